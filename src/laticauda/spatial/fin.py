"""What the bodies of the caudal fin are called."""

from laticauda.robot import CaudalFin, Piece


def fin_bodies(fin: CaudalFin) -> list[tuple[str, Piece]]:
    """The bodies of a fin by name, from the root on; the frame of each is at its head end, x toward the head."""
    return [(f"caudal_fin_{k}" if k else "caudal_fin", piece) for k, piece in enumerate(fin.pieces)]
