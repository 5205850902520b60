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
    Range,
    hardly_is,
    is_within,
    must_be,
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
MODULES = (0.01, 20.0)
"""Mass per displaced water of a module, from the lightest foam to gold."""
LIGHTEST_ROBOT = 0.4
"""Mass per displaced water below which robots hardly swim. Mamba, as it was simulated, has 0.51, a tendon fish 0.43;
sections that are given as diameters make a quarter of what is right."""
HEAVIEST_ROBOT = 1.15
"""Mass per displaced water above which a robot sinks like a stone."""
USUAL_ROBOT = (0.4, 1.15)
"""Mass per displaced water of a robot that somebody may have meant."""

LEAST_USUAL_INERTIA = 0.3
"""Share of a rod's inertia above which a module's may have been meant."""
SLIMMEST_INERTIA = 0.01
"""Share of a rod's inertia below which a module's is hardly meant."""
LARGEST_FIN = 5.0
"""Length and height of a fin are smaller [m]."""
THICKEST_FIN = 0.25
"""A plate is thinner than this share of its length or height."""
SMALLEST_FIN = 0.01
"""Size of a fin that somebody may have meant, per length of the robot."""
FIN_DENSITIES = (10.0, 20_000.0)
"""From foam to gold [kg/m^3]."""
FIN_DENSITY_RULE = "between 10 and 20000 kg/m^3"


def judge_body(robot: Robot) -> Iterator[Doubt]:
    """Yield what is odd about the modules and the fin of a robot.

    Args:
        robot: The robot.
    """
    for i, module in different_modules(robot):
        name = f"modules[{i}]"
        yield from _judge_size(name, module)
        yield from _judge_mass(name, module)
        yield from _judge_inertia(name, module)
    if robot.caudal_fin is not None:
        yield from _judge_fin(robot, robot.caudal_fin)
    yield from _judge_weight(robot)


def different_modules(robot: Robot) -> Iterator[tuple[int, Module]]:
    """Yield the modules of a robot with their numbers; of a chain, whose modules are one object, the first.

    Args:
        robot: The robot.
    """
    judged: set[int] = set()
    for i, module in enumerate(robot.modules):
        if id(module) not in judged:
            judged.add(id(module))
            yield i, module


def _judge_size(name: str, module: Module) -> Iterator[Doubt]:
    share = _weigh(module)
    length = module.length
    if length > LONGEST_MODULE:
        hint = _suggest_length(length, USUAL_LENGTHS, share * length)
        yield must_be(f"{name}.length", f"<= {LONGEST_MODULE:g} m", length, hint)
    for axis in ("half_height", "half_width"):
        size = getattr(module.section, axis)
        if size > THICKEST_MODULE:
            hint = _suggest_length(size, USUAL_HALF_AXES, share * size**2, power=2)
            yield must_be(f"{name}.section.{axis}", f"<= {THICKEST_MODULE:g} m", size, hint)


def _weigh(module: Module) -> float:
    """Return the mass of a module per displaced water."""
    return module.mass / (FRESH_WATER * module.volume)


def _suggest_length(value: float, usual: Range, weight: float, power: int = 1) -> str:
    """Return the end of a rule with the unit of a length that makes the module float, or is usual.

    Args:
        value: The length [m].
        usual: Lengths that somebody may have meant [m].
        weight: Mass per displaced water, times the power of the length.
        power: Power of the length to which the displaced water is proportional.
    """
    lightest, heaviest = USUAL_ROBOT
    root = 1.0 / power
    floating = ((weight / heaviest) ** root, (weight / lightest) ** root)
    hint = suggest_unit(value, LENGTHS, floating)
    return hint or suggest_unit(value, LENGTHS, usual)


def _judge_mass(name: str, module: Module) -> Iterator[Doubt]:
    if is_within(_weigh(module), MODULES):
        return
    water = FRESH_WATER * module.volume
    lowest, highest = _scaled(MODULES, water)
    rule = f"between {lowest:.3g} and {highest:.3g} kg for a module that displaces {water:.3g} kg of water"
    hint = suggest_unit(module.mass, MASSES, _scaled(USUAL_ROBOT, water))
    yield must_be(f"{name}.mass", rule, module.mass, hint)


def _scaled(limits: Range, factor: float) -> Range:
    low, high = limits
    return low * factor, high * factor


def _judge_inertia(name: str, module: Module) -> Iterator[Doubt]:
    """Compare an inertia with that of the mass at the corners of the module, and with a rod's."""
    inertia = module.inertia
    if inertia is None:
        return
    argument = f"{name}.inertia"
    end = module.half_length + abs(module.center)
    farthest = math.hypot(end, module.section.half_width)
    largest = module.mass * farthest**2
    rod = module.mass * module.half_length**2 / 3.0
    hint = suggest_unit(inertia, INERTIAS, (LEAST_USUAL_INERTIA * rod, largest))
    if inertia > largest:
        rule = f"<= {largest:.3g} kg m^2, all of {module.mass:g} kg at the corners"
        yield must_be(argument, rule, inertia, hint)
    elif inertia < SLIMMEST_INERTIA * rod:
        remark = f"is little beside a rod's, {rod:.3g} kg m^2"
        yield hardly_is(argument, inertia, "kg m^2", remark, hint)


def _judge_weight(robot: Robot) -> Iterator[Doubt]:
    """Compare the mass of a robot with that of the water it displaces."""
    share = robot.mass / (FRESH_WATER * robot.volume)
    weight = f"in all is {share:.2g} of the water that the robot displaces"
    if share < LIGHTEST_ROBOT:
        remark = f"{weight}: it would lie on the water"
        yield hardly_is("mass", robot.mass, "kg", remark, LIGHT_HINT)
    if share > HEAVIEST_ROBOT:
        yield hardly_is("mass", robot.mass, "kg", f"{weight}: it would sink", HEAVY_HINT)


LIGHT_HINT = (
    "; are `half_height` and `half_width` diameters, or is the mass in other units than kg?"
)
HEAVY_HINT = "; is the mass of each module that of the whole robot, or in another unit than kg?"


def _judge_fin(robot: Robot, fin: CaudalFin) -> Iterator[Doubt]:
    for name in ("length", "height"):
        yield from _judge_fin_size(robot, f"caudal_fin.{name}", getattr(fin, name))
    smaller = min(fin.length, fin.height)
    thickest = THICKEST_FIN * smaller
    name = "caudal_fin.thickness"
    if fin.thickness > smaller:
        hint = suggest_unit(fin.thickness, LENGTHS, (0.0, thickest))
        yield must_be(name, f"<= {smaller:g} m, as the fin is a plate", fin.thickness, hint)
    elif fin.thickness > thickest:
        yield hardly_is(name, fin.thickness, "m", f"is much for a plate of {smaller:g} m")
    if not is_within(fin.density, FIN_DENSITIES):
        hint = suggest_unit(fin.density, DENSITIES, FIN_DENSITIES)
        yield must_be("caudal_fin.density", FIN_DENSITY_RULE, fin.density, hint)


def _judge_fin_size(robot: Robot, name: str, size: float) -> Iterator[Doubt]:
    length = robot.length
    hint = suggest_unit(size, LENGTHS, (SMALLEST_FIN * length, length))
    if size > LARGEST_FIN:
        yield must_be(name, f"<= {LARGEST_FIN:g} m", size, hint)
    elif size > length:
        remark = f"is more than the robot's whole length, {length:.3g} m"
        yield hardly_is(name, size, "m", remark, hint)
