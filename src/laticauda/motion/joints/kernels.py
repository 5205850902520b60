"""Joint laws in the kernels of both models."""

# pyright: reportUnknownParameterType=false, reportMissingParameterType=false, reportUnknownVariableType=false
# pyright: reportUnknownMemberType=false, reportUnknownArgumentType=false

from typing import Any, no_type_check

from laticauda.compiling import kernel
from laticauda.compiling.formulas import in_numbers, in_rows
from laticauda.motion.joints.laws import (
    MOTION,
    OWN_DRIVEN,
    OWN_LINEAR,
    PD,
    PD_DRIVEN,
    SERVO_DRIVEN,
    Drive,
    Servo,
)
from laticauda.values import Formula


def actuator_of(own: Formula | None) -> Any:
    """Return a kernel function of a joint's code and three tuples: its motion, its drive and the law's own numbers.

    It returns the actuator's torque and its slopes, and always includes the built-in laws.

    Args:
        own: Formula for joints with the codes OWN_DRIVEN and OWN_LINEAR; None: no such joints.
    """
    pd, servo = (in_numbers(kind().formula, Drive, MOTION) for kind in (PD, Servo))
    if own is None:

        @kernel
        @no_type_check
        def by_own(motion, drive, numbers):
            return 0.0 * motion[0], 0.0 * motion[0], 0.0 * motion[0]

    else:
        law = in_rows(own, Drive, MOTION)

        @kernel
        @no_type_check
        def by_own(motion, drive, numbers):
            none = 0.0 * motion[0]  # gives constants the type of the other numbers
            torque, slope_p, slope_d = law(*motion, *drive, *numbers)
            return torque + none, slope_p + none, slope_d + none

    @kernel
    @no_type_check
    def actuator(code, motion, drive, numbers):
        if code == PD_DRIVEN:
            torque, slope_p, slope_d = pd(*motion, *drive)
        elif code == SERVO_DRIVEN:
            torque, slope_p, slope_d = servo(*motion, *drive)
        elif code == OWN_DRIVEN or code == OWN_LINEAR:
            torque, slope_p, slope_d = by_own(motion, drive, numbers)
        else:
            torque = 0.0 * motion[0]
            slope_p = 0.0 * motion[0]
            slope_d = 0.0 * motion[0]
        return torque, slope_p, slope_d

    return actuator
