"""The planar reduction: modules that only bend out of the swimming plane become one rigid link."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from laticauda.robot.joints import Joint
from laticauda.robot.modules import Module


@dataclass(frozen=True, kw_only=True)
class Reduction:
    """Which modules became which link, and where they sit in it."""

    modules: tuple[Module, ...]
    """The links, tail first."""
    link: tuple[int, ...]
    """For each old module the link that it is part of [-]."""
    shift: tuple[float, ...]
    """For each old module the position of its middle in the link, from the link's middle [m]."""


def reduce_to_plane(modules: Sequence[Module], joints: Sequence[Joint]) -> Reduction:
    """Merge modules that are joined by pitch joints; these are held at 0.

    Raises:
        ValueError: If modules to be merged differ in section or fluid coefficients. No single section has the drag and
            the added mass of two different ones, so there is nothing right to put in their place.
    """
    groups: list[list[int]] = [[0]]
    for i, joint in enumerate(joints, start=1):
        if joint.axis == "pitch":
            _check_alike(modules, groups[-1][0], i)
            groups[-1].append(i)
        else:
            groups.append([i])
    links: list[Module] = []
    shifts: list[float] = []
    for group in groups:
        merged, middles = _merge([modules[i] for i in group])
        links.append(merged)
        shifts.extend(middles)
    owner = tuple(k for k, group in enumerate(groups) for _ in group)
    return Reduction(modules=tuple(links), link=owner, shift=tuple(shifts))


def _check_alike(modules: Sequence[Module], first: int, other: int) -> None:
    for name in ("section", "tangential_friction", "normal_drag", "added_mass", "added_inertia"):
        if getattr(modules[first], name) != getattr(modules[other], name):
            raise ValueError(
                f"`modules[{other}].{name}` must equal that of `modules[{first}]`, because a pitch joint makes them "
                f"one link of the planar model, got {getattr(modules[other], name)}."
            )


def _merge(pieces: Sequence[Module]) -> tuple[Module, list[float]]:
    """One rigid module in place of `pieces` in a row, and where their middles lie in it [m]."""
    if len(pieces) == 1:
        return pieces[0], [0.0]
    first = pieces[0]
    length = math.fsum(piece.length for piece in pieces)
    mass = math.fsum(piece.mass for piece in pieces)
    middles: list[float] = []
    start = -0.5 * length
    for piece in pieces:
        middles.append(start + piece.half_length)
        start += piece.length
    centers = [middle + piece.center for middle, piece in zip(middles, pieces, strict=True)]
    center = sum(piece.mass * x for piece, x in zip(pieces, centers, strict=True)) / mass
    inertia = sum(
        piece.moment_of_inertia + piece.mass * (x - center) ** 2  # parallel axes
        for piece, x in zip(pieces, centers, strict=True)
    )
    merged = Module(
        length=length,
        mass=mass,
        section=first.section,
        tangential_friction=first.tangential_friction,
        normal_drag=first.normal_drag,
        added_mass=first.added_mass,
        added_inertia=first.added_inertia,
        center=center,
        inertia=inertia,
    )
    return merged, middles
