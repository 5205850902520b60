"""What an FMU says about itself: `modelDescription.xml` for programs, and a page for people."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from string import Template
from typing import cast
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import laticauda as lc
from laticauda import extensions
from laticauda.cosim.native.tables import Tables
from laticauda.cosim.native.variables import Variable
from laticauda.packaging import __version__

# Name, exponents of kg, m, s and rad.
UNITS = {
    "1": (0, 0, 0, 0),
    "rad": (0, 0, 0, 1),
    "rad/s": (0, 0, -1, 1),
    "m": (0, 1, 0, 0),
    "m/s": (0, 1, -1, 0),
    "s": (0, 0, 1, 0),
    "kg/m3": (1, -3, 0, 0),
    "N.m": (1, 2, -2, 0),
    "N.m2": (1, 3, -2, 0),
    "W": (1, 2, -3, 0),
    "J": (1, 2, -2, 0),
}
DEGREES = {"rad": "deg", "rad/s": "deg/s"}
DURATION, INTERVAL = 30.0, 0.05  # of the default experiment [s]
VERSIONS = ("2.0", "3.0")
PAGE = Path(__file__).with_name("page.html")
VARIABILITY = {"independent": "continuous", "parameter": "fixed", "input": "continuous", "output": "continuous"}


@dataclass(frozen=True, kw_only=True)
class Description:
    """One FMU in words."""

    identifier: str
    """Name of the binary, and of the model [-]."""
    tables: Tables
    """What swims, and its variables."""
    platforms: str
    """Processors and systems that it has a binary for [-]."""
    imprint: Mapping[str, str | None]
    """Author, version, license and the like, by the names of their attributes; empty ones are left out [-]."""
    version: str
    """Of FMI: 2.0 or 3.0 [-]."""

    def model_description(self, guid: str = "", date: str = "") -> bytes:
        """The file modelDescription.xml.

        Args:
            guid: What tells this FMU from others.
            date: When it was made.
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
            generationTool=f"laticauda {__version__}",
            variableNamingConvention="structured",
        )
        state = "FMUstate" if is_old else "FMUState"
        # What is left out, FMI takes as false.
        can = ("canHandleVariableCommunicationStepSize", f"canGetAndSet{state}", f"canSerialize{state}")
        SubElement(root, "CoSimulation", {"modelIdentifier": self.identifier, **dict.fromkeys(can, "true")})
        _add_units(root, self.tables.variables)
        categories = SubElement(root, "LogCategories")
        SubElement(categories, "Category", name="logStatusError", description="What was refused, and why.")
        SubElement(root, "DefaultExperiment", startTime="0.0", stopTime=str(DURATION), stepSize=str(INTERVAL))
        listed = SubElement(root, "ModelVariables")
        for reference, variable in enumerate(self.tables.variables):
            _add_variable(listed, reference, variable, is_old)
        structure = SubElement(root, "ModelStructure")
        outputs = [i for i, variable in enumerate(self.tables.variables) if variable.causality == "output"]
        # Outputs are those of the end of the last step, so no input acts on them before the next one.
        for kind, more in (("Output", {"dependencies": ""}), ("InitialUnknown", {})):
            group = SubElement(structure, f"{kind}s") if is_old else structure
            for i in outputs:
                place = {"index": str(i + 1)} if is_old else {"valueReference": str(i)}
                SubElement(group, "Unknown" if is_old else kind, {**place, **more})
        indent(root)
        return tostring(root, encoding="UTF-8", xml_declaration=True) + b"\n"

    def page(self) -> str:
        """The file documentation/index.html."""
        facts = "\n".join(
            f"<tr><th>{escape(name)}</th><td>{escape(value)}</td></tr>" for name, value in facts_of(self.tables)
        )
        listed = "\n".join(_row(variable) for variable in self.tables.variables)
        return Template(PAGE.read_text(encoding="utf-8")).substitute(
            title=escape(self.identifier),
            robot=escape(self.tables.words),
            version=escape(__version__),
            fmi=self.version,
            platforms=escape(self.platforms),
            facts=facts,
            variables=listed,
        )


def facts_of(tables: Tables) -> tuple[tuple[str, str], ...]:
    """What was chosen when an FMU was made, and cannot be changed any more: name and value."""
    body = tables.plant
    water = cast(lc.Water, body.environment)
    return (
        ("robot", f"{body.robot.name}: its links, sections, masses, joints, fin and other effectors"),
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
        base = {key: str(value) for key, value in zip(("kg", "m", "s", "rad"), exponents, strict=True) if value}
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
    facts = {"unit": variable.unit if variable.unit in UNITS else "", "displayUnit": DEGREES.get(variable.unit, "")}
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
