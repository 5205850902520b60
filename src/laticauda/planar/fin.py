"""The caudal fin as rigid pieces behind the tail link, with a hinge at the head end of each."""

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace

import numpy as np

from laticauda.hydrodynamics import Coefficients
from laticauda.planar import rows
from laticauda.robot import CaudalFin, Hinge, Joint, Piece


@dataclass(frozen=True, kw_only=True, eq=False)
class FinBody:
    """One rigid piece of the fin."""

    length: float
    """[m]."""
    mass: float
    """Of the plate, spread evenly, opening included [kg]."""
    strips: Coefficients
    """What of it feels the water; positions are those from the piece's tail end."""
    law: int
    """Joint law of the hinge at its head end (`actuation.laws.LOCKED` and so on)."""
    joint: Joint | None
    """What drives that hinge."""
    hinge: Hinge | None
    """The bending that it stands for."""


def fin_bodies(fin: CaudalFin, strips: Coefficients, *, joints: int, as_links: bool = False) -> list[FinBody]:
    """Cut the fin at its hinges.

    Args:
        fin: The plate.
        strips: Its strips, none of which a hinge cuts (`laticauda.hydrodynamics.link_coefficients`).
        joints: Joint law of a driven root.
        as_links: Cut it at all strips, with locked hinges where it is rigid.

    Returns:
        The pieces from the root to the trailing edge.
    """
    middle = -strips.position
    pieces = fin.pieces
    if as_links:
        edges = middle - strips.half_length
        pieces = [finer for piece in pieces for finer in _cut(piece, edges)]
    bodies: list[FinBody] = []
    for piece in pieces:
        joint = fin.joint if piece.begin == 0.0 else None
        passive = rows.LOCKED if piece.hinge is None else rows.PASSIVE
        bodies.append(
            FinBody(
                length=piece.length,
                mass=piece.mass,
                strips=_moved(strips, (middle > piece.begin) & (middle < piece.end), piece.end),
                law=passive if joint is None else joints,
                joint=joint,
                hinge=piece.hinge,
            )
        )
    return bodies


def _cut(piece: Piece, edges: np.ndarray) -> Iterator[Piece]:
    """A piece in parts, cut where strips begin inside it."""
    inside = edges[(edges > piece.begin + 1e-9) & (edges < piece.end - 1e-9)]
    ends = [piece.begin, *map(float, inside), piece.end]
    for i, begin in enumerate(ends[:-1]):
        mass = piece.mass * (ends[i + 1] - begin) / piece.length
        yield replace(piece, begin=begin, end=ends[i + 1], mass=mass, hinge=None if i else piece.hinge)


def _moved(strips: Coefficients, own: np.ndarray, end: float) -> Coefficients:
    """Some of the strips, their positions counted from `end` behind the root."""
    taken = {field.name: getattr(strips, field.name)[own] for field in fields(strips) if field.name != "fin"}
    return Coefficients(**{**taken, "position": taken["position"] + end})
