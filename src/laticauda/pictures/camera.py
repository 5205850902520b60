"""Cameras: one that follows a robot calmly, one beside it, one above it, and one that stands still and sees it all."""

import math
from pathlib import Path
from typing import Any, Literal

import numpy as np
from jaxtyping import Float

from laticauda.errors import load_mujoco, within
from laticauda.files import read_toml
from laticauda.quantities import option, quantity, value
from laticauda.robot import Robot
from laticauda.spatial.bodies import center_of_mass
from laticauda.trial import Trial

Camera = Literal["follow", "side", "top", "fixed"]
VIEW_DEG = 36.0  # vertical angle of view
# How far it looks down, and its direction to the robot's own: follow is to its right with the head toward us.
DIRECTIONS: dict[str, tuple[float, float]] = read_toml(Path(__file__).with_suffix(".toml"))
ROOM = 1.36  # width of the picture at the robot, in lengths of the robot
BELOW = 0.07  # how far below the robot `follow` looks, in its lengths: there is its shadow
CALM, CALM_TURN = 0.75, 1.5  # how far it looks around in time, in periods of the gait
PERIOD, LONGEST_PERIOD = 2.0, 10.0  # where no gait says, and at most [s]


@value
class Film:
    """What a film or a picture of a trial shows, and how large.

    Raises:
        ValueError: If a field is out of its range.
    """

    size: tuple[int, int] = quantity("", "Width and height in pixels", ge=64, le=4096, default=(1280, 720))
    frames_per_second: float = quantity("1/s", "Pictures in a second of the film", gt=0.0, le=240.0, default=30.0)
    begin: float | None = quantity("s", "Time of the trial at which it begins; its start if left out", default=None)
    end: float | None = quantity("s", "Time of the trial at which it ends; its end if left out", default=None)
    camera: Camera = option("`follow` turns with it, `side` is beside, `top` above, `fixed` sees all", default="follow")

    def span(self, trial: Trial) -> tuple[float, float]:
        """Where the film begins and ends in a trial [s].

        Raises:
            ValueError: If it is not within the trial.
        """
        first, last = float(trial.time[0]), float(trial.time[-1])
        begin = first if self.begin is None else within("begin", self.begin, first, last, "s")
        return begin, last if self.end is None else within("end", self.end, begin, last, "s")


def view(trial: Trial, time: float, height: float, film: Film) -> Any:
    """What a film's camera sees of a trial at a time, as a `MjvCamera`.

    Args:
        trial: Any trial.
        time: Within the trial's time [s].
        height: At which a planar robot swims [m].
        film: Whose camera it is.
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
        return look(trial.robot, in_space(0.5 * (low + high), height), 0.0, aspect, camera, wide)
    period = ripple_period(trial)
    center = in_space(calm(trial.time, trial.center_of_mass, time, CALM * period), height)
    heading = float(calm(trial.time, trial.heading, time, CALM_TURN * period))
    return look(trial.robot, center, heading, aspect, camera)


def look(
    robot: Robot,
    center: Float[np.ndarray, "3"],
    heading: float,
    aspect: float,
    camera: Camera = "follow",
    wide: float = 0.0,
) -> Any:
    """What a camera sees of a robot, as a `MjvCamera`.

    Args:
        robot: Whom it shows.
        center: Its center of mass [m].
        heading: Its direction [rad].
        aspect: Width of the picture to its height [-].
        camera: `follow` turns with the robot, `side` is beside it, `top` above, `fixed` stays.
        wide: What it is to see at least [m].
    """
    down, aside = DIRECTIONS[camera]
    reach, ahead = robot.reach, 0.0 if camera == "fixed" else middle(robot)
    below = BELOW * reach if camera == "follow" else 0.0
    half_view = math.atan(math.tan(math.radians(0.5 * VIEW_DEG)) * aspect)
    seen = load_mujoco().MjvCamera()
    seen.lookat = center + np.array((ahead * math.cos(heading), ahead * math.sin(heading), -below))
    seen.distance = 0.5 * ROOM * max(reach, wide) / math.tan(half_view)
    seen.azimuth, seen.elevation = math.degrees(heading) + aside, -down
    return seen


def in_space(center: np.ndarray, height: float) -> Float[np.ndarray, "3"]:
    """A place, at a height if it is one in the plane [m]."""
    return center if center.size == 3 else np.append(center, height)


def ripple_period(trial: Trial) -> float:
    """Over which speed and heading go up and down [s]."""
    return min(trial.period or PERIOD, LONGEST_PERIOD)


def middle(robot: Robot) -> float:
    """Middle of the straight robot with its fin, ahead of its center of mass [m]."""
    behind = robot.caudal_fin.length if robot.caudal_fin else 0.0
    return 0.5 * (robot.length - behind) - center_of_mass(robot)


def calm(time: Float[np.ndarray, " n"], values: Float[np.ndarray, "n ..."], at: float, width: float) -> np.ndarray:
    """A signal without its ripple: the straight line that fits best around a moment, there.

    Unlike a mean it does not lag at the ends of the log.

    Args:
        time: Of the samples [s].
        values: The signal.
        at: The moment [s].
        width: How far around it samples count: the standard deviation of their weights [s].
    """
    ago = time - at
    near = np.abs(ago) <= max(3.0 * width, 2.0 * float(np.min(np.abs(ago))))
    weight = np.exp(-0.25 * (ago[near] / width) ** 2)
    return np.asarray(np.polyfit(ago[near], values[near], min(1, int(near.sum()) - 1), w=weight)[-1])
