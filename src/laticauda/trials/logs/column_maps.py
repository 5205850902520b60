"""Column maps: the meaning of the columns of an external log, as a value and as a small TOML file.

    kind = "columns"
    robot = "mamba-fin"
    start = 2.0                        # the part of the log that is the trial [s]
    stop = 32.0

    [gait]
    kind = "lateral-undulation"
    amplitude_deg = 30
    frequency_deg_s = 130
    phase_shift_deg = 40

    [body]                             # tracked by motion capture
    position = ["tail x", "tail y"]
    length_unit = "mm"
    yaw = "tail yaw"
    angle_unit = "deg"

    [joint_angle]
    columns = "phi {}"                 # phi 0 is the tail-most joint
    unit = "deg"

Column maps are read strictly: unknown keys, missing keys and values out of range are rejected,
naming the key.
"""

import math
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, Literal, TypeAlias

from laticauda.motion import gaits
from laticauda.robot import Environment, Robot
from laticauda.scenarios import NAMES, take_chosen
from laticauda.values import (
    BadArgument,
    TrialFileError,
    check_choice,
    check_finite,
    codec,
    files,
    option,
    quantity,
    show_value,
    value_class,
)

LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}
ANGLES = {"rad": 1.0, "deg": math.pi / 180.0}
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6}
RATES = {"rad/s": 1.0, "deg/s": math.pi / 180.0}
TORQUES = {"N m": 1.0, "N cm": 1e-2, "N mm": 1e-3}
UNITS = {
    "joint_angle": ANGLES,
    "joint_angle_ref": ANGLES,
    "joint_rate": RATES,
    "joint_torque": TORQUES,
}
"""Units of the joint columns by section; the first is the default."""
AXES = ("X", "Y", "Z")
STRAIGHT = gaits.Gait(amplitude=0.0, frequency=0.0, phase_shift=0.0)

LengthUnit: TypeAlias = Literal["m", "cm", "mm"] | None
AngleUnit: TypeAlias = Literal["rad", "deg"] | None
Axes: TypeAlias = tuple[str, str] | tuple[str, str, str]
Matrix: TypeAlias = tuple[str, str, str, str, str, str, str, str, str]
Direction: TypeAlias = Literal["x", "-x", "y", "-y", "z", "-z"]

_LENGTH_UNIT = "Unit of length; None: the one stated in the file, else m"
_ANGLE_UNIT = "Unit of the angle; None: the one stated in the file, else rad"
_PLACE = "Columns of the position: x and y, or x, y and z"


@value_class
class TimeColumn:
    """Times of the rows; if neither field is given, the file itself must state them."""

    column: str | None = option("Name of the column", default=None)
    unit: Literal["s", "ms", "us"] = option("Unit of the column", default="s")
    rate: float | None = quantity(
        "Hz", "Rows per second, instead of a column", default=None, gt=0.0
    )

    def __post_init__(self) -> None:
        """Check that the fields fit together."""
        if self.rate is not None and self.column is not None:
            raise BadArgument("rate", f"must not be given beside `column`, got {self.rate}")


@value_class
class Frame:
    """Pose of the trial's world axes in the axes of the file: first aligned, then shifted, then rotated."""

    x: Direction = option("Direction in the file that is forward", default="x")
    y: Direction = option("Direction in the file that is left", default="y")
    origin: tuple[float, float] = quantity(
        "m", "Position of the trial's origin, along those two", default=(0.0, 0.0)
    )
    rotation_deg: float = quantity(
        "deg", "Angle by which the result is rotated, counter-clockwise", default=0.0
    )

    def __post_init__(self) -> None:
        """Check that the fields fit together."""
        if self.x[-1] == self.y[-1]:
            raise BadArgument(
                "y", f"must be a different axis from `x` = {self.x!r}, got {self.y!r}"
            )


@value_class
class Position:
    """A position whose columns represent the center of mass itself, such as the mean of many markers."""

    position: Axes = option(_PLACE)
    length_unit: LengthUnit = option(_LENGTH_UNIT, default=None)


@value_class
class Heading:
    """The heading, for logs without joint angles to derive it from."""

    column: str = option("Name of the column")
    unit: AngleUnit = option(_ANGLE_UNIT, default=None)


