"""A robot in water as an FMU: a file that other simulation tools load and step.

Machine code and tables of numbers become a shared library by the system's C compiler.
"""

import hashlib
import importlib.util
import io
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Unpack, cast
from uuid import UUID

import numpy as np

import laticauda as lc
from laticauda import extensions, files
from laticauda.cosim.fmu import description, entry
from laticauda.cosim.fmu.tables import Tables, tables_of
from laticauda.cosim.fmu.variables import Variable
from laticauda.errors import BadArgument, LaticaudaError, MissingProgram, instance, one_of
from laticauda.planar.layout import flow_rows
from laticauda.planar.model import PlanarPlant
from laticauda.scenarios import Changes, Planar, Scenario, scenario

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
            f"#define N_NUMBERS {tables.n_rows + entry.SCRATCH}",
            f"#define DT {tables.whole[entry.DT]}",
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


INPUTS = ("gait", "references")
_EPOCH = (1980, 1, 1, 0, 0, 0)  # of all files inside, so that the same robot makes the same FMU


def export_fmu(
    path: str | os.PathLike[str],
    robot: Scenario | lc.Robot | str | Path,
    gait: lc.Gait | None = None,
    *,
    inputs: str = "gait",
    fmi: str = "2.0",
    **changes: Unpack[Changes],
) -> tuple[Variable, ...]:
    """Write a planar robot in water to an FMU for co-simulation that needs no Python where it is used.

    Inside are the kernels that `laticauda.swim` runs, compiled for any x86-64 processor under Linux. Inputs are held
    during a communication step of any length, which is cut into steps of the integration no longer than `dt`.

    Args:
        path: The file (.fmu); an older one is replaced.
        robot: The scenario, whose duration does not count; or what swims, with its gait.
        gait: With a robot: what the joints are asked for unless the FMU is told otherwise; of kind custom, its
            envelope too.
        inputs: What drives the robot: `gait` (amplitude, frequency, phase shift, offset) or, for joints driven by pd
            control or servos, `references` (an angle for every joint, and for a driven fin).
        fmi: Version of the standard: 2.0, which all tools read, or 3.0.
        changes: With a robot, what else differs from the defaults; see `laticauda.scenarios.Changes`.

    Returns:
        The FMU's variables, in the order of their value references.

    Raises:
        ValueError: If an argument is out of its range, or robot, gait and inputs do not fit together.
        MissingProgram: If there is no C compiler, which puts the compiled kernels into a library.
        LinkingFailed: If it fails.
    """
    file = Path(path)
    if file.suffix.lower() != ".fmu":
        raise BadArgument("path", f"must be a file that ends in .fmu, got {path}")
    one_of("inputs", inputs, INPUTS)
    one_of("fmi", fmi, description.VERSIONS)
    chosen = robot if isinstance(robot, Scenario) else scenario(robot, cast(lc.Gait, gait), **changes)
    instance("environment", chosen.environment, lc.Water)
    instance("model", chosen.model, Planar)
    instance("motion", chosen.motion, lc.Gait)
    instance("start", chosen.start, lc.Start)
    body, gait = cast(PlanarPlant, lc.plant(chosen)), chosen.gait
    if inputs == "references" and body.joints.prescribed:
        raise BadArgument(
            "inputs",
            "must be 'gait' for prescribed joints, which cannot jump; pd and servo joints can, got 'references'",
        )
    if inputs == "references":  # the wave stands still, so its numbers mean nothing
        gait = replace(gait, amplitude=0.0, frequency=0.0, phase_shift=0.0, offset=0.0)
    tables = tables_of(body, gait, cast(lc.Start, chosen.start), inputs=inputs)
    _export(file, body, tables, inputs, fmi)
    return tables.variables


def needs_compiling(water: lc.Water, joints: lc.JointLaw | str = "prescribed") -> bool:
    """Whether the next FMU for this water will have to compile the kernels, which takes seconds.

    Args:
        water: Where it will swim.
        joints: How its joints will follow their references.
    """
    return not entry.kept_at(water.drag, lc.JointLaw.of(joints), flow_rows(water).kinds).exists()


def _export(file: Path, body: PlanarPlant, tables: Tables, inputs: str, fmi: str) -> None:
    """Compile, and pack what belongs together; its identity is a digest of all that it is made of."""
    c_compiler()  # before the kernels, which take seconds
    code = entry.object_code(body.law, body.joints, body.flow.kinds)
    words = description.Description(
        identifier=_identifier(file.stem),
        robot=_in_words(body),
        facts=_facts(body, inputs),
        variables=tables.variables,
        version=fmi,
    )
    content = words.model_description("").decode() + tables_in_c(tables, "") + digest(code)
    content += "".join(part.read_text(encoding="utf-8") for part in sorted(FOLDER.iterdir()))
    guid = f"{{{UUID(digest(content.encode())[:32])}}}"
    parts = {
        "modelDescription.xml": words.model_description(guid),
        f"binaries/{description.BINARIES[fmi]}/{words.identifier}.so": library(code, tables, guid, fmi),
        "documentation/index.html": words.page().encode(),
    }
    files.write(file, _zipped(parts))


def _identifier(stem: str) -> str:
    """A name that C allows, from that of the file."""
    plain = "".join(letter if letter.isascii() and letter.isalnum() else "_" for letter in stem)
    return plain if plain[:1].isalpha() else f"robot_{plain}"


def _in_words(body: PlanarPlant) -> str:
    robot = body.robot
    fin = "" if robot.caudal_fin is None else " with a caudal fin"
    return (
        f"The swimming snake robot {robot.name}{fin}: {robot.n_links} links, {robot.length:.3g} m, "
        f"{robot.mass:.3g} kg, {body.joints.words}, in water ({body.environment.name}); planar model."
    )


def _facts(body: PlanarPlant, inputs: str) -> tuple[tuple[str, str], ...]:
    water = body.environment
    assert isinstance(water, lc.Water)
    return (
        ("robot", f"{body.robot.name}: its links, sections, masses, joints, fin and other effectors"),
        ("joints", extensions.name_of(type(body.joints))),
        ("inputs", inputs),
        ("drag", water.drag.words),
        ("form of the added mass", water.added_mass_form),
        ("rotational loads", water.rotational),
        ("trailing edge", water.trailing_edge),
        ("friction taper", f"{water.friction_taper:g}"),
        *([("current", water.current_words)] if water.flow else []),
        ("depth", "far below the surface" if water.depth is None else f"{water.depth:g} m"),
    )


def _zipped(content: dict[str, bytes]) -> bytes:
    """The archive that an FMU is; the same content always gives the same bytes."""
    raw = io.BytesIO()
    with zipfile.ZipFile(raw, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in content.items():
            entry = zipfile.ZipInfo(name, date_time=_EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if name.endswith(".so") else 0o644) << 16
            archive.writestr(entry, data)
    return raw.getvalue()
