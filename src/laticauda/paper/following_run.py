"""What the path-following study keeps of every run."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from laticauda.control import PathFollowing
from laticauda.trial import Trial, following
from laticauda.trial.cycles import TRANSIENT


@dataclass(frozen=True, kw_only=True)
class FollowingRun:
    """How one run was made, and its figures."""

    joints: str
    """How the joints follow the gait."""
    offset_bandwidth: float
    """Of the reference generator [rad/s]."""
    heading_estimate: str
    """raw or cycle_mean."""
    dt: float
    """Largest time step [s]."""
    ramp: float
    """Duration of the smooth start [s]."""
    reached: str
    """What ended it: time or distance."""
    duration: float
    """How long it was [s]."""
    forward_velocity: float
    """Equation (5), over the whole run [m/s]."""
    path_speed: float
    """Length of the center of mass's path / time [m/s]."""
    steady_velocity: float | None
    """Equation (5) over whole gait cycles after the transient; None for a run that is too short [m/s]."""
    mechanical_power: float
    """Mean of sum |u phi'| [W]."""
    joules_per_meter: float
    """Mechanical power / forward velocity [J/m]."""
    figures: Mapping[str, float | None]
    """By the names of `laticauda.trial.following.FIGURES`; None where the run has no such figure."""
    last_third_rms: float | None
    """Root mean square of the cycle-mean error over the last third, so that a limit cycle cannot pass as converged;
    None for a run that is too short [m]."""
    last_third_largest: float | None
    """Largest cycle-mean error to either side over the last third; None for a run that is too short [m]."""
    offset_swing: float
    """Amplitude of the offset that was asked for over the last third, sqrt(2) times its standard deviation: what
    steering adds to the gait [rad]."""

    @property
    def name(self) -> str:
        """Joint law, bandwidth and heading in words."""
        heading = {"raw": "raw", "cycle_mean": "cycle-mean"}[self.heading_estimate]
        return f"{self.joints} joints, {self.offset_bandwidth:g} rad/s, {heading} heading"

    @property
    def converged(self) -> bool:
        """Whether its cycle-mean error stayed within 0.1 m for a whole cycle, at some time."""
        return self.figures["convergence_time"] is not None


def figures_of(trial: Trial, distance: float) -> FollowingRun:
    """What is kept of a run along the x axis.

    Args:
        trial: A run of `laticauda.control.PathFollowing` with a gait that moves.
        distance: Progress in x after which it was to end [m].
    """
    time, period = trial.time, trial.period
    assert period is not None  # no case stands still
    late = time - time[0] >= 2.0 / 3.0 * trial.duration
    rms = largest = None
    if trial.duration >= 1.5 * period:
        middle, error = following.mean_error(time, trial.signals["cross_track_error"], period)
        last = error[middle - time[0] >= 2.0 / 3.0 * trial.duration]
        rms, largest = float(np.sqrt(np.mean(last**2))), float(np.max(np.abs(last)))
    how: Any = trial.settings
    controller: Any = getattr(trial.scenario, "motion", None)  # a measured trial has none
    assert isinstance(controller, PathFollowing)
    progress = trial.center_of_mass[-1, 0] - trial.center_of_mass[0, 0]
    return FollowingRun(
        joints=str(how["joints"]),
        offset_bandwidth=float(how["offset_bandwidth"]),
        heading_estimate=controller.heading_estimate,
        dt=float(how["dt"]),
        ramp=float(how["ramp"]),
        reached="distance" if progress >= distance else "time",
        duration=trial.duration,
        forward_velocity=trial.forward_velocity,
        path_speed=trial.path_speed,
        steady_velocity=trial.steady_velocity if trial.duration >= TRANSIENT + period else None,
        mechanical_power=trial.mechanical_power,
        joules_per_meter=trial.mechanical_power / trial.forward_velocity,
        figures=following.summary(trial),
        last_third_rms=rms,
        last_third_largest=largest,
        offset_swing=float(np.sqrt(2.0) * np.std(trial.signals["offset"][late])),
    )
