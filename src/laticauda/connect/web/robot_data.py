"""Data of a web page's robots: everything that differs between them, for its kernels, drawings and files."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import cycle
from typing import Any, cast

import numpy as np

import laticauda as lc
from laticauda import scenarios
from laticauda.connect.native.joint_rows import first_row_of_body
from laticauda.connect.native.tables import Tables, build_tables
from laticauda.connect.native.variable import Variable
from laticauda.models.planar import PlanarPlant, rows
from laticauda.motion import gaits
from laticauda.motion.gaits import FIRST_GAIT
from laticauda.robot import kinematics
from laticauda.trials import all_measured
from laticauda.values import codec, extensions

ELASTIC_FIN: Mapping[str, Any] = {"n_hinges": 3, "flexural_rigidity": 0.2}
"""Number of hinges and flexural rigidity of an elastic fin [-], [N m^2]."""
FIN_SIZES = {"small": 0.8, "large": 1.25}
"""Factors by which the lengths of a rigid fin are multiplied; its thickness stays the same."""
FIN_LENGTHS = ("length", "height", "opening_length")
"""Fields of a fin that are multiplied."""
WATER_COEFFICIENTS = ("tangential_friction", "normal_drag", "added_mass")
"""Coefficients of the water that can be set on a page."""
GAIT_KINDS = ("lateral_undulation", "eel_like")
"""Kinds of gait that can be chosen on a page."""

WORK_NAMES = {
    "mechanical_work": "work_absolute",
    "net_work": "work_net",
    "positive_work": "work_positive",
}
"""Names of works in a trial, by those of the variables."""
LOGGED_PREFIXES = (
    "time",
    "center",
    "heading",
    "link",
    "joint_",
    "fin_",
    *WORK_NAMES,
    "electrical_work",
)
"""Prefixes of the names of variables that a trial also contains."""
MOTION_ROWS = rows.STATE_OF_JOINT
"""Rows of every body that hold its motion."""


@dataclass(frozen=True, kw_only=True)
class RobotChoice:
    """A robot of a page, with each fin that it can have."""

    name: str
    """Name by which it was asked for [-]."""
    robot: lc.Robot
    """The robot with its own fin, or none."""
    plants: Mapping[str, PlanarPlant]
    """Plants in their water, by name of the fin."""
    parameters: lc.Parameters | None
    """Parameters that were identified on it; None: the default water, and prescribed joints."""


def build_choice(robot: str | lc.Robot) -> RobotChoice:
    """Build a robot with each fin that it can have.

    Args:
        robot: The robot, or what `load_robot` accepts.

    Raises:
        RobotFileError: If there is no robot with that name.
    """
    if isinstance(robot, str):
        name = robot
        own_robot = lc.load_robot(robot)
    else:
        name = robot.name
        own_robot = robot
    parameters = scenarios.identified_parameters(name)
    plants: dict[str, PlanarPlant] = {}
    for fin_name, body in _list_fins(own_robot).items():
        scenario = lc.build_scenario(body, FIRST_GAIT, parameters=parameters)
        plants[fin_name] = cast(PlanarPlant, lc.build_plant(scenario))
    return RobotChoice(name=name, robot=own_robot, plants=plants, parameters=parameters)


def _list_fins(robot: lc.Robot) -> dict[str, lc.Robot]:
    """Return a robot with its own fin and, if that is a rigid rectangle, an elastic one and ones of other sizes."""
    fin = robot.caudal_fin
    if fin is None:
        return {"none": robot}
    robots = {"rigid": robot}
    if fin.n_hinges or fin.joint is not None or fin.silhouette is not None:
        return robots
    robots["elastic"] = replace(robot, caudal_fin=replace(fin, **ELASTIC_FIN))
    for name, factor in FIN_SIZES.items():
        lengths = {length: factor * getattr(fin, length) for length in FIN_LENGTHS}
        robots[name] = replace(robot, caudal_fin=replace(fin, **lengths))
    return robots


def name_of_kernels(plant: PlanarPlant) -> str:
    """Return what a plant's kernels are called: after its drag law, and a joint law that not all kernels include.

    Args:
        plant: Plant in water.
    """
    name = extensions.name_of(type(plant.law))
    if plant.joints.own is None:
        return name
    return f"{name}, {extensions.name_of(type(plant.joints))}"


def describe_choice(choice: RobotChoice) -> dict[str, Any]:
    """Return the data of a robot on a page.

    Args:
        choice: Robot with each fin that it can have.
    """
    fins = {name: _describe_plant(plant, choice) for name, plant in choice.plants.items()}
    parameters_name = ""
    basis = ""
    if choice.parameters is not None:
        parameters_name = choice.parameters.name
        basis = choice.parameters.basis
    return {
        "name": choice.name,
        "title": choice.robot.description or choice.robot.name,
        "parameters": parameters_name,
        "basis": basis,
        "measured": _list_measured(choice.robot),
        "fins": fins,
    }


def _list_measured(robot: lc.Robot) -> list[dict[str, Any]]:
    """Return the settings in which the robot was measured, with speed [m/s] and electrical power [W], or None."""
    measured: list[dict[str, Any]] = []
    for measurements in all_measured():
        for trial in measurements.trials():
            if trial.robot != robot.name:
                continue
            measured.append(
                {
                    "gait": trial.gait.kind,
                    "numbers": [trial.gait.amplitude, trial.gait.frequency, trial.gait.phase_shift],
                    "speed": trial.forward_velocity,
                    "power": trial.mean_power,
                }
            )
    return measured


def _list_motors(robot: lc.Robot) -> list[list[float]]:
    """Return stall torque [N m] and no-load speed [rad/s] of each joint; nothing if they are not stated."""
    actuators = [joint.actuator for joint in robot.joints]
    if not all(actuator.stated for actuator in actuators):
        return []
    return [[actuator.stall_torque, actuator.no_load_speed] for actuator in actuators]


def _describe_plant(plant: PlanarPlant, choice: RobotChoice) -> dict[str, Any]:
    """Return the data of a robot with one of its fins."""
    tables = build_tables(plant, FIRST_GAIT, lc.Start(), inputs="gait")
    numbers = {variable.name: number for number, variable in enumerate(tables.variables)}
    levers = kinematics.levers(plant.robot)
    fin: Any = {}
    if plant.robot.caudal_fin is not None:
        fin = codec.encode(plant.robot.caudal_fin)
    plant_at_zero = _build_in_water(plant, coefficient=0.0)
    plant_at_one = _build_in_water(plant, coefficient=1.0)
    return {
        "plate": fin,
        "kernels": name_of_kernels(plant),
        "whole": tables.whole.tolist(),
        "real": tables.real.tolist(),
        "n_rows": tables.n_numbers,
        "first": [variable.start for variable in tables.variables],
        "number": numbers,
        "columns": _list_columns(tables),
        "state": _list_state_rows(plant),
        "angles": _list_angles(plant, numbers),
        "ends": levers.end.tolist(),
        "fin": levers.fin.tolist(),
        "width": [module.section.half_width for module in plant.robot.modules],
        "limits": [joint.limit for joint in plant.robot.joints],
        "motors": _list_motors(plant.robot),
        "dt": plant_at_zero.dt,
        "slopes": _list_stopping_rates(plant_at_zero, plant_at_one, numbers),
        "kinds": {kind: _describe_gait_kind(plant, kind, choice) for kind in GAIT_KINDS},
    }


def _build_in_water(plant: PlanarPlant, *, coefficient: float) -> PlanarPlant:
    """Build the same robot in its water, but with all coefficients the same."""
    coefficients: Any = dict.fromkeys(WATER_COEFFICIENTS, coefficient)
    water = replace(cast(lc.Water, plant.environment), **coefficients)
    return cast(PlanarPlant, lc.build_plant(plant.robot, water, joints=plant.joints))


def _list_columns(tables: Tables) -> list[tuple[str, int]]:
    """Return name and variable of every column of a trial's CSV file."""
    columns: list[tuple[str, int]] = []
    for number, variable in enumerate(tables.variables):
        if variable.name.startswith(LOGGED_PREFIXES):
            columns.append((_name_of_column(variable), number))
    return columns


