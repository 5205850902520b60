"""Can this robot do it? What a run takes of joints and actuators beside what they have, and whether links overlap.

An actuator at the rate phi' has the torque of its torque-speed line, u_stall (1 - phi'/phi'_0) less its own friction,
in the direction of u. That is its `servo` law read backwards: it can as long as its duty stays between -1 and 1,

    d = (u + b phi' + u_c tanh(phi'/eps)) / u_stall + phi'/phi'_0

and where it brakes, phi' < 0 in that formula, it has more than at standstill. Links are rectangles of their length and
width. Neighbors fold over each other where the inner edges of their bend meet beyond the middle of one; links further
apart overlap where their rectangles do, which is looked for in the plane of the yaw joints, as long as no other joint
bends.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from laticauda.actuation.laws import SLIDING_RATE
from laticauda.robot import Actuator, Robot
from laticauda.series import Log

Joints = Float[np.ndarray, "n_samples n_joints n_runs"]
Shares = Float[np.ndarray, "3 n_samples n_joints n_runs"]

NEEDS = {
    "peak_joint_angle": ("joint_angle",),
    "peak_joint_rate": ("joint_rate",),
    "peak_joint_torque": ("joint_torque",),
    "utilization": ("joint_angle", "joint_rate", "joint_torque"),
}
"""The figures of this module, and what of a log each needs."""
ROUNDING = 1e-9
"""A share that is this much above 1 is 1: servos do deliver all they have."""


@dataclass(frozen=True, kw_only=True)
class Feasibility:
    """What a run takes of what the robot has."""

    figures: Mapping[str, float]
    """By name, see `NEEDS`; in SI units."""
    words: str
    """The largest angle, rate and torque of a joint, each beside what it has there."""
    problems: tuple[str, ...]
    """Why the robot cannot do it, a sentence each; none if it can."""


def settled(time: Float[np.ndarray, " n_samples"], period: float | None) -> Bool[np.ndarray, " n_samples"]:
    """Which samples count: those after the first gait cycle, in which a run starts; all if not half a cycle is left.

    Half a cycle holds the peaks: the other half is its mirror image.

    Args:
        time: Of the samples [s].
        period: Of the gait, None without one [s].
    """
    start = time[0] + (period or 0.0)
    return time >= (start if time[-1] - start >= 0.5 * (period or 0.0) else time[0])


def shares(robots: Sequence[Robot], angle: Joints, rate: Joints, torque: Joints) -> Shares:
    """What every joint uses of its limit, of the speed of its actuator, and of that one's duty; 1 is all.

    Args:
        robots: One per run; the planar ones for runs in the plane.
        angle: phi of the driven joints, tail first, then that of a driven fin [rad].
        rate: phi' [rad/s].
        torque: u [N m].
    """
    has = [[(joint.limit, *_motor(joint.actuator)) for joint in robot.driven_joints] for robot in robots]
    limit, stall, speed, dry, viscous = np.array(has).reshape(len(robots), angle.shape[1], 5).T
    duty = (torque + viscous * rate + dry * np.tanh(rate / SLIDING_RATE)) / stall + rate / speed
    return np.abs(np.stack((angle / limit, rate / speed, duty)))


def _motor(actuator: Actuator) -> tuple[float, float, float, float]:
    return actuator.stall_torque, actuator.no_load_speed, actuator.friction_torque, actuator.viscous_friction


def peaks(
    robots: Sequence[Robot], angle: Joints, rate: Joints, torque: Joints, counts: Bool[np.ndarray, "n_samples n_runs"]
) -> dict[str, Float[np.ndarray, " n_runs"]]:
    """The figures of many runs; of one that diverged they mean nothing.

    Args:
        robots: See `shares`, which has the other arguments.
        angle: See there [rad].
        rate: See there [rad/s].
        torque: See there [N m].
        counts: Which samples do, see `settled`.
    """
    motion = [np.where(counts[:, np.newaxis], one, 0.0) for one in (angle, rate, torque)]
    largest = [np.abs(one).max(axis=(0, 1), initial=0.0) for one in motion]
    used = shares(robots, *motion).max(axis=(0, 1, 2), initial=0.0)
    near = [overlap(robot, motion[0][:, : robot.n_joints, k])[0] for k, robot in enumerate(robots)]
    return dict(zip(NEEDS, (*largest, np.maximum(used, near)), strict=True))


def overlap(robot: Robot, angle: Float[np.ndarray, "n_samples n_joints"]) -> tuple[float, int, int]:
    """How near two links come to overlapping, and which two: above 1 they do.

    Args:
        robot: Whose links are bent.
        angle: phi of the joints between them, tail first [rad].
    """
    if not angle.size:
        return 0.0, 0, 0
    length = np.array([module.length for module in robot.modules])
    height, width = np.array([(m.section.half_height, m.section.half_width) for m in robot.modules]).T
    is_yaw = np.array([joint.axis == "yaw" for joint in robot.joints])
    half = np.where(is_yaw, np.maximum(width[1:], width[:-1]), np.maximum(height[1:], height[:-1]))
    bend = np.minimum(np.abs(angle).max(axis=0), math.pi - 1e-6)
    fold = half * np.tan(0.5 * bend) / (0.5 * np.minimum(length[1:], length[:-1]))
    worst = int(np.argmax(fold))
    found = float(fold[worst]), worst, worst + 1
    if np.any(angle[:, ~is_yaw]):
        return found
    turned = np.cumsum(np.pad(angle, ((0, 0), (1, 0))), axis=1)
    # Links whose directions differ by less come on along the body, and none reaches past its neighbors.
    curl, room = np.ptp(turned, axis=1), 0.5 * length[1:-1].min(initial=math.inf) / width.max()
    curled = np.tan(0.5 * np.minimum(curl, 3.1)) >= room
    return max(found, _crossing(length, width, turned[curled])) if np.any(curled) else found


def _crossing(
    length: Float[np.ndarray, " n_links"], width: Float[np.ndarray, " n_links"], turned: Float[np.ndarray, "n n_links"]
) -> tuple[float, int, int]:
    """The same of the rectangles of links that are no neighbors, by the axes that may separate two of them.

    Args:
        length: Of the links [m].
        width: Half of theirs [m].
        turned: Angles of the links to the tail link [rad].
    """
    along = np.stack((np.cos(turned), np.sin(turned)))
    center = np.cumsum(length * along, axis=2) - 0.5 * length * along
    i, j = np.triu_indices(length.size, 2)
    apart, gaps = center[:, :, j] - center[:, :, i], list[np.ndarray]()
    cos, sin = np.abs(np.cos(turned[:, j] - turned[:, i])), np.abs(np.sin(turned[:, j] - turned[:, i]))
    for a, b in ((i, j), (j, i)):
        x, y = along[:, :, a]
        gaps.append(np.abs(apart[0] * x + apart[1] * y) - 0.5 * (length[a] + length[b] * cos) - width[b] * sin)
        gaps.append(np.abs(apart[1] * x - apart[0] * y) - 0.5 * length[b] * sin - width[a] - width[b] * cos)
    share = (1.0 - np.max(gaps, axis=0) / (width[i] + width[j])).max(axis=0)
    worst = int(np.argmax(share))
    return float(share[worst]), int(i[worst]), int(j[worst])


def feasibility(robot: Robot, log: Log, period: float | None) -> Feasibility:
    """What a run takes of what the robot has.

    Args:
        robot: The planar one for a run in the plane.
        log: Of the run; what was not measured is 0 there, and takes nothing.
        period: Of the gait, None without one [s].
    """
    counts = settled(log.time, period)
    fin = [log.signals.get(name, 0.0 * log.time) for name in ("fin_angle_0", "fin_rate_0", "fin_torque")]
    body = (log.joint_angle, log.joint_rate, log.joint_torque)
    columns = [np.column_stack((one, own)) for one, own in zip(body, fin, strict=True)]
    motion = [one[:, : len(robot.driven_joints), np.newaxis] for one in columns]
    figures = {name: float(one[0]) for name, one in peaks([robot], *motion, counts[:, np.newaxis]).items()}
    motion = [one[counts] for one in motion]
    words, problems = _said(robot, *(one[..., 0] for one in motion)) if robot.driven_joints else ("no joints", [])
    share, i, j = overlap(robot, motion[0][:, : robot.n_joints, 0])
    if share > 1.0 + ROUNDING:
        problems.append(f"links {i} and {j} overlap")
    return Feasibility(figures=figures, words=words, problems=tuple(problems))


def _said(robot: Robot, angle: np.ndarray, rate: np.ndarray, torque: np.ndarray) -> tuple[str, list[str]]:
    """The largest angle, rate and torque in words, each beside what its joint has; and what goes beyond that."""
    used = shares([robot], angle[..., np.newaxis], rate[..., np.newaxis], torque[..., np.newaxis])[..., 0]
    places = [tuple(map(int, np.unravel_index(np.argmax(one), one.shape))) for one in used]
    names = [f"joint {j}" if j < robot.n_joints else "the fin's joint" for _, j in places]
    bent, fast, strong = (robot.driven_joints[j] for _, j in places)
    bends, limit = math.degrees(abs(angle[places[0]])), math.degrees(bent.limit)
    turns, speed = math.degrees(abs(rate[places[1]])), math.degrees(fast.actuator.no_load_speed)
    needs, along = abs(torque[places[2]]), math.copysign(1.0, torque[places[2]]) * rate[places[2]]
    stall, no_load, dry, viscous = _motor(strong.actuator)
    has = max(0.0, stall * (1.0 - along / no_load) - viscous * along - dry * math.tanh(along / SLIDING_RATE))
    at = f"at {math.degrees(along):.3g} deg/s"
    lacks, problems = needs > has, list[str]()
    beyond = used.max(axis=(1, 2)) > 1.0 + ROUNDING
    if beyond[0]:
        problems.append(f"{names[0]} bends {bends:.3g} deg; its limit is {limit:.3g}")
    if beyond[2] and lacks:
        problems.append(f"{names[2]} needs {needs:.3g} N m {at}; its servo has {has:.3g}")
    elif beyond[1]:
        problems.append(f"{names[1]} turns at {turns:.3g} deg/s; its servo does {speed:.3g}")
    words = (
        f"{names[0]} bends {bends:.3g} of {limit:.3g} deg, {names[1]} turns at {turns:.3g} of {speed:.3g} deg/s, "
        f"{names[2]} needs {needs:.3g} of {has:.3g} N m {at}"
    )
    return words, problems


def peak(name: str) -> Callable[[Any], float]:
    """What gives one of the figures of a trial; it raises a ValueError if what it needs was not measured.

    Args:
        name: One of `NEEDS`.
    """

    def of(trial: Any) -> float:
        trial.need(f"a {name.replace('_', ' ')}", *NEEDS[name])
        return trial.feasibility.figures[name]

    return of
