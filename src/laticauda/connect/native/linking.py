"""Libraries and WebAssembly modules from machine code, linked by a C compiler.

For this machine the compiler is the system's own, for others that of the package `ziglang` (the
extra `export`), which includes their C libraries.
"""

import importlib.util
import os
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from laticauda.connect.native import platforms
from laticauda.connect.native.entry import ENTRY_FUNCTION
from laticauda.connect.native.platforms import BROWSER, Platform
from laticauda.values import LaticaudaError, MissingExtra, MissingProgram

COMPILERS = ("cc", "gcc", "clang")
"""C compilers that are looked for, in this order."""
COMPILE_FLAGS = (
    "-std=c11 -O2 -fPIC -fvisibility=hidden -Wall -Wextra -Werror=implicit-function-declaration"
)
KERNELS_FILE = "kernels.o"
LIBRARY_FILE = "library"
MOST_LINES = 8
"""Lines of a compiler's output that an error shows at most."""

PAGE = 1 << 14
"""Memory page on a Mac [byte]; each part of a universal library begins at a page boundary."""
UNIVERSAL_MAGIC = 0xCAFEBABE
"""First number of a universal library for macOS."""


class LinkingFailed(LaticaudaError, RuntimeError):
    """Raised if the C compiler is available but fails; the message gives the command and its output."""


class LinkedLibrary(NamedTuple):
    """A library, and the machine code from which it was linked."""

    machine_code: bytes
    """Object file of the kernels, which names the processor."""
    library: bytes
    """Content of the library."""


def find_compiler(platform: Platform) -> list[str]:
    """Return the command of a C compiler: for this machine that in CC or the system's, otherwise that of ziglang.

    Args:
        platform: Target platform.

    Raises:
        MissingProgram, MissingExtra: If there is no compiler.
    """
    if platform != platforms.current_platform():
        if not _has_ziglang():
            raise MissingExtra(f"A library for {platform.pair}", "ziglang", "export")
        return _ziglang_command(platform)
    command_of_user = shlex.split(os.environ.get("CC", ""))
    if command_of_user:
        return _check_command_of_user(command_of_user)
    for compiler in COMPILERS:
        if shutil.which(compiler) is not None:
            return [compiler]
    if _has_ziglang():
        return _ziglang_command(platform)
    raise MissingProgram("A library of machine code", "a C compiler", "gcc libc6-dev")


def _check_command_of_user(command: list[str]) -> list[str]:
    compiler = command[0]
    if shutil.which(compiler) is None:
        missing = f"the C compiler `{compiler}` (the environment says CC={' '.join(command)})"
        raise MissingProgram("A library of machine code", missing, "gcc libc6-dev")
    return command


def _has_ziglang() -> bool:
    return importlib.util.find_spec("ziglang") is not None


def _ziglang_command(platform: Platform) -> list[str]:
    target = f"{platform.processor}-{platform.system.zig_name}"
    return [sys.executable, "-m", "ziglang", "cc", "-target", target]


def link_library(
    machine_code: bytes,
    platform: Platform,
    sources: Sequence[Path] = (),
    headers: Mapping[str, str] | None = None,
    static: bool = False,
    name: str = ENTRY_FUNCTION,
) -> bytes:
    """Link a shared library or, for a browser, a WebAssembly module.

    The module needs no imports. It exports `memory`, `_initialize()`, to be called first,
    `laticauda_reserve(bytes)`, which returns the address of newly reserved memory (and may replace
    its buffer), and `laticauda_move`.

    Args:
        machine_code: Object file from `compile_kernels`, for the same platform.
        platform: Target platform.
        sources: C source files of the library.
        headers: Names and texts of the headers that they include.
        static: Whether to build a static library instead.
        name: Name of the exported function.

    Raises:
        MissingProgram, MissingExtra: If there is no C compiler for the platform.
        LinkingFailed: If the C compiler fails.
    """
    compiler = find_compiler(platform)
    if static:
        commands = _static_commands(compiler, sources)
    else:
        commands = [_shared_command(compiler, platform, sources, exported_name=name)]
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        for header, text in (headers or {}).items():
            (folder / header).write_text(text, encoding="utf-8")
        (folder / KERNELS_FILE).write_bytes(machine_code)
        for command in commands:
            _run_compiler(command, folder, platform)
        return (folder / LIBRARY_FILE).read_bytes()


def _source_arguments(sources: Sequence[Path]) -> list[str]:
    source_paths = [str(source) for source in sources]
    return [*shlex.split(COMPILE_FLAGS), "-I.", *source_paths]


def _shared_command(
    compiler: Sequence[str], platform: Platform, sources: Sequence[Path], *, exported_name: str
) -> list[str]:
    """Return the command that compiles the sources and links a shared library or a WebAssembly module."""
    command = [
        *compiler,
        *_source_arguments(sources),
        *shlex.split(platform.system.link_flags),
        KERNELS_FILE,
        "-lm",
        "-o",
        LIBRARY_FILE,
    ]
    if platform.system == BROWSER:
        command.append(f"-Wl,--export={exported_name}")
    return command


def _static_commands(compiler: Sequence[str], sources: Sequence[Path]) -> list[list[str]]:
    """Return the commands that compile the sources, and combine the object files to a static library."""
    archiver = ["ar"]
    if "ziglang" in compiler:
        archiver = [sys.executable, "-m", "ziglang", "ar"]
    compiled_sources = [f"{source.stem}.o" for source in sources]
    return [
        [*compiler, "-c", *_source_arguments(sources)],
        [*archiver, "rcs", LIBRARY_FILE, KERNELS_FILE, *compiled_sources],
    ]


def _run_compiler(command: Sequence[str], folder: Path, platform: Platform) -> None:
    result = subprocess.run(command, capture_output=True, text=True, cwd=folder)
    if result.returncode == 0:
        return
    lines = (result.stderr or result.stdout).splitlines()
    output = "\n".join(lines[:MOST_LINES])
    beginning = " ".join(command[:4])
    raise LinkingFailed(
        f"`{beginning} ...` cannot make a library for {platform.pair}. It says:\n{output}"
    )


def combine_libraries(libraries: Sequence[LinkedLibrary]) -> bytes:
    """Combine libraries for different processors into one for macOS; a single library is returned unchanged.

    Args:
        libraries: Machine code and library for each processor.
    """
    if len(libraries) == 1:
        return libraries[0].library
    head = struct.pack(">2I", UNIVERSAL_MAGIC, len(libraries))
    body = b""
    for linked in libraries:
        # The processor's type and subtype, from the machine code, whose bytes are in reverse order.
        processor_type = linked.machine_code[7:3:-1]
        processor_subtype = linked.machine_code[11:7:-1]
        begin = PAGE + len(body)
        alignment = PAGE.bit_length() - 1
        position = struct.pack(">3I", begin, len(linked.library), alignment)
        head += processor_type + processor_subtype + position
        padding = -len(linked.library) % PAGE
        body += linked.library + bytes(padding)
    return head.ljust(PAGE, b"\0") + body
