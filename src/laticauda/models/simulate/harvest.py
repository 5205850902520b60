"""What is taken from the log of a block right after it was computed, in compiled code (a template).

The formulas are those of `batch_figures.sample_block` and of `laticauda.trials.feasibility`, to the last
bit.
"""

# pyright: basic
# ruff: noqa: N803

import math

import numpy as np

from laticauda.compiling import entry, kernel
from laticauda.compiling.templates import bindings
from laticauda.models.planar.rows import HEADING, N_WORKS, TIME, VX, WORK_ABSOLUTE, X

_specialization = bindings(__name__)
N_LANES = _specialization["n_lanes"]
"""Runs of a block."""
MOST_POSTURES = _specialization["most_postures"]
"""Postures that are checked for crossing links in each run."""
_X = X - TIME
_VX = VX - TIME
N_AXES = 2
ANGLE = 0
"""Row of the largest joint angle in the results of `scan_joints` [rad]."""
RATE = 1
"""Row of the largest joint rate [rad/s]."""
TORQUE = 2
"""Row of the largest torque [N m]."""
DUTY = 3
"""Row of the largest duty [-]."""
DRIVEN_RATE = 4
"""Row of the largest rate of a joint that its motor drives [rad/s]."""
N_PEAKS = 5
ROUNDING_OF_SHARES = 1e-9
"""Relative error of shares that are only compared [-]."""
SMALLEST_SHARE_OF_DISTANCE = 0.7
"""A little less than 1/sqrt(2) [-]."""


@entry
def keep_path(log, S, index, before, numbers):
    """Write the numbers from which figures are computed, in the order of `batch_figures.START` to `WORK`.

    Args:
        log: Log of a block.
        S: Rows of the block at the end.
        index: Index of each lane's run in the batch.
        before: Index of the last sample before the steady part, of every run of the batch.
        numbers: One column per run of the batch.
    """
    last = log.shape[0] - 1
    for lane in range(index.size):
        run = index[lane]
        first = before[run]
        for axis in range(N_AXES):
            numbers[axis, run] = log[0, _X + axis, lane]
            numbers[N_AXES + axis, run] = log[last, _X + axis, lane]
            numbers[2 * N_AXES + axis, run] = log[first, _X + axis, lane]
            numbers[3 * N_AXES + axis, run] = log[first, _VX + axis, lane]
            numbers[4 * N_AXES + axis, run] = log[first + 1, _X + axis, lane]
            numbers[5 * N_AXES + axis, run] = log[first + 1, _VX + axis, lane]
        numbers[6 * N_AXES, run] = S[HEADING, lane]
        for kind in range(N_WORKS):
            numbers[6 * N_AXES + 1 + kind, run] = S[WORK_ABSOLUTE + kind, lane]


@entry
def scan_joints(
    log,
    columns,
    first,
    stall_torque,
    duty_per_rate,
    joint_limit,
    no_load_speed,
    n_joints,
    peaks,
    curl,
    utilization,
):
    """Find the peaks of every driven joint, and the curl of the body at every sample.

    Args:
        log: Log of a block.
        columns: Columns of the driven joints in the log, those of the body first: of their angles,
            rates and torques.
        first: First sample of each lane that counts.
        stall_torque: Of every driven joint and lane [N m].
        duty_per_rate: Duty per rate, of every driven joint and lane [s/rad].
        joint_limit: Largest angle, of every driven joint and lane [rad].
        no_load_speed: Rate without load, of every driven joint and lane [rad/s].
        n_joints: Number of joints of the body.
        peaks: Receives the peaks: by row, driven joint and lane.
        curl: Receives the largest difference in direction between two links, by sample and lane, and in
            its last row that of all samples; 0 for samples that do not count [rad].
        utilization: Receives the largest share of angle, speed and torque of each lane [-].
    """
    n_samples = log.shape[0]
    # What is added is in memory, rounded: multiplied in the same expression, it would not be.
    added_duty = curl[0].copy()
    direction = curl[0].copy()
    leftmost = curl[0].copy()
    rightmost = curl[0].copy()
    peaks[:] = 0.0
    curl[:] = 0.0
    for sample in range(first.min(), n_samples):
        direction[:] = 0.0
        leftmost[:] = 0.0
        rightmost[:] = 0.0
        for joint in range(columns.shape[1]):
            angle = log[sample, columns[0, joint]]
            rate = log[sample, columns[1, joint]]
            torque = log[sample, columns[2, joint]]
            for lane in range(N_LANES):
                added_duty[lane] = rate[lane] * duty_per_rate[joint, lane]
            for lane in range(N_LANES):
                share = torque[lane] / stall_torque[joint, lane] + added_duty[lane]
                driven_rate = 0.0 if rate[lane] * torque[lane] < 0.0 else rate[lane]
                counts = sample >= first[lane]
                keep_larger(peaks, ANGLE, joint, lane, angle[lane], counts)
                keep_larger(peaks, RATE, joint, lane, rate[lane], counts)
                keep_larger(peaks, TORQUE, joint, lane, torque[lane], counts)
                keep_larger(peaks, DUTY, joint, lane, share, counts)
                keep_larger(peaks, DRIVEN_RATE, joint, lane, driven_rate, counts)
            if joint < n_joints:
                for lane in range(N_LANES):
                    direction[lane] += angle[lane]
                    leftmost[lane] = max(leftmost[lane], direction[lane])
                    rightmost[lane] = min(rightmost[lane], direction[lane])
        for lane in range(N_LANES):
            if sample >= first[lane]:
                curl[sample, lane] = leftmost[lane] - rightmost[lane]
                curl[n_samples, lane] = max(curl[n_samples, lane], curl[sample, lane])
    utilization[:] = 0.0
    for joint in range(columns.shape[1]):
        for lane in range(N_LANES):
            share = max(
                peaks[ANGLE, joint, lane] / joint_limit[joint, lane],
                peaks[DRIVEN_RATE, joint, lane] / no_load_speed[joint, lane],
                peaks[DUTY, joint, lane],
            )
            utilization[lane] = max(utilization[lane], share)


