"""HTML page of an FMU: what it is, what cannot be changed, and its variables, for people."""

from collections.abc import Sequence
from html import escape
from pathlib import Path
from string import Template
from typing import NamedTuple, cast

import laticauda as lc
from laticauda.connect.fmu.model_description import Description
from laticauda.connect.native.platforms import Platform
from laticauda.connect.native.tables import Tables
from laticauda.connect.native.variable import Variable
from laticauda.values import extensions

TEMPLATE = Path(__file__).parent / "page.html"


class FixedSetting(NamedTuple):
    """A setting that was chosen when an FMU was created and can no longer be changed."""

    name: str
    """Name of the setting [-]."""
    value: str
    """Its value as text [-]."""


def write_documentation(description: Description, platforms: Sequence[Platform]) -> str:
    """Return the content of documentation/index.html.

    Args:
        description: The FMU.
        platforms: Platforms for which it has a binary.
    """
    tables = description.tables
    settings = [_write_setting(setting) for setting in list_fixed_settings(tables)]
    variables = [_write_variable(variable) for variable in tables.variables]
    pairs = ", ".join(platform.pair for platform in platforms)
    template = Template(TEMPLATE.read_text(encoding="utf-8"))
    return template.substitute(
        title=escape(description.identifier),
        robot=escape(tables.description),
        version=escape(lc.__version__),
        fmi=description.fmi_version,
        platforms=escape(pairs),
        facts="\n".join(settings),
        variables="\n".join(variables),
    )


def list_fixed_settings(tables: Tables) -> list[FixedSetting]:
    """Return the settings that were chosen when an FMU was created and can no longer be changed.

    Args:
        tables: The robot and its variables.
    """
    plant = tables.plant
    water = cast(lc.Water, plant.environment)
    robot = f"{plant.robot.name}: number of links, fin, other effectors, and what is no parameter"
    depth = "far below the surface"
    if water.depth is not None:
        depth = f"{water.depth:g} m"
    settings = [
        FixedSetting("robot", robot),
        FixedSetting("joints", extensions.name_of(type(plant.joints))),
        FixedSetting("inputs", tables.inputs),
        FixedSetting("drag", water.drag.words),
        FixedSetting("form of the added mass", water.added_mass_form),
        FixedSetting("rotational loads", water.rotational),
        FixedSetting("trailing edge", water.trailing_edge),
        FixedSetting("plate drag", f"{water.plate_drag}"),
        FixedSetting("plate added mass", f"{water.plate_added_mass}"),
        FixedSetting("edge clip", f"{water.edge_clip}"),
        FixedSetting("friction taper", f"{water.friction_taper:g}"),
    ]
    if water.flow:
        settings.append(FixedSetting("current", water.current_words))
    settings.append(FixedSetting("depth", depth))
    return settings


def _write_setting(setting: FixedSetting) -> str:
    return f"<tr><th>{escape(setting.name)}</th><td>{escape(setting.value)}</td></tr>"


def _write_variable(variable: Variable) -> str:
    start = ""
    if variable.is_settable:
        start = f"{variable.start:.6g}"
    texts = (
        variable.name,
        variable.causality,
        variable.symbol,
        variable.shown_unit,
        start,
        variable.description,
    )
    cells = [f"<td>{escape(text)}</td>" for text in texts]
    return f"<tr>{''.join(cells)}</tr>"
