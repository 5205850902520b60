"""Packages that may be missing: those of laticauda's extras, imported when they are first needed.

If one is missing, the error states what to install. Processes started by such an import ignore
Ctrl-C.
"""

from importlib import import_module
from typing import Any

from laticauda.values.errors import MissingExtra
from laticauda.values.interrupts import defer_interrupts


def optional_import(feature: str, package: str, extra: str, module: str | None = None) -> Any:
    """Import a module that may not be installed.

    Args:
        feature: Feature that needs it, in words.
        package: Name of the package, as the user knows it.
        extra: Extra of laticauda that installs the package.
        module: Name under which it is imported; None: the package's name.

    Returns:
        The module. If the package has no types, everything from it is `Any`.

    Raises:
        MissingExtra: If the package is not installed.
    """
    try:
        return import_module(module or package)
    except ImportError as error:
        raise MissingExtra(feature, package, extra) from error


def load_mujoco() -> Any:
    """Import the module `mujoco`. It has no types, so everything from it is `Any` here.

    Raises:
        MissingExtra: If the package is not installed.
    """
    # One of its imports runs Python in other processes, which would answer Ctrl-C with a
    # traceback.
    with defer_interrupts():
        return optional_import("The 3D model", "MuJoCo", "spatial", "mujoco")
