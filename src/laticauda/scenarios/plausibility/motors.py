"""Data of a robot's servos, and what is mounted on it."""

import math
from collections.abc import Iterator
from typing import NamedTuple

from laticauda.robot import Actuator, Robot
from laticauda.scenarios.plausibility.doubts import (
    Doubt,
    Unit,
    hardly_is,
    is_within,
    must_be,
)

LARGEST_EFFICIENCY = 1.01
"""Stall torque times no-load speed per voltage times stall current; 1 without any loss, and 1 % for rounded data."""
SMALLEST_EFFICIENCY = 0.05
"""The same of a motor that is hardly worth its supply; Mamba's servo has 0.64."""
USUAL_EFFICIENCIES = (0.2, 1.0)
"""The same of motors that somebody may have meant."""
FASTEST_SERVO = 20.0
"""No-load speeds of servos above this are rather given in another unit [rad/s]."""
STRONGEST_THRUST = 5.0
"""Thrust per weight of the robot that hardly any thruster has."""
OFF = 1e-6
"""A motor that takes less is off, and its data are not judged [W]."""
GRAVITY = 9.81
"""Standard gravity [m/s^2]."""
LARGEST_POWER = 2000.0
"""Power of electronics that hardly any robot has [W]."""


class OtherUnit(NamedTuple):
    """A field of an actuator, and a unit in which it may have been given."""

    field: str
    unit: Unit


FAST = (
    OtherUnit("no_load_speed", Unit("deg/s", math.radians(1.0))),
    OtherUnit("no_load_speed", Unit("rpm", 2.0 * math.pi / 60.0)),
)
"""Other units than rad/s."""
STRONG = (
    OtherUnit("stall_torque", Unit("kg cm", 0.0980665)),
    OtherUnit("stall_torque", Unit("N cm", 1e-2)),
    OtherUnit("stall_torque", Unit("oz in", 0.00706155)),
    OtherUnit("stall_torque", Unit("N mm", 1e-3)),
)
"""Other units than N m."""
THIRSTY = (
    OtherUnit("stall_current", Unit("mA", 1e-3)),
    OtherUnit("voltage", Unit("mV", 1e-3)),
)
"""Other units than V and A."""
LARGEST_VOLTAGE = 100.0
"""Voltages of servos above this are rather given in mV [V]."""


def judge_mounted(robot: Robot) -> Iterator[Doubt]:
    """Yield what is odd about the servos, the electronics and the thrusters of a robot.

    Args:
        robot: The robot.
    """
    judged: set[int] = set()
    for i, joint in enumerate(robot.driven_joints):
        actuator = joint.actuator
        if actuator.stated and id(actuator) not in judged:  # those of a chain are the same object
            judged.add(id(actuator))
            name = f"joints[{i}].actuator"
            yield from _judge_motor(name, actuator)
            yield from _judge_idling(name, actuator)
    power = robot.electronics_power
    if power > LARGEST_POWER:
        hint = _show_meant(power, Unit("mW", 1e-3))
        yield hardly_is("electronics_power", power, "W", "is more than robots have", hint)
    weight = robot.mass * GRAVITY
    for i, thruster in enumerate(robot.thrusters):
        ratio = abs(thruster.thrust) / weight
        if ratio > STRONGEST_THRUST:
            remark = f"is {ratio:.3g} times the weight of the robot"
            yield hardly_is(f"thrusters[{i}].thrust", thruster.thrust, "N", remark)


def _show_meant(value: float, unit: Unit) -> str:
    meant = value * unit.size
    return f"; did you mean {meant:.4g} ({value:g} {unit.name})?"


def _judge_motor(name: str, actuator: Actuator) -> Iterator[Doubt]:
    """Compare the power that a motor gives with what it takes.

    A geared motor without losses has a stall torque times no-load speed of its voltage times stall current.
    """
    if actuator.stall_power < OFF:
        return
    output = actuator.stall_torque * actuator.no_load_speed
    efficiency = output / actuator.stall_power
    if efficiency > LARGEST_EFFICIENCY:
        suspect = _suspect_too_strong(actuator, efficiency)
    elif efficiency < SMALLEST_EFFICIENCY:
        suspect = _suspect_too_thirsty(actuator, efficiency)
    else:
        return
    argument = f"{name}.{suspect.field}"
    value = getattr(actuator, suspect.field)
    input_power = f"`voltage` * `stall_current` {actuator.stall_power:.3g} W"
    powers = f"`stall_torque` * `no_load_speed` is {output:.3g} W, {input_power}"
    if efficiency > LARGEST_EFFICIENCY:
        rule = f"less, as no motor gives more than it takes: {powers}"
        yield must_be(argument, rule, value, suspect.hint)
    else:
        remark = f"makes a motor of {100.0 * efficiency:.2g} % efficiency: {powers}"
        yield hardly_is(argument, value, "", remark, suspect.hint)


def _judge_idling(name: str, actuator: Actuator) -> Iterator[Doubt]:
    current = actuator.idle_current
    if current > actuator.stall_current:
        rule = f"<= {actuator.stall_current:g} A, the `stall_current`"
        hint = _show_meant(current, Unit("mA", 1e-3))
        yield must_be(f"{name}.idle_current", rule, current, hint)


class Suspect(NamedTuple):
    """A field that is probably in another unit."""

    field: str
    hint: str
    """The end of a rule with that unit; "" if none makes the motor usual."""


def _suspect_too_strong(actuator: Actuator, efficiency: float) -> Suspect:
    """Return the field because of which a motor gives more than it takes."""
    units = STRONG
    if actuator.no_load_speed > FASTEST_SERVO:
        units = (*FAST, *STRONG)
    for field, unit in units:
        if is_within(efficiency * unit.size, USUAL_EFFICIENCIES):
            return Suspect(field, _show_meant(getattr(actuator, field), unit))
    return Suspect(units[0].field, "")


def _suspect_too_thirsty(actuator: Actuator, efficiency: float) -> Suspect:
    """Return the field because of which a motor takes far more than it gives."""
    units = THIRSTY
    if actuator.voltage > LARGEST_VOLTAGE:
        units = THIRSTY[::-1]
    for field, unit in units:
        if is_within(efficiency / unit.size, USUAL_EFFICIENCIES):
            return Suspect(field, _show_meant(getattr(actuator, field), unit))
    return Suspect(units[0].field, "")
