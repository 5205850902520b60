"""Rules of the house that no other tool checks."""

import ast
import csv
import importlib.metadata
import itertools
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
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
    "cv2",
    "dask",
    "distributed",
    "ezc3d",
    "gymnasium",
    "h5py",
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
MODULES = sorted((ROOT / "src").rglob("*.py"))
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def repository_files() -> list[Path]:
    """Every text file that belongs to the project: tracked, or new and not ignored."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    if listed.returncode:
        pytest.skip("not a git checkout")
    suffixes = {"", ".cff", ".csv", ".css", ".md", ".py", ".toml", ".txt", ".yml"}
    files = [ROOT / name for name in listed.stdout.splitlines()]
    return [file for file in files if file.suffix in suffixes and file.is_file()]


def test_importing_laticauda_loads_no_heavy_library():
    code = f"import sys, laticauda; print(*[name for name in {HEAVY} if name in sys.modules])"
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert loaded.stdout.split() == []


def test_every_name_that_laticauda_offers_exists():
    import laticauda

    assert all(hasattr(laticauda, name) for name in laticauda.__all__)


def test_shapes_are_checked_while_tests_run():
    from laticauda.robot import kinematics

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
    pattern = re.compile(
        "|".join(["/" + folder + "/" for folder in ("home", "root", "Users", "work", "opt")])
    )
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
        str(file.relative_to(ROOT))
        for file in repository_files()
        if stated.search(file.read_text(encoding="utf-8"))
    }
    beside = {name for name in found if name.startswith("plugins/")}  # distributions of their own
    assert found == {"pyproject.toml", *beside}
    assert beside <= {str(file.relative_to(ROOT)) for file in ROOT.glob("plugins/*/pyproject.toml")}


def required(*groups: str) -> dict[str, set[str]]:
    """What the package wants, by name, and how it is written; extras are named, "" is what all have."""
    project = PYPROJECT["project"]
    extras = {"": project["dependencies"], **project["optional-dependencies"]}
    found: dict[str, set[str]] = {}
    for requirement in itertools.chain.from_iterable(extras[group] for group in groups or extras):
        name = re.split(r"[^\w.-]", requirement)[0]
        if name != "laticauda":
            found.setdefault(distribution(name), set()).add(requirement)
    return found


def distribution(name: str) -> str:
    return name.lower().replace("_", "-")


def test_every_dependency_has_a_lower_bound_and_the_same_one_everywhere():
    assert not {name: written for name, written in required().items() if len(written) > 1}
    assert all(">=" in requirement for written in required().values() for requirement in written)
    assert {
        one for one in PYPROJECT["build-system"]["requires"] if not one.startswith("hatchling")
    } <= {requirement for written in required().values() for requirement in written}


def test_an_upper_bound_has_a_reason():
    text = (
        (ROOT / "pyproject.toml")
        .read_text(encoding="utf-8")
        .partition("[project]")[2]
        .partition("[project.scripts]")[0]
    )
    capped = [line for line in text.splitlines() if re.search(r'>=[^"]*,<', line)]
    assert len(capped) == sum(
        ",<" in requirement for written in required().values() for requirement in written
    )
    assert not [line for line in capped if "  # " not in line]


def test_the_extra_all_is_all_but_the_large_ones():
    large = {"all", "export"}
    extras = PYPROJECT["project"]["optional-dependencies"]
    assert extras["all"] == [
        f"laticauda[{','.join(extra for extra in extras if extra not in large)}]"
    ]


def imports(tree: ast.AST) -> Iterator[tuple[str, str]]:
    """What is imported, and with which of our extras it comes, or "" where that is not said."""
    for node in ast.walk(tree):
        match node:
            case ast.Import(names=names):
                yield from ((alias.name, "") for alias in names)
            case ast.ImportFrom(module=str(module), level=0):
                yield module, ""
            case ast.Call(
                func=ast.Name(id="import_module"), args=[ast.Constant(value=str(module)), *_]
            ):
                yield module, ""
            case ast.Call(func=ast.Name(id="hardware"), args=[_, ast.Constant(value=str(module))]):
                yield module, "hardware"
            case ast.Call(func=ast.Name(id="optional_import"), args=positional, keywords=named):
                names = ("feature", "package", "extra", "module")
                given = dict(zip(names, positional, strict=False))
                given |= {keyword.arg: keyword.value for keyword in named}
                extra = ast.literal_eval(given["extra"])
                match given.get("module", given["package"]):
                    case (
                        ast.Constant(value=str(name))
                        | ast.JoinedStr(values=[ast.Constant(value=str(name)), *_])
                    ):
                        yield name, extra
            case _:
                pass


def test_what_is_imported_is_declared_in_the_extra_that_is_named_and_nothing_is_declared_in_vain():
    homes = importlib.metadata.packages_distributions()
    own = {"laticauda", *sys.stdlib_module_names}
    found = {
        (*(distribution(home) for home in homes.get(top, [top])), extra)
        for module in MODULES
        for name, extra in imports(ast.parse(module.read_text(encoding="utf-8")))
        if (top := name.split(".")[0]) not in own
    }
    assert not {
        one
        for one in found
        if not {*one[:-1]} & required(*({"", one[-1]} if one[-1] else ())).keys()
    }
    program = {"ziglang"}  # run, not imported
    assert required().keys() - {name for one in found for name in one} == program


def test_the_page_gives_the_extras_the_weights_that_were_measured():
    with (ROOT / "campaigns" / "environments.csv").open(newline="", encoding="utf-8") as lines:
        answers = {row["case"]: row["answer"] for row in csv.DictReader(lines)}
    weights = {
        case.removeprefix("size of "): answer
        for case, answer in answers.items()
        if case.startswith("size of ")
    }
    assert {*PYPROJECT["project"]["optional-dependencies"], "plain"} == weights.keys()
    text = (ROOT / "docs/install.md").read_text(encoding="utf-8")
    shown = dict(re.findall(r"^\|.*`(\w+)` \|.*?(\d+ MB)", text, re.MULTILINE))
    assert shown.items() <= weights.items()
    assert weights.keys() - shown.keys() == {"plain"}
    assert weights["plain"] in text


def test_the_recipe_for_conda_wants_what_the_package_wants():
    names = {"matplotlib-base": "matplotlib", "mujoco-python": "mujoco"}
    recipe = (ROOT / "recipe" / "recipe.yaml").read_text(encoding="utf-8").partition("  run:\n")[2]
    listed = {
        names.get(name, name): bounds
        for name, bounds in re.findall(r"^    - ([\w-]+) (>=\S+)$", recipe, re.MULTILINE)
    }
    wanted = {name: one for name, written in required().items() for one in written}
    assert required("").keys() <= listed.keys() <= {*wanted, "python"}
    assert all(wanted[name].endswith(bounds) for name, bounds in listed.items() if name != "python")


KINDS_OF_CHANGE = {kind["directory"] for kind in PYPROJECT["tool"]["towncrier"]["type"]}


def test_every_unreleased_change_has_a_file_of_a_known_kind():
    fragments = [path for path in (ROOT / "changes").iterdir() if path.name != "README.md"]
    wrong_names = [
        path.name
        for path in fragments
        if path.suffix != ".md" or path.stem.rpartition(".")[2] not in KINDS_OF_CHANGE
    ]
    assert not wrong_names


def test_the_changelog_says_only_what_a_user_notices():
    assert (ROOT / "CHANGELOG.md").stat().st_size <= 8_000


LARGEST_PICTURE = 800_000
"""Size of a picture in the repository at most [bytes]."""


def test_only_the_front_pages_have_pictures_in_the_repository_and_no_large_ones():
    listed = subprocess.run(
        ["git", "ls-files", "docs/images"], cwd=ROOT, capture_output=True, text=True
    )
    if listed.returncode:
        pytest.skip("not a git checkout")
    front_pages = [ROOT / "README.md", ROOT / "docs" / "index.md"]
    text = "".join(page.read_text(encoding="utf-8") for page in front_pages)
    measured = "operate-timing.png"  # of one computer on one day: it cannot be drawn anew
    for name in listed.stdout.splitlines():
        file = ROOT / name
        if file.suffix in (".png", ".webp") and file.name != measured:
            assert file.name in text
            assert file.stat().st_size <= LARGEST_PICTURE
