"""The distributions beside laticauda, as installed: only their entry points say that they are there.

An installer needs the index; so their metadata are written here, from their pyproject.toml. The
shapes that they state are checked, as those of laticauda.
"""

import sys
import tomllib
from pathlib import Path

import pytest
from typechecker import check_shapes

from laticauda.values import extensions

HERE = Path(__file__).parent

for folder in HERE.glob("laticauda-*/src"):
    check_shapes(folder)


def write_metadata(folder: Path, place: Path) -> None:
    project = tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    info = place / f"{project['name'].replace('-', '_')}-{project['version']}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(
        f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n"
    )
    groups = project.get("entry-points", {}).items()
    lines = [
        f"[{group}]\n" + "".join(f"{name} = {at}\n" for name, at in points.items())
        for group, points in groups
    ]
    (info / "entry_points.txt").write_text("".join(lines))


@pytest.fixture(scope="session", autouse=True)
def installed(tmp_path_factory):
    place = tmp_path_factory.mktemp("installed")
    for folder in HERE.glob("laticauda-*"):
        write_metadata(folder, place)
    sys.path.append(str(place))
    extensions._installed.cache_clear()
    yield
    sys.path.remove(str(place))
    extensions._installed.cache_clear()
