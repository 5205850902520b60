"""The path-following study: the 12 trials of Table 2 in every way of the band, and a trial of another publication.

It repeats the trials behind the paper's Figs. 12 to 23 and Table 2. What it finds about the table is computed in
`table2`.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import count
from typing import Any

import numpy as np

from laticauda.control import HeadingController, LineOfSight, PathFollowing, StraightLine
from laticauda.gaits import Gait
from laticauda.interfaces import Command, Controller, Observation, OpenLoop, Start
from laticauda.packaging import __version__
from laticauda.paper.following_run import FollowingRun, figures_of
from laticauda.paper.following_settings import (
    FollowingGroup,
    HeldOut,
    PathFollowingSettings,
    path_following_settings,
)
from laticauda.paper.measured import MeasuredPathFollowing
from laticauda.paper.swimmers import run_named
from laticauda.robot import load_robot
from laticauda.simulate import plant
from laticauda.simulate.runner import Until
from laticauda.studies.progress import Progress
from laticauda.trial import Trial, following
from laticauda.trial.contents import Setting

Way = tuple[str, float]
"""Joint law and bandwidth of the reference generator [rad/s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FollowingCase:
    """One row of Table 2, measured and simulated."""

    measured: MeasuredPathFollowing
    """The row: gait, initial conditions and what was measured."""
    group: FollowingGroup
    """The part of the table that it is in."""
    figure: int
    """Number of the paper's figure."""
    trial: Trial
    """With the chosen joints and bandwidth, raw heading: what the figure shows."""
    run: FollowingRun
    """Its figures."""
    band: tuple[FollowingRun, ...]
    """Raw heading, every way of the band, the chosen one among them."""
    cycle_mean: FollowingRun
    """With the mean heading over the gait cycle, other things equal to the chosen run."""
    free_velocity: float
    """Steady velocity of the same gait with the chosen joints, unsteered [m/s]."""

    @property
    def is_in_band(self) -> bool:
        """Whether the measured speed lies in the band of the simulated ones."""
        speeds = [run.forward_velocity for run in self.band]
        return min(speeds) <= self.measured.forward_velocity <= max(speeds)

    def change_by_the_loop(self, run: FollowingRun) -> float | None:
        """By how much closing the loop changes the steady velocity; None for a run that is too short [%].

        Args:
            run: Of this case.
        """
        return None if run.steady_velocity is None else 100.0 * (run.steady_velocity / self.free_velocity - 1.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class HeldOutRun:
    """The trial of another publication, with the chosen joints and bandwidth, raw heading."""

    settings: HeldOut
    """Its initial conditions, and the published ranges."""
    trial: Trial
    """The run."""
    run: FollowingRun
    """Its figures."""
    velocity: tuple[float, float]
    """Smallest and largest velocity along the heading, after the first gait cycle [m/s]."""
    mean_velocity: tuple[float, float]
    """The same of its mean over the gait cycle around each moment [m/s]."""
    offset: tuple[float, float]
    """Smallest and largest offset that was asked for [rad]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PathFollowingStudy:
    """What the path-following study ran, and what came out."""

    settings: PathFollowingSettings
    """What was run."""
    how: Mapping[str, Setting]
    """How the chosen runs were computed: model, joints, dt [s], offset_bandwidth [rad/s], ramp [s] and the like."""
    version: str
    """Version of laticauda that ran it."""
    cases: tuple[FollowingCase, ...]
    """All rows of Table 2 in its order."""
    held_out: HeldOutRun
    """The trial of another publication."""


def run_path_following(
    settings: PathFollowingSettings | None = None,
    *,
    model: str = "planar",
    joints: str = "prescribed",
    dt: float | None = None,
    offset_bandwidth: float = 10.0,
    progress: Progress | None = None,
) -> PathFollowingStudy:
    """Run the path-following study: every case of Table 2, straight and from rest, along the x axis.

    Args:
        settings: None takes those of the paper.
        model: See `laticauda.simulate.plant`.
        joints: Of the chosen runs; see `laticauda.simulate.plant`.
        dt: Of the runs with these joints; others take a converged one; see `laticauda.simulate.plant` [s].
        offset_bandwidth: Of the chosen runs; see `laticauda.simulate.plant` [rad/s].
        progress: Called after every run with the number of runs done, and of all.

    Returns:
        The logs of the chosen runs, and figures of all.

    Raises:
        ValueError: If an argument is out of its range.
        SimulationFailed: If a run blows up; the message says which.
    """
    settings = settings or path_following_settings()
    n_runs = settings.n_runs(joints, offset_bandwidth)
    done = count(1)

    def tell() -> None:
        if progress is not None:
            progress(next(done), n_runs)

    pool = _Pool(
        settings=settings, model=model, joints=joints, dt=dt, offset_bandwidth=float(offset_bandwidth), tell=tell
    )
    cases = [case for group in settings.groups for case in pool.cases(group)]
    return PathFollowingStudy(
        settings=settings,
        how=cases[0].trial.settings,
        version=__version__,
        cases=tuple(cases),
        held_out=pool.held_out(),
    )


@dataclass(frozen=True, kw_only=True)
class _Pool:
    """Where everything swims: what all runs have in common."""

    settings: PathFollowingSettings
    model: str
    joints: str
    dt: float | None
    offset_bandwidth: float
    tell: Callable[[], None]

    @property
    def chosen(self) -> Way:
        return self.joints, self.offset_bandwidth

    def cases(self, group: FollowingGroup) -> Iterator[FollowingCase]:
        """All cases of a group."""
        still = OpenLoop(command=Command(gait=group.measured[0].gait))
        free = self._swim(f"{group.name}, unsteered", group.robot, still, Start(), self.chosen)
        for row, figure in zip(group.measured, group.figures, strict=True):
            start = Start(center_of_mass=(0.0, row.initial_cross_track_error), heading=row.initial_heading)
            task = (f"{group.name}, case {row.case}", group.robot, row.gait, start)
            band = {way: self._follow(*task, way) for way in self.settings.band(*self.chosen)}
            trial, run = band[self.chosen]
            yield FollowingCase(
                measured=row,
                group=group,
                figure=figure,
                trial=trial,
                run=run,
                band=tuple(each for _, each in band.values()),
                cycle_mean=self._follow(*task, self.chosen, "cycle_mean")[1],
                free_velocity=free.steady_velocity,
            )

    def held_out(self) -> HeldOutRun:
        """The trial of another publication."""
        held = self.settings.held_out
        start = Start(center_of_mass=(0.0, held.initial_cross_track_error), heading=held.initial_heading)
        return _held_out(held, *self._follow("The held-out trial", held.robot, held.gait, start, self.chosen))

    def _follow(
        self, what: str, robot: str, gait: Gait, start: Start, way: Way, heading: str = "raw"
    ) -> tuple[Trial, FollowingRun]:
        end = start.center_of_mass[0] + self.settings.distance

        def is_there(seen: Observation) -> bool:
            return bool(seen.center_of_mass[0] >= end)

        trial = self._swim(what, robot, _controller(self.settings, gait, heading), start, way, is_there)
        return trial, figures_of(trial, self.settings.distance)

    def _swim(
        self,
        what: str,
        robot: str,
        controller: Controller[Any],
        start: Start,
        way: Way,
        until: Until | None = None,
    ) -> Trial:
        joints, bandwidth = way
        kind, coefficients = controller.gait.kind, self.settings.coefficients
        body = plant(
            coefficients.robot(load_robot(robot), kind),
            coefficients.water(kind),
            model=self.model,
            joints=joints,
            dt=self.dt if joints == self.joints else None,
            offset_bandwidth=bandwidth,
        )
        name = f"{what}, joints {joints}, bandwidth {bandwidth:g} rad/s"
        trial = run_named(name, body, controller, self.settings.duration, start=start, until=until)
        self.tell()
        return trial


def _controller(settings: PathFollowingSettings, gait: Gait, heading: str) -> PathFollowing:
    return PathFollowing(
        gait=gait,
        path=StraightLine(),
        guidance=LineOfSight(look_ahead_distance=settings.look_ahead_distance),
        heading=HeadingController(gain=settings.gain, max_offset=settings.max_offset),
        heading_estimate=heading,
        interval=settings.control_interval,
    )


def _held_out(settings: HeldOut, trial: Trial, found: FollowingRun) -> HeldOutRun:
    time, period, velocity = trial.time, trial.period, trial.center_of_mass_velocity
    assert period is not None
    ahead = velocity[:, 0] * np.cos(trial.heading) + velocity[:, 1] * np.sin(trial.heading)
    middle, mean = following.mean_error(time, ahead, period)
    return HeldOutRun(
        settings=settings,
        trial=trial,
        run=found,
        velocity=_range(ahead[time - time[0] >= period]),
        mean_velocity=_range(mean[middle - time[0] >= 1.5 * period]),
        offset=_range(trial.signals["offset"]),
    )


def _range(values: np.ndarray) -> tuple[float, float]:
    return float(np.min(values)), float(np.max(values))
