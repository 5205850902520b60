"""The sections of a column map: where time, position, joints and power are in the columns of a log.

Every section is a value class; `column_maps` joins them to a map. Units are those of the file;
factors convert them to SI.
"""

from typing import Any, Literal, TypeAlias

from laticauda.values import BadArgument, check_finite, option, quantity, value_class
from laticauda.values.tables import ANGLES, RATES, TORQUES

JOINT_UNITS = {
    "joint_angle": ANGLES,
    "joint_angle_ref": ANGLES,
    "joint_rate": RATES,
    "joint_torque": TORQUES,
}
"""Units of the joint columns by section; the first is the default."""
AXES = ("X", "Y", "Z")
"""Axes at the end of the names of position columns."""

LengthUnit: TypeAlias = Literal["m", "cm", "mm"] | None
AngleUnit: TypeAlias = Literal["rad", "deg"] | None
PositionColumns: TypeAlias = tuple[str, str] | tuple[str, str, str]
RotationColumns: TypeAlias = tuple[str, str, str, str, str, str, str, str, str]
Direction: TypeAlias = Literal["x", "-x", "y", "-y", "z", "-z"]
"""An axis of the file or of a tracked body, or its opposite."""

_LENGTH_UNIT = "Unit of length; None: the one stated in the file, else m"
_ANGLE_UNIT = "Unit of the angle; None: the one stated in the file, else rad"
_POSITION_COLUMNS = "Columns of the position: x and y, or x, y and z"


@value_class
class TimeColumn:
    """Times of the rows; if neither field is given, the file itself must state them."""

    column: str | None = option("Name of the column", default=None)
    unit: Literal["s", "ms", "us", "ns"] | None = option(
        "Unit of the column; None: the one that the file or its name states, else s; times since "
        "1970 are recognized",
        default=None,
    )
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

    position: PositionColumns = option(_POSITION_COLUMNS)
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
    position: PositionColumns | None = option(_POSITION_COLUMNS, default=None)
    length_unit: LengthUnit = option(_LENGTH_UNIT, default=None)
    yaw: str | None = option(
        "Column of its angle about the vertical axis in the file", default=None
    )
    angle_unit: AngleUnit = option(_ANGLE_UNIT, default=None)
    quaternion: tuple[str, str, str, str] | None = option(
        "Columns w, x, y, z, instead of `yaw`", default=None
    )
    rotation: RotationColumns | None = option(
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
        orientations = (self.yaw, self.quaternion, self.rotation)
        n_orientations = sum(columns is not None for columns in orientations)
        n_needed = int(self.name is None)
        if n_orientations != n_needed:
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
    unit: str | None = option(
        "Unit of the columns; None: the one stated in the file, else SI", default=None
    )
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
        names = self._names_in_order_of_file(n_joints)
        if len(names) != n_joints:
            rule = f"must have {n_joints} names, one per joint of the robot, got {len(names)}"
            raise BadArgument("columns", rule)
        if self.head_first:
            names.reverse()
        return names

    def _names_in_order_of_file(self, n_joints: int) -> list[str]:
        if not isinstance(self.columns, str):
            return list(self.columns)
        numbers = range(self.first, self.first + n_joints)
        return [self.columns.replace("{}", str(number)) for number in numbers]


def _check_voltage(name: str, voltage: Any) -> str | float | None:
    """Return the name of a column, or a number [V]."""
    if voltage is None or isinstance(voltage, str):
        return voltage
    return check_finite(name, voltage, "V")


@value_class
class Power:
    """Electrical power, from a meter in the supply line."""

    column: str | None = option(
        "Column of the power [W], instead of current and voltage", default=None
    )
    current: str | None = option("Column of the current [A]", default=None)
    voltage: str | float | None = option(
        "Column of the voltage, or its value [V]", default=None, check=_check_voltage
    )
    idle: float | None = quantity(
        "W", "Idle power, subtracted; None: the robot's `idle_power`", default=None, ge=0.0
    )

    def __post_init__(self) -> None:
        """Check that the fields fit together."""
        has_power = self.column is not None
        has_current = self.current is not None
        has_voltage = self.voltage is not None
        if has_power == has_current or has_current != has_voltage:
            rule = f"must be given, or `current` and `voltage`, but not both; got {self.column!r}"
            raise BadArgument("column", rule)
