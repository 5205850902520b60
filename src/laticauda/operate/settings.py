"""What one operation is: gait or path, start, connections, tank, calibration and limits; the content of a trial file.

Two frames: the tank frame is the one that the motion capture was calibrated to; the path frame is the world of
everything else, with the path along its x axis in the paper's trials.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from laticauda.control import (
    Guidance,
    HeadingController,
    IntegralLineOfSight,
    LineOfSight,
    Path,
    PathFollowing,
    Polyline,
    Spline,
    StraightLine,
)
from laticauda.errors import finite, instance, not_negative, one_of, positive, whole, within
from laticauda.gaits import Gait
from laticauda.interfaces import Command, Controller, OpenLoop
from laticauda.operate.estimate import Mount
from laticauda.operate.tank import Tank, pair, put
from laticauda.robot import Robot, Water, load_robot, load_water

INTERFACES = ("udp_multicast", "virtual", "socketcan")
ESTIMATORS = ("filter", "kinematics")
GUIDANCE = ("line_of_sight", "integral_line_of_sight")
LEAST_RATE, MOST_RATE = 10.0, 500.0  # below, references time out in the modules; above, the bus is full [1/s]


@dataclass(frozen=True, kw_only=True)
class Following:
    """Path following; an operation without it swims its gait open loop."""

    waypoints: tuple[tuple[float, float], ...] | None = None
    """Corners of the path, path frame; None: the x axis [m]."""
    smooth: bool = False
    """A smooth curve through the waypoints instead of straight legs."""
    guidance: str = "line_of_sight"
    """line_of_sight or integral_line_of_sight [-]."""
    look_ahead_distance: float = 0.18
    """Delta [m]."""
    integral_gain: float = 0.12
    """sigma of the integral law [m/s]."""
    gain: float = 0.4
    """k, offset per heading error [-]."""
    max_offset: float = math.radians(20.0)
    """Largest offset of the joints to either side [rad]."""
    heading_estimate: str = "raw"
    """raw, or cycle_mean over the last gait cycle [-]."""
    interval: float = 0.05
    """Between two control instants [s]."""

    def __post_init__(self) -> None:
        """Check every field once, the laws' own by the laws."""
        instance("smooth", self.smooth, bool)
        put(self, "guidance", one_of("guidance", _underscored(self.guidance), GUIDANCE))
        if self.waypoints is not None:
            if not isinstance(self.waypoints, Sequence) or len(self.waypoints) < 2:  # pyright: ignore
                raise ValueError(f"`waypoints` must be at least two points [x, y] in m, got {self.waypoints!r}.")
            put(self, "waypoints", tuple(pair(f"waypoints[{i}]", p, "m") for i, p in enumerate(self.waypoints)))
        self.controller(Gait(amplitude=0.5, frequency=1.0, phase_shift=0.5))

    @property
    def path(self) -> Path[Any]:
        """Where to go."""
        if self.waypoints is None:
            return StraightLine()
        return Spline(waypoints=self.waypoints) if self.smooth else Polyline(waypoints=self.waypoints)

    def controller(self, gait: Gait) -> PathFollowing:
        """The controller, as in simulation.

        Args:
            gait: What swims along the path.
        """
        law: Guidance[Any] = LineOfSight(look_ahead_distance=self.look_ahead_distance)
        if self.guidance == "integral_line_of_sight":
            law = IntegralLineOfSight(look_ahead_distance=self.look_ahead_distance, integral_gain=self.integral_gain)
        return PathFollowing(
            gait=gait,
            path=self.path,
            guidance=law,
            heading=HeadingController(gain=self.gain, max_offset=self.max_offset),
            heading_estimate=self.heading_estimate,
            interval=self.interval,
        )


