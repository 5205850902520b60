"""Kernels of single runs from a shared library, without Numba, whose import takes longer than a run.

The library is made when laticauda is installed (`laticauda.connect.native.kernel_library`), from the
machine code that Numba makes of the templates, for the usual laws. It is used as long as the sources
are those that it was made of, and the processor has what its code uses. Otherwise Numba compiles the
templates, and the numbers are the same.
"""

import functools
import json
import os
from collections.abc import Callable
from ctypes import CDLL, Structure, addressof, c_double, c_int64, c_void_p
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from laticauda.values import Formula
from laticauda.values.sources import SourceRecord

FOLDER = Path(__file__).parent / "ready"
"""Folder of the library; it does not exist where none could be made."""
LIBRARY = "kernels.so"
"""Name of the library."""
CONTENTS = "kernels.json"
"""Name of the file that says what is in the library, and what it was made of."""
SETTINGS_OF_COMPILER = ("NUMBA_DISABLE_JIT", "NUMBA_CPU_NAME")
"""Variables of the environment by which somebody asks for other machine code, or for none."""
MEMORY = c_double * 0
"""Numbers of an array, of whose size the library is told; arrays that are not contiguous are refused."""
ARGUMENTS = [c_void_p, c_void_p, c_void_p]
"""Types of the arguments of the library's functions: the rows, what march it is (`_MarchNumbers`), and the log."""


@dataclass(frozen=True, kw_only=True)
class Contents:
    """What is in the library, and what it was made of."""

    kernels: list[str]
    """What the functions were made of, in the order of their numbers (`describe_kernel`)."""
    record: SourceRecord
    """Sources of the library."""
    maker: str
    """Digest of the sources of the maker (`laticauda.connect.native.kernel_library`)."""

    def write(self) -> str:
        """Return the contents as text in JSON."""
        stored = {"kernels": self.kernels, "record": self.record.write(), "maker": self.maker}
        return json.dumps(stored)


def read_contents(folder: Path) -> Contents | None:
    """Return the contents of the library in a folder; None if there is none that the sources of today agree with.

    Args:
        folder: Folder of the library.
    """
    try:
        stored = json.loads((folder / CONTENTS).read_text(encoding="utf-8"))
        record = SourceRecord.read(stored["record"])
        kernels, maker = stored["kernels"], stored["maker"]
    except (OSError, ValueError, KeyError, TypeError):
        return None
    if record is None or not record.is_current():
        return None
    return Contents(kernels=kernels, record=record, maker=maker)


def describe_kernel(run_name: str, drag: Formula, joints: Formula | None) -> str:
    """Return what tells a kernel for two laws from others.

    Args:
        run_name: Name of the kernel in `stepping`.
        drag: Formula of the drag law.
        joints: Formula of the joint law; None: one that all kernels include.
    """
    return f"{run_name}: {_describe(drag)}, {_describe(joints)}"


def _describe(formula: Formula | None) -> str:
    if formula is None:
        return "included"
    function = formula.function
    return " ".join([f"{function.__module__}.{function.__qualname__}", *formula.fields])


def find_run(run_name: str, drag: Formula, joints: Formula | None) -> Callable[..., int] | None:
    """Return the library's function for two laws in still water or a uniform current; None if it has none.

    Args:
        run_name: Name of the kernel in `stepping`.
        drag: Formula of the drag law.
        joints: Formula of the joint law; None: one that all kernels include.
    """
    return _load(FOLDER).get(describe_kernel(run_name, drag, joints))


@functools.cache
def _load(folder: Path) -> dict[str, Callable[..., int]]:
    """Return the functions of the library by what they were made of; none if it cannot be used here."""
    if any(variable in os.environ for variable in SETTINGS_OF_COMPILER):
        return {}
    contents = read_contents(folder)
    if contents is None:
        return {}
    try:
        library = CDLL(str(folder / LIBRARY))
    except OSError:  # of another system
        return {}
    if not library.laticauda_fits_processor():
        return {}
    functions: dict[str, Callable[..., int]] = {}
    for k, kernel in enumerate(contents.kernels):
        function = library[f"laticauda_run_{k}"]
        function.argtypes = ARGUMENTS
        function.restype = c_int64
        functions[kernel] = function
    return functions


