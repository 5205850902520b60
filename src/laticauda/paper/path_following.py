"""The path-following study: the 12 trials of Table 2, and one of another publication.

It repeats the trials behind the paper's Figs. 12 to 23 and Table 2. The paper does not say how its
joints follow the gait, nor how fast an offset takes effect; so every case is run with each
combination of joint law and bandwidth, the band. One of them is the chosen one. The findings about
the table are computed in `scores`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

import laticauda as lc
from laticauda.paper.measured import MeasuredPathFollowing, percent_change
from laticauda.paper.runs import Coefficients, NamedScenario, Runs, Study
from laticauda.paper.settings import (
    Group,
    HeldOut,
    PathFollowingSettings,
    load_path_following_settings,
)
from laticauda.scenarios import Model, Observations, loop_in_words
from laticauda.trials import TRANSIENT, Trial, following
from laticauda.values import name_of, option, quantity, value_class

HEADING_WORDS = {"raw": "raw", "cycle_mean": "cycle-mean"}
"""Names of the heading estimates in texts."""
_KEPT_SETTINGS = ("joints", "offset_bandwidth", "loop_delay", "dt", "ramp")
"""Settings of a trial that are fields of `FollowingRun`, too."""


@value_class
class FollowingRun:
    """Settings of one run, and its figures."""

    joints: str = option("How the joints follow the gait")
    offset_bandwidth: float = quantity("rad/s", "Bandwidth of the reference generator")
    loop_delay: float = quantity("s", "Delay from heading to joint")
    heading_estimate: str = option("raw or cycle_mean")
    dt: float = quantity("s", "Largest time step")
    ramp: float = quantity("s", "Duration of the smooth start")
    reached: str = option("What ended the run: time or distance")
    duration: float = quantity("s", "how long the run was")
    forward_velocity: float = quantity("m/s", "forward velocity, straight line over the whole run")
    path_speed: float = quantity("m/s", "length of the path over time")
    steady_velocity: float | None = quantity(
        "m/s", "forward velocity over whole gait cycles after the transient"
    )
    mechanical_power: float = quantity("W", "mechanical power, mean of sum |u phi'|")
    joules_per_meter: float = quantity("J/m", "mechanical power / forward velocity")
    figures: Mapping[str, float | None] = option(
        "By the names of `laticauda.trials.following.FIGURES`; None: undefined"
    )
    # So that a limit cycle cannot pass as converged:
    last_third_rms: float | None = quantity(
        "m", "root mean square of the cycle-mean error over the last third"
    )
    last_third_largest: float | None = quantity("m", "largest cycle-mean error over the last third")
    offset_swing: float = quantity("rad", "amplitude of the offset asked for over the last third")

    @property
    def name(self) -> str:
        """Joint law, bandwidth, delay and heading in words."""
        heading = HEADING_WORDS[self.heading_estimate]
        loop = loop_in_words(vars(self)).removeprefix("bandwidth ")
        return f"{self.joints} joints, {loop}, {heading} heading"

    @property
    def has_come(self) -> bool:
        """Whether at some time the cycle-mean error stayed within 0.1 m for a whole cycle."""
        return self.figures["convergence_time"] is not None

    @property
    def converged(self) -> bool:
        """Whether the cycle-mean error came within 0.1 m for a whole cycle, and is there over the last three."""
        return following.stays(self.figures)


@dataclass(frozen=True, kw_only=True, eq=False)
class FollowingCase:
    """One row of Table 2, measured and simulated."""

    measured: MeasuredPathFollowing
    """The row: gait, initial conditions and measured values."""
    group: Group
    """Part of the table to which the row belongs."""
    figure: int
    """Number of the paper's figure."""
    trial: Trial
    """Trial with the chosen joints and bandwidth and raw heading, which the figure shows."""
    run: FollowingRun
    """Settings and figures of that trial."""
    band: tuple[FollowingRun, ...]
    """Runs with raw heading for every combination of the band, including the chosen one."""
    cycle_mean: FollowingRun
    """Run with the mean heading over the gait cycle, otherwise the same as the chosen run."""
    free_velocity: float
    """Steady velocity of the same gait with the chosen joints, unsteered [m/s]."""

    @property
    def is_in_band(self) -> bool:
        """Whether the measured speed lies within the band of simulated speeds."""
        speeds = [run.forward_velocity for run in self.band]
        return min(speeds) <= self.measured.forward_velocity <= max(speeds)

    def change_by_the_loop(self, run: FollowingRun) -> float | None:
        """Return the change of steady velocity by closing the loop; None for too short a run [%].

        Args:
            run: Run of this case.
        """
        if run.steady_velocity is None:
            return None
        return percent_change(self.free_velocity, run.steady_velocity)


