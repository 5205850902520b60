"""Many planar runs at once: eight side by side in the processor's vector registers, and blocks of eight on all cores.

The kernels are those of a single run, compiled for more lanes; the results of a run do not depend
on its neighbors, on the order, or on the number of threads.

Runs may carry derivatives. Every number of a block is then complex, and its imaginary part is
`STEP` times the derivative with respect to the run's parameter; what kernels must keep to for that
is said in `number_types`.
"""

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from itertools import groupby, islice
from typing import Any, TypeVar, cast

import numpy as np
from jaxtyping import Float, Inexact, Int

from laticauda.compiling.formulas import digest_of
from laticauda.compiling.lane_types import split
from laticauda.models.dynamics.sampled_loads import SampledLoads
from laticauda.models.dynamics.school import GAIT_PARAMETERS, usable_cores
from laticauda.models.planar import rows
from laticauda.models.planar.layout import Layout
from laticauda.models.planar.load_log import LoadLog
from laticauda.models.planar.model import PlanarPlant
from laticauda.models.planar.sample_format import column_of
from laticauda.scenarios import Command, Controller, Start
from laticauda.values import Extensible

Result = TypeVar("Result")

WIDTH = 8
"""Runs side by side. They fill an AVX-512 register; other processors use two or four registers for the
same numbers, and 16 lanes are no faster."""
COMMAND = slice(rows.AMPLITUDE, rows.OFFSET + 1)
"""Rows of a wave's parameters (`GAIT_PARAMETERS`)."""
FILTERED_COMMAND = [rows.AMPLITUDE_NOW, rows.FREQUENCY_NOW, rows.PHASE_SHIFT_NOW]
"""Rows of the initial state that hold the first of them."""
MOST_BLOCKS_PER_TASK = 8
"""Blocks that one thread takes at a time."""
SAMPLES_PER_CALL = 2000
"""Samples that are logged by one call of a kernel."""
STEP = 2.0**-100
"""Step of the derivatives: far below rounding, and a power of two, so that scaling by it changes no digits."""
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
    """Results of a few runs of the same kind, runs along the last axis; the next block overwrites the path."""

    index: Int[np.ndarray, " n_runs"]
    """Indices of these runs in the batch."""
    time: Float[np.ndarray, " n_samples"]
    """Times of the samples [s]."""
    center_of_mass: Inexact[np.ndarray, "n_samples 2 n_runs"]
    """p [m]."""
    center_of_mass_velocity: Inexact[np.ndarray, "n_samples 2 n_runs"]
    """p' [m/s]."""
    log: Inexact[np.ndarray, "n_samples n_rows n_runs"]
    """The header's state rows from TIME to VY; complete logs also include the joints (see `sample_format`)."""
    heading: Inexact[np.ndarray, " n_runs"]
    """Heading at the end [rad]."""
    work: Inexact[np.ndarray, "4 n_runs"]
    """Work at the end: absolute, net and positive work of the joints, electrical work [J]."""
    n_samples: Int[np.ndarray, " n_runs"]
    """Number of samples before the run diverged; all samples if the run reached its end."""
    loads: tuple[SampledLoads, ...] | None = None
    """Loads of each run at the samples, which mean nothing from where it diverged; None: not requested."""


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
    tasks = _tasks(runs, duration / n_intervals, n_threads)

    def work(task: np.ndarray) -> list[Result]:
        task_runs = [runs[int(i)] for i in task]
        plant = task_runs[0].plant  # kernel and rows are the same for all runs of a kind
        columns = columns_of(task_runs)
        n_rows = PATH_ROWS
        if with_joints or with_loads:
            n_rows = plant.layout.sample_size
        kind = float if runs[0].slope is None else complex
        log = aligned((1 + min(n_intervals, SAMPLES_PER_CALL), n_rows, WIDTH), kind)
        results: list[Result] = []
        for first in range(0, len(task_runs), WIDTH):
            lanes = slice(first, first + WIDTH)
            S = side_by_side(columns[:, lanes], task_runs[lanes])
            load_log: LoadLog | None = None
            if with_loads:
                plants = [run.plant for run in task_runs[lanes]]
                load_log = LoadLog(plants, WIDTH, 1 + n_intervals)
            block = _march(plant, task[lanes], S, duration, n_intervals, log, load_log)
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


