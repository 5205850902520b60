"""modelDescription.xml of an FMU: what it can do, and its variables, for other programs."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import laticauda as lc
from laticauda.connect.fmu.units import DEGREES_PER_RADIAN, UNITS, Unit
from laticauda.connect.native.tables import Tables
from laticauda.connect.native.variable import Variable

FMI_VERSIONS = ("2.0", "3.0")
"""Versions of the standard that an FMU may follow."""
DEFAULT_DURATION = 30.0
"""Duration of the default experiment [s]."""
DEFAULT_STEP = 0.05
"""Communication step of the default experiment [s]."""
VARIABILITY = {
    "independent": "continuous",
    "parameter": "fixed",
    "input": "continuous",
    "output": "continuous",
}
"""When the values of variables may change, by causality."""


@dataclass(frozen=True, kw_only=True)
class Description:
    """Description of one FMU."""

    identifier: str
    """Name of the binary and of the model [-]."""
    tables: Tables
    """Tables of the robot, and its variables."""
    imprint: Mapping[str, str | None]
    """Author, version, license and so on, by attribute name; empty ones are omitted [-]."""
    fmi_version: str
    """FMI version: 2.0 or 3.0 [-]."""

    @property
    def is_fmi2(self) -> bool:
        """Whether names and structure are those of FMI 2."""
        return self.fmi_version == "2.0"


def write_model_description(description: Description, guid: str = "", date: str = "") -> bytes:
    """Return the content of modelDescription.xml.

    Args:
        description: What is described.
        guid: Identifier that distinguishes this FMU from others.
        date: Date and time of creation.
    """
    root = Element(
        "fmiModelDescription",
        _root_attributes(description, guid, date),
        description=f"{description.tables.description} Kernels of laticauda as machine code; needs no Python.",
        generationTool=f"laticauda {lc.__version__}",
        variableNamingConvention="structured",
    )
    _add_capabilities(root, description)
    _add_units(root, description.tables.variables)
    _add_log_categories(root)
    _add_default_experiment(root)
    _add_variables(root, description)
    _add_structure(root, description)
    indent(root)
    return tostring(root, encoding="UTF-8", xml_declaration=True) + b"\n"


def _root_attributes(description: Description, guid: str, date: str) -> dict[str, str]:
    guid_attribute = "guid" if description.is_fmi2 else "instantiationToken"
    attributes = {
        "fmiVersion": description.fmi_version,
        "modelName": description.identifier,
        guid_attribute: guid,
    }
    imprint = {**description.imprint, "generationDateAndTime": date}
    for name, text in imprint.items():
        if text:
            attributes[name] = text
    return attributes


def _add_capabilities(root: Element, description: Description) -> None:
    """Say what an FMU can do; FMI treats omitted capabilities as false."""
    state = "FMUstate" if description.is_fmi2 else "FMUState"
    attributes = {
        "modelIdentifier": description.identifier,
        "canHandleVariableCommunicationStepSize": "true",
        f"canGetAndSet{state}": "true",
        f"canSerialize{state}": "true",
    }
    SubElement(root, "CoSimulation", attributes)


def _add_units(root: Element, variables: Sequence[Variable]) -> None:
    names_in_use = {variable.unit for variable in variables}
    definitions = SubElement(root, "UnitDefinitions")
    for unit in UNITS.values():
        if unit.name in names_in_use:
            _add_unit(definitions, unit)


def _add_unit(definitions: Element, unit: Unit) -> None:
    element = SubElement(definitions, "Unit", name=unit.name)
    exponents = {"kg": unit.kg, "m": unit.m, "s": unit.s, "rad": unit.rad}
    base_unit = {name: str(exponent) for name, exponent in exponents.items() if exponent}
    SubElement(element, "BaseUnit", base_unit)
    if unit.display_name:
        factor = repr(DEGREES_PER_RADIAN)
        SubElement(element, "DisplayUnit", name=unit.display_name, factor=factor)


def _add_log_categories(root: Element) -> None:
    categories = SubElement(root, "LogCategories")
    SubElement(
        categories,
        "Category",
        name="logStatusError",
        description="Rejected calls, with the reasons.",
    )


def _add_default_experiment(root: Element) -> None:
    SubElement(
        root,
        "DefaultExperiment",
        startTime="0.0",
        stopTime=str(DEFAULT_DURATION),
        stepSize=str(DEFAULT_STEP),
    )


def _add_variables(root: Element, description: Description) -> None:
    """Add all variables, whose numbers are their value references."""
    parent = SubElement(root, "ModelVariables")
    for number, variable in enumerate(description.tables.variables):
        attributes = {
            "name": variable.name,
            "valueReference": str(number),
            "description": variable.description,
            "causality": variable.causality,
            "variability": VARIABILITY[variable.causality],
        }
        type_attributes = _type_attributes(variable)
        if description.is_fmi2:
            element = SubElement(parent, "ScalarVariable", attributes)
            SubElement(element, "Real", type_attributes)
        else:
            SubElement(parent, "Float64", attributes | type_attributes)


def _type_attributes(variable: Variable) -> dict[str, str]:
    """Return unit, range and start value of a variable, as far as it has them."""
    attributes: dict[str, str] = {}
    unit = UNITS.get(variable.unit)
    if unit is not None:
        attributes["unit"] = unit.name
        if unit.display_name:
            attributes["displayUnit"] = unit.display_name
    if not variable.is_settable:
        return attributes
    numbers = {"min": variable.least, "max": variable.most, "start": variable.start}
    for name, number in numbers.items():
        if math.isfinite(number):
            attributes[name] = repr(number)
    return attributes


def _add_structure(root: Element, description: Description) -> None:
    """List the outputs; they are those at the end of the last step, so no input affects them before the next step."""
    structure = SubElement(root, "ModelStructure")
    outputs: list[int] = []
    for number, variable in enumerate(description.tables.variables):
        if variable.causality == "output":
            outputs.append(number)
    if description.is_fmi2:
        _add_fmi2_unknowns(SubElement(structure, "Outputs"), outputs, {"dependencies": ""})
        _add_fmi2_unknowns(SubElement(structure, "InitialUnknowns"), outputs, {})
        return
    for number in outputs:
        attributes = {"valueReference": str(number), "dependencies": ""}
        SubElement(structure, "Output", attributes)
    for number in outputs:
        SubElement(structure, "InitialUnknown", {"valueReference": str(number)})


def _add_fmi2_unknowns(
    parent: Element, outputs: Sequence[int], attributes: Mapping[str, str]
) -> None:
    """Add outputs in the way of FMI 2, which counts variables from 1 here."""
    for number in outputs:
        SubElement(parent, "Unknown", {"index": str(number + 1), **attributes})
