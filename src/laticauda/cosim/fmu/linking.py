"""From machine code and tables of numbers to a shared library, by the system's C compiler."""

import hashlib
import importlib.util
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from laticauda.cosim.fmu.tables import Tables
from laticauda.errors import LaticaudaError, MissingProgram

FOLDER = Path(__file__).parent / "c"
COMPILERS = ("cc", "gcc", "clang")
FLAGS = (
    "-std=c11 -O2 -fPIC -shared -fvisibility=hidden -Wall -Wextra -Werror=implicit-function-declaration "
    "-Wl,-Bsymbolic -Wl,-z,noexecstack -Wl,-z,defs -s"
)
LETTERS = {"independent": "t", "parameter": "p", "input": "i", "output": "o"}


class LinkingFailed(LaticaudaError, RuntimeError):
    """The C compiler is there, and does not do its work: it says which, and what it said."""


def c_compiler() -> list[str]:
    """The command of a C compiler: that of the variable CC, the system's, or that of the package ziglang.

    Raises:
        MissingProgram: If there is none.
    """
    wanted = shlex.split(os.environ.get("CC", ""))
    for command in [wanted] if wanted else [[name] for name in COMPILERS]:
        if shutil.which(command[0]) is not None:
            return command
    if not wanted and importlib.util.find_spec("ziglang") is not None:
        return [sys.executable, "-m", "ziglang", "cc"]
    thing = f"the C compiler `{wanted[0]}` (the environment says CC={' '.join(wanted)})" if wanted else "a C compiler"
    raise MissingProgram("An FMU", thing, "gcc libc6-dev")


def library(code: bytes, tables: Tables, guid: str, version: str) -> bytes:
    """The shared library of an FMU.

    Args:
        code: The object file with what computes.
        tables: Robot and variables.
        guid: What tells this FMU from others.
        version: Of FMI.

    Raises:
        MissingProgram: If there is no C compiler.
        LinkingFailed: If it fails.
    """
    compiler = c_compiler()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "tables.h").write_text(tables_in_c(tables, guid), encoding="utf-8")
        (folder / "kernels.o").write_bytes(code)
        command = [*compiler, *shlex.split(FLAGS), "-I", str(folder), "-I", str(FOLDER)]
        command += ["-o", str(folder / "fmu.so"), str(FOLDER / f"fmi{version[0]}.c"), str(folder / "kernels.o"), "-lm"]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            said = "\n".join((done.stderr or done.stdout).splitlines()[:8])
            raise LinkingFailed(f"`{' '.join(compiler)}` cannot build the FMU's library. It says:\n{said}")
        return (folder / "fmu.so").read_bytes()


def tables_in_c(tables: Tables, guid: str) -> str:
    """The header with a robot's numbers, exact to the last bit.

    Args:
        tables: Robot and variables.
        guid: What tells this FMU from others.
    """
    from laticauda.cosim.fmu.entry import SCRATCH

    variables = tables.variables
    texts = ", ".join(f'"{variable.name}"' for variable in variables)
    letters = ", ".join(f"'{LETTERS[variable.causality]}'" for variable in variables)
    return "\n".join(
        (
            "/* Written by laticauda: the numbers of one robot. */",
            "#include <math.h>",
            "#include <stdint.h>",
            f'#define MODEL "{guid}"',
            f"#define DIGEST UINT64_C(0x{digest(guid.encode())[:16]})",
            f"#define N_VARIABLES {len(variables)}",
            f"#define N_NUMBERS {tables.n_rows + SCRATCH}",
            f"#define DT {tables.where('dt')}",
            f"static const int64_t whole[] = {{{', '.join(map(str, tables.whole.tolist()))}}};",
            f"static const double real[] = {{{_reals(tables.real)}}};",
            f"static const double first_values[N_VARIABLES] = {{{_reals(v.start for v in variables)}}};",
            f"static const double least[N_VARIABLES] = {{{_reals(v.least for v in variables)}}};",
            f"static const double most[N_VARIABLES] = {{{_reals(v.most for v in variables)}}};",
            f"static const char causality[N_VARIABLES] = {{{letters}}};",
            f"static const char *const names[N_VARIABLES] = {{{texts}}};",
            "",
        )
    )


def digest(content: bytes) -> str:
    """Hexadecimal digits that tell one content from another."""
    return hashlib.sha256(content).hexdigest()


def _reals(numbers: Iterable[float] | Sequence[float] | np.ndarray) -> str:
    return ", ".join(_real(float(number)) for number in numbers)


def _real(number: float) -> str:
    if number in (float("inf"), float("-inf")):
        return "INFINITY" if number > 0.0 else "-INFINITY"
    return number.hex()
