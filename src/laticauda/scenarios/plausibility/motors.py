"""Data of a robot's servos, and what is mounted on it."""

import math
from collections.abc import Iterator
from typing import NamedTuple

from laticauda.robot import Actuator, Robot
from laticauda.scenarios.plausibility.doubts import Doubt, Unit

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
            yield from _judge_motor(f"joints[{i}].actuator", actuator)
    if robot.electronics_power > LARGEST_POWER:
        watts = robot.electronics_power
        rule = f"of {watts:g} W is more than robots have; did you mean {1e-3 * watts:.4g} ({watts:g} mW)?"
        yield Doubt(name="electronics_power", rule=rule)
    for i, thruster in enumerate(robot.thrusters):
        weight = robot.mass * GRAVITY
        if abs(thruster.thrust) > STRONGEST_THRUST * weight:
            times = abs(thruster.thrust) / weight
            rule = f"of {thruster.thrust:g} N is {times:.3g} times the weight of the robot"
            yield Doubt(name=f"thrusters[{i}].thrust", rule=rule)


def _judge_motor(name: str, actuator: Actuator) -> Iterator[Doubt]:
    """Compare the power that a motor gives with what it takes.

    A geared motor without losses has a stall torque times no-load speed of its voltage times stall current.
    """
    given = actuator.stall_torque * actuator.no_load_speed
    efficiency = given / actuator.stall_power
    taken = f"`voltage` * `stall_current` {actuator.stall_power:.3g} W"
    shown = f"`stall_torque` * `no_load_speed` is {given:.3g} W, {taken}"
    if efficiency > LARGEST_EFFICIENCY:
        field, hint = _suggest(actuator, efficiency, gives_too_much=True)
        value = getattr(actuator, field)
        rule = f"must not let the motor give more than it takes: {shown}, got {value:g}{hint}"
        yield Doubt(name=f"{name}.{field}", rule=rule, refuses=True)
    if efficiency < SMALLEST_EFFICIENCY:
        field, hint = _suggest(actuator, efficiency, gives_too_much=False)
        value = getattr(actuator, field)
        rule = f"of {value:g} makes a motor of {100.0 * efficiency:.2g} % efficiency: {shown}{hint}"
        yield Doubt(name=f"{name}.{field}", rule=rule)
    if actuator.idle_current > actuator.stall_current:
        rule = f"must be <= {actuator.stall_current:g} A, the `stall_current`, got {actuator.idle_current:g}"
        milli = 1e-3 * actuator.idle_current
        hint = f"; did you mean {milli:.4g} ({actuator.idle_current:g} mA)?"
        yield Doubt(name=f"{name}.idle_current", rule=f"{rule}{hint}", refuses=True)


def _suggest(actuator: Actuator, efficiency: float, *, gives_too_much: bool) -> tuple[str, str]:
    """Return the field that is probably in another unit, and the end of a rule that says which unit."""
    is_fast = actuator.no_load_speed > FASTEST_SERVO
    candidates = (*FAST, *STRONG) if is_fast else STRONG
    if not gives_too_much:
        candidates = THIRSTY[::-1] if actuator.voltage > LARGEST_VOLTAGE else THIRSTY
    low, high = USUAL_EFFICIENCIES
    for field, unit in candidates:
        corrected = efficiency * unit.size if gives_too_much else efficiency / unit.size
        if low <= corrected <= high:
            value = getattr(actuator, field)
            return field, f"; did you mean {value * unit.size:.4g} ({value:g} {unit.name})?"
    return candidates[0].field, ""
