"""Target platforms of the kernels: machine code for each, and libraries built from it.

LLVM generates the machine code for any platform on any machine. A C compiler links it: for this
machine the system's own, for others that of the package `ziglang` (the extra `export`), which
includes their C libraries.
"""

# pyright: basic
import contextlib
import functools
import hashlib
import importlib.util
import os
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from platform import machine
from typing import NamedTuple

import llvmlite
import llvmlite.binding as llvm
import numba

from laticauda.compiling.templates import sources_digest
from laticauda.connect.native.entry import NAME, bitcode
from laticauda.models.planar.model import PlanarPlant, specialize
from laticauda.motion.joints.laws import JointLaw
from laticauda.values import files, formulas
from laticauda.values.checks import check_choice
from laticauda.values.errors import BadArgument, LaticaudaError, MissingExtra, MissingProgram
from laticauda.values.files import read_toml
from laticauda.water.fluid.laws import DragLaw

FOLDER = Path(__file__).parent / "c"
COMPILERS = ("cc", "gcc", "clang")
FLAGS = "-std=c11 -O2 -fPIC -fvisibility=hidden -Wall -Wextra -Werror=implicit-function-declaration"


class System(NamedTuple):
    """An operating system, or its equivalent."""

    name: str
    """Name in FMI 3 [-]."""
    llvm: str
    """Name in LLVM, following the processor [-]."""
    zig: str
    """Name in Zig's C compiler [-]."""
    ending: str
    """Ending of a library's file name [-]."""
    linking: str
    """Compiler flags for linking [-]."""


class Platform(NamedTuple):
    """An operating system on a family of processors, represented by its most basic member."""

    name: str
    """Name by which users choose it [-]."""
    processor: str
    """Name in LLVM, Zig and FMI 3 [-]."""
    system: System
    """Operating system [-]."""
    folder: str
    """Folder of a library in an FMU, FMI 2; empty if there are no FMUs for the platform [-]."""
    features: str = ""
    """Required processor features [-]."""

    @property
    def pair(self) -> str:
        """Processor and system, which is also the folder of a library in an FMU, FMI 3 [-]."""
        return f"{self.processor}-{self.system.name}"


_TOLD = read_toml(Path(__file__).with_suffix(".toml"))
_WASM = shlex.quote(f"{FOLDER}/wasm.c")
_SYSTEMS = {
    name: System(name, llvm, zig, ending, flags.format(wasm=_WASM))
    for name, (llvm, zig, ending, flags) in _TOLD["systems"].items()
}
PLATFORMS = {
    name: Platform(name, one, _SYSTEMS[of], *more)
    for name, (one, of, *more) in _TOLD["platforms"].items()
}
"""Platforms by name."""
_PAGE = 1 << 14  # memory page on a Mac; each part of a universal library begins at a page boundary


class LinkingFailed(LaticaudaError, RuntimeError):
    """Raised if the C compiler is available but fails; the message gives the command and its output."""


def current_platform() -> Platform | None:
    """Return the platform of this machine; None if it is not one of `PLATFORMS`."""
    system = {"win32": "windows"}.get(sys.platform, sys.platform)
    family = {"amd64": "x86_64", "arm64": "aarch64"}.get(machine().lower(), machine().lower())
    return next((one for one in PLATFORMS.values() if one.pair == f"{family}-{system}"), None)


def platform_of(name: str = "") -> Platform:
    """Return a platform by its name; that of this machine if omitted.

    Args:
        name: One of `PLATFORMS`.

    Raises:
        ValueError: If there is no such platform.
    """
    if name:
        return PLATFORMS[check_choice("platform", name, [*PLATFORMS])]
    if (own := current_platform()) is None:
        raise BadArgument(
            "platform", f"must be given on {sys.platform} on {machine()}, which is none of them"
        )
    return own


def platforms_of(names: Sequence[str] = ()) -> list[Platform]:
    """Return platforms in the order of `PLATFORMS`; `darwin` means both kinds of Mac, no name means this machine.

    Args:
        names: Names from `PLATFORMS`, except for that of browsers.

    Raises:
        ValueError: If there is no platform with one of the names.
    """
    libraries = [one for one in PLATFORMS.values() if one.folder]
    for name in names:
        check_choice("platform", name, [*(one.name for one in libraries), "darwin"])
    return [one for one in libraries if one.name in names or one.system.name in names] or [
        platform_of()
    ]


def object_code(
    law: DragLaw, joints: JointLaw, flow: tuple[formulas.Formula, ...], platform: Platform
) -> bytes:
    """Return the object file with the function `laticauda_move` for a platform, from the cache if possible.

    Args:
        law: Law of the loads on one element.
        joints: Law by which the joints follow their references.
        flow: Kinds of parts of the water's flow (`PlanarPlant.flow.kinds`); empty for a uniform
            current or none.
        platform: Target platform.

    Raises:
        ValueError: If the law is not plain arithmetic.
    """
    whole = functools.partial(
        _kept, kept_at(law, joints, flow, "bc"), functools.partial(bitcode, law, joints, flow)
    )
    return _kept(
        kept_at(law, joints, flow, f"{platform.name}.o"), lambda: emitted(whole(), platform)
    )


def object_codes(plant: PlanarPlant, platforms: Sequence[Platform]) -> list[bytes]:
    """Return the object files of `object_code` for a plant, after checking that they can be linked.

    Args:
        plant: Plant whose laws are compiled.
        platforms: Target platforms.

    Raises:
        MissingProgram, MissingExtra, ValueError: As raised by `compiler` and `object_code`.
    """
    for one in platforms:
        compiler(one)  # before compiling the kernels, which takes seconds
    return [object_code(plant.law, plant.joints, plant.flow.kinds, one) for one in platforms]


