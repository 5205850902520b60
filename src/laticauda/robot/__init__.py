"""Robots, water and ground as validated data, their TOML files, and the presets."""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports
from laticauda.robot.describe import describe as describe  # at once: a module has its name

if TYPE_CHECKING:
    from laticauda.robot.body import (
        Actuator as Actuator,
        Joint as Joint,
        Module as Module,
        Section as Section,
    )
    from laticauda.robot.describe import (
        describe_coefficients as describe_coefficients,
        in_a_line as in_a_line,
        summarize_robot as summarize_robot,
    )
    from laticauda.robot.effectors import (
        CaudalFin as CaudalFin,
        DragArea as DragArea,
        Hinge as Hinge,
        PectoralFin as PectoralFin,
        Piece as Piece,
        Tether as Tether,
        Thruster as Thruster,
    )
    from laticauda.robot.environment import (
        Current as Current,
        Environment as Environment,
        Ground as Ground,
        Scene as Scene,
        Water as Water,
        check_fits as check_fits,
        law_of as law_of,
    )
    from laticauda.robot.files import (
        RobotNotFound as RobotNotFound,
        current_names as current_names,
        current_of as current_of,
        from_toml as from_toml,
        ground_names as ground_names,
        load_current as load_current,
        load_ground as load_ground,
        load_joint_angles as load_joint_angles,
        load_robot as load_robot,
        load_water as load_water,
        robot_names as robot_names,
        to_toml as to_toml,
        water_names as water_names,
        find as find,
        read_table as read_table,
    )
    from laticauda.robot.parameters import (
        Parameters as Parameters,
        load_parameters as load_parameters,
        parameter_names as parameter_names,
        FIELDS_OF_ROBOT as FIELDS_OF_ROBOT,
        GAITS as GAITS,
        NAMES as NAMES,
        adjust as adjust,
        read_adjustments as read_adjustments,
    )
    from laticauda.robot.robot import Robot as Robot, has_power_model as has_power_model
    from laticauda.robot.servos import (
        load_servo as load_servo,
        servo_names as servo_names,
        with_servos as with_servos,
    )
    from laticauda.robot.textbook import (
        SEEN as SEEN,
        TEXTBOOK as TEXTBOOK,
        Textbook as Textbook,
        tether_drag as tether_drag,
        textbook_of as textbook_of,
        textbook_water as textbook_water,
    )
    from laticauda.robot.hydrodynamics import (
        Coefficients as Coefficients,
        FinEdge as FinEdge,
        fin_edge as fin_edge,
        link_coefficients as link_coefficients,
        links_in_water as links_in_water,
        mass_across as mass_across,
        override_or_default as override_or_default,
        wake_mass as wake_mass,
    )
    from laticauda.robot.kinematics import (
        ModulePoses as ModulePoses,
        Posture as Posture,
        center_of_mass as center_of_mass,
        from_quaternion as from_quaternion,
        heading as heading,
        levers as levers,
        link_angles as link_angles,
        module_poses as module_poses,
        move_head as move_head,
        to_quaternion as to_quaternion,
        turn as turn,
    )
    from laticauda.robot.silhouettes import FinPlate as FinPlate, fin_plate as fin_plate

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.robot.body": ["Actuator", "Joint", "Module", "Section"],
        "laticauda.robot.describe": ["describe_coefficients", "in_a_line", "summarize_robot"],
        "laticauda.robot.effectors": [
            "CaudalFin",
            "DragArea",
            "Hinge",
            "PectoralFin",
            "Piece",
            "Tether",
            "Thruster",
        ],
        "laticauda.robot.environment": [
            "Current",
            "Environment",
            "Ground",
            "Scene",
            "Water",
            "check_fits",
            "law_of",
        ],
        "laticauda.robot.files": [
            "RobotNotFound",
            "current_names",
            "current_of",
            "from_toml",
            "ground_names",
            "load_current",
            "load_ground",
            "load_joint_angles",
            "load_robot",
            "load_water",
            "robot_names",
            "to_toml",
            "water_names",
        ],
        "laticauda.robot.parameters": ["Parameters", "load_parameters", "parameter_names"],
        "laticauda.robot.robot": ["Robot", "has_power_model"],
        "laticauda.robot.servos": ["load_servo", "servo_names", "with_servos"],
        "laticauda.robot.textbook": [
            "SEEN",
            "TEXTBOOK",
            "Textbook",
            "tether_drag",
            "textbook_of",
            "textbook_water",
        ],
    },
    own=["describe"],
    plain={
        "laticauda.robot.files": ["find", "read_table"],
        "laticauda.robot.hydrodynamics": [
            "Coefficients",
            "FinEdge",
            "fin_edge",
            "link_coefficients",
            "links_in_water",
            "mass_across",
            "override_or_default",
            "wake_mass",
        ],
        "laticauda.robot.kinematics": [
            "ModulePoses",
            "Posture",
            "center_of_mass",
            "from_quaternion",
            "heading",
            "levers",
            "link_angles",
            "module_poses",
            "move_head",
            "to_quaternion",
            "turn",
        ],
        "laticauda.robot.parameters": [
            "FIELDS_OF_ROBOT",
            "GAITS",
            "NAMES",
            "adjust",
            "read_adjustments",
        ],
        "laticauda.robot.silhouettes": ["FinPlate", "fin_plate"],
    },
    renamed={"coefficients": "describe_coefficients", "summary": "summarize_robot"},
)
