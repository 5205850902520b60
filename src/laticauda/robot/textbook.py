"""Water for a custom robot from its dimensions: coefficients from tables, each with an interval and a source.

The resistance of a straight robot is an area times rho v^2 / 2: skin friction C_F on the wetted
surface, form drag of both ends, gaps at the joints. This area divided by the reference area of C_f
(`laticauda.robot.hydrodynamics`) is C_f:

    C_f = (C_F S + C_e A + C_g sum A_j) / (sum pi (a + b)/2 2l + 2 h L)      C_F = .075 / (log10 Re - 2)^2

with S the wetted surface, A the largest section, A_j the section at a joint, h and L of the fin,
and Re based on the length. Drag and added mass across the body come from tables of sections by
their ratio of width to height; fins and flat modules are plates of their own proportions
(`laticauda.robot.plates`). Drag areas (`Robot.drag_areas`) stand beside C_f.

References:
    [1] A. Morrall, 1957 ITTC Model-Ship Correlation Line, National Physical Laboratory, Ship Report 142, 1970: C_F, and
        the viscosity at 15 deg C.
    [2] Aeronautical Engineer's Data Book, p. 95, drag of standard shapes: cylinder along the flow .85 to .99, across it
        1.20, rough sphere .40, long plate across the flow 1.98, airship .020 to .025.
    [3] NASA Glenn, Beginner's Guide to Aeronautics, Shape Effects on Drag: bullet .295, aerofoil .045.
    [4] J.-H. Choi, S.-J. Lee, J. Fluids Struct. 14, 2000, abstract: an ellipse twice as long as high has about half the
        drag of a circle.
    [5] An experimental study on aerodynamic drag of rectangular cylinders, abstract: 2.6 at a depth of 2/3 of the
        height, about 2.0 for plate and square, reattachment near 2.8.
    [6] F. M. White, Fluid Mechanics, fig. 7.6: rough plates to .014 at L/roughness = 200; laminar below Re 5e5.
    [7] DNV-RP-C205, Environmental conditions and environmental loads, 2010, as quoted in secondary sources.
"""

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

from laticauda.robot.body import Section, is_flat
from laticauda.robot.environment import Water, finite_span_refusal
from laticauda.robot.robot import Robot, Surface
from laticauda.values import BadArgument, add_up
from laticauda.water.fluid import TotalSpeedDrag

TEXTBOOK = "textbook"
"""Name of this water."""
VISCOSITY = 1.14e-6
"""Kinematic viscosity of fresh water at 15 deg C [m^2/s] [1]."""
FRESH_WATER_DENSITY = 1000.0
"""Density of fresh water [kg/m^3]."""
BODY_LENGTHS = 0.5
"""Default speed in body lengths [1/s]: C_f changes by 8 % for twice the speed."""

SEEN = {
    "swimming": (-0.08, 0.16),
    "gliding": (-0.15, 0.20),
    "turning": (-0.01, 0.44),
    "starting": (-0.29, -0.19),
}
"""Simulated / measured - 1 on AmphiBot: speeds, angle, distance. `tendon-fish` with its broad fin is off far more."""

ROUGH_PLATE_FRICTION = 0.010
"""C_F of a rough plate [6]: that of a loose skin, which wrinkles [-]."""
LARGEST_PLATE_FRICTION = 0.014
"""Largest C_F of a rough plate in the chart [6] [-]."""
LARGEST_SKINNED_FACTOR = 10.0
"""Drag of a robot in a skin, at most, by that of the tables: Mamba, in a skin and on a tether, has ten times [-]."""
ADDED_MASS_SHARES = (0.8, 1.2)
"""Interval of the added mass, as shares of its value: judgment [-]."""


@dataclass(frozen=True)
class Estimate:
    """A number with its interval."""

    value: float
    """Central value."""
    low: float
    """Smallest plausible value."""
    high: float
    """Largest plausible value."""


@dataclass(frozen=True)
class DragPart:
    """A part of the drag along the body: an area times a coefficient."""

    name: str
    """Name in the text of the source."""
    area: float
    """Area on which the coefficient is based [m^2]."""
    coefficient: Estimate
    """Drag coefficient [-]."""

    @property
    def value(self) -> float:
        """Drag area [m^2]."""
        return self.area * self.coefficient.value


