"""Stretches of time in which the motion of a robot is compared with that of its twin, driven by the robot's joints.

A stretch is half a gait cycle. The twin swims all stretches in one run, in still water; each is
then compared separately, with its middle and its mean heading unknown. See
docs/theory/learning-twin.md.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, TypeAlias

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

TICKS, POINTS = (
    72,
    12,
)  # per stretch: times at which motions are compared; parts whose medians are used
MARGIN, KNOT = (
    0.3,
    0.1,
)  # margin of samples around the stretches; knot spacing of the joints' spline [s]
TICK = 0.01  # sampling interval of the twin [s]
POSITION, HEADING = 1e-3, 3e-3  # units of deviations [m, rad]


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
    """Time [s], position of the marker body [m, m] and angle of its link [rad], shape (4, n_frames)."""
    joints: Array
    """Time [s], angles [rad] and torques [N m] of the joints, shape (1 + 2 n_joints, n_samples)."""

    @cached_property
    def ticks(self) -> Array:
        """Times at which motions are compared, shape (n_stretches, TICKS) [s]."""
        return self.bounds[:-1, np.newaxis] + np.diff(self.bounds)[:, np.newaxis] * np.linspace(
            0.0, 1.0, TICKS
        )

    @cached_property
    def from_middle(self) -> Array:
        """Time from the middle of each stretch, shape (n_stretches, TICKS) [s]."""
        return self.ticks - self.ticks.mean(axis=1, keepdims=True)

    @cached_property
    def seen(self) -> Array:
        """Marker body's x and y [m] and the angle of its link [rad], shape (3, n_stretches, TICKS)."""
        time, x, y, yaw = self.poses
        return np.stack(_at(self.ticks, time, (x, y, np.unwrap(yaw))))

    @cached_property
    def _reported(self) -> tuple[Array, Array]:
        """Spline knots [s]; joint angles [rad], then the sides on which gears touch [-], at the knots."""
        time, n = self.joints[0], len(self.joints) // 2
        both = np.concatenate(
            (self.joints[1 : 1 + n], np.tanh(self.joints[1 + n :] / PLAY_TORQUE))
        ).T
        knots = np.arange(self.bounds[0] - MARGIN, self.bounds[-1] + MARGIN, KNOT)
        near = np.searchsorted(time, [knots - 1.5 * KNOT, knots + 1.5 * KNOT]).T.tolist()
        fits: list[Array] = [
            np.polyfit(time[i:j] - knot, both[i:j], 2)[-1]
            for knot, (i, j) in zip(knots, near, strict=True)
        ]
        return knots, np.array(fits).T

    def off(self, plant: Plant[Any], play: float, current: Array) -> tuple[Array, Array]:
        """Return the deviation of the robot from the twin, and the twin's motion: two coordinates and the heading.

        Both are rotated to the robot's heading and relative to the middle of each stretch, in units
        of `POSITION` and `HEADING`; shape (3, n_stretches, TICKS).

        Args:
            plant: The twin, in still water, with prescribed joints.
            play: Backlash between a joint and its sensor [rad].
            current: Velocity of the water, part of the robot's motion but not of the twin's, shape
                (2,) [m/s].
        """
        x, y, yaw = self.seen
        ahead, aside, turned, joints = self._swum(plant, play)
        link, offset = self.mount.on_link(self.robot)
        theta = link_angles(joints, angle=yaw, link=link)
        place = center_of_mass(
            self.robot.planar(), np.stack((x, y), axis=-1), theta, link=link, offset=offset
        )
        place = place - self.from_middle[..., np.newaxis] * current
        towards = heading(theta)
        way = _way(ahead + 1j * aside, turned, towards)
        return _way(place @ np.array([1.0, 1.0j]), towards, towards) - way, way

    def _swum(self, plant: Plant[Any], play: float) -> tuple[Array, Array, Array, Array]:
        """Return the twin's x and y [m], heading and joint angles [rad] at the ticks, for the reported joint motion."""
        x, y, yaw = self.seen
        knots, (angles, sides) = self._reported[0], np.split(self._reported[1], 2)
        angles, begin = angles - 0.5 * play * sides, float(self.bounds[0])
        motion = JointAngles(
            time=tuple((knots - begin).tolist()), angle=tuple(map(tuple, angles.tolist()))
        )
        command = Command(gait=replace(STILL, recorded=motion))
        speed = math.hypot(x[1, 0] - x[0, 0], y[1, 0] - y[0, 0]) / float(self.ticks[1, 0] - begin)
        state = plant.init(Start(heading=float(yaw[0].mean()), velocity=speed), command)
        log = plant.march(state, command, float(self.bounds[-1]) - begin, TICK)[1]
        columns = (*log.center_of_mass.T[:2], log.heading, *log.joint_angle.T)
        ahead, aside, turned, *joints = _at(self.ticks - begin, log.time, columns)
        return ahead, aside, turned, np.stack(joints, axis=-1)

    def compared(self, ways: Sequence[Array], way: Array) -> Array:
        """Return medians over parts of every stretch, so that single wrong frames have no effect.

        Whatever the unknown position and heading of each stretch explain is removed.

        Args:
            ways: Motions as returned by `off`.
            way: Motion of the twin.

        Returns:
            A column for each of the `ways`, then for each change that brings the robot closer to
                the twin: a heading
            1 rad off the measured one, and a current of 1 m/s along x and y; shape (n_stretches, 3
            POINTS, n_ways + 3).
        """
        none, one, ahead = (
            np.zeros_like(self.ticks),
            np.ones_like(self.ticks),
            self.from_middle / POSITION,
        )
        turned = -way[1], way[0]
        rows = _binned([*ways, (*turned, none), (ahead, none, none), (none, ahead, none)])
        base, _ = np.linalg.qr(
            _binned([(one, none, none), (none, one, none), (*turned, one / HEADING)])
        )
        return rows - base @ (base.swapaxes(1, 2) @ rows)


def _at(moments: Array, time: Array, columns: Sequence[Array]) -> list[Array]:
    """Interpolate the columns of a log linearly at some moments."""
    return [np.interp(moments, time, one) for one in columns]


def _way(place: Any, angle: Array, towards: Array) -> Array:
    """Center a complex `place` and an `angle`, rotated so that the mean angle is that of `towards`."""
    turn = np.exp(1j * np.mean(towards - angle, axis=1, keepdims=True))
    way = turn * (place - place.mean(axis=1, keepdims=True))
    return np.stack(
        (
            way.real / POSITION,
            way.imag / POSITION,
            (angle - angle.mean(axis=1, keepdims=True)) / HEADING,
        )
    )


def _binned(ways: Sequence[Any]) -> Array:
    """Return the medians of `POINTS` equal parts of every stretch, a column for each way."""
    parts = np.array(ways)
    middle = np.median(parts.reshape(*parts.shape[:-1], POINTS, -1), axis=-1)
    return np.moveaxis(middle, 2, 0).reshape(parts.shape[2], len(ways), -1).swapaxes(1, 2)
