"""Robots, water and ground as validated data, their TOML files, and the presets."""

from laticauda.packaging import lazy_exports
from laticauda.robot.body import (
    Actuator as Actuator,
    Joint as Joint,
    Module as Module,
    Section as Section,
)
from laticauda.robot.describe import (
    coefficients as coefficients,
    describe as describe,
    in_a_line as in_a_line,
)
from laticauda.robot.describe import summary as summary
from laticauda.robot.effectors import (
    CaudalFin as CaudalFin,
    Hinge as Hinge,
    PectoralFin as PectoralFin,
    Piece as Piece,
)
from laticauda.robot.effectors import Tether as Tether, Thruster as Thruster
from laticauda.robot.environment import (
    Current as Current,
    Environment as Environment,
    Ground as Ground,
    Water as Water,
)
from laticauda.robot.environment import Scene as Scene, check_fits as check_fits, law_of as law_of
from laticauda.robot.files import (
    RobotNotFound as RobotNotFound,
    from_toml as from_toml,
    ground_names as ground_names,
)
from laticauda.robot.files import current_names as current_names, current_of as current_of
from laticauda.robot.files import load_current as load_current
from laticauda.robot.files import load_ground as load_ground, load_joint_angles as load_joint_angles
from laticauda.robot.files import load_robot as load_robot, load_water as load_water
from laticauda.robot.files import (
    robot_names as robot_names,
    to_toml as to_toml,
    water_names as water_names,
)
from laticauda.robot.parameters import Parameters as Parameters, load_parameters as load_parameters
from laticauda.robot.parameters import parameter_names as parameter_names
from laticauda.robot.robot import Robot as Robot, has_power_model as has_power_model
from laticauda.robot.textbook import SEEN as SEEN, TEXTBOOK as TEXTBOOK, Textbook as Textbook
from laticauda.robot.textbook import tether_drag as tether_drag, textbook_of as textbook_of
from laticauda.robot.textbook import textbook_water as textbook_water

__getattr__, __dir__, __all__ = lazy_exports()
