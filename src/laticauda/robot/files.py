"""TOML files of robots, waters, grounds and currents, and the presets that come with laticauda.

A file first states its kind: ``kind = "robot"``, ``"water"``, ``"ground"``, or the kind of a flow
(`laticauda.water.fluid.flow`), which is a current. The other keys are the fields of the class of that
name, in the same units (lengths in m, angles in rad). Four features keep a file short:

- an angle may be given in degrees under its name with ``_deg``: ``limit_deg = 90``;
- an entry of ``modules`` or ``joints`` may have a ``count``;
- the ``axis`` of a joint entry may be a list, which its joints cycle through: ``count = 18`` and
  ``axis = ["yaw", "pitch"]`` give 18 joints about the two axes in turn;
- ``extends = "mamba"`` takes every top-level key that the file lacks, except ``name`` and
  ``description``, from a preset or from another file (a path relative to this one).

The ``current`` of a water may also be a preset's name or such a path.
"""

from collections.abc import Mapping
from os import sep
from pathlib import Path
from typing import Any, TypeAlias, TypeVar, cast, overload

from laticauda.motion import gaits
from laticauda.robot import environment, textbook
from laticauda.robot.robot import Robot
from laticauda.values import (
    BadArgument,
    BadKey,
    LaticaudaError,
    RobotFileError,
    Table,
    decode,
    encode,
    extensions,
    files,
    keys_of,
    stamped,
    suggest_nearest,
    take_kind,
)
from laticauda.water.fluid import Flow

Described: TypeAlias = Robot | environment.Water | environment.Ground | Flow
Kind = TypeVar("Kind", Robot, environment.Water, environment.Ground, Flow)

KINDS: dict[str, type[Described]] = {
    "robot": Robot,
    "water": environment.Water,
    "ground": environment.Ground,
}
"""Classes of what files hold, by kind; any other kind is that of a flow."""
PRESETS = Path(__file__).parent / "presets"
FOLDERS = {kind: f"{kind}s" for kind in (*KINDS, "current", "parameter", "motion", "servo")}
"""Folders of the presets, by kind."""


class RobotNotFound(RobotFileError, FileNotFoundError):
    """No preset or file has the requested name."""

    __str__ = Exception.__str__  # OSError's own would look for an errno

    def __reduce__(self) -> tuple[type["RobotNotFound"], tuple[object, ...]]:
        """Support pickling between processes; tools that pickle tracebacks fail with two built-in base classes."""
        return type(self), self.args


def to_toml(thing: Described) -> str:
    """Write a robot, water, ground or flow as TOML.

    Args:
        thing: The `Robot`, `Water`, `Ground` or `Flow`.

    Returns:
        The TOML text; ``from_toml(to_toml(thing)) == thing`` holds exactly.

    Raises:
        ValueError: If `thing` is none of these.
    """
    import tomli_w

    if not isinstance(thing, (*KINDS.values(), Flow)):
        raise BadArgument(
            "thing", f"must be a Robot, Water, Ground or Flow, got {type(thing).__name__}"
        )
    return tomli_w.dumps(stamped(extensions.name_of(type(thing)), encode(thing)))


@overload
def from_toml(source: str | Path, kind: type[Kind]) -> Kind: ...
@overload
def from_toml(source: str | Path) -> Described: ...
def from_toml(source: str | Path, kind: type[Any] | None = None) -> Any:
    """Read a robot, water, ground or flow from a TOML text, or from a file if `source` is a `Path`.

    Args:
        source: The text itself, or a path.
        kind: `Robot`, `Water`, `Ground` or `Flow`, to reject anything else; None accepts all of
            them.

    Raises:
        RobotFileError: If the source is invalid; the message names the file, the key, the rule and
            the value.
    """
    if isinstance(source, Path):
        return _build_from_table(read_table(source), str(source), source, kind)
    table = files.parse_toml(str(source), "<text>", RobotFileError)
    return _build_from_table(table, "<text>", None, kind)


def _build_from_table(
    table: Table, source_name: str, path: Path | None, kind: type[Described] | None
) -> Described:
    """Return what a file's table describes; `source_name` stands in messages."""
    described_class, complete_table = _complete(table, source_name, path, kind, ())
    return _build(described_class, complete_table, source_name)


def read_table(path: Path) -> Table:
    """Read the table in a file.

    Raises:
        RobotFileError: If the file cannot be read or is not TOML.
    """
    return files.read_toml(path, RobotFileError, missing=RobotNotFound)