def read_simulated_velocity(case: FollowingCase) -> float:
    """Return the forward velocity of the run that is shown [m/s].

    Args:
        case: Row of Table 2.
    """
    return case.run.forward_velocity


def read_simulated_power(case: FollowingCase) -> float:
    """Return the mechanical power of the run that is shown [W].

    Args:
        case: Row of Table 2.
    """
    return case.run.mechanical_power


@dataclass(frozen=True, kw_only=True, eq=False)
class HeldOutRun:
    """The trial of another publication, with the chosen joints and bandwidth and raw heading."""

    settings: HeldOut
    """Its initial conditions, and the published ranges."""
    trial: Trial
    """The simulated trial."""
    run: FollowingRun
    """Settings and figures of that trial."""
    velocity: tuple[float, float]
    """Smallest and largest velocity along the heading, after the first gait cycle [m/s]."""
    mean_velocity: tuple[float, float]
    """Smallest and largest mean of that velocity over the gait cycle around each instant [m/s]."""
    offset: tuple[float, float]
    """Smallest and largest commanded offset [rad]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PathFollowingStudy(Study[PathFollowingSettings]):
    """Settings and results of the study; `trial_settings` describes the chosen runs."""

    cases: tuple[FollowingCase, ...]
    """All rows of Table 2, in its order."""
    held_out: HeldOutRun
    """The trial of another publication."""
    own: "tuple[PathFollowingStudy, ...]" = ()
    """The same study with each of the models that have their own joints, in one way each."""

    default_settings = staticmethod(load_path_following_settings)

    @property
    def ways(self) -> "tuple[PathFollowingStudy, ...]":
        """By combination of the band, the study as if that were chosen, with the same trials."""
        studies: list[PathFollowingStudy] = []
        for index in range(len(self.cases[0].band)):
            cases = tuple(replace(case, run=case.band[index]) for case in self.cases)
            studies.append(replace(self, cases=cases))
        return tuple(studies)

    @classmethod
    def from_runs(cls, settings: PathFollowingSettings, runs: Runs) -> "PathFollowingStudy":
        """Run the trials of `settings` by `runs`, and return the study.

        Args:
            settings: Settings of the study.
            runs: Runner, with the model and the progress callback.
        """
        chosen = runs.model
        joints = name_of(type(chosen.joints))
        runs.n_runs = settings.n_runs(joints, chosen.offset_bandwidth)
        study = _run_study(settings, _models_of_band(settings, chosen), runs)
        own_studies: list[PathFollowingStudy] = []
        for coefficients in settings.own:
            runs = replace(runs, model=coefficients.give_joints(chosen))
            own_settings = replace(settings, coefficients=coefficients, own=())
            own_studies.append(_run_study(own_settings, [runs.model], runs))
        return replace(study, own=tuple(own_studies))


run_path_following = PathFollowingStudy.run


def _models_of_band(settings: PathFollowingSettings, chosen: Model) -> list[Model]:
    """Return the models of the band, among them the chosen one."""
    chosen_joints = name_of(type(chosen.joints))
    models: list[Model] = []
    for joints, bandwidth in settings.band(chosen_joints, chosen.offset_bandwidth):
        model = replace(chosen, offset_bandwidth=bandwidth)
        if joints != chosen_joints:
            model = replace(model, joints=lc.JointLaw.of(joints), dt=None)
        models.append(model)
    return models


def _run_study(
    settings: PathFollowingSettings, models: list[Model], runs: Runs
) -> PathFollowingStudy:
    """Run all cases with every model, one of which is `runs.model`, and the held-out trial."""
    following_runs = _FollowingRuns(settings=settings, models=models, runs=runs)
    cases = following_runs.run_groups()
    return PathFollowingStudy(
        settings=settings,
        trial_settings=cases[0].trial.settings,
        cases=tuple(cases),
        held_out=following_runs.run_held_out(),
    )


def group_by_law(case: FollowingCase) -> dict[str, list[FollowingRun]]:
    """Return the band of a case, by joint law.

    Args:
        case: Case of the study.
    """
    runs_by_law: dict[str, list[FollowingRun]] = {}
    for run in case.band:
        runs_by_law.setdefault(run.joints, []).append(run)
    return runs_by_law


# ---- figures of a run ----------------------------------------------------------------------------


def figures_of(trial: Trial, distance: float) -> FollowingRun:
    """Return the settings and figures that are kept of a run along the x axis.

    Args:
        trial: A run of `laticauda.control.PathFollowing` with a gait that moves.
        distance: Progress in x after which the run was to end [m].
    """
    period = trial.period
    assert period is not None  # no case stands still
    controller: Any = getattr(trial.scenario, "motion", None)  # a measured trial has none
    assert isinstance(controller, lc.PathFollowing)
    trial_settings: dict[str, Any] = {name: trial.settings[name] for name in _KEPT_SETTINGS}

    progress = trial.center_of_mass[-1, 0] - trial.center_of_mass[0, 0]
    reached = "time"
    if progress >= distance:
        reached = "distance"

    steady_velocity = None
    if trial.duration >= TRANSIENT + period:
        steady_velocity = trial.steady_velocity

    last_third_rms = None
    last_third_largest = None
    if trial.duration >= 1.5 * period:
        error = following.last_third(trial.time, trial.signals["cross_track_error"], period)
        last_third_rms = float(np.sqrt(np.mean(error**2)))
        last_third_largest = float(np.max(np.abs(error)))

    is_late = trial.time - trial.time[0] >= 2.0 / 3.0 * trial.duration
    return FollowingRun(
        **trial_settings,
        heading_estimate=controller.heading_estimate,
        reached=reached,
        duration=trial.duration,
        forward_velocity=trial.forward_velocity,
        path_speed=trial.path_speed,
        steady_velocity=steady_velocity,
        mechanical_power=trial.mechanical_power,
        joules_per_meter=trial.mechanical_power / trial.forward_velocity,
        figures=following.summarize_following(trial),
        last_third_rms=last_third_rms,
        last_third_largest=last_third_largest,
        offset_swing=float(np.sqrt(2.0) * np.std(trial.signals["offset"][is_late])),
    )


# ---- running -------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class _Task:
    """What swims, whatever the model and the heading."""

    name: str
    """Name for messages."""
    robot: str
    """The robot's name."""
    gait: lc.Gait
    """Gait without the steering."""


