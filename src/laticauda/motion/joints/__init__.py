"""Actuators: joint laws as values, their torques as scalar functions, and the power drawn by their motors."""

from laticauda.motion.joints.laws import (
    FIRST_FREE,
    JOINT,
    LOCKED,
    PASSIVE,
    PD,
    PRESCRIBED,
    SLIDING_RATE,
    Drive,
    JointLaw,
    Prescribed,
    Servo,
    motor_power,
    servo,
    usual_law,
)
from laticauda.motion.joints.muscles import Ekeberg, Hill, ekeberg, hill
from laticauda.motion.joints.speed_servo import SpeedServo, speed_servo

__all__ = [
    "FIRST_FREE",
    "JOINT",
    "LOCKED",
    "PASSIVE",
    "PD",
    "PRESCRIBED",
    "SLIDING_RATE",
    "Drive",
    "Ekeberg",
    "Hill",
    "JointLaw",
    "Prescribed",
    "Servo",
    "SpeedServo",
    "ekeberg",
    "hill",
    "motor_power",
    "servo",
    "speed_servo",
    "usual_law",
]