@dataclass(frozen=True, kw_only=True)
class Placement:
    """Where the robot is to be put before the run, path frame."""

    position: tuple[float, float]
    """Of the center of mass [m]."""
    heading: float = 0.0
    """[rad]."""
    tolerance: float = 0.3
    """How far off it may be before the run is refused [m]."""
    heading_tolerance: float = math.radians(15.0)
    """The same for the heading [rad]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        put(self, "position", pair("position", self.position, "m"))
        put(self, "heading", finite("heading", self.heading, "rad"))
        put(self, "tolerance", positive("tolerance", self.tolerance, "m"))
        put(self, "heading_tolerance", positive("heading_tolerance", self.heading_tolerance, "rad"))


@dataclass(frozen=True, kw_only=True)
class Connection:
    """Where the devices are."""

    can_interface: str = "udp_multicast"
    """python-can's name of the bus: udp_multicast, virtual or socketcan [-]."""
    can_channel: str = "239.74.163.2"
    """Its channel: a multicast address, any name, or can0 [-]."""
    can_port: int = 43113
    """UDP port of udp_multicast [-]."""
    mocap_host: str = "127.0.0.1"
    """Address of the motion capture's computer [-]."""
    mocap_port: int = 22223
    """Its port [-]."""
    mocap_body: str = ""
    """Name of the rigid body; "" takes the only one there is [-]."""
    meter_port: str = ""
    """Serial port of the power meter; "" for none [-]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        one_of("can_interface", self.can_interface, INTERFACES)
        for name in ("can_channel", "mocap_host", "mocap_body", "meter_port"):
            instance(name, getattr(self, name), str)
        for name in ("can_port", "mocap_port"):
            if whole(name, getattr(self, name), 1) > 65535:
                raise ValueError(f"`{name}` must be a port from 1 to 65535, got {getattr(self, name)}.")


@dataclass(frozen=True, kw_only=True)
class Calibration:
    """What is measured before a run."""

    joint_zeros: bool = False
    """Take what the limp joints report as zero, if a module has no zero since its power came on: the robot must lie
    straight then, against a ruler."""
    max_joint_zero: float = math.radians(5.0)
    """Zeros beyond this are refused: then it was not straight [rad]."""
    marker_module: int = 0
    """The module that carries the rigid body, 0 = tail: the paper's is the last one, which also carries the fin [-]."""
    marker_offset: tuple[float, float] = (0.0, 0.0)
    """Of the rigid body from the middle of its module: toward the head, to the left [m]."""
    marker_yaw: float = 0.0
    """Direction of the rigid body's x axis to the module's [rad]."""
    straight_heading: float | None = None
    """Heading of the straight robot at the calibration, tank frame: then `marker_yaw` is measured; None: as given
    [rad]."""
    idle_time: float = 3.0
    """How long the current at rest is averaged [s]."""
    still_speed: float = 0.01
    """Slower than this the robot is still [m/s]."""
    still_rate: float = math.radians(2.0)
    """The same for its turning rate [rad/s]."""
    still_time: float = 2.0
    """For how long it has to be [s]."""
    patience: float = 120.0
    """After which waiting for it is given up [s]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        instance("joint_zeros", self.joint_zeros, bool)
        put(self, "marker_module", whole("marker_module", self.marker_module, 0))
        put(self, "marker_offset", pair("marker_offset", self.marker_offset, "m"))
        put(self, "marker_yaw", finite("marker_yaw", self.marker_yaw, "rad"))
        if self.straight_heading is not None:
            put(self, "straight_heading", finite("straight_heading", self.straight_heading, "rad"))
        units = {"max_joint_zero": "rad", "still_speed": "m/s", "still_rate": "rad/s", "patience": "s"}
        units |= {"idle_time": "s", "still_time": "s"}
        for name, unit in units.items():
            put(self, name, positive(name, getattr(self, name), unit))

    @property
    def mount(self) -> Mount:
        """Where the rigid body of the motion capture sits."""
        return Mount(module=self.marker_module, offset=self.marker_offset, angle=self.marker_yaw)


@dataclass(frozen=True, kw_only=True)
class Limits:
    """What the safety supervisor accepts."""

    max_temperature: float = 70.0
    """Of a module [degC]."""
    max_current: float = 4.4
    """Of a motor, longer than `current_time` [A]."""
    current_time: float = 3.0
    """Longer than the servos of the model stall under the water's load, about 2 s with the fin [s]."""
    min_voltage: float = 28.0
    """Of the supply at a module [V]."""
    max_joint_error: float = math.radians(45.0)
    """Of a joint to its reference, longer than `joint_error_time`; wide, for the servos of the model lag by up to 47
    deg for 1.3 s when a hard turn and the gait begin at once [rad]."""
    joint_error_time: float = 2.0
    """[s]."""
    heartbeat_timeout: float = 0.5
    """A module that is silent for longer is lost [s]."""
    joint_timeout: float = 0.3
    """A joint whose angle is older is lost [s]."""
    mocap_timeout: float = 1.5
    """For how long the estimator may go on without the motion capture [s]."""
    meter_timeout: float = 3.0
    """The same for the power meter [s]."""
    max_lateness: float = 0.15
    """Of one tick; the modules hold after 0.2 s without references [s]."""
    edge_margin: float = 0.25
    """Distance to the edge of the measuring volume or the tank at which to stop [m]."""
    straighten_time: float = 2.0
    """In which the robot straightens before it goes limp [s]."""
    straight: float = math.radians(4.0)
    """Joints within this are straight [rad]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        for name, unit in LIMIT_UNITS.items():
            put(self, name, positive(name, getattr(self, name), unit))


LIMIT_UNITS = {
    "max_temperature": "degC",
    "max_current": "A",
    "current_time": "s",
    "min_voltage": "V",
    "max_joint_error": "rad",
    "joint_error_time": "s",
    "heartbeat_timeout": "s",
    "joint_timeout": "s",
    "mocap_timeout": "s",
    "meter_timeout": "s",
    "max_lateness": "s",
    "edge_margin": "m",
    "straighten_time": "s",
    "straight": "rad",
}


@dataclass(frozen=True, kw_only=True)
class Operation:
    """One run of a robot, from the connections to the last command: the content of a trial file."""

    name: str
    """What its files are called."""
    robot: str = "mamba"
    """A preset or a TOML file; CAN node k drives its joint k - 1, tail first [-]."""
    water: str = "paper-lateral"
    """A preset or a TOML file, for the record [-]."""
    gait: Gait
    """What the joints do."""
    following: Following | None = None
    """Path following; None: open loop."""
    start: Placement | None = None
    """Where the robot is put; None: anywhere."""
    duration: float = 90.0
    """After which the run ends, if the tank does not end before [s]."""
    rate: float = 100.0
    """Ticks per second [1/s]."""
    countdown: float = 3.0
    """Before the run begins [s]."""
    ramp: float = 3.0
    """Of the smooth start [s]."""
    offset_bandwidth: float = 2.0
    """Of the reference generator [rad/s]."""
    supply_voltage: float | None = None
    """V of (4), by which the power meter's current becomes power; it must be given beside a meter [V]."""
    estimator: str = "filter"
    """What says where the robot is: filter, or kinematics as in the paper, which bridges no drop-out [-]."""
    connection: Connection = field(default_factory=Connection)
    """Where the devices are."""
    tank: Tank = field(default_factory=Tank)
    """Where the path is in the tank."""
    calibration: Calibration = field(default_factory=Calibration)
    """What is measured before."""
    limits: Limits = field(default_factory=Limits)
    """What the supervisor accepts."""

    def __post_init__(self) -> None:
        """Check every field once, and what depends on two of them."""
        if not isinstance(self.name, str) or not self.name.replace("-", "").replace("_", "").isalnum():  # pyright: ignore
            raise ValueError(f"`name` must be letters, digits, `-` and `_`, as in a file's name, got {self.name!r}.")
        instance("gait", self.gait, Gait)
        if self.gait.pitch is not None:
            raise ValueError("`gait.pitch` must not be given: the operated robot swims at the surface, in the plane.")
        one_of("estimator", self.estimator, ESTIMATORS)
        put(self, "duration", positive("duration", self.duration, "s"))
        put(self, "rate", within("rate", self.rate, LEAST_RATE, MOST_RATE, "1/s"))
        put(self, "countdown", not_negative("countdown", self.countdown, "s"))
        put(self, "ramp", not_negative("ramp", self.ramp, "s"))
        put(self, "offset_bandwidth", positive("offset_bandwidth", self.offset_bandwidth, "rad/s"))
        if self.supply_voltage is not None:
            put(self, "supply_voltage", positive("supply_voltage", self.supply_voltage, "V"))
        elif self.connection.meter_port:
            raise ValueError(
                "`supply_voltage` must be given in V beside a power meter, whose current it turns into power, got None."
            )

    def body(self) -> Robot:
        """The robot.

        Raises:
            RobotFileError: If there is none of that name, or its file is wrong.
            ValueError: If its joints cannot do what the controller may ask for.
        """
        robot = load_robot(self.robot)
        if self.following is not None:
            self.following.controller(self.gait).check(robot)
        return robot

    def pool(self) -> Water:
        """The water."""
        return load_water(self.water)

    def controller(self) -> Controller[Any]:
        """What decides: the same object as in simulation."""
        if self.following is None:
            return OpenLoop(command=Command(gait=self.gait))
        return self.following.controller(self.gait)


def _underscored(word: Any) -> Any:
    return word.replace("-", "_") if isinstance(word, str) else word
