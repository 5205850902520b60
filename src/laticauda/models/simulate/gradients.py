"""Derivatives of single figures of runs with respect to everything that a run is computed from.

They are computed backward in time (`laticauda.models.planar.reverse`): one sweep for a figure, however
many numbers there are. `derivatives` does the same forward, one run for a number.
"""

import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from laticauda.models.dynamics.school import usable_cores
from laticauda.models.planar import batch, reverse, rows
from laticauda.models.planar.model import PlanarPlant
from laticauda.models.simulate import batch_figures
from laticauda.models.simulate.derivatives import SharedWork
from laticauda.models.simulate.row_derivatives import Number, RowDerivative
from laticauda.models.simulate.runner import Progress, silent
from laticauda.trials import REACHED_END

_X = reverse.seed_of(rows.X)
_VX = reverse.seed_of(rows.VX)
_HEADING = reverse.seed_of(rows.HEADING)


MOST_FORWARD = 10
"""Numbers of a run up to which its figures are differentiated forward: their kernels are compiled anyway."""
COST_FORWARD = 2.25
"""Time to differentiate a run with respect to one of several numbers, in runs."""
COST_BACKWARD = 4.5
"""Time to differentiate one figure of a run with respect to all numbers, in runs."""


def is_cheaper(plants: Sequence[PlanarPlant], n_figures: int, n_numbers: int) -> bool:
    """Return whether derivatives of the runs of some plants are to be computed backward, as far as they can be.

    Args:
        plants: Plants of the runs.
        n_figures: Figures of a run that are differentiated.
        n_numbers: Numbers with respect to which they are differentiated.
    """
    if n_numbers <= MOST_FORWARD or COST_BACKWARD * n_figures >= COST_FORWARD * n_numbers:
        return False
    return can_go_backward(plants)


def can_go_backward(plants: Sequence[PlanarPlant]) -> bool:
    """Return whether the runs of some plants can be differentiated backward in time.

    Args:
        plants: Plants of the runs.
    """
    different_plants = {id(plant): plant for plant in plants}
    return all(reverse.find_obstacle(plant) is None for plant in different_plants.values())


class FigureOfRun(NamedTuple):
    """A figure of one run of a batch."""

    run: int
    """Index of the run."""
    figure: str
    """Name of the figure, one of `run_figures.UNITS`."""


class Gradient(NamedTuple):
    """Value and derivatives of a figure of a run, both nan where it has none."""

    value: float
    """Value of the figure."""
    rows: Float[np.ndarray, " n_rows"]
    """Derivatives with respect to the rows that the kernels read."""
    weight: float
    """Derivative with respect to the robot's weight, see `carried_weight`."""
    status: str
    """How the run ended."""

    @property
    def succeeded(self) -> bool:
        """Whether the run reached its end."""
        return self.status == REACHED_END


def compute_row_gradients(
    runs: Sequence[batch.Run],
    figures: Sequence[FigureOfRun],
    duration: float,
    *,
    sample_interval: float = 0.05,
    threads: int | None = None,
    progress: Progress = silent,
) -> list[Gradient]:
    """Compute figures of runs and their derivatives with respect to all rows of the runs.

    Args:
        runs: Runs that `reverse.find_obstacle` finds nothing against.
        figures: Which figures of which runs.
        duration: Duration of every trial [s].
        sample_interval: Sample interval of the logs used for the figures [s].
        threads: Number of threads; None uses all cores that this process may use.
        progress: Called repeatedly with the completed share, from 0 to 1.

    Returns:
        The gradients, in the order of the figures.
    """
    if not figures:
        return []
    n_intervals = max(1, round(duration / sample_interval))
    runs_of_figures = [runs[figure.run] for figure in figures]
    gradients: dict[int, Gradient] = {}
    own = _OfThread()

    def sweep(members: list[int]) -> list[tuple[int, Gradient]]:
        block = _Block(
            runs=[runs_of_figures[i] for i in members],
            figures=[figures[i].figure for i in members],
            time=np.linspace(0.0, duration, n_intervals + 1),
        )
        # A list: what is left to be computed when it is asked for would all be computed by one thread.
        gradients_of_block = block.sweep(duration, sample_interval, own.room)
        return list(zip(members, gradients_of_block, strict=True))

    with ThreadPoolExecutor(threads or usable_cores()) as pool:
        for gradients_of_block in pool.map(sweep, _blocks(runs_of_figures, duration / n_intervals)):
            gradients.update(gradients_of_block)
            progress(len(gradients) / len(figures))
    return [gradients[i] for i in range(len(figures))]


