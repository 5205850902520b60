"""Cameras: one that follows a robot smoothly, one beside it, one above it, and a fixed one that shows everything."""

import math
from typing import Any, Literal, NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.models.spatial.bodies import straight_center_of_mass
from laticauda.robot import Robot
from laticauda.trials import Trial
from laticauda.values.checks import check_within
from laticauda.values.optional import load_mujoco
from laticauda.values.quantities import option, quantity, value_class

Camera = Literal["follow", "side", "top", "fixed"]
VIEW_DEG = 36.0  # vertical angle of view


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
ROOM = 1.36  # width of the picture at the robot, in robot lengths
BELOW = 0.07  # how far below the robot `follow` looks, in robot lengths, to show its shadow
CALM, CALM_TURN = 0.75, 1.5  # time scales of smoothing, in periods of the gait
PERIOD, LONGEST_PERIOD = 2.0, 10.0  # period if there is no gait, and longest period [s]


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

    def span(self, trial: Trial) -> tuple[float, float]:
        """Return the times at which the film begins and ends in a trial [s].

        Raises:
            ValueError: If it is not within the trial.
        """
        first, last = float(trial.time[0]), float(trial.time[-1])
        begin = first if self.begin is None else check_within("begin", self.begin, first, last, "s")
        return begin, last if self.end is None else check_within("end", self.end, begin, last, "s")


def view(trial: Trial, time: float, height: float, film: Film) -> Any:
    """Return a film's camera for a trial at a given time, as a `MjvCamera`.

    Args:
        trial: Any trial.
        time: Time within the trial [s].
        height: Height at which a planar robot swims [m].
        film: The film with its camera.
    """
    aspect, camera = film.size[0] / film.size[1], film.camera
    if camera == "fixed":
        begin, end = film.span(trial)
        shown = (trial.time >= begin) & (trial.time <= end)
        center, heading = trial.center_of_mass[shown], trial.heading[shown]
        ends = 0.5 * trial.robot.reach * np.stack((np.cos(heading), np.sin(heading)), axis=1)
        low, high = center.min(axis=0), center.max(axis=0)
        both = np.concatenate((center[:, :2] - ends, center[:, :2] + ends))
        low[:2], high[:2] = both.min(axis=0), both.max(axis=0)
        wide = max(float(high[0] - low[0]), aspect * float(high[1] - low[1]))
        return aim_camera(
            trial.robot, to_space(0.5 * (low + high), height), 0.0, aspect, camera, wide
        )
    period = ripple_period(trial)
    center = to_space(calm(trial.time, trial.center_of_mass, time, CALM * period), height)
    heading = float(calm(trial.time, trial.heading, time, CALM_TURN * period))
    return aim_camera(trial.robot, center, heading, aspect, camera)


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
    down, aside = DIRECTIONS[camera]
    reach, ahead = robot.reach, 0.0 if camera == "fixed" else middle_ahead_of_center(robot)
    below = BELOW * reach if camera == "follow" else 0.0
    half_view = math.atan(math.tan(math.radians(0.5 * VIEW_DEG)) * aspect)
    seen = load_mujoco().MjvCamera()
    seen.lookat = center + np.array((ahead * math.cos(heading), ahead * math.sin(heading), -below))
    seen.distance = 0.5 * ROOM * max(reach, wide) / math.tan(half_view)
    seen.azimuth, seen.elevation = math.degrees(heading) + aside, -down
    return seen


def to_space(center: np.ndarray, height: float) -> Float[np.ndarray, "3"]:
    """Return a position in space, at a given height if it is planar [m]."""
    return center if center.size == 3 else np.append(center, height)


def ripple_period(trial: Trial) -> float:
    """Return the period of the ripple in speed and heading [s]."""
    return min(trial.period or PERIOD, LONGEST_PERIOD)


def middle_ahead_of_center(robot: Robot) -> float:
    """Return how far the middle of the straight robot with its fin is ahead of its center of mass [m]."""
    behind = robot.caudal_fin.length if robot.caudal_fin else 0.0
    return 0.5 * (robot.length - behind) - straight_center_of_mass(robot)


def calm(
    time: Float[np.ndarray, " n"], values: Float[np.ndarray, "n ..."], at: float, width: float
) -> np.ndarray:
    """Return a signal without its ripple: the value at a moment of the best-fit straight line around it.

    Unlike a mean, it does not lag at the ends of the log.

    Args:
        time: Times of the samples [s].
        values: The signal.
        at: The moment [s].
        width: Standard deviation of the samples' weights around that moment [s].
    """
    ago = time - at
    near = np.abs(ago) <= max(3.0 * width, 2.0 * float(np.min(np.abs(ago))))
    weight = np.exp(-0.25 * (ago[near] / width) ** 2)
    return np.asarray(
        np.polyfit(ago[near], values[near], min(1, int(near.sum()) - 1), w=weight)[-1]
    )
