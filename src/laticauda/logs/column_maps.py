"""Column maps as values: what the columns of somebody's log are; `column_files` reads them from TOML."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import cast

from laticauda.errors import BadArgument, finite, not_negative, one_of, positive, whole
from laticauda.gaits import Gait
from laticauda.robot import Ground, Robot, Water

LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}
ANGLES = {"rad": 1.0, "deg": math.pi / 180.0}
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6}
RATES = {"rad/s": 1.0, "deg/s": math.pi / 180.0}
TORQUES = {"N m": 1.0, "N cm": 1e-2, "N mm": 1e-3}
UNITS = {"joint_angle": ANGLES, "joint_angle_ref": ANGLES, "joint_rate": RATES, "joint_torque": TORQUES}
"""Units of the columns of joints by section; the first is the default."""
DIRECTIONS = tuple(sign + axis for axis in "xyz" for sign in ("", "-"))
AXES = ("X", "Y", "Z")


@dataclass(frozen=True, kw_only=True)
class TimeColumn:
    """When the rows were taken; without any, the file must say it itself."""

    column: str | None = None
    """Name of the column."""
    unit: str = "s"
    """Its unit: s, ms or us."""
    rate: float | None = None
    """Rows per second, instead of a column [Hz]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        one_of("unit", self.unit, tuple(TIMES))
        if self.rate is not None:
            object.__setattr__(self, "rate", positive("rate", self.rate, "Hz"))
        if self.rate is not None and self.column is not None:
            raise BadArgument("rate", f"must not be given beside `column`, got {self.rate}")


@dataclass(frozen=True, kw_only=True)
class Frame:
    """Where the world axes of the trial are in those of the file: first turned to them, then moved, then rotated."""

    x: str = "x"
    """Which direction of the file is forward: x, y, z or their opposites, as -z."""
    y: str = "y"
    """Which one is left."""
    origin: tuple[float, float] = (0.0, 0.0)
    """Where the trial's origin is, along those two [m]."""
    rotation_deg: float = 0.0
    """By which angle the result is turned, counter-clockwise [deg]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        for name in ("x", "y"):
            one_of(name, getattr(self, name), DIRECTIONS)
        if self.x[-1] == self.y[-1]:
            raise BadArgument("y", f"must be another axis than `x` = {self.x!r}, got {self.y!r}")
        object.__setattr__(self, "origin", _pair("origin", self.origin, "m"))
        object.__setattr__(self, "rotation_deg", finite("rotation_deg", self.rotation_deg, "deg"))


@dataclass(frozen=True, kw_only=True)
class Position:
    """A place whose columns stand for the center of mass itself, as the mean of many markers does."""

    position: Sequence[str]
    """Names of its columns: x and y, or x, y and z."""
    length_unit: str | None = None
    """Their unit: m, cm or mm; the file's own if it states one, else m."""

    def __post_init__(self) -> None:
        """Check every field once."""
        object.__setattr__(self, "position", _names("position", self.position, (2, 3)))
        _unit("length_unit", self.length_unit, LENGTHS)


@dataclass(frozen=True, kw_only=True)
class Heading:
    """The heading, where no joint angles are there to make it of."""

    column: str
    """Name of the column."""
    unit: str | None = None
    """Its unit: rad or deg; the file's own if it states one, else rad."""

    def __post_init__(self) -> None:
        """Check every field once."""
        _unit("unit", self.unit, ANGLES)


