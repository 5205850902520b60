"""Robots, waters, grounds and currents as readable text: the contents of their declared fields."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby
from operator import attrgetter
from typing import TypeVar

from laticauda.robot import body, environment, textbook
from laticauda.robot.robot import Robot
from laticauda.values import describe_fields, quantities_of
from laticauda.water.fluid import Flow

Row = tuple[str, str]
T = TypeVar("T")


def summarize_robot(robot: Robot) -> dict[str, str | int | float | bool]:
    """Return the main facts about `robot` by name: links, joints, length [m], mass [kg], fin, description.

    Args:
        robot: Robot to summarize.
    """
    return {
        "name": robot.name,
        "n_links": robot.n_links,
        "n_joints": robot.n_joints,
        "length": robot.length,
        "mass": robot.mass,
        "caudal_fin": robot.caudal_fin is not None,
        "description": robot.description,
    }


def describe(thing: Robot | environment.Water | environment.Ground | Flow) -> str:
    """Describe `thing`, a robot, water, ground or flow, in full: one fact per line, aligned.

    Args:
        thing: A robot, water, ground or flow.
    """
    if isinstance(thing, Robot):
        rows = [*robot_rows(thing), *_textbook_rows(thing), *_power_rows(thing)]
    elif isinstance(thing, Flow):
        units = {
            name: f"{one.text} [{one.unit or '-'}]"
            for name, one in quantities_of(type(thing)).items()
        }
        rows = [("current", thing.words), *units.items()]
    else:
        kind = "water" if isinstance(thing, environment.Water) else "ground"
        rows = [(kind, thing.name), *describe_coefficients(thing).items()]
    width = max(len(name) for name, _ in rows)
    return "\n".join(f"{name:<{width}}  {text}" for name, text in rows)


def describe_coefficients(medium: environment.Environment) -> dict[str, str]:
    """Return the fields of a water or ground other than its name, as text by field.

    Args:
        medium: A water or ground.
    """
    if isinstance(medium, environment.Water):
        depth = "far below the surface" if medium.depth is None else f"{medium.depth:g} m"
        return {
            **describe_fields(medium, "name", "density"),
            "depth": depth,
            "density": f"{medium.density:g} kg/m^3",
        }
    if medium.friction.of_weight:
        unit = "of the weight"
        fields = describe_fields(medium, "name")
    else:
        unit = "N s/m per link"
        fields = describe_fields(medium, "name", "gravity")
    for name in ("tangential", "normal"):
        fields[name] = f"{getattr(medium, name):g} {unit}"
    return fields


def in_a_line(facts: dict[str, str]) -> str:
    """Join facts in one line, each with its name.

    Args:
        facts: Facts from `laticauda.values.quantities.describe_fields`.
    """
    return ", ".join(f"{name} {text}" for name, text in facts.items())


def robot_rows(robot: Robot) -> Iterator[Row]:
    """Yield what a robot consists of: one fact per row, its name and the text.

    Args:
        robot: The robot.
    """
    fin = robot.caudal_fin
    yield "robot", robot.name
    if robot.description:
        yield "description", robot.description
    yield "links, joints", f"{robot.n_links}, {robot.n_joints}"
    if fin is None:
        yield "length", f"{robot.length:.4g} m"
        yield "mass", f"{robot.mass:.4g} kg"
    else:
        yield "length", f"{robot.length:.4g} m without the fin"
        yield "mass", f"{robot.mass:.4g} kg with the fin"
    yield "volume", f"{1e3 * robot.volume:.4g} L"
    for indices, module in _group_equal(robot.modules):
        yield f"modules {indices}", in_a_line(describe_fields(module))
    if robot.joints:
        yield "axes", _axes(robot.joints)
    # The axes and the actuators have rows of their own.
    plain_joints = [replace(joint, axis="yaw", actuator=body.Actuator()) for joint in robot.joints]
    for indices, joint in _group_equal(plain_joints):
        yield f"joints {indices}", in_a_line(describe_fields(joint, "axis", "actuator"))
    for indices, actuator in _group_equal([joint.actuator for joint in robot.joints]):
        text = in_a_line(describe_fields(actuator, "stated"))
        if not actuator.stated:
            text = f"not stated; with Mamba's servo: {text}"
        yield f"actuators {indices}", text
    if fin is not None:
        left_out = () if fin.opening_length else ("opening",)
        facts = {"mass": f"{fin.mass:g} kg", **describe_fields(fin, *left_out)}
        yield "caudal fin", in_a_line(facts)
    for thruster in robot.thrusters:
        yield f"thruster on link {thruster.link}", in_a_line(describe_fields(thruster, "link"))
    for plate in robot.pectoral_fins:
        yield f"pectoral fin on link {plate.link}", in_a_line(describe_fields(plate, "link"))
    for area in robot.drag_areas:
        yield f"drag area on link {area.link}", in_a_line(describe_fields(area, "link"))
    tether = describe_fields(robot.tether)
    if tether:
        yield "tether", in_a_line(tether)
    yield "surface, ends", f"{robot.surface}, {robot.nose} nose, {robot.tail} tail"


def _power_rows(robot: Robot) -> Iterator[Row]:
    if robot.idle_power:
        yield "power at rest", f"{robot.idle_power:g} W"
    if robot.active_power is not None:
        yield "electronics while swimming", f"{robot.active_power:g} W above power at rest"


def _textbook_rows(robot: Robot) -> Iterator[Row]:
    """Yield a row for each coefficient of the robot's textbook water: value, interval and source."""
    book = textbook.textbook_water(robot)
    for name, (low, high) in book.intervals.items():
        value = attrgetter(name.removeprefix("water."))(book.water)
        coefficient = name.rpartition(".")[2]
        text = f"{coefficient} {value:.3g} ({low:.3g} to {high:.3g}): {book.sources[name]}"
        yield "textbook water", text


def _axes(joints: Sequence[body.Joint]) -> str:
    initials = "".join(joint.axis[0] for joint in joints)  # y and p, tail first
    if "p" not in initials:
        return "all yaw"
    if "yy" not in initials and "pp" not in initials:
        return f"alternating yaw and pitch, {joints[0].axis} at the tail"
    return f"{initials} from the tail (y yaw, p pitch)"


def _group_equal(parts: Sequence[T]) -> list[tuple[str, T]]:
    """Group equal consecutive parts: each once, with its range of indices, such as "0-8"."""
    groups: list[tuple[str, T]] = []
    start = 0
    for part, group in groupby(parts):
        stop = start + len(list(group))
        indices = f"{start}-{stop - 1}"
        if stop == start + 1:
            indices = str(start)
        groups.append((indices, part))
        start = stop
    return groups
