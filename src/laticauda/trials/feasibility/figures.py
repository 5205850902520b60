"""Peak demands as figures, of one run or of many side by side."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int

from laticauda.robot import Robot
from laticauda.trials.feasibility.actuators import Joints, Offer, driven_rate, duty_from_offer
from laticauda.trials.feasibility.link_overlap import (
    find_smallest_crossing_curl,
    measure_crossing,
    measure_fold,
    measure_neighbor_overlap,
)

NEEDS = {
    "peak_joint_angle": ("joint_angle",),
    "peak_joint_rate": ("joint_rate",),
    "peak_joint_torque": ("joint_torque",),
    "utilization": ("joint_angle", "joint_rate", "joint_torque"),
}
"""The figures of this module, and the series of a log that each needs."""
ROUNDING = 1e-9
"""A share that exceeds 1 by no more than this counts as 1: servos do deliver all they have."""
CAN_DO = 1.0 + ROUNDING
"""Largest share of what the robot offers that it can do [-]."""
MOST_POSTURES = 40
"""Number of postures that are checked for crossing links in each of many runs."""

Samples = Bool[np.ndarray, "n_samples n_runs"]


def find_settled_samples(
    time: Float[np.ndarray, " n_samples"], period: float | None
) -> Bool[np.ndarray, " n_samples"]:
    """Return which samples count: those after the first (start-up) cycle.

    All count if less than half a cycle is left. Half a cycle contains the peaks: the other half is
    its mirror image.

    Args:
        time: Times of the samples [s].
        period: Gait period, None without a gait [s].
    """
    start_up = period or 0.0
    end_of_start_up = time[0] + start_up
    if time[-1] - end_of_start_up < 0.5 * start_up:
        return time >= time[0]
    return time >= end_of_start_up


def count_unsettled_samples(
    time: Float[np.ndarray, " n_samples"], period: Float[np.ndarray, " n_runs"]
) -> Int[np.ndarray, " n_runs"]:
    """Return the number of samples of many runs that do not count, see `find_settled_samples`.

    Args:
        time: Times of the samples of every run [s].
        period: Gait period of each run, nan without a gait [s].
    """
    start_up: np.ndarray = np.nan_to_num(period)
    end_of_start_up: np.ndarray = time[0] + start_up
    remaining_time = time[-1] - end_of_start_up
    is_too_short = remaining_time < 0.5 * start_up
    settled_from: np.ndarray = np.where(is_too_short, time[0], end_of_start_up)
    return np.searchsorted(time, settled_from)


def compute_peaks(
    robots: Sequence[Robot],
    angle: Joints,
    rate: Joints,
    torque: Joints,
    counts: Samples,
    most: int = MOST_POSTURES,
) -> dict[str, Float[np.ndarray, " n_runs"]]:
    """Compute the figures of many runs; they are meaningless for a run that diverged.

    Args:
        robots: One robot per run, in its planar form for runs in the plane.
        angle: phi [rad].
        rate: phi' of the driven joints, tail first, followed by that of a driven fin [rad/s].
        torque: u [N m].
        counts: Which samples count, see `find_settled_samples`.
        most: Maximum number of curled postures, evenly spread over a run, that are checked for
            crossing links.
    """
    offer = Offer.of(robots)
    largest_angle = _largest(angle, counts)
    largest_rate = _largest(rate, counts)
    largest_torque = _largest(torque, counts)
    largest_duty = _largest(duty_from_offer(offer, rate, torque), counts)
    largest_driven_rate = _largest(driven_rate(rate, torque), counts)
    shares = [
        largest_angle / offer.joint_limit,
        largest_driven_rate / offer.no_load_speed,
        largest_duty,
    ]
    utilization = np.max(shares, axis=(0, 1), initial=0.0)
    curl = _curl(angle[:, : robots[0].n_joints])
    for run, robot in enumerate(robots):
        may_cross = counts[:, run] & (curl[:, run] >= find_smallest_crossing_curl(robot))
        body_angle = angle[:, : robot.n_joints, run]
        utilization[run] = max(
            utilization[run],
            measure_neighbor_overlap(robot, largest_angle[: robot.n_joints, run]).share,
            measure_crossing(robot, body_angle[spread_evenly(may_cross, most)]).share,
        )
    return {
        "peak_joint_angle": largest_angle.max(axis=0, initial=0.0),
        "peak_joint_rate": largest_rate.max(axis=0, initial=0.0),
        "peak_joint_torque": largest_torque.max(axis=0, initial=0.0),
        "utilization": utilization,
    }


def compute_joint_shares(
    robots: Sequence[Robot], angle: Joints, rate: Joints, torque: Joints, counts: Samples
) -> Float[np.ndarray, "7 n_driven n_runs"]:
    """Compute the shares of angle, speed, torque and room that every joint of many runs uses, to either side.

    By row: angle, speed and duty to the left, the same to the right, and what of the room between its links
    a joint of the body uses up. The largest of a run is its utilization, unless links that are no
    neighbors come closest.

    Args:
        robots: One robot per run, in its planar form for runs in the plane.
        angle: phi [rad].
        rate: phi' of the driven joints, tail first, followed by that of a driven fin [rad/s].
        torque: u [N m].
        counts: Which samples count, see `find_settled_samples`.
    """
    offer = Offer.of(robots)
    duty = duty_from_offer(offer, rate, torque)
    demands = (
        angle / offer.joint_limit,
        driven_rate(rate, torque) / offer.no_load_speed,
        duty,
    )
    is_counted = counts[:, np.newaxis]
    shares = [np.max(demand * is_counted, axis=0) for demand in demands]
    shares += [np.max(-demand * is_counted, axis=0) for demand in demands]
    largest_angle = _largest(angle, counts)
    fold = np.zeros_like(largest_angle)
    for run, robot in enumerate(robots):
        for joint in range(robot.n_joints):
            fold[joint, run] = measure_fold(robot, joint, float(largest_angle[joint, run]))
    return np.stack([*shares, fold])


def _largest(values: Joints, counts: Samples) -> Float[np.ndarray, "n_joints n_runs"]:
    """Return the largest magnitude of every joint among the samples that count."""
    return np.max(np.abs(values) * counts[:, np.newaxis], axis=0, initial=0.0)


def _curl(body_angle: Joints) -> Float[np.ndarray, "n_samples n_runs"]:
    """Return the largest difference in direction between two links [rad]."""
    direction = np.cumsum(body_angle, axis=1)
    leftmost = np.maximum(direction.max(axis=1, initial=0.0), 0.0)
    rightmost = np.minimum(direction.min(axis=1, initial=0.0), 0.0)
    return leftmost - rightmost


def spread_evenly(
    is_chosen: Bool[np.ndarray, " n_samples"], most: int = MOST_POSTURES
) -> np.ndarray:
    """Return the indices of at most `most` of the chosen samples, evenly spread.

    Args:
        is_chosen: Whether each sample is chosen.
        most: Largest number of indices.
    """
    chosen = np.flatnonzero(is_chosen)
    return chosen[:: max(1, math.ceil(chosen.size / most))]


def make_peak_figure(name: str) -> Callable[[Any], float]:
    """Return a function that computes a figure of a trial.

    It raises a ValueError if required data were not measured.

    Args:
        name: One of `NEEDS`.
    """

    def figure_of(trial: Any) -> float:  # a `Trial`, whose class is made of this function
        trial.need(f"a {name.replace('_', ' ')}", *NEEDS[name])
        return trial.feasibility.figures[name]

    return figure_of