class _RunAlongPath(NamedTuple):
    """A run along the path."""

    task: _Task
    """What swims."""
    model: Model
    """Model that computes it."""
    start: lc.Start
    """Its start."""
    heading_estimate: str
    """Heading that is used: raw or cycle_mean."""


class _Row(NamedTuple):
    """A row of Table 2 before its runs."""

    group: Group
    """Part of the table to which it belongs."""
    measured: MeasuredPathFollowing
    """What was measured."""
    figure: int
    """Number of the paper's figure."""
    free_velocity: float
    """Steady velocity of the same gait, unsteered [m/s]."""

    def run_along_path(self, model: Model, heading_estimate: str) -> _RunAlongPath:
        """Return a run of this row."""
        measured = self.measured
        task = _Task(
            name=f"{self.group.name}, case {measured.case}",
            robot=self.group.robot,
            gait=measured.gait,
        )
        start = lc.Start(
            center_of_mass=(0.0, measured.initial_cross_track_error),
            heading=measured.initial_heading,
        )
        return _RunAlongPath(task, model, start, heading_estimate)


def _free_task(group: Group) -> _Task:
    """Return what swims when nothing steers the gait of a group."""
    return _Task(
        name=f"{group.name}, unsteered",
        robot=group.robot,
        gait=group.path_following_cases[0].gait,
    )


