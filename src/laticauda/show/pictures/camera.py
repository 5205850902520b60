"""Cameras: one that follows a robot smoothly, one beside it, one above it, and a fixed one that shows everything.

A camera that follows looks at the robot without the ripple of its strokes, see `remove_ripple`.
"""

import math
from typing import Any, Literal, NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.models.spatial import straight_center_of_mass
from laticauda.robot import Robot
from laticauda.trials import Trial
from laticauda.values import check_within, load_mujoco, option, quantity, value_class

Camera = Literal["follow", "side", "top", "fixed"]
VIEW_DEG = 36.0
"""Vertical angle of view [deg]."""


class Direction(NamedTuple):
    """Where a camera looks."""

    below_horizontal: float
    """[deg]."""
    from_heading: float
    """Direction relative to the robot's own [deg]."""


DIRECTIONS = {
    "follow": Direction(24.0, 118.0),  # from its right, with the head toward us
    "side": Direction(3.0, 90.0),
    "top": Direction(89.9, 90.0),
    "fixed": Direction(32.0, 90.0),
}
ROOM = 1.36
"""Width of the picture at the robot, in robot lengths."""
BELOW = 0.07
"""How far below the robot `follow` looks, to show its shadow, in robot lengths."""
CALM_POSITION = 0.75
"""Time scale over which the position is smoothed, in periods of the gait."""
CALM_HEADING = 1.5
"""Time scale over which the heading is smoothed, in periods of the gait."""
PERIOD = 2.0
"""Period that is assumed if there is no gait [s]."""
LONGEST_PERIOD = 10.0
"""Largest period that is smoothed [s]."""


@value_class
class Film:
    """Contents and size of a film or a picture of a trial.

    Raises:
        ValueError: If a field is out of range.
    """

    size: tuple[int, int] = quantity(
        "", "Width and height in pixels", ge=64, le=4096, default=(1280, 720)
    )
    frames_per_second: float = quantity(
        "1/s", "Frames per second of the film", gt=0.0, le=240.0, default=30.0
    )
    begin: float | None = quantity(
        "s", "Time in the trial at which the film begins; its start if omitted", default=None
    )
    end: float | None = quantity(
        "s", "Time in the trial at which the film ends; its end if omitted", default=None
    )
    camera: Camera = option(
        "`follow`, `side` and `top` turn with the robot; `fixed` sees it all", default="follow"
    )

    @property
    def aspect(self) -> float:
        """Aspect ratio of the pictures, width over height [-]."""
        width, height = self.size
        return width / height

    def span(self, trial: Trial) -> tuple[float, float]:
        """Return the times at which the film begins and ends in a trial [s].

        Args:
            trial: The trial.

        Raises:
            ValueError: If it is not within the trial.
        """
        begin = float(trial.time[0])
        end = float(trial.time[-1])
        if self.begin is not None:
            begin = check_within("begin", self.begin, begin, end, "s")
        if self.end is not None:
            end = check_within("end", self.end, begin, end, "s")
        return begin, end


def aim_at_trial(trial: Trial, time: float, height: float, film: Film) -> Any:
    """Return a film's camera for a trial at a given time, as a `MjvCamera`.

    Args:
        trial: Any trial.
        time: Time within the trial [s].
        height: Height at which a planar robot swims [m].
        film: The film with its camera.
    """
    if film.camera == "fixed":
        return _aim_at_whole_trial(trial, height, film)
    period = estimate_ripple_period(trial)
    center = remove_ripple(
        trial.time, trial.center_of_mass, moment=time, width=CALM_POSITION * period
    )
    heading = remove_ripple(trial.time, trial.heading, moment=time, width=CALM_HEADING * period)
    return aim_camera(
        trial.robot,
        center=lift_to_space(center, height),
        heading=float(heading),
        aspect=film.aspect,
        camera=film.camera,
    )


