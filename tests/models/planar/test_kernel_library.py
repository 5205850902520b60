"""Single runs from the library of kernels: the numbers of Numba, and Numba itself wherever the library does not fit."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import laticauda as lc
from laticauda.connect.native import kernel_library as made, platforms
from laticauda.models.planar import kernel_library
from laticauda.models.planar.kernel_library import LibraryKernels, describe_kernel, find_run
from laticauda.models.planar.model import RUN, RUN_PRESCRIBED, PlanarPlant
from laticauda.models.simulate import needs_compiling
from laticauda.water.fluid import PolynomialDrag
from laticauda.water.fluid.laws import FunctionDrag, TotalSpeedDrag
from laticauda.water.fluid.uniform import LinearShear

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.2, phase_shift=0.7)
COMMAND = lc.Command(gait=GAIT)
MAKE = "import sys, pathlib; from laticauda.connect.native.kernel_library import make_library; " + (
    "print(make_library(pathlib.Path(sys.argv[1])))"
)
NUMBA = """
import sys
from laticauda.cli import main
sys.argv = ["laticauda", "swim", "--duration", "1"]
main()
assert "numba" not in sys.modules and "llvmlite" not in sys.modules
"""


def make(folder: Path, **variables: str) -> str:
    """Return what a process of its own says that makes the library in this folder."""
    command = [sys.executable, "-c", MAKE, str(folder)]
    done = subprocess.run(
        command, env={**os.environ, **variables}, capture_output=True, text=True, check=True
    )
    return done.stdout.strip()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the installation's library, or of one that is made now."""
    if kernel_library.read_contents(kernel_library.FOLDER) is not None:
        return kernel_library.FOLDER
    folder = tmp_path_factory.mktemp("ready")
    reason = make(folder)
    if reason:
        pytest.skip(reason)
    return folder


