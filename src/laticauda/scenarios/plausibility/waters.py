"""Density, coefficients and motion of a water, and coefficients that parts of a robot have of their own."""

import math
from collections.abc import Iterator, Mapping

from laticauda.robot import Environment, Robot, Water
from laticauda.scenarios.plausibility.doubts import (
    DENSITIES,
    LENGTHS,
    SPEEDS,
    Doubt,
    suggest_unit,
)

DENSITY_RANGE = (500.0, 1500.0)
"""Densities of liquids that robots swim in [kg/m^3]."""
DEEPEST = 11_000.0
"""Depth of the deepest sea [m]."""
FAST_CURRENT = 4.0
"""Currents above this are torrents [m/s]."""
FASTEST_CURRENT = 30.0
"""No water flows faster past a robot [m/s]."""
LARGEST_COEFFICIENTS: Mapping[str, float] = {
    "tangential_friction": 3.0,
    "normal_drag": 30.0,
    "added_mass": 10.0,
    "added_inertia": 10.0,
    "tangential_added_mass": 3.0,
}
"""Coefficients above these are hardly measured on anything that swims."""
IMPOSSIBLE = 10.0
"""How many times as large a coefficient cannot be."""


def judge_environment(environment: Environment) -> Iterator[Doubt]:
    """Yield what is odd about a water; nothing is known of grounds.

    Args:
        environment: Water or ground.
    """
    if not isinstance(environment, Water):
        return
    low, high = DENSITY_RANGE
    if not low <= environment.density <= high:
        hint = suggest_unit(environment.density, DENSITIES, lambda density: low <= density <= high)
        rule = f"must be between {low:g} and {high:g} kg/m^3, got {environment.density:g}{hint}"
        yield Doubt(name="density", rule=rule, refuses=True)
    yield from judge_coefficients("", environment)
    speed = math.hypot(*environment.uniform)
    hint = suggest_unit(speed, SPEEDS, lambda speed: speed <= 1.0)
    if speed > FASTEST_CURRENT:
        rule = f"must be <= {FASTEST_CURRENT:g} m/s, got {speed:.4g}{hint}"
        yield Doubt(name="current", rule=rule, refuses=True)
    elif speed > FAST_CURRENT:
        yield Doubt(name="current", rule=f"of {speed:.4g} m/s is a torrent{hint}")
    if environment.depth is not None and environment.depth > DEEPEST:
        hint = suggest_unit(environment.depth, LENGTHS, lambda depth: depth <= DEEPEST)
        rule = f"must be <= {DEEPEST:g} m, got {environment.depth:g}{hint}"
        yield Doubt(name="depth", rule=rule, refuses=True)


def judge_own_coefficients(robot: Robot) -> Iterator[Doubt]:
    """Yield what is odd about coefficients that modules and the fin have instead of the water's.

    The added mass of a section is measured by that of its own area: for a flat one it is as large as the
    section is high per width.

    Args:
        robot: The robot.
    """
    judged: set[int] = set()
    for i, module in enumerate(robot.modules):
        if id(module) not in judged:
            judged.add(id(module))
            flatness = module.section.half_height / module.section.half_width
            yield from judge_coefficients(f"modules[{i}].", module, max(1.0, flatness))
    if robot.caudal_fin is not None:
        yield from judge_coefficients("caudal_fin.", robot.caudal_fin)


def judge_coefficients(prefix: str, owner: object, flatness: float = 1.0) -> Iterator[Doubt]:
    """Yield what is odd about the coefficients among the fields of an object.

    Args:
        prefix: What comes before their names.
        owner: Water, module or fin.
        flatness: How much larger than usual they may be.
    """
    for name, largest in LARGEST_COEFFICIENTS.items():
        value = getattr(owner, name, None)
        if value is None or value <= largest * flatness:
            continue
        limit = IMPOSSIBLE * largest * flatness
        reason = "it is a coefficient without unit, about 1"
        if value > limit:
            rule = f"must be <= {limit:g}: {reason}, got {value:g}"
            yield Doubt(name=f"{prefix}{name}", rule=rule, refuses=True)
        else:
            yield Doubt(name=f"{prefix}{name}", rule=f"of {value:g} is large: {reason}")
