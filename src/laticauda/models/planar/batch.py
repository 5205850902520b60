"""Many planar runs at once: eight side by side in the processor's vector registers, and blocks of eight on all cores.

The kernels are those of a single run, compiled for more lanes; the results of a run do not depend
on its neighbors, on the order, or on the number of threads.

Runs may carry derivatives. Every number of a block is then complex, and its imaginary part is
`STEP` times the derivative with respect to the run's parameter; what kernels must keep to for that
is said in `number_types`. Runs that differ in their slopes alone share what is computed for their
values (`lanes_of_runs`).
"""

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import groupby, islice
from typing import Any, NamedTuple, TypeVar

import numpy as np
from jaxtyping import Float, Inexact, Int

from laticauda.compiling.formulas import digest_of
from laticauda.models.dynamics.sampled_loads import SampledLoads
from laticauda.models.dynamics.school import GAIT_PARAMETERS, usable_cores
from laticauda.models.planar import rows
from laticauda.models.planar.lanes_of_runs import (
    MOST_SLOPES,
    STEP as STEP,
    WIDTH as WIDTH,
    LanesOfRuns,
    aligned as aligned,
    blocks_of,
    lanes_of_single_runs,
    values_of,
)
from laticauda.models.planar.layout import Layout
from laticauda.models.planar.load_log import LoadLog
from laticauda.models.planar.model import PlanarPlant
from laticauda.models.planar.sample_format import column_of
from laticauda.scenarios import Command, Controller, Start
from laticauda.values import Extensible

Result = TypeVar("Result")
Lanes = Sequence[Sequence[int]]
"""Indices of the runs of every lane."""

COMMAND = slice(rows.AMPLITUDE, rows.OFFSET + 1)
"""Rows of a wave's parameters (`GAIT_PARAMETERS`)."""
FILTERED_COMMAND = [rows.AMPLITUDE_NOW, rows.FREQUENCY_NOW, rows.PHASE_SHIFT_NOW]
"""Rows of the initial state that hold the first of them."""
MOST_BLOCKS_PER_TASK = 8
"""Blocks that one thread takes at a time."""
SAMPLES_PER_CALL = 2000
"""Samples that are logged by one call of a kernel."""
_X = column_of(rows.X)
_VX = column_of(rows.VX)
_AXES = 2
PATH_ROWS = _VX + _AXES
"""Rows of a log without the joints: the header's state from TIME to VY, few enough to stay in the processor's cache."""


@dataclass(frozen=True, kw_only=True)
class Run:
    """One run of a batch: the plant, its command and its start."""

    plant: PlanarPlant
    """Robot, environment and settings."""
    command: Command
    """Command, held throughout the run, or until the controller's first one acts."""
    start: Start = Start()  # noqa: RUF009 - frozen
    """Start; by default straight and at rest."""
    slope: Float[np.ndarray, " rows"] | None = None
    """Derivative of the run's rows with respect to a parameter, to differentiate the results; for all runs or none."""
    controller: Controller[Any] | None = None
    """Controller that steers (`fleet`); None: the command is held."""

    @property
    def rows(self) -> Float[np.ndarray, " rows"]:
        """Rows that are passed to the kernels."""
        return self.plant.rows(self.plant.init(self.start, self.command), self.command)

    @property
    def n_rows(self) -> int:
        """Number of these rows."""
        if self.command.gait.recorded is not None:
            return self.rows.size
        return self.plant.layout.template.size


@dataclass(frozen=True, kw_only=True, eq=False)
class Block:
    """Results of a few runs of the same kind, runs along the last axis; the next block overwrites the samples."""

    index: Int[np.ndarray, " n_runs"]
    """Indices of these runs in the batch."""
    samples: np.ndarray
    """What the kernels have logged."""
    lanes: LanesOfRuns
    """Where the runs lie in it."""
    heading: Inexact[np.ndarray, " n_runs"]
    """Heading at the end [rad]."""
    work: Inexact[np.ndarray, "4 n_runs"]
    """Work at the end: absolute, net and positive work of the joints, electrical work [J]."""
    n_samples: Int[np.ndarray, " n_runs"]
    """Number of samples before the run diverged; all samples if the run reached its end."""
    loads: tuple[SampledLoads, ...] | None = None
    """Loads of each run at the samples, which mean nothing from where it diverged; None: not requested."""

    @property
    def time(self) -> Float[np.ndarray, " n_samples"]:
        """Times of the samples [s]."""
        return np.real(values_of(self.samples)[:, 0, 0])

    @cached_property
    def log(self) -> Inexact[np.ndarray, "n_samples n_rows n_runs"]:
        """The header's state rows from TIME to VY; complete logs also include the joints (see `sample_format`)."""
        return self.lanes.numbers(self.samples)

    @property
    def center_of_mass(self) -> Inexact[np.ndarray, "n_samples 2 n_runs"]:
        """p [m]."""
        return self.log[:, _X : _X + _AXES]

    @property
    def center_of_mass_velocity(self) -> Inexact[np.ndarray, "n_samples 2 n_runs"]:
        """p' [m/s]."""
        return self.log[:, _VX : _VX + _AXES]

    def at(self, sample: Int[np.ndarray, " n_runs"]) -> Inexact[np.ndarray, "n_rows n_runs"]:
        """Return one sample of every run, as in `log`, without those between.

        Args:
            sample: Index of the sample of each run.
        """
        return self.lanes.numbers_at(self.samples, sample)


