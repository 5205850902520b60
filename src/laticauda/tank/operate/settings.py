"""Settings of operations and of series, and their TOML files.

    kind = "trial"
    name = "line-1"
    robot = "mamba"
    duration = 60.0

    [gait]
    kind = "lateral-undulation"
    amplitude_deg = 30
    frequency_deg_s = 90
    phase_shift_deg = 40

    [following]                    # left out: open loop
    look_ahead_distance = 0.18

Tables and keys are the fields of `Operation` and of the classes it holds, read strictly. Units are
SI; an angle may be given in degrees with the suffix ``_deg``, an angular rate with ``_deg_s``. A
series file has the kind ``series``, the number of `repeats`, a table ``[common]`` of what all
trials share, and a list ``[[trials]]`` of what differs.

There are two frames. The tank frame is the one to which the motion capture was calibrated; the path
frame is the world frame of everything else, with the path along its x axis in the paper's trials.
"""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from laticauda import control, scenarios
from laticauda.control import estimation, transform_to_axes
from laticauda.control.estimation import Offset
from laticauda.motion import gaits
from laticauda.motion.joints import Servo
from laticauda.robot import Parameters, Robot, Water, load_parameters, load_robot
from laticauda.scenarios import interfaces
from laticauda.tank.operate import drivers
from laticauda.tank.protocol.can import GROUP, PORT
from laticauda.values import (
    BadArgument,
    LaticaudaError,
    codec,
    files,
    option,
    quantity,
    value_class,
)

Vector: TypeAlias = NDArray[np.float64]
"""A position or velocity, with two or three components."""
SLOWEST_RATE = 10.0
"""Ticks per second below which references time out in the modules [1/s]."""
FASTEST_RATE = 500.0
"""Ticks per second above which the bus is full [1/s]."""
REST_SPEED = 0.01
"""Speed up to which a robot moves toward no edge: it may swim away from it [m/s]."""
REQUIRED_DEVICES = ("bus", "mocap")
"""Kinds of devices without which there is no operation."""


@value_class
class Placement:
    """Where the robot has to be placed before the run, in the path frame."""

    position: tuple[float, float] = quantity("m", "of the center of mass")
    heading: float = quantity("rad", "of the robot", default=0.0)
    tolerance: float = quantity(
        "m", "how far off it may be before the run is refused", gt=0.0, default=0.3
    )
    heading_tolerance: float = quantity(
        "rad", "the same for the heading", gt=0.0, default=math.radians(15.0)
    )


@value_class
class Connection:
    """Driver and address of each device; the driver defines what an address looks like.

    `laticauda drivers` lists the available drivers, and tries a single one.
    """

    bus: str = option("driver of the modules' bus", default="can")
    bus_address: str = option("its address", default=f"udp_multicast:{GROUP}:{PORT}")
    mocap: str = option("driver of the motion capture", default="qtm")
    mocap_address: str = option("its address", default="127.0.0.1:22223")
    mocap_body: str = option(
        "rigid body, FRONT+BACK+LEFT markers or SKELETON/SEGMENT; empty: the only one", default=""
    )
    meter: str = option("driver of the power meter", default="fluke")
    meter_address: str = option('its address; "" for none', default="")
    stop: str = option("driver of the emergency-stop input", default="serial-line")
    stop_address: str = option('its address; "" for none', default="")
    sensors: str = option("driver of the robot's own sensors", default="udp-readings")
    sensors_address: str = option('its address; "" for none', default="")

    def __post_init__(self) -> None:
        """Reject unknown drivers, and addresses that are invalid for their driver."""
        for kind in drivers.KINDS:
            name, address = self.of(kind)
            if address or kind in REQUIRED_DEVICES:
                drivers.driver_named(kind, name, address)

    def of(self, kind: str) -> tuple[str, str]:
        """Return driver and address of the device of this `kind`, one of `drivers.KINDS`."""
        return getattr(self, kind), getattr(self, f"{kind}_address")

    def opened(self, kind: str, clock: drivers.Clock) -> Any:
        """Connect to a device, and return its driver.

        Args:
            kind: One of `drivers.KINDS`.
            clock: Clock that timestamps incoming data.

        Raises:
            DeviceFailed: If the device cannot be reached; the message says what to check.
            MissingExtra: If a library is not installed.
        """
        name, address = self.of(kind)
        driver_class = drivers.driver_named(kind, name, address)
        if kind == "mocap":
            return driver_class(address, clock, body=self.mocap_body)
        return driver_class(address, clock)

    def at(self, **typed: str | None) -> "Connection":
        """Return a copy with other devices, given in the form in which users type them.

        Args:
            typed: By kind: DRIVER@ADDRESS, or ADDRESS for the same driver; None: unchanged.

        Raises:
            ValueError: If a driver is unknown, or an address is invalid.
        """
        changes: dict[str, str] = {}
        for kind, text in typed.items():
            if text is None:
                continue
            name, _, address = text.rpartition("@")
            if name:
                changes[kind] = name
            changes[f"{kind}_address"] = address
        try:
            return replace(self, **changes)
        except BadArgument as error:
            raise BadArgument(error.name.removesuffix("_address"), error.rule) from None