def preset_names(kind: str) -> tuple[str, ...]:
    """Return the sorted names of the presets of a kind, one of `FOLDERS`."""
    return tuple(sorted(path.stem for path in (PRESETS / FOLDERS[kind]).glob("*")))


def find(name_or_path: str | Path, kind: str, folder: Path | None = None) -> Path:
    """Return the file of a preset, or the file that a path points to.

    A text that contains a folder or ends in ``.toml`` is a path; any other text is a preset's name.

    Args:
        name_or_path: Name or path given by the user.
        kind: One of `FOLDERS`.
        folder: Base of relative paths; None for the working directory.

    Raises:
        ValueError: If it is neither a name nor a path.
        RobotNotFound: If it does not exist; the message lists the presets and suggests the nearest.
    """
    if not isinstance(name_or_path, str | Path):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise BadArgument(
            "name_or_path", f"must be a preset's name or a path, got {name_or_path!r}"
        )
    names = preset_names(kind)
    text = str(name_or_path)
    listed = f"{FOLDERS[kind]}: {', '.join(names)}"
    ending = ".csv" if kind == "motion" else ".toml"
    is_path = isinstance(name_or_path, Path) or text.endswith(ending) or "/" in text or sep in text
    if not is_path:
        if text in names:
            return PRESETS / FOLDERS[kind] / f"{text}{ending}"
        raise RobotNotFound(
            f"there is no {kind} preset named `{text}`{suggest_nearest(text, names)} "
            f"({listed}; a path ends in {ending})"
        )
    path = Path(text) if folder is None else folder / text
    try:
        exists = path.exists()
    except (OSError, ValueError):  # an over-long name, a null byte: reading reports it
        exists = True
    if not exists:
        shown_path = path if folder else text
        raise RobotNotFound(
            f"{shown_path}: no such file{suggest_nearest(path.stem, names)} ({listed})"
        )
    return path


def _complete(
    table: Table,
    source_name: str,
    path: Path | None,
    kind: type[Described] | None,
    parents: tuple[Path, ...],
) -> tuple[type[Described], Table]:
    """Return the class that a file describes, and its keys with those of the file it extends."""
    with keys_of(source_name, RobotFileError):
        is_flow = kind is Flow or (kind is None and table.get("kind") in Flow.names())
        kind_name = take_kind(table, *(Flow.names() if is_flow else KINDS))
        if kind not in (None, KINDS.get(kind_name, Flow)):
            expected = extensions.name_of(cast(type, kind))
            raise BadKey("kind", f'must be "{expected}" here, got {kind_name!r}')
    base = table.pop("extends", None)
    if base is not None:
        preset_kind = "current" if is_flow else kind_name
        table = {**_inherited(base, source_name, path, preset_kind, parents), **table}
    folder = None if path is None else path.parent
    if is_flow:
        return Flow, current_of({**table, "kind": kind_name}, folder)
    if kind_name == "water" and "current" in table:
        table["current"] = current_of(table["current"], folder)
    return KINDS[kind_name], table


def _inherited(
    base: object,
    source_name: str,
    path: Path | None,
    preset_kind: str,
    parents: tuple[Path, ...],
) -> Table:
    """Return the keys that a file takes from the file it extends, which must be valid by itself."""
    if not isinstance(base, str):
        raise RobotFileError(
            f"{source_name}: key `extends`: must be the name of a preset or a path, got {base!r}"
        )
    try:
        base_path = find(base, preset_kind, None if path is None else path.parent)
        base_table = read_table(base_path)
    except LaticaudaError as error:
        raise type(error)(f"{source_name}: key `extends`: {error}") from None
    chain = parents if path is None else (*parents, path.resolve())
    if base_path.resolve() in chain:
        raise RobotFileError(
            f"{source_name}: key `extends`: must not lead back to a file that extends it, "
            f"got {base!r}"
        )
    kind = KINDS.get(preset_kind, Flow)
    base_class, complete_table = _complete(base_table, str(base_path), base_path, kind, chain)
    _build(base_class, complete_table, str(base_path))
    return {
        key: value for key, value in complete_table.items() if key not in ("name", "description")
    }


def _build(kind: type[Described], table: Table, source_name: str) -> Described:
    with keys_of(source_name, RobotFileError):
        return decode(kind, table)


