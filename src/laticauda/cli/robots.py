"""`laticauda robots`: the available robots, environments and parameters."""

import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from laticauda import robot
from laticauda.cli import command, flags, tables
from laticauda.robot import Ground, Parameters, Robot, Water, files, parameters
from laticauda.values.checks import check_choice
from laticauda.values.errors import BadArgument
from laticauda.values.quantities import option, value_class
from laticauda.water.fluid.flow import Flow

KINDS: dict[str, tuple[Callable[[], Sequence[str]], Callable[[str], Any]]] = {
    "robots": (robot.robot_names, robot.load_robot),
    "waters": (robot.water_names, robot.load_water),
    "grounds": (robot.ground_names, robot.load_ground),
    "currents": (robot.current_names, robot.load_current),
    "parameters": (robot.parameter_names, robot.load_parameters),
}
"""By kind of preset: the function that lists the names, and the one that loads a name."""
WATER_FACTS = ("tangential_friction", "normal_drag", "added_mass", "added_mass_form", "drag")
GROUND_FACTS = ("friction", "tangential", "normal")


@value_class
class Robots(command.Command):
    """List the robots, waters, grounds, currents and parameters that come with laticauda, or show one of them.

    For example: laticauda robots mamba --toml
    """

    name: flags.Preset = option(
        "A preset of any kind, or a TOML file; all if omitted", default=None
    )
    toml: bool = option("Print its TOML file, to be edited and used", default=False)

    def run(self) -> command.Outcome:
        """Load and describe."""
        if self.toml and self.json:
            raise BadArgument("toml", "must not be given together with --json")
        if self.name is None:
            if self.toml:
                raise BadArgument("toml", "must be given with the NAME to print")
            every = {kind: list(names()) for kind, (names, _) in KINDS.items()} | {
                "robots": _summaries()
            }
            return command.Outcome(facts=every, text="" if self.json else _lists())
        thing = _named(self.name)
        toml = thing.to_toml() if isinstance(thing, Parameters) else robot.to_toml(thing)
        facts = robot.summarize_robot(thing) if isinstance(thing, Robot) else {}
        return command.Outcome(
            facts={
                **tomllib.loads(toml),
                **facts,
            },  # all fields as in its TOML file; the main facts take precedence
            text=toml.rstrip()
            if self.toml or isinstance(thing, Parameters)
            else robot.describe(thing),
        )


def _named(name: str) -> Robot | Water | Ground | Flow | Parameters:
    """Return the preset of that name, of any kind, or the contents of a file."""
    for names, load in KINDS.values():
        if name in names():
            return load(name)
    if name.endswith(".toml"):
        is_parameters = files.read_table(Path(name)).get("kind") == parameters.KIND
        return robot.load_parameters(name) if is_parameters else robot.from_toml(Path(name))
    return robot.load_robot(
        check_choice("name", name, [one for names, _ in KINDS.values() for one in names()])
    )


def _lists() -> str:
    titles = [
        {"parameters": name, "title": robot.load_parameters(name).title}
        for name in robot.parameter_names()
    ]
    book = {"water": robot.TEXTBOOK, **dict.fromkeys(WATER_FACTS, "of the robot")}
    return "\n\n".join([
        _robots(_summaries()),
        tables.format_table([*_rows("water", WATER_FACTS), book]),
        tables.format_table(_rows("ground", GROUND_FACTS)),
        tables.format_table(_currents()),
        tables.format_table(titles),
    ])  # fmt: skip


def _summaries() -> list[dict[str, Any]]:
    return [robot.summarize_robot(robot.load_robot(name)) for name in robot.robot_names()]


def _robots(summaries: Sequence[Mapping[str, Any]]) -> str:
    rows = [("name", "links", "joints", "length [m]", "mass [kg]", "fin", "description")]
    for one in summaries:
        n_links, n_joints, fin = (
            str(one["n_links"]),
            str(one["n_joints"]),
            "yes" if one["caudal_fin"] else "no",
        )
        size = f"{one['length']:.2f}", f"{one['mass']:.2f}"
        rows.append((one["name"], n_links, n_joints, *size, fin, one["description"]))
    return tables.aligned(rows, right=(1, 2, 3, 4))


def _currents() -> list[dict[str, str]]:
    """Return a row per current preset: its name and what it is."""
    return [
        {"current": name, "of": robot.load_current(name).words} for name in robot.current_names()
    ]


def _rows(kind: str, facts: Sequence[str]) -> list[dict[str, str]]:
    """Return a row per water or ground, with these facts from its description."""
    names, load = KINDS[f"{kind}s"]
    found = {name: robot.describe_coefficients(load(name)) for name in names()}
    return [{kind: name, **{fact: one[fact] for fact in facts}} for name, one in found.items()]
