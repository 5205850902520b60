"""What a thread of a kernel takes of a GPU, found without one: registers, and bytes of the stack.

A GPU runs the more threads at once, the fewer registers each takes; numbers on the stack lie in its
slow memory. The kernel is compiled to PTX, the assembly language of all GPUs, and NVIDIA's assembler
says what it takes on one of them.

    python -m laticauda_cuda.registers
"""

# pyright: basic, reportMissingImports=false, reportPrivateImportUsage=false

import importlib.util
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple, cast
from unittest import mock

from numba import cuda

import laticauda as lc
from laticauda.connect.native.usual_kernels import signature_of
from laticauda.models.planar import PlanarPlant
from laticauda.values import LaticaudaError
from laticauda_cuda import kernel_of

CAPABILITY = (9, 0)
"""Compute capability of the GPU that the kernel is assembled for: an H100."""
SIGNATURE = signature_of(2)
"""Types of the arguments that `laticauda_cuda` passes to a kernel."""


class NoAssembler(LaticaudaError, RuntimeError):
    """Raised if the assembler of GPU code is not installed."""


class Use(NamedTuple):
    """What one thread of a kernel takes."""

    registers: int
    """Registers of 32 bits; 255 at most, of 65 536 that all threads share."""
    stack: int
    """Size of its stack [B]."""


def find_assembler() -> Path:
    """Return the path of ptxas: that of Python's packages, which fits numba-cuda, or of the system.

    Raises:
        NoAssembler: If it is not installed.
    """
    folders: list[str] = []
    spec = importlib.util.find_spec("nvidia")
    if spec is not None:
        folders += spec.submodule_search_locations or []
    for folder in folders:
        for path in Path(folder).glob("*/bin/ptxas"):
            return path
    path_of_system = shutil.which("ptxas")
    if path_of_system is None:
        raise NoAssembler("There is no `ptxas`: pip install './plugins/laticauda-cuda[ptx]'.")
    return Path(path_of_system)


def measure(plant: PlanarPlant) -> Use:
    """Return what a thread takes that runs a plant.

    Args:
        plant: Robot and environment, whose water is still.

    Raises:
        NoAssembler: If ptxas is not installed.
    """
    assembler = find_assembler()
    # The line below asks the GPU of this machine what it can do, even if it is told.
    device = mock.Mock(compute_capability=CAPABILITY)
    with mock.patch("numba.cuda.dispatcher.get_current_device", lambda: device):
        ptx, _ = cuda.compile_ptx(kernel_of(plant, is_still=True).py_func, SIGNATURE, cc=CAPABILITY)
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "kernel.ptx"
        source.write_text(ptx)
        architecture = "sm_{}{}".format(*CAPABILITY)
        output = str(Path(folder) / "kernel.cubin")
        process = subprocess.run(
            [assembler, "-v", f"-arch={architecture}", source, "-o", output],
            capture_output=True,
            text=True,
            check=True,
        )
    return Use(
        registers=_read_number(r"Used (\d+) registers", process.stderr),
        stack=_read_number(r"(\d+) bytes stack frame", process.stderr),
    )


def _read_number(pattern: str, text: str) -> int:
    """Return the largest number that a pattern finds: a kernel may call functions of its own."""
    return max(int(number) for number in re.findall(pattern, text))


def main() -> None:
    """Print what a thread takes, for the kinds of joints that the arguments name, or for three."""
    water = lc.load_water("paper-lateral")
    sys.stdout.write("joints        registers   stack [B]\n")
    for joints in sys.argv[1:] or ("prescribed", "pd", "servo"):
        plant = cast(PlanarPlant, lc.build_plant("mamba", water, joints=joints))
        use = measure(plant)
        sys.stdout.write(f"{joints:<12}{use.registers:>11}{use.stack:>12}\n")
        sys.stdout.flush()  # the next kernel compiles for a while


if __name__ == "__main__":
    main()
