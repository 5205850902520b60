"""Stretches of time in which a robot's motion is compared with that of its twin.

The twin's joints do what the robot's report. A stretch is half a gait cycle. The twin swims all
stretches in one run, in still water; each is then compared separately, with its middle and its mean
heading unknown. See docs/theory/learning-twin.md.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from laticauda.control.estimation.digital_twin import STILL
from laticauda.control.estimation.filter import PLAY_TORQUE
from laticauda.control.estimation.samples import Mount
from laticauda.models.dynamics import Plant
from laticauda.motion.gaits import JointAngles
from laticauda.robot import Robot, center_of_mass, heading, link_angles
from laticauda.scenarios import Command, Start

Array: TypeAlias = NDArray[np.float64]

TICKS = 72
"""Times per stretch at which motions are compared [-]."""
POINTS = 12
"""Equal parts per stretch, whose medians are used [-]."""
MARGIN = 0.3
"""Margin of samples around the stretches [s]."""
KNOT = 0.1
"""Spacing of the knots of the joints' spline [s]."""
TICK = 0.01
"""Sampling interval of the twin [s]."""
POSITION = 1e-3
"""Unit of deviations of a position [m]."""
HEADING = 3e-3
"""Unit of deviations of a heading [rad]."""


class JointReports(NamedTuple):
    """What the joints report, at the knots of a spline."""

    knots: Array
    """Times [s]."""
    angles: Array
    """Angles of the sensors, shape (n_joints, n_knots) [rad]."""
    sides: Array
    """Sides on which gears touch, -1 to 1, shape (n_joints, n_knots) [-]."""


class TwinRun(NamedTuple):
    """Motion of the twin at the ticks of all stretches, each of shape (n_stretches, TICKS)."""

    x: Array
    """First coordinate of the center of mass [m]."""
    y: Array
    """Second coordinate of the center of mass [m]."""
    heading: Array
    """Heading (6) [rad]."""
    joint_angle: Array
    """Joint angles, with the joints along a third axis [rad]."""


