"""`swim_many`: the figures of many trials, computed side by side and on all cores."""

import functools
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TypeVar, Unpack, cast

import numpy as np
from jaxtyping import Bool, Float, Inexact

from laticauda.errors import BadArgument, instance, one_of, whole
from laticauda.gaits import Gait
from laticauda.interfaces import Command, OpenLoop, Start
from laticauda.planar import rows
from laticauda.planar.batch import STEP, Block, Run, march_many
from laticauda.planar.model import PlanarPlant
from laticauda.robot import Environment, Ground, Robot, Water, has_power_model
from laticauda.scenarios import ModelChanges, Planar, Scenario, Spatial, default_water, scenario
from laticauda.simulate.numbers import UNITS
from laticauda.simulate.plants import plant
from laticauda.simulate.runner import Progress, check_size
from laticauda.simulate.several import swim_each
from laticauda.trial import Trial, feasibility, metrics
from laticauda.trial.cycles import hermite, steady_part

DEVICES = ("cpu", "cuda")
Item = TypeVar("Item")
Figure = Float[np.ndarray, " n_trials"]
Look = Callable[[Sequence[Run], Block], None]
"""What is done with the runs of a block and what they left behind."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Swims:
    """Figures of many trials, in the order in which they were asked for; each means what it means in a `Trial`.

    A figure is nan where a trial has none: all of them where the trial diverged, `steady_velocity` also where the trial
    is too short for its gait, `cost_of_transport` where the robot did not move.
    """

    forward_velocity: Figure
    """Straight-line displacement / time over the whole run (5) [m/s]."""
    steady_velocity: Figure
    """The same over whole gait cycles after the first third of the run and 10 s [m/s]."""
    mechanical_power: Figure
    """Mean of sum |u phi'| [W]."""
    net_power: Figure
    """Mean of sum u phi' [W]."""
    positive_power: Figure
    """Mean of sum max(u phi', 0) [W]."""
    mean_power: Figure
    """Electrical power with servo joints or a `Robot.active_power`, else the mechanical one [W]."""
    cost_of_transport: Figure
    """`mean_power` / (weight of the displaced water x `forward_velocity`) [-]."""
    center_of_mass: Float[np.ndarray, "n_trials n_axes"]
    """At the end [m]."""
    heading: Figure
    """At the end [rad]."""
    succeeded: Bool[np.ndarray, " n_trials"]
    """Whether the trial reached its end."""
    status: tuple[str, ...]
    """How it ended."""

    def __len__(self) -> int:
        """Number of trials."""
        return len(self.status)


def swim_many(
    robots: Sequence[Scenario] | Robot | Sequence[Robot],
    gaits: Gait | Sequence[Gait] | None = None,
    duration: float = 30.0,
    *,
    environments: Environment | Sequence[Environment] | None = None,
    starts: Start | Sequence[Start] | None = None,
    sample_interval: float = 0.05,
    threads: int | None = None,
    device: str = "cpu",
    progress: Progress | None = None,
    **changes: Unpack[ModelChanges],
) -> Swims:
    """Run many scenarios of one model; or let many robots swim, each from straight and at rest.

    Trial i is what `swim` makes of the i-th of everything; where one thing is given instead of a sequence, all trials
    share it. Planar robots of equal shape are computed eight at a time, so a sweep over gaits, waters or sizes gains
    most; any mixture is allowed, and the figures agree with those of `swim` to rounding. Spatial ones run one by one on
    every thread, and their figures are those of `swim` to the last bit. Neither depends on what else is in the batch,
    nor on the number of threads.

    Args:
        robots: The scenarios, all planar or all spatial; planar ones have no controllers, and are of one duration and
            sample interval. Or what swims, with their gaits.
        gaits: What the joints are asked for.
        duration: Of every trial [s].
        environments: Waters or grounds; None takes `default_water` of each robot and gait.
        starts: Where each begins; None: at the origin, along x.
        sample_interval: Of the logs that the figures are taken from; they are not kept [s].
        threads: How many to compute with; None takes all cores that this process may use.
        device: cpu, or cuda for a GPU, one planar trial per thread of it: it needs the extra `gpu`, and pays for
            thousands of trials.
        progress: Called now and then with the share that is finished, from 0 to 1.
        changes: Of the model, see `laticauda.scenarios.ModelChanges`. A fluid law that branches with `if` works, but
            takes its lanes one by one.

    Returns:
        The figures, as arrays.

    Raises:
        ValueError: If an argument is out of its range, or sequences differ in length, or there is no GPU.
        MissingExtra: If numba-cuda is not installed and `device` asks for it.

    Example:
        >>> import laticauda as lc
        >>> gaits = [lc.eel_like(amplitude=a, frequency=2.0, phase_shift=0.7) for a in (0.4, 0.5, 0.6)]
        >>> lc.swim_many(lc.load_robot("mamba"), gaits).forward_velocity.round(3)
        array([0.066, 0.091, 0.116])
    """
    scenarios = batch_of(robots, gaits, environments, starts, duration, sample_interval, **changes)
    if scenarios and isinstance(getattr(scenarios[0], "model", None), Spatial):
        one_of("device", device, DEVICES[:1])
        found = swum(scenarios, threads, progress)
    else:
        runs = runs_of(scenarios)
        found = collected(runs, scenarios[0].duration, scenarios[0].sample_interval, threads, progress, device=device)
    named = dict(found.figures)
    end = np.stack([named.pop(axis) for axis in "xyz" if axis in named], axis=1)
    return Swims(**named, center_of_mass=end, succeeded=found.succeeded, status=found.status)


