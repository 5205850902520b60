"""Scenarios and experiments as text with every number, from which equal ones are restored.

A law or controller named in a text but not defined here is kept as a stand-in: its trial loads, and
only running it again is rejected. Nothing that a text names is imported. Experiments are stored as
text in the same way.
"""

import warnings
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any, cast

from laticauda import robot
from laticauda.motion import gaits
from laticauda.scenarios.interfaces import Controller
from laticauda.scenarios.scenario import Experiment, Scenario
from laticauda.values import RobotFileError, codec, extensions, files, quantities
from laticauda.water.fluid import Grid

KINDS: dict[str, type[Scenario] | type[Experiment]] = {
    "scenario": Scenario,
    "experiment": Experiment,
}
"""What a text may hold, by the name in it."""
PLAIN = frozenset((float, int, bool, str, tuple, type(None)))
"""Types of values that are nobody's stand-in; most fields of a robot are of one."""
MOTION_KEYS = ("gait", "controller")
"""Keys of which one holds the motion of a scenario."""


def run_to_toml(run: Scenario | Experiment) -> str:
    """Convert a scenario or experiment to text, from which `run_from_toml` restores an equal one.

    A function in it, such as a law that is not a class, cannot be stored: only its name is, with a
    warning.

    Args:
        run: The scenario or experiment.
    """
    import tomli_w

    kind = type(run)
    hints = quantities.hints_of(kind)
    table = codec.stamped(extensions.name_of(kind), {})
    for field in fields(run):
        value = getattr(run, field.name)
        if isinstance(value, robot.Robot | robot.Water | robot.Ground):
            table[field.name] = codec.stamped(extensions.name_of(type(value)), codec.encode(value))
        elif field.name == "motion" and isinstance(value, Controller):
            table["controller"] = _encode_controller(cast("Controller[Any]", value))
        elif field.name == "motion":
            table["gait"] = codec.encode(value, hints["motion"])
        elif value is not None:
            table[field.name] = codec.encode(value, hints[field.name])
    return tomli_w.dumps(_without_functions(table, ""))


def run_from_toml(text: str) -> Scenario | Experiment:
    """Restore the scenario or experiment from a text made by `run_to_toml`.

    Args:
        text: The TOML text.

    Raises:
        BadKey: If a key is unknown, missing or out of range.
        RobotFileError: If robot or environment is wrong, or the text is not TOML, or is nested too
            deeply.
    """
    return run_from_table(files.parse_toml(text, "scenario", RobotFileError))


def run_from_table(table: codec.Table) -> Scenario | Experiment:
    """Restore a scenario or experiment from the parsed text.

    Args:
        table: Table as returned by a TOML reader.
    """
    table = dict(table)
    kind = KINDS[codec.take_kind(table, *KINDS)]
    hints = quantities.hints_of(kind)
    keys = [name for name in hints if name != "motion"]
    if kind is Scenario:
        keys += MOTION_KEYS
    codec.check_keys(table, keys)
    for name in ("robot", "environment"):
        if name not in table:
            raise codec.BadKey(name, f"is missing; every {kind.__name__} needs it")
    with codec.keeping_unknown(), codec.arguments_of(""):
        values: codec.Table = {}
        if kind is Scenario:
            values["motion"] = motion_of(table)
        for name, value in table.items():
            if name in ("robot", "environment"):
                values[name] = load_described(value)
            elif name in hints:
                default = kind.__dataclass_fields__[name].default
                values[name] = codec.decode(hints[name], value, name, default)
        return kind(**values)


def unknown_in(owner: object) -> Iterator[extensions.Unknown]:
    """Yield the stand-ins in a scenario, or in a part of it, for what is not defined here.

    Args:
        owner: The scenario.
    """
    if isinstance(owner, extensions.Unknown):
        yield owner
    elif is_dataclass(owner):
        for value in vars(owner).values():
            if type(value) not in PLAIN:
                yield from unknown_in(value)


def _encode_controller(controller: Controller[Any]) -> Any:
    """Return a controller as a table; of one that is no dataclass, its kind and its gait."""
    if is_dataclass(controller) or isinstance(controller, extensions.Unknown):
        return codec.encode(controller, Controller)
    return {
        "kind": extensions.name_of(type(controller)),
        "gait": codec.encode(cast(Any, controller).gait),
    }


def motion_of(table: Mapping[str, Any]) -> gaits.Gait | Controller[Any]:
    """Return the gait or the controller in a table; an undefined controller is kept as a stand-in with its gait.

    Args:
        table: Table of a scenario.

    Raises:
        BadKey: If neither is given, or it is wrong.
    """
    if ("gait" in table) == ("controller" in table):
        raise codec.BadKey("gait", "must be given, or `controller`, but not both")
    if "gait" in table:
        return codec.decode(gaits.Gait, table["gait"], "gait")
    with codec.keeping_unknown():
        controller: Any = codec.decode(cast(Any, Controller), table["controller"], "controller")
    if isinstance(controller, extensions.Unknown):
        gait = codec.decode(gaits.Gait, controller.table.get("gait"), "controller.gait")
        vars(controller)["gait"] = gait
    return cast("Controller[Any]", controller)


def load_described(description: Any) -> Any:
    """Return the robot, water or ground described by a table; anything else is returned unchanged.

    Args:
        description: The table, including its kind.

    Raises:
        ValueError: If anything in it is wrong.
    """
    import tomli_w

    if is_dataclass(description):
        return description
    try:
        return robot.from_toml(tomli_w.dumps(description))
    except RobotFileError as error:
        raise ValueError(str(error).removeprefix("<text>: ")) from error


def _without_functions(table: Mapping[str, Any], prefix: str) -> codec.Table:
    """Return the table with functions replaced by their names, as kinds that do not exist."""
    storable: codec.Table = {}
    for name, value in table.items():
        if isinstance(value, Mapping):
            inner = cast("Mapping[str, Any]", value)
            storable[name] = _without_functions(inner, f"{prefix}{name}.")
        elif callable(value) or isinstance(value, Grid):
            description = "Dataset in memory"
            if callable(value):
                description = f"function {getattr(value, '__name__', value)}"
            text = f"`{prefix}{name}` is a {description}, which cannot be stored, so the run cannot be repeated."
            warnings.warn(f"{text} Use a law that is a class, or a file.", stacklevel=2)
            return {"kind": description}
        elif value is not None:
            storable[name] = value
    return storable
