"""A twin that learns while the robot swims: the water's coefficients, its current, and what has changed.

A twin in still water, whose joints do what the robot's report, swims the last minute anew every half cycle; beside it
one for each unknown coefficient, which is a little larger there. How far the robot's ways are off the twin's is nearly
linear in what is unknown: least squares do the rest. See docs/theory/learning-twin.md.

This belongs into `laticauda.estimation` and, for every recording, beside `operate`; until there is room for it, it
stands here.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from laticauda import gaits
from laticauda.actuation.laws import Prescribed
from laticauda.dynamics.plant import Plant
from laticauda.errors import BadArgument
from laticauda.estimation.digital_twin import check_plant
from laticauda.estimation.samples import JointSample, Mount, PoseSample, Sample
from laticauda.gaits import JointAngles
from laticauda.interfaces import Command, Start
from laticauda.kinematics import center_of_mass, heading, link_angles
from laticauda.quantities import option, quantity, value
from laticauda.robot import Robot, Water

Array = NDArray[Any]
LARGER = 0.02  # by which an unknown is larger in its own twin, as a share
TICKS, POINTS = 72, 12  # of a stretch, half a cycle: at which ways are compared; medians of so many parts count
MARGIN, GAP, KNOT = 0.3, 0.2, 0.1  # of samples around a stretch; in them at most; of the joints' spline [s]
UNTOLD, LEAST = 2, 6  # stretches that a twin needs to swim as the robot does; beyond them, to say anything
TICK, POSITION, HEADING = 0.01, 1e-3, 3e-3  # between samples of a twin [s]; scales of deviations [m, rad]
MEDIAN = 0.455  # of the square of a normal number
PLAY, PLAY_TORQUE = 0.01, 0.3  # usual [rad], and what has a gear touch on one side [N m]
CRAB = 0.005  # by which the robot points elsewhere than is seen: joints' zeros, markers [rad]
FLOOR, FLOOR_CURRENT = 0.02, 1.2e-3  # what repeats in every cycle and no fit sees: of coefficients, current [m/s]
STILL = 0.02  # swing of a joint that is not asked to move [rad]


@value
class Learner:
    """What is learnt, from what, and how sure that can become."""

    unknown: tuple[str, ...] = option("coefficients of the water", default=("normal_drag", "tangential_friction"))
    coefficient: float = quantity("", "how far they may be off in the beginning, as a share", gt=0.0, default=0.3)
    current: float = quantity("m/s", "how fast the water may move", gt=0.0, default=0.05)
    window: float = quantity("s", "how long anything is remembered", gt=5.0, default=60.0)
    doubt: float = quantity("", "standard deviations beyond which the water has changed", gt=0.0, default=10.0)
    stuck: float = quantity("", "share of its usual swing below which a joint is stuck", gt=0.0, default=0.3)
    weak: float = quantity("", "below which it is weak", gt=0.0, default=0.88)


@dataclass(frozen=True, kw_only=True)
class Learned:
    """What is known at one moment."""

    time: float
    """The end of the last stretch [s]."""
    known: Mapping[str, tuple[float, float]]
    """Every coefficient, then `current_x` and `current_y` [m/s]: value and standard deviation."""
    changes: tuple[str, ...] = ()
    """What has just been found to have happened, in words."""


class Learning:
    """A learner at work; samples come in the order of their times.

    Args:
        settings: Of the learner.
        robot: As it is built, whose joints the samples have.
        plant: The robot as it is thought to be, in water of which the unknown coefficients are a guess.
        mount: Where the marker body sits.

    Raises:
        ValueError: If the plant cannot be a twin, or its environment has no such coefficient.
    """

    def __init__(self, settings: Learner, robot: Robot, plant: Plant[Any], mount: Mount | None = None) -> None:
        check_plant(plant, robot)
        water = plant.environment
        if not isinstance(water, Water):
            raise BadArgument("plant", f"must be in water for anything to be learnt, got the ground `{water.name}`")
        for name in settings.unknown:
            if not isinstance(getattr(water, name, None), float) or getattr(water, name) <= 0.0:
                raise BadArgument("unknown", f"must name coefficients of the water above 0, got {name!r}")
        model = replace(plant.settings, joints=Prescribed(), dt=None)
        self.settings, self.robot, self.mount = settings, robot, mount or Mount()
        self.plant: Plant[Any] = replace(plant, environment=water.still, settings=model)
        self._opening = np.array(
            [settings.coefficient] * len(settings.unknown) + [1.0, 1.0, settings.current, settings.current]
        )
        self._guess = self._mean = np.zeros(self._opening.size)
        self._deviation = self._opening
        self._floor = np.array([FLOOR] * len(settings.unknown) + [0.05, 1.0, FLOOR_CURRENT, FLOOR_CURRENT])
        self._bounds, self._swings, self._named = list[float](), list[Array](), set[tuple[int, str]]()
        self._poses, self._joints, self._sent = (list[tuple[float, ...]]() for _ in range(3))
        self._doubts, self._weak = 0, 0

    @property
    def known(self) -> dict[str, tuple[float, float]]:
        """Coefficients, the joints' `play` and the `crab` angle [rad], the current [m/s]: value, standard deviation."""
        value = [getattr(self._water(self._mean), name) for name in self.settings.unknown]
        scale = np.array([*value, PLAY, CRAB, 1.0, 1.0])
        found = zip([*value, *(scale * self._mean)[-4:].tolist()], (scale * self._deviation).tolist(), strict=True)
        return dict(zip((*self.settings.unknown, "play", "crab", "current_x", "current_y"), found, strict=True))

    def step(self, sample: Sample) -> Learned | None:
        """Take in one more `sample`; what is known anew, at the end of a stretch."""
        if isinstance(sample, PoseSample):
            if not sample.is_lost and sample.rotation is not None:
                x, y = sample.position[:2].tolist()
                self._poses.append((sample.time, x, y, self.mount.link_yaw(sample.rotation)))
        elif isinstance(sample, JointSample):
            angle = self.robot.yaw_joints("angle", sample.angle)
            if np.isfinite(angle).all():
                torque = angle * 0.0 if sample.torque is None else self.robot.yaw_joints("torque", sample.torque)
                self._joints.append((sample.time, *angle.tolist(), *np.nan_to_num(torque).tolist()))
        else:
            self._sent.append((sample.time, *self.robot.yaw_joints("angle", sample.angle).tolist()))
            half = math.pi / sample.frequency if sample.frequency else math.inf
            if math.isinf(half):
                self._forget(math.inf)
            elif not self._bounds:
                self._bounds = [sample.time + MARGIN]
            elif sample.time > self._bounds[-1] + half + MARGIN:
                self._bounds.append(self._bounds[-1] + half)
                return self._learn()
        return None

    def _forget(self, before: float) -> None:
        """Everything from before a time."""
        self._bounds = [one for one in self._bounds if one >= before]
        for kept in (self._poses, self._joints, self._sent):
            kept[:] = [one for one in kept if one[0] >= before - 2.0 * MARGIN]

    def _learn(self) -> Learned | None:
        """What the last stretches say."""
        self._forget(self._bounds[-1] - self.settings.window)
        poses, joints, sent = (np.array(one).T for one in (self._poses, self._joints, self._sent))
        if not all(_covers(one, self._bounds[-2] - MARGIN, self._bounds[-1] + MARGIN) for one in (poses, joints)):
            return self._forget(math.inf)
        changes = self._of_joints(joints, sent)
        if len(self._bounds) > UNTOLD + LEAST:
            changes += self._fitted(poses, joints)
        return Learned(time=self._bounds[-1], known=self.known, changes=changes)

    def _fitted(self, poses: Array, joints: Array) -> tuple[str, ...]:
        """Two steps of Gauss and Newton, with the first guess as a prior; what the last cycle does not fit into."""
        prior = self._opening**-2.0
        for is_first in (True, False):
            off, design = self._compared(poses, joints)
            pull = np.einsum("kij,ki->kj", design, off)
            if is_first and (changes := self._surprised(off, design, poses, joints)):
                return changes
            size = float(np.median(off * off)) / MEDIAN
            told = np.einsum("kij,kil->jl", design, design) / size + np.diag(prior)
            step = np.linalg.solve(told, pull.sum(axis=0) / size - prior * (self._mean - self._guess))
            self._mean = self._mean + step
        cycles = _cycles(np.einsum("kij,ki->kj", design, off - design @ step) / size)
        spread = cycles.T @ cycles * len(cycles) / max(len(cycles) - len(step), 1) + np.diag(prior)
        back = np.linalg.inv(told)
        self._deviation = np.sqrt(np.diag(back @ spread @ back) + self._floor**2)
        return ()

    def _surprised(self, off: Array, design: Array, poses: Array, joints: Array) -> tuple[str, ...]:
        """What has happened, if the last cycle is not like those before it; then they are forgotten."""
        changes = self._without_fin(off, poses, joints)
        *before, last = _cycles(np.einsum("kij,ki->kj", design, off))
        if len(before) >= LEAST and not changes:
            size = float(np.median(off * off)) / MEDIAN
            noise = 2.0 * size * np.einsum("kij,kil->jl", design, design) / len(off)
            noise += size**2 * np.diag(self._opening**-2.0)
            usual = (np.einsum("ki,kj->ij", before, before) + LEAST * noise) / (len(before) + LEAST)
            is_odd = float(last @ np.linalg.solve(usual, last)) > self.settings.doubt**2
            self._doubts = self._doubts + 1 if is_odd else 0
            changes = ("The water is not what it was.",) if self._doubts == 2 else ()
        if changes:
            self.plant, self._doubts = replace(self.plant, environment=self._water(self._mean)), 0
            self._mean = np.concatenate((0.0 * self._mean[:-4], self._mean[-4:]))
            self._guess = 0.0 * self._mean
            self._forget(self._bounds[-3])
        return changes

    def _without_fin(self, off: Array, poses: Array, joints: Array) -> tuple[str, ...]:
        """Whether the last cycle is rather that of the robot without its fin, which the twin loses, too, then."""
        with_fin = self.plant
        if with_fin.robot.caudal_fin is None:
            return ()
        self.plant = replace(with_fin, robot=replace(with_fin.robot, caudal_fin=None))
        if np.sum(self._compared(poses, joints)[0][-2:] ** 2) < 0.5 * np.sum(off[-2:] ** 2):
            return ("The fin is gone.",)
        self.plant = with_fin
        return ()

    def _compared(self, poses: Array, joints: Array) -> tuple[Array, Array]:
        """How far the robot is off the twin in every stretch, and how much nearer each unknown brings them.

        Shares of the noise; where the robot is and which way it points count as unknown in every stretch.
        """
        bounds, n = np.array(self._bounds), self._mean.size
        ticks = bounds[:-1, np.newaxis] + np.diff(bounds)[:, np.newaxis] * np.linspace(0.0, 1.0, TICKS)
        seen = np.stack([np.interp(ticks, poses[0], one) for one in (*poses[1:3], np.unwrap(poses[3]))])
        off, twin = self._off(self._mean, ticks, seen, joints)
        nearer = [
            (off - self._off(self._mean + LARGER * one, ticks, seen, joints)[0]) / LARGER for one in np.eye(n)[:-3]
        ]
        still, one = np.zeros_like(ticks), np.ones_like(ticks)
        nearer.append(CRAB * np.stack((-twin[1], twin[0], still)))
        ahead = (ticks - ticks.mean(axis=1, keepdims=True)) / POSITION
        nearer += [np.stack((ahead, still, still)), np.stack((still, ahead, still))]
        free = [(one, still, still), (still, one, still), (-twin[1], twin[0], one / HEADING)]
        base, _ = np.linalg.qr(_binned(free))
        rows = _binned([off, *nearer])
        rows = (rows - base @ (base.swapaxes(1, 2) @ rows))[UNTOLD:]
        return rows[..., 0], rows[..., 1:]

    def _off(self, mean: Array, ticks: Array, seen: Array, joints: Array) -> tuple[Array, Array]:
        """How far the robot is off the twin, if the unknown is so; and where the twin is."""
        begin, n = float(ticks[0, 0]), self.robot.planar().n_joints
        pull = np.tanh(joints[1 + n :] / PLAY_TORQUE)
        command = _reported(joints[0], joints[1 : 1 + n] - 0.5 * mean[-4] * PLAY * pull, ticks)
        x, y, yaw = seen
        speed = math.hypot(x[1, 0] - x[0, 0], y[1, 0] - y[0, 0]) / float(ticks[1, 0] - begin)
        plant = replace(self.plant, environment=self._water(mean))
        state = plant.init(Start(heading=float(yaw[0].mean()), velocity=speed), command)
        log = plant.march(state, command, float(ticks[-1, -1]) - begin, TICK)[1]
        angle = np.stack([np.interp(ticks - begin, log.time, one) for one in log.joint_angle.T], axis=-1)
        link, offset = self.mount.on_link(self.robot)
        theta = link_angles(angle, angle=yaw, link=link)
        place = center_of_mass(self.robot.planar(), np.stack((x, y), axis=-1), theta, link=link, offset=offset)
        place = place - (ticks - ticks.mean(axis=1, keepdims=True))[..., np.newaxis] * mean[-2:]
        ahead, aside, angle = (
            np.interp(ticks - begin, log.time, one) for one in (*log.center_of_mass.T[:2], log.heading)
        )
        towards = heading(theta)
        twin = _way(ahead + 1j * aside, angle, towards)
        return _way(place @ np.array([1.0, 1.0j]), towards, towards) - twin, twin

    def _water(self, mean: Array) -> Water:
        """The water, if the unknown is so."""
        logs = zip(self.settings.unknown, mean.tolist(), strict=False)
        water = self.plant.environment
        return replace(water, **{name: getattr(water, name) * math.exp(one) for name, one in logs})

    def _of_joints(self, joints: Array, sent: Array) -> tuple[str, ...]:
        """Joints that swing less over the last cycle than they did, as shares of what they are asked for."""
        bounds = self._bounds[-3:]
        if len(bounds) < 3:
            return ()
        swing, asked = (
            one[1 : len(sent), (one[0] > bounds[0]) & (one[0] <= bounds[-1])].std(axis=1) for one in (joints, sent)
        )
        if asked.min() < STILL:
            return ()
        self._swings.append(swing / asked)
        share = self._swings[-1] / np.median(self._swings[:-2] or self._swings, axis=0)
        worst = int(share.argmin())
        self._weak = self._weak + 1 if share[worst] < self.settings.weak else 0
        word = "is stuck" if share[worst] < self.settings.stuck else "is weak" if self._weak == 3 else ""
        if not word or (worst, word) in self._named or (word == "is weak" and self._named):
            return ()
        self._named |= {(worst, word)}
        return (f"Joint {worst + 1} {word}: it swings {100.0 * share[worst]:.0f} % of what it did.",)