@value_class
class CaptureVolume:
    """Part of the tank that the motion capture covers, and where the path lies; tank frame."""

    volume_x: tuple[float, float] = quantity(
        "m", "extent of the measuring volume along the tank", default=(0.0, 12.0)
    )
    volume_y: tuple[float, float] = quantity(
        "m", "its extent across the tank", default=(-2.725, 2.725)
    )
    path_origin: tuple[float, float] = quantity("m", "origin of the path frame", default=(0.0, 0.0))
    path_heading: float = quantity("rad", "direction of its x axis", default=0.0)
    surface: float = quantity(
        "m", "height of the water's surface, where z of the path frame is 0", default=0.0
    )

    def __post_init__(self) -> None:
        """Reject a volume whose limits are in the wrong order."""
        for name in ("volume_x", "volume_y"):
            low, high = getattr(self, name)
            if low >= high:
                raise BadArgument(
                    name, f"must be a lower and an upper limit in m, got {(low, high)!r}"
                )

    def to_path(self, position: Vector) -> Vector:
        """Transform a position from the tank frame to the path frame [m]."""
        in_plane = transform_to_axes(self.path_origin, self.path_heading, position)
        height = position[2:] - self.surface
        return np.array([*in_plane, *height])

    def to_tank(self, position: Vector) -> Vector:
        """Transform a position from the path frame to the tank frame [m]."""
        x, y = transform_to_axes((0.0, 0.0), -self.path_heading, position)
        origin_x, origin_y = self.path_origin
        height = position[2:] + self.surface
        return np.array([origin_x + x, origin_y + y, *height])

    def room(self, position: Vector, velocity: Vector) -> float:
        """Return the distance to the edge that the robot moves toward [m].

        It is infinite if it moves toward none.

        Args:
            position: Position in the tank frame [m].
            velocity: Velocity in the tank frame [m/s].
        """
        room = math.inf
        for axis, (lower_edge, upper_edge) in enumerate((self.volume_x, self.volume_y)):
            if velocity[axis] > REST_SPEED:
                room = min(room, upper_edge - position[axis])
            elif velocity[axis] < -REST_SPEED:
                room = min(room, position[axis] - lower_edge)
        return float(room)


@value_class
class Calibration:
    """Settings of the measurements before a run.

    With `joint_zeros`, the reported angles of the limp joints become zero if a module has had no
    zero since power-on; the robot must then lie straight, against a ruler. With `straight_heading`,
    `marker_yaw` is measured.
    """

    joint_zeros: bool = option("whether joint zeros are measured", default=False)
    max_joint_zero: float = quantity(
        "rad", "largest zero that is accepted", gt=0.0, default=math.radians(5.0)
    )
    marker_module: int = quantity(
        "", "the module that carries the rigid body, 0 = tail", ge=0, default=0
    )
    marker_offset: Offset = quantity(
        "m", "of the body from mid-module: toward the head, left, up", default=(0.0, 0.0)
    )
    marker_yaw: float = quantity(
        "rad", "direction of the rigid body's x axis relative to the module's", default=0.0
    )
    straight_heading: float | None = quantity(
        "rad", "of the straight robot in the tank, if known", default=None
    )
    idle_time: float = quantity(
        "s", "time over which the current at rest is averaged", gt=0.0, default=3.0
    )
    still_speed: float = quantity(
        "m/s", "speed below which the robot is still", gt=0.0, default=0.01
    )
    still_rate: float = quantity(
        "rad/s", "the same for its turning rate", gt=0.0, default=math.radians(2.0)
    )
    still_time: float = quantity("s", "time for which it has to be still", gt=0.0, default=2.0)
    patience: float = quantity(
        "s", "how long to wait for that before giving up", gt=0.0, default=120.0
    )

    @property
    def mount(self) -> estimation.Mount:
        """Where the rigid body of the motion capture is mounted."""
        return estimation.Mount(
            module=self.marker_module, offset=self.marker_offset, angle=self.marker_yaw
        )


