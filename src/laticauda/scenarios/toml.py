"""Scenarios as TOML: files that people write, using names where possible; trials store them with every number.

    kind = "scenario"
    robot = "mamba"              # a preset or a file, or a table; optionally with `n_links`
    water = "paper-lateral"      # a preset, file or table; or `ground` or `parameters`; default: textbook's or Mamba's
    duration = 20.0

    [gait]                       # or [controller]
    amplitude_deg = 30
    frequency_deg_s = 130
    phase_shift_deg = 40
    recorded = "angles.csv"      # or a table of `time` and `angle_deg`; the numbers above are then optional

    [model]
    kind = "spatial"
    joints = "servo"

A water or ground may be a table that changes a few numbers of another one: ``extends =
"paper-eel"``.

A law or controller named in a text but not defined here is kept as a stand-in: its trial loads, and
only running it again is rejected. Nothing that a text names is imported. Experiments are stored as
text in the same way.
"""

import warnings
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, cast

from laticauda import robot
from laticauda.motion import gaits
from laticauda.scenarios import building
from laticauda.scenarios.interfaces import Controller
from laticauda.scenarios.scenario import Experiment, Scenario
from laticauda.values import codec, extensions, files, quantities
from laticauda.values.errors import RobotFileError
from laticauda.water.fluid.gridded import Grid

NAMES = ("robot", "n_links", "water", "ground", "parameters")


def load_scenario(path: str | Path) -> Scenario:
    """Load a scenario from a file.

    Args:
        path: Path of the TOML file; paths in the file are relative to its folder.

    Raises:
        RobotFileError: If the file cannot be read, or anything in it is wrong; the message gives
            the file, the key, the rule and the value.
    """
    with codec.keys_of(path, RobotFileError):
        return scenario_from_table(files.read_toml(path, RobotFileError), Path(path).parent)


def save_scenario(scenario: Scenario, path: str | Path) -> None:
    """Write a scenario with all its numbers, for `load_scenario`.

    Args:
        scenario: The scenario to write.
        path: Path of the TOML file; an existing file is replaced.

    Raises:
        StorageFailed: If the file cannot be written.
    """
    files.write(path, run_to_toml(scenario))


def scenario_from_table(table: codec.Table, folder: Path | None = None) -> Scenario:
    """Return the scenario described by a table from a file or a message.

    Args:
        table: Table as returned by a TOML or JSON reader.
        folder: Base folder of relative paths; None for the working directory.

    Raises:
        BadKey: If a key is unknown, missing or out of range.
    """
    table = dict(table)
    if isinstance(table.get("gait"), Mapping) and "recorded" in table["gait"]:
        table["gait"] = _with_recorded(table["gait"], folder)
    motion = motion_of(table)
    gait = motion if isinstance(motion, gaits.Gait) else motion.gait
    has_parameters = "parameters" in table
    chosen = take_chosen(table, gait, folder)
    table.setdefault("robot", chosen.robot)
    places = [
        name for name in ("water", "ground", "environment") if isinstance(table.get(name), Mapping)
    ]
    if len(places) > 1:
        raise codec.BadKey(places[1], f"must not be given together with `{places[0]}`")
    where = (
        {"kind": places[0], **table[places[0]]} if places and places[0] != "environment" else None
    )
    if where is not None and "current" in where:
        where["current"] = robot.current_of(where["current"], folder)
    table.setdefault("environment", chosen.environment if where is None else where)
    for name in NAMES[1:]:
        table.pop(name, None)
    model: Any = table.get("model", {})
    model = {"kind": model} if isinstance(model, str) else dict(model)
    if has_parameters:
        model.setdefault("joints", chosen.model.joints)
    table["model"] = {"kind": "planar", **model}
    found = run_from_table(table)
    if not isinstance(found, Scenario):
        raise codec.BadKey("kind", 'must be "scenario" here')
    return found


def take_chosen(table: codec.Table, gait: gaits.Gait, folder: Path | None) -> building.Chosen:
    """Remove the entries `NAMES` from a table, and return what they stand for.

    Args:
        table: Table of a file; tables in place of names stay in it, that of a robot converted to
            the robot.
        gait: Determines the water, if none is named.
        folder: Folder in which named files are searched for first, before the working directory.

    Raises:
        BadKey: If a name is unknown, or names are incompatible.
    """
    named = {
        name: table.pop(name)
        for name in NAMES
        if name in table and not isinstance(table[name], Mapping)
    }
    for name, one in named.items():
        if (
            isinstance(one, str)
            and one.endswith(".toml")
            and folder is not None
            and (folder / one).is_file()
        ):
            named[name] = str(folder / one)
    with codec.arguments_of(""):
        if "robot" in table:
            table["robot"] = described(table["robot"])
        own: robot.Robot | None = table.get("robot")
        return building.Choice(**named).resolved(
            gait, lambda name, n: own or robot.load_robot(name, n)
        )


