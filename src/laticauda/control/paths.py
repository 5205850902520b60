"""Paths to follow: a straight line, a circle, legs between waypoints, a smooth curve through them.

Each is a `Path` with `init` and `locate`, and with the progress along it as an explicit value.
"""

import math
from collections.abc import Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from laticauda.control.curve import Curve, fit_natural_cubic
from laticauda.control.frames import Distances, Path, PathFrame, Points, Position, VectorPath
from laticauda.values import BadArgument, quantity, value_class, wrap_to_pi

Waypoints = tuple[tuple[float, float], ...]
"""Points in order, x and y in world axes [m]."""


@value_class
class StraightLine(Path[None]):
    """Straight line without start or end.

    Raises:
        ValueError: If a field is not a finite number.

    Example:
        >>> line = StraightLine()
        >>> line.locate(line.init(), np.array([2.0, 0.5]))[1].cross_track_error
        0.5
    """

    point: tuple[float, float] = quantity(
        "m", "Point with along-track distance 0, in world axes", default=(0.0, 0.0)
    )
    angle: float = quantity(
        "rad", "Its direction, from the world x axis, counter-clockwise", default=0.0
    )

    def init(self) -> None:
        """Return None: a line has no progress."""

    def locate(self, progress: None, position: Position) -> tuple[None, PathFrame]:
        """Locate a `position` [m]; there is no `progress`.

        Args:
            progress: None, because a line needs no memory.
            position: Center of mass, in world axes [m].
        """
        along, across = transform_to_axes(self.point, self.angle, position)
        frame = PathFrame(
            along_track_distance=along,
            cross_track_error=across,
            path_tangential_angle=self._direction,
            curvature=0.0,
            remaining=math.inf,
        )
        return None, frame

    @cached_property
    def _direction(self) -> float:
        """Its direction in [-pi, pi) [rad]."""
        return wrap_to_pi(self.angle)

    @classmethod
    def vectorize(cls, paths: Sequence[Any]) -> VectorPath:
        """Return one object that locates a robot on each of many of these paths.

        Args:
            paths: The paths, one for each robot.
        """
        from laticauda.control.vector_paths import VectorLines

        return VectorLines(paths)

    def points(self, along_track_distance: Distances) -> Points:
        """Return the point of the line at each `along_track_distance` [m].

        Args:
            along_track_distance: Distances along the path from its start [m].
        """
        return np.array(self.point) + np.outer(along_track_distance, _unit_vector(self.angle))


class CircleProgress(NamedTuple):
    """Progress along a circle."""

    direction: float
    """Direction from the center to the last position, from the world x axis [rad]."""
    angle_covered: float
    """Angle covered so far, positive in the direction in which the circle is followed [rad]."""


@value_class
class Circle(Path[CircleProgress | None]):
    """Circle, followed once or several times; it starts where the robot is first seen, without end.

    Raises:
        ValueError: If the radius is not positive, or the number of turns is 0.
    """

    center: tuple[float, float] = quantity("m", "Its center; x and y in world axes")
    radius: float = quantity("m", "Its radius", gt=0.0)
    turns: float = quantity(
        "", "Number of turns; positive: to the left, negative: to the right", default=1.0
    )

    def __post_init__(self) -> None:
        """Reject zero turns."""
        if self.turns == 0.0:
            raise BadArgument("turns", "must not be 0")

    @property
    def lengths(self) -> tuple[float, float]:
        """Length at the start and after all turns [m]."""
        return 0.0, 2.0 * math.pi * self.radius * abs(self.turns)

    def init(self) -> None:
        """Return None: the robot has not been seen yet."""

    def locate(
        self, progress: CircleProgress | None, position: Position
    ) -> tuple[CircleProgress, PathFrame]:
        """Locate a `position` [m].

        Args:
            progress: Progress at the last position; None if there is no last position.
            position: Center of mass, in world axes [m].
        """
        side = self._turning_side
        x, y = self.center
        distance = math.hypot(position[0] - x, position[1] - y)
        direction = math.atan2(position[1] - y, position[0] - x)
        if progress is None:
            progress = CircleProgress(direction, 0.0)
        step = side * wrap_to_pi(direction - progress.direction)
        angle_covered = progress.angle_covered + step
        _, length = self.lengths
        frame = _build_frame(
            along=self.radius * angle_covered,
            across=side * (self.radius - distance),
            angle=direction + side * 0.5 * math.pi,
            length=length,
            curvature=side / self.radius,
        )
        return CircleProgress(direction, angle_covered), frame

    @classmethod
    def vectorize(cls, paths: Sequence[Any]) -> VectorPath:
        """Return one object that locates a robot on each of many of these paths.

        Args:
            paths: The paths, one for each robot.
        """
        from laticauda.control.vector_paths import VectorCircles

        return VectorCircles(paths)

    def points(self, along_track_distance: Distances) -> Points:
        """Return the point at each `along_track_distance` [m]; distance 0 is at the circle's right.

        Args:
            along_track_distance: Distances along the circle from its rightmost point [m].
        """
        angle = self._turning_side * along_track_distance / self.radius
        directions = np.stack((np.cos(angle), np.sin(angle)), axis=1)
        return np.array(self.center) + self.radius * directions

    @property
    def _turning_side(self) -> float:
        """1 if the robot turns to the left, -1 if it turns to the right."""
        return math.copysign(1.0, self.turns)


