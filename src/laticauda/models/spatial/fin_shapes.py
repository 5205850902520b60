"""Shapes of the pieces of a caudal fin: the plate behind its opening, and the two rods that hold the plate."""

from typing import NamedTuple

from laticauda.models.spatial.bodies import Three
from laticauda.robot import CaudalFin, Piece

SHORTEST_SHAPE = 1e-3
"""Minimum length of a shape [m]."""
ROD_POSITION = 0.4
"""Distance of a rod from the middle of the fin, relative to the fin's height [-]."""
ROD_HALF_HEIGHT = 0.06
"""Half height of a rod, relative to the fin's height [-]."""


class Box(NamedTuple):
    """A box-shaped part of the fin, in the frame of its piece."""

    half_size: Three
    """Half size along x, y and z [m]."""
    position: Three
    """Position of its center [m]."""


def build_fin_plate(fin: CaudalFin, piece: Piece) -> Box | None:
    """Return the part of a piece of the fin that lies behind the opening, or None if there is none."""
    begin = max(_visible_opening(fin), piece.begin)
    if begin >= piece.end:
        return None
    return _build_box(fin, piece, begin=begin, end=piece.end, height=0.0, half_height=0.5)


def build_fin_rods(fin: CaudalFin, piece: Piece) -> list[Box]:
    """Return a piece's part of the two rods that hold the plate, above and below the opening."""
    end = min(_visible_opening(fin), piece.end)
    if piece.begin >= end:
        return []
    rods: list[Box] = []
    for height in (-ROD_POSITION, ROD_POSITION):
        rod = _build_box(
            fin, piece, begin=piece.begin, end=end, height=height, half_height=ROD_HALF_HEIGHT
        )
        rods.append(rod)
    return rods


def _visible_opening(fin: CaudalFin) -> float:
    """Return the visible length of the opening [m]: 0 if it is closed, or too short for a shape."""
    if fin.opening == "closed" or fin.opening_length < SHORTEST_SHAPE:
        return 0.0
    return fin.opening_length


def _build_box(
    fin: CaudalFin, piece: Piece, *, begin: float, end: float, height: float, half_height: float
) -> Box:
    """Return a box as thick as the fin.

    Args:
        fin: The fin.
        piece: The piece in whose frame the box is.
        begin: Where the box begins, behind the fin's root [m].
        end: Where it ends, behind the fin's root [m].
        height: Height of its center, relative to the fin's height [-].
        half_height: Its half height, relative to the fin's height [-].
    """
    half_size = (0.5 * (end - begin), 0.5 * fin.thickness, half_height * fin.height)
    middle = piece.begin - 0.5 * (begin + end)
    return Box(half_size=half_size, position=(middle, 0.0, height * fin.height))
