"""Loading of an animat of FARMS: which files it consists of."""

from pathlib import Path

from laticauda.connect.farms.animat import FarmsAnimat
from laticauda.connect.farms.assembly import Assembly
from laticauda.connect.farms.bodies import Morphology
from laticauda.connect.farms.entries import Entry, read_entries
from laticauda.connect.farms.mjcf import read_mjcf
from laticauda.connect.farms.network_file import Drives
from laticauda.connect.farms.sdf import read_sdf
from laticauda.values import BadArgument, RobotFileError, check_finite

ANIMAT_ENDINGS = (".yaml", ".yml")
"""Endings of the files that describe an animat."""
MORPHOLOGY_ENDINGS = (".sdf", ".xml")
"""Endings of the files that describe its bodies: SDF and MJCF."""


def load_farms(
    path: str | Path,
    *,
    morphology: str | Path | None = None,
    head: str | None = None,
    drive: float | tuple[float, float] | None = None,
) -> FarmsAnimat:
    """Read an animat of FARMS: its morphology (SDF or MJCF) and its network (YAML).

    Args:
        path: The animat's YAML file; or an SDF or MJCF file alone, which has no network.
        morphology: SDF or MJCF file of the bodies; None: the one that the YAML file names.
        head: Name of the head's link; None: the root of the bodies.
        drive: Descending drive of all oscillators, or (left, right), in place of those in the file.

    Raises:
        RobotFileError: If a file cannot be read, or is not understood.
    """
    path = Path(path)
    drives = _check_drives(drive)
    ending = path.suffix.lower()
    if ending in MORPHOLOGY_ENDINGS:
        if morphology is not None:
            rule = f"must not be given with {path.name}, which is one itself"
            raise BadArgument("morphology", rule)
        return _assemble(bodies_file=path, entry=Entry(path, "", {}), head=head).build(drives)
    if ending not in ANIMAT_ENDINGS:
        endings = ", ".join((*ANIMAT_ENDINGS, *MORPHOLOGY_ENDINGS))
        raise RobotFileError(f"{path}: must be an animat of FARMS, a file that ends in {endings}")
    entry = read_entries(path)
    if morphology is None:
        bodies_file = _find_morphology(entry)
    else:
        bodies_file = Path(morphology)
    return _assemble(bodies_file=bodies_file, entry=entry, head=head).build(drives)


def _assemble(*, bodies_file: Path, entry: Entry, head: str | None) -> Assembly:
    """Return the animat of a file of bodies, about to be built."""
    return Assembly(
        morphology=_read_morphology(bodies_file),
        bodies_file=bodies_file,
        entry=entry,
        head=head,
    )


def _check_drives(drive: float | tuple[float, float] | None) -> Drives | None:
    """Return the drives of both sides."""
    if drive is None:
        return None
    if not isinstance(drive, tuple):
        drive = (drive, drive)
    if len(drive) != 2:
        raise BadArgument("drive", f"must be one number, or (left, right), got {drive}")
    left, right = drive
    return Drives(left=check_finite("drive", left), right=check_finite("drive", right))


def _read_morphology(path: Path) -> Morphology:
    """Return the bodies in an SDF or MJCF file."""
    if path.suffix.lower() == ".xml":
        return read_mjcf(path)
    return read_sdf(path)


def _find_morphology(entry: Entry) -> Path:
    """Return the SDF file that an animat names, from its own folder or one above."""
    name = entry.text("sdf")
    folder = entry.path.absolute().parent
    for candidate in (folder, *folder.parents):
        if (candidate / name).is_file():
            return candidate / name
    raise entry.error("sdf", f"names {name}, which is not there; give the file as `morphology`")