class _OfThread(threading.local):
    """What a thread has of its own."""

    def __init__(self) -> None:
        self.room = reverse.Room()


def compute_jacobians(
    runs: Sequence[batch.Run],
    numbers: Sequence[Sequence[Number]],
    figures: Sequence[Sequence[str]],
    duration: float,
    *,
    sample_interval: float = 0.05,
    threads: int | None = None,
    progress: Progress = silent,
) -> "list[FigureJacobian]":
    """Compute figures of runs and their derivatives with respect to numbers of each run, backward in time.

    Args:
        runs: Runs that `reverse.find_obstacle` finds nothing against.
        numbers: The numbers of each run.
        figures: The figures of each run.
        duration: Duration of every trial [s].
        sample_interval: Sample interval of the logs used for the figures [s].
        threads: Number of threads; None uses all cores that this process may use.
        progress: Called repeatedly with the completed share, from 0 to 1.

    Raises:
        ValueError: If a number cannot change to either side.
    """
    shared = SharedWork()
    sweeps = _Sweeps(shared)
    for run, numbers_of_run, figures_of_run in zip(runs, numbers, figures, strict=True):
        changes = shared.derivatives_of(run, numbers_of_run)
        sweeps.add(run, changes, figures_of_run)
    gradients = compute_row_gradients(
        sweeps.runs,
        sweeps.figures,
        duration,
        sample_interval=sample_interval,
        threads=threads,
        progress=progress,
    )
    changes_of_task: _Changes | None = None
    jacobians: list[FigureJacobian] = []
    for task in sweeps.tasks:
        if changes_of_task is None or changes_of_task.sources is not task.changes:
            changes_of_task = _Changes.of(task.changes)
        jacobians.append(task.combine(gradients, changes_of_task))
    return jacobians


class FigureJacobian(NamedTuple):
    """Some figures of a run and their derivatives; nan where it has none."""

    values: Float[np.ndarray, " n_figures"]
    """The figures."""
    jacobian: Float[np.ndarray, "n_figures n_numbers"]
    """Their derivatives."""
    status: str
    """How the run ended."""


class _Task(NamedTuple):
    """What is differentiated of a run."""

    changes: Sequence[RowDerivative]
    """How each number enters the run."""
    sweep_of_change: Sequence[int]
    """For each number, the index of the first sweep that holds its derivatives."""
    n_figures: int
    """Number of figures, each with a sweep of its own."""

    def combine(self, gradients: Sequence[Gradient], changes: "_Changes") -> FigureJacobian:
        """Return the derivatives with respect to numbers from those with respect to rows.

        Args:
            gradients: The gradients of all sweeps.
            changes: What `changes` of this task are, in arrays.
        """
        jacobian = np.empty((self.n_figures, len(self.changes)))
        for first in dict.fromkeys(self.sweep_of_change):
            columns = np.equal(self.sweep_of_change, first)
            for i in range(self.n_figures):
                along_all = changes.along(gradients[first + i])
                jacobian[i, columns] = along_all[columns]
        first = self.sweep_of_change[0]
        own_gradients = gradients[first : first + self.n_figures]
        return FigureJacobian(
            values=np.array([gradient.value for gradient in own_gradients]),
            jacobian=jacobian,
            status=own_gradients[0].status,
        )


class _Changes(NamedTuple):
    """How some numbers enter a run, in arrays."""

    sources: Sequence[RowDerivative]
    """What the arrays are made of."""
    rows: Float[np.ndarray, "n_numbers n_rows"]
    """Derivatives of the rows."""
    weight: Float[np.ndarray, " n_numbers"]
    """Derivatives of the robot's weight."""

    @classmethod
    def of(cls, sources: Sequence[RowDerivative]) -> "_Changes":
        """Return the arrays of some numbers."""
        return cls(
            sources=sources,
            rows=np.stack([source.rows for source in sources]),
            weight=np.array([source.weight for source in sources]),
        )

    def along(self, gradient: Gradient) -> Float[np.ndarray, " n_numbers"]:
        """Return the derivatives of a figure with respect to the numbers.

        Each is summed by itself, and does not depend on which others there are.
        """
        along_rows = np.einsum("kr,r->k", self.rows, gradient.rows)
        return along_rows + gradient.weight * self.weight