def _aim_at_whole_trial(trial: Trial, height: float, film: Film) -> Any:
    """Return a camera that sees the robot during the whole film."""
    begin, end = film.span(trial)
    is_filmed = (trial.time >= begin) & (trial.time <= end)
    center = trial.center_of_mass[is_filmed]
    heading = trial.heading[is_filmed]
    half_robot = 0.5 * trial.robot.reach * np.stack((np.cos(heading), np.sin(heading)), axis=1)
    ends = np.concatenate((center[:, :2] - half_robot, center[:, :2] + half_robot))
    low = center.min(axis=0)
    high = center.max(axis=0)
    low[:2] = ends.min(axis=0)
    high[:2] = ends.max(axis=0)
    width = float(high[0] - low[0])
    depth = float(high[1] - low[1])
    return aim_camera(
        trial.robot,
        center=lift_to_space(0.5 * (low + high), height),
        heading=0.0,
        aspect=film.aspect,
        camera=film.camera,
        wide=max(width, film.aspect * depth),
    )


def aim_camera(
    robot: Robot,
    center: Float[np.ndarray, "3"],
    heading: float,
    aspect: float,
    camera: Camera = "follow",
    wide: float = 0.0,
) -> Any:
    """Return a camera that looks at a robot, as a `MjvCamera`.

    Args:
        robot: The robot to show.
        center: Its center of mass [m].
        heading: Heading of the robot [rad].
        aspect: Aspect ratio of the picture, width over height [-].
        camera: `follow`, `side` (beside it) and `top` (above) turn with the robot; `fixed` stays in
            place.
        wide: Minimum width to be seen [m].
    """
    direction = DIRECTIONS[camera]
    ahead = 0.0
    if camera != "fixed":
        ahead = middle_ahead_of_center(robot)
    below = 0.0
    if camera == "follow":
        below = BELOW * robot.reach
    offset = np.array((ahead * math.cos(heading), ahead * math.sin(heading), -below))
    half_width = 0.5 * ROOM * max(robot.reach, wide)
    half_view = math.atan(math.tan(math.radians(0.5 * VIEW_DEG)) * aspect)
    mujoco_camera = load_mujoco().MjvCamera()
    mujoco_camera.lookat = center + offset
    mujoco_camera.distance = half_width / math.tan(half_view)
    mujoco_camera.azimuth = math.degrees(heading) + direction.from_heading
    mujoco_camera.elevation = -direction.below_horizontal
    return mujoco_camera


def lift_to_space(position: np.ndarray, height: float) -> Float[np.ndarray, "3"]:
    """Return a position in space, at a given height if it is planar [m]."""
    if position.size == 3:
        return position
    return np.append(position, height)


def middle_ahead_of_center(robot: Robot) -> float:
    """Return how far the middle of the straight robot with its fin is ahead of its center of mass [m]."""
    fin_length = 0.0
    if robot.caudal_fin is not None:
        fin_length = robot.caudal_fin.length
    return 0.5 * (robot.length - fin_length) - straight_center_of_mass(robot)


# ---- smoothing -----------------------------------------------------------------------------------


def estimate_ripple_period(trial: Trial) -> float:
    """Return the period of the ripple in speed and heading [s]."""
    return min(trial.period or PERIOD, LONGEST_PERIOD)


def remove_ripple(
    time: Float[np.ndarray, " n"], values: Float[np.ndarray, "n ..."], moment: float, width: float
) -> np.ndarray:
    """Return a signal without its ripple: the value at a moment of the best-fit straight line around it.

    Unlike a mean, it does not lag at the ends of the log.

    Args:
        time: Times of the samples [s].
        values: The signal.
        moment: The moment [s].
        width: Standard deviation of the samples' weights around that moment [s].
    """
    lead = time - moment
    nearest = float(np.min(np.abs(lead)))
    is_near = np.abs(lead) <= max(3.0 * width, 2.0 * nearest)
    weight = np.exp(-0.25 * (lead[is_near] / width) ** 2)
    n_near = int(is_near.sum())
    degree = min(1, n_near - 1)
    coefficients = np.polyfit(lead[is_near], values[is_near], degree, w=weight)
    return np.asarray(coefficients[-1])