def swum(scenarios: Sequence[Scenario], threads: int | None, progress: Progress | None) -> "Collected":
    """The figures of spatial scenarios, and `z`; arguments as for `swim_many`."""
    names = (*UNITS, "z")

    def figures(trial: Trial) -> tuple[list[float], bool, str]:
        found: dict[str, float] = {
            "heading": trial.heading[-1],
            **dict(zip("xyz", trial.center_of_mass[-1], strict=True)),
        }
        for name in UNITS.keys() - found.keys():
            with suppress(ValueError):  # it has no meaning for this trial
                found[name] = getattr(trial, name)
        numbers = [found.get(name, np.nan) if trial.succeeded else np.nan for name in names]
        return numbers, trial.succeeded, trial.status

    for i, one in enumerate(scenarios):
        instance(f"scenarios[{i}].model", one.model, Spatial)
    numbers, succeeded, status = zip(*swim_each(scenarios, figures, threads=threads, progress=progress), strict=True)
    by_name = dict(zip(names, np.array(numbers).T, strict=True))
    return Collected(figures=by_name, succeeded=np.array(succeeded), status=status)


def batch_of(
    robots: Sequence[Scenario] | Robot | Sequence[Robot],
    gaits: Gait | Sequence[Gait] | None,
    environments: Environment | Sequence[Environment] | None = None,
    starts: Start | Sequence[Start] | None = None,
    duration: float = 30.0,
    sample_interval: float = 0.05,
    **changes: Unpack[ModelChanges],
) -> Sequence[Scenario]:
    """The scenarios of a batch; arguments as for `swim_many`."""
    if gaits is None:
        return cast("Sequence[Scenario]", robots)
    given = {"robots": robots, "gaits": gaits, "environments": environments, "starts": starts}
    n = _common_length(given)
    every_robot = _each("robots", cast("Robot | Sequence[Robot]", robots), n, Robot)
    every_gait = _each("gaits", gaits, n, Gait)
    every_start = _each("starts", Start() if starts is None else starts, n, Start)
    if environments is None:
        every_environment: Sequence[Environment] = list(map(default_water, every_robot, every_gait))
    else:
        every_environment = _each("environments", environments, n, Water, Ground)
    base = scenario(every_robot[0], every_gait[0], duration, sample_interval=sample_interval, **changes)
    parts = zip(every_robot, every_gait, every_environment, every_start, strict=True)
    return [replace(base, robot=r, motion=g, environment=e, start=s) for r, g, e, s in parts]


