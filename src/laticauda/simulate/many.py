"""`swim_many`: the figures of many trials, computed side by side and on all cores."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, Unpack, cast

import numpy as np
from jaxtyping import Bool, Float, Inexact

from laticauda.dynamics.plant import check_size
from laticauda.errors import (
    BadArgument,
    check_choice,
    check_instance,
    check_not_empty,
    check_whole_number,
)
from laticauda.gaits import Gait
from laticauda.interfaces import Command, OpenLoop, Start
from laticauda.planar.batch import Block, Device, Run, march_many
from laticauda.planar.model import PlanarPlant
from laticauda.robot import Environment, Ground, Robot, Water, load_robot
from laticauda.scenarios import (
    ModelChanges,
    Planar,
    Scenario,
    Spatial,
    build_scenario,
    default_water,
)
from laticauda.simulate import batch_figures, runner
from laticauda.simulate.batch_figures import Figure
from laticauda.simulate.numbers import UNITS, of_figure
from laticauda.simulate.plants import build_plant
from laticauda.simulate.several import swim_each
from laticauda.trial import Trial, metrics
from laticauda.trial.dataset import AXES

if TYPE_CHECKING:
    import xarray

CPU = "cpu"
Item = TypeVar("Item")
Look = Callable[[Sequence[Run], Block], None]
"""Callback that receives the runs of a block and their results."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Swims:
    """Figures of many trials, in the order of the arguments; each is defined as in a `Trial`.

    A figure is nan where a trial has none: all figures where the trial diverged, `steady_velocity`
    also where the trial is too short for its gait, `cost_of_transport` where the robot did not
    move.
    """

    forward_velocity: Figure
    """Straight-line displacement / time over the whole run (5) [m/s]."""
    steady_velocity: Figure
    """Displacement / time over whole gait cycles after the first third of the run and 10 s [m/s]."""
    mechanical_power: Figure
    """Mean of sum |u phi'| [W]."""
    net_power: Figure
    """Mean of sum u phi' [W]."""
    positive_power: Figure
    """Mean of sum max(u phi', 0) [W]."""
    mean_power: Figure
    """Electrical power with servo joints or a `Robot.active_power`, otherwise mechanical power [W]."""
    cost_of_transport: Figure
    """`mean_power` / (weight of the displaced water x `forward_velocity`) [-]."""
    center_of_mass: Float[np.ndarray, "n_trials n_axes"]
    """Final position of the center of mass [m]."""
    heading: Figure
    """Final heading [rad]."""
    succeeded: Bool[np.ndarray, " n_trials"]
    """Whether the trial reached its end."""
    status: tuple[str, ...]
    """How each trial ended."""

    def __len__(self) -> int:
        """Return the number of trials."""
        return len(self.status)

    def to_dataset(self) -> "xarray.Dataset":
        """Convert to an xarray Dataset with the dimension `trial`, labeled like the results of a sweep.

        Add varied parameters with `assign_coords`; an amplitude, for instance, with
        `amplitude=("trial", amplitudes)`.
        """
        import xarray

        found: dict[str, Any] = {"status": ("trial", np.array(self.status, dtype=object))}
        for name, values in vars(self).items():
            if name != "status":
                found[name] = ("trial", "axis")[: np.ndim(values)], values, of_figure(name)
        axes = np.array(AXES[: self.center_of_mass.shape[1]], dtype=object)
        return xarray.Dataset(found, coords={"trial": np.arange(len(self)), "axis": axes})