@dataclass(frozen=True, kw_only=True)
class _FollowingRuns:
    """Runs all trials of a study."""

    settings: PathFollowingSettings
    """Settings of the study."""
    models: list[Model]
    """Models of the band."""
    runs: Runs
    """Runner; its model is the chosen one."""

    def run_groups(self) -> list[FollowingCase]:
        """Run all cases of all groups, side by side: with every model of the band, and with the cycle-mean heading."""
        rows: list[_Row] = []
        runs_along_path: list[_RunAlongPath] = []
        for group in self.settings.groups:
            free_velocity = self._swim_unsteered(_free_task(group)).steady_velocity
            for measured, figure in zip(group.path_following_cases, group.figures, strict=True):
                row = _Row(group, measured, figure, free_velocity)
                rows.append(row)
                for model in self.models:
                    runs_along_path.append(row.run_along_path(model, "raw"))
                runs_along_path.append(row.run_along_path(self.runs.model, "cycle_mean"))
        trials = self._swim_along_path(runs_along_path)
        n_of_row = len(self.models) + 1
        return [
            self._build_case(row, trials[n_of_row * i : n_of_row * (i + 1)])
            for i, row in enumerate(rows)
        ]

    def _build_case(self, row: "_Row", trials: list[Trial]) -> FollowingCase:
        """Return a case from its trials: one for every model of the band, then that with the cycle-mean heading."""
        *trials_of_band, cycle_mean = trials
        band = [self._figures(trial) for trial in trials_of_band]
        chosen = self.models.index(self.runs.model)
        return FollowingCase(
            measured=row.measured,
            group=row.group,
            figure=row.figure,
            trial=trials_of_band[chosen],
            run=band[chosen],
            band=tuple(band),
            cycle_mean=self._figures(cycle_mean),
            free_velocity=row.free_velocity,
        )

    def run_held_out(self) -> HeldOutRun:
        """Run the trial of another publication."""
        held_out = self.settings.held_out
        task = _Task(name="The held-out trial", robot=held_out.robot, gait=held_out.gait)
        start = lc.Start(
            center_of_mass=(0.0, held_out.initial_cross_track_error),
            heading=held_out.initial_heading,
        )
        (trial,) = self._swim_along_path([_RunAlongPath(task, self.runs.model, start, "raw")])
        period = trial.period
        assert period is not None
        elapsed = trial.time - trial.time[0]
        velocity = trial.center_of_mass_velocity
        along_heading = velocity[:, 0] * np.cos(trial.heading) + velocity[:, 1] * np.sin(
            trial.heading
        )
        middles, mean_along_heading = following.mean_error(trial.time, along_heading, period)
        is_after_first_cycle = middles - trial.time[0] >= 1.5 * period
        return HeldOutRun(
            settings=held_out,
            trial=trial,
            run=self._figures(trial),
            velocity=_range_of(along_heading[elapsed >= period]),
            mean_velocity=_range_of(mean_along_heading[is_after_first_cycle]),
            offset=_range_of(trial.signals["offset"]),
        )

    def _figures(self, trial: Trial) -> FollowingRun:
        return figures_of(trial, self.settings.distance)

    def _swim_unsteered(self, task: _Task) -> Trial:
        """Return the trial of a gait that nothing steers, with the chosen model."""
        model = self.runs.model
        return self.runs.swim(_name_run(task, model), self._unsteered_scenario(task, model))

    def _swim_along_path(self, runs_along_path: "list[_RunAlongPath]") -> list[Trial]:
        """Return the trials of runs along the path, each of which ends at the distance of the settings."""
        tasks: list[NamedScenario] = []
        ends: list[float] = []
        for run in runs_along_path:
            scenario = replace(
                self._unsteered_scenario(run.task, run.model),
                motion=self.settings.controller(run.task.gait, run.heading_estimate),
                start=run.start,
            )
            tasks.append(NamedScenario(_name_run(run.task, run.model), scenario))
            ends.append(run.start.center_of_mass[0] + self.settings.distance)
        end_of_run = np.array(ends)

        def has_arrived(observations: Observations, index: np.ndarray) -> np.ndarray:
            return observations.center_of_mass[:, 0] >= end_of_run[index]

        return self.runs.swim_side_by_side(tasks, has_arrived)

    def _unsteered_scenario(self, task: _Task, model: Model) -> lc.Scenario:
        coefficients: Coefficients = self.settings.coefficients
        return coefficients.build_scenario(
            task.robot, task.gait, model=model, duration=self.settings.duration
        )


def _name_run(task: _Task, model: Model) -> str:
    joints = name_of(type(model.joints))
    return f"{task.name}, joints {joints}, bandwidth {model.offset_bandwidth:g} rad/s"


def _range_of(values: np.ndarray) -> tuple[float, float]:
    return float(np.min(values)), float(np.max(values))