def runs_of(scenarios: Sequence[Scenario]) -> list[Run]:
    """The runs of a batch, with one plant for all that share robot, environment and model.

    Args:
        scenarios: All planar, of one duration and sample interval.

    Raises:
        ValueError: If they are not.
    """
    instance("scenarios", scenarios, Sequence)
    if not scenarios:
        raise BadArgument("scenarios", "must hold at least one item, got none")
    plants: dict[tuple[int, int, int], PlanarPlant] = {}
    runs: list[Run] = []
    for i, one in enumerate(scenarios):
        key = id(one.robot), id(one.environment), id(one.model)  # the scenarios keep them alive
        if key not in plants:
            instance(f"scenarios[{i}].model", one.model, Planar)
            plants[key] = cast(PlanarPlant, plant(one))
        for name in ("duration", "sample_interval"):
            if getattr(one, name) != getattr(scenarios[0], name):
                raise BadArgument(name, f"must be the same in all scenarios, got {getattr(one, name):g} s too")
        instance(f"scenarios[{i}].motion", one.motion, Gait, OpenLoop)
        command = one.motion.command if isinstance(one.motion, OpenLoop) else Command(gait=one.gait)
        instance(f"scenarios[{i}].start", one.start, Start)
        runs.append(Run(plant=plants[key], command=command, start=cast(Start, one.start)))
    return runs


@dataclass(frozen=True, kw_only=True, eq=False)
class Collected:
    """All figures of a batch; complex if its runs have slopes (see `Run`)."""

    figures: Mapping[str, Inexact[np.ndarray, " n_runs"]]
    """By name, nan where a run has none."""
    succeeded: Bool[np.ndarray, " n_runs"]
    """Whether the run reached its end."""
    status: tuple[str, ...]
    """How it ended."""


def collected(
    runs: Sequence[Run],
    duration: float,
    sample_interval: float,
    threads: int | None,
    progress: Progress | None,
    *,
    weights: Inexact[np.ndarray, " n_runs"] | None = None,
    device: str = "cpu",
    look: Look | None = None,
    with_joints: bool = False,
) -> Collected:
    """Run a batch, and put all blocks' figures where they belong.

    Args:
        runs: What swims how.
        duration: See `swim_many` [s].
        sample_interval: See `swim_many` [s].
        threads: See `swim_many`.
        progress: See `swim_many`.
        weights: What the robots carry [N]; complex if their runs have slopes.
        device: See `swim_many`.
        look: Called once per block, in the threads that compute, before the next one overwrites its log; cpu only.
        with_joints: Whether it finds what the joints did in the log, too.
    """
    check_size(duration, sample_interval)
    if threads is not None:
        whole("threads", threads, 1)
    march = functools.partial(march_many, with_joints=with_joints)
    if one_of("device", device, DEVICES) == "cuda":
        from laticauda.planar.cuda import march_many as march_on_gpu

        march = march_on_gpu
    n, carried = len(runs), weights
    if carried is None:
        weight = {id(run.plant): metrics.carried_weight(run.plant.robot, run.plant.environment) for run in runs}
        carried = np.array([weight[id(run.plant)] for run in runs])
    numbers = np.full((len(UNITS), n), np.nan, dtype=carried.dtype)
    succeeded, status = np.zeros(n, dtype=bool), ["The run reached its end."] * n

    def figures(block: Block) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
        mine = [runs[int(i)] for i in block.index]
        if look is not None:
            look(mine, block)
        return block.index, block.n_samples, _figures(mine, carried[block.index], block)

    n_intervals = max(1, round(duration / sample_interval))
    finished = 0
    for index, n_samples, found in march(runs, duration, sample_interval, figures, threads=threads):
        well = n_samples == n_intervals + 1
        succeeded[index] = well
        for row, name in enumerate(UNITS):
            numbers[row, index[well]] = found[name][well]
        for i, reached in zip(index[~well], n_samples[~well], strict=True):
            status[i] = runs[int(i)].plant.what_went_wrong(float(reached) * duration / n_intervals)
        finished += index.size
        if progress is not None:
            progress(finished / n)
    figures_by_name: dict[str, np.ndarray] = dict(zip(UNITS, numbers, strict=True))
    return Collected(figures=figures_by_name, succeeded=succeeded, status=tuple(status))


def joint_peaks(runs: Sequence[Run], block: Block) -> dict[str, Figure]:
    """The figures of `laticauda.trial.feasibility` for every run of a block whose log has what the joints did.

    Args:
        runs: Those of the block.
        block: What they left behind.
    """
    layout, robots = runs[0].plant.layout, [run.plant.robot for run in runs]
    tail, n_joints = layout.tail_link, layout.n_bodies - 1
    log = block.log[:, rows.LOG_STATE :].reshape(block.time.size, 4, n_joints, len(runs))
    if len(robots[0].driven_joints) > robots[0].n_joints:
        log = np.concatenate((log, log[:, :, tail - 1 : tail]), axis=2)
    periods = [2.0 * np.pi / run.command.gait.frequency if run.command.gait.frequency > 0.0 else None for run in runs]
    counts = np.stack([feasibility.settled(block.time, period) for period in periods], axis=1)
    with np.errstate(all="ignore"):
        return feasibility.peaks(robots, log[:, 0, tail:], log[:, 1, tail:], log[:, 3, tail:], counts)


