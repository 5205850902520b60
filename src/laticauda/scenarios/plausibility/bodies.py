"""Size, mass and inertia of a robot's modules, and the size of its fin."""

import math
from collections.abc import Iterator

from laticauda.robot import CaudalFin, Module, Robot
from laticauda.scenarios.plausibility.doubts import (
    DENSITIES,
    INERTIAS,
    LENGTHS,
    MASSES,
    Doubt,
    suggest_unit,
)

LONGEST_MODULE = 5.0
"""A module is shorter [m]."""
THICKEST_MODULE = 2.0
"""Half-axes of a section are shorter [m]."""
USUAL_LENGTHS = (0.01, 1.0)
"""Lengths of modules and fins that somebody may have meant [m]."""
USUAL_HALF_AXES = (0.002, 0.3)
"""Half-axes of sections that somebody may have meant [m]."""

FRESH_WATER = 1000.0
"""Density of the water that a module is weighed against [kg/m^3]."""
LIGHTEST_MODULE = 0.01
"""Mass per displaced water of the lightest foam."""
HEAVIEST_MODULE = 20.0
"""Mass per displaced water of gold."""
LIGHTEST_ROBOT = 0.4
"""Mass per displaced water below which robots hardly swim. Mamba, as it was simulated, has 0.51, a tendon fish 0.43;
sections that are given as diameters make a quarter of what is right."""
HEAVIEST_ROBOT = 1.15
"""Mass per displaced water above which a robot sinks like a stone."""
USUAL_ROBOT = (0.4, 1.15)
"""Mass per displaced water of a robot that somebody may have meant."""

SLIMMEST_INERTIA = 0.01
"""Share of a rod's inertia below which a module's is hardly meant."""
LARGEST_FIN = 5.0
"""Length and height of a fin are smaller [m]."""
THICKEST_FIN = 0.25
"""A plate is thinner than this share of its length or height."""
FIN_DENSITIES = (10.0, 20_000.0)
"""From foam to gold [kg/m^3]."""


def judge_body(robot: Robot) -> Iterator[Doubt]:
    """Yield what is odd about the modules and the fin of a robot.

    Args:
        robot: The robot.
    """
    judged: set[int] = set()
    for i, module in enumerate(robot.modules):
        if id(module) not in judged:  # those of a chain are the same object
            judged.add(id(module))
            yield from _judge_size(f"modules[{i}]", module)
            yield from _judge_mass(f"modules[{i}]", module)
            yield from _judge_inertia(f"modules[{i}]", module)
    if robot.caudal_fin is not None:
        yield from _judge_fin(robot, robot.caudal_fin)
    yield from _judge_weight(robot)


def _is_within(value: float, limits: tuple[float, float]) -> bool:
    low, high = limits
    return low <= value <= high


def _judge_size(name: str, module: Module) -> Iterator[Doubt]:
    share = module.mass / (FRESH_WATER * module.volume)
    if module.length > LONGEST_MODULE:
        hint = _suggest_length(module.length, USUAL_LENGTHS, share * module.length)
        rule = f"must be <= {LONGEST_MODULE:g} m, got {module.length:g}{hint}"
        yield Doubt(name=f"{name}.length", rule=rule, refuses=True)
    for axis in ("half_height", "half_width"):
        size = getattr(module.section, axis)
        if size > THICKEST_MODULE:
            hint = _suggest_length(size, USUAL_HALF_AXES, share * size**2, power=2)
            rule = f"must be <= {THICKEST_MODULE:g} m, got {size:g}{hint}"
            yield Doubt(name=f"{name}.section.{axis}", rule=rule, refuses=True)


def _suggest_length(value: float, usual: tuple[float, float], weight: float, power: int = 1) -> str:
    """Return the end of a rule with the unit of a length that makes the module float, or is usual.

    Args:
        value: The length [m].
        usual: Lengths that somebody may have meant [m].
        weight: Mass per displaced water, times the power of the length.
        power: Power of the length to which the displaced water is proportional.
    """
    hint = suggest_unit(value, LENGTHS, lambda m: _is_within(weight / m**power, USUAL_ROBOT))
    return hint or suggest_unit(value, LENGTHS, lambda m: _is_within(m, usual))


