"""Packages that are needed by a part alone: of these environments, or of what stands on them."""

from importlib import import_module
from typing import Any

from laticauda.errors import LaticaudaError


class NotInstalled(LaticaudaError, ImportError):
    """A package that is needed and not there; the message says how to get it."""


def needed(feature: str, package: str, module: str | None = None) -> Any:
    """A module that may not be installed.

    Args:
        feature: What needs it, in words.
        package: As an installer knows it.
        module: As it is imported; None: the package's name.

    Raises:
        NotInstalled: If it is not.
    """
    try:
        return import_module(module or package)
    except ImportError as error:
        raise NotInstalled(f"{feature} needs {package}; run `pip install {package}`.") from error
