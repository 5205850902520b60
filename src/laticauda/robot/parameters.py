"""Parameter files: fluid coefficients of one's own for every gait, as TOML.

    kind = "parameters"
    name = "tank-2025"
    title = "our trials in the tank"

    [water]                    # for every gait: the fields of `Water` but its name
    tangential_friction = 0.3
    normal_drag = 1.75
    added_mass = 1.5

    [eel_like.water]           # for this gait: replaces what differs; `lateral_undulation.water` likewise
    tangential_friction = 0.17

Like the files of robots they are read strictly: what is unknown, missing or out of range is refused with its key.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from laticauda.errors import RobotFileError, nearest
from laticauda.robot.checks import label
from laticauda.robot.environment import Water
from laticauda.robot.files import parsed, read_text
from laticauda.robot.tables import BadKey, Table, decode

KIND = "parameters"
GAITS = ("lateral_undulation", "eel_like")
"""Kinds of gait that may have a water of their own."""


@dataclass(frozen=True, kw_only=True)
class Parameters:
    """What a parameter file says: the water's coefficients, by gait where they differ."""

    name: str
    """What files and stored trials call them."""
    title: str
    """What a legend says."""
    every_gait: Water
    """For the gaits that have no water of their own."""
    own: Mapping[str, Water] = field(default_factory=dict[str, Water])
    """By kind of gait, one of `GAITS`: its own water."""

    def __post_init__(self) -> None:
        label("name", self.name)
        label("title", self.title)

    def water(self, gait_kind: str) -> Water:
        """The water for a kind of gait.

        Args:
            gait_kind: As in `laticauda.Gait.kind`; one without a water of its own has that of every gait.
        """
        return self.own.get(gait_kind, self.every_gait)


def load_parameters(path: str | Path) -> Parameters:
    """Load a parameter file.

    Args:
        path: Of the TOML file.

    Returns:
        The parameters, checked.

    Raises:
        RobotFileError: If there is no such file (`RobotNotFound`), or anything in it is wrong; the message has the
            file, the key, the rule and the value.
    """
    if not isinstance(path, str | Path):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ValueError(f"`path` must be the path of a parameter file, got {path!r}.")
    shown = str(path)
    table = parsed(read_text(Path(path)), shown)
    try:
        return _parameters(table)
    except BadKey as error:
        raise RobotFileError(f"{shown}: key `{error.key}`: {error.rule}") from None


def _parameters(table: Table) -> Parameters:
    _check_kind(table.pop("kind", None))
    _check_keys(table, ("name", "title", "water", *GAITS), "")
    for key in ("name", "title", "water"):
        if key not in table:
            raise BadKey(key, "is missing; every parameter file needs it")
    name = _label(table, "name")
    common = _water_table(table["water"], "water")
    own: dict[str, Water] = {}
    every_gait = decode(Water, {**common, "name": name}, "water")
    for gait in GAITS:
        if gait in table:
            entries = _table(table[gait], gait)
            _check_keys(entries, ("water",), gait)
            where = f"{gait}.water"
            changes = _water_table(entries.get("water", {}), where)
            own[gait] = decode(Water, {**common, **changes, "name": f"{name}, {gait}"}, where)
    return Parameters(name=name, title=_label(table, "title"), every_gait=every_gait, own=own)


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


def _label(table: Table, key: str) -> str:
    try:
        return label(key, table[key])
    except ValueError as error:
        raise BadKey(key, str(error).removeprefix(f"`{key}` ").removesuffix(".")) from None