def _name_of_column(variable: Variable) -> str:
    """Return the name of a variable's column in a trial's CSV file (`laticauda trial convert`)."""
    name = WORK_NAMES.get(variable.name, variable.name)
    name = name.replace("[", "_").replace("]", "").replace(".", "_")
    unit = variable.unit.replace("/s", " s-1").replace(".", " ")
    return f"{name} [{unit}]"


def _list_state_rows(plant: PlanarPlant) -> list[int]:
    """Return the rows that are kept when the water's parameters change: all those that `Plant.pack` keeps."""
    state_rows = list(range(rows.TIME, rows.TIME + rows.LOG_STATE))
    for body in range(1, plant.layout.n_bodies):
        first_row = first_row_of_body(body)
        for row in MOTION_ROWS:
            state_rows.append(first_row + row)
    return state_rows


def _list_stopping_rates(
    plant_at_zero: PlanarPlant, plant_at_one: PlanarPlant, numbers: Mapping[str, int]
) -> list[list[float]]:
    """Return the rate at which the drag stops each element, which limits the step.

    It is (p + q C) / (m + k C'), where C and C' are variables. A row holds p, q, the number of C,
    m, k and the number of C'; all is linear in the coefficients, so plants in waters with all of
    them 0 and 1 give these numbers.
    """
    added_mass = numbers["water.added_mass"]
    # Elements are stopped across them and along them, in turns.
    drag_coefficients = cycle((numbers["water.normal_drag"], numbers["water.tangential_friction"]))
    elements = zip(
        plant_at_zero.stopping(), plant_at_one.stopping(), drag_coefficients, strict=False
    )
    rates: list[list[float]] = []
    for element_at_zero, element_at_one, drag_coefficient in elements:
        drag, mass = element_at_zero
        drag_at_one, mass_at_one = element_at_one
        columns = np.broadcast_arrays(
            drag, drag_at_one - drag, drag_coefficient, mass, mass_at_one - mass, added_mass
        )
        rates.extend(np.stack(columns, axis=1).tolist())
    return rates