def _covers(samples: Array, begin: float, end: float) -> bool:
    """Whether samples reach from one time to another, without a gap that would matter."""
    time = samples[0] if samples.size else np.array([math.inf])
    gap = np.diff(time[(time > begin - GAP) & (time < end + GAP)]).max(initial=0.0)
    return bool(time[0] <= begin + GAP and time[-1] >= end - GAP and gap < GAP)


def _reported(time: Array, joints: Array, ticks: Array) -> Command:
    """The joints' motion as a spline through their means over some time."""
    knots = np.arange(ticks[0, 0] - MARGIN, ticks[-1, -1] + MARGIN, KNOT)
    at = np.searchsorted(time, [knots - 1.5 * KNOT, knots + 1.5 * KNOT]).T.tolist()
    angle = [np.polyfit(time[i:j] - knot, joints[:, i:j].T, 2)[-1] for knot, (i, j) in zip(knots, at, strict=True)]
    recorded = JointAngles(
        time=tuple((knots - ticks[0, 0]).tolist()), angle=tuple(map(tuple, np.array(angle).T.tolist()))
    )
    return Command(gait=gaits.Gait(amplitude=0.0, frequency=0.0, phase_shift=0.0, recorded=recorded))


def _way(place: Array, angle: Array, towards: Array) -> Array:
    """Two coordinates and the heading over every stretch, from their middle, turned as the robot is: by the noise."""
    turn = np.exp(1j * np.mean(towards - angle, axis=1, keepdims=True))
    way = turn * (place - place.mean(axis=1, keepdims=True))
    return np.stack((way.real / POSITION, way.imag / POSITION, (angle - angle.mean(axis=1, keepdims=True)) / HEADING))


def _binned(ways: Sequence[Any]) -> Array:
    """Medians of equal parts of every stretch, a column for each of some ways: single wrong frames do not count."""
    parts = np.stack([np.stack(way) for way in ways])
    middle = np.median(parts.reshape(*parts.shape[:-1], POINTS, -1), axis=-1)
    return np.moveaxis(middle, 2, 0).reshape(parts.shape[2], len(ways), -1).swapaxes(1, 2)


def _cycles(pull: Array) -> Array:
    """Sums over pairs of stretches, the last one with the one before it."""
    return pull[len(pull) % 2 :].reshape(-1, 2, pull.shape[1]).sum(axis=1)
