"""Running the runs of a table: the kernels' logs are evaluated in compiled code, block by block.

The results are those of `batch_run.run_batch`, to the last bit, without an object for every run.
"""

from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from threading import local
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from laticauda.compiling.templates import specialized
from laticauda.models.dynamics.samples import check_size
from laticauda.models.dynamics.school import usable_cores
from laticauda.models.planar import (
    COMMAND,
    FILTERED_COMMAND,
    PATH_ROWS,
    SAMPLES_PER_CALL,
    WIDTH,
    Block,
    Layout,
    Run,
    aligned,
    kinds_of,
    rows,
    sample_format,
)
from laticauda.models.simulate import batch_figures
from laticauda.models.simulate.batch_figures import joint_peaks, periods_of
from laticauda.models.simulate.batch_run import CPU, BatchResult
from laticauda.models.simulate.batch_scenarios import runs_of
from laticauda.models.simulate.loads_of_many import KeptLoads
from laticauda.models.simulate.run_table import (
    Columns,
    RunTable,
    make_run_table,
    scenarios_at,
    table_of_runs,
)
from laticauda.models.simulate.runner import Progress, silent
from laticauda.models.simulate.steered import run_mixed_batch
from laticauda.motion.gaits import Gait
from laticauda.robot import Robot, Water
from laticauda.scenarios import Scenario
from laticauda.trials import REACHED_END, metrics
from laticauda.trials.feasibility import (
    MOST_POSTURES,
    NEEDS,
    ScanLimits,
    count_unsettled_samples,
    include_neighbors,
    measure_crossing,
    spread_evenly,
)
from laticauda.values import check_whole_number

MOST_BLOCKS_PER_TASK = 64
"""Blocks that one thread takes at a time: so many that what is prepared for a task hardly counts."""
_N_PEAKS = 5
"""Rows of the peaks that `harvest.find_peaks` finds."""


_FILTERED_COMMAND = np.array(FILTERED_COMMAND)
"""Rows of the initial state that hold the first numbers of a wave."""


def _harvest_row(name: str) -> int:
    """Return the row of a peak, by the name of its constant in `harvest`."""
    return getattr(_compiled(), name)


class TableResult(NamedTuple):
    """Results of the runs of a table."""

    batch: BatchResult
    """All figures."""
    peaks: dict[str, Float[np.ndarray, " n_runs"]]
    """Figures of `laticauda.trials.feasibility`, meaningless where a run diverged; empty if not asked for."""
    loads: KeptLoads | None = None
    """What is kept of the loads; None: not asked for."""


def run_columns(
    scenario: Scenario,
    columns: Columns,
    *,
    threads: int | None,
    progress: Progress = silent,
    with_peaks: bool,
    with_loads: bool = False,
    with_load_series: bool = False,
) -> TableResult:
    """Run a scenario with other values of some of its numbers.

    Args:
        scenario: What all runs share, of the planar model.
        columns: Values by the name of a parameter, one per run, as `check_columns` returns them.
        threads: Number of threads; None uses all cores that this process may use.
        progress: Called repeatedly with the completed share, from 0 to 1.
        with_peaks: Whether to compute the figures of `laticauda.trials.feasibility`.
        with_loads: Whether to compute those of what joints carry.
        with_load_series: Whether to keep these loads at all samples as well.
    """
    duration, sample_interval = scenario.duration, scenario.sample_interval
    if isinstance(scenario.motion, Gait):
        table = make_run_table(scenario, columns)
        if not with_loads:
            return run_table(
                table,
                duration,
                sample_interval,
                threads=threads,
                progress=progress,
                with_peaks=with_peaks,
            )
        runs = _list_runs(table)
    else:
        points = np.stack(list(columns.values()), axis=1)
        runs = runs_of(scenarios_at(scenario, tuple(columns), points), steered=True)
    kept_loads = None
    if with_loads:
        kept_loads = KeptLoads(len(runs), with_series=with_load_series)
    return run_with_peaks(
        runs,
        duration,
        sample_interval,
        threads=threads,
        progress=progress,
        with_peaks=with_peaks,
        kept_loads=kept_loads,
    )