def _describe_gait_kind(plant: PlanarPlant, kind: str, choice: RobotChoice) -> dict[str, Any]:
    """Return the data of a kind of gait: its envelope, and the coefficients of its water."""
    gait = replace(FIRST_GAIT, envelope=gaits.envelope_of(kind))
    if choice.parameters is not None:
        water = choice.parameters.water(kind)
    else:
        water = scenarios.default_water(plant.robot, gait)
    coefficients = {f"water.{name}": getattr(water, name) for name in WATER_COEFFICIENTS}
    return {"envelope": gait.joint_envelope(plant.robot.n_links), "water": coefficients}


def _list_angles(plant: PlanarPlant, numbers: Mapping[str, int]) -> list[list[tuple[int, float]]]:
    """Return the variables and factors that sum to the angle of each fin piece, last one first, and each link."""
    robot = plant.robot
    n_pieces = kinematics.levers(robot).end.shape[1] - robot.n_links
    angles: list[list[tuple[int, float]]] = []
    for piece in reversed(range(n_pieces)):
        angle = [(numbers["link_angle[0]"], 1.0)]
        for joint in robot.fin_joints:
            if joint <= piece:
                angle.append((numbers[f"fin_angle[{joint}]"], -1.0))
        angles.append(angle)
    for link in range(robot.n_links):
        angles.append([(numbers[f"link_angle[{link}]"], 1.0)])
    return angles
