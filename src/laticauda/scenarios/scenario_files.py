"""Scenarios as TOML files that people write, in names where names will do.

    kind = "scenario"
    robot = "mamba"              # a preset or a file, or a table; `n_links` beside it
    water = "paper-lateral"      # likewise; or `ground`, or `parameters`; left out: the textbook's or Mamba's
    duration = 20.0

    [gait]                       # or [controller]
    amplitude_deg = 30
    frequency_deg_s = 130
    phase_shift_deg = 40
    recorded = "angles.csv"      # or a table of `time` and `angle_deg`; the numbers above may be left out then

    [model]
    kind = "spatial"
    joints = "servo"

A water or ground may be a table that changes a few numbers of another one: ``extends = "paper-eel"``.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from laticauda import files, gaits, robot
from laticauda.codec import BadKey, Table, arguments_of, decode, keys_of
from laticauda.errors import RobotFileError
from laticauda.scenarios import building, coding
from laticauda.scenarios.scenario import Scenario

NAMES = ("robot", "n_links", "water", "ground", "parameters")


def load_scenario(path: str | Path) -> Scenario:
    """The scenario in a file.

    Args:
        path: Of the TOML file; paths in it are relative to its folder.

    Raises:
        RobotFileError: If it cannot be read, or anything in it is wrong; the message has the file, the key, the rule
            and the value.
    """
    with keys_of(path, RobotFileError):
        return scenario_from_table(files.read_toml(path, RobotFileError), Path(path).parent)


def save_scenario(scenario: Scenario, path: str | Path) -> None:
    """Write a scenario with all its numbers, for `load_scenario`.

    Args:
        scenario: What to write.
        path: Of the TOML file; one that is there is replaced.

    Raises:
        StorageFailed: If it cannot be written.
    """
    files.write(path, coding.run_to_toml(scenario))


def scenario_from_table(table: Table, folder: Path | None = None) -> Scenario:
    """The scenario that a table of a file or a message says.

    Args:
        table: As a TOML or JSON reader gives it.
        folder: Where relative paths in it start; None for the working directory.

    Raises:
        BadKey: If a key is unknown, missing or out of range.
    """
    table = dict(table)
    if isinstance(table.get("gait"), Mapping) and "recorded" in table["gait"]:
        table["gait"] = _with_recorded(table["gait"], folder)
    motion = coding.motion_of(table)
    gait = motion if isinstance(motion, gaits.Gait) else motion.gait
    has_parameters = "parameters" in table
    chosen = take_chosen(table, gait, folder)
    table.setdefault("robot", chosen.robot)
    places = [name for name in ("water", "ground", "environment") if isinstance(table.get(name), Mapping)]
    if len(places) > 1:
        raise BadKey(places[1], f"must not be given beside `{places[0]}`")
    where = {"kind": places[0], **table[places[0]]} if places and places[0] != "environment" else None
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
    found = coding.run_from_table(table)
    if not isinstance(found, Scenario):
        raise BadKey("kind", 'must be "scenario" here')
    return found


def take_chosen(table: Table, gait: gaits.Gait, folder: Path | None) -> building.Chosen:
    """Take from a table what it says in `NAMES`, and say what that stands for.

    Args:
        table: Of a file; tables in it in the place of names are left there, that of a robot as the robot.
        gait: It decides on the water, if none is named.
        folder: Where files that it names are looked for first, before the working directory.

    Raises:
        BadKey: If a name is not known, or names do not go together.
    """
    named = {name: table.pop(name) for name in NAMES if name in table and not isinstance(table[name], Mapping)}
    for name, one in named.items():
        if isinstance(one, str) and one.endswith(".toml") and folder is not None and (folder / one).is_file():
            named[name] = str(folder / one)
    with arguments_of(""):
        if "robot" in table:
            table["robot"] = coding.described(table["robot"])
        own: robot.Robot | None = table.get("robot")
        return building.Choice(**named).resolved(gait, lambda name, n: own or robot.load_robot(name, n))


def _with_recorded(table: Table, folder: Path | None) -> Table:
    """The table of a gait whose joint angles are in a file, or beside it; what it leaves out is the recording's."""
    given = table["recorded"]
    if isinstance(given, str):
        with arguments_of("gait.recorded"):
            angles = robot.load_joint_angles(given, folder)
    else:
        angles = decode(gaits.JointAngles, given, "gait.recorded")
    usual = {"amplitude": 0.0, "frequency": angles.frequency, "phase_shift": 0.0}
    left = {name: one for name, one in usual.items() if not any(key.startswith(name + "_deg") for key in table)}
    return {**left, **table, "recorded": angles}
