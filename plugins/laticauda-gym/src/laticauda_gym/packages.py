"""Packages that only a part needs: a part of these environments, or of what is built on them."""

from importlib import import_module
from typing import Any

from laticauda.values import LaticaudaError


class NotInstalled(LaticaudaError, ImportError):
    """A required package that is not installed; the message says how to install it."""


def needed(feature: str, package: str, module: str | None = None) -> Any:
    """Return a module that may not be installed.

    Args:
        feature: What needs the module, in words.
        package: Name of the package for an installer.
        module: Name of the module for an import; None: the package's name.

    Raises:
        NotInstalled: If it is not installed.
    """
    try:
        return import_module(module or package)
    except ImportError as error:
        raise NotInstalled(f"{feature} needs {package}; run `pip install {package}`.") from error
