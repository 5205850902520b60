"""Packages that may be missing: those of laticauda's extras, imported when they are first needed.

If one is missing, the error states what to install. Processes started by such an import ignore
Ctrl-C.
"""

import os
from collections.abc import Generator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from laticauda.values.errors import MissingExtra
from laticauda.values.interrupts import defer_interrupts

ENCODING = "PYTHONIOENCODING"
"""Variable with the encoding of the standard streams of Python."""


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
    # traceback, and so an encoding in which they do not talk to each other.
    with defer_interrupts(), _usual_encoding():
        return optional_import("The 3D model", "MuJoCo", "spatial", "mujoco")


@contextmanager
def _usual_encoding() -> Generator[None]:
    """Let processes that are started meanwhile use the usual encoding of their streams."""
    encoding = os.environ.pop(ENCODING, None)
    try:
        yield
    finally:
        if encoding is not None:
            os.environ[ENCODING] = encoding