def swim_many(
    robots: Sequence[Scenario] | Robot | Sequence[Robot] | str | Path,
    gaits: Gait | Sequence[Gait] | None = None,
    duration: float = 30.0,
    *,
    environments: Environment | Sequence[Environment] | None = None,
    starts: Start | Sequence[Start] | None = None,
    sample_interval: float = 0.05,
    threads: int | None = None,
    device: str = CPU,
    progress: runner.Progress = runner.silent,
    **changes: Unpack[ModelChanges],
) -> Swims:
    """Run many scenarios of one model, or let many robots swim, each starting straight and at rest.

    Trial i is the result of `swim` for the i-th element of every argument; where a single value is
    given instead of a sequence, all trials share it. Planar robots of equal shape are computed
    eight at a time, so a sweep over gaits, waters or sizes gains most; any mixture is allowed, and
    the figures agree with those of `swim` to rounding. Spatial robots run one by one on every
    thread, and their figures are those of `swim` to the last bit. Neither depends on what else is
    in the batch, nor on the number of threads.

    Args:
        robots: The scenarios, all planar or all spatial; planar ones have no controllers, and share
            duration and sample interval. Or the robots, together with their gaits; one robot may be
            given by preset name or file path.
        gaits: The commanded gaits.
        duration: Duration of every trial [s].
        environments: Waters or grounds; None uses `default_water` of each robot and gait.
        starts: Start of each trial; None: at the origin, along x.
        sample_interval: Sample interval of the logs used for the figures; the logs are not kept
            [s].
        threads: Number of threads; None uses all cores that this process may use.
        device: cpu, or a device provided by an installed package: cuda for a GPU, with
            `laticauda-cuda` (experimental), one planar trial per GPU thread. It pays off for
            thousands of trials.
        progress: Called repeatedly with the completed share, from 0 to 1.
        changes: Settings of the model: `joints` (prescribed, pd, servo, or a joint law), `dt` [s]
            and the other fields of `laticauda.scenarios.ModelChanges`. A fluid law that branches
            with `if` works, but lane by lane.

    Returns:
        The figures, as arrays.

    Raises:
        ValueError: If an argument is out of its range, or sequences differ in length, or there is
            no GPU.

    Example:
        >>> import laticauda as lc
        >>> gaits = [lc.eel_like(amplitude=a, frequency=2.0, phase_shift=0.7) for a in (0.4, 0.5, 0.6)]
        >>> lc.swim_many("mamba", gaits).forward_velocity.round(3)
        array([0.066, 0.091, 0.116])
    """
    scenarios = scenarios_of_batch(
        robots, gaits, environments, starts, duration, sample_interval, **changes
    )
    if scenarios and isinstance(getattr(scenarios[0], "model", None), Spatial):
        check_choice("device", device, (CPU,))
        found = run_spatial(scenarios, threads, progress)
    else:
        runs = runs_of(scenarios)
        found = run_batch(
            runs,
            scenarios[0].duration,
            scenarios[0].sample_interval,
            threads,
            progress,
            device=device,
        )
    named = dict(found.figures)
    end = np.stack([named.pop(axis) for axis in "xyz" if axis in named], axis=1)
    return Swims(**named, center_of_mass=end, succeeded=found.succeeded, status=found.status)


def run_spatial(
    scenarios: Sequence[Scenario], threads: int | None, progress: runner.Progress
) -> "Collected":
    """Compute the figures of spatial scenarios, and `z`; arguments as for `swim_many`."""
    names = (*UNITS, "z")

    def figures(trial: Trial) -> tuple[list[float | None], bool, str]:
        known = trial.figures()[0] | {"heading": trial.heading[-1]}
        known |= dict(zip("xyz", trial.center_of_mass[-1], strict=True))
        return (
            [known.get(name) if trial.succeeded else None for name in names],
            trial.succeeded,
            trial.status,
        )

    for i, one in enumerate(scenarios):
        check_instance(f"scenarios[{i}].model", one.model, Spatial)
    numbers, succeeded, status = zip(
        *swim_each(scenarios, figures, threads=threads, progress=progress), strict=True
    )
    by_name = dict(zip(names, np.array(numbers, dtype=float).T, strict=True))
    return Collected(figures=by_name, succeeded=np.array(succeeded), status=status)


def scenarios_of_batch(
    robots: Sequence[Scenario] | Robot | Sequence[Robot] | str | Path,
    gaits: Gait | Sequence[Gait] | None,
    environments: Environment | Sequence[Environment] | None = None,
    starts: Start | Sequence[Start] | None = None,
    duration: float = 30.0,
    sample_interval: float = 0.05,
    **changes: Unpack[ModelChanges],
) -> Sequence[Scenario]:
    """Return the scenarios of a batch; arguments as for `swim_many`."""
    swimming = load_robot(robots) if isinstance(robots, str | Path) else robots
    if gaits is None:
        return _each(
            "robots",
            cast("Sequence[Scenario]", check_instance("robots", swimming, Sequence)),
            0,
            Scenario,
        )
    given = {"robots": swimming, "gaits": gaits, "environments": environments, "starts": starts}
    n = _common_length(given)
    every_robot = _each("robots", cast("Robot | Sequence[Robot]", swimming), n, Robot)
    every_gait = _each("gaits", gaits, n, Gait)
    every_start = _each("starts", Start() if starts is None else starts, n, Start)
    if environments is None:
        every_environment: Sequence[Environment] = list(map(default_water, every_robot, every_gait))
    else:
        every_environment = _each("environments", environments, n, Water, Ground)
    base = build_scenario(
        every_robot[0], every_gait[0], duration, sample_interval=sample_interval, **changes
    )
    parts = zip(every_robot, every_gait, every_environment, every_start, strict=True)
    return [replace(base, robot=r, motion=g, environment=e, start=s) for r, g, e, s in parts]


