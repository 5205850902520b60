"""The numbers of the virtual tank. What is not in the paper is an assumption, and says so."""

from dataclasses import dataclass, field

from laticauda.errors import not_negative, positive, within
from laticauda.robot.checks import settle_required


@dataclass(frozen=True, kw_only=True)
class NodeSettings:
    """A joint module: its firmware's times and limits, its sensors, its heat. All are assumptions."""

    startup_time: float = 1.0
    """From power on until it talks [s]."""
    calibration_time: float = 1.0
    """Self-test after that [s]."""
    hold_after: float = 0.2
    """References stay away so long: hold the last one [s]."""
    limp_after: float = 1.0
    """References stay away so long: motor off [s]."""
    heartbeat_interval: float = 0.1
    """[s]."""
    sensor_interval: float = 0.05
    """Between two frames of the force/torque sensor, and of the accelerometer [s]."""
    speed_limit: float = 4.0
    """The reference is followed no faster than this; torque is limited by the motor itself [rad/s]."""
    current_limit: float = 4.4
    """Of the motor, averaged over `current_time`; the servo stalls at 4.6 A, and hard swimming takes 3.3 A [A]."""
    current_time: float = 3.0
    """Longer than the servos of the model stall under the water's load, about 2 s with the fin [s]."""
    stuck_duty: float = 0.9
    """The joint is stuck if the motor pulls at this duty or more [-]..."""
    stuck_travel: float = 0.0175
    """... while the joint comes no further than this from where it stood; 1 deg [rad]..."""
    stuck_time: float = 3.0
    """... for so long in all; longer than a stall under the water's load, as above [s]."""
    temperature_limit: float = 80.0
    """Of the motor [deg C]."""
    temperature_again: float = 70.0
    """Below it, over-temperature can be cleared [deg C]."""
    thermal_resistance: float = 3.0
    """Motor to water [K/W]."""
    heat_capacity: float = 50.0
    """Of the motor [J/K]."""
    zero_error: float = 0.05
    """Of the angle sensor before it is calibrated, as far as to either side [rad]."""
    angle_noise: float = 0.0035
    """Standard deviation of one reading; 0.2 deg [rad]."""
    angle_step: float = 0.0015
    """Resolution of the angle sensor, 12 bits for a turn [rad]."""
    backlash: float = 0.0087
    """Play of the gear between the sensor and the joint, in all; 0.5 deg [rad]."""
    rate_noise: float = 0.02
    """Standard deviation [rad/s]."""
    current_noise: float = 0.02
    """Standard deviation [A]."""
    torque_noise: float = 0.02
    """Standard deviation, of the force/torque sensor [N m]."""
    acceleration_noise: float = 0.05
    """Standard deviation [m/s^2]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        settle_required(self, positive, "s", "heartbeat_interval", "sensor_interval", "current_time", "stuck_time")
        settle_required(self, positive, "s", "hold_after", "limp_after")
        settle_required(self, not_negative, "s", "startup_time", "calibration_time")
        settle_required(self, positive, "rad/s", "speed_limit")
        settle_required(self, positive, "rad", "stuck_travel")
        settle_required(self, positive, "A", "current_limit")
        settle_required(self, positive, "K/W", "thermal_resistance")
        settle_required(self, positive, "J/K", "heat_capacity")
        settle_required(self, not_negative, "rad", "zero_error", "angle_noise", "angle_step", "backlash")
        settle_required(self, not_negative, "rad/s", "rate_noise")
        settle_required(self, not_negative, "A", "current_noise")
        settle_required(self, not_negative, "N m", "torque_noise")
        settle_required(self, not_negative, "m/s^2", "acceleration_noise")
        within("stuck_duty", self.stuck_duty, 0.0, 1.0)
        if not self.hold_after <= self.limp_after:
            raise ValueError(f"`limp_after` must be >= `hold_after` = {self.hold_after:g} s, got {self.limp_after:g}.")


@dataclass(frozen=True, kw_only=True)
class MocapSettings:
    """Cameras that see five markers on the last module, which is the tail: the paper's fin is on it, too.

    The size of the volume and the markers' depth are the paper's; all else is an assumption.
    """

    rate: float = 100.0
    """Frames per second [Hz]."""
    position_noise: float = 0.001
    """Standard deviation along each axis [m]."""
    rotation_noise: float = 0.00175
    """Standard deviation about each axis; 0.1 deg [rad]."""
    drop_share: float = 0.01
    """Share of frames that never come [-]."""
    lost_share: float = 0.005
    """Share of frames in which too few markers are seen [-]."""
    size: tuple[float, float, float] = (12.0, 5.45, 1.35)
    """Of the volume that the cameras cover [m]."""
    middle: tuple[float, float, float] = (5.0, 0.0, -0.675)
    """Of that volume, in world axes: the water's surface is at height 0 [m]."""
    depth: float = 0.15
    """Of the markers below the surface, where the model is planar [m]."""
    reflection_share: float = 0.5
    """Share of frames in which a marker at the surface is mistaken for its mirror image [-]..."""
    reflection_depth: float = 0.03
    """... and the depth in which that share falls by a factor e [m]."""
    reflection_jump: float = 0.03
    """Standard deviation of the position of a body that was so mistaken [m]; its rotation is off by 0.1 rad."""
    mount: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Of the markers' body from the middle of the last module, in that one's axes [m]."""
    mount_yaw: float = 0.0
    """How far the markers' body is turned to the left on it [rad]."""
    frame: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """The origin of the cameras' frame in world axes [m]."""
    frame_yaw: float = 0.0
    """How far the cameras' frame is turned to the left [rad]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        settle_required(self, positive, "Hz", "rate")
        settle_required(self, not_negative, "m", "position_noise", "depth", "reflection_jump")
        settle_required(self, positive, "m", "reflection_depth")
        settle_required(self, not_negative, "rad", "rotation_noise")
        for name in ("drop_share", "lost_share", "reflection_share"):
            within(name, getattr(self, name), 0.0, 1.0)


@dataclass(frozen=True, kw_only=True)
class SupplySettings:
    """The power box, its cable, and the meter in it."""

    voltage: float = 35.0
    """Of the box; the paper's [V]."""
    cable_resistance: float = 0.2
    """To the modules and back; an assumption [ohm]."""
    current_noise: float = 0.002
    """Standard deviation of the meter's reading; an assumption [A]."""
    meter_interval: float = 0.2
    """Between two readings of the meter, each the average since the one before; an assumption [s]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        settle_required(self, positive, "V", "voltage")
        settle_required(self, not_negative, "ohm", "cable_resistance")
        settle_required(self, not_negative, "A", "current_noise")
        settle_required(self, positive, "s", "meter_interval")


@dataclass(frozen=True, kw_only=True)
class LabSettings:
    """The whole virtual tank."""

    nodes: NodeSettings = field(default_factory=NodeSettings)
    """The joint modules."""
    mocap: MocapSettings = field(default_factory=MocapSettings)
    """The cameras."""
    supply: SupplySettings = field(default_factory=SupplySettings)
    """The power supply and its meter."""
    step: float = 0.01
    """Between two looks of the devices at the world [s]."""
    water_temperature: float = 18.0
    """An assumption [deg C]."""
    seed: int = 0
    """Of all that is random [-]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        settle_required(self, positive, "s", "step")
        within("step", self.step, 1e-3, 0.05, "s")