def run_table(
    table: RunTable,
    duration: float,
    sample_interval: float,
    *,
    threads: int | None,
    progress: Progress = silent,
    with_peaks: bool,
) -> TableResult:
    """Run all runs of a table.

    Args:
        table: The runs.
        duration: Duration of every run [s].
        sample_interval: Sample interval of the logs used for the figures; the logs are not kept
            [s].
        threads: Number of threads; None uses all cores that this process may use.
        progress: Called repeatedly with the completed share, from 0 to 1.
        with_peaks: Whether to compute the figures of `laticauda.trials.feasibility`.
    """
    check_size(duration, sample_interval)
    if threads is not None:
        check_whole_number("threads", threads, 1)
    n_intervals = _count_intervals(duration, sample_interval)
    if not _can_be_harvested(table.bases, n_intervals, with_peaks=with_peaks):
        return run_with_peaks(
            _list_runs(table),
            duration,
            sample_interval,
            threads=threads,
            progress=progress,
            with_peaks=with_peaks,
        )
    harvest = _Harvest(table, duration, n_intervals, with_peaks=with_peaks)
    n_finished = 0
    for n_runs in harvest.run(threads or usable_cores()):
        n_finished += n_runs
        progress(n_finished / len(table))
    return harvest.results()


def _count_intervals(duration: float, sample_interval: float) -> int:
    """Return the number of samples of a run after the first."""
    return max(1, round(duration / sample_interval))


def _can_be_harvested(bases: Sequence[Run], n_intervals: int, *, with_peaks: bool) -> bool:
    """Return whether compiled code can evaluate the logs of runs, one call of the kernels each."""
    needs_log = any(map(_has_flow, bases))
    needs_log |= with_peaks and any(map(_has_dry_friction, bases))
    return n_intervals <= SAMPLES_PER_CALL and not needs_log


def _has_flow(run: Run) -> bool:
    """Return whether the water of a run moves otherwise than uniformly."""
    water = run.plant.environment
    return isinstance(water, Water) and water.flow is not None


def _has_dry_friction(run: Run) -> bool:
    """Return whether a joint of a run's robot has dry friction."""
    return any(joint.actuator.friction_torque > 0.0 for joint in run.plant.robot.driven_joints)


def _list_runs(table: RunTable) -> list[Run]:
    """Return an object for every run."""
    return [table.run(i) for i in range(len(table))]


def run_all(
    runs: Sequence[Run],
    duration: float,
    sample_interval: float,
    *,
    threads: int | None,
    progress: Progress = silent,
    device: str = CPU,
    with_peaks: bool,
    kept_loads: KeptLoads | None = None,
) -> TableResult:
    """Run a batch, as a table if gaits alone move its robots; arguments as for `run_with_peaks`."""
    if device == CPU and kept_loads is None and all(map(_is_moved_by_gait, runs)):
        table = table_of_runs(runs)
        n_intervals = _count_intervals(duration, sample_interval)
        if _can_be_harvested(table.bases, n_intervals, with_peaks=with_peaks):
            return run_table(
                table,
                duration,
                sample_interval,
                threads=threads,
                progress=progress,
                with_peaks=with_peaks,
            )
    return run_with_peaks(
        runs,
        duration,
        sample_interval,
        threads=threads,
        progress=progress,
        device=device,
        with_peaks=with_peaks,
        kept_loads=kept_loads,
    )


def _is_moved_by_gait(run: Run) -> bool:
    """Return whether a run's gait moves its robot, rather than a controller or references."""
    return run.controller is None and run.command.references is None


def run_with_peaks(
    runs: Sequence[Run],
    duration: float,
    sample_interval: float,
    *,
    threads: int | None,
    progress: Progress,
    device: str = CPU,
    with_peaks: bool,
    kept_loads: KeptLoads | None = None,
) -> TableResult:
    """Run a batch, and return its figures and the peaks of its joints.

    Args:
        runs: The runs.
        duration: Duration of every run [s].
        sample_interval: Sample interval of the logs [s].
        threads: Number of threads.
        progress: Called repeatedly with the completed share, from 0 to 1.
        device: cpu, or a device provided by an installed package, without peaks and loads.
        with_peaks: Whether to compute the peaks.
        kept_loads: Receives the loads; None: they are not computed.
    """
    peaks = {name: np.full(len(runs), np.nan) for name in NEEDS}
    has_loads = kept_loads is not None

    def keep(block_runs: Sequence[Run], block: Block) -> None:
        if with_peaks:
            for name, values in joint_peaks(block_runs, block).items():
                peaks[name][block.index] = values
        if kept_loads is not None:
            kept_loads.add(block_runs, block)

    batch = run_mixed_batch(
        runs,
        duration,
        sample_interval,
        threads=threads,
        progress=progress,
        device=device,
        observe=keep if with_peaks or has_loads else silent,
        with_joints=with_peaks,
        with_loads=has_loads,
    )
    return TableResult(batch, peaks if with_peaks else {}, kept_loads)