@dataclass(frozen=True, kw_only=True)
class Body:
    """One link that motion capture followed; with the joint angles it gives the whole robot."""

    name: str | None = None
    """Name of a rigid body in a QTM file, instead of all columns below."""
    position: Sequence[str] | None = None
    """Names of the columns of its place: x and y, or x, y and z."""
    length_unit: str | None = None
    """Their unit: m, cm or mm; the file's own if it states one, else m."""
    yaw: str | None = None
    """Column of its angle about the vertical axis of the file."""
    angle_unit: str | None = None
    """Its unit: rad or deg; the file's own if it states one, else rad."""
    quaternion: Sequence[str] | None = None
    """Columns w, x, y, z of its orientation, instead of `yaw`."""
    rotation: Sequence[str] | None = None
    """Columns of its rotation matrix, the first three its x axis, instead of `yaw`."""
    forward: str = "x"
    """Which of its own axes points to the head: x, y, z or their opposites."""
    link: int = 0
    """The link that carries it, 0 = tail; of the planar chain, for robots with pitch joints."""
    offset: tuple[float, float] = (0.0, 0.0)
    """Its place from the middle of that link: toward the head, to the left [m]."""
    angle_offset_deg: float = 0.0
    """Angle of the link minus the angle of the body [deg]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        if (self.name is None) == (self.position is None):
            raise BadArgument("position", f"must be given, or `name`, and not both; got {self.position}")
        turns = [one for one in ("yaw", "quaternion", "rotation") if getattr(self, one) is not None]
        if len(turns) != (1 if self.name is None else 0):
            raise BadArgument("yaw", "must be given, or `quaternion` or `rotation`, and just one; with `name` none")
        for name, sizes in (("position", (2, 3)), ("quaternion", (4,)), ("rotation", (9,))):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, _names(name, getattr(self, name), sizes))
        _unit("length_unit", self.length_unit, LENGTHS)
        _unit("angle_unit", self.angle_unit, ANGLES)
        one_of("forward", self.forward, DIRECTIONS)
        whole("link", self.link, 0)
        object.__setattr__(self, "offset", _pair("offset", self.offset, "m"))
        object.__setattr__(self, "angle_offset_deg", finite("angle_offset_deg", self.angle_offset_deg, "deg"))


@dataclass(frozen=True, kw_only=True)
class Ends:
    """A marker on the tail end, on every joint and on the head end: no joint angles are needed."""

    markers: Sequence[str]
    """Their names, tail first: one more than the robot has links."""
    columns: str = "{marker} {axis}"
    """How their columns are called, the axis being X, Y or Z."""
    length_unit: str | None = None
    """Their unit: m, cm or mm; the file's own if it states one, else m."""

    def __post_init__(self) -> None:
        """Check every field once."""
        object.__setattr__(self, "markers", _names("markers", self.markers, None))
        if "{marker}" not in self.columns or "{axis}" not in self.columns:
            raise BadArgument("columns", f"must hold {{marker}} and {{axis}}, got {self.columns!r}")
        _unit("length_unit", self.length_unit, LENGTHS)


@dataclass(frozen=True, kw_only=True)
class JointColumns:
    """One column per joint."""

    columns: str | Sequence[str]
    """Their names, tail first; or one name with {} in the place of the number."""
    first: int = 0
    """The number of the tail-most joint, where they are numbered."""
    head_first: bool = False
    """Whether the first of them is the head-most joint."""
    unit: str | None = None
    """Their unit; SI if left out."""
    sign: float = 1.0
    """-1 where the file counts positive what turns the robot right."""

    def __post_init__(self) -> None:
        """Check every field once."""
        if isinstance(self.columns, str) and "{}" not in self.columns:
            raise BadArgument("columns", f"must be a list of names, or hold {{}} for the number, got {self.columns!r}")
        if not isinstance(self.columns, str):
            object.__setattr__(self, "columns", _names("columns", self.columns, None))
        whole("first", self.first, 0)
        if self.sign not in (1, -1):
            raise BadArgument("sign", f"must be 1 or -1, got {self.sign}")

    def names(self, n_joints: int) -> list[str]:
        """The names of the columns, tail first.

        Args:
            n_joints: How many joints there are.

        Raises:
            ValueError: If there are others than that many names.
        """
        if isinstance(self.columns, str):
            found = [self.columns.replace("{}", str(self.first + i)) for i in range(n_joints)]
        else:
            found = list(self.columns)
        if len(found) != n_joints:
            raise BadArgument("columns", f"must have {n_joints} names, one per joint of the robot, got {len(found)}")
        return found[::-1] if self.head_first else found


