"""`laticauda robots`: the available robots, environments and parameters."""

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from laticauda import robot
from laticauda.cli import command, flags, tables
from laticauda.robot import Ground, Parameters, Robot, Water, files, parameters
from laticauda.scenarios import check_described
from laticauda.values import BadArgument, check_choice, option, value_class
from laticauda.water.fluid import Flow


@dataclass(frozen=True)
class PresetKind:
    """A kind of preset."""

    list_names: Callable[[], Sequence[str]]
    load: Callable[[str], Any]
    """Function that loads the preset of a name."""


KINDS = {
    "robots": PresetKind(robot.robot_names, robot.load_robot),
    "waters": PresetKind(robot.water_names, robot.load_water),
    "grounds": PresetKind(robot.ground_names, robot.load_ground),
    "currents": PresetKind(robot.current_names, robot.load_current),
    "parameters": PresetKind(robot.parameter_names, robot.load_parameters),
}
"""All kinds of presets, by name."""
WATER_FACTS = ("tangential_friction", "normal_drag", "added_mass", "added_mass_form", "drag")
GROUND_FACTS = ("friction", "tangential", "normal")


@value_class
class Robots(command.Command):
    """List the robots, waters, grounds, currents and parameters that come with laticauda, or show one of them.

    For example: laticauda robots mamba --toml
    """

    name: flags.PresetArgument = option(
        "A preset of any kind, or a TOML file; all if omitted", default=None
    )
    toml: bool = option("Print its TOML file, to be edited and used", default=False)

    def run(self) -> command.Outcome:
        """Load and describe."""
        if self.toml and self.json:
            raise BadArgument("toml", "must not be given together with --json")
        if self.name is not None:
            preset = _load(self.name)
            if isinstance(preset, Robot):
                check_described(preset)
            return self._describe(preset)
        if self.toml:
            raise BadArgument("toml", "must be given with the NAME to print")
        return self._list_all()

    def _list_all(self) -> command.Outcome:
        facts: dict[str, Any] = {name: list(kind.list_names()) for name, kind in KINDS.items()}
        facts["robots"] = _summaries_of_robots()
        text = "" if self.json else _tables_of_all()
        return command.Outcome(facts=facts, text=text)

    def _describe(self, preset: Any) -> command.Outcome:
        is_parameters = isinstance(preset, Parameters)
        toml = preset.to_toml() if is_parameters else robot.to_toml(preset)
        facts = tomllib.loads(toml)
        if isinstance(preset, Robot):
            facts |= robot.summarize_robot(preset)  # these take precedence
        if self.toml or is_parameters:
            return command.Outcome(facts=facts, text=toml.rstrip())
        return command.Outcome(facts=facts, text=robot.describe(preset))


def _load(name: str) -> Robot | Water | Ground | Flow | Parameters:
    """Return the preset of that name, of any kind, or the contents of a file."""
    all_names: list[str] = []
    for kind in KINDS.values():
        names = kind.list_names()
        if name in names:
            return kind.load(name)
        all_names += names
    if not name.endswith(".toml"):
        return robot.load_robot(check_choice("name", name, all_names))
    path = Path(name)
    if files.read_table(path).get("kind") == parameters.KIND:
        return robot.load_parameters(name)
    return robot.from_toml(path)


def _tables_of_all() -> str:
    textbook_row = {"water": robot.TEXTBOOK, **dict.fromkeys(WATER_FACTS, "of the robot")}
    return "\n\n".join([
        _table_of_robots(_summaries_of_robots()),
        tables.format_table([*_rows_of("water", WATER_FACTS), textbook_row]),
        tables.format_table(_rows_of("ground", GROUND_FACTS)),
        tables.format_table(_rows_of_currents()),
        tables.format_table(_rows_of_parameters()),
    ])  # fmt: skip


def _summaries_of_robots() -> list[dict[str, Any]]:
    return [robot.summarize_robot(robot.load_robot(name)) for name in robot.robot_names()]


def _table_of_robots(summaries: Sequence[Mapping[str, Any]]) -> str:
    rows = [("name", "links", "joints", "length [m]", "mass [kg]", "fin", "description")]
    for summary in summaries:
        row = (
            summary["name"],
            str(summary["n_links"]),
            str(summary["n_joints"]),
            f"{summary['length']:.2f}",
            f"{summary['mass']:.2f}",
            "yes" if summary["caudal_fin"] else "no",
            summary["description"],
        )
        rows.append(row)
    return tables.align_columns(rows, right=(1, 2, 3, 4))


def _rows_of_currents() -> list[dict[str, str]]:
    return [
        {"current": name, "of": robot.load_current(name).words} for name in robot.current_names()
    ]


def _rows_of_parameters() -> list[dict[str, str]]:
    return [
        {"parameters": name, "title": robot.load_parameters(name).title}
        for name in robot.parameter_names()
    ]


def _rows_of(kind: str, facts: Sequence[str]) -> list[dict[str, str]]:
    """Return a row per water or ground, with these facts from its description."""
    presets = KINDS[f"{kind}s"]
    rows: list[dict[str, str]] = []
    for name in presets.list_names():
        coefficients = robot.describe_coefficients(presets.load(name))
        row = {kind: name}
        for fact in facts:
            row[fact] = coefficients[fact]
        rows.append(row)
    return rows
