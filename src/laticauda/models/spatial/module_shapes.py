"""Shapes of the modules of a robot: the hull that touches the world, and what is shown of them.

The shapes follow the proportions of Mamba's modules. A module is a row of housings, each with a
band around it; the head has a rounded front and a collar. All are in the frame of the module, with
x from its tail end toward the head.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from laticauda.models.spatial.meshes import (
    VERTICES_PER_SECTION,
    Mesh,
    Section,
    join_meshes,
    loft_sections,
)
from laticauda.robot import Module

PITCH = 1.64
"""Length of one housing in half heights of the module, as on Mamba's modules [-]."""
GAP = 0.012
"""Gap between two housings, filled by the bellows [m]."""
LARGEST_GAP = 0.2
"""Largest part of a housing's length that the gap takes [-]."""
CORE = 0.84
"""Size of the core inside the housings, relative to the module [-]."""
PROUD = 1.012
"""Size of a band around a housing, relative to the module [-]."""
NOSE = 1.5
"""Length of the rounded front, in half heights of the module [-]."""
LONGEST_NOSE = 0.75
"""Largest part of the head's length that the rounded front takes [-]."""
HULL_VERTICES = 24
"""Vertices around the hull."""

Builder = Callable[[Module], Mesh]


class Span(NamedTuple):
    """A part of a module's length."""

    begin: float
    """Start, from the module's tail end [m]."""
    end: float
    """End, from the module's tail end [m]."""


class Ring(NamedTuple):
    """A section of a shape, relative to that of the module."""

    x: float
    """Position, from the module's tail end [m]."""
    scale: float
    """Size, relative to the section of the module [-]."""


def choose_builders(*, is_head: bool) -> dict[str, Builder]:
    """Return the functions that build a module's parts, by material."""
    if is_head:
        return {"head": build_head, "collar": build_collar}
    return {"housing": build_housings, "band": build_bands}


def build_hull(module: Module) -> Mesh:
    """Return the module's shape in the models: an elliptic cylinder."""
    rings = [Ring(0.0, 1.0), Ring(module.length, 1.0)]
    return _build_surface(module, rings, around=HULL_VERTICES)


def build_housings(module: Module) -> Mesh:
    """Return a row of housings with beveled ends, and the core that holds them together."""
    rings: list[Ring] = []
    for housing in _spans_of_housings(module):
        bevel = 0.08 * (housing.end - housing.begin)
        rings += [
            Ring(housing.begin, CORE),
            Ring(housing.begin, 0.9),
            Ring(housing.begin + bevel, 1.0),
            Ring(housing.end - bevel, 1.0),
            Ring(housing.end, 0.9),
            Ring(housing.end, CORE),
        ]
    return _build_surface(module, rings)


def build_bands(module: Module) -> Mesh:
    """Return a band around every housing."""
    bands: list[Mesh] = []
    for housing in _spans_of_housings(module):
        length = housing.end - housing.begin
        band = Span(housing.begin + 0.40 * length, housing.begin + 0.62 * length)
        bands.append(_build_band(module, band))
    return join_meshes(*bands)


def build_head(module: Module) -> Mesh:
    """Return a housing with a rounded front."""
    begin = 0.5 * min(GAP, LARGEST_GAP * module.length)
    end = module.length
    length = end - begin
    nose = min(NOSE * module.section.half_height, LONGEST_NOSE * length)
    rings = [Ring(begin, 0.9), Ring(begin + 0.06 * length, 1.0)]
    for angle in np.linspace(0.0, 0.5 * np.pi, 15):
        x = end - nose * (1.0 - float(np.sin(angle)))
        # The cosine of the last angle may be slightly negative.
        scale = max(float(np.cos(angle)), 0.0) ** 0.8
        rings.append(Ring(x, scale))
    return _build_surface(module, rings)


def build_collar(module: Module) -> Mesh:
    """Return the dark band around the neck of the head."""
    return _build_band(module, Span(0.16 * module.length, 0.26 * module.length))


def _build_band(module: Module, band: Span) -> Mesh:
    rings = [
        Ring(band.begin, 0.9),
        Ring(band.begin, PROUD),
        Ring(band.end, PROUD),
        Ring(band.end, 0.9),
    ]
    return _build_surface(module, rings)


def _build_surface(
    module: Module, rings: list[Ring], *, around: int = VERTICES_PER_SECTION
) -> Mesh:
    """Return a surface through rings, with `around` vertices each."""
    sections: list[Section] = []
    for ring in rings:
        section = Section(
            x=ring.x,
            half_height=ring.scale * module.section.half_height,
            half_width=ring.scale * module.section.half_width,
        )
        sections.append(section)
    return loft_sections(sections, around=around)


def _spans_of_housings(module: Module) -> list[Span]:
    """Return where the housings of a module begin and end; their number follows Mamba's proportions."""
    n_housings = max(1, round(module.length / (PITCH * module.section.half_height)))
    pitch = module.length / n_housings
    gap = min(GAP, LARGEST_GAP * module.length / n_housings)
    return [Span(k * pitch + 0.5 * gap, (k + 1) * pitch - 0.5 * gap) for k in range(n_housings)]
