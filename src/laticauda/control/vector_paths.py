"""Paths of many robots at once: each kind of `laticauda.control.paths`, written for arrays.

Every formula is that of the path for one robot, in the same order; only where a curve is searched for
its nearest point may results differ by rounding.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.control.curve import nearest_of_many
from laticauda.control.frames import Path, PathFrames, VectorPath
from laticauda.control.paths import Circle, Polyline, Spline, StraightLine
from laticauda.control.vector_guidance import apply
from laticauda.scenarios import vectorize_alike
from laticauda.values import wrap_to_pi

Numbers = Float[np.ndarray, " n"]
Positions = Float[np.ndarray, "n n_axes"]


class _Axes:
    """Axes of many robots, each with an origin and turned by an angle.

    Args:
        origins: Origin of each robot's axes [m].
        angles: Angle of the first axis from the world x axis [rad].
    """

    def __init__(
        self, origins: Float[np.ndarray, "... 2"], angles: Float[np.ndarray, "..."]
    ) -> None:
        self.x = origins[..., 0]
        self.y = origins[..., 1]
        self.angle = angles
        flat_angles = angles.ravel()
        self.cos = apply(math.cos, flat_angles).reshape(angles.shape)
        self.sin = apply(math.sin, flat_angles).reshape(angles.shape)

    def transform(self, position: Positions, place: Any = ...) -> tuple[Numbers, Numbers]:
        """Return the positions along the axes and to the left of them [m].

        Args:
            position: Positions of the robots in world axes [m].
            place: Index of the axes to which each is transformed.
        """
        x = position[:, 0] - self.x[place]
        y = position[:, 1] - self.y[place]
        c = self.cos[place]
        s = self.sin[place]
        return c * x + s * y, c * y - s * x


def _build_frames(
    *, along: Numbers, across: Numbers, angle: Numbers, length: Numbers, curvature: Numbers
) -> PathFrames:
    """Return positions relative to paths of these lengths, whose directions here are `angle`."""
    return PathFrames(
        along_track_distance=along,
        cross_track_error=across,
        path_tangential_angle=wrap_to_pi(angle),
        curvature=curvature,
        remaining=np.maximum(length - along, 0.0),
    )


class VectorLines(VectorPath):
    """Straight lines, one for each robot.

    Args:
        lines: The lines.
    """

    def __init__(self, lines: Sequence[StraightLine]) -> None:
        self._axes = _Axes(
            np.array([line.point for line in lines], dtype=float),
            np.array([line.angle for line in lines], dtype=float),
        )
        self._curvature = np.zeros(len(lines))
        self._length = np.full(len(lines), math.inf)

    def locate(self, position: Positions) -> PathFrames:
        """Locate every robot relative to its line.

        Args:
            position: Centers of mass, in world axes [m].
        """
        along, across = self._axes.transform(position)
        return _build_frames(
            along=along,
            across=across,
            angle=self._axes.angle,
            length=self._length,
            curvature=self._curvature,
        )


class VectorCircles(VectorPath):
    """Circles, one for each robot.

    Args:
        circles: The circles.
    """

    def __init__(self, circles: Sequence[Circle]) -> None:
        self._x, self._y = np.array([circle.center for circle in circles], dtype=float).T
        self._radius = np.array([circle.radius for circle in circles], dtype=float)
        sides = [math.copysign(1.0, circle.turns) for circle in circles]
        lengths = [circle.lengths[-1] for circle in circles]
        self._side = np.array(sides)
        self._length = np.array(lengths)
        self._direction: np.ndarray | None = None
        """Direction from the center to the last position; None: the robots are not yet seen [rad]."""
        self._angle_covered = np.zeros(len(circles))
        """Angle covered so far, positive in the direction in which the circle is followed [rad]."""

    def locate(self, position: Positions) -> PathFrames:
        """Locate every robot relative to its circle.

        Args:
            position: Centers of mass, in world axes [m].
        """
        x = position[:, 0] - self._x
        y = position[:, 1] - self._y
        direction = apply(math.atan2, y, x)
        if self._direction is not None:
            step = self._side * wrap_to_pi(direction - self._direction)
            self._angle_covered = self._angle_covered + step
        self._direction = direction
        return _build_frames(
            along=self._radius * self._angle_covered,
            across=self._side * (self._radius - apply(math.hypot, x, y)),
            angle=direction + self._side * 0.5 * math.pi,
            length=self._length,
            curvature=self._side / self._radius,
        )


class VectorPolylines(VectorPath):
    """Legs between waypoints, for each robot.

    Args:
        polylines: The legs of each robot.
    """

    def __init__(self, polylines: Sequence[Polyline]) -> None:
        n = len(polylines)
        self._robots = np.arange(n)
        self._leg = np.zeros(n, dtype=int)
        last_legs = [len(polyline.waypoints) - 2 for polyline in polylines]
        acceptance_distances = [polyline.acceptance_distance for polyline in polylines]
        lengths = [polyline.length for polyline in polylines]
        self._last_leg = np.array(last_legs)
        self._acceptance_distance = np.array(acceptance_distances)
        self._length = np.array(lengths)
        self._curvature = np.zeros(n)
        most_legs = int(self._last_leg.max()) + 1
        begins = np.zeros((n, most_legs, 2))
        ends = np.zeros((n, most_legs, 2))
        angles = np.zeros((n, most_legs))
        self._length_before = np.zeros((n, most_legs))
        for i, polyline in enumerate(polylines):
            waypoints = np.array(polyline.waypoints)
            n_legs = len(waypoints) - 1
            begins[i, :n_legs] = waypoints[:-1]
            ends[i, :n_legs] = waypoints[1:]
            angles[i, :n_legs] = list(map(polyline.angle, range(n_legs)))
            self._length_before[i, :n_legs] = polyline.lengths[:-1]
        self._axes_at_begin = _Axes(begins, angles)
        self._axes_at_end = _Axes(ends, angles)

    def locate(self, position: Positions) -> PathFrames:
        """Locate every robot on its current leg.

        Args:
            position: Centers of mass, in world axes [m].
        """
        goes_on = self._leg < self._last_leg
        while goes_on.any():
            goes_on = goes_on & self._is_done(position)
            self._leg = self._leg + goes_on
            goes_on = goes_on & (self._leg < self._last_leg)
        leg = self._robots, self._leg
        along, across = self._axes_at_begin.transform(position, leg)
        return _build_frames(
            along=along + self._length_before[leg],
            across=across,
            angle=self._axes_at_begin.angle[leg],
            length=self._length,
            curvature=self._curvature,
        )

    def _is_done(self, position: Positions) -> np.ndarray:
        """Return whether the end of each robot's leg is passed or reached."""
        along, across = self._axes_at_end.transform(position, (self._robots, self._leg))
        distance = apply(math.hypot, along, across)
        is_near = distance < self._acceptance_distance
        return (along >= 0.0) | is_near


