"""Scenarios as files that people write, in TOML, with names of presets and files where possible.

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
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from laticauda import robot
from laticauda.motion import gaits
from laticauda.scenarios import choice, stored
from laticauda.scenarios.scenario import Scenario
from laticauda.values import RobotFileError, codec, files
from laticauda.values.packaging import renamed_names
from laticauda.values.tables import check_columns

NAMES = ("robot", "n_links", "water", "ground", "parameters")
"""Entries that choose robot and environment by name, see `laticauda.scenarios.Choice`."""
ENVIRONMENTS = ("water", "ground", "environment")
"""Entries that may hold the table of an environment."""


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
    files.write(path, stored.run_to_toml(scenario))


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
    motion = stored.motion_of(table)
    gait = motion if isinstance(motion, gaits.Gait) else motion.gait
    has_parameters = "parameters" in table
    chosen = take_chosen(table, gait, folder)
    table.setdefault("robot", chosen.robot)
    environment: Any = _environment_table(table, folder)
    if environment is None:
        environment = chosen.environment
    table.setdefault("environment", environment)
    for name in NAMES[1:]:
        table.pop(name, None)
    model: Any = table.get("model", {})
    if isinstance(model, str):
        model = {"kind": model}
    if has_parameters:
        model = {"joints": chosen.model.joints, **model}
    table["model"] = {"kind": "planar", **model}
    scenario = stored.run_from_table(table)
    if not isinstance(scenario, Scenario):
        raise codec.BadKey("kind", 'must be "scenario" here')
    return scenario


def _environment_table(table: codec.Table, folder: Path | None) -> codec.Table | None:
    """Return the table of a water or ground with its kind; None if there is none, or under `environment`."""
    names = [name for name in ENVIRONMENTS if isinstance(table.get(name), Mapping)]
    if len(names) > 1:
        raise codec.BadKey(names[1], f"must not be given together with `{names[0]}`")
    if not names or names[0] == "environment":
        return None
    environment = {"kind": names[0], **table[names[0]]}
    if "current" in environment:
        environment["current"] = robot.current_of(environment["current"], folder)
    return environment


def take_chosen(table: codec.Table, gait: gaits.Gait, folder: Path | None) -> choice.Chosen:
    """Remove the entries `NAMES` from a table, and return what they stand for.

    Args:
        table: Table of a file; tables in place of names stay in it, that of a robot converted to
            the robot.
        gait: Determines the water, if none is named.
        folder: Folder in which named files are searched for first, before the working directory.

    Raises:
        BadKey: If a name is unknown, or names are incompatible.
    """
    names: dict[str, Any] = {}
    for name in NAMES:
        if name in table and not isinstance(table[name], Mapping):
            names[name] = _in_folder(table.pop(name), folder)
    with codec.arguments_of(""):
        if "robot" in table:
            table["robot"] = stored.load_described(table["robot"])
        stated_robot: robot.Robot | None = table.get("robot")

        def find_robot(name: str, n_links: int | None) -> robot.Robot:
            return stated_robot or robot.load_robot(name, n_links)

        return choice.Choice(**names).resolved(gait, find_robot)


def _in_folder(name: object, folder: Path | None) -> object:
    """Return the path of a named file if it is in the folder; anything else is returned unchanged."""
    if folder is None or not isinstance(name, str) or not name.endswith(".toml"):
        return name
    path = folder / name
    if path.is_file():
        return str(path)
    return name


def _with_recorded(table: codec.Table, folder: Path | None) -> codec.Table:
    """Return a gait's table with its recorded joint angles loaded.

    Omitted fields are taken from the recording; an angle may also be stated in degrees.
    """
    recorded: Any = table["recorded"]
    if isinstance(recorded, str):
        angles = _load_recorded({"file": recorded}, folder)
    elif _names_file(recorded):
        angles = _load_recorded(dict(recorded), folder)
    else:
        angles = codec.decode(gaits.JointAngles, recorded, "gait.recorded")
    defaults = {"amplitude": 0.0, "frequency": angles.frequency, "phase_shift": 0.0}
    for name in list(defaults):
        if any(key.startswith(name + "_deg") for key in table):
            del defaults[name]
    return {**defaults, **table, "recorded": angles}


def _names_file(recorded: object) -> bool:
    return isinstance(recorded, Mapping) and "file" in recorded


def _load_recorded(recorded: codec.Table, folder: Path | None) -> gaits.JointAngles:
    """Return the joint angles in a file, whose columns may have names of their own."""
    codec.check_keys(recorded, ("file", "columns"), "gait.recorded")
    with codec.arguments_of("gait.recorded"):
        columns = check_columns("columns", recorded.get("columns", {}))
        return robot.load_joint_angles(recorded["file"], folder, columns=columns)


# Names of 0.2, for one release.
__getattr__ = renamed_names(
    __name__, {"run_from_table": "laticauda.scenarios.stored:run_from_table"}
)
