"""Machine code that comes with the installation, so that the first run need not compile; made when a wheel is built.

The code is for a whole family of processors and is stored under the name of its function, which
ends in the digest of everything that it is made of, and the versions of Python and Numba; if any of
these differs, Numba compiles as usual.
"""

import os
import pickle
import platform
import sys
from functools import cache
from pathlib import Path
from typing import Any, cast

import numba
from llvmlite import binding
from numba.core.caching import FunctionCache

FOLDER = Path(__file__).parent / "ready"
"""Folder of the code; it does not exist next to sources that no wheel was built from."""
FEATURES = ("avx", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe", "popcnt", "sse4.2")
"""Features of the processors that the code is made for: the family x86-64-v3, most processors since 2013."""


class ReadyCache(FunctionCache):
    """Numba's cache of one function, extended by the code that came with the installation."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the code for a signature, None if there is none; see Numba."""
        cached = cast(Any, super()).load_overload(sig, target_context)
        path = path_of(self._py_func)
        if cached is not None or not path.is_file() or not is_of_family():
            return cached
        signature, code = pickle.loads(path.read_bytes())
        if signature != str(sig):
            return None
        target_context.refresh()
        return cast(Any, self)._impl.rebuild(target_context, code)


def path_of(function: Any, folder: Path | None = None) -> Path:
    """Return the path of a function's code, which need not exist.

    Args:
        function: Function whose name ends in its digest.
        folder: Folder of the code of all functions; None: that of the installation.
    """
    versions = f"{sys.implementation.cache_tag}-{numba.__version__}-{sys.platform}"
    return (folder or FOLDER) / f"{function.__qualname__}-{versions}.code"


@cache
def is_of_family() -> bool:
    """Return whether this machine's processor is of the family, and no code for another processor was requested."""
    if platform.machine() not in ("x86_64", "AMD64") or "NUMBA_CPU_NAME" in os.environ:
        return False
    features: Any = binding.get_host_cpu_features()
    return all(features.get(feature, False) for feature in FEATURES)


def is_ready(function: Any) -> bool:
    """Return whether code of a function for this processor came with the installation.

    Args:
        function: Function whose name ends in its digest.
    """
    return path_of(function).is_file() and is_of_family()


def keep(compiled: Any, folder: Path) -> None:
    """Write the code of a function that this process has compiled; `NUMBA_CPU_NAME` determines the processors.

    Args:
        compiled: Function as returned by Numba's decorator, with one signature, compiled and not
            loaded.
        folder: Destination folder.
    """
    ((signature, result),) = compiled.overloads.items()
    code = compiled._cache._impl.reduce(result)
    path_of(compiled.py_func, folder).write_bytes(pickle.dumps((str(signature), code), protocol=-1))