@cache
def _compiled() -> Any:
    """Return the compiled functions of `harvest`."""
    package = "laticauda.models.simulate"
    numbers = {"n_lanes": WIDTH, "most_postures": MOST_POSTURES}
    return specialized(package, {"harvest": tuple(numbers)}, numbers)


@dataclass
class _Buffers:
    """Memory of a thread's blocks."""

    log: np.ndarray
    """Log of a block."""
    rows: np.ndarray
    """Rows of a block."""


class _Harvest:
    """The results of a table's runs, which the computing threads fill in, each its own columns.

    Args:
        table: The runs.
        duration: Duration of every run [s].
        n_intervals: Number of samples after the first.
        with_peaks: Whether to compute the peaks of the joints.
    """

    def __init__(
        self, table: RunTable, duration: float, n_intervals: int, *, with_peaks: bool
    ) -> None:
        self.table = table
        self.duration = duration
        self.n_intervals = n_intervals
        self.with_peaks = with_peaks
        n_runs = len(table)
        sample_times = np.linspace(0.0, duration, n_intervals + 1)
        self.steady = batch_figures.Steady.at_frequencies(table.frequency, sample_times)
        self.numbers = np.full((batch_figures.N_SAMPLED_NUMBERS, n_runs), np.nan)
        self.numbers[batch_figures.WATER] = 0.0
        self.n_samples = np.zeros(n_runs, dtype=int)
        self.peaks = np.full((len(NEEDS), n_runs), np.nan)
        self._rows = [run.rows for run in table.bases]
        self._limits: dict[int, ScanLimits] = {}
        self._of_thread = local()
        self._command_offset = np.array([run.command.offset for run in table.bases])

    def run(self, n_threads: int) -> Iterator[int]:
        """Run everything; yield the number of runs that each task finished."""
        interval = self.duration / self.n_intervals
        kinds = list(kinds_of(self.table.bases, interval))
        with ThreadPoolExecutor(n_threads) as pool:
            for bases in kinds:
                yield from pool.map(self._run_task, self._tasks(bases, n_threads))

    def results(self) -> TableResult:
        """Return the results of all runs."""
        facts = self.table.facts()
        figures = batch_figures.compute_figures(facts, self.numbers, steady=self.steady)
        succeeded = self.n_samples == self.n_intervals + 1
        batch = BatchResult(
            figures={name: np.where(succeeded, values, np.nan) for name, values in figures.items()},
            succeeded=succeeded,
            status=self._statuses(succeeded),
        )
        peaks: dict[str, np.ndarray] = {}
        if self.with_peaks:
            peaks = dict(zip(NEEDS, self.peaks, strict=True))
        return TableResult(batch, peaks)

    def _statuses(self, succeeded: Bool[np.ndarray, " n_runs"]) -> tuple[str, ...]:
        """Return how each run ended."""
        status = [REACHED_END] * len(succeeded)
        for i in np.flatnonzero(~succeeded).tolist():
            time = float(self.n_samples[i]) * self.duration / self.n_intervals
            plant = self.table.base(i).plant
            status[i] = plant.describe_divergence(time)
        return tuple(status)

    def _tasks(self, bases: Sequence[int], n_threads: int) -> Iterator[np.ndarray]:
        """Yield indices of runs of some bases of one kind, those of one base together."""
        is_of_kind = np.zeros(len(self.table.bases), dtype=bool)
        is_of_kind[bases] = True
        members = np.flatnonzero(is_of_kind[self.table.base_of])
        members = members[np.argsort(self.table.base_of[members], kind="stable")]
        n_blocks = max(members.size // (4 * WIDTH * n_threads), 1)
        size = WIDTH * min(n_blocks, MOST_BLOCKS_PER_TASK)
        for first in range(0, members.size, size):
            yield members[first : first + size]

    def _run_task(self, task: np.ndarray) -> int:
        """Run a few blocks, and keep what is needed of them."""
        plant = self.table.base(int(task[0])).plant
        every = plant.steps_in(self.duration / self.n_intervals)
        n_steps = self.n_intervals * every
        dt = self.duration / self.n_intervals / every
        march = plant.kernels_of(WIDTH).run
        chain = plant.layout.chain
        n_rows = PATH_ROWS
        scan: _TaskScan | None = None
        if self.with_peaks:
            n_rows = plant.layout.sample_size
            scan = self._new_scan(task)
        buffers = self._buffers_of_thread(
            n_rows=self._rows[self.table.base_of[task[0]]].size, n_logged_rows=n_rows
        )
        log, block_rows = buffers.log, buffers.rows
        for first in range(0, task.size, WIDTH):
            index = task[first : first + WIDTH]
            self._fill(block_rows, index)
            march(block_rows, *chain, plant.is_implicit, n_steps, dt, every, log)
            self.n_samples[index] = block_rows[rows.SAMPLES, : index.size]
            _compiled().keep_path(log, block_rows, index, self.steady.before, self.numbers)
            if scan is not None:
                scan.add(log, first // WIDTH)
        if scan is not None:
            self.peaks[:, task] = scan.figures()
        self._keep_water(task, log[:, 0, 0])
        return task.size

    def _buffers_of_thread(self, *, n_rows: int, n_logged_rows: int) -> "_Buffers":
        """Return the memory of this thread's blocks, which one task after the other uses."""
        buffers: _Buffers | None = getattr(self._of_thread, "buffers", None)
        log_shape = (1 + self.n_intervals, n_logged_rows, WIDTH)
        is_fit = buffers is not None and buffers.rows.shape[0] == n_rows
        if buffers is None or not is_fit or buffers.log.shape != log_shape:
            buffers = _Buffers(aligned(log_shape, float), aligned((n_rows, WIDTH), float))
            self._of_thread.buffers = buffers
        return buffers

    def _fill(self, block_rows: np.ndarray, index: np.ndarray) -> None:
        """Write the rows of runs into the lanes of a block; the last run fills what lanes are left."""
        first = int(self.table.base_of[index[0]])
        is_one_base = self.table.base_of[index[-1]] == first  # the runs of one base are together
        has_waves = self.table.bases[first].command.references is None
        if is_one_base and has_waves:
            _compiled().fill_lanes(
                self._rows[first],
                self._command_offset[first],
                self.table.waves,
                _FILTERED_COMMAND,
                COMMAND.start,
                index,
                block_rows,
            )
            return
        lanes = np.resize(index, WIDTH)
        lanes[index.size :] = index[-1]
        bases = self.table.base_of[lanes]
        for lane, base in enumerate(bases.tolist()):
            block_rows[:, lane] = self._rows[base]
        if has_waves:
            waves = self.table.waves[:, lanes]
            block_rows[COMMAND] = waves
            block_rows[FILTERED_COMMAND] = waves[: len(FILTERED_COMMAND)]
            block_rows[rows.OFFSET] += self._command_offset[bases]

    def _keep_water(self, task: np.ndarray, time: np.ndarray) -> None:
        """Write how far the water moved, see `water_paths.sample_water`; it moves uniformly."""
        bases = self.table.base_of[task]
        for base in set(map(int, bases)):
            water = self.table.bases[base].plant.environment
            if not isinstance(water, Water) or not np.any(water.uniform[:2]):
                continue
            velocity = np.broadcast_to(np.array(water.uniform[:2]), (time.size, 2))
            displacement = metrics.cumulative_integral(time, velocity)
            runs = task[bases == base]
            before = self.steady.before[runs]
            kept = (
                np.broadcast_to(displacement[-1], (runs.size, 2)),
                displacement[before],
                velocity[before],
                displacement[before + 1],
                velocity[before + 1],
            )
            self.numbers[batch_figures.WATER, runs] = np.concatenate(kept, axis=1).T

    def _new_scan(self, task: np.ndarray) -> "_TaskScan":
        """Return what finds the peaks of the joints of a task."""
        bases = [self.table.base(i) for i in task.tolist()]
        limits = [self._limits_of(base) for base in bases]
        periods = periods_of(self.table.frequency[task])
        return _TaskScan(bases[0].plant.layout, limits, periods, self.n_intervals)

    def _limits_of(self, base: Run) -> ScanLimits:
        """Return the limits of a base's robot; those of one robot are computed once."""
        robot = base.plant.robot
        if id(robot) not in self._limits:
            self._limits[id(robot)] = ScanLimits.of(robot)
        return self._limits[id(robot)]


class _TaskScan:
    """Finds the peaks of the joints of a task's runs.

    Args:
        layout: Layout of the runs' robots.
        limits: Limits of each run's robot.
        periods: Gait periods of the runs; nan where one stands still [s].
        n_intervals: Number of samples after the first.
    """

    def __init__(
        self,
        layout: Layout,
        limits: Sequence[ScanLimits],
        periods: Float[np.ndarray, " n_runs"],
        n_intervals: int,
    ) -> None:
        self._limits = limits
        self._periods = periods
        n_missing = -len(limits) % WIDTH
        lanes = [*limits, *[limits[-1]] * n_missing]
        self._stall_torque = _in_blocks(lanes, "stall_torque")
        self._duty_per_rate = _in_blocks(lanes, "duty_per_rate")
        self._joint_limit = _in_blocks(lanes, "joint_limit")
        self._no_load_speed = _in_blocks(lanes, "no_load_speed")
        self._length = _in_blocks(lanes, "length").swapaxes(1, 2).copy()
        self._half_width = _in_blocks(lanes, "half_width").swapaxes(1, 2).copy()
        smallest_curl = [run.smallest_crossing_curl for run in lanes]
        self._smallest_crossing_curl = np.array(smallest_curl).reshape(-1, WIDTH)
        self._crosses = np.zeros(WIDTH, dtype=bool)
        robot = limits[0].robot
        self._n_joints = robot.n_joints
        self._columns = _columns_of_driven_joints(layout, robot)
        n_driven = self._columns.shape[1]
        n_blocks = len(self._stall_torque)
        self._curl = np.empty((n_intervals + 2, WIDTH))
        self._peaks = np.empty((n_blocks, _N_PEAKS, n_driven, WIDTH))
        self._first: np.ndarray | None = None
        """First sample of each run that counts; None before any is known."""
        self._utilization = np.zeros((n_blocks, WIDTH))

    def add(self, log: np.ndarray, block: int) -> None:
        """Find the peaks of a block.

        Args:
            log: Its log.
            block: Its index in the task.
        """
        if self._first is None:
            first = count_unsettled_samples(log[:, 0, 0], self._periods)
            self._first = np.resize(first.astype(float), self._utilization.shape)
        some_may_cross = _compiled().find_peaks(
            log,
            block,
            self._columns,
            self._first,
            self._stall_torque,
            self._duty_per_rate,
            self._joint_limit,
            self._no_load_speed,
            self._n_joints,
            self._length,
            self._half_width,
            self._smallest_crossing_curl,
            self._peaks,
            self._curl,
            self._utilization,
            self._crosses,
        )
        if some_may_cross:
            for lane in np.flatnonzero(self._crosses).tolist():
                self._include_crossing(log, block, lane)

    def figures(self) -> Float[np.ndarray, "n_figures n_runs"]:
        """Return the figures of the runs, in the order of `NEEDS`."""
        n_runs = len(self._limits)
        # Row, joint, run.
        peaks = np.moveaxis(self._peaks, 0, 2).reshape(*self._peaks.shape[1:3], -1)[:, :, :n_runs]
        utilization = include_neighbors(
            self._limits,
            self._utilization.ravel()[:n_runs],
            peaks[_harvest_row("ANGLE"), : self._n_joints],
        )
        largest = [
            peaks[_harvest_row(name)].max(axis=0, initial=0.0)
            for name in ("ANGLE", "RATE", "TORQUE")
        ]
        return np.stack([*largest, utilization])

    def _include_crossing(self, log: np.ndarray, block: int, lane: int) -> None:
        """Raise the utilization of a run that curls to that of links that cross."""
        run = block * WIDTH + lane
        if run >= len(self._limits):
            return
        limits = self._limits[run]
        curls = self._curl[:-1, lane] >= limits.smallest_crossing_curl
        body = slice(self._columns[0, 0], self._columns[0, 0] + self._n_joints)
        overlap = measure_crossing(limits.robot, log[spread_evenly(curls), body, lane])
        self._utilization[block, lane] = max(self._utilization[block, lane], overlap.share)


def _in_blocks(
    lanes: Sequence[ScanLimits], name: str
) -> Float[np.ndarray, "n_blocks n_numbers n_lanes"]:
    """Return a field of the limits of all lanes, by block."""
    n_blocks = len(lanes) // WIDTH
    first = lanes[0]
    if all(limits is first for limits in lanes):
        block = np.repeat(getattr(first, name)[:, np.newaxis], WIDTH, axis=1)
        return np.repeat(block[np.newaxis], n_blocks, axis=0)
    numbers = np.stack([getattr(limits, name) for limits in lanes])
    in_blocks = numbers.reshape(n_blocks, WIDTH, -1)
    return np.ascontiguousarray(in_blocks.transpose(0, 2, 1))


def _columns_of_driven_joints(layout: Layout, robot: Robot) -> Int[np.ndarray, "3 n_driven"]:
    """Return the columns of angles, rates and torques in a sample, those of a driven fin last."""
    joints = np.arange(layout.tail_link, layout.n_joints)
    if len(robot.driven_joints) > robot.n_joints:
        joints = np.append(joints, layout.tail_link - 1)
    columns = [
        sample_format.columns_of_joints(row, layout.n_joints).start + joints
        for row in (rows.ANGLE, rows.RATE, rows.TORQUE)
    ]
    return np.stack(columns)
