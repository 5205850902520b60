"""The caudal fin as rigid pieces behind the tail link, with a hinge at the head end of each."""

from dataclasses import dataclass, fields

import numpy as np

from laticauda.fluid import Coefficients
from laticauda.planar import rows
from laticauda.robot import CaudalFin, Hinge, Joint


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
    """Joint law of the hinge at its head end (`rows.LOCKED` ... `rows.PASSIVE`)."""
    joint: Joint | None = None
    """What drives that hinge."""
    hinge: Hinge | None = None
    """The bending that it stands for."""


def fin_bodies(fin: CaudalFin, strips: Coefficients, *, joints: int, as_links: bool = False) -> list[FinBody]:
    """Cut the fin at its hinges.

    Args:
        fin: The plate.
        strips: Its strips, none of which a hinge cuts (`laticauda.fluid.link_coefficients`).
        joints: Joint law of a driven root.
        as_links: Cut it at all strips, with locked hinges where it is rigid.

    Returns:
        The pieces from the root to the trailing edge.
    """
    middle = -strips.position
    begins: dict[float, Hinge | None] = {0.0: None, **{hinge.position: hinge for hinge in fin.hinges}}
    if as_links:
        for edge in middle - strips.half_length:
            if np.min(np.abs(np.array(list(begins)) - edge)) > 1e-9:
                begins[float(edge)] = None
    edges = [*sorted(begins), fin.length]
    pieces: list[FinBody] = []
    for begin, end in zip(edges[:-1], edges[1:], strict=True):
        hinge = begins[begin]
        joint = fin.joint if begin == 0.0 else None
        pieces.append(
            FinBody(
                length=end - begin,
                mass=fin.mass * (end - begin) / fin.length,
                strips=_moved(strips, (middle > begin) & (middle < end), end),
                law=joints if joint is not None else rows.PASSIVE if hinge is not None else rows.LOCKED,
                joint=joint,
                hinge=hinge,
            )
        )
    return pieces


def _moved(strips: Coefficients, own: np.ndarray, end: float) -> Coefficients:
    """Some of the strips, their positions counted from `end` behind the root."""
    taken = {field.name: getattr(strips, field.name)[own] for field in fields(strips) if field.name != "fin"}
    return Coefficients(**{**taken, "position": taken["position"] + end})
