"""Export of a robot in water as an FMU: a file that other simulation tools load and step.

A C compiler links machine code and tables of numbers into a shared library. The FMU is described by
`modelDescription.xml` for programs, and by an HTML page for people.
"""

import hashlib
import io
import math
import os
import time
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from string import Template
from typing import Any, Unpack, cast
from uuid import UUID
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import laticauda as lc
from laticauda import scenarios
from laticauda.connect.native.platforms import linked, object_codes, platforms_of, universal
from laticauda.connect.native.tables import Tables, c_identifier, tables_for, tables_in_c
from laticauda.connect.native.variables import Variable
from laticauda.values import extensions, files
from laticauda.values.checks import check_choice
from laticauda.values.errors import BadArgument

HERE = Path(__file__).parent
FOLDER = HERE / "c"
_EPOCH = (
    1980,
    1,
    1,
    0,
    0,
    0,
)  # date of all files inside, so that the same robot gives the same FMU


def export_fmu(
    path: str | os.PathLike[str],
    robot: scenarios.Scenario | lc.Robot | str | Path,
    gait: lc.Gait | None = None,
    *,
    inputs: str = "gait",
    fmi: str = "2.0",
    platform: Sequence[str] = (),
    author: str | None = None,
    model_version: str | None = None,
    license: str = "MIT",
    **changes: Unpack[scenarios.Changes],
) -> tuple[Variable, ...]:
    """Export a planar robot in water as an FMU for co-simulation, which runs without Python.

    The FMU contains the kernels that `laticauda.swim` runs, compiled for each platform. Inputs are
    held constant during a communication step of any length, which is divided into integration steps
    no longer than `dt`.

    Args:
        path: The file (.fmu); an existing one is replaced.
        robot: The scenario, whose duration is ignored; or the robot, with its gait.
        gait: With a robot: the gait that the joints follow unless the FMU's inputs say otherwise;
            for the kind custom, including its envelope.
        inputs: What drives the robot: `gait` (amplitude, frequency, phase shift, offset) or, for
            joints driven by pd control or servos, `references` (an angle for every joint, and for a
            driven fin).
        fmi: Version of the standard: 2.0, which all tools support, or 3.0.
        platform: One or more target platforms: linux64, aarch64 (Linux), win64, darwin; if omitted,
            that of this machine. Platforms other than this machine's require the package ziglang.
        author: Author of the model, as stated in the FMU.
        model_version: Version of the model; laticauda's own if omitted.
        license: License of the model. The FMU also contains the text of the kernels' own license.
        changes: With a robot, further changes to the defaults: `environment`, `current`, `model`,
            `start`, `sample_interval` [s], or, for the model, `joints`, `dt` [s] and the other
            fields of `laticauda.scenarios.ModelChanges`.

    Returns:
        The FMU's variables, in the order of their value references.

    Raises:
        ValueError: If an argument is out of range, or robot, gait and inputs are incompatible.
        MissingProgram, MissingExtra: If there is no C compiler to link the compiled kernels into a
            library.
        LinkingFailed: If the C compiler fails.
    """
    file = Path(path)
    if file.suffix.lower() != ".fmu":
        raise BadArgument("path", f"must be a file that ends in .fmu, got {path}")
    check_choice("fmi", fmi, VERSIONS)
    wanted = platforms_of(platform)
    tables = tables_for(robot, gait, inputs, **changes)
    codes = object_codes(tables.plant, wanted)
    words = Description(
        identifier=c_identifier(file.stem),
        tables=tables,
        platforms=", ".join(one.pair for one in wanted),
        version=fmi,
        imprint={"author": author, "version": model_version or lc.__version__, "license": license},
    )
    content = words.model_description() + tables_in_c(tables, "").encode() + b"".join(codes)
    content += b"".join(part.read_bytes() for part in sorted(FOLDER.iterdir()))
    guid = f"{{{UUID(hashlib.sha256(content).hexdigest()[:32])}}}"  # a digest of everything from which it is made
    sources, headers = (FOLDER / f"fmi{fmi[0]}.c",), {"tables.h": tables_in_c(tables, guid)}
    libraries: dict[str, list[tuple[bytes, bytes]]] = {}
    for one, code in zip(wanted, codes, strict=True):
        folder = one.folder if fmi == "2.0" else one.pair
        name = f"binaries/{folder}/{words.identifier}{one.system.ending}"
        libraries.setdefault(name, []).append((code, linked(code, one, sources, headers)))
    parts = {
        "modelDescription.xml": words.model_description(guid, _now()),
        **{name: universal(some) for name, some in libraries.items()},
        "documentation/index.html": words.page().encode(),
        "documentation/licenses/license.txt": (HERE / "license.txt").read_bytes(),
        "model.png" if fmi == "2.0" else "terminalsAndIcons/icon.png": (
            HERE / "icon.png"
        ).read_bytes(),
    }
    files.write(file, _zipped(parts))
    return tables.variables


