"""Common parts of the paper's studies: which robot swims in which water, and how a study is run.

`Coefficients` turn a robot and a gait into a scenario, `Runs` swims scenarios one after another,
and `Study` is the base of all studies: its `run` is what users call.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any, ClassVar, Generic, NamedTuple, Self, TypeVar, Unpack, cast, get_args

import numpy as np

import laticauda as lc
from laticauda.models.simulate import (
    HasArrived,
    Until,
    build_plant,
    run_scenario,
    silent,
    swim_side_by_side,
)
from laticauda.motion import gaits
from laticauda.scenarios import (
    NO_FILTER,
    Model,
    ModelChanges,
    Scenario,
    check_plausible,
    model_of,
    settings_of,
)
from laticauda.studies import Progress
from laticauda.trials import Setting
from laticauda.values import SimulationFailed, check_instance, packaging

Settings = TypeVar("Settings")
_load_robot_once = cache(lc.load_robot)


@dataclass(frozen=True, kw_only=True)
class Coefficients:
    """One set of fluid coefficients, by gait; a curve in every figure."""

    name: str
    """Name in tables and files."""
    title: str
    """Label in legends."""
    waters: Mapping[str, str | lc.Water]
    """Water for every kind of gait, or its name (`load_water`)."""
    parameters: lc.Parameters | None = None
    """Parameter file from which they come, if any, with its changes to a robot."""
    n_fitted: int | None = None
    """Number of its values that are fitted to Table 1; None if all are from another source [-]."""
    loop_delay: float | None = None
    """Delay with the parameters' own joints and no steering filter; None: those of the run [s]."""

    @classmethod
    def of(cls, parameters: lc.Parameters, **more: Any) -> Self:
        """Return the coefficients of a parameter file.

        Args:
            parameters: Parameters from the file.
            more: Further fields.
        """
        waters = {gait: parameters.water(gait) for gait in gaits.GAIT_WORDS}
        return cls(
            name=parameters.name,
            title=parameters.title,
            waters=waters,
            parameters=parameters,
            **more,
        )

    def give_joints(self, model: Model) -> Model:
        """Return the model with the joints and delay of these coefficients, if they have their own.

        Args:
            model: Model with which everything else is run.
        """
        if self.loop_delay is None or self.parameters is None or self.parameters.joints is None:
            return model
        return replace(
            model,
            joints=lc.JointLaw.of(self.parameters.joints),
            offset_bandwidth=NO_FILTER,
            loop_delay=self.loop_delay,
            dt=None,
        )

    def water(self, gait: str) -> lc.Water:
        """Return the water for a kind of gait.

        Args:
            gait: Kind of gait.
        """
        water = self.waters[gait]
        if isinstance(water, lc.Water):
            return water
        return lc.load_water(water)

    def build_scenario(self, robot: lc.Robot | str, gait: lc.Gait, **more: Any) -> Scenario:
        """Return the scenario of a robot, changed by these parameters, in the water for its gait.

        Args:
            robot: Robot that swims, or its name (`load_robot`).
            gait: Gait of the robot.
            more: Further fields of the scenario.
        """
        if isinstance(robot, str):
            robot = _load_robot_once(robot)
        if self.parameters is not None:
            robot = self.parameters.robot(robot, gait.kind)
        return Scenario(robot=robot, motion=gait, environment=self.water(gait.kind), **more)


class NamedScenario(NamedTuple):
    """A scenario to run, with the name that messages call it by."""

    name: str
    """Name of the run, for messages."""
    scenario: Scenario
    """Scenario to run."""