class _Sweeps:
    """Sweeps of all runs; a number that needs further loads has sweeps of its own.

    What is computed for a number thereby does not depend on which others are asked for.
    """

    def __init__(self, shared: SharedWork) -> None:
        self.runs: list[batch.Run] = []
        """Runs to sweep, some with kernels for all loads."""
        self.figures: list[FigureOfRun] = []
        """Figures of these runs, one for each sweep."""
        self.tasks: list[_Task] = []
        """What is made of the sweeps, one for each run that was added."""
        self._shared = shared

    def add(self, run: batch.Run, changes: Sequence[RowDerivative], figures: Sequence[str]) -> None:
        """Add the sweeps that a run needs."""
        first_sweeps: dict[bool, int] = {}
        sweep_of_change: list[int] = []
        for change in changes:
            needs_extras = change.needs_extras and not run.plant.layout.has_extras
            if needs_extras not in first_sweeps:
                first_sweeps[needs_extras] = self._add_sweeps(run, needs_extras, figures)
            sweep_of_change.append(first_sweeps[needs_extras])
        task = _Task(changes=changes, sweep_of_change=sweep_of_change, n_figures=len(figures))
        self.tasks.append(task)

    def _add_sweeps(self, run: batch.Run, needs_extras: bool, figures: Sequence[str]) -> int:
        """Add sweeps for all figures of a run; return the index of the first."""
        first = len(self.figures)
        if needs_extras:
            run = replace(run, plant=self._shared.plant_with_extras(run.plant))
        self.figures += [FigureOfRun(len(self.runs), figure) for figure in figures]
        self.runs.append(run)
        return first


def _blocks(runs: Sequence[batch.Run], interval: float) -> Iterator[list[int]]:
    """Yield the indices of runs that go side by side."""
    for members in batch.kinds_of(runs, interval):
        for first in range(0, len(members), batch.WIDTH):
            yield members[first : first + batch.WIDTH]


class _Block:
    """A few runs side by side, each with the figure that is differentiated."""

    def __init__(
        self,
        runs: Sequence[batch.Run],
        figures: Sequence[str],
        time: Float[np.ndarray, " n_samples"],
    ) -> None:
        self.runs = runs
        self.figures = figures
        self.facts = batch_figures.RunFacts.of(runs)
        self.steady = batch_figures.Steady.of(runs, time)
        self.slopes = _FigureSlopes.unknown(len(runs))
        self.reached_end: Bool[np.ndarray, " n_runs"] = np.zeros(len(runs), dtype=bool)
        self.last_sample: Int[np.ndarray, " n_runs"] = np.zeros(len(runs), dtype=int)

    def sweep(
        self, duration: float, sample_interval: float, room: reverse.Room
    ) -> Iterator[Gradient]:
        """Yield the gradient of every run's figure."""
        bars = reverse.march_back(self.runs, duration, sample_interval, self._seed, room)
        slopes = self.slopes
        change = slopes.start * (duration - np.nan_to_num(self.steady.start))
        for lane, run in enumerate(self.runs):
            # The start of the steady part depends on the frequency, see `batch_figures.Steady`.
            frequency = run.command.gait.frequency
            if frequency > 0.0:
                bars[rows.FREQUENCY, lane] += change[lane] / frequency
            bars[rows.CURRENT_X, lane] += slopes.current[0, lane]
            bars[rows.CURRENT_Y, lane] += slopes.current[1, lane]
            if np.isnan(slopes.value[lane]):
                bars[:, lane] = np.nan
            yield Gradient(
                value=float(slopes.value[lane]),
                rows=bars[:, lane].copy(),
                weight=float(slopes.weight[lane]),
                status=self._status(lane),
            )

    def _status(self, lane: int) -> str:
        if self.reached_end[lane]:
            return REACHED_END
        failed_at = float(self.steady.time[self.last_sample[lane]])
        return self.runs[lane].plant.describe_divergence(failed_at)

    def _seed(self, block: batch.Block) -> Float[np.ndarray, "n_samples n_seeds n_runs"]:
        """Return the derivatives of every run's figure with respect to the samples of its log."""
        n_samples = block.time.size
        self.reached_end = block.n_samples == n_samples
        self.last_sample = np.minimum(block.n_samples, n_samples - 1)
        before = self.steady.before
        numbers = batch_figures.sample_block(self.runs, block, before)
        self.slopes = _FigureSlopes.of(self.figures, self.facts, numbers, self.steady)
        self.slopes.value[~self.reached_end] = np.nan
        slopes = np.where(np.isnan(self.slopes.value), 0.0, self.slopes.numbers)
        seeds = np.zeros((n_samples, reverse.SEED_ROWS, len(self.runs)))
        lanes = np.arange(len(self.runs))
        position = slice(_X, _X + 2)
        seeds[0, position] += slopes[batch_figures.START]
        seeds[-1, position] += slopes[batch_figures.END]
        seeds[-1, _HEADING] += slopes[batch_figures.HEADING]
        seeds[-1, reverse.SEED_WORK :] += slopes[batch_figures.WORK]
        around_start = (
            (before, _X, batch_figures.POSITION_BEFORE),
            (before, _VX, batch_figures.VELOCITY_BEFORE),
            (before + 1, _X, batch_figures.POSITION_AFTER),
            (before + 1, _VX, batch_figures.VELOCITY_AFTER),
        )
        for sample, seed, kept_numbers in around_start:
            along_x, along_y = slopes[kept_numbers]
            seeds[sample, seed, lanes] += along_x
            seeds[sample, seed + 1, lanes] += along_y
        return seeds


