"""What all studies of the paper share: who swims with which coefficients, and how it is run."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any, ClassVar, Generic, Self, TypeVar, Unpack, get_args

import numpy as np

import laticauda as lc
from laticauda import gaits, packaging
from laticauda.errors import SimulationFailed, instance
from laticauda.scenarios import Model, ModelChanges, Scenario, model_of, settings_of
from laticauda.scenarios.scenario import NO_FILTER
from laticauda.simulate import plant
from laticauda.simulate.runner import Until, run_scenario, silent
from laticauda.studies.sweep import Progress
from laticauda.trial.contents import Setting

Settings = TypeVar("Settings")
_robot = cache(lc.load_robot)


@dataclass(frozen=True, kw_only=True)
class Coefficients:
    """One set of fluid coefficients, by gait: a curve of every figure."""

    name: str
    """What tables and files call it."""
    title: str
    """What a legend says."""
    waters: Mapping[str, str | lc.Water]
    """A water for every kind of gait: itself, or its name (`load_water`)."""
    parameters: lc.Parameters | None = None
    """What they change about a robot, if they come from a parameter file."""
    n_fitted: int | None = None
    """How many of its numbers are fitted to Table 1; None for what the paper or somebody else gives [-]."""
    loop_delay: float | None = None
    """For joints of the parameters' own, without a steering filter; None: joints and loop of the run [s]."""

    @classmethod
    def of(cls, parameters: lc.Parameters, **more: Any) -> Self:
        """What a parameter file says.

        Args:
            parameters: From the file.
            more: Further fields.
        """
        waters = {gait: parameters.water(gait) for gait in gaits.GAIT_WORDS}
        return cls(name=parameters.name, title=parameters.title, waters=waters, parameters=parameters, **more)

    def driven(self, model: Model) -> Model:
        """The model with joints and delay of its own, if it has any.

        Args:
            model: By which everything else is run.
        """
        if self.loop_delay is None or self.parameters is None or self.parameters.joints is None:
            return model
        joints = lc.JointLaw.of(self.parameters.joints)
        return replace(model, joints=joints, offset_bandwidth=NO_FILTER, loop_delay=self.loop_delay, dt=None)

    def water(self, gait: str) -> lc.Water:
        """The water for a kind of gait.

        Args:
            gait: The gait's kind.
        """
        water = self.waters[gait]
        return water if isinstance(water, lc.Water) else lc.load_water(water)

    def scenario(self, robot: lc.Robot | str, gait: lc.Gait, **more: Any) -> Scenario:
        """A robot with what these parameters change about it, in the water for its gait.

        Args:
            robot: What swims, or its name (`load_robot`).
            gait: How.
            more: Further fields of the scenario.
        """
        robot = _robot(robot) if isinstance(robot, str) else robot
        robot = robot if self.parameters is None else self.parameters.robot(robot, gait.kind)
        return Scenario(robot=robot, motion=gait, environment=self.water(gait.kind), **more)


@dataclass(kw_only=True)
class Runs:
    """Swims one scenario after the other: counts them, and keeps how they were made."""

    model: Model
    """By which model, unless a run says otherwise."""
    progress: Progress
    """Called after every run with the number of runs done, and of all."""
    n_runs: int = 0
    """How many there will be; a study says so before the first [-]."""
    how: dict[str, Setting] = field(default_factory=dict[str, Setting])
    """How they were computed: model, joints, dt [s], offset_bandwidth [rad/s], ramp [s] and the like."""
    n_done: int = 0
    """How many there were [-]."""

    def swim(self, name: str, scenario: Scenario, *, until: Until | None = None) -> lc.Trial:
        """The trial of a scenario.

        Args:
            name: Which one it is.
            scenario: What is run.
            until: Asked at every control instant after the first; once it says yes the run is over, before its
                duration.

        Raises:
            SimulationFailed: If the run blows up; the message says which.
        """
        body = plant(scenario)
        try:
            trial = run_scenario(scenario, body, until=until, throw=True)
        except SimulationFailed as error:
            raise SimulationFailed(f"{name}: {error}") from error
        self.how |= settings_of(body.settings)
        self.n_done += 1
        self.progress(self.n_done, self.n_runs)
        return trial

    def figures(self, tasks: Sequence[tuple[str, Scenario]]) -> dict[str, np.ndarray]:
        """The figures of many scenarios that hold a gait, side by side: those of `swim` to rounding (`lc.swim_many`).

        Args:
            tasks: Names and scenarios.

        Raises:
            SimulationFailed: If one blows up; the message says which.
            ValueError: If one is too short for a steady part.
        """
        begun, scenarios = self.n_done, [scenario for _, scenario in tasks]

        def tell(share: float) -> None:
            while self.n_done < begun + round(share * len(tasks)):
                self.n_done += 1
                self.progress(self.n_done, self.n_runs)

        found = lc.swim_many(scenarios, threads=1, progress=tell)
        for (name, _), succeeded, status in zip(tasks, found.succeeded, found.status, strict=True):
            if not succeeded:
                raise SimulationFailed(f"{name}: {status}")
        for k in np.flatnonzero(np.isnan(found.steady_velocity)):  # a run that is too short: its trial says so
            _ = lc.swim(scenarios[k]).steady_velocity
        self.how |= settings_of(plant(scenarios[-1]).settings)
        return vars(found)


@dataclass(frozen=True, kw_only=True, eq=False)
class Study(Generic[Settings]):
    """What a study ran; what came out stands in its subclasses."""

    settings: Settings
    """What was run."""
    how: Mapping[str, Setting]
    """How every run was computed: model, joints, dt [s], offset_bandwidth [rad/s], ramp [s] and the like."""
    version: str = field(default_factory=lambda: packaging.__version__)
    """Version of laticauda that ran it."""
    usual: ClassVar[Any]
    """Makes the settings that are run where none are given."""

    @classmethod
    def run(
        cls,
        settings: Settings | None = None,
        model: Model | str = "planar",
        *,
        progress: Progress = silent,
        **changes: Unpack[ModelChanges],
    ) -> Self:
        """Run the study.

        Args:
            settings: None takes those of the paper, or the defaults where it has none.
            model: By which model, or its name.
            progress: Called after every run with the number of runs done, and of all.
            changes: What differs from the model's defaults.

        Returns:
            What was run, and what came out.

        Raises:
            ValueError: If an argument is out of its range.
            SimulationFailed: If a run blows up; the message says which.
        """
        chosen: Any = cls.usual() if settings is None else settings
        instance("settings", chosen, *get_args(cls.__dict__["__orig_bases__"][0]))
        return cls.by_runs(chosen, Runs(model=model_of(model, **changes), progress=progress))

    @classmethod
    def by_runs(cls, settings: Settings, runs: Runs) -> Any:
        """What comes out of `settings`, swum by `runs`."""
        raise NotImplementedError
