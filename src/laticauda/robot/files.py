"""TOML files of robots, waters, grounds and currents, and the presets that come with laticauda.

A file first states its kind: ``kind = "robot"``, ``"water"``, ``"ground"``, or the kind of a flow
(`laticauda.fluid.flow`), which is a current. The other keys are the fields of the class of that
name, in the same units (lengths in m, angles in rad). Four features keep a file short:

- an angle may be given in degrees under its name with ``_deg``: ``limit_deg = 90``;
- an entry of ``modules`` or ``joints`` may have a ``count``;
- the ``axis`` of a joint entry may be a list, which its joints cycle through: ``count = 18`` and
  ``axis = ["yaw", "pitch"]`` give 18 joints about the two axes in turn;
- ``extends = "mamba"`` takes every top-level key that the file lacks, except ``name`` and
  ``description``, from a preset or from another file (a path relative to this one).

The ``current`` of a water may also be a preset's name or such a path.
"""

from os import sep
from pathlib import Path
from typing import Any, TypeAlias, TypeVar, cast, overload

from laticauda import extensions, files, gaits
from laticauda.codec import BadKey, Table, decode, encode, keys_of, stamped, take_kind
from laticauda.errors import BadArgument, LaticaudaError, RobotFileError, suggest_nearest
from laticauda.fluid.flow import Flow
from laticauda.robot import environment, textbook
from laticauda.robot.robot import Robot

Described: TypeAlias = Robot | environment.Water | environment.Ground | Flow
Kind = TypeVar("Kind", Robot, environment.Water, environment.Ground, Flow)

KINDS: dict[str, type[Described]] = {
    "robot": Robot,
    "water": environment.Water,
    "ground": environment.Ground,
}
PRESETS = Path(__file__).parent / "presets"
FOLDERS = {word: f"{word}s" for word in (*KINDS, "current", "parameter", "motion")}


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
    path = source if isinstance(source, Path) else None
    shown = "<text>" if path is None else str(path)
    table = (
        files.parse_toml(str(source), shown, RobotFileError) if path is None else read_table(path)
    )
    return _build(*_complete(table, shown, path, kind, ()), shown)


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
    names, given = preset_names(kind), str(name_or_path)
    listed = f"{FOLDERS[kind]}: {', '.join(names)}"
    ending = ".csv" if kind == "motion" else ".toml"
    is_path = (
        isinstance(name_or_path, Path) or given.endswith(ending) or "/" in given or sep in given
    )
    if not is_path:
        if given in names:
            return PRESETS / FOLDERS[kind] / f"{given}{ending}"
        raise RobotNotFound(
            f"there is no {kind} preset named `{given}`{suggest_nearest(given, names)} "
            f"({listed}; a path ends in {ending})"
        )
    path = folder / given if folder is not None else Path(given)
    try:
        there = path.exists()
    except (OSError, ValueError):  # an over-long name, a null byte: reading reports it
        there = True
    if not there:
        raise RobotNotFound(
            f"{path if folder else given}: no such file{suggest_nearest(path.stem, names)} ({listed})"
        )
    return path


def _complete(
    table: Table,
    shown: str,
    path: Path | None,
    kind: type[Described] | None,
    parents: tuple[Path, ...],
) -> tuple[type[Described], Table]:
    """Return the class that a file describes, and its keys with those of the file it extends."""
    with keys_of(shown, RobotFileError):
        is_flow = kind is Flow or (kind is None and table.get("kind") in Flow.names())
        word = take_kind(table, *(Flow.names() if is_flow else KINDS))
        if kind not in (None, KINDS.get(word, Flow)):
            raise BadKey(
                "kind", f'must be "{extensions.name_of(cast(type, kind))}" here, got {word!r}'
            )
    base = table.pop("extends", None)
    if base is not None:
        table = {**_inherited(base, shown, path, "current" if is_flow else word, parents), **table}
    if is_flow:
        return Flow, current_of({**table, "kind": word}, None if path is None else path.parent)
    if word == "water" and "current" in table:
        table["current"] = current_of(table["current"], None if path is None else path.parent)
    return KINDS[word], table


def _inherited(
    base: object, shown: str, path: Path | None, word: str, parents: tuple[Path, ...]
) -> Table:
    """Return the keys that a file takes from the file it extends, which must be valid by itself."""
    if not isinstance(base, str):
        raise RobotFileError(
            f"{shown}: key `extends`: must be the name of a preset or a path, got {base!r}"
        )
    try:
        other = find(base, word, None if path is None else path.parent)
        found = read_table(other)
    except LaticaudaError as error:
        raise type(error)(f"{shown}: key `extends`: {error}") from None
    chain = parents if path is None else (*parents, path.resolve())
    if other.resolve() in chain:
        raise RobotFileError(
            f"{shown}: key `extends`: must not lead back to a file that extends it, got {base!r}"
        )
    kind, table = _complete(found, str(other), other, KINDS.get(word, Flow), chain)
    _build(kind, table, str(other))
    return {key: value for key, value in table.items() if key not in ("name", "description")}


def _build(kind: type[Described], table: Table, shown: str) -> Described:
    with keys_of(shown, RobotFileError):
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
    return robot if n_links is None else robot.with_links(n_links)


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


def current_of(given: Any, folder: Path | None = None) -> Any:
    """Resolve a current: return the flow of a preset's name or a path, and anything else unchanged.

    Args:
        given: As given by a file or a caller; the name of a flow alone means that flow with its
            defaults. In a table, the flows of a sum may also be names, and a source is a path.
        folder: Base of relative paths; None for the working directory.

    Raises:
        RobotFileError: If there is no such current (`RobotNotFound`), or its file is invalid.
    """
    if isinstance(given, list):
        return [current_of(one, folder) for one in cast("list[Any]", given)]
    if isinstance(given, dict):
        table = cast("Table", given)
        flows, source = (
            current_of(table.get("flows"), folder),
            str((folder or Path()) / str(table.get("source"))),
        )
        return {key: {"flows": flows, "source": source}.get(key, one) for key, one in table.items()}
    is_name = isinstance(given, str) and (given in current_names() or given not in Flow.names())
    return from_toml(find(given, "current", folder), Flow) if is_name else given


def load_joint_angles(name_or_path: str | Path, folder: Path | None = None) -> gaits.JointAngles:
    """Load a recorded motion.

    Args:
        name_or_path: A preset's name, such as `amphibot-1`, or the path of a CSV file
            (`JointAngles.read`).
        folder: Base of relative paths; None for the working directory.

    Raises:
        RobotNotFound: If there is no such motion.
        TrialFileError: If its file is invalid.
    """
    return gaits.JointAngles.read(find(name_or_path, "motion", folder))


def _load(name_or_path: str | Path, kind: str) -> Any:
    kind_of: type[Any] = KINDS.get(kind, Flow)
    return from_toml(find(name_or_path, kind), kind_of)