@dataclass(kw_only=True)
class Runs:
    """Runner that swims scenarios one by one, counts them and records how they were computed."""

    model: Model
    """Model, unless a run specifies another."""
    progress: Progress
    """Called after every run with the number of runs done and the total."""
    n_runs: int = 0
    """Total number of runs; a study sets it before the first one [-]."""
    trial_settings: dict[str, Setting] = field(default_factory=dict[str, Setting])
    """How the runs were computed: model, joints, dt, ramp [s], offset_bandwidth [rad/s] ..."""
    n_done: int = 0
    """Number of runs done [-]."""

    def swim(self, name: str, scenario: Scenario, *, until: Until | None = None) -> lc.Trial:
        """Return the trial of a scenario.

        Args:
            name: Name of the run, for messages.
            scenario: Scenario to run.
            until: Called at every control instant after the first; once it returns True, the run
                ends before its duration.

        Raises:
            SimulationFailed: If the run blows up; the message says which.
        """
        plant = build_plant(scenario)
        try:
            trial = run_scenario(scenario, plant, until=until, throw=True)
        except SimulationFailed as error:
            raise SimulationFailed(f"{name}: {error}") from error
        self.trial_settings |= settings_of(plant.settings)
        self._count_run()
        return trial

    def swim_side_by_side(
        self, tasks: Sequence[NamedScenario], has_arrived: HasArrived
    ) -> list[lc.Trial]:
        """Return the trials of scenarios with controllers; up to rounding, those of `swim`.

        Args:
            tasks: Names and scenarios, all with the same duration and sample interval.
            has_arrived: Called at every control instant after the first: a run ends early where it
                returns True; see `laticauda.models.simulate.swim_side_by_side`.

        Raises:
            SimulationFailed: If one blows up; the message says which.
        """
        scenarios = [task.scenario for task in tasks]
        for scenario in scenarios:
            check_plausible(scenario)
        trials = swim_side_by_side(scenarios, has_arrived)
        for task, trial in zip(tasks, trials, strict=True):
            if not trial.succeeded:
                raise SimulationFailed(f"{task.name}: {trial.status}")
            self.trial_settings |= settings_of(cast(Model, trial.scenario.model))
            self._count_run()
        return trials

    def swim_many(self, tasks: Sequence[NamedScenario]) -> dict[str, np.ndarray]:
        """Return the figures of many scenarios with a fixed gait; up to rounding, those of `swim`.

        Args:
            tasks: Names and scenarios.

        Raises:
            SimulationFailed: If one blows up; the message says which.
            ValueError: If one is too short for a steady part.
        """
        n_done_before = self.n_done
        scenarios = [task.scenario for task in tasks]

        def count_runs(share_done: float) -> None:
            while self.n_done < n_done_before + round(share_done * len(tasks)):
                self._count_run()

        swims = lc.swim_many(scenarios, threads=1, progress=count_runs)
        for task, succeeded, status in zip(tasks, swims.succeeded, swims.status, strict=True):
            if not succeeded:
                raise SimulationFailed(f"{task.name}: {status}")
        for index in np.flatnonzero(np.isnan(swims.steady_velocity)):
            # The run is too short: its trial raises the error that says so.
            _ = lc.swim(scenarios[index]).steady_velocity
        self.trial_settings |= settings_of(build_plant(scenarios[-1]).settings)
        return vars(swims)

    def _count_run(self) -> None:
        self.n_done += 1
        self.progress(self.n_done, self.n_runs)


@dataclass(frozen=True, kw_only=True, eq=False)
class Study(Generic[Settings]):
    """Settings of a study that was run; subclasses add the results."""

    settings: Settings
    """Settings that were run."""
    trial_settings: Mapping[str, Setting]
    """How every run was computed: model, joints, dt, ramp [s], offset_bandwidth [rad/s] ..."""
    version: str = field(default_factory=lambda: packaging.__version__)
    """Version of laticauda that ran it."""
    default_settings: ClassVar[Any]
    """Factory of the settings that are run if none are given."""

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
            settings: Settings to run; None uses those of the paper, or the defaults where it has
                none.
            model: Model, or its name.
            progress: Called after every run with the number of runs done and the total.
            changes: Differences from the model's defaults.

        Returns:
            The study: settings and results.

        Raises:
            ValueError: If an argument is out of its range.
            SimulationFailed: If a run blows up; the message says which.
        """
        chosen: Any = settings
        if settings is None:
            chosen = cls.default_settings()
        check_instance("settings", chosen, cls._settings_class())
        runs = Runs(model=model_of(model, **changes), progress=progress)
        return cls.from_runs(chosen, runs)

    @classmethod
    def _settings_class(cls) -> Any:
        """Return the class that a subclass names in brackets: `Study[EfficiencySettings]`."""
        (settings_class,) = get_args(cls.__dict__["__orig_bases__"][0])
        return settings_class

    @classmethod
    def from_runs(cls, settings: Settings, runs: Runs) -> Any:
        """Run the trials of `settings` by `runs`, and return the study."""
        raise NotImplementedError