@value_class
class Limits:
    """Limits that the safety supervisor enforces.

    `current_time` is longer than the model's servos stall under the water's load, about 2 s with
    the fin. `max_joint_error` is wide because they lag by up to 47 deg for 1.3 s when a hard turn
    and the gait begin at the same time. `max_lateness` is less than the 0.2 s after which the
    modules hold without references.
    """

    max_temperature: float = quantity("degC", "of a module", gt=0.0, default=70.0)
    max_current: float = quantity(
        "A", "of a motor, longer than `current_time`", gt=0.0, default=4.4
    )
    current_time: float = quantity("s", "for which a motor may draw more", gt=0.0, default=3.0)
    min_voltage: float = quantity("V", "of the supply at a module", gt=0.0, default=28.0)
    max_voltage: float = quantity("V", "of the supply at a module", gt=0.0, default=math.inf)
    max_joint_error: float = quantity(
        "rad", "for longer than `joint_error_time`", gt=0.0, default=math.radians(45.0)
    )
    joint_error_time: float = quantity(
        "s", "for which a joint may be off by more", gt=0.0, default=2.0
    )
    heartbeat_timeout: float = quantity(
        "s", "a module that is silent for longer is lost", gt=0.0, default=0.5
    )
    joint_timeout: float = quantity(
        "s", "a joint whose angle is older is lost", gt=0.0, default=0.3
    )
    mocap_timeout: float = quantity(
        "s", "of the estimator without the motion capture", gt=0.0, default=1.5
    )
    meter_timeout: float = quantity("s", "the same for the power meter", gt=0.0, default=3.0)
    max_lateness: float = quantity("s", "of one tick", gt=0.0, default=0.15)
    edge_margin: float = quantity(
        "m", "distance to the edge of the volume at which to stop", gt=0.0, default=0.25
    )
    straighten_time: float = quantity(
        "s", "for the robot to straighten before it goes limp", gt=0.0, default=2.0
    )
    straight: float = quantity(
        "rad", "within this, a joint counts as straight", gt=0.0, default=math.radians(4.0)
    )


@value_class
class Acceptance:
    """Limits for accepting a run that reached its end, one for each check of its verdict.

    Those of speed, sideslip and turning limit changes in the run relative to the model;
    `missing_answers`, `time_late`, `model_speed` and `without_zero` are only noted. What the first
    four limit may be why others are exceeded.

    `longest_silence` is more than the 0.3 s after which the supervisor usually stops a run
    (`Limits.joint_timeout`), and less than the 0.8 s from which a module that is cut off may have
    gone limp: nothing else vouches for a robot that nobody has heard for so long.
    `missing_in_run` is a half: with more, most of what the other checks see is interpolated.
    """

    missing_answers: float = quantity(
        "", "share of a cycle's answers of a module that did not come", gt=0.0, default=0.1
    )
    time_late: float = quantity(
        "", "share of a cycle's time by which this computer was late", gt=0.0, default=0.1
    )
    missing_in_run: float = quantity(
        "", "share of the run's answers of a module that did not come", gt=0.0, default=0.5
    )
    longest_silence: float = quantity(
        "s", "longest time in the run without an answer of a module", gt=0.0, default=0.5
    )
    joint_error: float = quantity(
        "rad", "joint error not explained by its servo", gt=0.0, default=math.radians(3.0)
    )
    angle_jump: float = quantity(
        "rad", "joint-angle jump not explained by its rate", gt=0.0, default=math.radians(3.0)
    )
    marker_jump: float = quantity(
        "rad", "jump of heading from markers and joints", gt=0.0, default=math.radians(3.0)
    )
    swing_error: float = quantity(
        "", "difference of the markers' swing from the model's", gt=0.0, default=0.2
    )
    speed_change: float = quantity(
        "", "change of the speed relative to the model's", gt=0.0, default=0.2
    )
    sideslip_change: float = quantity(
        "", "change of the sideslip relative to the model's", gt=0.0, default=0.1
    )
    turn_change: float = quantity(
        "rad", "change of turning relative to the model's", gt=0.0, default=math.radians(0.6)
    )
    model_speed: float = quantity(
        "", "log ratio of speed to the model's (`laticauda identify`)", gt=0.0, default=0.25
    )
    pose_age: float = quantity(
        "s", "median age of the cameras' poses, also at the end alone", gt=0.0, default=0.25
    )
    clock_drift: float = quantity(
        "s/s", "drift of the cameras' clock against ours", gt=0.0, default=2e-4
    )
    water_speed: float = quantity(
        "m/s", "drift of the straight robot before the run", gt=0.0, default=0.01
    )
    without_zero: float = quantity(
        "", "modules without a zero (`joint_zeros` sets them)", gt=0.0, default=0.5
    )


