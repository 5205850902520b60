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

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, Literal

from laticauda.motion import gaits
from laticauda.robot import Environment, Robot
from laticauda.scenarios import NAMES, take_chosen
from laticauda.trials.logs.map_sections import (
    JOINT_UNITS,
    Body,
    Ends,
    Frame,
    Heading,
    JointColumns,
    Position,
    Power,
    TimeColumn,
)
from laticauda.values import (
    BadArgument,
    TrialFileError,
    check_choice,
    codec,
    files,
    option,
    quantity,
    show_value,
    value_class,
)

STRAIGHT = gaits.Gait(amplitude=0.0, frequency=0.0, phase_shift=0.0)
"""Stands for an unknown gait where a gait is needed to choose the water."""


def _check_signals(name: str, table: Any) -> dict[str, str]:
    if not hasattr(table, "values") or not all(isinstance(text, str) for text in table.values()):
        raise BadArgument(name, f"must be a table of names of columns, got {show_value(table)}")
    return dict(table)


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
    decimal: Literal[".", ","] | None = option(
        "Decimal point or comma; None: detected", default=None
    )
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
        "Columns kept as is, by name", default_factory=dict[str, str], check=_check_signals
    )

    def __post_init__(self) -> None:
        """Check that the fields fit together."""
        if self.start is not None and self.stop is not None and self.stop <= self.start:
            raise BadArgument("stop", f"must be > `start` = {self.start:g} s, got {self.stop:g}")
        sections = {"center_of_mass": self.center_of_mass, "body": self.body, "ends": self.ends}
        present = [name for name, section in sections.items() if section is not None]
        if len(present) > 1:
            first, second = present[:2]
            rule = f"must not be given beside `{first}`: both say where the robot was"
            raise BadArgument(second, rule)
        if self.body is not None and self.joint_angle is None:
            rule = "must be given with `body`: one link does not say where the others are"
            raise BadArgument("joint_angle", rule)
        for name, columns in self.joint_sections().items():
            if columns.unit is not None:
                check_choice(f"{name}.unit", columns.unit, tuple(JOINT_UNITS[name]))

    def joint_sections(self) -> dict[str, JointColumns]:
        """Return the sections with a column per joint that the map has, by name."""
        sections = {
            "joint_angle": self.joint_angle,
            "joint_angle_ref": self.joint_angle_ref,
            "joint_rate": self.joint_rate,
            "joint_torque": self.joint_torque,
        }
        return {name: columns for name, columns in sections.items() if columns is not None}


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
        table = files.read_toml(path, TrialFileError)
        return _decode_column_map(table, path.parent)


def _decode_column_map(table: codec.Table, folder: Path) -> ColumnMap:
    """Return the map that a table describes; files that it names are first searched in the folder."""
    codec.take_kind(table, "columns")
    if "robot" not in table:
        raise codec.BadKey("robot", "is missing; every column map needs it")
    # The environment is named by `water` or `ground`, which are among `NAMES`.
    known_keys = [field.name for field in fields(ColumnMap) if field.name != "environment"]
    codec.check_keys(table, [*known_keys, *NAMES])
    gait = None
    if "gait" in table:
        gait = codec.decode(gaits.Gait, table.pop("gait"), "gait")
    chosen = take_chosen(table, gait or STRAIGHT, folder)
    values = {"robot": chosen.robot, "environment": chosen.environment, **table, "gait": gait}
    return codec.decode(ColumnMap, values)
