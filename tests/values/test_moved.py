"""Import paths of 0.2 lead to where things are now, and warn once."""

import importlib
import pkgutil
import subprocess
import sys
import warnings

import pytest

import laticauda
from laticauda.values import moved


@pytest.fixture(autouse=True)
def _modules_as_before():
    """Imports of one test are not there in the next."""
    before = set(sys.modules)
    former = tuple(f"laticauda.{old}" for old in moved.PLACES)
    yield
    for name in set(sys.modules) - before:
        if any(f"{name}.".startswith(f"{old}.") for old in former):
            del sys.modules[name]
            package, _, last = name.rpartition(".")
            if package == "laticauda" or name in former:
                vars(sys.modules[package]).pop(last, None)


@pytest.mark.parametrize("old", moved.PLACES)
def test_a_path_of_before_gives_the_module_of_today_and_warns_once(old):
    place = f"laticauda.{moved.PLACES[old]}"
    with pytest.warns(DeprecationWarning, match=rf"^laticauda\.{old} is now {place}$"):
        module = importlib.import_module(f"laticauda.{old}")
    assert module is importlib.import_module(place)
    assert module.__name__ == place
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert importlib.import_module(f"laticauda.{old}") is module


def test_what_is_inside_a_package_that_moved_is_the_same_too():
    with pytest.warns(DeprecationWarning):
        from laticauda.mujoco_water import Water, water  # pyright: ignore
        from laticauda.trial.trial import Trial  # pyright: ignore
    assert Trial is laticauda.Trial
    today = importlib.import_module("laticauda.water.mujoco.water")
    assert Water is today.Water
    assert water is today


@pytest.mark.parametrize("old", moved.NOT_ERRORS)
def test_what_is_no_error_is_found_by_its_name_of_before(old):
    module, _, name = moved.NOT_ERRORS[old].partition(":")
    with pytest.warns(DeprecationWarning):
        from laticauda import errors  # pyright: ignore
    with pytest.warns(
        DeprecationWarning, match=rf"errors\.{old} is now laticauda\.values\.{module}\."
    ):
        found = getattr(errors, old)
    assert found is getattr(importlib.import_module(f"laticauda.values.{module}"), name)


def test_packages_of_before_are_attributes_too():
    with pytest.warns(
        DeprecationWarning, match=r"^laticauda\.logs is now laticauda\.trials\.logs$"
    ):
        module = laticauda.logs  # pyright: ignore
    assert module is importlib.import_module("laticauda.trials.logs")


def test_the_warning_points_to_the_import():
    code = (
        "import warnings\nwarnings.simplefilter('always')\n\nfrom laticauda.fluid import DragLaw\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr.count("DeprecationWarning") == 1
    assert (
        "<string>:4: DeprecationWarning: laticauda.fluid is now laticauda.water.fluid"
        in done.stderr
    )


def test_nothing_of_today_has_a_name_of_before():
    names = {found.name for found in pkgutil.iter_modules(laticauda.__path__)}
    assert not names & moved.PLACES.keys()