@value_class
class Operation:
    """One run of a robot, from the connections to the last command: the content of a trial file."""

    name: str = option("base name of its files")
    robot: str = option(
        "a preset or a TOML file; CAN node k drives its joint k - 1, tail first", default="mamba"
    )
    water: str | None = option(
        "a preset, a TOML file or textbook; None: the robot's usual water", default=None
    )
    parameters: str | None = option(
        "a preset or a parameter file: its numbers for water, joints, fin and power, by which the run is estimated and "
        "judged (not with a water); None: the robot's own, with servos in its joints",
        default=None,
    )
    gait: gaits.Gait = option("motion of the joints")
    following: control.Following | None = option("path following; None: open loop", default=None)
    steering: interfaces.Controller[Any] | None = option(
        "controller of any kind, as in a scenario file, with its gait instead of `gait` (not with `following`); None: "
        "path following or open loop",
        default=None,
    )
    start: Placement | None = option("where the robot is put; None: anywhere", default=None)
    duration: float = quantity(
        "s", "after which the run ends, unless the tank ends first", gt=0.0, default=90.0
    )
    rate: float = quantity(
        "1/s", "ticks per second", ge=SLOWEST_RATE, le=FASTEST_RATE, default=100.0
    )
    countdown: float = quantity("s", "before the run begins", ge=0.0, default=3.0)
    ramp: float = quantity("s", "of the smooth start", ge=0.0, default=3.0)
    offset_bandwidth: float = quantity(
        "rad/s",
        "of the filter on the steering, which delays it by 2 divided by this",
        gt=0.0,
        default=25.0,
    )
    supply_voltage: float | None = quantity(
        "V",
        "V of (4), to turn the power meter's current into power; required with a meter",
        gt=0.0,
        default=None,
    )
    estimator: Literal["filter", "kinematics"] = option(
        "state estimator; kinematics, always used in space, does not bridge dropouts",
        default="filter",
    )
    connection: Connection = option(
        "drivers and addresses of the devices", default_factory=Connection
    )
    tank: CaptureVolume = option(
        "measuring volume, and where the path lies in the tank", default_factory=CaptureVolume
    )
    calibration: Calibration = option("measurements before the run", default_factory=Calibration)
    limits: Limits = option("limits that the safety supervisor enforces", default_factory=Limits)
    acceptance: Acceptance = option("limits for accepting the run", default_factory=Acceptance)
    learning: estimation.Learning | None = option(
        "what a digital twin learns; None: nothing", default=None
    )

    def __post_init__(self) -> None:
        """Check the name, and the rules that involve two fields."""
        if not self.name.replace("-", "").replace("_", "").isalnum():
            raise BadArgument(
                "name", f"must be a file name of letters, digits, `-` and `_`, got {self.name!r}"
            )
        if self.parameters is not None and self.water is not None:
            raise BadArgument("parameters", "must not be given with `water`: both define the water")
        if self.steering is not None:
            if self.following is not None:
                raise BadArgument("steering", "must not be given with `following`: one steers")
            object.__setattr__(self, "gait", self.steering.gait)
        if self.supply_voltage is None and self.connection.meter_address:
            raise BadArgument(
                "supply_voltage",
                "must be given in V with a power meter, to turn its current into power, got None",
            )
        if self.learning is not None and self.in_space:
            raise BadArgument("learning", "must be left out in space, where nothing is learned")

    @property
    def in_space(self) -> bool:
        """Whether depth and pitch are measured: on a path in space, or if pitch joints move."""
        if self.gait.pitch is not None:
            return True
        return self.following is not None and self.following.path_depth is not None

    def body(self) -> Robot:
        """Return the robot, with the numbers of the parameters.

        Raises:
            RobotFileError: If there is no robot or no parameters of that name, or their file is
                invalid.
            ValueError: If its joints cannot do what the controller may command.
        """
        robot = load_robot(self.robot)
        parameters = self._load_parameters()
        if parameters is not None:
            robot = parameters.robot(robot, self.gait.kind)
        interfaces.check_waves(robot, self.gait)
        self.controller().check(robot)
        return robot

    def pool(self) -> Water:
        """Return the water, of the parameters if there are any.

        Raises:
            RobotFileError: If there is no robot, water or parameters of that name, or their file is
                invalid.
        """
        parameters = self._load_parameters()
        if parameters is not None:
            return parameters.water(self.gait.kind)
        return scenarios.water_for(load_robot(self.robot), self.water)

    def joint_law(self) -> Servo:
        """Return the law of the joints, by which the run is estimated and judged.

        It is that of the parameters. Modules are servos: where the parameters are without a law, or
        with joints that are not servos, it is that of a servo.

        Raises:
            RobotFileError: If there are no parameters of that name, or their file is invalid.
        """
        parameters = self._load_parameters()
        if parameters is None:
            return Servo()
        return parameters.servos

    def _load_parameters(self) -> Parameters | None:
        if self.parameters is None:
            return None
        return load_parameters(self.parameters)

    def controller(self) -> interfaces.Controller[Any]:
        """Return the controller: the same object as in simulation."""
        if self.steering is not None:
            return self.steering
        if self.following is None:
            return interfaces.OpenLoop(command=interfaces.Command(gait=self.gait))
        return self.following.controller(self.gait)