def _tasks(runs: Sequence[Run], interval: float, n_threads: int) -> Iterator[np.ndarray]:
    """Yield indices of runs that can run side by side, a few blocks of WIDTH per task."""
    for indices in kinds_of(runs, interval):
        n_blocks = max(len(indices) // (4 * WIDTH * n_threads), 1)
        size = WIDTH * min(n_blocks, MOST_BLOCKS_PER_TASK)
        for first in range(0, len(indices), size):
            yield np.array(indices[first : first + size])


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
    index: np.ndarray,
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
    path: np.ndarray | None = None
    if n_intervals > SAMPLES_PER_CALL:
        path = _path_without_samples(log, duration, n_intervals)
    is_well = np.full(WIDTH, True)
    n_samples = np.zeros(WIDTH, dtype=int)
    for first in range(0, n_intervals, SAMPLES_PER_CALL):
        count = min(SAMPLES_PER_CALL, n_intervals - first)
        part = log[: count + 1]
        n_logged = march(S, *plant.layout.chain, plant.is_implicit, count * every, dt, every, part)
        n_written = np.real(_numbers(S[rows.SAMPLES])).astype(int)
        # The first sample of a further part is the last one of the part before.
        n_repeated = 0 if first == 0 else 1
        n_samples += is_well * np.maximum(n_written - n_repeated, 0)
        is_well &= n_written == count + 1
        if path is not None:
            path[first + n_repeated : first + n_logged] = _numbers(part[n_repeated:n_logged])
        if load_log is not None:
            load_log.add(S, part[n_repeated:n_logged], first + n_repeated)
        if not is_well.any():
            break
    if path is None:
        path = _numbers(log)
    n = index.size
    loads = None if load_log is None else load_log.loads()
    return block_of(index, path[..., :n], _numbers(S)[:, :n], n_samples[:n], loads)


def _path_without_samples(log: np.ndarray, duration: float, n_intervals: int) -> np.ndarray:
    """Return the path of a block of long runs before it is known: times only, all else nan.

    It keeps its length when all runs of the block diverge, and the rest is never computed.
    """
    path = np.full((1 + n_intervals, *log.shape[1:]), np.nan, dtype=_numbers(log[:1]).dtype)
    path[:, 0] = np.linspace(0.0, duration, 1 + n_intervals)[:, np.newaxis]
    return path


def block_of(
    index: np.ndarray,
    path: np.ndarray,
    end: np.ndarray,
    n_samples: np.ndarray,
    loads: tuple[SampledLoads, ...] | None = None,
) -> Block:
    """Return the results of runs, from their logs and their rows at the end."""
    return Block(
        index=index,
        time=np.real(path[:, 0, 0]),
        center_of_mass=path[:, _X : _X + _AXES],
        center_of_mass_velocity=path[:, _VX : _VX + _AXES],
        log=path,
        heading=end[rows.HEADING].copy(),
        work=end[rows.WORK_ABSOLUTE :][: rows.N_WORKS].copy(),
        n_samples=n_samples,
        loads=loads,
    )


def side_by_side(columns: np.ndarray, runs: Sequence[Run]) -> np.ndarray:
    """Return the rows of up to WIDTH runs as lanes, complex if they have slopes; unused lanes repeat the last run."""
    n = len(runs)
    has_slopes = runs[0].slope is not None
    S = aligned((columns.shape[0], WIDTH), complex if has_slopes else float)
    real = S
    if has_slopes:
        real, slopes = split(S)
        slopes[:, :n] = STEP * np.stack([cast(np.ndarray, run.slope) for run in runs], axis=1)
        slopes[:, n:] = slopes[:, n - 1 : n]
    real[:, :n] = columns
    real[:, n:] = columns[:, -1:]
    return S


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


def _numbers(lanes: np.ndarray) -> np.ndarray:
    """Return the kernels' output as plain numbers, complex if the runs had slopes."""
    if lanes.dtype == float:
        return lanes
    real, imaginary = split(lanes)
    return real + 1j * imaginary


def aligned(shape: tuple[int, ...], kind: type) -> np.ndarray:
    """Return an array of zeros that is aligned to the size of a vector register."""
    size = int(np.prod(shape)) * np.dtype(kind).itemsize // 8
    raw: np.ndarray = np.zeros(size + 8)
    first = -raw.__array_interface__["data"][0] % 64 // 8
    return cast(np.ndarray, raw[first : first + size].view(kind)).reshape(shape)
