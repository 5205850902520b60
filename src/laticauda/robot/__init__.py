"""What swims and where: robots, water and ground as validated data, their TOML files, and the presets."""

from laticauda.robot.environment import Environment, Ground, Water, check_fits
from laticauda.robot.effectors import CaudalFin, PectoralFin, Tether, Thruster
from laticauda.robot.joints import Actuator, Joint
from laticauda.robot.modules import Module, Section
from laticauda.robot.robot import Robot

__all__ = [
    "Actuator",
    "CaudalFin",
    "Environment",
    "Ground",
    "Joint",
    "Module",
    "PectoralFin",
    "Robot",
    "Section",
    "Tether",
    "Thruster",
    "Water",
    "check_fits",
]
