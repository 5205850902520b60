"""Can this robot do it? What a run demands of joints and actuators, what they offer, and whether links overlap.

The torque available from an actuator at the rate phi', in the direction of u, follows its
torque-speed line, u_stall (1 - phi'/phi'_0) less its own friction. This is its `servo` law
inverted; the duty must stay within -1 and 1:

    d = (u + b phi' + u_c tanh(phi'/eps)) / u_stall + phi'/phi'_0

When it brakes (phi' < 0 in that formula), more torque is available than at standstill. Links are
rectangles with their length and width. Neighbors fold over each other when the inner edges of their
bend meet beyond the middle of one of them; links further apart overlap when their rectangles do,
which is checked in the plane of the yaw joints as long as no other joint bends.
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

_SERIES = ("joint_angle", "joint_rate", "joint_torque")
NEEDS = {f"peak_{name}": (name,) for name in _SERIES} | {"utilization": _SERIES}
"""The figures of this module, and the series of a log that each needs."""
AT_ONCE = 1 << 20  # samples times pairs of links processed at once: 100 MB
ROUNDING = 1e-9
"""A share that exceeds 1 by no more than this counts as 1: servos do deliver all they have."""
MOST = 40
"""Number of postures that are checked for crossing links in each of many runs."""


@dataclass(frozen=True, kw_only=True)
class Feasibility:
    """What a run demands of the robot, compared with what the robot offers."""

    figures: Mapping[str, float]
    """Figures by name, see `NEEDS`; in SI units."""
    words: str
    """The largest angle, rate and torque of a joint, each with the value available at that joint."""
    problems: tuple[str, ...]
    """Reasons why the robot cannot do it, one sentence each; empty if it can."""


def settled(
    time: Float[np.ndarray, " n_samples"], period: float | None
) -> Bool[np.ndarray, " n_samples"]:
    """Return which samples count: those after the first (start-up) cycle; all if less than half a cycle is left.

    Half a cycle contains the peaks: the other half is its mirror image.

    Args:
        time: Times of the samples [s].
        period: Gait period, None without a gait [s].
    """
    start = time[0] + (period or 0.0)
    return time >= (start if time[-1] - start >= 0.5 * (period or 0.0) else time[0])


def _has(robots: Sequence[Robot]) -> np.ndarray:
    """Limit [rad], stall torque [N m], no-load speed [rad/s], dry [N m] and viscous friction of each joint and run."""
    kinds = {
        id(robot): [(joint.limit, *_motor(joint.actuator)) for joint in robot.driven_joints]
        for robot in robots
    }
    return np.array([kinds[id(robot)] for robot in robots]).reshape(len(robots), -1, 5).T


def _motor(actuator: Actuator) -> tuple[float, float, float, float]:
    """Return the torque-speed line; a motor whose data are not stated has no limits."""
    if not actuator.stated:
        return math.inf, math.inf, 0.0, 0.0
    return (
        actuator.stall_torque,
        actuator.no_load_speed,
        actuator.friction_torque,
        actuator.viscous_friction,
    )


def duty(robots: Sequence[Robot], rate: Joints, torque: Joints) -> Joints:
    """Compute the duty d that the actuators would need; beyond -1 and 1 they cannot follow.

    Args:
        robots: One robot per run, in its planar form for runs in the plane.
        rate: phi' of the driven joints, tail first, followed by that of a driven fin [rad/s].
        torque: u [N m].
    """
    _, stall, speed, dry, viscous = _has(robots)
    found = torque / stall + rate * (viscous / stall + 1.0 / speed)
    return found + dry / stall * np.tanh(rate / SLIDING_RATE) if np.any(dry) else found


def peaks(
    robots: Sequence[Robot],
    angle: Joints,
    rate: Joints,
    torque: Joints,
    counts: Bool[np.ndarray, "n_samples n_runs"],
    most: int = MOST,
) -> dict[str, Float[np.ndarray, " n_runs"]]:
    """Compute the figures of many runs; they are meaningless for a run that diverged.

    Args:
        robots: One robot per run, in its planar form for runs in the plane.
        angle: phi [rad].
        rate: phi' of the driven joints, tail first, followed by that of a driven fin [rad/s].
        torque: u [N m].
        counts: Which samples count, see `settled`.
        most: Maximum number of curled postures, evenly spread over a run, that are checked for
            crossing links.
    """
    mask = counts[:, np.newaxis]
    motion = (angle, rate, torque, duty(robots, rate, torque))
    largest = [np.max(np.abs(one) * mask, axis=0, initial=0.0) for one in motion]
    limit, _, speed, _, _ = _has(robots)
    used = np.max([largest[0] / limit, largest[1] / speed, largest[3]], axis=(0, 1), initial=0.0)
    turned = np.cumsum(angle[:, : robots[0].n_joints], axis=1)
    curl = np.maximum(turned.max(axis=1, initial=0.0), 0.0) - np.minimum(
        turned.min(axis=1, initial=0.0), 0.0
    )
    for k, robot in enumerate(robots):
        curled = np.flatnonzero(counts[:, k] & (curl[:, k] >= _room(robot)))
        postures = angle[curled[:: max(1, math.ceil(curled.size / most))], : robot.n_joints, k]
        used[k] = max(
            used[k], _fold(robot, largest[0][: robot.n_joints, k])[0], _crossing(robot, postures)[0]
        )
    return dict(
        zip(NEEDS, (*(one.max(axis=0, initial=0.0) for one in largest[:3]), used), strict=True)
    )


def overlap(robot: Robot, angle: Float[np.ndarray, "n_samples n_joints"]) -> tuple[float, int, int]:
    """Return how close two links come to overlapping, and which two they are; above 1 they overlap.

    Args:
        robot: The robot whose links are bent.
        angle: phi of the joints between the links, tail first [rad].
    """
    return max(_fold(robot, np.abs(angle).max(axis=0, initial=0.0)), _crossing(robot, angle))


def _fold(robot: Robot, bend: Float[np.ndarray, " n_joints"]) -> tuple[float, int, int]:
    """Return the same as `overlap` for neighboring links, from the largest bend of every joint [rad]."""
    found = 0.0, 0, 0
    for i, (joint, angle) in enumerate(zip(robot.joints, bend.tolist(), strict=True)):
        pair = robot.modules[i : i + 2]
        half = max(
            m.section.half_width if joint.axis == "yaw" else m.section.half_height for m in pair
        )
        room = 0.5 * min(m.length for m in pair)
        found = max(found, (half * math.tan(0.5 * min(angle, math.pi - 1e-6)) / room, i, i + 1))
    return found


def _room(robot: Robot) -> float:
    """Return the largest difference in direction at which all links advance along the body and none passes the next."""
    inner = min((module.length for module in robot.modules[1:-1]), default=math.inf)
    return 2.0 * math.atan(0.5 * inner / max(module.section.half_width for module in robot.modules))


def _crossing(
    robot: Robot, angle: Float[np.ndarray, "n_samples n_joints"]
) -> tuple[float, int, int]:
    """Return the same as `overlap` for other pairs of links, as rectangles, by the axes that may separate them."""
    is_yaw = [joint.axis == "yaw" for joint in robot.joints]
    if not angle.size or robot.n_links < 3 or np.any(angle[:, np.logical_not(is_yaw)]):
        return 0.0, 0, 0
    if len(angle) > 1 and angle.size * robot.n_links > AT_ONCE:
        return max(
            (_crossing(robot, part) for part in np.array_split(angle, 2)),
            key=lambda found: found[0],
        )
    length = np.array([module.length for module in robot.modules])
    width = np.array([module.section.half_width for module in robot.modules])
    turned = np.cumsum(np.column_stack((np.zeros(len(angle)), angle)), axis=1)
    along = np.stack((np.cos(turned), np.sin(turned)))
    center = np.cumsum(length * along, axis=2) - 0.5 * length * along
    i, j = np.triu_indices(length.size, 2)
    apart, gaps = center[:, :, j] - center[:, :, i], list[np.ndarray]()
    cos, sin = (
        np.abs(np.cos(turned[:, j] - turned[:, i])),
        np.abs(np.sin(turned[:, j] - turned[:, i])),
    )
    for a, b in ((i, j), (j, i)):
        x, y = along[:, :, a]
        gaps.append(
            np.abs(apart[0] * x + apart[1] * y)
            - 0.5 * (length[a] + length[b] * cos)
            - width[b] * sin
        )
        gaps.append(
            np.abs(apart[1] * x - apart[0] * y) - 0.5 * length[b] * sin - width[a] - width[b] * cos
        )
    share = (1.0 - np.max(gaps, axis=0) / (width[i] + width[j])).max(axis=0)
    worst = int(np.argmax(share))
    return float(share[worst]), int(i[worst]), int(j[worst])


def feasibility(robot: Robot, log: Log, period: float | None) -> Feasibility:
    """Compare what a run demands of the robot with what the robot offers.

    Args:
        robot: The robot, in its planar form for a run in the plane.
        log: Log of the run; series that were not measured are 0 there, and demand nothing.
        period: Gait period, None without a gait [s].
    """
    counts = settled(log.time, period)
    fin = [
        log.signals.get(name, 0.0 * log.time)
        for name in ("fin_angle_0", "fin_rate_0", "fin_torque")
    ]
    body = (log.joint_angle, log.joint_rate, log.joint_torque)
    n_driven, all_count = len(robot.driven_joints), np.full((np.count_nonzero(counts), 1), True)
    columns = [
        np.column_stack((one, own))[counts, :n_driven] for one, own in zip(body, fin, strict=True)
    ]
    angle, rate, torque = (one[..., np.newaxis] for one in columns)
    found = peaks([robot], angle, rate, torque, all_count, len(angle))
    words, problems = _said(robot, angle, rate, torque) if n_driven else ("none", list[str]())
    figures = {name: float(one[0]) for name, one in found.items()}
    if figures["utilization"] > 1.0 + ROUNDING:  # only then can links overlap as well
        share, i, j = overlap(robot, angle[:, : robot.n_joints, 0])
        if share > 1.0 + ROUNDING:
            problems.append(f"links {i} and {j} overlap")
    return Feasibility(figures=figures, words=words, problems=tuple(problems))


def _said(robot: Robot, angle: Joints, rate: Joints, torque: Joints) -> tuple[str, list[str]]:
    """Describe the largest angle, rate and torque, each with the value available, and list whatever exceeds it."""
    limit, _, speed, _, _ = _has([robot])
    used = np.abs(np.stack((angle / limit, rate / speed, duty([robot], rate, torque))))
    places = [tuple(map(int, np.unravel_index(np.argmax(one), one.shape))) for one in used]
    names = [f"joint {j}" if j < robot.n_joints else "the fin's joint" for _, j, _ in places]
    bent, fast, strong = (robot.driven_joints[j] for _, j, _ in places)
    bends, end = math.degrees(abs(angle[places[0]])), math.degrees(bent.limit)
    turns, does = math.degrees(abs(rate[places[1]])), math.degrees(fast.actuator.no_load_speed)
    needs, along = abs(torque[places[2]]), math.copysign(1.0, torque[places[2]]) * rate[places[2]]
    stall, no_load, dry, viscous = _motor(strong.actuator)
    has = max(
        0.0,
        stall * (1.0 - along / no_load) - viscous * along - dry * math.tanh(along / SLIDING_RATE),
    )
    at = f"at {math.degrees(along):.3g} deg/s"
    lacks, problems = needs > has, list[str]()
    beyond = used.max(axis=(1, 2, 3)) > 1.0 + ROUNDING
    if beyond[0]:
        problems.append(f"{names[0]} bends {bends:.3g} deg; its limit is {end:.3g}")
    if not any(joint.actuator.stated for joint in robot.driven_joints):
        fastest, strongest = math.degrees(np.abs(rate).max()), np.abs(torque).max()
        takes = f"joints turn at up to {fastest:.3g} deg/s and need up to {strongest:.3g} N m"
        return (
            f"{names[0]} bends {bends:.3g} of {end:.3g} deg, {takes}; no actuator is stated",
            problems,
        )
    if beyond[2] and lacks:
        problems.append(f"{names[2]} needs {needs:.3g} N m {at}; its servo has {has:.3g}")
    elif beyond[1]:
        problems.append(f"{names[1]} turns at {turns:.3g} deg/s; its servo does {does:.3g}")
    words = (
        f"{names[0]} bends {bends:.3g} of {end:.3g} deg, {names[1]} turns at {turns:.3g} of {does:.3g} deg/s, "
        f"{names[2]} needs {needs:.3g} of {has:.3g} N m {at}"
    )
    return words, problems


def peak(name: str) -> Callable[[Any], float]:
    """Return a function that computes a figure of a trial; it raises a ValueError if required data were not measured.

    Args:
        name: One of `NEEDS`.
    """

    def of(trial: Any) -> float:
        trial.need(f"a {name.replace('_', ' ')}", *NEEDS[name])
        return trial.feasibility.figures[name]

    return of
