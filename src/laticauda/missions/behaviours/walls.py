"""Distance keeping by sonar along a net, a wall or a pipe."""

import math
from dataclasses import dataclass
from typing import Literal

from laticauda.missions.behaviours.behaviour import Behaviour, Outcome
from laticauda.missions.estimate import Echo, Estimate
from laticauda.missions.steering import Steering
from laticauda.values import option, quantity, value_class
from laticauda.values.angles import wrapped

SMOOTHING = 1.5
"""Time over which distance and direction of the wall are averaged, about a cycle [s]."""
TURN_SMOOTHING = 5.0
"""Time over which the wall's turning is averaged [s]."""


@dataclass(frozen=True, kw_only=True)
class WallState:
    """What is known of the wall, averaged over a cycle."""

    time: float
    """Time of the last control instant [s]."""
    seen_at: float
    """When the wall was last seen [s]."""
    direction: float | None = None
    """Direction from the robot to the wall, unwrapped; None: not yet seen [rad]."""
    distance: float = 0.0
    """Distance of the middle of the body from the wall [m]."""
    turn_rate: float = 0.0
    """How fast its direction turns [rad/s]."""
    turned: float = 0.0
    """By how much it has turned since it was first seen, positive to the left [rad]."""
    travelled: float = 0.0
    """Way along it [m]."""


@value_class
class FollowWall(Behaviour[WallState]):
    """Swims along a wall at a distance: around a pen for some turns, or along a wall or pipe for a length.

    What is near home does not count: seen from behind, a dock looks like a wall.
    """

    side: Literal["left", "right"] = option("On which side the wall is", default="left")
    distance: float = quantity(
        "m", "Distance of the middle of the body from it", gt=0.0, default=1.3
    )
    look_ahead: float = quantity(
        "m", "Distance ahead at which it aims to be right", gt=0.0, default=1.5
    )
    turns: float = quantity("", "Done after so many turns around it", gt=0.0, default=1.1)
    length: float = quantity("m", "Done after so long a way along it", gt=0.0, default=math.inf)
    home: tuple[float, float] = quantity("m", "x and y of home", default=(0.0, 0.0))
    home_radius: float = quantity(
        "m", "Distance from home within which nothing counts", ge=0.0, default=0.0
    )
    lost_after: float = quantity(
        "s", "It has failed if the wall is not seen for so long", gt=0.0, default=6.0
    )

    def begin(self, estimate: Estimate) -> WallState:
        """Return the state at `estimate`, when the phase begins."""
        return WallState(time=estimate.time, seen_at=estimate.time)

    def steer(self, state: WallState, estimate: Estimate) -> tuple[WallState, Steering]:
        """Return the next state, from `state` and `estimate`, and how to swim until the next instant."""
        elapsed = estimate.time - state.time
        echo = estimate.nearest_echo(away_from=self.home, radius=self.home_radius)
        if echo is None:
            state = _replace_time(state, estimate.time)
        else:
            state = _see_wall(state, echo, estimate, elapsed)
        if state.direction is None:
            return state, Steering(heading=estimate.heading)
        side = self._side
        course_along = state.direction - side * 0.5 * math.pi
        correction = math.atan2(state.distance - self.distance, self.look_ahead)
        course = course_along + side * correction
        return state, Steering(course=course, turn_rate=state.turn_rate)

    @property
    def _side(self) -> float:
        """1 for a wall to the left, -1 to the right."""
        return 1.0 if self.side == "left" else -1.0

    def outcome(self, state: WallState, estimate: Estimate) -> Outcome | None:
        """Return how the phase ended, by `state` and `estimate`; None if it goes on."""
        has_turned = self._side * state.turned >= 2.0 * math.pi * self.turns
        if has_turned or state.travelled >= self.length:
            return "done"
        if estimate.time - state.seen_at > self.lost_after:
            return "failed"
        return None


def _replace_time(state: WallState, time: float) -> WallState:
    """Return a state in which nothing but the time has changed: the wall is not seen."""
    return WallState(**{**vars(state), "time": time})


def _see_wall(state: WallState, echo: Echo, estimate: Estimate, elapsed: float) -> WallState:
    """Return the state after the nearest echo: the wall is the line through it, across its direction."""
    head_x, head_y = estimate.head_position
    direction = math.atan2(echo.y - head_y, echo.x - head_x)
    to_echo_x = echo.x - estimate.position[0]
    to_echo_y = echo.y - estimate.position[1]
    distance = to_echo_x * math.cos(direction) + to_echo_y * math.sin(direction)
    is_fresh = estimate.sonar_silence <= elapsed
    seen_at = state.seen_at
    if is_fresh:
        seen_at = estimate.time
    if state.direction is None:
        return WallState(
            time=estimate.time, seen_at=seen_at, direction=direction, distance=distance
        )
    share = min(elapsed / SMOOTHING, 1.0)
    turn = share * wrapped(direction - state.direction)
    turn_share = min(elapsed / TURN_SMOOTHING, 1.0)
    turn_rate = state.turn_rate + turn_share * (turn / max(elapsed, 1e-6) - state.turn_rate)
    along = state.direction - 0.5 * math.pi
    speed_along = estimate.velocity[0] * math.cos(along) + estimate.velocity[1] * math.sin(along)
    return WallState(
        time=estimate.time,
        seen_at=seen_at,
        direction=state.direction + turn,
        distance=state.distance + share * (distance - state.distance),
        turn_rate=turn_rate,
        turned=state.turned + turn,
        travelled=state.travelled + abs(speed_along) * elapsed,
    )


@value_class
class StandOff(Behaviour[tuple[float, float]]):
    """Swims away from what the sonar last saw, and waits there in circles."""

    distance: float = quantity("m", "How far away", gt=0.0, default=2.5)

    def begin(self, estimate: Estimate) -> tuple[float, float]:
        """Return where it waits, from the position in `estimate`."""
        x, y = estimate.position
        echo = estimate.last_echo
        if echo is None:
            return x, y
        away = math.atan2(y - echo.y, x - echo.x)
        return x + self.distance * math.cos(away), y + self.distance * math.sin(away)

    def steer(
        self, state: tuple[float, float], estimate: Estimate
    ) -> tuple[tuple[float, float], Steering]:
        """Return the next state, from `state` and `estimate`, and how to swim until the next instant."""
        return state, Steering(course=estimate.course_to(state))
