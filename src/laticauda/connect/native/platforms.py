"""Target platforms of the kernels: operating systems on families of processors."""

import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from platform import machine
from typing import NamedTuple

from laticauda.values import BadArgument, check_choice

C_FOLDER = Path(__file__).parent / "c"
"""C sources and headers that libraries are built from."""


class System(NamedTuple):
    """An operating system, or its equivalent."""

    name: str
    """Name in FMI 3 [-]."""
    llvm_name: str
    """Name in LLVM, following the processor [-]."""
    zig_name: str
    """Name in Zig's C compiler [-]."""
    library_ending: str
    """Ending of a library's file name [-]."""
    link_flags: str
    """Compiler flags for linking [-]."""


class Platform(NamedTuple):
    """An operating system on a family of processors, represented by its most basic member."""

    name: str
    """Name by which users choose it [-]."""
    processor: str
    """Name in LLVM, Zig and FMI 3 [-]."""
    system: System
    """Operating system [-]."""
    fmi2_folder: str
    """Folder of a library in an FMU, FMI 2; empty if there are no FMUs for the platform [-]."""
    features: str = ""
    """Required processor features [-]."""

    @property
    def pair(self) -> str:
        """Processor and system, which is also the folder of a library in an FMU, FMI 3 [-]."""
        return f"{self.processor}-{self.system.name}"


LINUX = System(
    name="linux",
    llvm_name="unknown-linux-gnu",
    zig_name="linux-gnu.2.17",
    library_ending=".so",
    link_flags="-shared -s -Wl,-Bsymbolic -Wl,-z,noexecstack -Wl,-z,defs",
)
WINDOWS = System(
    name="windows",
    llvm_name="pc-windows-gnu",
    zig_name="windows-gnu",
    library_ending=".dll",
    link_flags="-shared -s",
)
DARWIN = System(
    name="darwin",
    llvm_name="apple-macosx11.0.0",
    zig_name="macos",
    library_ending=".dylib",
    link_flags="-shared",
)
_WASM_SOURCE = shlex.quote(f"{C_FOLDER}/wasm.c")
BROWSER = System(
    name="unknown",
    llvm_name="unknown-unknown",
    zig_name="wasi",
    library_ending=".wasm",
    link_flags=f"-mexec-model=reactor -s -Wl,--export=laticauda_reserve {_WASM_SOURCE}",
)
"""A web browser, in which WebAssembly runs."""

_ALL_PLATFORMS = (
    Platform(name="linux64", processor="x86_64", system=LINUX, fmi2_folder="linux64"),
    Platform(name="aarch64", processor="aarch64", system=LINUX, fmi2_folder="aarch64-linux"),
    Platform(name="win64", processor="x86_64", system=WINDOWS, fmi2_folder="win64"),
    Platform(name="darwin-arm64", processor="aarch64", system=DARWIN, fmi2_folder="darwin64"),
    Platform(name="darwin-x86-64", processor="x86_64", system=DARWIN, fmi2_folder="darwin64"),
    Platform(
        name="wasm32",
        processor="wasm32",
        system=BROWSER,
        fmi2_folder="",
        features="+simd128,+bulk-memory",
    ),
)
PLATFORMS = {platform.name: platform for platform in _ALL_PLATFORMS}
"""Platforms by name."""

SYSTEM_NAMES = {"win32": "windows"}
"""Names of systems in FMI 3 by Python's, where they differ."""
PROCESSOR_NAMES = {"amd64": "x86_64", "arm64": "aarch64"}
"""Names of processors in LLVM by Python's, where they differ."""


def current_platform() -> Platform | None:
    """Return the platform of this machine; None if it is not one of `PLATFORMS`."""
    system = SYSTEM_NAMES.get(sys.platform, sys.platform)
    processor = machine().lower()
    processor = PROCESSOR_NAMES.get(processor, processor)
    for platform in PLATFORMS.values():
        if platform.pair == f"{processor}-{system}":
            return platform
    return None


def find_platform(name: str = "") -> Platform:
    """Return a platform by its name; that of this machine if omitted.

    Args:
        name: One of `PLATFORMS`.

    Raises:
        ValueError: If there is no such platform.
    """
    if name:
        return PLATFORMS[check_choice("platform", name, [*PLATFORMS])]
    platform = current_platform()
    if platform is None:
        raise BadArgument(
            "platform", f"must be given on {sys.platform} on {machine()}, which is none of them"
        )
    return platform


def find_library_platforms(names: Sequence[str] = ()) -> list[Platform]:
    """Return platforms in the order of `PLATFORMS`; `darwin` means both kinds of Mac, no name means this machine.

    Args:
        names: Names from `PLATFORMS`, except for that of browsers.

    Raises:
        ValueError: If there is no platform with one of the names.
    """
    platforms = [platform for platform in PLATFORMS.values() if platform.fmi2_folder]
    choices = [platform.name for platform in platforms]
    choices.append(DARWIN.name)
    for name in names:
        check_choice("platform", name, choices)
    chosen: list[Platform] = []
    for platform in platforms:
        if platform.name in names or platform.system.name in names:
            chosen.append(platform)
    return chosen or [find_platform()]
