"""Machine code that clones share, on folders that stand for them."""

import os
import time
from pathlib import Path

import kernels
import pytest

FOLDER = Path("planar", "__pycache__")


@pytest.fixture
def store(tmp_path: Path) -> Path:
    return tmp_path / "store"


@pytest.fixture
def clones(tmp_path: Path) -> tuple[Path, Path]:
    return tmp_path / "first", tmp_path / "second"


def compile_kernel(clone: Path, code: bytes, age: float = 0.0) -> None:
    """Leave what Numba leaves: an index, and the data that it names."""
    folder = clone / FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in (("run-1.py311.1.nbc", code), ("run-1.py311.nbi", b"1")):
        file = folder / name
        file.unlink(missing_ok=True)  # Numba replaces files, and does not write into them
        file.write_bytes(content)
        os.utime(file, (time.time() - age,) * 2)


def test_a_second_clone_takes_over_what_the_first_has_compiled(store: Path, clones):
    first, second = clones
    compile_kernel(first, b"code")
    (first / FOLDER / "native-1-wasm32.o").write_bytes(b"object")
    assert kernels.keep(first, store) == 2
    assert kernels.fetch(second, store) == 2
    assert (second / FOLDER / "run-1.py311.1.nbc").read_bytes() == b"code"
    assert (second / FOLDER / "native-1-wasm32.o").read_bytes() == b"object"
    assert kernels.fetch(second, store) == kernels.keep(second, store) == 0


def test_an_index_and_its_data_replace_older_ones_together(store: Path, clones):
    first, second = clones
    compile_kernel(first, b"old", age=60.0)
    compile_kernel(second, b"new")
    kernels.keep(first, store)
    kernels.keep(second, store)
    assert kernels.fetch(first, store) == 1
    assert (first / FOLDER / "run-1.py311.1.nbc").read_bytes() == b"new"


def test_what_was_compiled_long_ago_is_dropped(store: Path, clones):
    first, second = clones
    compile_kernel(first, b"code")
    kernels.keep(first, store)
    for file in store.rglob("run-*"):
        os.utime(file, (0.0, 0.0))
    kernels.keep(second, store)
    assert not list(store.rglob("run-*"))
