"""How joints are driven: the torque that a joint law delivers, and the electrical power that it takes."""

from laticauda.actuation.laws import motor_power, pd, servo

__all__ = ["motor_power", "pd", "servo"]
