"""Settings of the virtual tank. Those that are not in the paper are assumptions, and marked as such."""

from laticauda.values import BadArgument, option, quantity, value_class


@value_class
class NodeSettings:
    """Settings of a joint module: its firmware's times and limits, its sensors, its heat. All are assumptions.

    The servo stalls at 4.6 A, hard swimming takes 3.3 A, and with the fin the model's servos stall
    for about 2 s under the water's load, hence the current limit and its time. Torque is limited by
    the motor itself.
    """

    startup_time: float = quantity("s", "From power-on to its first frame", ge=0.0, default=1.0)
    calibration_time: float = quantity(
        "s", "Duration of the self-test that follows", ge=0.0, default=1.0
    )
    hold_after: float = quantity(
        "s", "Time without references until the last one is held", gt=0.0, default=0.2
    )
    limp_after: float = quantity(
        "s", "Time without references until the motor is off", gt=0.0, default=1.0
    )
    heartbeat_interval: float = quantity("s", "Between two heartbeats", gt=0.0, default=0.1)
    sensor_interval: float = quantity(
        "s", "Between frames of force/torque sensor, accelerometer", gt=0.0, default=0.05
    )
    speed_limit: float = quantity(
        "rad/s", "Highest rate at which a reference is followed", gt=0.0, default=4.0
    )
    current_limit: float = quantity(
        "A", "Motor current, averaged over `current_time`", gt=0.0, default=4.4
    )
    current_time: float = quantity(
        "s", "Averaging time; longer than a stall under the water load", gt=0.0, default=3.0
    )
    stuck_duty: float = quantity(
        "", "A joint is stuck if its motor's duty is so high ...", ge=0.0, le=1.0, default=0.9
    )
    stuck_travel: float = quantity(
        "rad", "... while the joint moves no more than this; 1 deg", gt=0.0, default=0.0175
    )
    stuck_time: float = quantity(
        "s", "... for this long in total; longer than a stall", gt=0.0, default=3.0
    )
    temperature_limit: float = quantity(
        "deg C", "Temperature limit of the motor", ge=-273.15, le=1000.0, default=80.0
    )
    temperature_again: float = quantity(
        "deg C", "Its flag can be cleared below", ge=-273.15, le=1000.0, default=70.0
    )
    thermal_resistance: float = quantity("K/W", "From motor to water", gt=0.0, default=3.0)
    heat_capacity: float = quantity("J/K", "Heat capacity of the motor", gt=0.0, default=50.0)
    zero_error: float = quantity(
        "rad", "Largest before the sensor is calibrated, either sign", ge=0.0, default=0.05
    )
    angle_noise: float = quantity(
        "rad", "Standard deviation of one reading; 0.2 deg", ge=0.0, default=0.0035
    )
    angle_step: float = quantity(
        "rad", "Resolution of the angle sensor, 12 bits per turn", ge=0.0, default=0.0015
    )
    backlash: float = quantity(
        "rad", "Total play between sensor and joint; 0.5 deg", ge=0.0, default=0.0087
    )
    rate_noise: float = quantity("rad/s", "Standard deviation", ge=0.0, default=0.02)
    current_noise: float = quantity("A", "Standard deviation", ge=0.0, default=0.02)
    torque_noise: float = quantity(
        "N m", "Standard deviation, of the force/torque sensor", ge=0.0, default=0.02
    )
    force_noise: float = quantity(
        "N", "Standard deviation along each axis, of the same sensor", ge=0.0, default=0.05
    )
    force_zero_error: float = quantity(
        "N", "Largest along each axis, either sign, of the same sensor", ge=0.0, default=0.1
    )
    acceleration_noise: float = quantity("m/s^2", "Standard deviation", ge=0.0, default=0.05)

    def __post_init__(self) -> None:
        """Check every field once."""
        if not self.hold_after <= self.limp_after:
            raise BadArgument(
                "limp_after",
                f"must be >= `hold_after` = {self.hold_after:g} s, got {self.limp_after:g}",
            )


@value_class
class MocapSettings:
    """Settings of cameras that see five markers on the last module, the tail, which also carries the paper's fin.

    The size of the volume and the markers' depth are from the paper; everything else is an
    assumption.
    """

    rate: float = quantity("Hz", "Frames per second", gt=0.0, default=100.0)
    position_noise: float = quantity(
        "m", "Standard deviation along each axis", ge=0.0, default=0.001
    )
    rotation_noise: float = quantity(
        "rad", "Standard deviation about each axis; 0.1 deg", ge=0.0, default=0.00175
    )
    drop_share: float = quantity(
        "", "Share of frames that never come", ge=0.0, le=1.0, default=0.01
    )
    lost_share: float = quantity(
        "", "Share of frames in which too few markers are seen", ge=0.0, le=1.0, default=0.005
    )
    size: tuple[float, float, float] = quantity(
        "m", "Size of the cameras' volume", default=(12.0, 5.45, 1.35)
    )
    middle: tuple[float, float, float] = quantity(
        "m", "Its center; the surface is at 0", default=(5.0, 0.0, -0.675)
    )
    depth: float = quantity(
        "m", "Depth of the markers, where the model is planar", ge=0.0, default=0.15
    )
    reflection_share: float = quantity(
        "", "Frames that take a reflection for a marker", ge=0.0, le=1.0, default=0.5
    )
    reflection_depth: float = quantity(
        "m", "Depth over which that share falls by a factor e", gt=0.0, default=0.03
    )
    reflection_jump: float = quantity(
        "m", "Deviation of such a position; rotations: 0.1 rad", ge=0.0, default=0.03
    )
    mount: tuple[float, float, float] = quantity(
        "m", "Marker body from mid-module, its axes", default=(0.0, 0.0, 0.0)
    )
    mount_yaw: float = quantity(
        "rad", "Angle of the marker body on it, positive to the left", default=0.0
    )
    frame: tuple[float, float, float] = quantity(
        "m", "Origin of the cameras' frame", default=(0.0, 0.0, 0.0)
    )
    frame_yaw: float = quantity(
        "rad", "Angle of the cameras' frame, positive to the left", default=0.0
    )


@value_class
class SupplySettings:
    """Settings of the power box, its cable, and the meter in the cable."""

    voltage: float = quantity("V", "Voltage of the supply, as in the paper", gt=0.0, default=35.0)
    cable_resistance: float = quantity(
        "ohm", "Of the cable to the modules and back; assumed", ge=0.0, default=0.2
    )
    current_noise: float = quantity(
        "A", "Standard deviation of a reading; an assumption", ge=0.0, default=0.002
    )
    meter_interval: float = quantity(
        "s", "Between two averages of the meter; assumed", gt=0.0, default=0.2
    )


@value_class
class LabSettings:
    """Settings of the whole virtual tank."""

    nodes: NodeSettings = option("The joint modules", default_factory=NodeSettings)
    mocap: MocapSettings = option("The cameras", default_factory=MocapSettings)
    supply: SupplySettings = option(
        "The power supply and its meter", default_factory=SupplySettings
    )
    step: float = quantity(
        "s", "Interval at which the devices are updated", ge=1e-3, le=0.05, default=0.01
    )
    water_temperature: float = quantity(
        "deg C", "Of the water; an assumption", ge=-10.0, le=150.0, default=18.0
    )
    seed: int = quantity("", "Seed of all random numbers", default=0)