class TwinComparison(NamedTuple):
    """A robot beside its twin: two coordinates and the heading, shape (3, n_stretches, TICKS).

    Both are rotated to the robot's heading and relative to the middle of each stretch, in units of
    `POSITION` and `HEADING`.
    """

    deviation: Array
    """Motion of the robot minus that of the twin."""
    twin_motion: Array
    """Motion of the twin."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Stretches:
    """Measurements over consecutive stretches of time."""

    robot: Robot
    """Robot as built; its planar reduction is used."""
    mount: Mount
    """Mount of the marker body."""
    bounds: Array
    """Start of each stretch, and the end of the last one, shape (n_stretches + 1,) [s]."""
    poses: Array
    """Time [s], x, y of the marker body [m] and angle of its link [rad], shape (4, n_frames)."""
    joints: Array
    """Time [s], angles [rad] and torques [N m] of the joints, shape (1 + 2 n_joints, n_samples)."""

    @cached_property
    def ticks(self) -> Array:
        """Times at which motions are compared, shape (n_stretches, TICKS) [s]."""
        starts = self.bounds[:-1, np.newaxis]
        durations = np.diff(self.bounds)[:, np.newaxis]
        return starts + durations * np.linspace(0.0, 1.0, TICKS)

    @cached_property
    def from_middle(self) -> Array:
        """Time from the middle of each stretch, shape (n_stretches, TICKS) [s]."""
        return self.ticks - self.ticks.mean(axis=1, keepdims=True)

    @cached_property
    def marker(self) -> Array:
        """Marker body's x, y [m] and the angle of its link [rad], shape (3, n_stretches, TICKS)."""
        time, x, y, yaw = self.poses
        return np.stack(_resample(self.ticks, time, (x, y, np.unwrap(yaw))))

    @cached_property
    def _joint_reports(self) -> JointReports:
        """Joint reports at knots, each from a parabola fitted to the samples around it."""
        time = self.joints[0]
        n_joints = len(self.joints) // 2
        angles = self.joints[1 : 1 + n_joints]
        torques = self.joints[1 + n_joints :]
        columns = np.concatenate((angles, np.tanh(torques / PLAY_TORQUE))).T
        knots = np.arange(self.bounds[0] - MARGIN, self.bounds[-1] + MARGIN, KNOT)
        begins = np.searchsorted(time, knots - 1.5 * KNOT).tolist()
        ends = np.searchsorted(time, knots + 1.5 * KNOT).tolist()
        # The lowest coefficient of a parabola around a knot is its value there.
        values_at_knots: list[Array] = [
            np.polyfit(time[begin:end] - knot, columns[begin:end], 2)[-1]
            for knot, begin, end in zip(knots, begins, ends, strict=True)
        ]
        angles_at_knots, sides_at_knots = np.split(np.array(values_at_knots).T, 2)
        return JointReports(knots, angles_at_knots, sides_at_knots)

    def compare_with_twin(self, plant: Plant[Any], play: float, current: Array) -> TwinComparison:
        """Return the deviation of the robot from the twin, and the twin's motion.

        Args:
            plant: The twin, in still water, with prescribed joints.
            play: Backlash between a joint and its sensor [rad].
            current: Velocity of the water, part of the robot's motion but not of the twin's, shape
                (2,) [m/s].
        """
        x, y, yaw = self.marker
        twin = self._swim_twin(plant, play)
        link, offset = self.mount.on_link(self.robot)
        theta = link_angles(twin.joint_angle, angle=yaw, link=link)
        position = center_of_mass(
            self.robot.planar(), np.stack((x, y), axis=-1), theta, link=link, offset=offset
        )
        position = position - self.from_middle[..., np.newaxis] * current
        robot_heading = heading(theta)
        twin_motion = _center_motion(twin.x + 1j * twin.y, twin.heading, robot_heading)
        complex_position = position @ np.array([1.0, 1.0j])
        robot_motion = _center_motion(complex_position, robot_heading, robot_heading)
        return TwinComparison(robot_motion - twin_motion, twin_motion)

    def _swim_twin(self, plant: Plant[Any], play: float) -> TwinRun:
        """Return the motion of a twin whose joints do what the robot's report."""
        reports = self._joint_reports
        angles = reports.angles - 0.5 * play * reports.sides
        begin = float(self.bounds[0])
        motion = JointAngles(
            time=tuple((reports.knots - begin).tolist()),
            angle=tuple(map(tuple, angles.tolist())),
        )
        command = Command(gait=replace(STILL, recorded=motion))
        state = plant.init(self._twin_start(), command)
        _, log, *_ = plant.march(state, command, float(self.bounds[-1]) - begin, TICK)
        columns = (*log.center_of_mass.T[:2], log.heading, *log.joint_angle.T)
        x, y, twin_heading, *joints = _resample(self.ticks - begin, log.time, columns)
        return TwinRun(x, y, twin_heading, np.stack(joints, axis=-1))

    def _twin_start(self) -> Start:
        """Return the start of the twin: with about the speed and direction of the robot."""
        x, y, yaw = self.marker
        distance = math.hypot(x[1, 0] - x[0, 0], y[1, 0] - y[0, 0])
        duration = float(self.ticks[1, 0] - float(self.bounds[0]))
        return Start(heading=float(yaw[0].mean()), velocity=distance / duration)

    def reduce_to_medians(self, motions: Sequence[Array], twin_motion: Array) -> Array:
        """Return medians over parts of every stretch, so that single wrong frames have no effect.

        Whatever the unknown position and heading of each stretch explain is removed.

        Args:
            motions: Motions or deviations as returned by `compare_with_twin`.
            twin_motion: Motion of the twin.

        Returns:
            A column for each of the `motions`, then for each change that brings the robot closer to
            the twin: a heading 1 rad off the measured one, and a current of 1 m/s along x and y;
            shape (n_stretches, 3 POINTS, n_motions + 3).
        """
        zeros = np.zeros_like(self.ticks)
        ones = np.ones_like(self.ticks)
        drifted = self.from_middle / POSITION
        per_heading = (-twin_motion[1], twin_motion[0])
        off_heading = (*per_heading, zeros)
        drifted_along_x = (drifted, zeros, zeros)
        drifted_along_y = (zeros, drifted, zeros)
        columns = _medians_of_parts([*motions, off_heading, drifted_along_x, drifted_along_y])
        shifted_along_x = (ones, zeros, zeros)
        shifted_along_y = (zeros, ones, zeros)
        turned = (*per_heading, ones / HEADING)
        unknown = _medians_of_parts([shifted_along_x, shifted_along_y, turned])
        basis, _ = np.linalg.qr(unknown)
        return columns - basis @ (basis.swapaxes(1, 2) @ columns)


def _resample(moments: Array, time: Array, columns: Sequence[Array]) -> list[Array]:
    """Interpolate the columns of a log linearly at some moments."""
    return [np.interp(moments, time, column) for column in columns]


def _center_motion(position: Any, angle: Array, toward: Array) -> Array:
    """Return a motion relative to its middle, rotated so that the mean angle is that of `toward`.

    `position` is complex; the result has the units `POSITION` and `HEADING`.
    """
    rotation = np.exp(1j * np.mean(toward - angle, axis=1, keepdims=True))
    centered = rotation * (position - position.mean(axis=1, keepdims=True))
    centered_angle = angle - angle.mean(axis=1, keepdims=True)
    return np.stack((centered.real / POSITION, centered.imag / POSITION, centered_angle / HEADING))


def _medians_of_parts(motions: Sequence[Any]) -> Array:
    """Return the medians of `POINTS` equal parts of every stretch, a column for each motion."""
    stacked = np.array(motions)
    n_motions, n_coordinates, n_stretches, _ = stacked.shape
    parts = stacked.reshape(n_motions, n_coordinates, n_stretches, POINTS, -1)
    medians = np.median(parts, axis=-1)
    by_stretch = np.moveaxis(medians, 2, 0).reshape(n_stretches, n_motions, -1)
    return by_stretch.swapaxes(1, 2)
