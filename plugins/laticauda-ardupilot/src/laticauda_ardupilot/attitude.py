"""Axes of the robot and of the autopilot.

laticauda's axes are forward, left, up, those of the autopilot north, east, down and forward, right,
down: the second and the third have the other sign. North is laticauda's x.
"""

import math

import numpy as np
from jaxtyping import Float

from laticauda.values import to_quaternion

Vector = Float[np.ndarray, " 3"]
Rotation = Float[np.ndarray, "3 3"]

SIGNS = np.array([1.0, -1.0, -1.0])
"""Signs between the axes of both."""
SMALLEST_ANGLE = 1e-8
"""Angle below which a rotation's axis is taken from its sines alone [rad]."""


def flip_vector(vector: Vector) -> Vector:
    """Return a vector in the autopilot's axes, or back.

    Args:
        vector: In the axes of the other.
    """
    return SIGNS * vector


def flip_rotation(rotation: Rotation) -> Rotation:
    """Return a rotation from body to world axes in the autopilot's axes, or back.

    Args:
        rotation: In the axes of the other.
    """
    return SIGNS[:, np.newaxis] * rotation * SIGNS


def mean_rotation(rotations: Float[np.ndarray, "n 3 3"]) -> Rotation:
    """Return the axes of a bent body as a whole: forward as its modules on average, up as nearly as possible.

    Args:
        rotations: Axes of the modules (forward, left, up) as columns.
    """
    total = rotations.sum(axis=0)
    forward = total[:, 0] / np.linalg.norm(total[:, 0])
    up = total[:, 2] - (total[:, 2] @ forward) * forward
    up /= np.linalg.norm(up)
    return np.stack((forward, np.cross(up, forward), up), axis=1)


def euler_angles(rotation: Rotation) -> Vector:
    """Return roll, pitch and yaw of a rotation from body to earth axes [rad].

    Args:
        rotation: In the autopilot's axes.
    """
    sine_of_pitch = min(max(-float(rotation[2, 0]), -1.0), 1.0)
    return np.array(
        [
            math.atan2(rotation[2, 1], rotation[2, 2]),
            math.asin(sine_of_pitch),
            math.atan2(rotation[1, 0], rotation[0, 0]),
        ]
    )


def rotation_vector(rotation: Rotation) -> Vector:
    """Return axis times angle of a rotation by less than half a turn [rad].

    Args:
        rotation: The rotation.
    """
    sines = 0.5 * np.array(
        [
            rotation[2, 1] - rotation[1, 2],
            rotation[0, 2] - rotation[2, 0],
            rotation[1, 0] - rotation[0, 1],
        ]
    )
    sine = math.sqrt(float(sines @ sines))
    cosine = 0.5 * (float(np.trace(rotation)) - 1.0)
    angle = math.atan2(sine, cosine)
    if angle < SMALLEST_ANGLE:
        return sines
    return sines * (angle / sine)


def quaternion_of(rotation: Rotation) -> Float[np.ndarray, " 4"]:
    """Return a rotation as w, x, y, z.

    Args:
        rotation: The rotation.
    """
    return np.asarray(to_quaternion(rotation))
