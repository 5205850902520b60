"""Machine code that other clones have compiled: `fetch` it before tests, `keep` it after them.

Kernels are named by digests of all that they are made of, and Numba 0.68 compares the content of
the source file (older ones its date, and compile), so what does not fit is not used. An index and
its data belong together: both are taken, or neither. The files are hard links where they can be,
which is safe because Numba replaces them and never writes into them.
"""

import os
import platform
import shutil
import sys
import time
from importlib.metadata import version
from pathlib import Path

from laticauda.files import locked

SOURCES = Path(__file__).parent.parent / "src" / "laticauda"
CACHE = Path(os.environ.get("LATICAUDA_KERNELS") or Path.home() / ".cache" / "laticauda-kernels")
STORE = CACHE / f"{sys.implementation.cache_tag}-{version('numba')}-{platform.machine()}"
OLD = 30 * 86400.0  # [s]


def fetch(folder: Path = SOURCES, store: Path = STORE) -> int:
    """Number of kernels that are new here."""
    return _take(store, folder)


def keep(folder: Path = SOURCES, store: Path = STORE) -> int:
    """Number of kernels that are new in the store; what was compiled a month ago is dropped."""
    for index in [*store.rglob("*.nbi")]:
        if time.time() - index.stat().st_mtime > OLD:
            for one in [index, *_data_of(index)]:
                one.unlink(missing_ok=True)
    return _take(folder, store)


def _take(source: Path, to: Path) -> int:
    STORE.mkdir(parents=True, exist_ok=True)
    with locked(STORE / "lock", wait=True):
        new = [
            one
            for one in source.rglob("__pycache__/*.nbi")
            if not (to / one.relative_to(source)).exists()
        ]
        for index in new:
            for one in [*_data_of(index), index]:
                _link(one, to / one.relative_to(source))
    return len(new)


def _data_of(index: Path) -> list[Path]:
    return [*index.parent.glob(f"{index.stem}.*.nbc")]


def _link(source: Path, to: Path) -> None:
    to.parent.mkdir(parents=True, exist_ok=True)
    to.unlink(missing_ok=True)
    try:
        os.link(source, to)
    except OSError:
        shutil.copy2(source, to)