@kernel
def keep_larger(peaks, row, joint, lane, value, counts):
    """Keep the magnitude of a value that counts, if it is larger than those before."""
    largest = peaks[row, joint, lane]
    size = abs(value) if counts else 0.0
    peaks[row, joint, lane] = size if size > largest else largest


@entry
def find_crossing(log, first_column, curl, smallest_curl, length, half_width, utilization, crosses):
    """Find the lanes in which links that are no neighbors may use up most of all that the robot offers.

    Nothing is left out, apart from rounding: see `laticauda.trials.feasibility.link_overlap`.

    Args:
        log: Log of a block.
        first_column: Column of the angle of the first joint of the body in the log.
        curl: Largest difference in direction between two links, as from `scan_joints` [rad].
        smallest_curl: Curl below which no link crosses another, of each lane [rad].
        length: Lengths of the links of each lane [m].
        half_width: Half of their widths [m].
        utilization: Utilization of each lane by everything else [-].
        crosses: Receives whether links may cross, of each lane.
    """
    n_samples = log.shape[0]
    for lane in range(N_LANES):
        crosses[lane] = False
        if curl[n_samples, lane] < smallest_curl[lane]:
            continue
        n_curled = 0
        for sample in range(n_samples):
            n_curled += curl[sample, lane] >= smallest_curl[lane]
        stride = max(1, math.ceil(n_curled / MOST_POSTURES))
        samples = np.empty(n_curled, dtype=np.int64)
        n_chosen = 0
        n_seen = 0
        for sample in range(n_samples):
            if curl[sample, lane] >= smallest_curl[lane]:
                if n_seen % stride == 0:
                    samples[n_chosen] = sample
                    n_chosen += 1
                n_seen += 1
        share = utilization[lane] * (1.0 - ROUNDING_OF_SHARES)
        angles = log[:, first_column : first_column + length.shape[1] - 1, lane]
        crosses[lane] = may_cross(angles, samples[:n_chosen], length[lane], half_width[lane], share)


@kernel
def may_cross(angles, samples, length, half_width, share):
    """Return whether links that are no neighbors may use up more than a share of the room between them."""
    n_links = length.size
    cos = np.empty(n_links)
    sin = np.empty(n_links)
    x = np.empty(n_links)
    y = np.empty(n_links)
    squared_reach = np.empty((n_links, n_links))
    for one in range(n_links):
        for other in range(one + 2, n_links):
            # The gap along an axis of two rectangles that are apart is at least a certain share of
            # their distance.
            largest_gap = (1.0 - share) * (half_width[one] + half_width[other])
            reach = (
                math.hypot(0.5 * length[one], half_width[one])
                + math.hypot(0.5 * length[other], half_width[other])
                + max(largest_gap, 0.0) / SMALLEST_SHARE_OF_DISTANCE
            )
            squared_reach[one, other] = reach * reach
    for sample in samples:
        direction = 0.0
        end_x = 0.0
        end_y = 0.0
        for link in range(n_links):
            if link > 0:
                direction += angles[sample, link - 1]
            cos[link] = math.cos(direction)
            sin[link] = math.sin(direction)
            x[link] = end_x + 0.5 * length[link] * cos[link]
            y[link] = end_y + 0.5 * length[link] * sin[link]
            end_x += length[link] * cos[link]
            end_y += length[link] * sin[link]
        for one in range(n_links):
            for other in range(one + 2, n_links):
                offset_x = x[other] - x[one]
                offset_y = y[other] - y[one]
                if offset_x * offset_x + offset_y * offset_y > squared_reach[one, other]:
                    continue
                gap = max(
                    gap_along_axes(offset_x, offset_y, cos, sin, length, half_width, one, other),
                    gap_along_axes(offset_x, offset_y, cos, sin, length, half_width, other, one),
                )
                if 1.0 - gap / (half_width[one] + half_width[other]) >= share:
                    return True
    return False


@kernel
def gap_along_axes(offset_x, offset_y, cos, sin, length, half_width, own, facing):
    """Return the larger gap between two links along the axes of one of them, negative where they overlap [m]."""
    cos_between = abs(cos[own] * cos[facing] + sin[own] * sin[facing])
    sin_between = abs(cos[own] * sin[facing] - sin[own] * cos[facing])
    along = abs(offset_x * cos[own] + offset_y * sin[own])
    across = abs(offset_y * cos[own] - offset_x * sin[own])
    extent_along = 0.5 * (length[own] + length[facing] * cos_between)
    extent_along += half_width[facing] * sin_between
    extent_across = half_width[own] + half_width[facing] * cos_between
    extent_across += 0.5 * length[facing] * sin_between
    return max(along - extent_along, across - extent_across)
