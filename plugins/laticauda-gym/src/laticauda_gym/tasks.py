"""The tasks: follow a line in a current, swim at a speed with the least power, stay where one is."""

import math

import numpy as np

from laticauda.control.path_following import refuse_offset
from laticauda.errors import BadArgument, positive
from laticauda.quantities import quantities_of, quantity, value
from laticauda_gym.swimming import Numbers, Range, Sight, Step, Swimming, in_body_axes, ranges

HEADING_RATE = Sight(name="heading_rate", of=lambda step: step.after.heading_rate)
ALONG = Sight(name="velocity_along", of=lambda step: step.velocity[0], unit=0.1)
ACROSS = Sight(name="velocity_across", of=lambda step: step.velocity[1], unit=0.1)
BESIDE_THE_PATH = (
    Sight(name="cross_track_error", of=lambda step: step.after.y),
    Sight(name="sin_heading", of=lambda step: np.sin(step.after.heading)),
    Sight(name="cos_heading", of=lambda step: np.cos(step.after.heading)),
    HEADING_RATE,
    ALONG,
    ACROSS,
)
"""What tells of the place beside the path, the heading to it, and the velocity over ground."""
PHASE = (
    Sight(name="sin_phase", of=lambda step: np.sin(step.after.phase)),
    Sight(name="cos_phase", of=lambda step: np.cos(step.after.phase)),
)


def log_square(value: Numbers, tolerance: float) -> Numbers:
    """ln(1 + (x/a)^2): (x/a)^2 for small x; from there on ten times the distance costs 4.6 more, wherever it is [-]."""
    return np.log1p((value / tolerance) ** 2)


def check_ends(task: Swimming, *names: str) -> None:
    """Refuse fields that are two ends, of which the lower one does not come first, or the upper one is not positive.

    Args:
        task: Whose fields.
        names: Of the fields.

    Raises:
        ValueError: If there is one.
    """
    for name in names:
        (low, high), unit = getattr(task, name), quantities_of(type(task))[name].unit
        if low > high:
            raise BadArgument(name, f"must be two numbers in {unit}, the lower one first, got {(low, high)}")
        positive(f"{name}[1]", high, unit)


@value
class Steered(Swimming):
    """A robot whose offset steers it, in a current that is not seen.

    Raises:
        ValueError: If a field is out of its range, or an offset could take a joint beyond its limit.
    """

    max_offset: float = quantity("rad", "Largest offset to either side", gt=0.0, default=math.radians(20.0))
    max_current: float = quantity("m/s", "Fastest current of an episode, in any direction", ge=0.0, default=0.06)
    power_unit: float = quantity("W", "P_1, power that costs 1 per second", gt=0.0, default=100.0)

    def __post_init__(self) -> None:
        """Check what goes together."""
        super().__post_init__()
        refuse_offset(self.scenario.robot, self.gait, self.max_offset)

    @property
    def actions(self) -> tuple[Range, ...]:
        """The offset."""
        return ranges(offset=(-self.max_offset, self.max_offset))

    @property
    def draws(self) -> tuple[Range, ...]:
        """The current, or what there is to be drawn of the water's flow."""
        if self.flow is not None:
            return self.flow_draws
        return ranges(current_speed=(0.0, self.max_current), current_direction=(-math.pi, math.pi))

    @property
    def sights(self) -> tuple[Sight, ...]:
        """Phase and offset of the gait."""
        return (*PHASE, Sight(name="offset", of=lambda step: step.after.offset, unit=self.max_offset))


@value
class PathFollowing(Steered):
    """Follow the x axis, in a current that is not seen; the action is what steering adds, as for line of sight.

        r = (x(t + h) - x(t)) / v_1 - h (ln(1 + (e/e_1)^2) + P/P_1)

    Raises:
        ValueError: If a field is out of its range, or an offset could take a joint beyond its limit.
    """

    max_cross_track_error: float = quantity("m", "At the start, to either side", ge=0.0, default=1.0)
    max_heading: float = quantity("rad", "At the start, to either side", ge=0.0, default=math.radians(60.0))
    cross_track_tolerance: float = quantity("m", "e_1", gt=0.0, default=0.1)
    speed_unit: float = quantity("m/s", "v_1, speed along the path that earns 1 per second", gt=0.0, default=0.1)

    @property
    def draws(self) -> tuple[Range, ...]:
        """Where an episode begins, in which water."""
        y, heading = self.max_cross_track_error, self.max_heading
        return ranges(y=(-y, y), heading=(-heading, heading)) + super().draws

    @property
    def sights(self) -> tuple[Sight, ...]:
        """Place beside the path, heading to it, velocity over ground; phase and offset of the gait."""
        return (*BESIDE_THE_PATH, *super().sights)

    def reward(self, step: Step) -> Numbers:
        """Progress along the path, less what distance from it and power cost in `step`."""
        progress = (step.after.x - step.before.x) / self.speed_unit
        error = log_square(step.after.y, self.cross_track_tolerance)
        return progress - step.interval * (error + step.power / self.power_unit)


