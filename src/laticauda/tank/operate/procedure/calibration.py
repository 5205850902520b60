"""What is measured of the robot that lies straight before a run: joint zeros, marker body."""

import math

import numpy as np
from jaxtyping import Float

from laticauda.values import LaticaudaError, wrap_to_pi


class CalibrationFailed(LaticaudaError, RuntimeError):
    """Robot or instruments are not as the calibration requires; the message says what to do."""


def measure_joint_zeros(
    angle: Float[np.ndarray, "n_samples n_joints"], *, largest: float
) -> Float[np.ndarray, " n_joints"]:
    """Return what every joint reports while the robot lies straight: the median of the samples.

    Args:
        angle: Angles that the limp joints reported [rad]; nan where one did not.
        largest: Largest zero; beyond this, the robot was not straight [rad].

    Returns:
        Zeros of the joints [rad].

    Raises:
        CalibrationFailed: If a joint was not heard, or is further from zero than `largest`.
    """
    was_heard = np.isfinite(angle).any(axis=0)
    if not was_heard.all():
        node = int(np.argmin(was_heard)) + 1
        raise CalibrationFailed(
            f"The joint zeros cannot be measured: module {node} did not report its angle."
        )
    zero = np.nanmedian(angle, axis=0)
    worst = int(np.argmax(np.abs(zero)))
    if abs(zero[worst]) > largest:
        raise CalibrationFailed(
            f"The joint zeros cannot be measured: module {worst + 1} reports "
            f"{math.degrees(zero[worst]):.1f} deg, more than {math.degrees(largest):.1f}; "
            "lay the robot straight against a ruler."
        )
    return zero


def measure_marker_yaw(rotation: Float[np.ndarray, "n_samples 3 3"], *, heading: float) -> float:
    """Return the direction of the marker body relative to its module, from the straight robot.

    All links of a straight robot point the same way, so the module's direction is the robot's,
    which is known: it lies along a wall, or along a rope.

    Args:
        rotation: Rotations from the marker body to the tank frame [-].
        heading: Heading of the straight robot, tank frame [rad].

    Returns:
        Direction [rad], in [-pi, pi).

    Raises:
        CalibrationFailed: If there is no sample.
    """
    if not len(rotation):
        raise CalibrationFailed(
            "The marker body cannot be calibrated: the motion capture did not see it."
        )
    yaw = np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0])
    mean_yaw = math.atan2(float(np.mean(np.sin(yaw))), float(np.mean(np.cos(yaw))))
    return wrap_to_pi(mean_yaw - heading)
