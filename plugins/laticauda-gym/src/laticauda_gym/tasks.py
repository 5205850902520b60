"""The tasks: follow a line in a current, swim at a given speed with the least power, stay in place."""

import math

import numpy as np

from laticauda.control import refuse_offset
from laticauda.values import BadArgument, check_positive, quantities_of, quantity, value_class
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
"""Position and heading relative to the path, and velocity over ground."""
PHASE = (
    Sight(name="sin_phase", of=lambda step: np.sin(step.after.phase)),
    Sight(name="cos_phase", of=lambda step: np.cos(step.after.phase)),
)


def log_square(value: Numbers, tolerance: float) -> Numbers:
    """ln(1 + (x/a)^2): (x/a)^2 for small x; for large x, ten times the distance always costs 4.6 more [-].

    Args:
        value: Error x, such as a distance [m].
        tolerance: Error a that costs ln 2, in the same unit.
    """
    return np.log1p((value / tolerance) ** 2)


def check_ends(task: Swimming, *names: str) -> None:
    """Refuse fields with two ends if the lower one does not come first or the upper one is not positive.

    Args:
        task: Task that has the fields.
        names: Names of the fields.

    Raises:
        ValueError: If there is such a field.
    """
    for name in names:
        low, high = getattr(task, name)
        unit = quantities_of(type(task))[name].unit
        if low > high:
            raise BadArgument(
                name, f"must be two numbers in {unit}, the lower one first, got {(low, high)}"
            )
        check_positive(f"{name}[1]", high, unit)


@value_class
class Steered(Swimming):
    """A robot that is steered by its offset, in a current that is not observed.

    Raises:
        ValueError: If a field is out of its range, or an offset could take a joint beyond its
            limit.
    """

    max_offset: float = quantity(
        "rad", "Largest offset to either side", gt=0.0, default=math.radians(20.0)
    )
    max_current: float = quantity(
        "m/s", "Fastest current of an episode, in any direction", ge=0.0, default=0.06
    )
    power_unit: float = quantity("W", "P_1, power that costs 1 per second", gt=0.0, default=100.0)

    def __post_init__(self) -> None:
        """Check that the fields fit together."""
        super().__post_init__()
        refuse_offset(self.scenario.robot, self.gait, self.max_offset)

    @property
    def actions(self) -> tuple[Range, ...]:
        """The offset."""
        return ranges(offset=(-self.max_offset, self.max_offset))

    @property
    def draws(self) -> tuple[Range, ...]:
        """The current, or the drawn parameters of the water's flow."""
        if self.flow is not None:
            return self.flow_draws
        return ranges(current_speed=(0.0, self.max_current), current_direction=(-math.pi, math.pi))

    @property
    def sights(self) -> tuple[Sight, ...]:
        """Phase and offset of the gait."""
        return (
            *PHASE,
            Sight(name="offset", of=lambda step: step.after.offset, unit=self.max_offset),
        )


@value_class
class PathFollowing(Steered):
    """Follow the x axis in an unobserved current; the action is the offset that steering adds, as for line of sight.

        r = (x(t + h) - x(t)) / v_1 - h (ln(1 + (e/e_1)^2) + P/P_1)

    Raises:
        ValueError: If a field is out of its range, or an offset could take a joint beyond its
            limit.
    """

    max_cross_track_error: float = quantity(
        "m", "At the start, to either side", ge=0.0, default=1.0
    )
    max_heading: float = quantity(
        "rad", "At the start, to either side", ge=0.0, default=math.radians(60.0)
    )
    cross_track_tolerance: float = quantity("m", "e_1", gt=0.0, default=0.1)
    speed_unit: float = quantity(
        "m/s", "v_1, speed along the path that earns 1 per second", gt=0.0, default=0.1
    )

    @property
    def draws(self) -> tuple[Range, ...]:
        """Start and water of an episode."""
        y, heading = self.max_cross_track_error, self.max_heading
        return ranges(y=(-y, y), heading=(-heading, heading)) + super().draws

    @property
    def sights(self) -> tuple[Sight, ...]:
        """Position and heading relative to the path, velocity over ground; phase and offset of the gait."""
        return (*BESIDE_THE_PATH, *super().sights)

    def reward(self, step: Step) -> Numbers:
        """Progress along the path in `step`, minus the costs of distance from it and of power."""
        progress = (step.after.x - step.before.x) / self.speed_unit
        error = log_square(step.after.y, self.cross_track_tolerance)
        return progress - step.interval * (error + step.power / self.power_unit)


