"""What a run demands of the robot, beside what the robot offers, in sentences."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from laticauda.robot import Robot
from laticauda.trials.feasibility.actuators import (
    Joints,
    Offer,
    TorqueSpeedLine,
    driven_rate,
    duty_from_offer,
)
from laticauda.trials.feasibility.figures import ROUNDING, compute_peaks, find_settled_samples
from laticauda.trials.feasibility.link_overlap import measure_overlap
from laticauda.values import Log

SERVOS = "servos"
JOINT_ANGLES = "joint angles"
LINKS = "links that touch"
FIN_SERIES = {
    "joint_angle": "fin_angle_0",
    "joint_rate": "fin_rate_0",
    "joint_torque": "fin_torque",
}
"""Series of a driven fin, by that of the joints beside which it stands."""


@dataclass(frozen=True, kw_only=True)
class Feasibility:
    """What a run demands of the robot, compared with what the robot offers."""

    figures: Mapping[str, float]
    """Figures by name, see `NEEDS`; in SI units."""
    words: str
    """The largest angle, rate and torque of a joint, each with the value that it offers."""
    problems: tuple[str, ...]
    """Reasons why the robot cannot do it, one sentence each; empty if it can."""
    limited_by: str
    """What is used most of all that the robot offers: its servos, its joint angles, or the room between its links."""
    is_complete: bool = True
    """Whether angles, rates and torques are all known; what was not measured counts as 0."""


@dataclass(frozen=True, kw_only=True)
class Demand:
    """The moment and joint at which a run demands most of what is offered."""

    words: str
    """What is demanded, of what is offered."""
    problem: str
    """The same as a sentence on why the joint cannot do it."""
    exceeds_offer: bool
    """Whether it cannot do it."""


def describe_ability(robot: Robot, feasibility: Feasibility) -> str:
    """Return in words whether the joints of a robot can do a run.

    Args:
        robot: The robot.
        feasibility: What the run demands of it.
    """
    if feasibility.problems:
        return f"cannot do it: {'; '.join(feasibility.problems)}"
    utilization = feasibility.figures["utilization"]
    if not math.isfinite(utilization) or not feasibility.is_complete:
        return feasibility.words
    if not any(joint.actuator.stated for joint in robot.driven_joints):
        return "can do it as far as their angles go; no actuator is stated"
    return f"can do it: {100.0 * utilization:.0f} % of angle, speed and torque are used"


def judge_feasibility(
    robot: Robot, log: Log, period: float | None, not_measured: Collection[str] = ()
) -> Feasibility:
    """Compare what a run demands of the robot with what the robot offers.

    Args:
        robot: The robot, in its planar form for a run in the plane.
        log: Log of the run; series that were not measured are 0 there, and demand nothing.
        period: Gait period, None without a gait [s].
        not_measured: Names of those series; nothing is said of them.
    """
    unknown = [series for series in FIN_SERIES if series in not_measured]
    is_settled = find_settled_samples(log.time, period)
    angle = _driven_joints(robot, log, "joint_angle")[is_settled]
    rate = _driven_joints(robot, log, "joint_rate")[is_settled]
    torque = _driven_joints(robot, log, "joint_torque")[is_settled]
    all_count = np.full((len(angle), 1), True)
    figures = compute_peaks([robot], angle, rate, torque, all_count, most=len(angle))
    words = "none"
    problems: list[str] = []
    if robot.driven_joints:
        words, problems = _describe(robot, angle, rate, torque, unknown)
    if figures["utilization"] > 1.0 + ROUNDING:  # only then can links overlap as well
        closest = measure_overlap(robot, angle[:, : robot.n_joints, 0])
        if closest.share > 1.0 + ROUNDING:
            problems.append(f"links {closest.first_link} and {closest.second_link} overlap")
    return Feasibility(
        figures={name: float(values[0]) for name, values in figures.items()},
        words=words,
        problems=tuple(problems),
        limited_by=_name_limit(robot, angle, rate, torque, figures["utilization"][0]),
        is_complete=not unknown,
    )


def _name_limit(
    robot: Robot, angle: Joints, rate: Joints, torque: Joints, utilization: float
) -> str:
    """Return which of the offers is used most; `utilization` is the largest share of all [-]."""
    if not robot.driven_joints:
        return LINKS
    offer = Offer.of([robot])
    share_of_limit = {
        SERVOS: max(
            _largest_magnitude(duty_from_offer(offer, rate, torque)),
            _largest_magnitude(driven_rate(rate, torque) / offer.no_load_speed),
        ),
        JOINT_ANGLES: _largest_magnitude(angle / offer.joint_limit),
    }
    largest = max(share_of_limit, key=share_of_limit.__getitem__)
    if share_of_limit[largest] < utilization - ROUNDING:
        return LINKS
    return largest


def exceeds_actuators(robot: Robot, log: Log, period: float | None) -> bool:
    """Return whether a run demands more of a joint than it offers: an angle, or a torque at its rate.

    Every run is asked this, so it is fast: overlapping links are not looked for.

    Args:
        robot: The robot, in its planar form for a run in the plane.
        log: Log of the run.
        period: Gait period, None without a gait [s].
    """
    if not robot.driven_joints:
        return False
    offer = Offer.of([robot])
    first = int(np.argmax(find_settled_samples(log.time, period)))
    angle, rate, torque = (_driven_joints(robot, log, series)[first:] for series in FIN_SERIES)
    demands = (angle / offer.joint_limit, duty_from_offer(offer, rate, torque))
    return any(_largest_magnitude(share) > 1.0 + ROUNDING for share in demands)


def _largest_magnitude(values: Joints) -> float:
    return max(float(values.max()), -float(values.min()))


def _driven_joints(robot: Robot, log: Log, series: str) -> Joints:
    """Return a series of all driven joints and then of a driven fin, as of a single run."""
    return _driven_columns(robot, log, series)[..., np.newaxis]


def _driven_columns(robot: Robot, log: Log, series: str) -> np.ndarray:
    """Return a series of all driven joints and then of a driven fin, a column each."""
    columns: np.ndarray = getattr(log, series)
    if len(robot.driven_joints) == columns.shape[1]:
        return columns
    fin = log.signals.get(FIN_SERIES[series], 0.0 * log.time)
    return np.column_stack((columns, fin))[:, : len(robot.driven_joints)]


def _describe(
    robot: Robot, angle: Joints, rate: Joints, torque: Joints, unknown: Sequence[str]
) -> tuple[str, list[str]]:
    """Describe the largest angle, rate and torque, each with the value available, but for the `unknown` series.

    The second value holds a sentence for whatever exceeds it.
    """
    offer = Offer.of([robot])
    bend = _largest_bend(robot, angle, offer)
    turn = _fastest_turn(robot, rate, torque, offer)
    effort = _greatest_effort(robot, rate, torque, offer)
    problems: list[str] = []
    if bend.exceeds_offer:
        problems.append(bend.problem)
    if unknown:
        known = [("joint_angle", bend), ("joint_rate", turn)]
        parts = [demand.words for series, demand in known if series not in unknown]
        names = [f"no {series.replace('_', ' ')} was measured" for series in unknown]
        return ", ".join(parts + names), problems
    if not any(joint.actuator.stated for joint in robot.driven_joints):
        fastest = math.degrees(np.abs(rate).max())
        strongest = np.abs(torque).max()
        motion = f"joints turn at up to {fastest:.3g} deg/s and need up to {strongest:.3g} N m"
        return f"{bend.words}, {motion}; no actuator is stated", problems
    if effort.exceeds_offer:
        problems.append(effort.problem)
    elif turn.exceeds_offer:
        problems.append(turn.problem)
    return f"{bend.words}, {turn.words}, {effort.words}", problems


def _largest_bend(robot: Robot, angle: Joints, offer: Offer) -> Demand:
    """Return the demand of the joint that comes closest to its limit."""
    share = np.abs(angle / offer.joint_limit)
    sample, joint = _largest_at(share)
    bend = math.degrees(abs(angle[sample, joint, 0]))
    limit = math.degrees(robot.driven_joints[joint].limit)
    name = _joint_name(robot, joint)
    return Demand(
        words=f"{name} bends {bend:.3g} of {limit:.3g} deg",
        problem=f"{name} bends {bend:.3g} deg; its limit is {limit:.3g}",
        exceeds_offer=_exceeds(share),
    )


def _fastest_turn(robot: Robot, rate: Joints, torque: Joints, offer: Offer) -> Demand:
    """Return the demand of the joint that comes closest to its speed without load.

    Where the water turns a joint, the motor brakes: at whatever speed, this exceeds nothing.
    """
    share = np.abs(rate / offer.no_load_speed)
    driven_share = np.abs(driven_rate(rate, torque) / offer.no_load_speed)
    exceeds_offer = _exceeds(driven_share)
    if exceeds_offer:
        share = driven_share
    sample, joint = _largest_at(share)
    speed = math.degrees(abs(rate[sample, joint, 0]))
    no_load_speed = math.degrees(robot.driven_joints[joint].actuator.no_load_speed)
    name = _joint_name(robot, joint)
    return Demand(
        words=f"{name} turns at {speed:.3g} of {no_load_speed:.3g} deg/s",
        problem=f"{name} turns at {speed:.3g} deg/s; its servo does {no_load_speed:.3g}",
        exceeds_offer=exceeds_offer,
    )


def _greatest_effort(robot: Robot, rate: Joints, torque: Joints, offer: Offer) -> Demand:
    """Return the demand of the joint that comes closest to its torque-speed line."""
    share = np.abs(duty_from_offer(offer, rate, torque))
    sample, joint = _largest_at(share)
    needed = abs(torque[sample, joint, 0])
    rate_along_torque = math.copysign(1.0, torque[sample, joint, 0]) * rate[sample, joint, 0]
    motor = TorqueSpeedLine.of(robot.driven_joints[joint].actuator)
    available = motor.available_torque(rate_along_torque)
    name = _joint_name(robot, joint)
    at_rate = f"at {math.degrees(rate_along_torque):.3g} deg/s"
    return Demand(
        words=f"{name} needs {needed:.3g} of {available:.3g} N m {at_rate}",
        problem=f"{name} needs {needed:.3g} N m {at_rate}; its servo has {available:.3g}",
        exceeds_offer=_exceeds(share) and bool(needed > available),
    )


def _largest_at(share: Joints) -> tuple[int, int]:
    """Return the sample and the joint at which a share is largest."""
    sample, joint, _ = np.unravel_index(np.argmax(share), share.shape)
    return int(sample), int(joint)


def _exceeds(share: Joints) -> bool:
    return bool(share.max() > 1.0 + ROUNDING)


def _joint_name(robot: Robot, joint: int) -> str:
    """Return what a driven joint is called in a sentence."""
    if joint < robot.n_joints:
        return f"joint {joint}"
    return "the fin's joint"