def _now() -> str:
    """Return the current time, or the one set for reproducible builds, to the second, as the standard requires."""
    seconds = float(os.environ.get("SOURCE_DATE_EPOCH", time.time()))
    return time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(seconds))


def _zipped(content: dict[str, bytes]) -> bytes:
    """Return the archive that makes up an FMU; the same content always gives the same bytes."""
    raw = io.BytesIO()
    with zipfile.ZipFile(raw, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in content.items():
            entry = zipfile.ZipInfo(name, date_time=_EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if name.startswith("binaries/") else 0o644) << 16
            archive.writestr(entry, data)
    return raw.getvalue()


# ---- description of an FMU -----------------------------------------------------------------------

_TOLD: Any = files.read_toml(HERE / "units.toml")
UNITS: Mapping[str, Sequence[int]] = _TOLD["units"]
"""Units, as exponents of kg, m, s and rad."""
DEGREES: Mapping[str, str] = _TOLD["degrees"]
DURATION, INTERVAL = 30.0, 0.05  # of the default experiment [s]
VERSIONS = ("2.0", "3.0")
VARIABILITY = {
    "independent": "continuous",
    "parameter": "fixed",
    "input": "continuous",
    "output": "continuous",
}


@dataclass(frozen=True, kw_only=True)
class Description:
    """Description of one FMU."""

    identifier: str
    """Name of the binary and of the model [-]."""
    tables: Tables
    """Tables of the robot, and its variables."""
    platforms: str
    """Processors and systems for which the FMU has a binary [-]."""
    imprint: Mapping[str, str | None]
    """Author, version, license and so on, by attribute name; empty ones are omitted [-]."""
    version: str
    """FMI version: 2.0 or 3.0 [-]."""

    def model_description(self, guid: str = "", date: str = "") -> bytes:
        """Return the content of modelDescription.xml.

        Args:
            guid: Identifier that distinguishes this FMU from others.
            date: Date and time of creation.
        """
        imprint = {**self.imprint, "generationDateAndTime": date}
        is_old = self.version == "2.0"
        root = Element(
            "fmiModelDescription",
            {
                "fmiVersion": self.version,
                "modelName": self.identifier,
                "guid" if is_old else "instantiationToken": guid,
                **{name: text for name, text in imprint.items() if text},
            },
            description=f"{self.tables.words} Kernels of laticauda as machine code; needs no Python.",
            generationTool=f"laticauda {lc.__version__}",
            variableNamingConvention="structured",
        )
        state = "FMUstate" if is_old else "FMUState"
        # FMI treats omitted capabilities as false.
        can = (
            "canHandleVariableCommunicationStepSize",
            f"canGetAndSet{state}",
            f"canSerialize{state}",
        )
        SubElement(
            root, "CoSimulation", {"modelIdentifier": self.identifier, **dict.fromkeys(can, "true")}
        )
        _add_units(root, self.tables.variables)
        categories = SubElement(root, "LogCategories")
        SubElement(
            categories,
            "Category",
            name="logStatusError",
            description="Rejected calls, with the reasons.",
        )
        SubElement(
            root,
            "DefaultExperiment",
            startTime="0.0",
            stopTime=str(DURATION),
            stepSize=str(INTERVAL),
        )
        listed = SubElement(root, "ModelVariables")
        for reference, variable in enumerate(self.tables.variables):
            _add_variable(listed, reference, variable, is_old)
        structure = SubElement(root, "ModelStructure")
        outputs = [
            i for i, variable in enumerate(self.tables.variables) if variable.causality == "output"
        ]
        # Outputs are those at the end of the last step, so no input affects them before the next
        # step.
        for kind, more in (("Output", {"dependencies": ""}), ("InitialUnknown", {})):
            group = SubElement(structure, f"{kind}s") if is_old else structure
            for i in outputs:
                place = {"index": str(i + 1)} if is_old else {"valueReference": str(i)}
                SubElement(group, "Unknown" if is_old else kind, {**place, **more})
        indent(root)
        return tostring(root, encoding="UTF-8", xml_declaration=True) + b"\n"

    def page(self) -> str:
        """Return the content of documentation/index.html."""
        facts = "\n".join(
            f"<tr><th>{escape(name)}</th><td>{escape(value)}</td></tr>"
            for name, value in facts_of(self.tables)
        )
        listed = "\n".join(_row(variable) for variable in self.tables.variables)
        return Template((HERE / "page.html").read_text(encoding="utf-8")).substitute(
            title=escape(self.identifier),
            robot=escape(self.tables.words),
            version=escape(lc.__version__),
            fmi=self.version,
            platforms=escape(self.platforms),
            facts=facts,
            variables=listed,
        )


def facts_of(tables: Tables) -> tuple[tuple[str, str], ...]:
    """Return the settings that were chosen when an FMU was created and can no longer be changed: name and value."""
    body = tables.plant
    water = cast(lc.Water, body.environment)
    return (
        (
            "robot",
            f"{body.robot.name}: its links, sections, masses, joints, fin and other effectors",
        ),
        ("joints", extensions.name_of(type(body.joints))),
        ("inputs", tables.inputs),
        ("drag", water.drag.words),
        ("form of the added mass", water.added_mass_form),
        ("rotational loads", water.rotational),
        ("trailing edge", water.trailing_edge),
        ("friction taper", f"{water.friction_taper:g}"),
        *([("current", water.current_words)] if water.flow else []),
        ("depth", "far below the surface" if water.depth is None else f"{water.depth:g} m"),
    )


def _add_units(root: Element, variables: Sequence[Variable]) -> None:
    used = {variable.unit for variable in variables}
    definitions = SubElement(root, "UnitDefinitions")
    for name, exponents in ((name, UNITS[name]) for name in UNITS if name in used):
        unit = SubElement(definitions, "Unit", name=name)
        base = {
            key: str(value)
            for key, value in zip(("kg", "m", "s", "rad"), exponents, strict=True)
            if value
        }
        SubElement(unit, "BaseUnit", base)
        if name in DEGREES:
            SubElement(unit, "DisplayUnit", name=DEGREES[name], factor=repr(180.0 / math.pi))


def _add_variable(listed: Element, reference: int, variable: Variable, is_old: bool) -> None:
    named = {
        "name": variable.name,
        "valueReference": str(reference),
        "description": variable.description,
        "causality": variable.causality,
        "variability": VARIABILITY[variable.causality],
    }
    facts = {
        "unit": variable.unit if variable.unit in UNITS else "",
        "displayUnit": DEGREES.get(variable.unit, ""),
    }
    if variable.causality in ("parameter", "input"):
        ends = {"min": variable.least, "max": variable.most, "start": variable.start}
        facts |= {name: repr(end) for name, end in ends.items() if math.isfinite(end)}
    facts = {name: fact for name, fact in facts.items() if fact}
    if is_old:
        SubElement(SubElement(listed, "ScalarVariable", named), "Real", facts)
    else:
        SubElement(listed, "Float64", named | facts)


def _row(variable: Variable) -> str:
    start = f"{variable.start:.6g}" if variable.causality in ("parameter", "input") else ""
    unit = "-" if variable.unit == "1" else variable.unit
    cells = (variable.name, variable.causality, variable.symbol, unit, start, variable.description)
    return "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in cells) + "</tr>"