NOSE_DRAG: Mapping[str, Estimate] = {
    "faired": Estimate(0.02, 0.01, 0.05),
    "round": Estimate(0.1, 0.05, 0.2),
    "blunt": Estimate(0.65, 0.58, 0.72),
}
"""Share of the head end in the drag along the body, by its shape, based on the largest section [-].

The sums of both ends are those of an airship, a sphere, a cylinder along the flow and, faired
before blunt, a bullet [2, 3].
"""
TAIL_DRAG: Mapping[str, Estimate] = {
    "faired": Estimate(0.03, 0.01, 0.1),
    "round": Estimate(0.3, 0.2, 0.4),
    "blunt": Estimate(0.25, 0.22, 0.28),
}
"""Share of the tail end, likewise [-]."""
GAP_DRAG: Mapping[str, Estimate] = {
    "smooth": Estimate(0.0, 0.0, 0.0),
    "jointed": Estimate(0.01, 0.0, 0.03),
    "skinned": Estimate(0.0, 0.0, 0.0),
}
"""Drag of the gap at a joint, by the surface of the body, based on the section there [-]."""

SectionTable = Sequence[tuple[float, float]]
"""Coefficients of a section by its ratio of width to height."""
DRAG_ACROSS: Mapping[str, SectionTable] = {
    "ellipse": [(0.0, 1.98), (1.0, 1.20), (2.0, 0.60)],
    "box": [(0.0, 2.0), (0.67, 2.6), (1.0, 2.0)],
}
"""Drag coefficient across the body, by the shape of the section [2, 4, 5]."""
ADDED_MASS_ACROSS: Mapping[str, SectionTable] = {
    "ellipse": [(1.0, 1.0)],
    "box": [
        (0.02, 1.046),
        (0.1, 1.141),
        (0.2, 1.217),
        (0.5, 1.364),
        (1.0, 1.513),
        (2.0, 1.696),
        (3.0, 1.816),
        (5.0, 1.980),
    ],
}
"""Added mass coefficient across the body, by potential flow.

That of an ellipse is the same whatever the axes; that of a box is by Schwarz-Christoffel, as the
tests compute it anew.
"""
LOWEST_DRAG_SHARE: Mapping[str, SectionTable] = {"ellipse": [(1.0, 0.8)], "box": [(1.0, 0.6)]}
"""Low end of the drag across the body, as a share of its value: round corners have less [-]."""
HIGHEST_DRAG_SHARE: Mapping[str, SectionTable] = {"ellipse": [(1.0, 1.2)], "box": [(1.0, 1.1)]}
"""High end, likewise [-]."""

PLATE_DRAG_FACTOR = (0.8, 1.65)
"""Interval of the drag of plates, from rounded edges to a plate of 1.98, which is long or closed at its ends [-]."""
PLATE_SOURCES: Mapping[str, str] = {
    "water.plate_drag": "rectangular plates across the flow [7]; interval: judgment (edges, closed ends)",
    "water.plate_added_mass": "rectangular plates, vortex lattice and [7]; interval: judgment",
}
"""Sources of the parameters of fins and flat modules, by name."""
SOURCES: Mapping[str, str] = {
    "water.normal_drag": "sections across the flow [2, 4, 5]; interval: judgment (corners, Reynolds number)",
    "water.added_mass": "potential flow about the section; interval: judgment",
    "water.drag.beta": "between cross-flow principle (0) and drag along the velocity (1)",
}
"""Sources of the parameters, by name, but for the friction, whose source lists its parts."""


@dataclass(frozen=True, kw_only=True)
class Textbook:
    """Water from tables, with the uncertainty of each parameter."""

    water: Water
    """Water with the central values."""
    intervals: Mapping[str, tuple[float, float]]
    """Least and greatest value of each parameter, by its name in `laticauda.models.simulate.list_parameters`."""
    sources: Mapping[str, str]
    """Source of each parameter, by name."""


