"""Many planar runs at once: eight side by side in the processor's vector registers, and blocks of eight on all cores.

The kernels are those of a single run, compiled for more lanes; a run's numbers do not depend on its neighbors, on the
order, or on the number of threads.

Runs may carry derivatives: then every number of a block is complex, and its imaginary part is `STEP` times the
derivative to the run's parameter.
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
from laticauda.dynamics.school import TOLD, usable_cores
from laticauda.extensions import Extensible
from laticauda.interfaces import Command, Start
from laticauda.planar import rows
from laticauda.planar.layout import Layout
from laticauda.planar.model import PlanarPlant

Result = TypeVar("Result")

# What fills a register of AVX-512; processors without it take two or four registers for the same numbers, and 16 lanes
# are no faster.
WIDTH = 8
# Where the numbers of a wave stand (`TOLD`), and of these the first in the state with which it begins.
COMMAND = slice(rows.AMPLITUDE, rows.OFFSET + 1)
BEGUN = [rows.AMPLITUDE_NOW, rows.FREQUENCY_NOW, rows.PHASE_SHIFT_NOW]
# The most blocks that one thread takes at a time, and samples that are logged at a time.
_BLOCKS = 8
_SAMPLES = 2000
# Of derivatives: far below rounding, and a power of two, so that it changes no digits.
STEP = 2.0**-100
# The log holds the header's state rows from TIME to VY: few enough to stay near the processor.
_X, _VX = rows.X - rows.TIME, rows.VX - rows.TIME
PATH_ROWS = _VX + 2


@dataclass(frozen=True, kw_only=True)
class Run:
    """One run of a batch: what swims, what it is asked for all the time, where it begins."""

    plant: PlanarPlant
    """Robot, environment and settings."""
    command: Command
    """Held from start to end."""
    start: Start = Start()  # noqa: RUF009 - frozen
    """Straight and at rest."""
    slope: Float[np.ndarray, " rows"] | None = None
    """Derivative of the run's rows to a parameter, if that of its results is wanted: in all runs of a batch."""

    @property
    def rows(self) -> Float[np.ndarray, " rows"]:
        """What the kernels get."""
        return self.plant.rows(self.plant.init(self.start, self.command), self.command)


@dataclass(frozen=True, kw_only=True, eq=False)
class Block:
    """What a few runs of the same kind left behind, the last axis the runs; the next block overwrites its path."""

    index: Int[np.ndarray, " n_runs"]
    """Which of the batch's runs these are."""
    time: Float[np.ndarray, " n_samples"]
    """Of the samples [s]."""
    center_of_mass: Inexact[np.ndarray, "n_samples 2 n_runs"]
    """p [m]."""
    center_of_mass_velocity: Inexact[np.ndarray, "n_samples 2 n_runs"]
    """p' [m/s]."""
    log: Inexact[np.ndarray, "n_samples n_rows n_runs"]
    """The header's state rows from TIME to VY; whole logs go on to what the joints do (see `rows.LOG_STATE`)."""
    heading: Inexact[np.ndarray, " n_runs"]
    """At the end [rad]."""
    work: Inexact[np.ndarray, "4 n_runs"]
    """At the end: absolute, net and positive work of the joints, electrical work [J]."""
    n_samples: Int[np.ndarray, " n_runs"]
    """Samples before the run's numbers left all bounds; all of them if the run reached its end."""


class Device(Extensible, group="devices"):
    """What marches batches in the place of the processor's cores; installed packages bring them."""

    def march_many(self, *batch: Any, **how: Any) -> Iterator[Any]:
        """As the function of that name; arguments as for it."""
        raise NotImplementedError