def kept_at(
    law: DragLaw, joints: JointLaw, flow: tuple[formulas.Formula, ...], ending: str
) -> Path:
    """Return the path of a cached file: in Numba's cache, under a name that encodes what it was built from.

    Args:
        law: Law of the loads on one element.
        joints: Law by which the joints follow their references.
        flow: Kinds of parts of the water's flow.
        ending: End of the file name, from the platform on.
    """
    run = specialize(
        1, law, joints, flow
    ).run  # this does not compile; the module's name encodes sources and laws
    digest = hashlib.sha256(sources_digest(__name__).encode())
    digest.update(f"{run.py_func.__module__} {numba.__version__} {llvmlite.__version__}".encode())
    digest.update(f"{llvm.get_host_cpu_name()} {sys.version}".encode())
    return Path(run.stats.cache_path) / f"native-{digest.hexdigest()[:24]}-{ending}"


def _kept(file: Path, make: Callable[[], bytes]) -> bytes:
    try:
        return file.read_bytes()
    except OSError:
        made = make()
    with contextlib.suppress(
        OSError
    ):  # there may be no place for it, or another process may be writing it right now
        file.parent.mkdir(parents=True, exist_ok=True)
        files.write(file, made)
    return made


def emitted(code: bytes, platform: Platform) -> bytes:
    """Compile a module to an object file.

    Args:
        code: LLVM bitcode.
        platform: Target platform.
    """
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    module = llvm.parse_bitcode(code)
    triple = f"{platform.processor}-{platform.system.llvm}"
    chosen = llvm.Target.from_triple(triple).create_target_machine(
        features=platform.features, opt=3, reloc="pic", codemodel="default"
    )
    module.triple, module.data_layout = triple, str(chosen.target_data)
    return chosen.emit_object(module)


def compiler(platform: Platform) -> list[str]:
    """Return the command of a C compiler: for this machine that in CC or the system's, otherwise that of ziglang.

    Args:
        platform: Target platform.

    Raises:
        MissingProgram, MissingExtra: If there is no compiler.
    """
    wanted = shlex.split(os.environ.get("CC", "")) if platform == current_platform() else []
    for command in (
        ([wanted] if wanted else [[name] for name in COMPILERS])
        if platform == current_platform()
        else []
    ):
        if shutil.which(command[0]) is not None:
            return command
    if not wanted and importlib.util.find_spec("ziglang") is not None:
        return [
            sys.executable,
            "-m",
            "ziglang",
            "cc",
            "-target",
            f"{platform.processor}-{platform.system.zig}",
        ]
    if platform != current_platform():
        raise MissingExtra(f"A library for {platform.pair}", "ziglang", "export")
    thing = (
        f"the C compiler `{wanted[0]}` (the environment says CC={' '.join(wanted)})"
        if wanted
        else "a C compiler"
    )
    raise MissingProgram("A library of machine code", thing, "gcc libc6-dev")


def linked(
    code: bytes,
    platform: Platform,
    sources: Sequence[Path] = (),
    headers: Mapping[str, str] | None = None,
    static: bool = False,
    name: str = NAME,
) -> bytes:
    """Link a shared library or, for a browser, a WebAssembly module.

    The module needs no imports. It exports `memory`, `_initialize()`, to be called first,
    `laticauda_reserve(bytes)`, which returns the address of newly reserved memory (and may replace
    its buffer), and `laticauda_move`.

    Args:
        code: Object file from `object_code`, for the same platform.
        platform: Target platform.
        sources: C source files of the library.
        headers: Names and texts of the headers that they include.
        static: Whether to build a static library instead.
        name: Name of the exported function.

    Raises:
        MissingProgram, MissingExtra: If there is no C compiler for the platform.
        LinkingFailed: If the C compiler fails.
    """
    chosen = compiler(platform)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        for header, text in (headers or {}).items():
            (folder / header).write_text(text, encoding="utf-8")
        (folder / "kernels.o").write_bytes(code)
        parts = [*shlex.split(FLAGS), "-I.", *map(str, sources)]
        linking = [
            *parts,
            *shlex.split(platform.system.linking),
            "kernels.o",
            "-lm",
            "-o",
            "library",
        ]
        linking += [f"-Wl,--export={name}"] if platform.system.name == "unknown" else []
        objects = ["kernels.o", *(f"{source.stem}.o" for source in sources)]
        archiver = [sys.executable, "-m", "ziglang", "ar"] if "ziglang" in chosen else ["ar"]
        both = [[*chosen, "-c", *parts], [*archiver, "rcs", "library", *objects]]
        for command in both if static else [[*chosen, *linking]]:
            done = subprocess.run(command, capture_output=True, text=True, cwd=folder)
            if done.returncode != 0:
                said = "\n".join((done.stderr or done.stdout).splitlines()[:8])
                raise LinkingFailed(
                    f"`{' '.join(command[:4])} ...` cannot make a library for {platform.pair}. It says:\n{said}"
                )
        return (folder / "library").read_bytes()


def universal(parts: Sequence[tuple[bytes, bytes]]) -> bytes:
    """Combine libraries for different processors into one for macOS; a single library is returned unchanged.

    Args:
        parts: Machine code and library for each processor.
    """
    head, body = struct.pack(">2I", 0xCAFEBABE, len(parts)), b""
    for code, library in parts:
        place = struct.pack(">3I", len(body) + _PAGE, len(library), _PAGE.bit_length() - 1)
        head += code[7:3:-1] + code[11:7:-1] + place  # processor type, from the machine code
        body += library + bytes(-len(library) % _PAGE)
    return parts[0][1] if len(parts) == 1 else head.ljust(_PAGE, b"\0") + body
