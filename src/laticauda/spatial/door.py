"""The door of MuJoCo: where it is loaded, and the sentence for those who do not have it."""

from functools import cache
from importlib import import_module
from typing import Any

from laticauda.errors import MissingExtra


@cache
def engine() -> Any:
    """The module `mujoco`. It has no types, so what comes from it is `Any` here.

    Raises:
        MissingExtra: If it is not installed.
    """
    try:
        return import_module("mujoco")
    except ImportError as error:
        raise MissingExtra("The 3D model", "MuJoCo", "spatial") from error
