"""Machine code that other clones have compiled: `fetch` it before tests, `keep` it after them.

It lies in a folder outside the clone, LATICAUDA_KERNELS or ~/.cache/laticauda-kernels, so that a
second clone compiles nothing. Kernels have a digest of all that they are made of in their names,
and Numba 0.68 compares the content of the source file too (older ones its date, and compile), so
code that does not fit is never run. An index of Numba's and the data that it names are copied
together, or neither is. Copies are hard links where possible: Numba replaces these files and never
writes into them.
"""

import os
import shutil
import sys
import time
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path

from llvmlite import binding

from laticauda.values.files import locked

SOURCES = Path(__file__).parent.parent / "src" / "laticauda"
ROOT = Path(os.environ.get("LATICAUDA_KERNELS") or Path.home() / ".cache" / "laticauda-kernels")
STORE = ROOT / f"{sys.implementation.cache_tag}-{version('numba')}-{binding.get_host_cpu_name()}"
"""Folder for this Python, Numba and processor."""
MAX_AGE = 30 * 86400.0
"""Age at which machine code is dropped, so that the folder does not grow forever [s]."""


def fetch(sources: Path = SOURCES, store: Path = STORE) -> int:
    """Take over what other clones have compiled; return the number of files that were new here.

    Args:
        sources: Folder of the package in this clone.
        store: Folder outside the clone.
    """
    with _only_one(store):
        return _copy_newer(store, sources)


def keep(sources: Path = SOURCES, store: Path = STORE) -> int:
    """Keep what was compiled for other clones; return the number of files that were new there.

    Args:
        sources: Folder of the package in this clone.
        store: Folder outside the clone.
    """
    with _only_one(store):
        _drop_old(store)
        return _copy_newer(sources, store)


def copy_source(source: str, target: str) -> None:
    """Copy a file of the package, but link machine code, of which there may be a gigabyte.

    Args:
        source: The file.
        target: The new file.
    """
    if source.endswith((".nbi", ".nbc")):
        _link(Path(source), Path(target))
    else:
        shutil.copy2(source, target)


def _only_one(store: Path):
    store.mkdir(parents=True, exist_ok=True)
    return locked(store / "lock", wait=True)


def _copy_newer(source: Path, destination: Path) -> int:
    n_copied = 0
    for index in _indices(source):
        target = destination / index.relative_to(source)
        if target.exists() and target.stat().st_mtime >= index.stat().st_mtime:
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        for data in _data_of(index):
            _link(data, target.with_name(data.name))
        _link(index, target)
        n_copied += 1
    return n_copied


def _drop_old(store: Path) -> None:
    oldest = time.time() - MAX_AGE
    for index in list(_indices(store)):
        if index.stat().st_mtime < oldest:
            for file in [index, *_data_of(index)]:
                file.unlink(missing_ok=True)


def _indices(folder: Path) -> Iterator[Path]:
    """Yield Numba's indices, and the files of `laticauda export`, which need none."""
    for pattern in ("*.nbi", "native-*.bc", "native-*.o"):
        yield from folder.rglob(f"__pycache__/{pattern}")


def _data_of(index: Path) -> list[Path]:
    if index.suffix != ".nbi":
        return []
    return list(index.parent.glob(f"{index.stem}.*.nbc"))


def _link(source: Path, target: Path) -> None:
    target.unlink(missing_ok=True)
    try:
        os.link(source, target)
    except OSError:  # another file system
        shutil.copy2(source, target)