class Device(Extensible, group="devices"):
    """Device that runs batches instead of the processor's cores; provided by installed packages."""

    def march_many(self, *batch: Any, **settings: Any) -> Iterator[Any]:
        """Run a batch, with the arguments of the function `march_many`."""
        raise NotImplementedError


def march_many(
    runs: Sequence[Run],
    duration: float,
    sample_interval: float,
    use: Callable[[Block], Result],
    *,
    threads: int | None = None,
    with_joints: bool = False,
    with_loads: bool = False,
) -> Iterator[Result]:
    """Simulate every run for `duration` and pass the results to `use`, block by block.

    Only a few blocks are in memory at any time.

    Args:
        runs: Runs of the batch.
        duration: Duration of every run [s].
        sample_interval: Time between two samples [s]; adjusted so that it divides `duration`.
        use: Function that is called once per block, in the computing threads.
        threads: Number of threads; None: one per core that this process may use.
        with_joints: Whether to log everything that the kernels can log, including the joints.
        with_loads: Whether to compute the loads at every sample, for which everything is logged; not
            of runs with slopes.

    Yields:
        Return values of `use`, in no particular order of runs.
    """
    n_intervals = max(1, round(duration / sample_interval))
    n_threads = threads or usable_cores()
    n_slopes = _slopes_per_lane(runs)
    tasks = _tasks(runs, duration / n_intervals, n_threads)

    def work(task: Lanes) -> list[Result]:
        first_runs = [runs[lane[0]] for lane in task]
        plant = first_runs[0].plant  # kernel and rows are the same for all runs of a kind
        columns = columns_of(first_runs)
        n_rows = PATH_ROWS
        if with_joints or with_loads:
            n_rows = plant.layout.sample_size
        n_samples = 1 + min(n_intervals, SAMPLES_PER_CALL)
        log = LanesOfRuns.of(task, n_slopes).room(n_samples, n_rows)
        results: list[Result] = []
        for first, lanes in zip(range(0, len(task), WIDTH), blocks_of(task, WIDTH), strict=True):
            indices = np.concatenate(lanes)
            members = _Members(
                indices=indices,
                lanes=LanesOfRuns.of(lanes, n_slopes),
                runs=[runs[int(i)] for i in indices],
            )
            load_log: LoadLog | None = None
            if with_loads:
                plants = [run.plant for run in members.runs]
                load_log = LoadLog(plants, WIDTH, 1 + n_intervals)
            S = members.side_by_side(columns[:, first : first + WIDTH])
            block = _march(plant, members, S, duration, n_intervals, log, load_log)
            results.append(use(block))
        return results

    with ThreadPoolExecutor(n_threads) as pool:
        waiting = deque[Future[list[Result]]](
            pool.submit(work, task) for task in islice(tasks, 2 * n_threads)
        )
        try:
            while waiting:
                done = waiting.popleft().result()
                waiting.extend(pool.submit(work, task) for task in islice(tasks, 1))
                yield from done
        finally:
            for future in waiting:
                future.cancel()


class _Members(NamedTuple):
    """The runs of a block."""

    indices: Int[np.ndarray, " n_runs"]
    """Indices of these runs in the batch."""
    lanes: LanesOfRuns
    """Where they lie."""
    runs: Sequence[Run]
    """The runs."""

    def side_by_side(self, columns: Float[np.ndarray, "n_rows n_lanes"]) -> np.ndarray:
        """Return the rows of the runs as the kernels take them.

        Args:
            columns: Rows of one run of every lane.
        """
        slopes = [run.slope for run in self.runs if run.slope is not None]
        return self.lanes.fill(columns, slopes)