class _FigureSlopes(NamedTuple):
    """One figure of each run and its derivatives with respect to what it is computed from."""

    value: Float[np.ndarray, " n_runs"]
    """The figures; nan where a run has none."""
    numbers: Float[np.ndarray, "n_numbers n_runs"]
    """Derivatives with respect to the kept numbers, see `batch_figures.sample_block`."""
    weight: Float[np.ndarray, " n_runs"]
    """With respect to the robot's weight."""
    start: Float[np.ndarray, " n_runs"]
    """With respect to the start of the steady part."""
    current: Float[np.ndarray, "2 n_runs"]
    """With respect to a uniform current, where the motion of the robot does not follow it."""

    @classmethod
    def unknown(cls, n_runs: int) -> "_FigureSlopes":
        """Return those of runs of which nothing is known."""
        nothing = np.full(n_runs, np.nan)
        numbers = np.full((batch_figures.N_SAMPLED_NUMBERS, n_runs), np.nan)
        return cls(nothing, numbers, nothing, nothing, numbers[:2])

    @classmethod
    def of(
        cls,
        figures: Sequence[str],
        facts: batch_figures.RunFacts,
        numbers: Float[np.ndarray, "n_numbers n_runs"],
        steady: batch_figures.Steady,
    ) -> "_FigureSlopes":
        """Differentiate figures by a complex step, all numbers of all runs at once."""
        n_numbers, n_runs = numbers.shape
        n_steps = n_numbers + 2  # all numbers, the weight, the start
        run: np.ndarray = np.array([*range(n_runs)] * n_steps)
        change: np.ndarray = 1j * batch.STEP * np.repeat(np.eye(n_steps), n_runs, axis=1)
        stepped_facts = facts.take(run)
        stepped_facts = stepped_facts._replace(weight=stepped_facts.weight + change[n_numbers])
        stepped_steady = batch_figures.Steady(
            start=steady.start[run] + change[n_numbers + 1],
            before=steady.before[run],
            time=steady.time,
        )
        stepped_numbers = np.take(numbers, run, axis=1) + change[:n_numbers]
        values = batch_figures.compute_figures(stepped_facts, stepped_numbers, stepped_steady)
        of_lanes = np.empty((n_steps, n_runs), dtype=complex)
        for lane, figure in enumerate(figures):
            of_lanes[:, lane] = values[figure].reshape(n_steps, n_runs)[:, lane]
        slopes = np.imag(of_lanes) / batch.STEP
        slopes_of_numbers = slopes[:n_numbers]
        return cls(
            value=np.real(of_lanes[0]).copy(),
            numbers=slopes_of_numbers,
            weight=slopes[n_numbers],
            start=np.nan_to_num(slopes[n_numbers + 1]),
            current=_slopes_of_current(slopes_of_numbers[batch_figures.WATER], steady),
        )


def _slopes_of_current(
    slopes: Float[np.ndarray, "n_numbers n_runs"], steady: batch_figures.Steady
) -> Float[np.ndarray, "2 n_runs"]:
    """Return the derivatives with respect to a uniform current from those to the motion of the water that it makes."""
    end, before, velocity_before, after, velocity_after = slopes.reshape(5, 2, -1)
    time_before, time_after = steady.time[steady.before], steady.time[steady.before + 1]
    return (
        end * steady.time[-1]
        + before * time_before
        + velocity_before
        + after * time_after
        + velocity_after
    )