@pytest.fixture
def library(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The library, which the package now uses."""
    monkeypatch.setattr(kernel_library, "FOLDER", folder)
    kernel_library._load.cache_clear()
    yield folder
    kernel_library._load.cache_clear()


@pytest.fixture
def copied(library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the library, which the package now uses."""
    copied = Path(shutil.copytree(library, tmp_path / "ready"))
    monkeypatch.setattr(kernel_library, "FOLDER", copied)
    return copied


def is_used() -> bool:
    """Return whether the package finds the kernels of the paper's water in its library."""
    kernel_library._load.cache_clear()
    return find_run(RUN, PolynomialDrag().formula, None) is not None


def plants() -> dict[str, Callable[[], Any]]:
    """A plant for each of the laws that the library has, by name."""
    water = lc.load_water("paper-lateral")
    total = replace(water, drag=TotalSpeedDrag())
    return {
        "prescribed": lambda: lc.build_plant("mamba", water),
        "current": lambda: lc.build_plant("mamba", replace(water, current=(0.1, 0.2))),
        "fin": lambda: lc.build_plant("mamba-fin", total, joints="prescribed"),
        "pd": lambda: lc.build_plant("mamba", water, joints="pd"),
        "servo": lambda: lc.build_plant("amphibot", water, joints="servo"),
        "elastic fin": lambda: lc.build_plant("mamba-fin", water),
        "total speed": lambda: lc.build_plant("mamba", total),
        "speed servo": lambda: lc.build_plant("mamba", total, joints=lc.SpeedServo()),
        "viscous ground": lambda: lc.build_plant("mamba", lc.load_ground("viscous")),
        "dry ground": lambda: lc.build_plant("mamba", lc.load_ground("coulomb"), joints="pd"),
    }


def run_steps(plant: PlanarPlant, kernels: Any) -> tuple[int, np.ndarray, np.ndarray]:
    """Return what a kernel returns and writes in 10 s: the number of samples, the rows and the log."""
    S = plant.rows(plant.init(lc.Start(velocity=0.1), COMMAND), COMMAND)
    every = plant.steps_in(0.1)
    log = np.zeros((101, plant.layout.sample_size, 1))
    chain = plant.layout.chain
    n = kernels.run(S, *chain, plant.is_implicit, 100 * every, 0.1 / every, every, log)
    return n, S, log


@pytest.mark.parametrize("name", plants())
def test_the_library_gives_the_numbers_that_numba_gives_to_the_last_digit(library: Path, name: str):
    plant = plants()[name]()
    kernels = plant.kernels_of(1)
    assert isinstance(kernels, LibraryKernels)
    n_samples, rows, log = run_steps(plant, kernels)
    compiled_n_samples, compiled_rows, compiled_log = run_steps(plant, kernels.compiled)
    assert n_samples == compiled_n_samples == 101
    assert rows.tobytes() == compiled_rows.tobytes()
    assert log.tobytes() == compiled_log.tobytes()


def test_marches_of_other_lengths_steps_and_logs_are_not_taken_for_the_last_one(library: Path):
    plant = lc.build_plant("mamba", lc.load_water("paper-lateral"))
    assert isinstance(plant, PlanarPlant)
    kernels = plant.kernels_of(1)
    start = plant.init(lc.Start(velocity=0.1), COMMAND)
    size = plant.layout.sample_size
    for steps, dt, every in ((2, 0.05, 1), (4, 0.05, 2), (4, 0.05, 1), (4, 0.02, 1), (2, 0.05, 1)):
        logs: list[np.ndarray] = []
        for run in (kernels.run, kernels.compiled.run):
            log = np.zeros((1 + steps // every, size, 1))
            run(plant.rows(start, COMMAND), *plant.layout.chain, False, steps, dt, every, log)
            logs.append(log)
        assert logs[0].tobytes() == logs[1].tobytes()


def test_one_plant_after_the_other_has_its_own_chain(library: Path):
    kernels = lc.build_plant("mamba", lc.load_water("paper-lateral")).kernels_of(1)
    for robot in ("mamba", "amphibot", "mamba"):
        plant = lc.build_plant(robot, lc.load_water("paper-lateral"))
        for found, expected in zip(
            run_steps(plant, kernels), run_steps(plant, plant.kernels_of(1)), strict=True
        ):
            np.testing.assert_array_equal(found, expected)


def test_numbers_in_another_form_are_refused(library: Path):
    plant = lc.build_plant("mamba", lc.load_water("paper-lateral"))
    S = plant.rows(plant.init(lc.Start(), COMMAND), COMMAND)
    log = np.zeros((3, plant.layout.sample_size, 1))
    for rows, message in (
        (S.astype(complex), "must be arrays of floats"),
        (np.repeat(S, 2)[::2], "not C contiguous"),
    ):
        with pytest.raises(TypeError, match=message):
            plant.kernels_of(1).run(rows, *plant.layout.chain, False, 2, 0.05, 1, log)


def test_what_the_library_lacks_is_compiled(library: Path):
    def law(v_t, v_n, across, rate, element):
        return -element.c_t * v_t, -element.c_n * v_n, -element.lambda_2 * rate

    water = lc.load_water("paper-lateral")
    own = lc.build_plant("mamba", replace(water, drag=FunctionDrag(function=law)))
    moving = lc.build_plant("mamba", replace(water, current=LinearShear(speed=0.1)))
    still = lc.build_plant("mamba", water)
    assert isinstance(still.kernels_of(1), LibraryKernels)
    for kernels in (own.kernels_of(1), moving.kernels_of(1), still.kernels_of(8)):
        assert not isinstance(kernels, LibraryKernels)
    assert not needs_compiling(water)
    assert still.towing_load(0.5, 0.3)[1] != 0.0  # of another kernel than the library has


def test_a_swim_from_the_shell_does_not_even_import_numba(library: Path):
    if library != kernel_library.FOLDER or library.parent != Path(kernel_library.__file__).parent:
        pytest.skip("this installation has no library")
    done = subprocess.run([sys.executable, "-c", NUMBA], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_a_library_of_other_sources_is_not_used(copied: Path):
    assert is_used()
    contents = json.loads((copied / kernel_library.CONTENTS).read_text())
    record = json.loads(contents["record"])
    record["digest"] = "0" * 16
    contents["record"] = json.dumps(record)
    (copied / kernel_library.CONTENTS).write_text(json.dumps(contents))
    assert not is_used()


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"laws": [], "record": "{}"}'])
def test_contents_that_are_none_are_not_used(copied: Path, text: str):
    (copied / kernel_library.CONTENTS).write_text(text)
    assert not is_used()


def test_a_library_of_another_system_is_not_used(copied: Path):
    (copied / kernel_library.LIBRARY).unlink()  # a loaded one must not be written to
    (copied / kernel_library.LIBRARY).write_bytes(b"MZ")
    assert not is_used()


def test_a_processor_that_lacks_something_does_not_use_the_library(
    library: Path, monkeypatch: pytest.MonkeyPatch
):
    class OfOtherProcessor:
        def __init__(self, path: str) -> None:
            self.path = path

        def laticauda_fits_processor(self) -> int:
            return 0

    assert is_used()
    monkeypatch.setattr(kernel_library, "CDLL", OfOtherProcessor)
    assert not is_used()


@pytest.mark.parametrize("variable", kernel_library.SETTINGS_OF_COMPILER)
def test_who_asks_the_compiler_for_something_else_gets_it(
    library: Path, monkeypatch: pytest.MonkeyPatch, variable: str
):
    monkeypatch.setenv(variable, "1")
    assert not is_used()


def test_kernels_are_told_apart_by_their_names_and_the_formulas_and_fields_of_their_laws():
    laws = [PolynomialDrag(), TotalSpeedDrag()]
    servo = lc.SpeedServo().own
    descriptions = {
        describe_kernel(name, law.formula, joints)
        for name in (RUN, RUN_PRESCRIBED)
        for law in laws
        for joints in (None, servo)
    }
    assert len(descriptions) == 8


def test_a_library_that_is_there_is_not_made_again(folder: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(platforms, "current_platform", lambda: pytest.fail("it was made again"))
    assert made.make_library(folder) == ""


def test_other_systems_have_no_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(platforms, "current_platform", lambda: platforms.PLATFORMS["darwin-arm64"])
    assert made.make_library(tmp_path) == "none can be made for this system."
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(
    platforms.current_platform() != platforms.PLATFORMS[made.PLATFORM], reason="of this system"
)
def test_without_a_c_compiler_there_is_no_library_and_it_says_so(tmp_path: Path):
    reason = make(tmp_path, CC="no-such-compiler")
    assert reason == (
        "A library of machine code needs the C compiler `no-such-compiler` "
        "(the environment says CC=no-such-compiler); on Debian and Ubuntu run "
        "`apt-get install gcc libc6-dev`."
    )
    assert not list(tmp_path.iterdir())
