"""Behaviours that need no sonar but to look for something: straight on, along points, at rest."""

import math
from dataclasses import dataclass

from laticauda.missions.behaviours.behaviour import Behaviour, Outcome
from laticauda.missions.estimate import Estimate
from laticauda.missions.steering import Steering
from laticauda.values import BadArgument, quantity, value_class

Point = tuple[float, float]


@value_class
class Rest(Behaviour[None]):
    """The joints go to rest, and the robot drifts: the end of a mission."""

    def begin(self, estimate: Estimate) -> None:
        """Return no state, at `estimate`."""

    def steer(self, state: None, estimate: Estimate) -> tuple[None, Steering]:
        """Return the next state, from `state` and `estimate`, and how to swim until the next instant."""
        return None, Steering(effort=0.0)


@value_class
class SwimStraight(Behaviour[Point]):
    """Swims straight on over ground for a distance, such as out of a dock."""

    course: float = quantity("rad", "Direction over ground", default=0.0)
    distance: float = quantity("m", "How far", gt=0.0, default=3.0)

    def begin(self, estimate: Estimate) -> Point:
        """Return where it begins, at `estimate`."""
        return estimate.position

    def steer(self, state: Point, estimate: Estimate) -> tuple[Point, Steering]:
        """Return the next state, from `state` and `estimate`, and how to swim until the next instant."""
        return state, Steering(course=self.course)

    def outcome(self, state: Point, estimate: Estimate) -> Outcome | None:
        """Return how the phase ended, by `state` and `estimate`; None if it goes on."""
        along_x = math.cos(self.course) * (estimate.position[0] - state[0])
        along_y = math.sin(self.course) * (estimate.position[1] - state[1])
        if along_x + along_y >= self.distance:
            return "done"
        return None


def check_points(points: tuple[Point, ...]) -> None:
    """Reject a route without points."""
    if not points:
        raise BadArgument("points", "must hold at least one point, got none")


@dataclass(frozen=True)
class RouteState:
    """How far a robot has come along a route."""

    leg: int
    """Index of the point to which it swims; the number of points at the end."""
    begin: Point
    """Where this leg began [m]."""


def follow_route(
    points: tuple[Point, ...], radius: float, state: RouteState, estimate: Estimate
) -> RouteState:
    """Return the state after passing all points that the robot has reached.

    A point is reached within the radius, or when the robot is beyond it.

    Args:
        points: The points [m].
        radius: How near it must come [m].
        state: The state before.
        estimate: What the robot believes.
    """
    while state.leg < len(points):
        point = points[state.leg]
        is_near = estimate.distance_to(point) <= radius
        if not is_near and not _is_beyond(point, state.begin, estimate.position):
            return state
        state = RouteState(leg=state.leg + 1, begin=point)
    return state


def _is_beyond(point: Point, begin: Point, position: Point) -> bool:
    """Return whether a position is beyond the end of a leg."""
    leg_x = point[0] - begin[0]
    leg_y = point[1] - begin[1]
    return (position[0] - point[0]) * leg_x + (position[1] - point[1]) * leg_y > 0.0


@value_class
class SwimRoute(Behaviour[RouteState]):
    """Swims to points, one after the other."""

    points: tuple[Point, ...] = quantity("m", "x and y of the points")
    radius: float = quantity("m", "How near it must come to each", gt=0.0, default=1.0)

    def __post_init__(self) -> None:
        """Reject a route without points."""
        check_points(self.points)

    def begin(self, estimate: Estimate) -> RouteState:
        """Return the state at `estimate`, when the phase begins."""
        return RouteState(leg=0, begin=estimate.position)

    def steer(self, state: RouteState, estimate: Estimate) -> tuple[RouteState, Steering]:
        """Return the next state, from `state` and `estimate`, and how to swim until the next instant."""
        state = follow_route(self.points, self.radius, state, estimate)
        point = self.points[min(state.leg, len(self.points) - 1)]
        return state, Steering(course=estimate.course_to(point))

    def outcome(self, state: RouteState, estimate: Estimate) -> Outcome | None:
        """Return how the phase ended, by `state` and `estimate`; None if it goes on."""
        if state.leg == len(self.points):
            return "done"
        return None


@value_class
class Search(SwimRoute):
    """Swims along points until the sonar sees something; it has failed if nothing was seen on the way.

    What is near home does not count: seen from behind, a dock looks like a wall.
    """

    within: float = quantity("m", "How near what is seen must be", gt=0.0, default=4.0)
    home: Point = quantity("m", "x and y of home", default=(0.0, 0.0))
    home_radius: float = quantity(
        "m", "Distance from home within which nothing counts", ge=0.0, default=0.0
    )

    def outcome(self, state: RouteState, estimate: Estimate) -> Outcome | None:
        """Return how the phase ended, by `state` and `estimate`; None if it goes on."""
        echo = estimate.nearest_echo(away_from=self.home, radius=self.home_radius)
        if echo is not None and echo.distance <= self.within:
            return "done"
        if state.leg == len(self.points):
            return "failed"
        return None