def textbook_water(
    robot: Robot, *, speed: float | None = None, surface: Surface | None = None
) -> Textbook:
    """Return the water from tables for a robot's lengths, sections, ends and surface.

    Args:
        robot: Robot that swims.
        speed: Swimming speed for the Reynolds number [m/s]; None for half its length per second.
        surface: Surface of the body, instead of the robot's own; see `Robot.surface`.

    Returns:
        The water with intervals and sources.

    Raises:
        ValueError: If the speed is not positive, or the surface is unknown.

    Example:
        >>> from laticauda.robot import load_robot
        >>> round(textbook_water(load_robot("mamba"), speed=0.15).water.tangential_friction, 3)
        0.029
    """
    body = robot if surface is None else replace(robot, surface=surface)
    v = BODY_LENGTHS * robot.length if speed is None else speed
    if not 0.0 < v < math.inf:
        raise BadArgument("speed", f"must be > 0 m/s, got {speed}")
    friction, friction_source = _friction(body, v)
    drag = _average_across(robot, DRAG_ACROSS, power=1)
    mass = _average_across(robot, ADDED_MASS_ACROSS, power=2)
    lowest_share = _average_across(robot, LOWEST_DRAG_SHARE, power=1)
    highest_share = _average_across(robot, HIGHEST_DRAG_SHARE, power=1)
    has_plates = robot.caudal_fin is not None or any(map(is_flat, robot.modules))
    plate_factor = None
    if has_plates:
        plate_factor = 1.0
    water = Water(
        name=TEXTBOOK,
        tangential_friction=friction.value,
        normal_drag=drag,
        added_mass=mass,
        plate_drag=plate_factor,
        plate_added_mass=plate_factor,
        drag=TotalSpeedDrag(beta=0.5),
        added_mass_form="kirchhoff",
        rotational="strip",
        trailing_edge=_edge_law(robot),
    )
    intervals: dict[str, tuple[float, float]] = {
        "water.tangential_friction": (friction.low, friction.high),
        "water.normal_drag": (lowest_share * drag, highest_share * drag),
        "water.added_mass": (ADDED_MASS_SHARES[0] * mass, ADDED_MASS_SHARES[1] * mass),
        "water.drag.beta": (0.0, 1.0),
    }
    sources = {**SOURCES, "water.tangential_friction": friction_source}
    if has_plates:
        intervals["water.plate_drag"] = PLATE_DRAG_FACTOR
        intervals["water.plate_added_mass"] = ADDED_MASS_SHARES
        sources |= PLATE_SOURCES
    return Textbook(water=water, intervals=intervals, sources=sources)


def _edge_law(robot: Robot) -> Literal["finite-span", "elongated"]:
    """Return the law of the trailing edge: that of a finite span, unless it does not hold for the robot."""
    if finite_span_refusal(robot) is None:
        return "finite-span"
    return "elongated"


@functools.lru_cache(maxsize=256)
def textbook_of(robot: Robot) -> Water:
    """Return only the water of `textbook_water`, the same object for the same robot.

    Args:
        robot: Robot that swims.
    """
    return textbook_water(robot).water


def skin_friction(speed: float, length: float) -> float:
    """Return C_F of the ITTC-57 line [1], based on the wetted surface [-].

    Args:
        speed: Speed [m/s].
        length: Length along the flow [m].
    """
    # Below a Reynolds number of 1000, there is hardly any turbulent friction.
    reynolds = max(speed * length / VISCOSITY, 1e3)
    return 0.075 / (math.log10(reynolds) - 2.0) ** 2


def tether_drag(length: float, diameter: float, speed: float) -> float:
    """Return the `drag` of a `Tether` towed along its length, from its skin friction [kg/m].

    Args:
        length: Length in the water [m].
        diameter: Diameter [m].
        speed: Speed [m/s].
    """
    return 0.5 * FRESH_WATER_DENSITY * skin_friction(speed, length) * math.pi * diameter * length