def runs_of(scenarios: Sequence[Scenario]) -> list[Run]:
    """Return the runs of a batch, with one plant for all that share robot, environment and model.

    Args:
        scenarios: Planar scenarios with the same duration and sample interval.

    Raises:
        ValueError: If they are not planar, or differ in these.
    """
    check_not_empty("scenarios", scenarios, "item")
    plants: dict[tuple[int, int, int], PlanarPlant] = {}
    common = scenarios[0].duration, scenarios[0].sample_interval
    runs: list[Run] = []
    for i, one in enumerate(scenarios):
        key = id(one.robot), id(one.environment), id(one.model)  # the scenarios keep them alive
        if key not in plants:
            check_instance(f"scenarios[{i}].model", one.model, Planar)
            plants[key] = cast(PlanarPlant, build_plant(one))
        if (one.duration, one.sample_interval) != common:
            name = "duration" if one.duration != common[0] else "sample_interval"
            raise BadArgument(
                name, f"must be the same in all scenarios, also got {getattr(one, name):g} s"
            )
        motion = check_instance(f"scenarios[{i}].motion", one.motion, Gait, OpenLoop)
        command = motion.command if isinstance(motion, OpenLoop) else Command(gait=one.gait)
        start = cast(Start, check_instance(f"scenarios[{i}].start", one.start, Start))
        runs.append(Run(plant=plants[key], command=command, start=start))
    return runs


@dataclass(frozen=True, kw_only=True, eq=False)
class Collected:
    """All figures of a batch; complex if its runs carry derivatives (see `Run`)."""

    figures: Mapping[str, Inexact[np.ndarray, " n_runs"]]
    """Figures by name, nan where a run has none."""
    succeeded: Bool[np.ndarray, " n_runs"]
    """Whether the run reached its end."""
    status: tuple[str, ...]
    """How each run ended."""


def run_batch(
    runs: Sequence[Run],
    duration: float,
    sample_interval: float,
    threads: int | None,
    progress: runner.Progress,
    *,
    weights: Inexact[np.ndarray, " n_runs"] | None = None,
    device: str = CPU,
    look: Look = runner.silent,
    with_joints: bool = False,
) -> Collected:
    """Run a batch, and collect the figures of all blocks in the order of the runs.

    Args:
        runs: The runs of the batch.
        duration: Duration of every trial [s].
        sample_interval: Sample interval of the logs used for the figures; the logs are not kept
            [s].
        threads: Number of threads; None uses all cores that this process may use.
        progress: Called repeatedly with the completed share, from 0 to 1.
        weights: Weights of the robots, see `carried_weight` [N]; complex if their runs carry
            derivatives.
        device: cpu, or a device provided by an installed package, such as cuda.
        look: Called once per block, in the computing threads, before the next block overwrites its
            log; cpu only.
        with_joints: Whether the log that `look` receives includes the motion of the joints.
    """
    check_size(duration, sample_interval)
    if threads is not None:
        check_whole_number("threads", threads, 1)
    is_here = check_choice("device", device, (CPU, *Device.names())) == CPU
    march = march_many if is_here else Device.named(device)().march_many
    n, carried = len(runs), weights
    if carried is None:
        plants: dict[int, PlanarPlant] = {id(run.plant): run.plant for run in runs}
        weight = {
            key: metrics.carried_weight(one.robot, one.environment) for key, one in plants.items()
        }
        carried = np.array([weight[id(run.plant)] for run in runs])
    n_intervals = max(1, round(duration / sample_interval))
    steady = batch_figures.Steady.of(runs, np.linspace(0.0, duration, n_intervals + 1))
    left = np.full((batch_figures.N_SAMPLED_NUMBERS, n), np.nan, dtype=carried.dtype)
    succeeded, status = np.zeros(n, dtype=bool), ["The run reached its end."] * n

    def keep(block: Block) -> np.ndarray:
        look([runs[int(i)] for i in block.index], block)
        left[:, block.index] = batch_figures.sample_block(block, steady.before[block.index])
        succeeded[block.index] = well = block.n_samples == n_intervals + 1
        for i, reached in zip(block.index[~well], block.n_samples[~well], strict=True):
            status[i] = runs[int(i)].plant.what_went_wrong(float(reached) * duration / n_intervals)
        return block.index

    finished = 0
    for index in march(
        runs, duration, sample_interval, keep, threads=threads, with_joints=with_joints
    ):
        finished += index.size
        progress(finished / n)
    found = batch_figures.compute_figures(runs, carried, left, steady)
    figures = {name: np.where(succeeded, one, np.nan) for name, one in found.items()}
    return Collected(figures=figures, succeeded=succeeded, status=tuple(status))


def _common_length(given: Mapping[str, object]) -> int:
    """Return the number of trials implied by the sequences among the arguments."""
    lengths = {
        name: len(cast(Sequence[object], value))
        for name, value in given.items()
        if isinstance(value, Sequence)
    }
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{length} {name}" for name, length in lengths.items())
        raise ValueError(f"`{'`, `'.join(lengths)}` must be of equal length, got {listed}.")
    return next(iter(lengths.values()), 1)


def _each(name: str, given: Item | Sequence[Item], n: int, *kinds: type) -> Sequence[Item]:
    """Return the argument once per trial, validated."""
    if not isinstance(given, Sequence):
        check_instance(name, given, *kinds)
        return [given] * n
    items = cast("Sequence[Item]", given)
    check_not_empty(name, items, "item")
    for i, item in enumerate(items):
        check_instance(f"{name}[{i}]", item, *kinds)
    return items
