"""Robots, waters, grounds and currents as text to read."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import groupby
from operator import attrgetter
from typing import TypeVar

from laticauda.fluid.flow import Flow
from laticauda.quantities import quantities_of
from laticauda.robot import body, effectors, environment, textbook
from laticauda.robot.robot import Robot

Row = tuple[str, str]
T = TypeVar("T")


def summary(robot: Robot) -> dict[str, str | int | float | bool]:
    """The main facts of `robot` by name: links, joints, length [m], mass [kg], fin, description."""
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
    """All that is known of `thing`, a robot, a water, a ground or a flow: one fact a line, like facts aligned."""
    if isinstance(thing, Robot):
        rows = _robot_rows(thing)
    elif isinstance(thing, Flow):
        rows = [("current", thing.words), *_flow_rows(thing)]
    elif isinstance(thing, environment.Water):
        rows = _water_rows(thing)
    else:
        rows = _ground_rows(thing)
    width = max(len(name) for name, _ in rows)
    return "\n".join(f"{name:<{width}}  {text}" for name, text in rows)


def _flow_rows(flow: Flow) -> list[Row]:
    """What each of its numbers is."""
    return [(name, f"{one.text} [{one.unit or '-'}]") for name, one in quantities_of(type(flow)).items()]


def _robot_rows(robot: Robot) -> list[Row]:
    rows: list[Row] = [("robot", robot.name)]
    if robot.description:
        rows.append(("description", robot.description))
    rows += [
        ("links, joints", f"{robot.n_links}, {robot.n_joints}"),
        ("length", f"{robot.length:.4g} m" + (" without the fin" if robot.caudal_fin else "")),
        ("mass", f"{robot.mass:.4g} kg" + (" with the fin" if robot.caudal_fin else "")),
        ("volume", f"{1e3 * robot.volume:.4g} L"),
    ]
    rows += [("modules " + place, _module(module)) for place, module in _runs(robot.modules)]
    rows += _joint_rows(robot.joints)
    for place, actuator in _runs([joint.actuator for joint in robot.joints]):
        rows += _actuator_rows("actuators " + place, actuator)
    if robot.caudal_fin is not None:
        rows.append(("caudal fin", _fin(robot.caudal_fin)))
    for thruster in robot.thrusters:
        rows.append((
            f"thruster on link {thruster.link}",
            f"{thruster.thrust:g} N{_most(thruster.max_thrust, 'N')} {_mount(thruster)}",
        ))  # fmt: skip
    for fin in robot.pectoral_fins:
        rows.append((
            f"pectoral fin on link {fin.link}",
            f"{fin.area:g} m^2{_most(fin.max_deflection and math.degrees(fin.max_deflection), 'deg')} {_mount(fin)}, "
            f"lift slope {fin.lift_slope:g} 1/rad, stalls at {_degrees(fin.stall_angle)}",
        ))  # fmt: skip
    tether = robot.tether
    if tether.drag or any(tether.force):
        rows.append(("tether", f"drag {tether.drag:g} kg/m, force ({tether.force[0]:g}, {tether.force[1]:g}) N"))
    book = textbook.textbook_water(robot)
    rows.append(("surface, ends", f"{robot.surface}, {robot.nose} nose, {robot.tail} tail"))
    for name, (low, high) in book.intervals.items():
        number = attrgetter(name.removeprefix("water."))(book.water)
        text = f"{name.rpartition('.')[2]} {number:.3g} ({low:.3g} to {high:.3g}): {book.sources[name]}"
        rows.append(("textbook water", text))
    if robot.idle_power:
        rows.append(("power at rest", f"{robot.idle_power:g} W"))
    if robot.active_power is not None:
        rows.append(("electronics while it swims", f"{robot.active_power:g} W above that"))
    return rows


def _module(module: body.Module) -> str:
    section = module.section
    parts = [
        f"{module.length:g} m, {module.mass:g} kg",
        f"{section.shape} {2.0 * section.half_height:g} m high, {2.0 * section.half_width:g} m wide",
    ]
    if module.center:
        parts.append(f"center of mass at {module.center:g} m")
    if module.inertia is not None:
        parts.append(f"moment of inertia {module.inertia:g} kg m^2")
    return ", ".join([*parts, *_own(module, "tangential_friction", "normal_drag", "added_mass", "added_inertia")])


def _own(part: body.Module | effectors.CaudalFin, *names: str) -> list[str]:
    """Coefficients that a part has of its own."""
    return [f"{name} {getattr(part, name):g}" for name in names if getattr(part, name) is not None]


def _joint_rows(joints: Sequence[body.Joint]) -> list[Row]:
    if not joints:
        return []
    axes = "".join(joint.axis[0] for joint in joints)  # y and p, tail first
    rows: list[Row] = []
    if "p" not in axes:
        rows.append(("axes", "all yaw"))
    elif "yy" not in axes and "pp" not in axes:
        rows.append(("axes", f"yaw and pitch in turn, {joints[0].axis} at the tail"))
    else:
        rows.append(("axes", f"{axes} from the tail (y yaw, p pitch)"))
    for place, joint in _runs([replace(joint, axis="yaw", actuator=body.Actuator()) for joint in joints]):
        text = f"to {_degrees(joint.limit)} on either side"
        if joint.stiffness or joint.damping:
            text += f", skin {joint.stiffness:g} N m/rad and {joint.damping:g} N m s/rad"
        rows.append((f"joints {place}", text))
    return rows


def _actuator_rows(name: str, actuator: body.Actuator) -> list[Row]:
    servo = (
        f"stall torque {actuator.stall_torque:g} N m, no-load speed {actuator.no_load_speed:g} rad/s, "
        f"gain {actuator.servo_gain:g} 1/rad, {actuator.voltage:g} V, stall current {actuator.stall_current:g} A"
    )
    if actuator.friction_torque or actuator.viscous_friction:
        servo += f", friction {actuator.friction_torque:g} N m and {actuator.viscous_friction:g} N m s/rad"
    if actuator.idle_current:
        servo += f", idle current {actuator.idle_current:g} A"
    rows = [(f"{name}, prescribed", f"{actuator.tracking:g} of the amplitude")] if actuator.tracking != 1.0 else []
    gains = f"k_p {actuator.proportional_gain:g} N m/rad, k_d {actuator.derivative_gain:g} N m s/rad"
    servo = servo if actuator.stated else f"not stated; if it were Mamba's: {servo}"
    return [*rows, (f"{name}, pd", gains), (f"{name}, servo", servo)]


def _fin(fin: effectors.CaudalFin) -> str:
    opening = f"opening of {fin.opening_length:g} m" if fin.opening == "open" else "no opening"
    parts = [f"{fin.length:g} m long, {fin.height:g} m high, {opening}, {fin.mass:g} kg, {fin.n_strips} strips"]
    parts += _own(fin, "tangential_friction", "normal_drag", "added_mass")
    if fin.n_hinges:
        hinges = "1 hinge" if fin.n_hinges == 1 else f"{fin.n_hinges} hinges"
        parts.append(
            f"bends about {hinges}, E I {fin.flexural_rigidity:g} N m^2, eta I {fin.bending_damping:g} N m^2 s"
        )
    if fin.joint is not None:
        parts.append("driven about its root")
    return ", ".join(parts)


def _mount(one: effectors.Mounted) -> str:
    """Direction and place of an effector."""
    out = "".join(f", {name} {_degrees(getattr(one, name))}" for name in ("elevation", "roll") if getattr(one, name))
    place = ", ".join(f"{part:g}" for part in (one.position if one.z else one.position[:2]))
    return f"at {_degrees(one.angle)}{out}, mounted at ({place}) m"


def _most(limit: float | None, unit: str) -> str:
    return "" if limit is None else f" (driven, to {limit:g} {unit})"


def _water_rows(water: environment.Water) -> list[Row]:
    return [
        ("water", water.name),
        ("density", f"{water.density:g} kg/m^3"),
        ("tangential_friction", f"{water.tangential_friction:g}"),
        ("normal_drag", f"{water.normal_drag:g}"),
        ("added_mass", f"{water.added_mass:g}, form {water.added_mass_form}"),
        ("added_inertia", f"{water.added_inertia:g}, rotational form {water.rotational}"),
        ("tangential_added_mass", f"{water.tangential_added_mass:g}"),
        ("drag", water.drag.words),
        *([("friction_taper", f"{water.friction_taper:g}")] if water.friction_taper else []),
        ("trailing_edge", water.trailing_edge),
        ("current", water.current_words),
        ("depth", "far below the surface" if water.depth is None else f"{water.depth:g} m"),
    ]


def _ground_rows(ground: environment.Ground) -> list[Row]:
    unit = " of the weight" if ground.friction.of_weight else " N s/m per link"
    return [
        ("ground", ground.name),
        ("friction", ground.friction.words),
        ("tangential", f"{ground.tangential:g}{unit}"),
        ("normal", f"{ground.normal:g}{unit}"),
        *([("gravity", f"{ground.gravity:g} m/s^2")] if ground.friction.of_weight else []),
    ]


def _runs(things: Sequence[T]) -> list[tuple[str, T]]:
    """Things that come several times in a row, once each, with their numbers: "0-8"."""
    runs: list[tuple[str, T]] = []
    start = 0
    for thing, group in groupby(things):
        stop = start + len(list(group))
        runs.append((str(start) if stop == start + 1 else f"{start}-{stop - 1}", thing))
        start = stop
    return runs


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):g} deg"
