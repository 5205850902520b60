"""Mesh files of the user that show the modules of a robot: one file per module, tail first."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from laticauda.values import BadArgument, write

SUFFIXES = (".stl", ".obj")
"""Types of files that MuJoCo and viewers of URDF files read."""


def check_meshes(meshes: Iterable[str | Path], n_links: int) -> list[Path]:
    """Return the paths of mesh files, after checking that there is none, or one readable file per module.

    Raises:
        ValueError: If the number of files is wrong, or a file is missing or of another type.
    """
    files = [Path(file) for file in meshes]
    if files:
        check_count(len(files), n_links)
    for file in files:
        if file.suffix.lower() not in SUFFIXES or not file.is_file():
            raise BadArgument("meshes", f"must be existing .stl or .obj files, got {file}")
    return files


def check_count(n_files: int, n_links: int) -> None:
    """Reject a number of mesh files that is not that of the modules."""
    if n_files != n_links:
        rule = f"must be one file per module ({n_links}) or none, got {n_files}"
        raise BadArgument("meshes", rule)


def copy_meshes(files: Sequence[Path], model_file: Path) -> list[str]:
    """Copy mesh files into a folder next to a model's file, and return their paths relative to that file.

    Args:
        files: The mesh files; one that occurs repeatedly is copied once.
        model_file: The model's file.
    """
    folder = model_file.with_name(f"{model_file.stem}_meshes")
    copies: dict[Path, str] = {}
    for file in files:
        source = file.resolve()
        if source in copies:
            continue
        folder.mkdir(exist_ok=True)
        # Files in different folders may have the same name.
        name = f"{len(copies)}_{file.name}"
        write(folder / name, source.read_bytes())
        copies[source] = f"{folder.name}/{name}"
    return [copies[file.resolve()] for file in files]
