"""Water for a custom robot from its dimensions: coefficients from tables, each with an interval and a source.

The resistance of a straight robot is an area times rho v^2 / 2: skin friction C_F on the wetted
surface, form drag of both ends, gaps at the joints. This area divided by the reference area of C_f
(`laticauda.hydrodynamics`) is C_f:

    C_f = (C_F S + C_e A + C_g sum A_j) / (sum pi (a + b)/2 2l + 2 h L)      C_F = .075 / (log10 Re - 2)^2

with S the wetted surface, A the largest section, A_j the section at a joint, h and L of the fin,
and Re based on the length. Drag and added mass across the body come from tables of sections by
their ratio of width to height.

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
"""

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

from laticauda.errors import BadArgument
from laticauda.files import read_toml
from laticauda.fluid.laws import TotalSpeedDrag
from laticauda.robot.body import Section
from laticauda.robot.environment import Water
from laticauda.robot.robot import Robot, Surface

TEXTBOOK = "textbook"
"""Name of this water."""
VISCOSITY = 1.14e-6
"""Kinematic viscosity of fresh water at 15 deg C [m^2/s] [1]."""
BODY_LENGTHS = 0.5
"""Default speed in body lengths [1/s]: C_f changes by 8 % for twice the speed."""

SEEN = {
    "swimming": (-0.08, 0.16),
    "gliding": (-0.15, 0.20),
    "turning": (-0.01, 0.44),
    "starting": (-0.29, -0.19),
}
"""Simulated / measured - 1 on AmphiBot: speeds, angle, distance. `tendon-fish` with its broad fin is off far more."""

Range = tuple[float, float, float]
_WRINKLED = 0.010, 0.014  # C_F of a rough plate, and its largest value in the chart [6]
_SKINNED = 10.0  # Mamba, in a skin and on a tether, has ten times the drag of the tables
_TOLD: Any = read_toml(Path(__file__).with_suffix(".toml"))


@dataclass(frozen=True, kw_only=True)
class Textbook:
    """Water from tables, with the uncertainty of each parameter."""

    water: Water
    """Water with the central values."""
    intervals: Mapping[str, tuple[float, float]]
    """Least and greatest value of each parameter, by its name in `laticauda.simulate.list_parameters`."""
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
    friction, of_friction = _friction(body, v)
    drag = _across(robot, _TOLD["drag"], 1)
    mass = _across(robot, _TOLD["mass"], 2)
    spread = [
        _across(robot, {name: ((1.0, pair[i]),) for name, pair in _TOLD["spread"].items()}, 1)
        for i in (0, 1)
    ]
    water = Water(
        name=TEXTBOOK,
        tangential_friction=friction[0],
        normal_drag=drag,
        added_mass=mass,
        drag=TotalSpeedDrag(beta=0.5),
        added_mass_form="kirchhoff",
        rotational="strip",
        trailing_edge="elongated",
    )
    intervals = {
        "water.tangential_friction": (friction[1], friction[2]),
        "water.normal_drag": (spread[0] * drag, spread[1] * drag),
        "water.added_mass": (0.8 * mass, 1.2 * mass),
        "water.drag.beta": (0.0, 1.0),
    }
    sources = _TOLD["sources"] | {"water.tangential_friction": of_friction}
    return Textbook(water=water, intervals=intervals, sources=sources)


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
    reynolds = max(speed * length / VISCOSITY, 1e3)  # below, there is hardly any turbulent friction
    return 0.075 / (math.log10(reynolds) - 2.0) ** 2


def tether_drag(length: float, diameter: float, speed: float) -> float:
    """Return the `drag` of a `Tether` towed along its length, from its skin friction [kg/m].

    Args:
        length: Length in the water [m].
        diameter: Diameter [m].
        speed: Speed [m/s].
    """
    return 0.5 * 1000.0 * skin_friction(speed, length) * math.pi * diameter * length


def _friction(robot: Robot, speed: float) -> tuple[Range, str]:
    """Return C_f with its interval, from areas whose uncertainties are independent of each other."""
    sections = [module.section for module in robot.modules]
    fin = robot.caudal_fin
    hole = fin.opening_length if fin and fin.opening == "open" else 0.0
    plate = 2.0 * fin.height * (fin.length - hole) if fin else 0.0
    wetted = sum(module.section.perimeter * module.length for module in robot.modules) + plate
    reference = plate + 0.5 * math.pi * sum(
        (module.section.half_height + module.section.half_width) * module.length
        for module in robot.modules
    )
    end = max(section.area for section in sections)
    joints = sum(min(one.area, other.area) for one, other in pairwise(sections))
    smooth = skin_friction(speed, robot.length)
    skin = (smooth, 0.5 * smooth, 1.5 * smooth)
    if robot.surface == "skinned":
        skin = (max(smooth, _WRINKLED[0]), smooth, max(smooth, _WRINKLED[1]))
    nose, tail = _TOLD["nose"][robot.nose], _TOLD["tail"][robot.tail]
    ends = nose[0] + tail[0], nose[1] + tail[1], nose[2] + tail[2]
    parts = [(wetted, skin), (end, ends), (joints, _TOLD["gaps"][robot.surface])]
    value = sum(area * one[0] for area, one in parts)
    less, more = (math.hypot(*(area * (one[i] - one[0]) for area, one in parts)) for i in (1, 2))
    high = _SKINNED * value if robot.surface == "skinned" else value + more
    names = "skin (ITTC-57 [1])", f"{robot.nose} nose and {robot.tail} tail [2, 3]", "gaps"
    shown = ", ".join(
        f"{name} {1e4 * area * one[0]:.3g}" for name, (area, one) in zip(names, parts, strict=True)
    )
    text = f"drag areas in cm^2 at {speed:.3g} m/s, {robot.surface}: {shown}; interval: judgment"
    return (value / reference, (value - less) / reference, high / reference), text


def _across(robot: Robot, tables: Mapping[str, Sequence[tuple[float, float]]], power: int) -> float:
    """Average a coefficient over the sections, weighted like the modules' loads: by height or its square."""
    weights = [module.length * module.section.half_height**power for module in robot.modules]
    found = [_looked_up(tables[module.section.shape], module.section) for module in robot.modules]
    return sum(w * one for w, one in zip(weights, found, strict=True)) / sum(weights)


def _looked_up(table: Sequence[tuple[float, float]], section: Section) -> float:
    """Interpolate a table linearly at the section's ratio of width to height; constant beyond its ends."""
    ratio = section.half_width / section.half_height
    for (x, low), (following, high) in pairwise(table):
        if x <= ratio < following:
            return low + (high - low) * (ratio - x) / (following - x)
    return table[0][1] if ratio < table[0][0] else table[-1][1]
