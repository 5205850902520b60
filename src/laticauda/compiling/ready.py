"""Machine code that comes with the installation, so that the first run need not compile: made when a wheel is built.

It is code for a whole family of processors, filed under the name of its function, which ends in the digest of all that
it is made of, and under the versions of Python and Numba; where any of them differs, Numba compiles as ever.
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
"""Where it is; there is none beside sources that nobody built a wheel of."""
FEATURES = ("avx", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe", "popcnt", "sse4.2")
"""What the processors have that it is made for: the family x86-64-v3, most since 2013."""


class ReadyCache(FunctionCache):
    """Numba's cache of one function, which also knows what came with the installation."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """See Numba: the code for a signature, None if there is none."""
        path, found = path_of(self._py_func), cast(Any, super()).load_overload(sig, target_context)
        if found is None and path.is_file() and is_of_family():
            signature, code = pickle.loads(path.read_bytes())
            if signature == str(sig):
                target_context.refresh()
                found = cast(Any, self)._impl.rebuild(target_context, code)
        return found


def path_of(function: Any, folder: Path | None = None) -> Path:
    """Where the code of a function is, if it is there.

    Args:
        function: Whose name ends in its digest.
        folder: Of the codes of all; None: of those that came with the installation.
    """
    versions = f"{sys.implementation.cache_tag}-{numba.__version__}-{sys.platform}"
    return (folder or FOLDER) / f"{function.__qualname__}-{versions}.code"


@cache
def is_of_family() -> bool:
    """Whether this machine's processor is one of the family, and nobody asked for code for another one."""
    if platform.machine() not in ("x86_64", "AMD64") or "NUMBA_CPU_NAME" in os.environ:
        return False
    there: Any = binding.get_host_cpu_features()
    return all(there.get(feature, False) for feature in FEATURES)


def is_ready(function: Any) -> bool:
    """Whether code of a function came with the installation, for this processor.

    Args:
        function: Whose name ends in its digest.
    """
    return path_of(function).is_file() and is_of_family()


def keep(compiled: Any, folder: Path) -> None:
    """Write the code of a function that this process has compiled; `NUMBA_CPU_NAME` says for which processors.

    Args:
        compiled: As Numba's decorator returned it, with one signature, compiled and not loaded.
        folder: Where to.
    """
    ((signature, result),) = compiled.overloads.items()
    code = compiled._cache._impl.reduce(result)
    path_of(compiled.py_func, folder).write_bytes(pickle.dumps((str(signature), code), protocol=-1))
