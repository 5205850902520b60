"""What all studies of the paper share: who swims with which coefficients, how it is steered, and how it is run."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any, ClassVar, Generic, Self, TypeVar, Unpack

from laticauda.actuation import JointLaw
from laticauda.control import HeadingController, IntegralLineOfSight, LineOfSight, PathFollowing, StraightLine
from laticauda.control import Path as FollowedPath
from laticauda.errors import SimulationFailed, within
from laticauda.gaits import GAIT_WORDS, Gait
from laticauda.packaging import __version__
from laticauda.robot import Parameters, Robot, Water, load_robot, load_water
from laticauda.scenarios import Model, ModelChanges, Scenario, model_of, settings_of
from laticauda.scenarios.scenario import NO_FILTER
from laticauda.simulate import plant, run
from laticauda.simulate.runner import Until
from laticauda.studies.trials import Progress
from laticauda.trial import Trial, following
from laticauda.trial.contents import Setting
from laticauda.trial.cycles import CycleMean
from laticauda.trial.null_models import group_name

Settings = TypeVar("Settings")
X_AXIS = StraightLine()
_robot = cache(load_robot)


class Swimmer(Scenario):
    """One gait with one configuration of the robot, in its water; the runs of a study differ from it in the rest."""

    @property
    def has_fin(self) -> bool:
        """Whether it wears a caudal fin."""
        return self.robot.caudal_fin is not None

    @property
    def name(self) -> str:
        """What tables and files call it."""
        return group_name(self.gait.kind, self.has_fin)

    @property
    def length(self) -> float:
        """Of the straight robot, its fin included [m]."""
        return self.robot.reach


@dataclass(frozen=True, kw_only=True)
class Coefficients:
    """One set of fluid coefficients, by gait: a curve of every figure."""

    name: str
    """What tables and files call it."""
    title: str
    """What a legend says."""
    waters: Mapping[str, str | Water]
    """A water for every kind of gait: itself, or its name (`load_water`)."""
    parameters: Parameters | None = None
    """What they change about a robot, if they come from a parameter file."""
    n_fitted: int | None = None
    """How many of its numbers are fitted to Table 1; None for what the paper or somebody else gives [-]."""
    loop_delay: float | None = None
    """For joints of the parameters' own, without a steering filter; None: joints and loop of the run [s]."""

    @classmethod
    def of(cls, parameters: Parameters, **more: Any) -> Self:
        """What a parameter file says.

        Args:
            parameters: From the file.
            more: Further fields.
        """
        waters = {gait: parameters.water(gait) for gait in GAIT_WORDS}
        return cls(name=parameters.name, title=parameters.title, waters=waters, parameters=parameters, **more)

    def driven(self, model: Model) -> Model:
        """The model with joints and delay of its own, if it has any.

        Args:
            model: By which everything else is run.
        """
        if self.loop_delay is None or self.parameters is None or self.parameters.joints is None:
            return model
        joints = JointLaw.of(self.parameters.joints)
        return replace(model, joints=joints, offset_bandwidth=NO_FILTER, loop_delay=self.loop_delay, dt=None)

    def water(self, gait: str) -> Water:
        """The water for a kind of gait.

        Args:
            gait: The gait's kind.
        """
        water = self.waters[gait]
        return water if isinstance(water, Water) else load_water(water)

    def swimmer(self, robot: Robot | str, gait: Gait, **more: Any) -> Swimmer:
        """A robot with what these parameters change about it, in the water for its gait.

        Args:
            robot: What swims, or its name (`load_robot`).
            gait: How.
            more: Further fields of the scenario.
        """
        robot = _robot(robot) if isinstance(robot, str) else robot
        robot = robot if self.parameters is None else self.parameters.robot(robot, gait.kind)
        return Swimmer(robot=robot, motion=gait, environment=self.water(gait.kind), **more)