def _friction(robot: Robot, speed: float) -> tuple[Estimate, str]:
    """Return C_f with its interval, and its source in words.

    The uncertainties of the drag areas are independent of each other.
    """
    parts = _drag_parts(robot, speed)
    value = add_up(part.value for part in parts)
    margin_below = math.hypot(
        *(part.area * (part.coefficient.low - part.coefficient.value) for part in parts)
    )
    margin_above = math.hypot(
        *(part.area * (part.coefficient.high - part.coefficient.value) for part in parts)
    )
    highest = value + margin_above
    if robot.surface == "skinned":
        highest = LARGEST_SKINNED_FACTOR * value
    reference = _reference_area(robot)
    estimate = Estimate(
        value=value / reference,
        low=(value - margin_below) / reference,
        high=highest / reference,
    )
    listed = ", ".join(f"{part.name} {1e4 * part.value:.3g}" for part in parts)
    source = f"drag areas in cm^2 at {speed:.3g} m/s, {robot.surface}: {listed}; interval: judgment"
    return estimate, source


def _drag_parts(robot: Robot, speed: float) -> list[DragPart]:
    """Return the parts of the drag along the straight robot: skin, both ends, gaps at the joints."""
    sections = [module.section for module in robot.modules]
    wetted = add_up(module.section.perimeter * module.length for module in robot.modules)
    smooth = skin_friction(speed, robot.length)
    skin = Estimate(value=smooth, low=0.5 * smooth, high=1.5 * smooth)
    if robot.surface == "skinned":
        skin = Estimate(
            value=max(smooth, ROUGH_PLATE_FRICTION),
            low=smooth,
            high=max(smooth, LARGEST_PLATE_FRICTION),
        )
    nose = NOSE_DRAG[robot.nose]
    tail = TAIL_DRAG[robot.tail]
    ends = Estimate(
        value=nose.value + tail.value, low=nose.low + tail.low, high=nose.high + tail.high
    )
    largest_section = max(section.area for section in sections)
    joint_sections = add_up(min(behind.area, ahead.area) for behind, ahead in pairwise(sections))
    return [
        DragPart("skin (ITTC-57 [1])", wetted + _fin_surface(robot), skin),
        DragPart(f"{robot.nose} nose and {robot.tail} tail [2, 3]", largest_section, ends),
        DragPart("gaps", joint_sections, GAP_DRAG[robot.surface]),
    ]


def _fin_surface(robot: Robot) -> float:
    """Return the area of both faces of the caudal fin, 0 without one [m^2]."""
    fin = robot.caudal_fin
    if fin is None:
        return 0.0
    if fin.silhouette is not None:
        return 2.0 * fin.area
    opening_length = fin.opening_length if fin.opening == "open" else 0.0
    return 2.0 * fin.height * (fin.length - opening_length)


def _reference_area(robot: Robot) -> float:
    """Return the area on which C_f is based, see `laticauda.robot.hydrodynamics` [m^2]."""
    body = add_up(
        (module.section.half_height + module.section.half_width) * module.length
        for module in robot.modules
    )
    return _fin_surface(robot) + 0.5 * math.pi * body


def _average_across(robot: Robot, tables: Mapping[str, SectionTable], *, power: int) -> float:
    """Average a coefficient over the sections, weighted like the modules' loads: by height or its square.

    Flat modules have coefficients of their own, unless all are flat.
    """
    bodies = [module for module in robot.modules if not is_flat(module)]
    modules = bodies or robot.modules
    weights = [module.length * module.section.half_height**power for module in modules]
    coefficients = [_look_up(tables[module.section.shape], module.section) for module in modules]
    weighted = add_up(
        weight * coefficient for weight, coefficient in zip(weights, coefficients, strict=True)
    )
    return weighted / add_up(weights)


def _look_up(table: SectionTable, section: Section) -> float:
    """Interpolate a table linearly at the section's ratio of width to height; constant beyond its ends."""
    ratio = section.half_width / section.half_height
    first_ratio, first_coefficient = table[0]
    if ratio < first_ratio:
        return first_coefficient
    for (left, low), (right, high) in pairwise(table):
        if left <= ratio < right:
            return low + (high - low) * (ratio - left) / (right - left)
    _, last_coefficient = table[-1]
    return last_coefficient
