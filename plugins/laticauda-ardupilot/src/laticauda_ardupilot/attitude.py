"""Axes of the robot and of the autopilot.

laticauda's axes are forward, left, up, those of the autopilot north, east, down and forward, right,
down: the second and the third have the other sign. North is laticauda's x.
"""

import math

import numpy as np

from laticauda.connect.vehicle_motion import Rotation, Vector

SIGNS = np.array([1.0, -1.0, -1.0])
"""Signs between the axes of both."""


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
