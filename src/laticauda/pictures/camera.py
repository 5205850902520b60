"""A camera that follows a robot calmly: it sees the whole body from one side, and does not nod with every stroke."""

import math
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.robot import Robot
from laticauda.spatial.bodies import center_of_mass
from laticauda.trial import Trial

VIEW_DEG = 36.0  # vertical angle of view
DOWN_DEG = 24.0  # how far it looks down
ASIDE_DEG = 118.0  # its direction to the robot's own: seen from the right, with the head toward us
ROOM = 1.36  # width of the picture at the robot, in lengths of the robot
BELOW = 0.07  # how far below the robot it looks, in its lengths: there is its shadow
CALM, CALM_TURN = 0.75, 1.5  # how far it looks around in time, in periods of the gait
PERIOD, LONGEST_PERIOD = 2.0, 10.0  # where no gait says, and at most [s]


class View(NamedTuple):
    """Where a camera stands and looks at one instant."""

    target: Float[np.ndarray, "3"]
    """What is in the middle of the picture [m]."""
    distance: float
    """From the target [m]."""
    azimuth: float
    """Horizontal direction it looks into, counter-clockwise from the x axis [deg]."""
    elevation: float
    """How far it looks up [deg]."""


def view(trial: Trial, time: float, height: float, aspect: float) -> View:
    """What the camera sees at a time.

    Args:
        trial: Any trial.
        time: Within the trial's time [s].
        height: At which a planar robot swims [m].
        aspect: Width of the picture to its height [-].
    """
    period = ripple_period(trial)
    center = calm(trial.time, trial.center_of_mass, time, CALM * period)
    heading = float(calm(trial.time, trial.heading, time, CALM_TURN * period))
    ahead = middle(trial.robot)
    target = np.array([*center[:2], center[2] if center.size == 3 else height])
    target += ahead * math.cos(heading), ahead * math.sin(heading), -BELOW * trial.robot.reach
    half_view = math.atan(math.tan(math.radians(0.5 * VIEW_DEG)) * aspect)
    return View(
        target=target,
        azimuth=math.degrees(heading) + ASIDE_DEG,
        elevation=-DOWN_DEG,
        distance=0.5 * ROOM * trial.robot.reach / math.tan(half_view),
    )


def aim(camera: Any, view: View) -> None:
    """Let a `MjvCamera` look so."""
    camera.lookat, camera.distance, camera.azimuth, camera.elevation = view


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
