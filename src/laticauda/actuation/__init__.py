"""Actuators: joint laws as values, their torques as scalar functions, and the power that their motors draw."""

from laticauda.actuation.laws import PD, Drive, JointLaw, Prescribed, Servo, motor_power, pd, servo

__all__ = ["PD", "Drive", "JointLaw", "Prescribed", "Servo", "motor_power", "pd", "servo"]