def _with_recorded(table: codec.Table, folder: Path | None) -> codec.Table:
    """Return a gait's table with its recorded joint angles loaded; omitted fields are taken from the recording."""
    given = table["recorded"]
    if isinstance(given, str):
        with codec.arguments_of("gait.recorded"):
            angles = robot.load_joint_angles(given, folder)
    else:
        angles = codec.decode(gaits.JointAngles, given, "gait.recorded")
    usual = {"amplitude": 0.0, "frequency": angles.frequency, "phase_shift": 0.0}
    left = {
        name: one
        for name, one in usual.items()
        if not any(key.startswith(name + "_deg") for key in table)
    }
    return {**left, **table, "recorded": angles}


KINDS: dict[str, type[Scenario] | type[Experiment]] = {
    "scenario": Scenario,
    "experiment": Experiment,
}


def run_to_toml(run: Scenario | Experiment) -> str:
    """Convert a scenario or experiment to text, from which `run_from_toml` restores an equal one.

    A function in it, such as a law that is not a class, cannot be stored: only its name is, with a
    warning.

    Args:
        run: The scenario or experiment.
    """
    import tomli_w

    table = codec.stamped(extensions.name_of(type(run)), {})
    for field in fields(run):
        value, hint = getattr(run, field.name), quantities.hints_of(type(run))[field.name]
        if isinstance(value, robot.Robot | robot.Water | robot.Ground):
            table[field.name] = codec.stamped(extensions.name_of(type(value)), codec.encode(value))
        elif field.name == "motion" and isinstance(value, Controller):
            table["controller"] = _stored(cast("Controller[Any]", value))
        elif value is not None:
            table["gait" if field.name == "motion" else field.name] = codec.encode(value, hint)
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
    motion = {"gait", "controller"} if kind is Scenario else set[str]()
    codec.check_keys(table, [*(name for name in hints if name != "motion"), *motion])
    for name in ("robot", "environment"):
        if name not in table:
            raise codec.BadKey(name, f"is missing; every {kind.__name__} needs it")
    with codec.keeping_unknown(), codec.arguments_of(""):
        values: codec.Table = {"motion": motion_of(table)} if motion else {}
        for name, given in table.items():
            if name in ("robot", "environment"):
                values[name] = described(given)
            elif name not in motion:
                values[name] = codec.decode(
                    hints[name], given, name, kind.__dataclass_fields__[name].default
                )
        return kind(**values)


def unknown_in(thing: object) -> Iterator[extensions.Unknown]:
    """Yield the names in a scenario, or in a part of it, that are not defined here.

    Args:
        thing: The scenario.
    """
    if isinstance(thing, extensions.Unknown):
        yield thing
    elif is_dataclass(thing):
        for part in vars(thing).values():
            yield from unknown_in(part)


def _stored(controller: Controller[Any]) -> Any:
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
        vars(controller)["gait"] = codec.decode(
            gaits.Gait, controller.table.get("gait"), "controller.gait"
        )
    return cast("Controller[Any]", controller)


def described(given: Any) -> Any:
    """Return the robot, water or ground described by a table; anything else is returned unchanged.

    Args:
        given: The table, including its kind.

    Raises:
        ValueError: If anything in it is wrong.
    """
    import tomli_w

    if is_dataclass(given):
        return given
    try:
        return robot.from_toml(tomli_w.dumps(given))
    except RobotFileError as error:
        raise ValueError(str(error).removeprefix("<text>: ")) from error


def _without_functions(table: Mapping[str, Any], at: str) -> codec.Table:
    """Return the table with functions replaced by their names, as kinds that do not exist."""
    found: codec.Table = {}
    for name, value in table.items():
        if isinstance(value, Mapping):
            found[name] = _without_functions(cast("Mapping[str, Any]", value), f"{at}{name}.")
        elif callable(value) or isinstance(value, Grid):
            called = (
                f"function {getattr(value, '__name__', value)}"
                if callable(value)
                else "Dataset in memory"
            )
            text = f"`{at}{name}` is a {called}, which cannot be stored, so the run cannot be repeated."
            warnings.warn(f"{text} Use a law that is a class, or a file.", stacklevel=2)
            return {"kind": called}
        elif value is not None:
            found[name] = value
    return found
