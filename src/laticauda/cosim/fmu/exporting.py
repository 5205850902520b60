"""A robot in water as an FMU: a file that other simulation tools load and step."""

import io
import os
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Unpack, cast

from laticauda.actuation.laws import JointLaw
from laticauda.cosim.fmu.description import BINARIES, VERSIONS, Description
from laticauda.cosim.fmu.linking import FOLDER, c_compiler, digest, library, tables_in_c
from laticauda.cosim.fmu.tables import Tables, tables_of
from laticauda.cosim.fmu.variables import Variable
from laticauda.errors import BadArgument, instance, one_of
from laticauda.extensions import name_of
from laticauda.files import write
from laticauda.gaits import Gait
from laticauda.interfaces import Start
from laticauda.planar.model import PlanarPlant
from laticauda.robot import Robot, Water
from laticauda.scenarios import Changes, Planar, Scenario, scenario
from laticauda.simulate import plant

INPUTS = ("gait", "references")
_EPOCH = (1980, 1, 1, 0, 0, 0)  # of all files inside, so that the same robot makes the same FMU


def export_fmu(
    path: str | os.PathLike[str],
    robot: Scenario | Robot | str | Path,
    gait: Gait | None = None,
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
            control or servos, `references` (an angle for every joint).
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
    one_of("fmi", fmi, VERSIONS)
    chosen = robot if isinstance(robot, Scenario) else scenario(robot, cast(Gait, gait), **changes)
    instance("environment", chosen.environment, Water)
    instance("model", chosen.model, Planar)
    instance("motion", chosen.motion, Gait)
    instance("start", chosen.start, Start)
    body, gait = cast(PlanarPlant, plant(chosen)), chosen.gait
    if inputs == "references" and body.joints.prescribed:
        raise BadArgument(
            "inputs",
            "must be 'gait' for prescribed joints, which cannot jump; pd and servo joints can, got 'references'",
        )
    if inputs == "references":  # the wave stands still, so its numbers mean nothing
        gait = replace(gait, amplitude=0.0, frequency=0.0, phase_shift=0.0, offset=0.0)
    tables = tables_of(body, gait, cast(Start, chosen.start), inputs=inputs)
    _export(file, body, tables, inputs, fmi)
    return tables.variables


def needs_compiling(water: Water, joints: JointLaw | str = "prescribed") -> bool:
    """Whether the next FMU for this water will have to compile the kernels, which takes seconds.

    Args:
        water: Where it will swim.
        joints: How its joints will follow their references.
    """
    from laticauda.cosim.fmu.entry import is_compiled

    return not is_compiled(water.drag, JointLaw.of(joints))


def _export(file: Path, body: PlanarPlant, tables: Tables, inputs: str, fmi: str) -> None:
    """Compile, and pack what belongs together; its identity is a digest of all that it is made of."""
    c_compiler()  # before the kernels, which take seconds
    from laticauda.cosim.fmu.entry import object_code

    code = object_code(body.law, body.joints)
    words = Description(
        identifier=_identifier(file.stem),
        robot=_in_words(body),
        facts=_facts(body, inputs),
        variables=tables.variables,
        version=fmi,
    )
    content = words.model_description("").decode() + tables_in_c(tables, "") + digest(code)
    content += "".join(part.read_text(encoding="utf-8") for part in sorted(FOLDER.iterdir()))
    guid = _guid(digest(content.encode()))
    parts = {
        "modelDescription.xml": words.model_description(guid),
        f"binaries/{BINARIES[fmi]}/{words.identifier}.so": library(code, tables, guid, fmi),
        "documentation/index.html": words.page().encode(),
    }
    write(file, _zipped(parts))


def _identifier(stem: str) -> str:
    """A name that C allows, from that of the file."""
    plain = "".join(letter if letter.isascii() and letter.isalnum() else "_" for letter in stem)
    return plain if plain[:1].isalpha() else f"robot_{plain}"


def _guid(digits: str) -> str:
    return "{" + "-".join((digits[:8], digits[8:12], digits[12:16], digits[16:20], digits[20:32])) + "}"


def _in_words(body: PlanarPlant) -> str:
    robot = body.robot
    fin = "" if robot.caudal_fin is None else " with a caudal fin"
    return (
        f"The swimming snake robot {robot.name}{fin}: {robot.n_links} links, {robot.length:.3g} m, "
        f"{robot.mass:.3g} kg, {body.joints.words}, in water ({body.environment.name}); planar model."
    )


def _facts(body: PlanarPlant, inputs: str) -> tuple[tuple[str, str], ...]:
    water = body.environment
    assert isinstance(water, Water)
    return (
        ("robot", f"{body.robot.name}: its links, sections, masses, joints, fin and other effectors"),
        ("joints", name_of(type(body.joints))),
        ("inputs", inputs),
        ("drag", water.drag.words),
        ("form of the added mass", water.added_mass_form),
        ("rotational loads", water.rotational),
        ("trailing edge", water.trailing_edge),
        ("friction taper", f"{water.friction_taper:g}"),
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