@dataclass(frozen=True, kw_only=True)
class Steering:
    """How a swimmer is steered along a path: guidance, heading law and heading."""

    name: str
    """What tables and files call it."""
    guidance: LineOfSight | IntegralLineOfSight
    """The law that leads to the path."""
    gain: float
    """k of the heading law [-]."""
    max_offset: float
    """Largest offset to either side [rad]."""
    heading_estimate: str = "raw"
    """Which heading is used: raw or cycle_mean."""

    def controller(self, gait: Gait, path: FollowedPath[Any], interval: float) -> PathFollowing:
        """The controller.

        Args:
            gait: What swims along the path.
            path: What is followed.
            interval: Between two control instants [s].
        """
        return PathFollowing(
            gait=gait,
            path=path,
            guidance=self.guidance,
            heading=HeadingController(gain=self.gain, max_offset=self.max_offset),
            heading_estimate=self.heading_estimate,
            interval=interval,
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class SteeredRun:
    """What a swimmer did along a path; errors are cycle means of its distance from it, positive to the left [m]."""

    swimmer: Swimmer
    """Who swam: its motion is the controller, its duration the longest that there could be."""
    law: Steering
    """How it was steered."""
    trial: Trial
    """The run."""

    @property
    def error(self) -> CycleMean:
        """The error over time [s], [m]."""
        return following.mean_error(*self._measured)

    @property
    def along(self) -> CycleMean:
        """Cycle mean over time of how far along the path it was [s], [m]."""
        time, _, period = self._measured
        return following.mean_error(time, self.trial.signals["along_track_distance"], period)

    @property
    def mean_error(self) -> float:
        """Its mean over the last third of the run [m]."""
        return following.last_third_error(*self._measured)

    @property
    def largest(self) -> float:
        """The largest of it on the way, with its sign [m]."""
        return float(max(self.error.value, key=abs))

    @property
    def is_cut_short(self) -> bool:
        """Whether something else than the time ended the run."""
        return self.trial.duration < self.swimmer.duration - 0.5 * self.swimmer.controller.interval

    def rms(self, begin: float = 0.0, end: float = math.inf) -> float:
        """Root mean square of the error: a swing about the path has little mean, and shows in this [m].

        Args:
            begin: Of the part of the run that counts, in thirds of it.
            end: Of that part, likewise.
        """
        third = self.trial.duration / 3.0
        return following.steady_error(*self._measured, begin * third, end * third)

    @property
    def _measured(self) -> tuple[Any, Any, float]:
        assert self.trial.period is not None  # every gait of the paper's moves
        return self.trial.time, self.trial.signals["cross_track_error"], self.trial.period


@dataclass(kw_only=True)
class Runs:
    """Swims one scenario after the other: counts them, and keeps how they were made."""

    model: Model
    """By which model, unless a run says otherwise."""
    progress: Progress | None
    """Called after every run with the number of runs done, and of all."""
    n_runs: int = 0
    """How many there will be; a study says so before the first [-]."""
    how: dict[str, Setting] = field(default_factory=dict[str, Setting])
    """How they were computed: model, joints, dt [s], offset_bandwidth [rad/s], ramp [s] and the like."""
    n_done: int = 0
    """How many there were [-]."""

    def swim(self, name: str, scenario: Scenario, *, until: Until | None = None) -> Trial:
        """The trial of a scenario.

        Args:
            name: Which one it is.
            scenario: What is run.
            until: See `laticauda.simulate.run`.

        Raises:
            SimulationFailed: If the run blows up; the message says which.
        """
        body, start, interval = plant(scenario), scenario.start, scenario.sample_interval
        settings: Any = {"start": start, "sample_interval": interval, "until": until}
        try:
            trial = run(body, scenario.controller, scenario.duration, throw=True, **settings)
        except SimulationFailed as error:
            raise SimulationFailed(f"{name}: {error}") from error
        self.how |= settings_of(body.settings)
        self.tell(self.n_done + 1)
        return trial

    def tell(self, n_done: int) -> None:
        """Say how many runs there were.

        Args:
            n_done: So many [-].
        """
        self.n_done = n_done
        if self.progress is not None:
            self.progress(n_done, self.n_runs)

    def follow(
        self,
        name: str,
        swimmer: Swimmer,
        law: Steering,
        interval: float,
        path: FollowedPath[Any] = X_AXIS,
        *,
        until: Until | None = None,
    ) -> SteeredRun:
        """A swimmer along a path.

        Args:
            name: Which run it is.
            swimmer: Who swims, from where and for how long at most.
            law: How it is steered.
            interval: Between two control instants [s].
            path: What is followed; the x axis if left out.
            until: As for `swim`.

        Raises:
            SimulationFailed: If the run blows up; the message says which.
        """
        steered = replace(swimmer, motion=law.controller(swimmer.gait, path, interval))
        return SteeredRun(swimmer=steered, law=law, trial=self.swim(name, steered, until=until))


@dataclass(frozen=True, kw_only=True, eq=False)
class Study(Generic[Settings]):
    """What a study ran; what came out stands in its subclasses."""

    settings: Settings
    """What was run."""
    how: Mapping[str, Setting]
    """How every run was computed: model, joints, dt [s], offset_bandwidth [rad/s], ramp [s] and the like."""
    version: str = field(default_factory=lambda: __version__)
    """Version of laticauda that ran it."""
    usual: ClassVar[Any]
    """Makes the settings that are run where none are given."""
    by_default: ClassVar[str] = "planar"
    """The name of the model where none is given."""

    @classmethod
    def run(
        cls,
        settings: Settings | None = None,
        model: Model | str | None = None,
        *,
        progress: Progress | None = None,
        **changes: Unpack[ModelChanges],
    ) -> Self:
        """Run the study.

        Args:
            settings: None takes those of the paper, or the defaults where it has none.
            model: By which model, or its name; None takes the planar one, and the spatial one to compare it with that.
            progress: Called after every run with the number of runs done, and of all.
            changes: What differs from the model's defaults.

        Returns:
            What was run, and what came out.

        Raises:
            ValueError: If an argument is out of its range.
            SimulationFailed: If a run blows up; the message says which.
        """
        chosen: Any = cls.usual() if settings is None else settings
        return cls.by_runs(chosen, Runs(model=model_of(model or cls.by_default, **changes), progress=progress))

    @classmethod
    def by_runs(cls, settings: Settings, runs: Runs) -> Any:
        """What comes out of `settings`, swum by `runs`."""
        raise NotImplementedError


def long_enough(name: str, duration: float, swimmers: tuple[Swimmer, ...], n_cycles: float) -> float:
    """A duration that holds so many cycles of every swimmer's gait.

    Args:
        name: Of the argument.
        duration: [s].
        swimmers: That are to be seen.
        n_cycles: How many of their cycles [-].

    Raises:
        ValueError: If it is too short.
    """
    longest = max(2.0 * math.pi / swimmer.gait.frequency for swimmer in swimmers)
    return within(name, duration, n_cycles * longest, 1e5, "s")