def _slopes_per_lane(runs: Sequence[Run]) -> int:
    """Return how many derivatives the lanes of a batch carry: none, one, or as many as they can."""
    if not runs or runs[0].slope is None:
        return 0
    if len(set(map(_values_of_run, runs))) == len(runs):
        return 1
    return MOST_SLOPES


def _values_of_run(run: Run) -> tuple[int, int, int]:
    """Return what runs of the same values have in common, as far as these are the same objects."""
    return id(run.plant), id(run.command), id(run.start)


def _lanes_of(runs: Sequence[Run], indices: Sequence[int]) -> Lanes:
    """Return the runs of every lane: one, or several that differ in their slopes alone."""
    lanes: list[list[int]] = []
    last_lane: dict[object, list[int]] = {}
    for i in indices:
        values = _values_of_run(runs[i])
        lane = last_lane.get(values)
        if lane is not None and runs[i].slope is not None and len(lane) < MOST_SLOPES:
            lane.append(i)
        else:
            last_lane[values] = [i]
            lanes.append(last_lane[values])
    return lanes


def _tasks(runs: Sequence[Run], interval: float, n_threads: int) -> Iterator[Lanes]:
    """Yield the runs of lanes that can run side by side, a few blocks of WIDTH lanes per task."""
    for indices in kinds_of(runs, interval):
        lanes = _lanes_of(runs, indices)
        n_blocks = max(len(lanes) // (4 * WIDTH * n_threads), 1)
        yield from blocks_of(lanes, WIDTH * min(n_blocks, MOST_BLOCKS_PER_TASK))


def kinds_of(runs: Sequence[Run], interval: float) -> Iterable[list[int]]:
    """Group the indices of runs that can run side by side; `interval` is the sample interval [s]."""
    kinds: dict[object, list[int]] = {}
    kind_of_plant: dict[int, object] = {}
    digest_of_laws: dict[object, str] = {}
    for i, run in enumerate(runs):
        plant = run.plant
        if id(plant) not in kind_of_plant:
            laws = _laws_of(plant)
            if laws not in digest_of_laws:
                digest_of_laws[laws] = _digest_laws(plant)
            kind_of_plant[id(plant)] = _kind(plant, interval, digest_of_laws[laws])
        recorded = run.command.gait.recorded
        recorded_times = recorded and recorded.time  # lanes share its times, not its angles
        kinds.setdefault((kind_of_plant[id(plant)], recorded_times), []).append(i)
    return kinds.values()


def _laws_of(plant: PlanarPlant) -> object:
    """Return what the digest of a plant's laws depends on, quickly."""
    flow = plant.flow
    function = getattr(plant.law, "function", None)
    return type(plant.law), function, type(plant.joints), flow.parts, flow.counts


def _digest_laws(plant: PlanarPlant) -> str:
    """Return the digest of the laws that are compiled into a plant's kernels."""
    flow = plant.flow
    joint_formula = plant.joints.own
    joint_digest = joint_formula and digest_of(joint_formula)
    flow_digests = [digest_of(formula) for formula in flow.kinds]
    flow_parts = [part[2] for part in flow.parts]
    return (
        f"{digest_of(plant.law.formula)} {joint_digest} {(flow_digests, flow_parts)} {flow.counts}"
    )


def _kind(plant: PlanarPlant, interval: float, law_digest: str) -> object:
    """Return what runs side by side must have in common: the chain's shape, the laws, the number of steps."""
    layout: Layout = plant.layout
    shape = (
        layout.n_bodies,
        layout.first_strip.tobytes(),
        layout.first_plate.tobytes(),
        layout.law.tobytes(),
        layout.tail_link,
        layout.has_extras,
        layout.has_finite_span,
    )
    return shape, plant.steps_in(interval), law_digest


def _march(
    plant: PlanarPlant,
    members: _Members,
    S: np.ndarray,
    duration: float,
    n_intervals: int,
    log: np.ndarray,
    load_log: LoadLog | None,
) -> Block:
    """Simulate up to WIDTH runs of one kind side by side, starting from their rows.

    A long run takes several calls of the kernel, one after the other, which all write to the same `log`.
    """
    every = plant.steps_in(duration / n_intervals)
    dt = duration / n_intervals / every
    march = plant.kernels_of(WIDTH).run
    lanes = members.lanes
    path: np.ndarray | None = None
    if n_intervals > SAMPLES_PER_CALL:
        path = _path_without_samples(lanes.numbers(log[:1]), duration, n_intervals)
    is_well = np.full(WIDTH, True)
    n_samples = np.zeros(WIDTH, dtype=int)
    for first in range(0, n_intervals, SAMPLES_PER_CALL):
        count = min(SAMPLES_PER_CALL, n_intervals - first)
        part = log[: count + 1]
        n_logged = march(S, *plant.layout.chain, plant.is_implicit, count * every, dt, every, part)
        n_written = values_of(S)[rows.SAMPLES].astype(int)
        # The first sample of a further part is the last one of the part before.
        n_repeated = 0 if first == 0 else 1
        n_samples += is_well * np.maximum(n_written - n_repeated, 0)
        is_well &= n_written == count + 1
        if path is not None:
            path[first + n_repeated : first + n_logged] = lanes.numbers(part[n_repeated:n_logged])
        if load_log is not None:
            load_log.add(S, part[n_repeated:n_logged], first + n_repeated)
        if not is_well.any():
            break
    loads = None if load_log is None else load_log.loads()
    end = lanes.numbers(S[: rows.HEADER_ROWS])
    block = block_of(members.indices, log, end, n_samples[lanes.lane], loads, lanes)
    if path is None:
        return block
    return replace(block, samples=path, lanes=lanes_of_single_runs(path.shape[-1]))


def _path_without_samples(sample: np.ndarray, duration: float, n_intervals: int) -> np.ndarray:
    """Return the path of a block of long runs before it is known, like `sample`: times only, all else nan.

    It keeps its length when all runs of the block diverge, and the rest is never computed.
    """
    path = np.full((1 + n_intervals, *sample.shape[1:]), np.nan, dtype=sample.dtype)
    path[:, 0] = np.linspace(0.0, duration, 1 + n_intervals)[:, np.newaxis]
    return path


def block_of(
    index: np.ndarray,
    samples: np.ndarray,
    end: np.ndarray,
    n_samples: np.ndarray,
    loads: tuple[SampledLoads, ...] | None = None,
    lanes: LanesOfRuns | None = None,
) -> Block:
    """Return the results of runs, from their logs and the rows of the header at the end.

    Args:
        index: Indices of the runs in the batch.
        samples: What was logged.
        end: Rows of the header at the end of every run.
        n_samples: Number of samples before a run diverged.
        loads: Loads of each run at the samples.
        lanes: Where the runs lie in the samples; None: one in each lane.
    """
    return Block(
        index=index,
        samples=samples,
        lanes=lanes or lanes_of_single_runs(samples.shape[-1]),
        heading=end[rows.HEADING].copy(),
        work=end[rows.WORK_ABSOLUTE :][: rows.N_WORKS].copy(),
        n_samples=n_samples,
        loads=loads,
    )


def side_by_side(columns: np.ndarray) -> np.ndarray:
    """Return the rows of up to WIDTH runs without slopes as lanes; unused lanes repeat the last run."""
    return lanes_of_single_runs(columns.shape[1]).fill(columns)


def columns_of(runs: Sequence[Run]) -> np.ndarray:
    """Return the rows of several runs, one column per run."""
    columns = [
        _columns(list(plant_runs)) for _, plant_runs in groupby(runs, lambda run: id(run.plant))
    ]
    return np.concatenate(columns, axis=1)


def _columns(runs: Sequence[Run]) -> np.ndarray:
    """Return the columns of one plant's runs; if only their waves differ, most rows are computed once."""
    first = runs[0]
    if len(runs) == 1 or not all(_differ_in_waves(first, run) for run in runs[1:]):
        return np.stack([run.rows for run in runs], axis=1)
    S = np.repeat(first.rows[:, np.newaxis], len(runs), axis=1)
    waves = np.array([_wave_numbers(run) for run in runs]).T
    S[COMMAND] = waves
    S[FILTERED_COMMAND] = waves[: len(FILTERED_COMMAND)]
    S[rows.OFFSET] += first.command.offset
    return S


def _wave_numbers(run: Run) -> list[float]:
    return [getattr(run.command.gait, name) for name in GAIT_PARAMETERS]


def _differ_in_waves(first: Run, run: Run) -> bool:
    """Return whether two runs of a plant differ only in the rows of `GAIT_PARAMETERS`.

    Held references stand in other rows, and the gait is ignored.
    """
    return (
        first.command.references is None
        and first.start == run.start
        and _are_same(first.command, run.command, but=("gait",))
        and _are_same(first.command.gait, run.command.gait, but=GAIT_PARAMETERS)
    )


def _are_same(first: object, second: object, but: Sequence[str]) -> bool:
    """Return whether two objects of a class are equal in all fields except those in `but`."""
    values_of_second = vars(second)
    for name, value in vars(first).items():
        other_value = values_of_second[name]
        # Most values are the same objects, and not compared.
        if value is not other_value and name not in but and value != other_value:
            return False
    return True