class VectorSplines(VectorPath):
    """Smooth curves, one for each robot; robots on the same curve are located together.

    Args:
        splines: The curves.
    """

    def __init__(self, splines: Sequence[Spline]) -> None:
        robots_on: dict[Spline, list[int]] = {}
        for i, spline in enumerate(splines):
            robots_on.setdefault(spline, []).append(i)
        self._robots_on = {spline: np.array(robots) for spline, robots in robots_on.items()}
        self._progress: np.ndarray | None = None
        """Length up to the last nearest point; None: the robots are not yet seen [m]."""

    def locate(self, position: Positions) -> PathFrames:
        """Locate every robot relative to its curve.

        Args:
            position: Centers of mass, in world axes [m].
        """
        frames = PathFrames(*np.empty((len(PathFrames._fields), len(position))))
        progress = np.empty(len(position))
        for spline, robots in self._robots_on.items():
            near = None
            if self._progress is not None:
                near = self._progress[robots]
            part, progress[robots] = _locate_on_curve(spline, position[robots], near)
            for values, values_of_part in zip(frames, part, strict=True):
                values[robots] = values_of_part
        self._progress = progress
        return frames


def _locate_on_curve(
    spline: Spline, position: Positions, near: Numbers | None
) -> tuple[PathFrames, Numbers]:
    """Return the positions relative to one curve, and the lengths up to the nearest points [m]."""
    curve = spline.curve
    u = nearest_of_many(curve, position[:, :2], near)
    length = curve.length(u)
    points, first, second = curve.derivatives(u)
    first_x, first_y = first.T
    angle = apply(math.atan2, first_y, first_x)
    beyond, across = _Axes(points, angle).transform(position)
    second_x, second_y = second.T
    speed = apply(math.hypot, first_x, first_y)
    cross_product = first_x * second_y - first_y * second_x
    curvature = cross_product / speed**3
    is_before_start = (length <= 0.0) & (beyond < 0.0)
    is_after_end = (length >= spline.length) & (beyond > 0.0)
    is_outside = is_before_start | is_after_end
    frames = _build_frames(
        along=np.where(is_outside, length + beyond, length),
        across=across,
        angle=angle,
        length=np.full(length.size, spline.length),
        curvature=np.where(is_outside, 0.0, curvature),
    )
    return frames, length


class PathsOneByOne(VectorPath):
    """Paths that are written for one robot, asked one after the other.

    Args:
        paths: One for each robot.
    """

    def __init__(self, paths: Sequence[Path[Any]]) -> None:
        self._paths = paths
        self._progress = [path.init() for path in paths]

    def locate(self, position: Positions) -> PathFrames:
        """Locate every robot relative to its path.

        Args:
            position: Centers of mass, in world axes [m].
        """
        frames = PathFrames(*np.empty((len(PathFrames._fields), len(position))))
        for i, path in enumerate(self._paths):
            self._progress[i], frame = path.locate(self._progress[i], position[i])
            for values, value in zip(frames, frame, strict=True):
                values[i] = value
        return frames


def vectorize_paths(paths: Sequence[Path[Any]]) -> VectorPath:
    """Return one object that locates a robot on each of many paths of one class.

    Args:
        paths: One for each robot.
    """
    vector_path = vectorize_alike(paths, "init", "locate")
    if vector_path is None:
        return PathsOneByOne(paths)
    return vector_path
