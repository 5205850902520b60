"""A robot in water as an FMU: a file that other simulation tools load and step.

Machine code and tables of numbers become a shared library by a C compiler.
"""

import hashlib
import io
import os
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Unpack, cast
from uuid import UUID

import laticauda as lc
from laticauda import extensions, files
from laticauda.cosim.fmu import description
from laticauda.cosim.native import platforms
from laticauda.cosim.native.tables import Tables, tables_in_c, tables_of
from laticauda.cosim.native.variables import Variable
from laticauda.errors import BadArgument, instance, one_of
from laticauda.planar.model import PlanarPlant
from laticauda.scenarios import Changes, Planar, Scenario, scenario

FOLDER = Path(__file__).parent / "c"
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


def _export(file: Path, body: PlanarPlant, tables: Tables, inputs: str, fmi: str) -> None:
    """Compile, and pack what belongs together; its identity is a digest of all that it is made of."""
    platform = platforms.platform_of()
    platforms.compiler(platform)  # before the kernels, which take seconds
    code = platforms.object_code(body.law, body.joints, body.flow.kinds, platform)
    words = description.Description(
        identifier=_identifier(file.stem),
        robot=_in_words(body),
        facts=_facts(body, inputs),
        variables=tables.variables,
        version=fmi,
    )
    content = words.model_description("") + tables_in_c(tables, "").encode() + code
    content += b"".join(part.read_bytes() for part in sorted(FOLDER.iterdir()))
    guid = f"{{{UUID(hashlib.sha256(content).hexdigest()[:32])}}}"
    sources, headers = (FOLDER / f"fmi{fmi[0]}.c",), {"tables.h": tables_in_c(tables, guid)}
    folder = platform.folder if fmi == "2.0" else platform.pair
    parts = {
        "modelDescription.xml": words.model_description(guid),
        f"binaries/{folder}/{words.identifier}{platform.system.ending}": platforms.linked(
            code, platform, sources, headers
        ),
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