class OperationFileError(LaticaudaError, ValueError):
    """A trial or series file is invalid; the message gives file, key, rule and value."""


@value_class
class SeriesFile:
    """Content of a series file."""

    name: str = option("name of its folder")
    repeats: int = quantity("", "number of runs of every setting", ge=1, default=1)
    retries: int = quantity(
        "", "number of rejected runs of a setting that are repeated", ge=0, default=1
    )
    trials: tuple[Operation, ...] = option("the settings, in order")

    def __post_init__(self) -> None:
        """Reject a series without trials, and trials of the same name."""
        if not self.trials:
            raise BadArgument("trials", "must hold at least one trial, got none")
        names = [operation.name for operation in self.trials]
        for name in names:
            if names.count(name) > 1:
                raise BadArgument("trials", f"must have distinct names, got {name!r} twice")


def load_operation(path: str | Path) -> Operation | SeriesFile:
    """Read a trial or series file.

    Args:
        path: Path of the TOML file.

    Returns:
        The `Operation` of a trial file, or the `SeriesFile`.

    Raises:
        OperationFileError: If the file cannot be read, or anything in it is invalid; the message
            gives the file, the key, the rule and the value.
    """
    return parse_operation(files.read_text(path, OperationFileError), str(path))


def parse_operation(text: str, shown: str = "<text>") -> Operation | SeriesFile:
    """Parse the text of a trial or series file.

    Args:
        text: Text in TOML.
        shown: Name of the text in messages.

    Raises:
        OperationFileError: Under the same conditions as in `load_operation`.
    """
    table = files.parse_toml(text, shown, OperationFileError)
    with codec.keys_of(shown, OperationFileError):
        if codec.take_kind(table, "trial", "series") == "trial":
            return codec.decode(Operation, table)
        return codec.decode(SeriesFile, _with_common(table))


def _with_common(table: codec.Table) -> codec.Table:
    """Return the table of a series with the common settings merged into every trial."""
    common = codec.table_of(table.pop("common", {}), "common")
    trials = table.get("trials")
    if not isinstance(trials, list):
        return table  # decoding it says what is wrong
    merged: list[codec.Table] = []
    for i, entry in enumerate(cast("list[object]", trials)):
        trial = codec.table_of(entry, f"trials[{i}]")
        merged.append(codec.merge_tables(common, trial))
    table["trials"] = merged
    return table
