"""How joints are driven: the torque that a joint law delivers, and the electrical power that it takes."""

from laticauda.actuation.laws import pd, servo, servo_power

__all__ = ["pd", "servo", "servo_power"]
