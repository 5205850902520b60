import importlib.metadata
import inspect
import pkgutil

import pytest

import laticauda as lc

NAMES = "cockpit control cosim figures fluid identify logs operate robot simulate studies trial"
LAZY = ["laticauda", *(f"laticauda.{name}" for name in NAMES.split())]


@pytest.mark.parametrize("package", LAZY)
def test_a_package_shows_its_public_names_and_nothing_else(package):
    module = importlib.import_module(package)
    for found in pkgutil.iter_modules(
        module.__path__, f"{package}."
    ):  # none takes the place of a function
        if package != "laticauda":
            importlib.import_module(found.name)
    assert dir(module) == sorted(module.__all__)
    assert all(not inspect.ismodule(getattr(module, name)) for name in module.__all__)
    assert not hasattr(module, "nothing")
    with pytest.raises(AttributeError, match=f"module '{package}' has no attribute 'nothing'"):
        module.nothing  # noqa: B018


def test_the_version_is_the_installed_one():
    assert lc.__version__ == importlib.metadata.version("laticauda")
