"""Robots, waters, grounds and currents as readable text: the contents of their declared fields."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby
from operator import attrgetter
from typing import TypeVar

from laticauda.fluid.flow import Flow
from laticauda.quantities import describe_fields, quantities_of
from laticauda.robot import body, environment, textbook
from laticauda.robot.robot import Robot

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
        rows = [*_robot_rows(thing)]
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


def describe_coefficients(thing: environment.Environment) -> dict[str, str]:
    """Return the fields of a water or ground other than its name, as text by field.

    Args:
        thing: A water or ground.
    """
    if isinstance(thing, environment.Water):
        depth = "far below the surface" if thing.depth is None else f"{thing.depth:g} m"
        return {
            **describe_fields(thing, "name", "density"),
            "depth": depth,
            "density": f"{thing.density:g} kg/m^3",
        }
    unit, unused = (
        ("of the weight", ()) if thing.friction.of_weight else ("N s/m per link", ("gravity",))
    )
    friction = {name: f"{getattr(thing, name):g} {unit}" for name in ("tangential", "normal")}
    return describe_fields(thing, "name", *unused) | friction


def in_a_line(facts: dict[str, str]) -> str:
    """Join facts in one line, each with its name.

    Args:
        facts: Facts from `laticauda.quantities.describe_fields`.
    """
    return ", ".join(f"{name} {text}" for name, text in facts.items())


def _robot_rows(robot: Robot) -> Iterator[Row]:
    fin = robot.caudal_fin
    yield "robot", robot.name
    if robot.description:
        yield "description", robot.description
    yield "links, joints", f"{robot.n_links}, {robot.n_joints}"
    yield "length", f"{robot.length:.4g} m" + (" without the fin" if fin else "")
    yield "mass", f"{robot.mass:.4g} kg" + (" with the fin" if fin else "")
    yield "volume", f"{1e3 * robot.volume:.4g} L"
    for place, module in _runs(robot.modules):
        yield f"modules {place}", in_a_line(describe_fields(module))
    if robot.joints:
        yield "axes", _axes(robot.joints)
    for place, joint in _runs(
        [replace(joint, axis="yaw", actuator=body.Actuator()) for joint in robot.joints]
    ):
        yield f"joints {place}", in_a_line(describe_fields(joint, "axis", "actuator"))
    for place, actuator in _runs([joint.actuator for joint in robot.joints]):
        stated = "" if actuator.stated else "not stated; with Mamba's servo: "
        yield f"actuators {place}", stated + in_a_line(describe_fields(actuator, "stated"))
    if fin is not None:
        no_hole = () if fin.opening_length else ("opening",)
        yield (
            "caudal fin",
            in_a_line({"mass": f"{fin.mass:g} kg", **describe_fields(fin, *no_hole)}),
        )
    for thruster in robot.thrusters:
        yield f"thruster on link {thruster.link}", in_a_line(describe_fields(thruster, "link"))
    for plate in robot.pectoral_fins:
        yield f"pectoral fin on link {plate.link}", in_a_line(describe_fields(plate, "link"))
    if tether := describe_fields(robot.tether):
        yield "tether", in_a_line(tether)
    yield "surface, ends", f"{robot.surface}, {robot.nose} nose, {robot.tail} tail"
    book = textbook.textbook_water(robot)
    for name, (low, high) in book.intervals.items():
        number, last = attrgetter(name.removeprefix("water."))(book.water), name.rpartition(".")[2]
        yield (
            "textbook water",
            f"{last} {number:.3g} ({low:.3g} to {high:.3g}): {book.sources[name]}",
        )
    if robot.idle_power:
        yield "power at rest", f"{robot.idle_power:g} W"
    if robot.active_power is not None:
        yield "electronics while swimming", f"{robot.active_power:g} W above power at rest"


def _axes(joints: Sequence[body.Joint]) -> str:
    axes = "".join(joint.axis[0] for joint in joints)  # y and p, tail first
    if "p" not in axes:
        return "all yaw"
    if "yy" not in axes and "pp" not in axes:
        return f"alternating yaw and pitch, {joints[0].axis} at the tail"
    return f"{axes} from the tail (y yaw, p pitch)"


def _runs(things: Sequence[T]) -> list[tuple[str, T]]:
    """Group equal consecutive things: each once, with its range of indices, such as "0-8"."""
    runs: list[tuple[str, T]] = []
    start = 0
    for thing, group in groupby(things):
        stop = start + len(list(group))
        runs.append((str(start) if stop == start + 1 else f"{start}-{stop - 1}", thing))
        start = stop
    return runs
