"""What an FMU says about itself: `modelDescription.xml` for programs, and a page for people."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from string import Template
from xml.etree import ElementTree

from laticauda.cosim.fmu.variables import Variable
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
    "W": (1, 2, -3, 0),
    "J": (1, 2, -2, 0),
}
DEGREES = {"rad": "deg", "rad/s": "deg/s"}
DURATION, INTERVAL = 30.0, 0.05  # of the default experiment [s]
VERSIONS = ("2.0", "3.0")
BINARIES = {"2.0": "linux64", "3.0": "x86_64-linux"}  # folder of the library
PAGE = Path(__file__).with_name("page.html")
VARIABILITY = {"independent": "continuous", "parameter": "fixed", "input": "continuous", "output": "continuous"}


@dataclass(frozen=True, kw_only=True)
class Description:
    """One FMU in words."""

    identifier: str
    """Name of the binary, and of the model [-]."""
    robot: str
    """What swims, in words [-]."""
    facts: tuple[tuple[str, str], ...]
    """What was chosen when it was made, and cannot be changed any more: name and value [-]."""
    variables: tuple[Variable, ...]
    """In the order of their value references."""

    version: str
    """Of FMI: 2.0 or 3.0 [-]."""

    def model_description(self, guid: str) -> bytes:
        """The file modelDescription.xml.

        Args:
            guid: What tells this FMU from others.
        """
        root = ElementTree.Element(
            "fmiModelDescription",
            {"fmiVersion": self.version, "modelName": self.identifier, self._guid: guid},
            description=f"{self.robot} Kernels of laticauda as machine code; needs no Python.",
            generationTool=f"laticauda {__version__}",
            variableNamingConvention="structured",
        )
        # What is left out, FMI takes as false.
        can = ("canHandleVariableCommunicationStepSize", *self._state_functions)
        ElementTree.SubElement(root, "CoSimulation", {"modelIdentifier": self.identifier, **dict.fromkeys(can, "true")})
        _add_units(root, self.variables)
        categories = ElementTree.SubElement(root, "LogCategories")
        text = "What was refused, and why."
        ElementTree.SubElement(categories, "Category", name="logStatusError", description=text)
        ElementTree.SubElement(
            root, "DefaultExperiment", startTime="0.0", stopTime=str(DURATION), stepSize=str(INTERVAL)
        )
        listed = ElementTree.SubElement(root, "ModelVariables")
        for reference, variable in enumerate(self.variables):
            _add_variable(listed, reference, variable, self.version)
        self._add_structure(root)
        ElementTree.indent(root)
        return ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True) + b"\n"

    @property
    def _guid(self) -> str:
        return "guid" if self.version == "2.0" else "instantiationToken"

    @property
    def _state_functions(self) -> tuple[str, str]:
        state = "FMUstate" if self.version == "2.0" else "FMUState"
        return f"canGetAndSet{state}", f"canSerialize{state}"

    def _add_structure(self, root: ElementTree.Element) -> None:
        """Which variables are outputs, and what they depend on."""
        outputs = [i for i, variable in enumerate(self.variables) if variable.causality == "output"]
        structure = ElementTree.SubElement(root, "ModelStructure")
        # Outputs are those of the end of the last step, so no input acts on them before the next one.
        if self.version == "3.0":
            for i in outputs:
                ElementTree.SubElement(structure, "Output", valueReference=str(i), dependencies="")
            for i in outputs:
                ElementTree.SubElement(structure, "InitialUnknown", valueReference=str(i))
            return
        of_outputs = ElementTree.SubElement(structure, "Outputs")
        at_start = ElementTree.SubElement(structure, "InitialUnknowns")
        for i in outputs:
            ElementTree.SubElement(of_outputs, "Unknown", index=str(i + 1), dependencies="")
            ElementTree.SubElement(at_start, "Unknown", index=str(i + 1))

    def page(self) -> str:
        """The file documentation/index.html."""
        facts = "\n".join(f"<tr><th>{escape(name)}</th><td>{escape(value)}</td></tr>" for name, value in self.facts)
        listed = "\n".join(_row(variable) for variable in self.variables)
        return Template(PAGE.read_text(encoding="utf-8")).substitute(
            title=escape(self.identifier),
            robot=escape(self.robot),
            version=escape(__version__),
            fmi=self.version,
            facts=facts,
            variables=listed,
        )


def _add_units(root: ElementTree.Element, variables: Sequence[Variable]) -> None:
    used = {variable.unit for variable in variables}
    definitions = ElementTree.SubElement(root, "UnitDefinitions")
    for name, exponents in UNITS.items():
        if name not in used:
            continue
        unit = ElementTree.SubElement(definitions, "Unit", name=name)
        base = {key: str(value) for key, value in zip(("kg", "m", "s", "rad"), exponents, strict=True) if value}
        ElementTree.SubElement(unit, "BaseUnit", base)
        if name in DEGREES:
            ElementTree.SubElement(unit, "DisplayUnit", name=DEGREES[name], factor=repr(180.0 / math.pi))


def _add_variable(listed: ElementTree.Element, reference: int, variable: Variable, version: str) -> None:
    named = {
        "name": variable.name,
        "valueReference": str(reference),
        "description": variable.description,
        "causality": variable.causality,
        "variability": VARIABILITY[variable.causality],
    }
    if version == "2.0":
        real = ElementTree.SubElement(ElementTree.SubElement(listed, "ScalarVariable", named), "Real")
    else:
        real = ElementTree.SubElement(listed, "Float64", named)
    if variable.unit in UNITS:
        real.set("unit", variable.unit)
    if variable.unit in DEGREES:
        real.set("displayUnit", DEGREES[variable.unit])
    if variable.causality not in ("parameter", "input"):
        return
    if math.isfinite(variable.least):
        real.set("min", repr(variable.least))
    if math.isfinite(variable.most):
        real.set("max", repr(variable.most))
    real.set("start", repr(variable.start))


def _row(variable: Variable) -> str:
    start = f"{variable.start:.6g}" if variable.causality in ("parameter", "input") else ""
    unit = "-" if variable.unit == "1" else variable.unit
    cells = (variable.name, variable.causality, variable.symbol, unit, start, variable.description)
    return "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in cells) + "</tr>"