class LibraryKernels:
    """Kernels of a single run, with the names of those in `laticauda.models.planar.stepping`."""

    def __init__(self, run: Callable[..., int], compile_kernels: Callable[[], Any]) -> None:
        """Use a function of the library.

        Args:
            run: The function, from `find_run`.
            compile_kernels: Returns the same kernels as compiled by Numba, for what the library does not have.
        """
        self._run = run
        self._compile_kernels = compile_kernels
        self._last_call: _Call | None = None

    @property
    def compiled(self) -> Any:
        """The same kernels as compiled by Numba."""
        return self._compile_kernels()

    @property
    def evaluate(self) -> Any:
        """`stepping.evaluate`."""
        return self.compiled.evaluate

    @property
    def link_forces(self) -> Any:
        """`stepping.link_forces`."""
        return self.compiled.link_forces

    def run(
        self,
        flat: np.ndarray,
        n: int,
        first_strip: np.ndarray,
        first_plate: np.ndarray,
        law: np.ndarray,
        tail_link: int,
        has_extras: bool,
        implicit: bool,
        steps: int,
        dt: float,
        every: int,
        log: np.ndarray,
    ) -> int:
        """Advance the run in `flat`, see `stepping.run`."""
        if flat.dtype.char != "d" or log.dtype.char != "d":
            raise TypeError("Rows and log must be arrays of floats.")
        march = _March(flat.size, log.shape, implicit, steps, dt, every)
        call = self._last_call
        # Of each robot there is one chain, whose arrays always come together.
        if (
            call is None
            or call.march != march
            or call.first_strip is not first_strip
            or call.law is not law
        ):
            call = _Call(march, n, first_strip, first_plate, law, tail_link, has_extras)
            self._last_call = call
        written = self._run(
            MEMORY.from_buffer(flat),  # pyright: ignore[reportArgumentType]  # a buffer by NumPy's C code
            call.address,
            MEMORY.from_buffer(log),  # pyright: ignore[reportArgumentType]
        )
        if written < 0:  # pragma: no cover - the kernels raise nothing
            raise RuntimeError("A kernel of the library failed.")
        return written


class _MarchNumbers(Structure):
    """What march it is, as the library takes it (`struct march` in `kernels.c`)."""

    _fields_ = (
        *((name, c_int64) for name in ("n", "tail_link", "has_extras")),
        *((name, c_void_p) for name in ("first_strip", "first_plate", "law")),
        *((name, c_int64) for name in ("n_first_strip", "n_first_plate", "n_law")),
        *((name, c_int64) for name in ("implicit", "steps", "every")),
        ("dt", c_double),
        *((name, c_int64) for name in ("n_rows", "n_samples", "size")),
    )


class _March(NamedTuple):
    """What a call does with the rows, by the arguments of `stepping.run`."""

    n_rows: int
    log_shape: tuple[int, ...]
    implicit: bool
    steps: int
    dt: float
    every: int


class _Call:
    """All arguments but rows and log, which a run with a controller repeats many times a second."""

    def __init__(
        self,
        march: _March,
        n: int,
        first_strip: np.ndarray,
        first_plate: np.ndarray,
        law: np.ndarray,
        tail_link: int,
        has_extras: bool,
    ) -> None:
        self.march = march
        self.first_strip = first_strip
        self.law = law
        n_samples, size, _ = march.log_shape
        arrays = [
            np.ascontiguousarray(array, np.int64) for array in (first_strip, first_plate, law)
        ]
        addresses = [_address(array) for array in arrays]
        sizes = [array.size for array in arrays]
        numbers = _MarchNumbers(
            *(n, tail_link, has_extras),
            *addresses,
            *sizes,
            *(march.implicit, march.steps, march.every, march.dt),
            *(march.n_rows, n_samples, size),
        )
        self._kept_alive = arrays, numbers  # the library has their addresses
        self.address = addressof(numbers)
        """Address of the `_MarchNumbers`."""


def _address(array: np.ndarray) -> int:
    return array.__array_interface__["data"][0]
