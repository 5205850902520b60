"""Keeping clear of what the sonar has seen: courses that pass it, and a turn away if it is too near ahead."""

import math
from collections.abc import Sequence
from typing import NamedTuple

from laticauda.missions.estimate import Estimate
from laticauda.missions.steering import Steering
from laticauda.values import quantity, value_class
from laticauda.values.angles import wrapped

MARGIN = 1e-3
"""Angle by which a free course passes the end of a blocked sector [rad]."""


class Sector(NamedTuple):
    """Courses that would come too near to a point."""

    middle: float
    """Direction of the point [rad]."""
    half_width: float
    """Angle to either side [rad]."""

    def blocks(self, course: float) -> bool:
        """Return whether it holds a course.

        Args:
            course: The course [rad].
        """
        return abs(wrapped(course - self.middle)) < self.half_width


@value_class
class Avoidance:
    """Keeps clear of remembered echoes, so that a robot finds around a net even while its sonar is silent."""

    clearance: float = quantity(
        "m", "Distance of the middle of the body from what was seen", gt=0.0, default=1.1
    )
    horizon: float = quantity("m", "Points farther away do not count yet", gt=0.0, default=3.0)
    turning_room: float = quantity(
        "m", "A turn does not sweep across a point nearer than this", ge=0.0, default=2.0
    )
    distance: float = quantity(
        "m", "Echoes nearer than this are turned away from", ge=0.0, default=0.7
    )
    sector: float = quantity(
        "rad", "Half of the sector ahead in which they are", gt=0.0, default=math.radians(60.0)
    )

    def correct(self, steering: Steering, estimate: Estimate) -> Steering:
        """Return a steering that keeps clear.

        Args:
            steering: What the behaviour wants.
            estimate: What the robot believes.
        """
        turn = self._turn_away(estimate)
        if turn is not None:
            return turn
        if steering.course is None:
            return steering
        course = self.free_course(steering.course, estimate)
        way_round = self._turn_other_way(course, estimate)
        if way_round is not None:
            return way_round
        if course == steering.course:
            return steering
        return Steering(course=course, effort=steering.effort, thrusts=steering.thrusts)

    def free_course(self, course: float, estimate: Estimate) -> float:
        """Return the course next to a wanted one that comes too near to nothing that was seen [rad].

        Args:
            course: The wanted one [rad].
            estimate: What the robot believes.
        """
        sectors = self._blocked_sectors(estimate)
        if _is_free(course, sectors):
            return course
        free_courses: list[float] = []
        for sector in sectors:
            for side in (-1.0, 1.0):
                edge = sector.middle + side * (sector.half_width + MARGIN)
                if _is_free(edge, sectors):
                    free_courses.append(edge)
        if not free_courses:
            return course
        return min(free_courses, key=lambda free: abs(wrapped(free - course)))

    def _blocked_sectors(self, estimate: Estimate) -> list[Sector]:
        """Return the courses that would come too near to what was seen."""
        sectors: list[Sector] = []
        for point in estimate.sightings:
            distance = estimate.distance_to(point)
            if distance > self.horizon:
                continue
            half_width = 0.5 * math.pi
            if distance > self.clearance:
                half_width = math.asin(self.clearance / distance)
            sectors.append(Sector(estimate.course_to(point), half_width))
        return sectors

    def _turn_other_way(self, course: float, estimate: Estimate) -> Steering | None:
        """Return a turn the long way round, where the short one would sweep across what is near; else None."""
        if not estimate.sightings:
            return None
        nearest = min(estimate.sightings, key=estimate.distance_to)
        if estimate.distance_to(nearest) > self.turning_room:
            return None
        turn = wrapped(course - estimate.heading)
        to_nearest = wrapped(estimate.course_to(nearest) - estimate.heading)
        sweeps_across = turn * to_nearest > 0.0 and abs(to_nearest) < abs(turn)
        if not sweeps_across:
            return None
        return Steering(offset=-math.copysign(math.inf, turn))

    def _turn_away(self, estimate: Estimate) -> Steering | None:
        """Return a turn away from the nearest echo ahead; None if nothing is too near."""
        ahead = [echo for echo in estimate.echoes if abs(echo.bearing) <= self.sector]
        too_near = [echo for echo in ahead if echo.distance < self.distance]
        if not too_near:
            return None
        nearest = min(too_near, key=lambda echo: echo.distance)
        return Steering(offset=-math.copysign(math.inf, nearest.bearing))


def _is_free(course: float, sectors: Sequence[Sector]) -> bool:
    """Return whether no sector blocks a course."""
    return not any(sector.blocks(course) for sector in sectors)
