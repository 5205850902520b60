"""Parameter files: numbers of one's own for water, joints, fin and electronics, for every gait or for one, as TOML.

    kind = "parameters"
    name = "tank-2025"
    title = "our trials in the tank"
    joints = "prescribed"      # the joint law that goes with them: prescribed, pd or servo

    [water]                    # for every gait: the fields of `Water` but its name
    tangential_friction = 0.3
    normal_drag = 1.75
    added_mass = 1.5

    [actuator]                 # of every joint; likewise [joint], [caudal_fin], [tether] and [robot]
    tracking = 0.92

    [eel_like.water]           # for this gait: replaces what differs; `lateral_undulation` likewise
    tangential_friction = 0.17

Only `[water]` has to be there. Like the files of robots they are read strictly: what is unknown, missing or out of
range is refused with its key.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any, Literal

from laticauda.errors import RobotFileError, StorageFailed, instance, nearest, one_of
from laticauda.robot.adjustments import NAMES, Adjustments, adjusted, read_adjustments, write_adjustments
from laticauda.robot.checks import label, put
from laticauda.robot.environment import Water
from laticauda.robot.files import find, parsed, preset_names, read_text
from laticauda.robot.robot import Robot
from laticauda.robot.tables import BadKey, Table, decode, encode

KIND = "parameters"
GAITS = ("lateral_undulation", "eel_like")
"""Kinds of gait that may have numbers of their own."""
JOINT_LAWS = ("prescribed", "pd", "servo")


@dataclass(frozen=True, kw_only=True)
class Parameters:
    """What a parameter file says: the water, by gait where it differs, and what it changes about a robot.

    Raises:
        ValueError: If a number is unknown or out of its range.
    """

    name: str
    """What files and stored trials call them; the waters are called after them."""
    title: str
    """What a legend says."""
    joints: Literal["prescribed", "pd", "servo"] | None = None
    """The joint law that they go with, taken where none is asked for; None: any."""
    every_gait: Water
    """For the gaits that have no water of their own."""
    own: Mapping[str, Water] = field(default_factory=dict[str, Water])
    """By kind of gait, one of `GAITS`: its own water."""
    changes: Adjustments = field(default_factory=dict[str, dict[str, Any]])
    """By table (joint, actuator, caudal_fin, tether, robot) and field: what the robot has instead of its own."""
    own_changes: Mapping[str, Adjustments] = field(default_factory=dict[str, Adjustments])
    """By kind of gait, one of `GAITS`: what it changes on top of that."""

    def __post_init__(self) -> None:
        label("name", self.name)
        label("title", self.title)
        if self.joints is not None:
            one_of("joints", self.joints, JOINT_LAWS)
        instance("every_gait", self.every_gait, Water)
        put(self, "every_gait", replace(self.every_gait, name=self.name))
        for name in ("own", "own_changes"):
            for gait in getattr(self, name):
                one_of(name, gait, GAITS)
        for gait, water in self.own.items():
            instance(f"own[{gait}]", water, Water)
        put(self, "own", {gait: replace(water, name=f"{self.name}, {gait}") for gait, water in self.own.items()})
        put(self, "changes", _checked("changes", self.changes))
        own = {gait: _checked(f"own_changes.{gait}", changes) for gait, changes in self.own_changes.items()}
        put(self, "own_changes", {gait: changes for gait, changes in own.items() if changes})

    def water(self, gait_kind: str) -> Water:
        """The water for a kind of gait.

        Args:
            gait_kind: As in `laticauda.Gait.kind`; one without a water of its own has that of every gait.
        """
        return self.own.get(gait_kind, self.every_gait)

    def robot(self, robot: Robot, gait_kind: str) -> Robot:
        """A robot with these numbers.

        Args:
            robot: What swims; a table for a fin does nothing to a robot without one.
            gait_kind: As in `laticauda.Gait.kind`.

        Raises:
            ValueError: If a number does not go with what the robot has.
        """
        return adjusted(adjusted(robot, self.changes), self.own_changes.get(gait_kind, {}))

    def to_toml(self) -> str:
        """The text of the file that `load_parameters` reads back to equal parameters.

        Raises:
            ValueError: If a gait's water has None where that of every gait has a number: TOML cannot say so.
        """
        import tomli_w

        table: Table = {"kind": KIND, "name": self.name, "title": self.title}
        if self.joints is not None:
            table["joints"] = self.joints
        table |= {"water": _without_name(encode(self.every_gait)), **write_adjustments(self.changes)}
        for gait in GAITS:
            entries: Table = write_adjustments(self.own_changes.get(gait, {}))
            if gait in self.own:
                entries = {"water": _differences(self.own[gait], self.every_gait), **entries}
            if entries:
                table[gait] = entries
        return tomli_w.dumps(table)

    def save(self, path: str | Path) -> None:
        """Write the file.

        Args:
            path: Of the TOML file; one that is there is replaced.

        Raises:
            StorageFailed: If it cannot be written.
        """
        text = self.to_toml()
        try:
            Path(path).write_text(text, encoding="utf-8")
        except OSError as error:
            raise StorageFailed(f"{path}: cannot be written: {error.strerror or error}.") from error


def parameter_names() -> tuple[str, ...]:
    """The names of the presets of parameters, sorted."""
    return preset_names("parameter")


def load_parameters(name_or_path: str | Path) -> Parameters:
    """Load parameters.

    Args:
        name_or_path: A preset's name (`parameter_names` lists them), or the path of a TOML file.

    Returns:
        The parameters, checked.

    Raises:
        RobotFileError: If there is no such file (`RobotNotFound`), or anything in it is wrong; the message has the
            file, the key, the rule and the value.

    Example:
        >>> load_parameters("paper").water("eel_like").tangential_friction
        0.17
    """
    if not isinstance(name_or_path, str | Path):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ValueError(f"`name_or_path` must be a preset's name or a path, got {name_or_path!r}.")
    path = find(name_or_path, "parameter")
    shown = str(path)
    table = parsed(read_text(path), shown)
    try:
        return _parameters(table)
    except BadKey as error:
        raise RobotFileError(f"{shown}: key `{error.key}`: {error.rule}") from None


def _parameters(table: Table) -> Parameters:
    _check_kind(table.pop("kind", None))
    _check_keys(table, ("name", "title", "joints", "water", *NAMES, *GAITS), "")
    for key in ("name", "title", "water"):
        if key not in table:
            raise BadKey(key, "is missing; every parameter file needs it")
    common = _water_table(table["water"], "water")
    every_gait = decode(Water, common, "water")
    own: dict[str, Water] = {}
    own_changes: dict[str, Adjustments] = {}
    for gait in GAITS:
        if gait not in table:
            continue
        entries = _table(table[gait], gait)
        _check_keys(entries, ("water", *NAMES), gait)
        if "water" in entries:
            where = f"{gait}.water"
            own[gait] = decode(Water, {**common, **_water_table(entries["water"], where)}, where)
        own_changes[gait] = read_adjustments({key: entries[key] for key in NAMES if key in entries}, gait)
    try:
        return Parameters(
            name=table["name"],
            title=table["title"],
            joints=table.get("joints"),
            every_gait=every_gait,
            own=own,
            changes=read_adjustments({key: table[key] for key in NAMES if key in table}),
            own_changes=own_changes,
        )
    except ValueError as error:  # name, title or joints: all else is checked already
        key, _, rule = str(error).removeprefix("`").partition("` ")
        raise BadKey(key, rule.removesuffix(".")) from None


def _checked(name: str, changes: Adjustments) -> dict[str, dict[str, Any]]:
    for table in changes:
        one_of(name, table, NAMES)
    try:
        read = read_adjustments(changes, name)
    except BadKey as error:
        raise ValueError(f"`{error.key}` {error.rule}.") from None
    return {table: values for table, values in read.items() if values}


def _differences(water: Water, usual: Water) -> Table:
    """The fields in which a water is not the usual one, as a file has them."""
    table: Table = {}
    for one in fields(Water):
        value: Any = getattr(water, one.name)
        if one.name == "name" or value == getattr(usual, one.name):
            continue
        if value is None:
            raise ValueError(f"`{one.name}` must be a number, as it is for every gait; a file cannot take it away.")
        table[one.name] = list(value) if isinstance(value, tuple) else value  # pyright: ignore[reportUnknownArgumentType]
    return table


def _without_name(table: Table) -> Table:
    return {key: value for key, value in table.items() if key != "name"}


def _check_kind(kind: object) -> None:
    if kind is None:
        raise BadKey("kind", f'is missing; it must be "{KIND}" here')
    if kind != KIND:
        raise BadKey("kind", f'must be "{KIND}" here, got {kind!r}')


def _check_keys(table: Mapping[str, object], known: Sequence[str], path: str) -> None:
    for key in table:
        if key not in known:
            hint = nearest(key, known) or f"; the keys here are {', '.join(known)}"
            raise BadKey(f"{path}.{key}" if path else key, f"is not known{hint}")


def _water_table(value: object, path: str) -> Table:
    table = _table(value, path)
    if "name" in table:
        raise BadKey(f"{path}.name", "must not be given: the water takes the name of the file")
    return table


def _table(value: Any, path: str) -> Table:
    if not isinstance(value, dict):
        raise BadKey(path, f"must be a table, got {value!r}")
    return value  # pyright: ignore[reportUnknownVariableType]