@value
class Efficiency(Swimming):
    """Swim at the speed that is asked for with the least power, in still water; the actions are the gait.

        r = -h (((u - v)/v_1)^2 + P/P_1)

    u is what the center of mass covers in the interval along the mean heading, divided by the interval.

    Raises:
        ValueError: If a field is out of its range, or the amplitude could take a joint beyond its limit.
    """

    amplitudes: tuple[float, float] = quantity("rad", "Action range", ge=0.0, default=(0.0, math.radians(45.0)))
    frequencies: tuple[float, float] = quantity("rad/s", "Action range", ge=0.0, default=(0.0, math.radians(130.0)))
    phase_shifts: tuple[float, float] = quantity("rad", "Its range", default=(math.radians(10.0), math.radians(70.0)))
    speeds: tuple[float, float] = quantity("m/s", "Range from which an episode draws v", ge=0.0, default=(0.03, 0.15))
    speed_tolerance: float = quantity("m/s", "v_1, speed error that costs 1 per second", gt=0.0, default=0.02)
    power_unit: float = quantity("W", "P_1, power that costs 1 per second", gt=0.0, default=10.0)

    def __post_init__(self) -> None:
        """Check what goes together."""
        super().__post_init__()
        check_ends(self, "amplitudes", "phase_shifts", "frequencies", "speeds")
        chain = self.scenario.robot.planar()
        for i, (joint, g) in enumerate(zip(chain.joints, self.gait.joint_envelope(chain.n_links), strict=True)):
            room = joint.limit - abs(self.gait.offset)
            if abs(g) * self.amplitudes[1] > room:
                raise BadArgument(
                    "amplitudes[1]",
                    f"must be <= {room / abs(g):.4g} rad, or joint {i} goes beyond its limit of "
                    f"{joint.limit:.4g} rad; got {self.amplitudes[1]}",
                )

    @property
    def actions(self) -> tuple[Range, ...]:
        """Amplitude, frequency, phase shift."""
        return ranges(amplitude=self.amplitudes, frequency=self.frequencies, phase_shift=self.phase_shifts)

    @property
    def draws(self) -> tuple[Range, ...]:
        """The speed asked for."""
        return ranges(speed_ref=self.speeds) + self.flow_draws

    @property
    def sights(self) -> tuple[Sight, ...]:
        """The speed asked for and the speed there is, the power, and the gait as the generator has it."""
        return (
            Sight(name="speed_ref", of=lambda step: step.drawn["speed_ref"], unit=0.1),
            Sight(name="speed", of=_speed, unit=0.1),
            ACROSS,
            HEADING_RATE,
            Sight(name="power", of=lambda step: step.power, unit=self.power_unit),
            *PHASE,
            Sight(name="amplitude", of=lambda step: step.after.amplitude, unit=self.amplitudes[1]),
            Sight(name="frequency", of=lambda step: step.after.frequency, unit=self.frequencies[1]),
            Sight(name="phase_shift", of=lambda step: step.after.phase_shift),
        )

    def reward(self, step: Step) -> Numbers:
        """What error of the speed and power cost in `step`."""
        error = (_speed(step) - step.drawn["speed_ref"]) / self.speed_tolerance
        return -step.interval * (error * error + step.power / self.power_unit)


def _speed(step: Step) -> Numbers:
    """u of a step [m/s]."""
    heading = 0.5 * (step.before.heading + step.after.heading)
    x, y = step.after.x - step.before.x, step.after.y - step.before.y
    return (np.cos(heading) * x + np.sin(heading) * y) / step.interval


@value
class StationKeeping(Steered):
    """Stay at the origin in a current that is not seen; the actions are what steering adds, and the frequency.

        r = -h (ln(1 + (d/d_1)^2) + P/P_1)

    Raises:
        ValueError: If a field is out of its range, or an offset could take a joint beyond its limit.
    """

    frequencies: tuple[float, float] = quantity("rad/s", "Action range", ge=0.0, default=(0.0, math.radians(130.0)))
    max_distance: float = quantity("m", "At the start, along each axis", ge=0.0, default=1.0)
    distance_tolerance: float = quantity("m", "d_1", gt=0.0, default=0.2)

    def __post_init__(self) -> None:
        """Check what goes together."""
        super().__post_init__()
        check_ends(self, "frequencies")

    @property
    def actions(self) -> tuple[Range, ...]:
        """Offset and frequency."""
        return super().actions + ranges(frequency=self.frequencies)

    @property
    def draws(self) -> tuple[Range, ...]:
        """Where an episode begins, in which water."""
        place = -self.max_distance, self.max_distance
        return ranges(x=place, y=place, heading=(-math.pi, math.pi)) + super().draws

    @property
    def sights(self) -> tuple[Sight, ...]:
        """Where the origin is seen, velocity over ground; phase, frequency and offset of the gait."""
        return (
            Sight(name="origin_along", of=lambda step: _origin(step)[0]),
            Sight(name="origin_across", of=lambda step: _origin(step)[1]),
            ALONG,
            ACROSS,
            HEADING_RATE,
            *PHASE,
            Sight(name="frequency", of=lambda step: step.after.frequency, unit=self.frequencies[1]),
            Sight(name="offset", of=lambda step: step.after.offset, unit=self.max_offset),
        )

    def reward(self, step: Step) -> Numbers:
        """What distance and power cost in `step`."""
        distance = log_square(np.hypot(step.after.x, step.after.y), self.distance_tolerance)
        return -step.interval * (distance + step.power / self.power_unit)


def _origin(step: Step) -> tuple[Numbers, Numbers]:
    return in_body_axes(step.after, -step.after.x, -step.after.y)
