"""Navigation: from what sensors tell to what the robot believes.

The direction of the head comes from the gyro, held by the compass. Its velocity is that of the Doppler log;
what the body's own swing adds to it is known from the joints' encoders, so the velocity of the middle
remains. Its sum is the position, which the acoustic beacon corrects. The velocity over ground less that
through the water is the current. A sensor that tells exactly the same again counts as silent: noise
never repeats.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from laticauda.missions.estimate import Echo, Estimate
from laticauda.missions.posture import Posture, bend_of_head, find_posture
from laticauda.scenarios import Observation
from laticauda.sensing import Reading
from laticauda.values import BadArgument, option, quantity, value_class
from laticauda.values.angles import wrapped

COMPASS_SHARE = 0.2
"""Share of the difference between compass and gyro that is corrected at once [-]."""
CURRENT_TIME = 10.0
"""Time over which the current is averaged, longer than the period of waves [s]."""
DRIFT = 0.02
"""Growth of the position's standard deviation with the root of time, with Doppler velocity [m/s^0.5]."""
BLIND_DRIFT = 0.1
"""The same without it [m/s^0.5]."""
GATE = 4.0
"""Standard deviations by which a fix may be off; farther ones are not believed at first [-]."""
MOST_REFUSED = 5
"""Fixes that are refused in a row; the next one is believed."""
ECHO_TIME = 3.0
"""Time after which the echoes of a ping no longer count [s]."""
GYRO_GAP = 0.5
"""Time without the gyro after which it no longer counts how the body turned before [s]."""
SQUARE = 0.3
"""Side of a square of the grid in which echoes are remembered [m]."""
FIRST_STD = 3.0
"""Standard deviation of the position before the first fix [m]."""
FIX_NOISE = (0.05, 0.02)
"""Standard deviation of a fix: constant [m], and share of the distance [-]."""


@dataclass(frozen=True, kw_only=True)
class NavigationState:
    """What navigation keeps from one control instant to the next."""

    estimate: Estimate | None = None
    head_rate: float = 0.0
    """How fast the head turns, by the gyro or assumed [rad/s]."""
    turn_rate: float = 0.0
    """How fast the body as a whole turned when the gyro last told it [rad/s]."""
    velocity: tuple[float, float] = (0.0, 0.0)
    """Velocity of the middle over ground, not averaged [m/s]."""
    n_refused: int = 0
    """Fixes refused in a row."""
    n_of_current: int = 0
    """Measurements of the current so far."""
    headings: tuple[tuple[float, float], ...] = ()
    """Times and headings of the last cycle [s, rad]."""
    sightings: Mapping[tuple[int, int], tuple[float, float]] = field(
        default_factory=dict[tuple[int, int], tuple[float, float]]
    )
    """Points from which echoes came, by square of the grid [m]."""
    heard_at: Mapping[str, float] = field(default_factory=dict[str, float])
    """When each sensor last told something new [s]."""
    last_values: Mapping[str, tuple[float, ...]] = field(
        default_factory=dict[str, tuple[float, ...]]
    )
    """What it told."""


@value_class
class Navigation:
    """Dead reckoning by Doppler velocity, gyro and compass, corrected by an acoustic beacon."""

    beacon: tuple[float, float] = quantity("m", "x and y of the beacon", default=(0.0, 0.0))
    start: tuple[float, float] = quantity(
        "m", "Where the robot is believed to start", default=(0.0, 0.0)
    )
    body_length: float = quantity("m", "Length of the body without its fin", gt=0.0, default=1.62)
    swim_speed: float = quantity(
        "m/s", "Speed through the water, where no sensor tells it", gt=0.0, default=0.2
    )
    beams: tuple[float, ...] = quantity(
        "rad", "Directions of the sonar's beams", ge=-math.pi, le=math.pi, default=()
    )
    compass: str = option("Name of the compass", default="compass")
    inertial: str = option("Name of the inertial unit", default="inertial")
    ground_velocity: str = option("Name of the Doppler log over ground", default="velocity")
    water_velocity: str = option("Name of that through the water", default="water_velocity")
    position: str = option("Name of the acoustic position", default="beacon")
    sonar: str = option("Name of the sonar", default="sonar")
    battery: str = option("Name of the battery gauge", default="battery")
    depth: str = option("Name of the depth gauge", default="depth")
    contact: str = option("Name of the contact sensor", default="contact")
    yaw_joints: tuple[int, ...] = quantity(
        "",
        "Joints that bend the body sideways, 0 = tail, of a robot that has others, too; empty: all",
        ge=0,
        default=(),
    )

    def init(self) -> NavigationState:
        """Return the state before the first control instant."""
        return NavigationState()

    def step(
        self, state: NavigationState, observation: Observation, cycle: float
    ) -> NavigationState:
        """Return the state after an observation, of which only readings and joints are used.

        Args:
            state: The state before.
            observation: The observation.
            cycle: Period of the gait, over which headings are averaged [s].
        """
        return _Instant(self, state, observation, cycle).state_after()