def march_many(
    runs: Sequence[Run],
    duration: float,
    sample_interval: float,
    use: Callable[[Block], Result],
    *,
    threads: int | None = None,
    with_joints: bool = False,
) -> Iterator[Result]:
    """Run every run for `duration` and hand what is left behind, block by block, to `use`.

    Only a few blocks are in memory at any time.

    Args:
        runs: What swims how.
        duration: [s].
        sample_interval: Between two samples [s]; adjusted so that it divides `duration`.
        use: Called once per block, in the threads that compute.
        threads: None takes as many as this process may use cores.
        with_joints: Log all that the kernels can, joints included.

    Yields:
        What `use` returned, in no particular order of runs.
    """
    n_intervals = max(1, round(duration / sample_interval))
    n_threads = threads or usable_cores()
    tasks = _tasks(runs, duration / n_intervals, n_threads)

    def work(task: np.ndarray) -> list[Result]:
        alike = [runs[int(i)] for i in task]
        first, columns = alike[0].plant, columns_of(alike)  # as to kernel and rows, like all runs of a kind
        n_rows = rows.LOG_STATE + 4 * (first.layout.n_bodies - 1) if with_joints else PATH_ROWS
        log = aligned((1 + min(n_intervals, _SAMPLES), n_rows, WIDTH), float if runs[0].slope is None else complex)
        blocks = [slice(i, i + WIDTH) for i in range(0, len(alike), WIDTH)]
        states = ((task[one], _side_by_side(columns[:, one], alike[one])) for one in blocks)
        return [use(_march(first, index, S, duration, n_intervals, log)) for index, S in states]

    with ThreadPoolExecutor(n_threads) as pool:
        waiting = deque[Future[list[Result]]](pool.submit(work, task) for task in islice(tasks, 2 * n_threads))
        try:
            while waiting:
                done = waiting.popleft().result()
                waiting.extend(pool.submit(work, task) for task in islice(tasks, 1))
                yield from done
        finally:
            for future in waiting:
                future.cancel()


