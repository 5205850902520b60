"""Density, coefficients and motion of a water, and coefficients that parts of a robot have of their own."""

import math
from collections.abc import Iterator, Mapping

from laticauda.robot import Environment, Robot, Water
from laticauda.scenarios.plausibility.bodies import different_modules
from laticauda.scenarios.plausibility.doubts import (
    DENSITIES,
    LENGTHS,
    SPEEDS,
    Doubt,
    hardly_is,
    is_within,
    must_be,
    suggest_unit,
)

DENSITY_RANGE = (500.0, 1500.0)
"""Densities of liquids that robots swim in [kg/m^3]."""
DENSITY_RULE = "between 500 and 1500 kg/m^3"
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
USUAL_CURRENTS = (0.0, 1.0)
"""Currents that somebody may have meant [m/s]."""
NO_UNIT = "it is a coefficient without unit, about 1"


def judge_environment(environment: Environment) -> Iterator[Doubt]:
    """Yield what is odd about a water; nothing is said of grounds.

    Args:
        environment: Water or ground.
    """
    if not isinstance(environment, Water):
        return
    density = environment.density
    if not is_within(density, DENSITY_RANGE):
        hint = suggest_unit(density, DENSITIES, DENSITY_RANGE)
        yield must_be("density", DENSITY_RULE, density, hint)
    yield from judge_coefficients("", environment)
    speed = math.hypot(*environment.uniform)
    hint = suggest_unit(speed, SPEEDS, USUAL_CURRENTS)
    if speed > FASTEST_CURRENT:
        yield must_be("current", f"<= {FASTEST_CURRENT:g} m/s", speed, hint)
    elif speed > FAST_CURRENT:
        yield hardly_is("current", speed, "m/s", "is a torrent", hint)
    depth = environment.depth
    if depth is not None and depth > DEEPEST:
        hint = suggest_unit(depth, LENGTHS, (0.0, DEEPEST))
        yield must_be("depth", f"<= {DEEPEST:g} m", depth, hint)


def judge_own_coefficients(robot: Robot) -> Iterator[Doubt]:
    """Yield what is odd about coefficients that modules and the fin have instead of the water's.

    The added mass of a section is measured by that of its own area: for a flat one it is as large as the
    section is high per width.

    Args:
        robot: The robot.
    """
    for i, module in different_modules(robot):
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
    for field, usual in LARGEST_COEFFICIENTS.items():
        value = getattr(owner, field, None)
        largest = usual * flatness
        if value is None or value <= largest:
            continue
        limit = IMPOSSIBLE * largest
        name = f"{prefix}{field}"
        if value > limit:
            yield must_be(name, f"<= {limit:.4g}: {NO_UNIT}", value)
        else:
            yield hardly_is(name, value, "", f"is large: {NO_UNIT}")
