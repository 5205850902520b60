"""Models as files that other programs open: MJCF for MuJoCo, URDF for ROS and most others."""

import shutil
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from laticauda.files import write
from laticauda.robot import Environment, Robot
from laticauda.spatial import mjcf
from laticauda.spatial.appearance import checked
from laticauda.spatial.urdf import urdf


def write_mjcf(
    path: str | Path, robot: Robot, environment: Environment, *, meshes: Iterable[str | Path] = (), **options: Any
) -> None:
    """Write a robot and its place to an MJCF file that plain MuJoCo opens; mesh files are copied beside it.

    Args:
        path: The file (.xml); an older one is replaced.
        robot: What swims.
        environment: The water it swims in or the ground it crawls on.
        meshes: As for `mjcf.spec`.
        options: Of `mjcf.spec`.

    Raises:
        MissingExtra: If MuJoCo is not installed.
        ValueError: If an argument is out of its range.
        StorageFailed: If the file cannot be written.
    """
    path = Path(path)
    model = mjcf.spec(robot, environment, meshes=checked(meshes, robot.n_links), **options)
    files = [Path(mesh.file) for mesh in model.meshes if mesh.file]
    if files:
        names = dict(zip(files, _copied(files, path), strict=True))
        model.modelfiledir = str(path.parent.resolve())
        for mesh in model.meshes:
            if mesh.file:
                mesh.file = names[Path(mesh.file)]
    model.compile()  # MuJoCo writes what it has checked
    write(path, model.to_xml())


def write_urdf(path: str | Path, robot: Robot, *, meshes: Iterable[str | Path] = ()) -> None:
    """Write a robot to a URDF file; mesh files are copied beside it.

    Args:
        path: The file (.urdf); an older one is replaced.
        robot: What swims.
        meshes: As for `mjcf.spec`.

    Raises:
        ValueError: If an argument is out of its range.
        StorageFailed: If the file cannot be written.
    """
    path = Path(path)
    write(path, urdf(robot, _copied(checked(meshes, robot.n_links), path)))


def _copied(files: list[Path], beside: Path) -> list[str]:
    """Copy files into a folder beside a model's file; what the model calls them."""
    folder = beside.with_name(f"{beside.stem}_meshes")
    places: dict[Path, str] = {}
    for file in files:
        source = file.resolve()
        if source not in places:
            folder.mkdir(exist_ok=True)
            name = f"{len(places)}_{file.name}"  # two folders may have files of the same name
            shutil.copyfile(source, folder / name)
            places[source] = f"{folder.name}/{name}"
    return [places[file.resolve()] for file in files]
