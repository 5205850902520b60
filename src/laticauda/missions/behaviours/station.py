"""Station keeping: by swimming against the flow, and by thrusters."""

import math
from dataclasses import dataclass, replace

import numpy as np

from laticauda.missions.behaviours.behaviour import Behaviour, Outcome
from laticauda.missions.behaviours.routes import Point
from laticauda.missions.estimate import Estimate
from laticauda.missions.steering import Steering
from laticauda.values import BadArgument, quantity, value_class
from laticauda.values.angles import wrapped

MOST_SIDEWAYS = 0.7
"""Largest share of the speed through the water that goes sideways, of a swimmer that faces the flow [-]."""
MEMORY = 2.0
"""Time over which missing speed is found, relative to that of settling: 2 is critically damped [-]."""
CRITICAL = 2.0
"""Twice the damping ratio of a critically damped return [-]."""
SHARE_OF_MEMORY = 0.1
"""Rate of the integral part, relative to the cube of the frequency with which the robot returns [-]."""


@dataclass(frozen=True, kw_only=True)
class SwimmingState:
    """What a swimmer that keeps its station remembers."""

    began_at: float
    """When the phase began [s]."""
    time: float
    """Time of the last control instant [s]."""
    rests: bool = True
    """Whether it rests, where the flow is too weak to be faced."""
    missing_speed: float = 0.0
    """Speed that its own lacks against the current, found by and by [m/s]."""


@value_class
class KeepStation(Behaviour[SwimmingState]):
    """Stays at a point without thrusters: faces the flow and swims at its speed, by the frequency of the gait.

    If it is ahead of the point, it swims slower and is carried back. How fast it swims at which
    frequency need not be known well: what is missing is found by and by. Where the flow is too weak
    to be faced, it rests near the point, and swims back when it has drifted away.
    """

    position: Point = quantity("m", "x and y of the point")
    swim_speed: float = quantity(
        "m/s", "Speed through the water at the gait's own frequency", gt=0.0, default=0.45
    )
    least_speed: float = quantity(
        "m/s", "Speed through the water below which it does not steer", gt=0.0, default=0.05
    )
    settling: float = quantity(
        "s", "Time in which it would come back at its first speed", gt=0.0, default=10.0
    )
    radius: float = quantity(
        "m", "In weaker flow it swims back from so far away", gt=0.0, default=0.6
    )
    arrival: float = quantity("m", "It then rests this near the point", gt=0.0, default=0.3)
    duration: float = quantity("s", "Done after so long", gt=0.0, default=math.inf)

    def begin(self, estimate: Estimate) -> SwimmingState:
        """Return the state at `estimate`, when the phase begins."""
        return SwimmingState(began_at=estimate.time, time=estimate.time)

    def steer(self, state: SwimmingState, estimate: Estimate) -> tuple[SwimmingState, Steering]:
        """Return the next state, from `state` and `estimate`, and how to swim until the next instant."""
        current_speed = math.hypot(*estimate.current)
        if current_speed >= self.least_speed:
            return self._face_flow(state, estimate, current_speed)
        distance = estimate.distance_to(self.position)
        limit = self.radius if state.rests else self.arrival
        rests = distance < limit
        state = replace(state, time=estimate.time, rests=rests)
        if rests:
            return state, Steering(effort=0.0)
        course = estimate.course_to(self.position)
        return state, Steering(course=course, pace=self._pace(distance / self.settling))

    def outcome(self, state: SwimmingState, estimate: Estimate) -> Outcome | None:
        """Return how the phase ended, by `state` and `estimate`; None if it goes on."""
        if estimate.time - state.began_at >= self.duration:
            return "done"
        return None

    def _face_flow(
        self, state: SwimmingState, estimate: Estimate, current_speed: float
    ) -> tuple[SwimmingState, Steering]:
        """Return the next state, and the heading and pace that bring it to the point and hold it there."""
        upstream = math.atan2(-estimate.current[1], -estimate.current[0])
        ahead, left = to_axes(self.position, estimate.position, upstream)
        wanted_speed = current_speed + state.missing_speed + ahead / self.settling
        speed = min(max(wanted_speed, self.least_speed), self.swim_speed)
        missing_speed = state.missing_speed
        if speed == wanted_speed:
            elapsed = estimate.time - state.time
            missing_speed += ahead * elapsed / (MEMORY * self.settling) ** 2
        most_sideways = MOST_SIDEWAYS * current_speed
        sideways = min(max(left / self.settling, -most_sideways), most_sideways)
        heading = upstream + math.asin(sideways / current_speed)
        state = replace(state, time=estimate.time, rests=False, missing_speed=missing_speed)
        if wanted_speed <= 0.0:
            return state, Steering(effort=0.0)
        return state, Steering(heading=heading, pace=self._pace(speed))

    def _pace(self, speed: float) -> float:
        """Return the share of the gait's frequency at a speed through the water."""
        return min(max(speed, self.least_speed), self.swim_speed) / self.swim_speed


def to_axes(point: Point, origin: Point, direction: float) -> Point:
    """Return how far a point is ahead of another along a direction, and to the left of it [m].

    Args:
        point: The point [m].
        origin: The other [m].
        direction: The direction [rad].
    """
    x = point[0] - origin[0]
    y = point[1] - origin[1]
    cos = math.cos(direction)
    sin = math.sin(direction)
    return cos * x + sin * y, cos * y - sin * x