@value_class
class Polyline(Path[int]):
    """Straight legs from waypoint to waypoint, followed one at a time.

    The next leg starts when the robot comes within the acceptance distance of the leg's end or
    passes it, so a robot carried past a waypoint does not turn back. The last leg continues
    straight beyond its end.

    Raises:
        ValueError: If there are fewer than two waypoints or two equal ones in a row, or a number is
            not finite.
    """

    waypoints: Waypoints = quantity("m", "Waypoints in order; x and y in world axes")
    acceptance_distance: float = quantity(
        "m", "Distance that counts as reached; 0: once passed", default=0.0, ge=0.0
    )

    def __post_init__(self) -> None:
        """Check every field once."""
        _check_waypoints(self.waypoints)

    @cached_property
    def lengths(self) -> tuple[float, ...]:
        """Length up to each waypoint [m]."""
        legs = np.diff(np.array(self.waypoints), axis=0)
        leg_lengths = np.linalg.norm(legs, axis=1)
        lengths = np.concatenate(([0.0], np.cumsum(leg_lengths)))
        return tuple(lengths.tolist())

    @property
    def length(self) -> float:
        """Total length of all legs [m]."""
        return self.lengths[-1]

    def init(self) -> int:
        """Return the first leg, 0."""
        return 0

    def locate(self, progress: int, position: Position) -> tuple[int, PathFrame]:
        """Locate a `position` [m] on the current leg, whose index is the `progress`.

        Args:
            progress: Index of the current leg, from 0.
            position: Center of mass, in world axes [m].
        """
        leg = progress
        last_leg = len(self.waypoints) - 2
        while leg < last_leg and self._is_done(leg, position):
            leg += 1
        angle = self.angle(leg)
        along, across = transform_to_axes(self.waypoints[leg], angle, position)
        frame = _build_frame(
            along=along + self.lengths[leg], across=across, angle=angle, length=self.length
        )
        return leg, frame

    @classmethod
    def vectorize(cls, paths: Sequence[Any]) -> VectorPath:
        """Return one object that locates a robot on each of many of these paths.

        Args:
            paths: The paths, one for each robot.
        """
        from laticauda.control.vector_paths import VectorPolylines

        return VectorPolylines(paths)

    def points(self, along_track_distance: Distances) -> Points:
        """Return the point of the legs at each `along_track_distance` [m].

        Args:
            along_track_distance: Distances along the path from its start [m].
        """
        # Before the start the first leg continues, after the end the last one.
        n_passed = np.searchsorted(self.lengths, along_track_distance, side="right")
        leg = np.clip(n_passed - 1, 0, len(self.lengths) - 2)
        corners = np.array(self.waypoints)
        directions = np.diff(corners, axis=0) / np.diff(self.lengths)[:, np.newaxis]
        distance_on_leg = along_track_distance - np.array(self.lengths)[leg]
        return corners[leg] + distance_on_leg[:, np.newaxis] * directions[leg]

    def angle(self, leg: int) -> float:
        """Return the direction of a `leg`, counted from 0, from the world x axis [rad].

        Args:
            leg: Index of the leg, from 0.
        """
        begin_x, begin_y = self.waypoints[leg]
        end_x, end_y = self.waypoints[leg + 1]
        return math.atan2(end_y - begin_y, end_x - begin_x)

    def _is_done(self, leg: int, position: Position) -> bool:
        """Return whether the end of a leg is passed or reached."""
        end = self.waypoints[leg + 1]
        along, across = transform_to_axes(end, self.angle(leg), position)
        if along >= 0.0:
            return True
        return math.hypot(along, across) < self.acceptance_distance