@dataclass(frozen=True, kw_only=True)
class Power:
    """Electrical power, from a meter in the supply."""

    column: str | None = None
    """Column of the power [W], instead of current and voltage."""
    current: str | None = None
    """Column of the current [A]."""
    voltage: str | float | None = None
    """Column of the voltage, or its value [V]."""
    idle: float | None = None
    """What the robot draws at rest, taken off; the robot's own `idle_power` if left out [W]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        if (self.column is None) == (self.current is None) or (self.current is None) != (self.voltage is None):
            raise BadArgument("column", f"must be given, or `current` and `voltage`, and not both; got {self.column!r}")
        if self.idle is not None:
            object.__setattr__(self, "idle", not_negative("idle", self.idle, "W"))


SECTIONS: dict[str, type] = {
    "time": TimeColumn,
    "frame": Frame,
    "center_of_mass": Position,
    "heading": Heading,
    "body": Body,
    "ends": Ends,
    "joint_angle": JointColumns,
    "joint_rate": JointColumns,
    "joint_angle_ref": JointColumns,
    "joint_torque": JointColumns,
    "power": Power,
}


@dataclass(frozen=True, kw_only=True)
class ColumnMap:
    """What the columns of a log are, and which robot it is of."""

    robot: Robot
    """What swam."""
    environment: Water | Ground
    """What it was in."""
    gait: Gait | None = None
    """What the joints were asked for; None where it is not known."""
    start: float | None = None
    """Where the trial begins in the file's time [s]; it is 0 in the trial's."""
    stop: float | None = None
    """Where it ends in the file's time [s]."""
    longest_gap: float = 0.1
    """Missing values over up to this time are filled by straight lines; longer gaps are refused [s]."""
    smoothing: float = 0.1
    """Rates are the slopes of cubic fits over this time [s]."""
    separator: str | None = None
    """Between the cells of a text file; found by itself if left out."""
    decimal: str = "."
    """Point or comma."""
    time: TimeColumn = field(default_factory=TimeColumn)
    """When."""
    frame: Frame = field(default_factory=Frame)
    """World axes."""
    center_of_mass: Position | None = None
    """The center of mass; just one of this, `body` and `ends`, none of them for a table that laticauda wrote."""
    heading: Heading | None = None
    """The heading, beside `center_of_mass`."""
    body: Body | None = None
    """One link."""
    ends: Ends | None = None
    """All links."""
    joint_angle: JointColumns | None = None
    """Angles of the joints."""
    joint_rate: JointColumns | None = None
    """Their rates; made of the angles if left out."""
    joint_angle_ref: JointColumns | None = None
    """What they were asked for."""
    joint_torque: JointColumns | None = None
    """Their torques."""
    power: Power | None = None
    """Electrical power."""
    signals: Mapping[str, str] = field(default_factory=dict[str, str])
    """Columns that are kept as they are, by the name of the signal."""

    def __post_init__(self) -> None:
        """Check every field once."""
        object.__setattr__(self, "longest_gap", not_negative("longest_gap", self.longest_gap, "s"))
        object.__setattr__(self, "smoothing", positive("smoothing", self.smoothing, "s"))
        one_of("decimal", self.decimal, (".", ","))
        for name in ("start", "stop"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, finite(name, getattr(self, name), "s"))
        if self.start is not None and self.stop is not None and self.stop <= self.start:
            raise BadArgument("stop", f"must be > `start` = {self.start:g} s, got {self.stop:g}")
        given = [name for name in ("center_of_mass", "body", "ends") if getattr(self, name) is not None]
        if len(given) > 1:
            raise BadArgument(f"{given[1]}", f"must not be given beside `{given[0]}`: both say where the robot was")
        if self.body is not None and self.joint_angle is None:
            raise BadArgument("joint_angle", "must be given with `body`: one link does not say where the others are")
        for name, section in UNITS.items():
            columns = getattr(self, name)
            if columns is not None and columns.unit is not None:
                one_of(f"{name}.unit", columns.unit, tuple(section))


def _unit(name: str, value: object, units: Mapping[str, float]) -> None:
    if value is not None:
        one_of(name, value, tuple(units))


def _pair(name: str, value: object, unit: str) -> tuple[float, float]:
    items = _items(value)
    if items is None or len(items) != 2:
        raise BadArgument(f"{name}", f"must be two numbers in {unit}, got {value!r}")
    return finite(name, items[0], unit), finite(name, items[1], unit)


def _names(name: str, value: object, sizes: tuple[int, ...] | None) -> tuple[str, ...]:
    items = _items(value)
    names = [one for one in items or () if isinstance(one, str)]
    if items is None or len(names) != len(items) or (sizes is not None and len(names) not in sizes):
        wanted = "" if sizes is None else f"{' or '.join(map(str, sizes))} "
        raise BadArgument(f"{name}", f"must be a list of {wanted}names of columns, got {value!r}")
    return tuple(names)


def _items(value: object) -> list[object] | None:
    return list(cast("Sequence[object]", value)) if isinstance(value, list | tuple) else None