def _figures(runs: Sequence[Run], weight: np.ndarray, block: Block) -> dict[str, np.ndarray]:
    """The figures of one block; numbers without meaning where a run diverged."""
    with np.errstate(all="ignore"):
        duration = block.time[-1] - block.time[0]
        end = block.center_of_mass[-1]
        speed = _size(end - block.center_of_mass[0]) / duration
        power = block.work / duration
        electrical = [has_power_model(run.plant.robot, run.plant.joints) for run in runs]
        mean = cast(np.ndarray, np.where(electrical, power[3], power[0]))
        moving = speed.real > metrics.STILL
        return {
            "forward_velocity": speed,
            "steady_velocity": _steady_velocity(runs, block),
            "mechanical_power": power[0],
            "net_power": power[1],
            "positive_power": power[2],
            "mean_power": mean,
            "cost_of_transport": np.where(moving, mean / (weight * speed), np.nan),
            "x": end[0].copy(),
            "y": end[1].copy(),
            "heading": block.heading,
        }


def _size(vector: np.ndarray) -> np.ndarray:
    """|vector|, complex steps included; the first axis holds x and y."""
    return np.sqrt(vector[0] * vector[0] + vector[1] * vector[1])


def _steady_velocity(runs: Sequence[Run], block: Block) -> np.ndarray:
    """`metrics.steady_velocity` for every run, nan where that refuses."""
    time = block.time
    start = np.array([_steady_start(time, run.command.gait) for run in runs])
    possible = np.isfinite(start)
    start = np.where(possible, start, time[0])
    i = np.clip(np.searchsorted(time, start, side="right") - 1, 0, time.size - 2)
    if runs[0].slope is not None:
        slopes = [_start_slope(run, time[-1] - at) for run, at in zip(runs, start, strict=True)]
        start = start + 1j * STEP * np.array(slopes)
    step = time[i + 1] - time[i]
    k = np.arange(len(runs))
    p, v = block.center_of_mass, block.center_of_mass_velocity
    begin = hermite((start - time[i]) / step, step, (p[i, :, k].T, p[i + 1, :, k].T), (v[i, :, k].T, v[i + 1, :, k].T))
    return np.where(possible, _size(p[-1] - begin) / (time[-1] - start), np.nan)


def _start_slope(run: Run, steady: float) -> float:
    """How the begin of the steady part, a whole number of cycles before the end, follows the run's parameter."""
    frequency = run.command.gait.frequency
    assert run.slope is not None
    return steady / frequency * float(run.slope[rows.FREQUENCY]) if frequency > 0.0 else 0.0


def _steady_start(time: np.ndarray, gait: Gait) -> float:
    """Where the steady part begins [s]; nan if there is none."""
    try:
        return steady_part(time, 2.0 * np.pi / gait.frequency if gait.frequency > 0.0 else None).start
    except ValueError:
        return np.nan


def _common_length(given: Mapping[str, object]) -> int:
    """How many trials the sequences among the arguments ask for."""
    lengths = {name: len(cast(Sequence[object], value)) for name, value in given.items() if isinstance(value, Sequence)}
    if 0 in lengths.values():
        empty = next(name for name, length in lengths.items() if length == 0)
        raise BadArgument(empty, "must hold at least one item, got none")
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{length} {name}" for name, length in lengths.items())
        raise ValueError(f"`{'`, `'.join(lengths)}` must be of equal length, got {listed}.")
    return next(iter(lengths.values()), 1)


def _each(name: str, given: Item | Sequence[Item], n: int, *kinds: type) -> Sequence[Item]:
    """The argument once per trial, checked."""
    if not isinstance(given, Sequence):
        instance(name, given, *kinds)
        return [given] * n
    items = cast("Sequence[Item]", given)
    for i, item in enumerate(items):
        instance(f"{name}[{i}]", item, *kinds)
    return items