@value_class
class Spline(Path[float | None]):
    """Smooth curve through waypoints, parameterized by its length; see `laticauda.control.curve`.

    The nearest point is first searched along the whole curve and then tracked, so that a curve may
    cross itself. Before its start and after its end the curve continues straight.

    Raises:
        ValueError: If there are fewer than two waypoints or two equal ones in a row, a number is
            not finite, or the curve turns back on the spot.
    """

    waypoints: Waypoints = quantity("m", "Waypoints in order; x and y in world axes")

    def __post_init__(self) -> None:
        """Check every field once."""
        _check_waypoints(self.waypoints)
        _ = self.curve  # reject an impossible curve now

    @cached_property
    def curve(self) -> Curve:
        """The curve through the waypoints."""
        return fit_natural_cubic(np.array(self.waypoints))

    @property
    def length(self) -> float:
        """Length of the whole curve [m]."""
        return float(self.curve.lengths[-1])

    @cached_property
    def lengths(self) -> tuple[float, ...]:
        """Length up to each waypoint [m]."""
        lengths = self.curve.length(self.curve.knots)
        return tuple(lengths.tolist())

    def init(self) -> None:
        """Return None: the first position is searched along the whole curve."""

    def locate(self, progress: float | None, position: Position) -> tuple[float | None, PathFrame]:
        """Locate a `position` [m]; the `progress` is the length up to the last nearest point [m].

        Args:
            progress: Length up to the last nearest point [m]; None if there is none yet.
            position: Center of mass, in world axes [m].
        """
        curve = self.curve
        u = np.array([curve.nearest(position[:2], progress)])
        length = float(curve.length(u)[0])
        points, first_derivatives, second_derivatives = curve.derivatives(u)
        x, y = points[0].tolist()
        first = first_derivatives[0]
        angle = math.atan2(first[1], first[0])
        beyond, across = transform_to_axes((x, y), angle, position)
        along = length
        curvature = _curvature(first, second_derivatives[0])
        is_before_start = length <= 0.0 and beyond < 0.0
        is_after_end = length >= self.length and beyond > 0.0
        # Between the ends, the nearest point is at a right angle to the curve, and any remaining
        # `beyond` is rounding.
        if is_before_start or is_after_end:
            along = length + beyond
            curvature = 0.0
        frame = _build_frame(
            along=along, across=across, angle=angle, length=self.length, curvature=curvature
        )
        return length, frame

    @classmethod
    def vectorize(cls, paths: Sequence[Any]) -> VectorPath:
        """Return one object that locates a robot on each of many of these paths.

        Args:
            paths: The paths, one for each robot.
        """
        from laticauda.control.vector_paths import VectorSplines

        return VectorSplines(paths)

    def points(self, along_track_distance: Distances) -> Points:
        """Return the point of the curve at each `along_track_distance` [m].

        Args:
            along_track_distance: Distances along the path from its start [m].
        """
        inside = np.clip(along_track_distance, 0.0, self.length)
        u = self.curve.parameter(inside)
        points, first, _ = self.curve.derivatives(u)
        directions = first / np.linalg.norm(first, axis=1, keepdims=True)
        beyond = along_track_distance - inside
        return points + beyond[:, np.newaxis] * directions


def _build_frame(
    *, along: float, across: float, angle: float, length: float, curvature: float = 0.0
) -> PathFrame:
    """Return the position relative to a path of this length, whose direction here is `angle`."""
    return PathFrame(
        along_track_distance=along,
        cross_track_error=across,
        path_tangential_angle=wrap_to_pi(angle),
        curvature=curvature,
        remaining=max(length - along, 0.0),
    )


def _unit_vector(angle: float) -> tuple[float, float]:
    return math.cos(angle), math.sin(angle)


def transform_to_axes(
    origin: tuple[float, float], angle: float, position: Position
) -> tuple[float, float]:
    """Transform a position to axes at `origin`, turned by `angle`: along and left [m].

    Args:
        origin: Origin of the axes [m].
        angle: Angle of the first axis from the world x axis [rad].
        position: Position in world axes [m].
    """
    c, s = _unit_vector(angle)
    x = float(position[0]) - origin[0]
    y = float(position[1]) - origin[1]
    return c * x + s * y, c * y - s * x


def _curvature(first: Position, second: Position) -> float:
    """Return the curvature (x' y'' - y' x'') / |r'|^3 [1/m]."""
    cross_product = first[0] * second[1] - first[1] * second[0]
    speed = math.hypot(first[0], first[1])
    return float(cross_product / speed**3)


def _check_waypoints(points: Waypoints) -> None:
    """Reject a single point, and two equal points in a row."""
    if len(points) < 2:
        raise BadArgument("waypoints", f"must hold at least 2 points, got {len(points)}")
    for i in range(1, len(points)):
        if points[i] == points[i - 1]:
            raise BadArgument(
                f"waypoints[{i}]", f"must differ from the point before it, got {points[i]} twice"
            )
