"""The path-following study: the 12 trials of Table 2 in all combinations of the band, and one of another publication.

It repeats the trials behind the paper's Figs. 12 to 23 and Table 2. Its findings about the table
are computed in `scores`.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import laticauda as lc
from laticauda.paper.measured import MeasuredPathFollowing, percent_change
from laticauda.paper.runs import Runs, Study
from laticauda.paper.settings import Group, HeldOut, PathFollowingSettings, path_following_settings
from laticauda.scenarios import Model, loop_in_words
from laticauda.trials import Trial, following
from laticauda.trials.cycles import TRANSIENT
from laticauda.values.extensions import name_of
from laticauda.values.quantities import option, quantity, value_class


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
        heading = {"raw": "raw", "cycle_mean": "cycle-mean"}[self.heading_estimate]
        loop = loop_in_words(vars(self)).removeprefix("bandwidth ")
        return f"{self.joints} joints, {loop}, {heading} heading"

    @property
    def converged(self) -> bool:
        """Whether at some time the cycle-mean error stayed within 0.1 m for a whole cycle."""
        return self.figures["convergence_time"] is not None


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
        """Return the change of steady velocity caused by closing the loop; None for a run that is too short [%].

        Args:
            run: Run of this case.
        """
        return (
            None
            if run.steady_velocity is None
            else percent_change(self.free_velocity, run.steady_velocity)
        )


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
    """Settings and results of the path-following study; `how` describes the chosen runs."""

    cases: tuple[FollowingCase, ...]
    """All rows of Table 2, in its order."""
    held_out: HeldOutRun
    """The trial of another publication."""
    own: "tuple[PathFollowingStudy, ...]" = ()
    """The same study with each of the models that have their own joints, each in a single combination."""

    usual = staticmethod(path_following_settings)

    @property
    def ways(self) -> "tuple[PathFollowingStudy, ...]":
        """For each combination of the band, the study as if that were chosen; trials remain those of the chosen one."""
        ways = range(len(self.cases[0].band))
        return tuple(
            replace(self, cases=tuple(replace(one, run=one.band[i]) for one in self.cases))
            for i in ways
        )

    @classmethod
    def by_runs(cls, settings: PathFollowingSettings, runs: Runs) -> "PathFollowingStudy":
        """Run the trials of `settings` by `runs`, and return the study.

        Args:
            settings: Settings of the study.
            runs: Runner, with the model and the progress callback.
        """
        chosen = runs.model
        law = name_of(type(chosen.joints))
        ways = [
            replace(chosen, offset_bandwidth=bandwidth)
            if joints == law
            else replace(chosen, joints=lc.JointLaw.of(joints), offset_bandwidth=bandwidth, dt=None)
            for joints, bandwidth in settings.band(law, chosen.offset_bandwidth)
        ]
        runs.n_runs = settings.n_runs(law, chosen.offset_bandwidth)
        study, own = cls._of(settings, ways, runs), list[PathFollowingStudy]()
        for one in settings.own:
            runs = replace(runs, model=one.driven(chosen))
            own.append(cls._of(replace(settings, coefficients=one, own=()), [runs.model], runs))
        return replace(study, own=tuple(own))

    @classmethod
    def _of(
        cls, settings: PathFollowingSettings, ways: list[Model], runs: Runs
    ) -> "PathFollowingStudy":
        pool = _Pool(settings=settings, ways=ways, runs=runs)
        cases = [case for group in settings.groups for case in pool.cases(group)]
        how = cases[0].trial.settings
        return PathFollowingStudy(
            settings=settings, how=how, cases=tuple(cases), held_out=pool.held_out()
        )


def group_by_law(case: FollowingCase) -> dict[str, list[FollowingRun]]:
    """Return the band of a case, by joint law.

    Args:
        case: Case of the study.
    """
    found: dict[str, list[FollowingRun]] = {}
    for run in case.band:
        found.setdefault(run.joints, []).append(run)
    return found


run_path_following = PathFollowingStudy.run


def figures_of(trial: Trial, distance: float) -> FollowingRun:
    """Return the settings and figures that are kept of a run along the x axis.

    Args:
        trial: A run of `laticauda.control.PathFollowing` with a gait that moves.
        distance: Progress in x after which the run was to end [m].
    """
    time, period = trial.time, trial.period
    assert period is not None  # no case stands still
    late = time - time[0] >= 2.0 / 3.0 * trial.duration
    rms = largest = None
    if trial.duration >= 1.5 * period:
        last = following.last_third(time, trial.signals["cross_track_error"], period)
        rms, largest = float(np.sqrt(np.mean(last**2))), float(np.max(np.abs(last)))
    names = "joints", "offset_bandwidth", "loop_delay", "dt", "ramp"
    how: dict[str, Any] = {name: trial.settings[name] for name in names}
    controller: Any = getattr(trial.scenario, "motion", None)  # a measured trial has none
    assert isinstance(controller, lc.PathFollowing)
    progress = trial.center_of_mass[-1, 0] - trial.center_of_mass[0, 0]
    return FollowingRun(
        **how,
        heading_estimate=controller.heading_estimate,
        reached="distance" if progress >= distance else "time",
        duration=trial.duration,
        forward_velocity=trial.forward_velocity,
        path_speed=trial.path_speed,
        steady_velocity=trial.steady_velocity if trial.duration >= TRANSIENT + period else None,
        mechanical_power=trial.mechanical_power,
        joules_per_meter=trial.mechanical_power / trial.forward_velocity,
        figures=following.summarize_following(trial),
        last_third_rms=rms,
        last_third_largest=largest,
        offset_swing=float(np.sqrt(2.0) * np.std(trial.signals["offset"][late])),
    )


@dataclass(frozen=True, kw_only=True)
class _Pool:
    """Common settings of all runs."""

    settings: PathFollowingSettings
    ways: list[Model]
    runs: Runs

    def cases(self, group: Group) -> Iterator[FollowingCase]:
        """Run and yield all cases of a group."""
        free = self._swim(
            f"{group.name}, unsteered", group.robot, group.followed[0].gait, self.runs.model
        )
        for row, figure in zip(group.followed, group.figures, strict=True):
            start = lc.Start(
                center_of_mass=(0.0, row.initial_cross_track_error), heading=row.initial_heading
            )
            task = (f"{group.name}, case {row.case}", group.robot, row.gait)
            trials = [self._swim(*task, way, start, "raw") for way in self.ways]
            band, place = [*map(self._figures, trials)], self.ways.index(self.runs.model)
            yield FollowingCase(
                measured=row,
                group=group,
                figure=figure,
                trial=trials[place],
                run=band[place],
                band=tuple(band),
                cycle_mean=self._figures(self._swim(*task, self.runs.model, start, "cycle_mean")),
                free_velocity=free.steady_velocity,
            )

    def held_out(self) -> HeldOutRun:
        """Run the trial of another publication."""
        held = self.settings.held_out
        start = lc.Start(
            center_of_mass=(0.0, held.initial_cross_track_error), heading=held.initial_heading
        )
        trial = self._swim(
            "The held-out trial", held.robot, held.gait, self.runs.model, start, "raw"
        )
        time, period, velocity = trial.time, trial.period, trial.center_of_mass_velocity
        assert period is not None
        ahead = velocity[:, 0] * np.cos(trial.heading) + velocity[:, 1] * np.sin(trial.heading)
        middle, mean = following.mean_error(time, ahead, period)
        return HeldOutRun(
            settings=held,
            trial=trial,
            run=self._figures(trial),
            velocity=_range(ahead[time - time[0] >= period]),
            mean_velocity=_range(mean[middle - time[0] >= 1.5 * period]),
            offset=_range(trial.signals["offset"]),
        )

    def _figures(self, trial: Trial) -> FollowingRun:
        return figures_of(trial, self.settings.distance)

    def _swim(
        self,
        what: str,
        robot: str,
        gait: lc.Gait,
        way: Model,
        start: lc.Start | None = None,
        heading: str = "",
    ) -> Trial:
        """Return the trial of a run along the path from a start; without a start, of an unsteered run."""
        settings, name = self.settings, f"{what}, joints {name_of(type(way.joints))}, bandwidth"
        swimmer = settings.coefficients.scenario(robot, gait, model=way, duration=settings.duration)
        name = f"{name} {way.offset_bandwidth:g} rad/s"
        if start is None:
            return self.runs.swim(name, swimmer)
        steered, end = (
            settings.controller(gait, heading),
            start.center_of_mass[0] + settings.distance,
        )
        steered = replace(swimmer, motion=steered, start=start)
        return self.runs.swim(name, steered, until=lambda seen: bool(seen.center_of_mass[0] >= end))


def _range(values: np.ndarray) -> tuple[float, float]:
    return float(np.min(values)), float(np.max(values))