def _judge_mass(name: str, module: Module) -> Iterator[Doubt]:
    water = FRESH_WATER * module.volume
    if LIGHTEST_MODULE <= module.mass / water <= HEAVIEST_MODULE:
        return
    hint = suggest_unit(module.mass, MASSES, lambda kg: _is_within(kg / water, USUAL_ROBOT))
    lowest, highest = LIGHTEST_MODULE * water, HEAVIEST_MODULE * water
    limits = f"between {lowest:.3g} and {highest:.3g} kg for a module that displaces {water:.3g} kg"
    rule = f"must be {limits} of water, got {module.mass:g}{hint}"
    yield Doubt(name=f"{name}.mass", rule=rule, refuses=True)


def _judge_inertia(name: str, module: Module) -> Iterator[Doubt]:
    """Compare an inertia with that of the mass at the corners of the module, and with a rod's."""
    inertia = module.inertia
    if inertia is None:
        return
    farthest = math.hypot(module.half_length + abs(module.center), module.section.half_width)
    largest = module.mass * farthest**2
    rod = module.mass * module.half_length**2 / 3.0
    hint = suggest_unit(inertia, INERTIAS, lambda value: 0.3 * rod <= value <= largest)
    if inertia > largest:
        rule = f"must be <= {largest:.3g} kg m^2, all of {module.mass:g} kg at the corners"
        yield Doubt(name=f"{name}.inertia", rule=f"{rule}, got {inertia:g}{hint}", refuses=True)
    elif inertia < SLIMMEST_INERTIA * rod:
        rule = f"of {inertia:g} kg m^2 is little beside a rod's, {rod:.3g} kg m^2{hint}"
        yield Doubt(name=f"{name}.inertia", rule=rule)


def _judge_weight(robot: Robot) -> Iterator[Doubt]:
    """Compare the mass of a robot with that of the water it displaces."""
    water = FRESH_WATER * robot.volume
    share = robot.mass / water
    weight = f"of {robot.mass:.3g} kg in all is {share:.2g} of the water that the robot displaces"
    if share < LIGHTEST_ROBOT:
        hint = (
            "are `half_height` and `half_width` diameters, or is the mass in other units than kg?"
        )
        yield Doubt(name="mass", rule=f"{weight}: it would lie on the water; {hint}")
    if share > HEAVIEST_ROBOT:
        yield Doubt(name="mass", rule=f"{weight}: it would sink; is it that of a module, in kg?")


def _judge_fin(robot: Robot, fin: CaudalFin) -> Iterator[Doubt]:
    for name in ("length", "height"):
        size = getattr(fin, name)
        hint = suggest_unit(size, LENGTHS, lambda m: 0.01 * robot.length <= m <= robot.length)
        if size > LARGEST_FIN:
            rule = f"must be <= {LARGEST_FIN:g} m, got {size:g}{hint}"
            yield Doubt(name=f"caudal_fin.{name}", rule=rule, refuses=True)
        elif size > robot.length:
            rule = (
                f"of {size:g} m is more than the robot's whole length, {robot.length:.3g} m{hint}"
            )
            yield Doubt(name=f"caudal_fin.{name}", rule=rule)
    smaller = min(fin.length, fin.height)
    if fin.thickness > smaller:
        hint = suggest_unit(fin.thickness, LENGTHS, lambda m: m <= THICKEST_FIN * smaller)
        rule = f"must be <= {smaller:g} m, as the fin is a plate, got {fin.thickness:g}{hint}"
        yield Doubt(name="caudal_fin.thickness", rule=rule, refuses=True)
    elif fin.thickness > THICKEST_FIN * smaller:
        rule = f"of {fin.thickness:g} m is much for a plate of {smaller:g} m"
        yield Doubt(name="caudal_fin.thickness", rule=rule)
    if not _is_within(fin.density, FIN_DENSITIES):
        low, high = FIN_DENSITIES
        hint = suggest_unit(
            fin.density, DENSITIES, lambda density: _is_within(density, FIN_DENSITIES)
        )
        rule = f"must be between {low:g} and {high:g} kg/m^3, got {fin.density:g}{hint}"
        yield Doubt(name="caudal_fin.density", rule=rule, refuses=True)