@value_class
class Efficiency(Swimming):
    """Swim at the requested speed with the least power, in still water; the actions are the gait.

        r = -h (((u - v)/v_1)^2 + P/P_1)

    u is the displacement of the center of mass in the interval along the mean heading, divided by
    the interval.

    Raises:
        ValueError: If a field is out of its range, or the amplitude could take a joint beyond its
            limit.
    """

    amplitudes: tuple[float, float] = quantity(
        "rad", "Action range", ge=0.0, default=(0.0, math.radians(45.0))
    )
    frequencies: tuple[float, float] = quantity(
        "rad/s", "Action range", ge=0.0, default=(0.0, math.radians(130.0))
    )
    phase_shifts: tuple[float, float] = quantity(
        "rad", "Its range", default=(math.radians(10.0), math.radians(70.0))
    )
    speeds: tuple[float, float] = quantity(
        "m/s", "Range from which an episode draws v", ge=0.0, default=(0.03, 0.15)
    )
    speed_tolerance: float = quantity(
        "m/s", "v_1, speed error that costs 1 per second", gt=0.0, default=0.02
    )
    power_unit: float = quantity("W", "P_1, power that costs 1 per second", gt=0.0, default=10.0)

    def __post_init__(self) -> None:
        """Check that the fields fit together."""
        super().__post_init__()
        check_ends(self, "amplitudes", "phase_shifts", "frequencies", "speeds")
        chain = self.scenario.robot.planar()
        envelope = self.gait.joint_envelope(chain.n_links)
        for i, (joint, share) in enumerate(zip(chain.joints, envelope, strict=True)):
            room = joint.limit - abs(self.gait.offset)
            if abs(share) * self.amplitudes[1] > room:
                raise BadArgument(
                    "amplitudes[1]",
                    f"must be <= {room / abs(share):.4g} rad, or joint {i} goes beyond its limit of "
                    f"{joint.limit:.4g} rad; got {self.amplitudes[1]}",
                )

    @property
    def actions(self) -> tuple[Range, ...]:
        """Amplitude, frequency, phase shift."""
        return ranges(
            amplitude=self.amplitudes, frequency=self.frequencies, phase_shift=self.phase_shifts
        )

    @property
    def draws(self) -> tuple[Range, ...]:
        """The requested speed."""
        return ranges(speed_ref=self.speeds) + self.flow_draws

    @property
    def sights(self) -> tuple[Sight, ...]:
        """The requested speed, the actual speed, the power, and the gait that the generator has reached."""
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
        """Cost of the speed error and of the power in `step`, negative."""
        error = (_speed(step) - step.drawn["speed_ref"]) / self.speed_tolerance
        return -step.interval * (error * error + step.power / self.power_unit)


def _speed(step: Step) -> Numbers:
    """Speed u in a step [m/s]."""
    heading = 0.5 * (step.before.heading + step.after.heading)
    x = step.after.x - step.before.x
    y = step.after.y - step.before.y
    return (np.cos(heading) * x + np.sin(heading) * y) / step.interval


@value_class
class StationKeeping(Steered):
    """Stay at the origin in an unobserved current; the actions are the offset that steering adds, and the frequency.

        r = -h (ln(1 + (d/d_1)^2) + P/P_1)

    Raises:
        ValueError: If a field is out of its range, or an offset could take a joint beyond its
            limit.
    """

    frequencies: tuple[float, float] = quantity(
        "rad/s", "Action range", ge=0.0, default=(0.0, math.radians(130.0))
    )
    max_distance: float = quantity("m", "At the start, along each axis", ge=0.0, default=1.0)
    distance_tolerance: float = quantity("m", "d_1", gt=0.0, default=0.2)

    def __post_init__(self) -> None:
        """Check that the fields fit together."""
        super().__post_init__()
        check_ends(self, "frequencies")

    @property
    def actions(self) -> tuple[Range, ...]:
        """Offset and frequency."""
        return super().actions + ranges(frequency=self.frequencies)

    @property
    def draws(self) -> tuple[Range, ...]:
        """Start and water of an episode."""
        either_side = -self.max_distance, self.max_distance
        return ranges(x=either_side, y=either_side, heading=(-math.pi, math.pi)) + super().draws

    @property
    def sights(self) -> tuple[Sight, ...]:
        """Origin as seen from the robot, velocity over ground; phase, frequency and offset of the gait."""
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
        """Cost of the distance and of the power in `step`, negative."""
        distance = log_square(np.hypot(step.after.x, step.after.y), self.distance_tolerance)
        return -step.interval * (distance + step.power / self.power_unit)


def _origin(step: Step) -> tuple[Numbers, Numbers]:
    return in_body_axes(step.after, -step.after.x, -step.after.y)
