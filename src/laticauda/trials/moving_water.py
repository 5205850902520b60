"""What a current does to a run, in words."""

import numpy as np

from laticauda.robot import Ground, Water
from laticauda.trials import metrics
from laticauda.trials.contents import Contents

THROUGH_WATER = ("speed_through_water", "steady_speed_through_water")
"""Figures that are shown only where the water moves; in still water they are those over ground."""
MOVING_WATER_NOTE = (
    "The water moves: forward velocity is over ground, costs per distance rest on the speed "
    "through the water."
)


def water_moves(environment: Water | Ground) -> bool:
    """Return whether a robot swims in water that moves."""
    return isinstance(environment, Water) and not environment.is_still


def describe_sweeping(trial: Contents) -> str:
    """Return a sentence if moving water sweeps a robot backward, against its heading; "" if it does not.

    Args:
        trial: Any trial, including a failed one.
    """
    is_known = "heading" not in trial.not_measured and trial.time.size > 1 and trial.succeeded
    if not is_known or not water_moves(trial.environment):
        return ""
    speeds_ahead = _mean_speeds_ahead(trial)
    if speeds_ahead[0] >= 0.0:
        return ""
    displacement = (trial.center_of_mass[-1] - trial.center_of_mass[0])[:2]
    course = np.degrees(np.arctan2(displacement[1], displacement[0]))
    heading = np.degrees(np.angle(np.mean(np.exp(1j * trial.heading))))
    cause = "The water sweeps the robot backward"
    if speeds_ahead[1] < 0.0:
        cause = "The robot moves tail first, through the water and over ground"
    return f"{cause}: it heads {heading:z.0f} deg, but travels toward {course:z.0f} deg."


def _mean_speeds_ahead(trial: Contents) -> tuple[float, float]:
    """Return the mean speed along the heading, over ground and through the water [m/s]."""
    ahead = np.stack((np.cos(trial.heading), np.sin(trial.heading)), axis=1)
    water = trial.environment
    assert isinstance(water, Water)
    over_ground = trial.center_of_mass_velocity[:, :2]
    water_velocity = water.velocity(trial.center_of_mass, trial.time)[:, :2]
    through_water = over_ground - water_velocity
    duration = metrics.log_duration(trial.time)
    means: list[float] = []
    for velocity in (over_ground, through_water):
        advance = metrics.cumulative_integral(trial.time, np.sum(velocity * ahead, axis=1))
        means.append(float(advance[-1]) / duration)
    return means[0], means[1]