def robot_names() -> tuple[str, ...]:
    """Return the sorted names of the robot presets."""
    return preset_names("robot")


def water_names() -> tuple[str, ...]:
    """Return the sorted names of the water presets."""
    return preset_names("water")


def ground_names() -> tuple[str, ...]:
    """Return the sorted names of the ground presets."""
    return preset_names("ground")


def load_robot(name_or_path: str | Path, n_links: int | None = None) -> Robot:
    """Load a robot.

    Args:
        name_or_path: A preset's name (`robot_names` lists them), or the path of a TOML file.
        n_links: Number of links instead of the file's; only for robots whose modules and joints are
            all identical.

    Raises:
        RobotFileError: If there is no such robot (`RobotNotFound`), or its file is invalid.
        ValueError: If the robot cannot have `n_links` links.

    Example:
        >>> load_robot("mamba").n_links
        9
        >>> load_robot("chain", n_links=12).n_joints
        11
    """
    robot: Robot = _load(name_or_path, "robot")
    if n_links is None:
        return robot
    return robot.with_links(n_links)


def load_water(name_or_path: str | Path, robot: Robot | None = None) -> environment.Water:
    """Load water.

    Args:
        name_or_path: A preset's name (`water_names` lists them), the path of a TOML file, or
            ``textbook``.
        robot: Robot whose shape determines the textbook water.

    Raises:
        RobotFileError: If there is no such water (`RobotNotFound`), or its file is invalid.

    Example:
        >>> load_water("paper-lateral").normal_drag
        1.75
    """
    if name_or_path == textbook.TEXTBOOK and robot is not None:
        return textbook.textbook_of(robot)
    return _load(name_or_path, "water")


def load_ground(name_or_path: str | Path) -> environment.Ground:
    """Load ground.

    Args:
        name_or_path: A preset's name (`ground_names` lists them), or the path of a TOML file.

    Raises:
        RobotFileError: If there is no such ground (`RobotNotFound`), or its file is invalid.
    """
    return _load(name_or_path, "ground")


def current_names() -> tuple[str, ...]:
    """Return the sorted names of the current presets."""
    return preset_names("current")


def load_current(name_or_path: str | Path) -> Flow:
    """Load a flow for `Water.current`.

    Args:
        name_or_path: A preset's name (`current_names` lists them), or the path of a TOML file.

    Raises:
        RobotFileError: If there is no such current (`RobotNotFound`), or its file is invalid.
    """
    return _load(name_or_path, "current")


def current_of(current: Any, folder: Path | None = None) -> Any:
    """Resolve a current: return the flow of a preset's name or a path, and anything else unchanged.

    Args:
        current: As stated by a file or a caller; the name of a flow alone means that flow with its
            defaults. In a table, the flows of a sum may also be names, and a source is a path.
        folder: Base of relative paths; None for the working directory.

    Raises:
        RobotFileError: If there is no such current (`RobotNotFound`), or its file is invalid.
    """
    if isinstance(current, list):
        return [current_of(part, folder) for part in cast("list[Any]", current)]
    if isinstance(current, dict):
        table = dict(cast("Table", current))
        if "flows" in table:
            table["flows"] = current_of(table["flows"], folder)
        if "source" in table:
            table["source"] = str((folder or Path()) / str(table["source"]))
        return table
    if not isinstance(current, str):
        return current
    # The name of a flow alone means that flow; a preset of the same name comes first.
    if current in Flow.names() and current not in current_names():
        return current
    return from_toml(find(current, "current", folder), Flow)


def load_joint_angles(
    name_or_path: str | Path,
    folder: Path | None = None,
    *,
    columns: Mapping[str, str] | None = None,
) -> gaits.JointAngles:
    """Load a recorded motion.

    Args:
        name_or_path: A preset's name, such as `amphibot-1`, or the path of a CSV file
            (`JointAngles.read`).
        folder: Base of relative paths; None for the working directory.
        columns: Names in the file by ours, for columns that it calls otherwise.

    Raises:
        RobotNotFound: If there is no such motion.
        TrialFileError: If its file is invalid.
    """
    return gaits.JointAngles.read(find(name_or_path, "motion", folder), columns)


def _load(name_or_path: str | Path, kind: str) -> Any:
    kind_of: type[Any] = KINDS.get(kind, Flow)
    return from_toml(find(name_or_path, kind), kind_of)