def _tasks(runs: Sequence[Run], interval: float, n_threads: int) -> Iterator[np.ndarray]:
    """Indices of runs that can go side by side, a few blocks of WIDTH per task."""
    for alike in kinds_of(runs, interval):
        size = WIDTH * min(max(len(alike) // (4 * WIDTH * n_threads), 1), _BLOCKS)
        for i in range(0, len(alike), size):
            yield np.array(alike[i : i + size])


def kinds_of(runs: Sequence[Run], interval: float) -> Iterable[list[int]]:
    """Indices of runs that can go side by side; `interval` is that of their samples [s]."""
    kinds: dict[object, list[int]] = {}
    of_plant: dict[int, object] = {}
    of_law: dict[object, str] = {}
    for i, run in enumerate(runs):
        plant = run.plant
        if id(plant) not in of_plant:
            flow = plant.flow
            law = type(plant.law), getattr(plant.law, "function", None), type(plant.joints), flow.parts, flow.counts
            if law not in of_law:
                own = plant.joints.own
                moving = [digest_of(formula) for formula in flow.kinds], [part[2] for part in flow.parts]
                of_law[law] = f"{digest_of(plant.law.formula)} {own and digest_of(own)} {moving} {flow.counts}"
            of_plant[id(plant)] = _kind(plant, interval, of_law[law])
        recorded = run.command.gait.recorded  # lanes share its times, not its angles
        kinds.setdefault((of_plant[id(plant)], recorded and recorded.time), []).append(i)
    return kinds.values()


def _kind(plant: PlanarPlant, interval: float, law_digest: str) -> object:
    """What runs side by side must have in common: the chain's shape, the laws, the step."""
    a: Layout = plant.layout
    shape = (a.n_bodies, a.first_strip.tobytes(), a.first_plate.tobytes(), a.law.tobytes(), a.tail_link, a.has_extras)
    return shape, plant.steps_in(interval), law_digest


def _march(
    plant: PlanarPlant, index: np.ndarray, S: np.ndarray, duration: float, n_intervals: int, log: np.ndarray
) -> Block:
    """Up to WIDTH runs of one kind from their rows, side by side."""
    every = plant.steps_in(duration / n_intervals)
    dt = duration / n_intervals / every
    paths: list[np.ndarray] = []
    well, n_samples = np.full(WIDTH, True), np.zeros(WIDTH, dtype=int)
    for first in range(0, n_intervals, _SAMPLES):
        count = min(_SAMPLES, n_intervals - first)
        part = log[: count + 1]
        plant.kernels_of(WIDTH).run(S, *plant.layout.chain, plant.is_implicit, count * every, dt, every, part)
        here = np.real(_numbers(S[rows.SAMPLES])).astype(int)
        n_samples += well * (here if first == 0 else np.maximum(here - 1, 0))
        well &= here == count + 1
        if n_intervals > _SAMPLES:
            paths.append(_numbers(part[0 if first == 0 else 1 :]).copy())
        if not well.any():
            break
    path = np.concatenate(paths) if paths else _numbers(log)
    n = index.size
    return block_of(index, path[..., :n], _numbers(S)[:, :n], n_samples[:n])


def block_of(index: np.ndarray, path: np.ndarray, end: np.ndarray, n_samples: np.ndarray) -> Block:
    """What runs left behind, from their logs and their rows at the end."""
    return Block(
        index=index,
        time=np.real(path[:, 0, 0]),
        center_of_mass=path[:, _X : _X + 2],
        center_of_mass_velocity=path[:, _VX : _VX + 2],
        log=path,
        heading=end[rows.HEADING].copy(),
        work=end[rows.WORK_ABSOLUTE : rows.WORK_ELECTRICAL + 1].copy(),
        n_samples=n_samples,
    )


def _side_by_side(columns: np.ndarray, runs: Sequence[Run]) -> np.ndarray:
    """Rows of up to WIDTH runs as lanes, complex if they have slopes; lanes without a run repeat the last one."""
    S = aligned((columns.shape[0], WIDTH), float if runs[0].slope is None else complex)
    real, n = S, len(runs)
    if runs[0].slope is not None:
        real, slopes = split(S)
        slopes[:, :n] = STEP * np.stack([cast(np.ndarray, run.slope) for run in runs], axis=1)
        slopes[:, n:] = slopes[:, n - 1 : n]
    real[:, :n] = columns
    real[:, n:] = columns[:, -1:]
    return S


def columns_of(runs: Sequence[Run]) -> np.ndarray:
    """The rows of several runs, one column each."""
    return np.concatenate([_columns(list(of_one)) for _, of_one in groupby(runs, lambda run: id(run.plant))], axis=1)


def _columns(runs: Sequence[Run]) -> np.ndarray:
    """Those of one plant's runs; where their waves alone differ, most are worked out once."""
    first = runs[0]
    if len(runs) == 1 or not all(_differ_in_waves(first, run) for run in runs[1:]):
        return np.stack([run.rows for run in runs], axis=1)
    S = np.repeat(first.rows[:, np.newaxis], len(runs), axis=1)
    waves = np.array([[getattr(run.command.gait, name) for name in TOLD] for run in runs]).T
    S[COMMAND], S[BEGUN] = waves, waves[: len(BEGUN)]
    S[rows.OFFSET] += first.command.offset
    return S


def _differ_in_waves(one: Run, other: Run) -> bool:
    """Whether two runs of a plant differ in nothing but `TOLD`."""
    a, b = one.command, other.command
    return one.start == other.start and _same(a, b, ("gait",)) and _same(a.gait, b.gait, TOLD)


def _same(one: object, other: object, but: Sequence[str]) -> bool:
    """Whether two objects of a class have the same in all fields but some."""
    return all(vars(other)[name] == value for name, value in vars(one).items() if name not in but)


def _numbers(lanes: np.ndarray) -> np.ndarray:
    """What the kernels left behind as plain numbers, complex if they had slopes."""
    if lanes.dtype == float:
        return lanes
    real, imaginary = split(lanes)
    return real + 1j * imaginary


def aligned(shape: tuple[int, ...], kind: type) -> np.ndarray:
    """An array of zeros that begins where a vector register's worth of memory does."""
    size = int(np.prod(shape)) * np.dtype(kind).itemsize // 8
    raw: np.ndarray = np.zeros(size + 8)
    first = -raw.__array_interface__["data"][0] % 64 // 8
    return cast(np.ndarray, raw[first : first + size].view(kind)).reshape(shape)
