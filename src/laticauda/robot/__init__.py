"""What swims and where: robots, water and ground as validated data, their TOML files, and the presets."""

from laticauda.robot.body import Actuator, Joint, Module, Section
from laticauda.robot.describe import describe, summary, summary_rows, summary_table
from laticauda.robot.effectors import CaudalFin, Hinge, PectoralFin, Piece, Tether, Thruster
from laticauda.robot.environment import Environment, Ground, Water, check_fits, law_of
from laticauda.robot.files import (
    RobotNotFound,
    from_toml,
    ground_names,
    load_ground,
    load_robot,
    load_water,
    robot_names,
    to_toml,
    water_names,
)
from laticauda.robot.parameters import Parameters, load_parameters, parameter_names
from laticauda.robot.robot import Robot, has_power_model

__all__ = [
    "Actuator",
    "CaudalFin",
    "Environment",
    "Ground",
    "Hinge",
    "Joint",
    "Module",
    "Parameters",
    "PectoralFin",
    "Piece",
    "Robot",
    "RobotNotFound",
    "Section",
    "Tether",
    "Thruster",
    "Water",
    "check_fits",
    "describe",
    "from_toml",
    "ground_names",
    "has_power_model",
    "law_of",
    "load_ground",
    "load_parameters",
    "load_robot",
    "load_water",
    "parameter_names",
    "robot_names",
    "summary",
    "summary_rows",
    "summary_table",
    "to_toml",
    "water_names",
]