@value_class
class Body:
    """One link tracked by motion capture; together with the joint angles it determines the whole robot."""

    name: str | None = option(
        "Name of a rigid body in a QTM file, instead of all columns below", default=None
    )
    position: Axes | None = option(_PLACE, default=None)
    length_unit: LengthUnit = option(_LENGTH_UNIT, default=None)
    yaw: str | None = option(
        "Column of its angle about the vertical axis in the file", default=None
    )
    angle_unit: AngleUnit = option(_ANGLE_UNIT, default=None)
    quaternion: tuple[str, str, str, str] | None = option(
        "Columns w, x, y, z, instead of `yaw`", default=None
    )
    rotation: Matrix | None = option(
        "Columns of its rotation matrix, x axis first, instead of `yaw`", default=None
    )
    forward: Direction = option("Axis of the body that points to the head", default="x")
    link: int = quantity(
        "", "Link that carries it, 0 = tail; of the planar chain if joints pitch", default=0, ge=0
    )
    offset: tuple[float, float] = quantity(
        "m", "Position from mid-link: toward the head, left", default=(0.0, 0.0)
    )
    angle_offset_deg: float = quantity(
        "deg", "Angle of the link minus the angle of the body", default=0.0
    )

    def __post_init__(self) -> None:
        """Check that the fields fit together."""
        if (self.name is None) == (self.position is None):
            raise BadArgument(
                "position", f"must be given, or `name`, but not both; got {self.position}"
            )
        turns = [one for one in (self.yaw, self.quaternion, self.rotation) if one is not None]
        if len(turns) != (1 if self.name is None else 0):
            rule = "must be given, or `quaternion` or `rotation`, exactly one of them; none with `name`"
            raise BadArgument("yaw", rule)


@value_class
class Ends:
    """A marker on the tail end, on every joint and on the head end: no joint angles are needed."""

    markers: tuple[str, ...] = option(
        "Names of the markers, tail first: one more than the robot has links"
    )
    columns: str = option(
        "Names of their columns; the axis is X, Y or Z", default="{marker} {axis}"
    )
    length_unit: LengthUnit = option(_LENGTH_UNIT, default=None)

    def __post_init__(self) -> None:
        """Check that the fields fit together."""
        if "{marker}" not in self.columns or "{axis}" not in self.columns:
            raise BadArgument("columns", f"must hold {{marker}} and {{axis}}, got {self.columns!r}")


@value_class
class JointColumns:
    """One column per joint."""

    columns: str | tuple[str, ...] = option("Names, tail first; or one name with {} for the number")
    first: int = quantity(
        "", "Number of the tail-most joint, if they are numbered", default=0, ge=0
    )
    head_first: bool = option("Whether the first column is of the head-most joint", default=False)
    unit: str | None = option("Unit of the columns; None: SI", default=None)
    sign: float = quantity(
        "", "-1 if positive values in the file turn the robot right", default=1.0
    )

    def __post_init__(self) -> None:
        """Check that the fields fit together."""
        if isinstance(self.columns, str) and "{}" not in self.columns:
            raise BadArgument(
                "columns",
                f"must be a list of names, or hold {{}} for the number, got {self.columns!r}",
            )
        if self.sign not in (1.0, -1.0):
            raise BadArgument("sign", f"must be 1 or -1, got {self.sign}")

    def names(self, n_joints: int) -> list[str]:
        """Return the names of the columns, tail first.

        Args:
            n_joints: Number of joints.

        Raises:
            ValueError: If the number of names differs from this.
        """
        if isinstance(self.columns, str):
            found = [self.columns.replace("{}", str(self.first + i)) for i in range(n_joints)]
        else:
            found = list(self.columns)
        if len(found) != n_joints:
            rule = f"must have {n_joints} names, one per joint of the robot, got {len(found)}"
            raise BadArgument("columns", rule)
        return found[::-1] if self.head_first else found


def _voltage(name: str, given: Any) -> str | float | None:
    return given if given is None or isinstance(given, str) else check_finite(name, given, "V")


@value_class
class Power:
    """Electrical power, from a meter in the supply line."""

    column: str | None = option(
        "Column of the power [W], instead of current and voltage", default=None
    )
    current: str | None = option("Column of the current [A]", default=None)
    voltage: str | float | None = option(
        "Column of the voltage, or its value [V]", default=None, check=_voltage
    )
    idle: float | None = quantity(
        "W", "Idle power, subtracted; None: the robot's `idle_power`", default=None, ge=0.0
    )

    def __post_init__(self) -> None:
        """Check that the fields fit together."""
        if (self.column is None) == (self.current is None) or (self.current is None) != (
            self.voltage is None
        ):
            rule = f"must be given, or `current` and `voltage`, but not both; got {self.column!r}"
            raise BadArgument("column", rule)


