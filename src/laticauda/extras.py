"""Packages that come with one of laticauda's extras: imported when they are first needed, and not before."""

from importlib import import_module
from typing import Any

from laticauda.errors import MissingExtra


def optional_import(feature: str, package: str, extra: str, module: str | None = None) -> Any:
    """A module that may not be installed.

    Args:
        feature: What needs it, in words.
        package: The package as the user knows it.
        extra: The extra of laticauda that installs the package.
        module: As it is imported; None: the package's name.

    Returns:
        The module. Where the package has no types, what comes from it is `Any`.

    Raises:
        MissingExtra: If it is not installed.
    """
    try:
        return import_module(module or package)
    except ImportError as error:
        raise MissingExtra(feature, package, extra) from error


def load_mujoco() -> Any:
    """The module `mujoco`. It has no types, so what comes from it is `Any` here.

    Raises:
        MissingExtra: If it is not installed.
    """
    return optional_import("The 3D model", "MuJoCo", "spatial", "mujoco")
