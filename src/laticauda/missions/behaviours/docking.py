"""Docking: along the axis of a funnel, with a check before its mouth and another try."""

import math
from dataclasses import dataclass, replace

from laticauda.missions.behaviours.behaviour import Behaviour, Outcome
from laticauda.missions.behaviours.routes import Point, RouteState, check_points, follow_route
from laticauda.missions.estimate import Estimate
from laticauda.missions.steering import Steering
from laticauda.values import quantity, value_class


@dataclass(frozen=True, kw_only=True)
class DockingState:
    """Where an approach is."""

    route: RouteState | None
    """On the way to the beginning of the axis; None: on the axis."""
    tries: int = 1
    """Which try this is."""


@value_class
class SwimIntoDock(Behaviour[DockingState]):
    """Swims along a route to the axis of a funnel, and along it to the latch.

    Before the mouth it checks how far it is beside the axis: too far, and it turns away and tries
    again, as it does if it has passed the latch without being caught.
    """

    position: Point = quantity("m", "x and y of the latch", default=(0.0, 0.0))
    heading: float = quantity("rad", "Direction in which a robot swims in", default=0.0)
    route: tuple[Point, ...] = quantity(
        "m", "Points from behind the dock around to the beginning of its axis"
    )
    radius: float = quantity("m", "How near it must come to these", gt=0.0, default=1.0)
    look_ahead: float = quantity("m", "Distance ahead along the axis", gt=0.0, default=1.2)
    check_at: float = quantity(
        "m", "Distance of the head from the latch at which it checks", gt=0.0, default=1.3
    )
    tolerance: float = quantity(
        "m", "How far beside the axis the head may be", gt=0.0, default=0.45
    )
    passed: float = quantity("m", "How far beyond the latch a try is over", gt=0.0, default=0.5)
    tries: int = quantity("", "How often it tries", ge=1, default=4)

    def __post_init__(self) -> None:
        """Reject a route without points."""
        check_points(self.route)

    def begin(self, estimate: Estimate) -> DockingState:
        """Return the state at `estimate`, when the phase begins."""
        return DockingState(route=RouteState(leg=0, begin=estimate.position))

    def steer(self, state: DockingState, estimate: Estimate) -> tuple[DockingState, Steering]:
        """Return the next state, from `state` and `estimate`, and how to swim until the next instant."""
        if state.route is not None:
            route = follow_route(self.route, self.radius, state.route, estimate)
            if route.leg < len(self.route):
                course = estimate.course_to(self.route[route.leg])
                return replace(state, route=route), Steering(course=course)
            state = replace(state, route=None)
        if self._must_try_again(estimate):
            route = RouteState(leg=0, begin=estimate.position)
            state = DockingState(route=route, tries=state.tries + 1)
            return state, Steering(course=estimate.course_to(self.route[0]))
        _, beside = self._along_and_beside(estimate.bow)
        course = self.heading - math.atan2(beside, self.look_ahead)
        return state, Steering(course=course)

    def outcome(self, state: DockingState, estimate: Estimate) -> Outcome | None:
        """Return how the phase ended, by `state` and `estimate`; None if it goes on."""
        if state.tries > self.tries:
            return "failed"
        return None

    def _must_try_again(self, estimate: Estimate) -> bool:
        """Return whether this try misses the latch."""
        along, beside = self._along_and_beside(estimate.bow)
        if along > self.passed:
            return True
        is_at_check = -self.check_at < along < -0.5 * self.check_at
        return is_at_check and abs(beside) > self.tolerance

    def _along_and_beside(self, point: Point) -> tuple[float, float]:
        """Return how far a point is beyond the latch, and how far to the left of the axis [m]."""
        x = point[0] - self.position[0]
        y = point[1] - self.position[1]
        cos = math.cos(self.heading)
        sin = math.sin(self.heading)
        return cos * x + sin * y, cos * y - sin * x