def _signals(name: str, given: Any) -> dict[str, str]:
    if not hasattr(given, "values") or not all(isinstance(one, str) for one in given.values()):
        raise BadArgument(name, f"must be a table of names of columns, got {show_value(given)}")
    return dict(given)


@value_class
class ColumnMap:
    """The meaning of the columns of a log, and the robot that it belongs to."""

    robot: Robot = option("Robot that swam")
    environment: Environment = option("Water or ground that it was in")
    gait: gaits.Gait | None = option("Commanded gait; None if it is not known", default=None)
    start: float | None = quantity(
        "s", "Time in the file at which the trial begins, its time 0", default=None
    )
    stop: float | None = quantity("s", "Time in the file at which the trial ends", default=None)
    longest_gap: float = quantity(
        "s",
        "Gaps up to this long are interpolated linearly; longer ones are refused",
        default=0.1,
        ge=0.0,
    )
    smoothing: float = quantity(
        "s", "Rates are the slopes of cubic fits over this time", default=0.1, gt=0.0
    )
    separator: str | None = option(
        "Separator of the cells of a text file; None: detected", default=None
    )
    decimal: Literal[".", ","] = option("Decimal point or comma", default=".")
    time: TimeColumn = option("Times of the rows", default=TimeColumn())
    frame: Frame = option("World axes", default=Frame())
    center_of_mass: Position | None = option(
        "This, `body` or `ends`; none: a table by laticauda", default=None
    )
    heading: Heading | None = option("The heading, beside `center_of_mass`", default=None)
    body: Body | None = option("One tracked link", default=None)
    ends: Ends | None = option("Markers at the ends of all links", default=None)
    joint_angle: JointColumns | None = option("Angles of the joints", default=None)
    joint_rate: JointColumns | None = option(
        "Rates of the joints; None: computed from the angles", default=None
    )
    joint_angle_ref: JointColumns | None = option("Commanded angles of the joints", default=None)
    joint_torque: JointColumns | None = option("Torques of the joints", default=None)
    power: Power | None = option("Electrical power", default=None)
    signals: Mapping[str, str] = option(
        "Columns kept as is, by name", default_factory=dict[str, str], check=_signals
    )

    def __post_init__(self) -> None:
        """Check that the fields fit together."""
        if self.start is not None and self.stop is not None and self.stop <= self.start:
            raise BadArgument("stop", f"must be > `start` = {self.start:g} s, got {self.stop:g}")
        given = [
            name for name in ("center_of_mass", "body", "ends") if getattr(self, name) is not None
        ]
        if len(given) > 1:
            raise BadArgument(
                given[1], f"must not be given beside `{given[0]}`: both say where the robot was"
            )
        if self.body is not None and self.joint_angle is None:
            rule = "must be given with `body`: one link does not say where the others are"
            raise BadArgument("joint_angle", rule)
        for name, section in UNITS.items():
            columns: JointColumns | None = getattr(self, name)
            if columns is not None and columns.unit is not None:
                check_choice(f"{name}.unit", columns.unit, tuple(section))


# ---- files ---------------------------------------------------------------------------------------


def load_column_map(path: str | Path) -> ColumnMap:
    """Load a column map.

    Args:
        path: Path of the TOML file; presets and files that it names are resolved as by
            `load_robot`.

    Raises:
        TrialFileError: If there is no such file, or anything in it is wrong; the message gives the
            file, the key, the rule and the value.
    """
    path = Path(path)
    with codec.keys_of(path, TrialFileError):
        return _column_map(files.read_toml(path, TrialFileError), path.parent)


def _column_map(table: codec.Table, folder: Path) -> ColumnMap:
    codec.take_kind(table, "columns")
    if "robot" not in table:
        raise codec.BadKey("robot", "is missing; every column map needs it")
    known = [one.name for one in fields(ColumnMap) if one.name != "environment"]
    codec.check_keys(table, [*known, *NAMES])
    gait = codec.decode(gaits.Gait, table.pop("gait"), "gait") if "gait" in table else None
    chosen = take_chosen(table, gait or STRAIGHT, folder)
    return codec.decode(
        ColumnMap, {"robot": chosen.robot, "environment": chosen.environment, **table, "gait": gait}
    )
