"""How joints follow their references: what an estimator expects before it hears their sensors.

Without knowledge of the servos, references are smoothed a little. A servo with speed control turns
no faster than its speed limit, however far its reference has jumped: who expects more of it takes
its true angles for outliers.
"""

import math
from typing import Any, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from laticauda.motion.gaits import filter_step
from laticauda.motion.joints import SpeedServo

Vector: TypeAlias = NDArray[np.float64]


def smooth_reference(
    angle: Vector, rate: Vector, reference: Vector, bandwidth: float, dt: float
) -> tuple[Vector, Vector]:
    """Return smoothed references after a time step, and their rates [rad], [rad/s].

    Args:
        angle: Smoothed references before the step [rad].
        rate: Their rates [rad/s].
        reference: phi_ref, held [rad].
        bandwidth: w of the critically damped filter [rad/s].
        dt: Time step [s].
    """
    filter_arrays = cast(Any, filter_step)  # its formula also holds for arrays
    decay = math.exp(-bandwidth * dt)
    smoothed, smoothed_rate, _ = filter_arrays(angle, rate, reference, bandwidth, decay, dt)
    return smoothed, smoothed_rate


def turn_by_speed_control(
    angle: Vector, reference: Vector, servo: SpeedServo, dt: float
) -> tuple[Vector, Vector]:
    """Return the angles of unloaded servos with speed control after a time step, and their rates [rad], [rad/s].

    phi' = clip(k_w (phi_ref - phi), -w_max, w_max), solved exactly: at the limit until the demand
    falls below it, and by a decay of the rest.

    Args:
        angle: phi before the step [rad].
        reference: phi_ref, held [rad].
        servo: The servos, with k_w and w_max.
        dt: Time step [s].
    """
    gain, limit = servo.position_gain, servo.speed_limit
    error = reference - angle
    time_at_limit = np.clip((np.abs(error) - limit / gain) / limit, 0.0, dt)
    error_then = error - np.sign(error) * limit * time_at_limit
    error_after = error_then * np.exp(-gain * (dt - time_at_limit))
    rate = np.clip(gain * error_after, -limit, limit)
    return reference - error_after, rate
