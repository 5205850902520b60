"""Runs that controllers steer, side by side.

Runs of one kind whose controllers decide at the same times are a fleet: at every control instant all
of its controllers decide, by arrays if they are written so, and then all robots swim on together. The
results are those of the runner, run by run.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields, replace
from functools import cached_property
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np

from laticauda.models.dynamics.sampled_loads import FORCES, SampledLoads
from laticauda.models.dynamics.school import usable_cores
from laticauda.models.planar import (
    PATH_ROWS,
    Block,
    Fleet,
    LoggedLeg,
    NeedsRunOfItsOwn,
    PlanarPlant,
    Run,
    block_of,
    kinds_of,
    march_many,
    rows,
)
from laticauda.models.simulate.batch_run import CPU, BatchResult, BlockObserver, run_batch
from laticauda.models.simulate.runner import Progress, run_samples, silent
from laticauda.models.simulate.timeline import (
    CommandQueue,
    Leg,
    Span,
    count_samples_of_run,
    split_run,
    split_span,
)
from laticauda.scenarios import (
    Controller,
    Decisions,
    Observation,
    Observations,
    Scenario,
    check_decisions,
    kind_of_controller,
    vectorize,
)
from laticauda.sensing import BodyLoads
from laticauda.values import DIRECTIONS, check_choice

Result = TypeVar("Result")

LARGEST_FLEET = 512
"""Robots of a fleet at most: enough for arrays to pay off."""
SMALLEST_FLEET = 64
"""Robots of a fleet that is not shared by more threads."""
LOG_BYTES = 64_000_000
"""Memory that the log of a fleet may take, unless it has very few robots."""
NUMBERS_PER_LINK = len(FORCES) * 2 + 3 * len(DIRECTIONS)
"""Numbers per sample that loads take per link: forces on it, in its joint, and of the water."""
LEAST_LANES = 8
"""Robots of a fleet at least, however long its log."""


class Sampling(NamedTuple):
    """When the robots of a fleet are seen, and when their log has samples."""

    n_intervals: int
    """Number of control intervals."""
    samples_per_interval: int
    """Number of samples in each."""

    @property
    def n_samples(self) -> int:
        """Number of samples after the first."""
        return self.n_intervals * self.samples_per_interval

    @classmethod
    def of(cls, controller: Controller[Any], duration: float, sample_interval: float) -> "Sampling":
        """Return the sampling of a run.

        Args:
            controller: Controller that steers.
            duration: Duration of the run [s].
            sample_interval: Time between two samples, not yet adjusted [s].
        """
        counts = count_samples_of_run(duration, sample_interval, controller.interval)
        return cls(*counts)


def run_mixed_batch(
    runs: Sequence[Run],
    duration: float,
    sample_interval: float,
    *,
    threads: int | None,
    progress: Progress,
    device: str = CPU,
    observe: BlockObserver = silent,
    with_joints: bool = False,
    with_loads: bool = False,
) -> BatchResult:
    """Run a batch in which some runs may have controllers; arguments as for `run_batch`.

    Those whose logs have other samples, because they must divide the control interval, are batches
    of their own.
    """
    batches = _split_by_sampling(runs, duration, sample_interval)
    if list(batches) == [None]:
        return run_batch(
            runs,
            duration,
            sample_interval,
            threads=threads,
            progress=progress,
            device=device,
            observe=observe,
            with_joints=with_joints,
            with_loads=with_loads,
        )
    check_choice("device", device, (CPU,))
    results: list[BatchResult] = []
    n_finished = 0
    for sampling, members in batches.items():

        def report(share: float, n_before: int = n_finished, n: int = len(members)) -> None:
            progress((n_before + share * n) / len(runs))

        def observe_members(
            block_runs: Sequence[Run], block: Block, members: np.ndarray = members
        ) -> None:
            observe(block_runs, replace(block, index=members[block.index]))

        own_interval = sample_interval
        if sampling is not None:
            own_interval = duration / sampling.n_samples
        result = run_batch(
            [runs[int(i)] for i in members],
            duration,
            own_interval,
            threads=threads,
            progress=report,
            observe=observe_members,
            with_joints=with_joints,
            with_loads=with_loads,
            march=march_many if sampling is None else march_steered,
        )
        results.append(result)
        n_finished += len(members)
    return _join_results(list(batches.values()), results)


def _split_by_sampling(
    runs: Sequence[Run], duration: float, sample_interval: float
) -> dict[Sampling | None, np.ndarray]:
    """Return the indices of the runs with each sampling; None: without a controller."""
    members: dict[Sampling | None, list[int]] = {}
    for i, run in enumerate(runs):
        sampling = None
        if run.controller is not None:
            sampling = Sampling.of(run.controller, duration, sample_interval)
        members.setdefault(sampling, []).append(i)
    return {sampling: np.array(indices) for sampling, indices in members.items()}


def _join_results(members: Sequence[np.ndarray], results: Sequence[BatchResult]) -> BatchResult:
    """Return the results of several batches as those of one, in the order of its runs."""
    n = sum(map(len, members))
    figures = {name: np.full(n, np.nan) for name in results[0].figures}
    succeeded = np.zeros(n, dtype=bool)
    status = [""] * n
    for indices, result in zip(members, results, strict=True):
        succeeded[indices] = result.succeeded
        for name, values in result.figures.items():
            figures[name][indices] = values
        for i, words in zip(indices, result.status, strict=True):
            status[i] = words
    return BatchResult(figures=figures, succeeded=succeeded, status=tuple(status))


def march_steered(
    runs: Sequence[Run],
    duration: float,
    sample_interval: float,
    use: Callable[[Block], Result],
    *,
    threads: int | None = None,
    with_joints: bool = False,
    with_loads: bool = False,
) -> Iterator[Result]:
    """Simulate every run for `duration` and pass the results to `use`, as `planar.batch.march_many` does.

    Args:
        runs: Runs with controllers, all with the same `Sampling`.
        duration: Duration of every run [s].
        sample_interval: Time between two samples [s]; adjusted so that it divides the control
            interval.
        use: Function that is called once per block, in the computing threads.
        threads: Number of threads; None: one per core that this process may use.
        with_joints: Whether to log everything that the kernels can log, including the joints.
        with_loads: Whether to compute the loads at every sample, for which everything is logged.

    Yields:
        Return values of `use`, in no particular order of runs.
    """
    n_threads = threads or usable_cores()

    def work(members: np.ndarray) -> list[Result]:
        member_runs = [runs[int(i)] for i in members]
        try:
            fleet = swim_fleet(
                member_runs,
                duration,
                sample_interval,
                with_joints=with_joints,
                with_loads=with_loads,
            )
        except NeedsRunOfItsOwn:
            return [
                use(_swim_alone(run, int(i), duration, sample_interval, with_loads=with_loads))
                for run, i in zip(member_runs, members, strict=True)
            ]
        return [use(block) for block in fleet.blocks(members)]

    fleets = split_into_fleets(
        runs,
        duration,
        sample_interval,
        n_threads=n_threads,
        with_joints=with_joints,
        with_loads=with_loads,
    )
    with ThreadPoolExecutor(n_threads) as pool:
        for results in pool.map(work, fleets):
            yield from results


def swim_fleet(
    runs: Sequence[Run],
    duration: float,
    sample_interval: float,
    *,
    with_joints: bool,
    with_loads: bool,
) -> Fleet:
    """Return a fleet after its whole run.

    Args:
        runs: Runs of one kind with controllers that decide at the same times.
        duration: Duration of the run [s].
        sample_interval: Time between two samples, not yet adjusted [s].
        with_joints: Whether to log the joints as well.
        with_loads: Whether to log joints and loads as well.
    """
    (fleet,) = swim_fleets(
        [runs], duration, sample_interval, with_joints=with_joints, with_loads=with_loads
    )
    return fleet


def swim_fleets(
    runs_of_fleets: Sequence[Sequence[Run]],
    duration: float,
    sample_interval: float,
    *,
    with_joints: bool,
    with_loads: bool = False,
    watch: Callable[[Observations, Mapping[str, np.ndarray]], np.ndarray] | None = None,
) -> list[Fleet]:
    """Return fleets after their whole run; the controllers of all decide together.

    Args:
        runs_of_fleets: For each fleet, runs of one kind; the controllers of all are of one kind and
            decide at the same times.
        duration: Duration of the run [s].
        sample_interval: Time between two samples, not yet adjusted [s].
        with_joints: Whether to log the joints as well.
        with_loads: Whether to log joints and loads as well.
        watch: Called after every control instant with what was observed of all robots and the signals
            of their controllers; robots for which it returns True swim no more, and the run ends when
            none does.
    """
    controllers: list[Controller[Any]] = []
    for runs in runs_of_fleets:
        controllers += [cast("Controller[Any]", run.controller) for run in runs]
    interval = controllers[0].interval
    sampling = Sampling.of(controllers[0], duration, sample_interval)
    steering = vectorize(controllers)
    members = [
        _Member(Fleet(runs, sampling.n_samples, with_joints=with_joints, with_loads=with_loads))
        for runs in runs_of_fleets
    ]
    ends = np.cumsum([member.fleet.n for member in members]).tolist()
    n_logged = 0
    now = 0.0
    for span in split_run(duration, sample_interval, interval):
        if span.begins_at_control_instant:
            observations = _join_observations([member.fleet.observe() for member in members])
            decisions = steering.step(observations)
            if isinstance(decisions, Mapping):
                decisions = check_decisions(decisions, observations.is_well)
            for member, end in zip(members, ends, strict=True):
                part = _part_of_decisions(decisions, slice(end - member.fleet.n, end))
                member.commands.add(now, part)
            if watch is not None:
                has_ended = watch(observations, steering.signals)
                if has_ended.any():
                    _retire(members, ends, has_ended)
                if np.all(has_ended | ~observations.is_well):
                    break
        for member in members:
            member.march(now, span, n_logged)
        n_logged += span.n_samples
        now = span.end
        if not any(member.fleet.any_swims for member in members):
            break
    return [member.fleet for member in members]


def _retire(members: "Sequence[_Member]", ends: Sequence[int], has_ended: np.ndarray) -> None:
    """Let robots that have come to their end swim no more."""
    for member, end in zip(members, ends, strict=True):
        fleet = member.fleet
        fleet.retire(has_ended[end - fleet.n : end])


class _Member:
    """A fleet and its commands.

    Args:
        fleet: The fleet.
    """

    def __init__(self, fleet: Fleet) -> None:
        self.fleet = fleet
        first_commands: Decisions = [run.command for run in fleet.runs]
        delay = fleet.plant.settings.loop_delay
        self.commands = CommandQueue[Decisions](first_commands, delay=delay)

    def march(self, now: float, span: Span, n_logged: int) -> None:
        """Let the fleet swim for a span, of whose log `n_logged` is the first sample."""
        for leg in _logged_legs(split_span([self.commands], now, span), span, n_logged):
            self.fleet.command(self.commands.acting(now, leg.begin))
            self.fleet.march(leg.logged)


def _join_observations(fleets: Sequence[Observations]) -> Observations:
    """Return the observations of several fleets as those of one."""
    if len(fleets) == 1:
        return fleets[0]
    return _JoinedObservations(fleets)


class _JoinedObservations(Observations):
    """The observations of several fleets, one after the other.

    Args:
        fleets: Observations of each fleet.
    """

    def __init__(self, fleets: Sequence[Observations]) -> None:
        self._fleets = fleets
        fleet_and_robot: list[tuple[Observations, int]] = []
        for fleet in fleets:
            fleet_and_robot += [(fleet, robot) for robot in range(len(fleet))]

        def observe(i: int) -> Observation:
            fleet, robot = fleet_and_robot[i]
            return fleet.of_robot(robot)

        super().__init__(
            time=self.collect("time"),
            center_of_mass=self.collect("center_of_mass"),
            center_of_mass_velocity=self.collect("center_of_mass_velocity"),
            heading=self.collect("heading"),
            heading_rate=self.collect("heading_rate"),
            is_well=self.collect("is_well"),
            observe=observe,
        )

    def collect(self, name: str) -> np.ndarray:
        """Return a field of all observations, one row per robot.

        Args:
            name: Its name.
        """
        return np.concatenate([getattr(fleet, name) for fleet in self._fleets])

    @cached_property
    def loads(self) -> BodyLoads:
        """What links and joints bear, one row per robot."""
        columns: dict[str, np.ndarray] = {}
        for quantity in fields(BodyLoads):
            tables = [getattr(fleet.loads, quantity.name) for fleet in self._fleets]
            columns[quantity.name] = np.concatenate(tables)
        return BodyLoads(**columns)


def _part_of_decisions(decisions: Decisions, robots: slice) -> Decisions:
    """Return what some of the robots are to do."""
    if isinstance(decisions, Mapping):
        return {name: values[robots] for name, values in decisions.items()}
    return decisions[robots]


def _swim_alone(
    run: Run, index: int, duration: float, sample_interval: float, *, with_loads: bool
) -> Block:
    """Return the results of a run that no fleet can hold."""
    plant = run.plant
    controller = cast("Controller[Any]", run.controller)
    scenario = Scenario(
        robot=plant.robot,
        motion=controller,
        environment=plant.environment,
        model=plant.settings,
        start=run.start,
        duration=duration,
        sample_interval=sample_interval,
    )
    alone = run_samples(scenario, plant, link_forces=with_loads)
    samples = alone.samples
    n_samples = 1 + Sampling.of(controller, duration, sample_interval).n_samples
    log = np.full((n_samples, samples.shape[1], 1), np.nan)
    log[:, 0, 0] = np.linspace(0.0, duration, n_samples)
    log[: len(samples), :, 0] = samples
    last_rows = np.zeros((rows.HEADER_ROWS, 1))
    last_rows[rows.TIME : rows.TIME + rows.LOG_STATE, 0] = samples[-1, : rows.LOG_STATE]
    loads = None
    if with_loads:
        loads = (alone.loads or _no_loads(plant, len(samples)),)
    return block_of(np.array([index]), log, last_rows, np.array([len(samples)]), loads)


def _no_loads(plant: PlanarPlant, n_samples: int) -> SampledLoads:
    """Return what takes the place of the loads of a run that diverged."""
    return SampledLoads.zeros(n_samples=n_samples, n_links=plant.robot.n_links, n_axes=2)


class _CommandedLeg(NamedTuple):
    """A leg, with its place in the log."""

    begin: float
    """Its begin after that of the span [s]."""
    logged: LoggedLeg
    """What the fleet needs to know of it."""


def _logged_legs(legs: Iterable[Leg], span: Span, first: int) -> Iterator[_CommandedLeg]:
    """Yield the legs of a span, whose log begins with the sample `first`."""
    begins_at_sample = True
    for leg in legs:
        duration = leg.end - leg.begin
        n_intervals = max(1, round(duration / leg.sample_interval))
        logged = LoggedLeg(
            duration=duration,
            n_intervals=n_intervals,
            first=first,
            begins_at_sample=begins_at_sample,
            ends_at_sample=leg.ends_at_sample,
        )
        yield _CommandedLeg(leg.begin, logged)
        begins_at_sample = leg.ends_at_sample
        if leg.ends_at_sample:
            first += n_intervals


def split_into_fleets(
    runs: Sequence[Run],
    duration: float,
    sample_interval: float,
    *,
    n_threads: int,
    with_joints: bool,
    with_loads: bool = False,
) -> Iterator[np.ndarray]:
    """Yield the indices of the runs of every fleet.

    Args:
        runs: Runs with controllers, all with the same `Sampling`.
        duration: Duration of every run [s].
        sample_interval: Time between two samples, not yet adjusted [s].
        n_threads: Number of threads that share the fleets.
        with_joints: Whether the joints are logged as well.
        with_loads: Whether the loads are logged as well.
    """
    first = cast("Controller[Any]", runs[0].controller)
    sampling = Sampling.of(first, duration, sample_interval)
    for members in _kinds_of_fleets(runs, duration / sampling.n_samples):
        plant = runs[members[0]].plant
        n_rows = plant.layout.sample_size if with_joints else PATH_ROWS
        if with_loads:
            n_rows = plant.layout.sample_size + NUMBERS_PER_LINK * plant.robot.n_links
        bytes_of_log = 8 * n_rows * (1 + sampling.n_samples)
        size = min(LARGEST_FLEET, max(LEAST_LANES, LOG_BYTES // bytes_of_log))
        size = min(size, max(SMALLEST_FLEET, -(-len(members) // n_threads)))
        for begin in range(0, len(members), size):
            yield np.array(members[begin : begin + size])


def _kinds_of_fleets(runs: Sequence[Run], interval: float) -> Iterable[list[int]]:
    """Group the indices of runs that can be one fleet; `interval` is the sample interval [s]."""
    kinds: dict[object, list[int]] = {}
    for members in kinds_of(runs, interval):
        for i in members:
            run = runs[i]
            controller = cast("Controller[Any]", run.controller)
            settings = run.plant.settings
            key = (
                members[0],
                kind_of_controller(controller),
                controller.interval,
                settings.loop_delay,
                run.plant.dt,
            )
            kinds.setdefault(key, []).append(i)
    return kinds.values()