class _Instant:
    """One control instant of navigation: what is fresh, and what follows from it.

    Args:
        navigation: The settings.
        state: The state before.
        observation: The observation.
        cycle: Period of the gait [s].
    """

    def __init__(
        self,
        navigation: Navigation,
        state: NavigationState,
        observation: Observation,
        cycle: float,
    ) -> None:
        self._navigation = navigation
        self._before = state
        self._cycle = cycle
        self._time = float(observation.time)
        self._joint_angle = self._of_yaw_joints(observation.joint_angle)
        self._joint_rate = self._of_yaw_joints(observation.joint_rate)
        self._readings = observation.readings
        self._heard_at = dict(state.heard_at)
        self._last_values = dict(state.last_values)
        self._fresh: dict[str, list[float]] = {}
        for name, reading in observation.readings.items():
            self._take(name, reading)

    def _take(self, name: str, reading: Reading) -> None:
        """Take a reading, unless it is old or the same again."""
        self._heard_at.setdefault(name, self._time)
        if not reading.is_new:
            return
        values: list[float] = reading.values.tolist()
        if _repeats(values, self._last_values.get(name)):
            return
        self._last_values[name] = tuple(values)
        self._heard_at[name] = self._time
        self._fresh[name] = values

    def _of_yaw_joints(self, values: np.ndarray) -> list[float]:
        """Return the values of the joints that bend the body sideways, tail first."""
        of_all: list[float] = values.tolist()
        if not self._navigation.yaw_joints:
            return of_all
        return [of_all[joint] for joint in self._navigation.yaw_joints]

    @property
    def _elapsed(self) -> float:
        """Time since the control instant before; 0 at the first [s]."""
        estimate = self._before.estimate
        if estimate is None:
            return 0.0
        return self._time - estimate.time

    def state_after(self) -> NavigationState:
        """Return the state after this instant."""
        turn_rate = self._turn_rate()
        head_rate = turn_rate + bend_of_head(self._joint_rate)
        head_heading = self._head_heading(head_rate)
        posture = find_posture(
            body_length=self._navigation.body_length,
            head_heading=head_heading,
            head_rate=head_rate,
            joint_angle=self._joint_angle,
            joint_rate=self._joint_rate,
        )
        current, n_of_current = self._current(head_heading)
        headings = self._headings_of_cycle(posture.heading)
        heading = sum(sample for _, sample in headings) / len(headings)
        velocity = self._velocity(head_heading, posture, heading, current)
        position, variance, n_refused = self._position(head_heading, posture, velocity)
        half_length = 0.5 * self._navigation.body_length
        bow_x = position[0] + half_length * math.cos(heading)
        bow_y = position[1] + half_length * math.sin(heading)
        head_position = position[0] + posture.head_x, position[1] + posture.head_y
        echoes = self._echoes(head_position, head_heading)
        sightings = self._sightings(echoes)
        estimate = Estimate(
            time=self._time,
            position=position,
            position_std=math.sqrt(variance),
            velocity=self._mean_velocity(velocity),
            velocity_now=velocity,
            heading=heading,
            heading_now=posture.heading,
            bow=(bow_x, bow_y),
            current=current,
            head_position=head_position,
            head_heading=head_heading,
            echoes=echoes,
            last_echo=self._last_echo(echoes),
            sightings=tuple(sightings.values()),
            battery=self._last_value(self._navigation.battery),
            depth=self._last_value(self._navigation.depth),
            beacon_distance=self._last_value(self._navigation.position),
            contact_force=self._contact_force(),
            sonar_silence=self._time - self._heard_at.get(self._navigation.sonar, self._time),
            silence={name: self._time - heard for name, heard in self._heard_at.items()},
        )
        return NavigationState(
            estimate=estimate,
            head_rate=head_rate,
            turn_rate=turn_rate,
            velocity=velocity,
            n_refused=n_refused,
            n_of_current=n_of_current,
            headings=headings,
            sightings=sightings,
            heard_at=self._heard_at,
            last_values=self._last_values,
        )

    def _turn_rate(self) -> float:
        """Return how fast the body as a whole turns: by the gyro, or as before, or not if that is long ago [rad/s]."""
        values = self._fresh.get(self._navigation.inertial)
        if values is not None:
            return values[2] - bend_of_head(self._joint_rate)
        if self._is_without_gyro:
            return 0.0
        return self._before.turn_rate

    @property
    def _is_without_gyro(self) -> bool:
        """Whether the gyro has been silent for long."""
        heard_at = self._heard_at.get(self._navigation.inertial, -math.inf)
        return self._time - heard_at > GYRO_GAP

    def _head_heading(self, head_rate: float) -> float:
        """Return the direction of the head [rad]."""
        compass = self._fresh.get(self._navigation.compass)
        before = self._before.estimate
        if before is None:
            if compass is None:
                return 0.0
            return compass[0]
        share = COMPASS_SHARE
        if self._is_without_gyro:
            share = 1.0
        mean_rate = 0.5 * (head_rate + self._before.head_rate)
        predicted = before.head_heading + mean_rate * self._elapsed
        if compass is None:
            return predicted
        return predicted + share * wrapped(compass[0] - predicted)

    def _headings_of_cycle(self, heading: float) -> tuple[tuple[float, float], ...]:
        """Return the times and headings of the last cycle."""
        oldest = self._time - self._cycle + 0.5 * self._elapsed
        recent = [sample for sample in self._before.headings if sample[0] >= oldest]
        return (*recent, (self._time, heading))

    def _in_world(self, name: str, head_heading: float) -> tuple[float, float] | None:
        """Return the velocity of the head that a Doppler log tells, world axes; None if it is silent [m/s]."""
        values = self._fresh.get(name)
        if values is None or not math.isfinite(values[0]):
            return None
        forward, left = values[0], values[1]
        cos = math.cos(head_heading)
        sin = math.sin(head_heading)
        return cos * forward - sin * left, sin * forward + cos * left

    def _current(self, head_heading: float) -> tuple[tuple[float, float], int]:
        """Return the current, and of how many measurements it is the mean."""
        before = self._before.estimate
        current = (0.0, 0.0)
        if before is not None:
            current = before.current
        over_ground = self._in_world(self._navigation.ground_velocity, head_heading)
        through_water = self._in_world(self._navigation.water_velocity, head_heading)
        n = self._before.n_of_current
        if over_ground is None or through_water is None:
            return current, n
        share = max(self._elapsed / CURRENT_TIME, 1.0 / (n + 1))
        x = current[0] + share * (over_ground[0] - through_water[0] - current[0])
        y = current[1] + share * (over_ground[1] - through_water[1] - current[1])
        return (x, y), n + 1

    def _velocity(
        self, head_heading: float, posture: Posture, heading: float, current: tuple[float, float]
    ) -> tuple[float, float]:
        """Return the velocity of the middle over ground [m/s]."""
        swing = posture.swing_x, posture.swing_y
        over_ground = self._in_world(self._navigation.ground_velocity, head_heading)
        if over_ground is not None:
            return over_ground[0] - swing[0], over_ground[1] - swing[1]
        through_water = self._in_world(self._navigation.water_velocity, head_heading)
        if through_water is not None:
            x = through_water[0] + current[0] - swing[0]
            return x, through_water[1] + current[1] - swing[1]
        speed = self._navigation.swim_speed
        return current[0] + speed * math.cos(heading), current[1] + speed * math.sin(heading)

    def _mean_velocity(self, velocity: tuple[float, float]) -> tuple[float, float]:
        """Return the velocity, averaged over about a cycle [m/s]."""
        before = self._before.estimate
        if before is None:
            return velocity
        share = min(self._elapsed / self._cycle, 1.0)
        x, y = before.velocity
        return x + share * (velocity[0] - x), y + share * (velocity[1] - y)

    def _position(
        self, head_heading: float, posture: Posture, velocity: tuple[float, float]
    ) -> tuple[tuple[float, float], float, int]:
        """Return the position, its variance, and how many fixes were refused in a row."""
        before = self._before.estimate
        if before is None:
            x, y = self._navigation.start
            variance = FIRST_STD**2
        else:
            last = self._before.velocity
            x = before.position[0] + 0.5 * (velocity[0] + last[0]) * self._elapsed
            y = before.position[1] + 0.5 * (velocity[1] + last[1]) * self._elapsed
            has_doppler = self._navigation.ground_velocity in self._fresh
            drift = DRIFT
            if not has_doppler:
                drift = BLIND_DRIFT
            variance = before.position_std**2 + drift**2 * self._elapsed
        values = self._fresh.get(self._navigation.position)
        if values is None or not math.isfinite(values[0]):
            return (x, y), variance, self._before.n_refused
        distance = values[0] * math.cos(values[2])
        direction = head_heading + values[1]
        error_x = self._navigation.beacon[0] - distance * math.cos(direction) - posture.head_x - x
        error_y = self._navigation.beacon[1] - distance * math.sin(direction) - posture.head_y - y
        noise = FIX_NOISE[0] + FIX_NOISE[1] * abs(distance)
        spread = variance + noise**2
        is_far = math.hypot(error_x, error_y) > GATE * math.sqrt(spread)
        if is_far and self._before.n_refused < MOST_REFUSED:
            return (x, y), variance, self._before.n_refused + 1
        share = variance / spread
        if is_far:
            share = 1.0
        fixed = x + share * error_x, y + share * error_y
        return fixed, max(share * noise**2, variance * (1.0 - share)), 0

    def _echoes(self, head_position: tuple[float, float], head_heading: float) -> tuple[Echo, ...]:
        """Return the echoes of the last ping."""
        values = self._fresh.get(self._navigation.sonar)
        if values is None:
            return self._remembered_echoes()
        beams = self._navigation.beams
        if len(values) != len(beams):
            rule = f"must have the beams of the sonar, {len(values)} of them"
            raise BadArgument("navigation.beams", f"{rule}, got {len(beams)}")
        echoes: list[Echo] = []
        for bearing, distance in zip(beams, values, strict=True):
            if not math.isfinite(distance):
                continue
            direction = head_heading + bearing
            x = head_position[0] + distance * math.cos(direction)
            y = head_position[1] + distance * math.sin(direction)
            echoes.append(Echo(bearing, distance, x, y))
        return tuple(echoes)

    def _remembered_echoes(self) -> tuple[Echo, ...]:
        """Return the echoes of the last ping, unless that is too long ago."""
        before = self._before.estimate
        last_ping = self._heard_at.get(self._navigation.sonar, -math.inf)
        if before is None or self._time - last_ping > ECHO_TIME:
            return ()
        return before.echoes

    def _sightings(self, echoes: tuple[Echo, ...]) -> Mapping[tuple[int, int], tuple[float, float]]:
        """Return the points from which echoes came so far, those of this ping included."""
        if self._navigation.sonar not in self._fresh:
            return self._before.sightings
        sightings = dict(self._before.sightings)
        for echo in echoes:
            square = round(echo.x / SQUARE), round(echo.y / SQUARE)
            sightings[square] = echo.x, echo.y
        return sightings

    def _last_echo(self, echoes: tuple[Echo, ...]) -> Echo | None:
        """Return the nearest echo of the last ping that had one."""
        if echoes:
            return min(echoes, key=lambda echo: echo.distance)
        before = self._before.estimate
        if before is None:
            return None
        return before.last_echo

    def _last_value(self, sensor: str) -> float | None:
        """Return the first value that a sensor last told; None if it told none."""
        values = self._last_values.get(sensor)
        if values is None or not math.isfinite(values[0]):
            return None
        return values[0]

    def _contact_force(self) -> float | None:
        """Return the force that the contact sensor last told, which may be zero for long; None if it told none."""
        reading = self._readings.get(self._navigation.contact)
        if reading is None or not math.isfinite(reading.values[0]):
            return None
        return float(reading.values[0])


def _repeats(values: Sequence[float], last_values: Sequence[float] | None) -> bool:
    """Return whether a sensor tells the same again; having nothing to tell, such as no echo, may be so for long."""
    if last_values is None:
        return False
    numbers = [value for value in values if math.isfinite(value)]
    last_numbers = [value for value in last_values if math.isfinite(value)]
    return bool(numbers) and numbers == last_numbers
