"""Rules of the house that no other tool checks."""

import ast
import importlib.metadata
import io
import re
import subprocess
import sys
import tokenize
import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from beartype.roar import BeartypeCallHintViolation
from jaxtyping import Float, TypeCheckError
from typechecker import check, shaped

ROOT = Path(__file__).parent.parent
HEAVY = [
    "can",
    "cantools",
    "casadi",
    "dask",
    "distributed",
    "ezc3d",
    "gymnasium",
    "matplotlib",
    "mcap",
    "mujoco",
    "netCDF4",
    "numba",
    "pyarrow",
    "pymoo",
    "qtm_rt",
    "scipy",
    "serial",
    "tqdm",
    "viser",
    "xarray",
    "zarr",
]
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def repository_files() -> list[Path]:
    """Every text file that belongs to the project: tracked, or new and not ignored."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True
    )
    if listed.returncode:
        pytest.skip("not a git checkout")
    suffixes = {"", ".cff", ".csv", ".css", ".md", ".py", ".toml", ".txt", ".yml"}
    files = [ROOT / name for name in listed.stdout.splitlines()]
    return [file for file in files if file.suffix in suffixes and file.is_file()]


def test_importing_laticauda_loads_no_heavy_library():
    code = f"import sys, laticauda; print(*[name for name in {HEAVY} if name in sys.modules])"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert loaded.stdout.split() == []


def test_every_name_that_laticauda_offers_exists():
    import laticauda

    assert all(hasattr(laticauda, name) for name in laticauda.__all__)


def test_shapes_are_checked_while_tests_run():
    from laticauda import kinematics

    with pytest.raises(TypeCheckError):
        kinematics.link_angles(np.zeros(3), angle=np.zeros(2))


def test_results_the_fields_of_dataclasses_and_axes_of_one_name_are_checked_too():
    checked = shaped(typechecker=check)

    @checked
    def both(a: Float[np.ndarray, " n"], b: Float[np.ndarray, " n"]) -> Float[np.ndarray, " n"]:
        return a[: len(a) - int(b[0])]

    @checked
    @dataclass
    class Point:
        place: Float[np.ndarray, " 2"]
        name: str = ""

    @checked
    def half(x: int) -> int:
        return x / 2  # pyright: ignore[reportReturnType]

    assert len(both(np.zeros(3), np.zeros(3))) == 3
    assert Point(np.zeros(2)).name == ""
    for wrong in (
        lambda: both(np.zeros(3), np.zeros(2)),
        lambda: both(np.zeros(3), np.ones(3)),
        lambda: Point(np.zeros(3)),
        lambda: Point(np.zeros(2), 3),  # pyright: ignore[reportArgumentType]
    ):
        with pytest.raises(TypeCheckError):
            wrong()
    for argument in (3, "x"):
        with pytest.raises(BeartypeCallHintViolation):
            half(argument)


def test_no_file_names_a_path_of_somebodys_machine():
    # Written in pieces, so that this file does not name them either.
    pattern = re.compile("|".join(["/" + folder + "/" for folder in ("home", "root", "Users", "work", "opt")]))
    found = {
        f"{file.relative_to(ROOT)}:{number}": line.strip()
        for file in repository_files()
        for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), start=1)
        if pattern.search(line)
    }
    assert not found


def test_the_version_is_stated_in_one_place():
    version = PYPROJECT["project"]["version"]
    # An editable install keeps the version of the day it was made.
    assert importlib.metadata.version("laticauda") == version, "run `make setup` again"
    stated = re.compile(r"""(__version__|^\s*version)\s*[:=]\s*["']?\d""", re.MULTILINE)
    found = {
        str(file.relative_to(ROOT)) for file in repository_files() if stated.search(file.read_text(encoding="utf-8"))
    }
    beside = {name for name in found if name.startswith("plugins/")}  # distributions of their own
    assert found == {"pyproject.toml", *beside}
    assert beside <= {str(file.relative_to(ROOT)) for file in ROOT.glob("plugins/*/pyproject.toml")}


def test_every_dependency_has_a_lower_and_an_upper_bound():
    project = PYPROJECT["project"]
    groups = [
        project["dependencies"],
        *project["optional-dependencies"].values(),
        *PYPROJECT["dependency-groups"].values(),
    ]
    wanted = [requirement for group in groups for requirement in group if not requirement.startswith("laticauda[")]
    unbounded = [
        requirement for requirement in wanted if "==" not in requirement and not re.search(r">=.*,<", requirement)
    ]
    assert not unbounded


def test_the_extra_all_is_all_of_them():
    extras = dict(PYPROJECT["project"]["optional-dependencies"])
    (everything,) = extras.pop("all")
    assert everything == f"laticauda[{','.join(extras)}]"


SILENT = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}
MODULES = sorted((ROOT / "src").rglob("*.py"))


def source_lines(text: str) -> int:
    """Lines that hold code: no docstrings, comments or blank lines."""
    docs: set[int] = set()
    for node in ast.walk(ast.parse(text)):
        body = getattr(node, "body", None)
        for statement in body if isinstance(body, list) else ():
            if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant):
                docs.update(range(statement.lineno, statement.end_lineno + 1))
    tokens = [t for t in tokenize.generate_tokens(io.StringIO(text).readline) if t.type not in SILENT]
    return len({line for t in tokens for line in range(t.start[0], t.end[0] + 1)} - docs)


def test_the_house_does_not_grow():
    # What comes makes room for itself, by better cuts.
    assert sum(source_lines(module.read_text(encoding="utf-8")) for module in MODULES) <= 34_000


def test_a_module_is_one_idea_and_can_be_read_in_one_go():
    long = {module.name: n for module in MODULES if (n := len(module.read_text(encoding="utf-8").splitlines())) > 400}
    assert not long