@dataclass(frozen=True, kw_only=True)
class HoverState:
    """What a robot that hovers by thrusters remembers."""

    began_at: float
    """When the phase began [s]."""
    time: float
    """Time of the last control instant [s]."""
    heading_ref: float
    """Heading that it keeps [rad]."""
    heading: float
    """Heading at the last control instant [rad]."""
    steady_x: float = 0.0
    """Force against the current, found by and by, world axes [N]."""
    steady_y: float = 0.0
    """Likewise [N]."""
    steady_moment: float = 0.0
    """Moment against the current, likewise [N m]."""


@value_class
class Hover(Behaviour[HoverState]):
    """Stays at a point by thrusters, with the joints at rest: pushes back as a damped spring would.

    The driven thrusters are those of `directions` and `places`, in the order of the robot's. What a
    steady current needs is found by and by, within the thrusters' limits.
    """

    position: Point = quantity("m", "x and y of the point")
    heading: float | None = quantity(
        "rad", "Heading that it keeps; None: it faces the current", default=None
    )
    directions: tuple[float, ...] = quantity(
        "rad", "Direction of each driven thruster, from that of the straight body"
    )
    places: tuple[float, ...] = quantity(
        "m", "How far each of them is ahead of the middle of the body"
    )
    max_thrust: float = quantity("N", "Limit of each of them", gt=0.0, default=2.0)
    mass: float = quantity("kg", "Mass with the water moved along", gt=0.0, default=12.0)
    inertia: float = quantity("kg m^2", "Moment of inertia, with the water's", gt=0.0, default=3.0)
    frequency: float = quantity("rad/s", "How fast it returns", gt=0.0, default=0.5)
    least_current: float = quantity(
        "m/s", "It turns only to a current of so much", ge=0.0, default=0.03
    )
    duration: float = quantity("s", "Done after so long", gt=0.0, default=math.inf)

    def __post_init__(self) -> None:
        """Reject thrusters that cannot push in every direction."""
        if len(self.places) != len(self.directions):
            rule = f"must have one entry per thruster, as the {len(self.directions)} `directions`"
            raise BadArgument("places", f"{rule}, got {len(self.places)}")
        if np.linalg.matrix_rank(self._wrench_of_thrusts()) < 3:
            rule = "must be of thrusters that can push ahead and aside, and turn the robot"
            raise BadArgument("directions", f"{rule}, got {self.directions} at {self.places}")

    def begin(self, estimate: Estimate) -> HoverState:
        """Return the state at `estimate`, when the phase begins."""
        heading = estimate.heading_now
        heading_ref = heading
        if self.heading is not None:
            heading_ref = self.heading
        return HoverState(
            began_at=estimate.time,
            time=estimate.time,
            heading=heading,
            heading_ref=heading_ref,
        )

    def steer(self, state: HoverState, estimate: Estimate) -> tuple[HoverState, Steering]:
        """Return the next state, from `state` and `estimate`, and how to swim until the next instant."""
        elapsed = estimate.time - state.time
        heading = estimate.heading_now
        heading_ref = self._heading_ref(state, estimate)
        turn_rate = 0.0
        if elapsed > 0.0:
            turn_rate = wrapped(heading - state.heading) / elapsed
        turn_error = wrapped(heading_ref - heading)
        error_x = self.position[0] - estimate.position[0]
        error_y = self.position[1] - estimate.position[1]
        velocity_x, velocity_y = estimate.velocity_now
        force_x = state.steady_x + self._push(self.mass, error_x, velocity_x)
        force_y = state.steady_y + self._push(self.mass, error_y, velocity_y)
        moment = state.steady_moment + self._push(self.inertia, turn_error, turn_rate)
        ahead, left = to_axes((force_x, force_y), (0.0, 0.0), heading)
        thrusts = np.linalg.pinv(self._wrench_of_thrusts()) @ np.array([ahead, left, moment])
        state = replace(state, time=estimate.time, heading=heading, heading_ref=heading_ref)
        if np.all(np.abs(thrusts) < self.max_thrust):
            growth = SHARE_OF_MEMORY * self.frequency**3 * elapsed
            state = replace(
                state,
                steady_x=state.steady_x + growth * self.mass * error_x,
                steady_y=state.steady_y + growth * self.mass * error_y,
                steady_moment=state.steady_moment + growth * self.inertia * turn_error,
            )
        limited = np.clip(thrusts, -self.max_thrust, self.max_thrust)
        return state, Steering(effort=0.0, thrusts=tuple(limited.tolist()))

    def outcome(self, state: HoverState, estimate: Estimate) -> Outcome | None:
        """Return how the phase ended, by `state` and `estimate`; None if it goes on."""
        if estimate.time - state.began_at >= self.duration:
            return "done"
        return None

    def _heading_ref(self, state: HoverState, estimate: Estimate) -> float:
        """Return the heading that it keeps: its own, or against the current."""
        is_weak = math.hypot(*estimate.current) < self.least_current
        if self.heading is not None or is_weak:
            return state.heading_ref
        return math.atan2(-estimate.current[1], -estimate.current[0])

    def _push(self, mass: float, error: float, rate: float) -> float:
        """Return the force of a damped spring, or the moment."""
        return mass * self.frequency * (self.frequency * error - CRITICAL * rate)

    def _wrench_of_thrusts(self) -> np.ndarray:
        """Return the force ahead, the force to the left and the moment, by thrust of every thruster."""
        directions = np.array(self.directions, dtype=float)
        places = np.array(self.places, dtype=float)
        across = np.sin(directions)
        return np.stack([np.cos(directions), across, places * across])
