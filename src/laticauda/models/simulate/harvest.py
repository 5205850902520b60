"""What is taken from the log of a block right after it was computed, in compiled code (a template).

The formulas are those of `batch_figures.sample_block` and of `laticauda.trials.feasibility`, to the last
bit.
"""

# pyright: basic
# pyright: reportCallIssue=false
# ruff: noqa: N803

import math

import numpy as np

from laticauda.compiling import entry, kernel, lane_types
from laticauda.compiling.lanes import magnitude, where
from laticauda.compiling.templates import bindings
from laticauda.models.planar.rows import HEADING, N_WORKS, TIME, VX, WORK_ABSOLUTE, X

_specialization = bindings(__name__)
N_LANES = _specialization["n_lanes"]
"""Runs of a block."""
MOST_POSTURES = _specialization["most_postures"]
"""Postures that are checked for crossing links in each run."""
as_rows = lane_types.rows_of(N_LANES)
"""Interprets an array as rows with a number per lane."""
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
def fill_lanes(rows_of_base, offset_of_base, waves, filtered, first_command, index, S):
    """Write the rows of runs that are copies of one base, apart from their waves.

    Args:
        rows_of_base: Rows of the base.
        offset_of_base: What its command adds to the last number of a wave [rad].
        waves: One column per run of the batch.
        filtered: Rows of the state that begin with the first numbers of a wave.
        first_command: First row of a wave.
        index: Index of each lane's run in the batch; the last one also fills what lanes are left.
        S: Receives the rows.
    """
    for row in range(rows_of_base.size):
        for lane in range(N_LANES):
            S[row, lane] = rows_of_base[row]
    n_numbers = waves.shape[0]
    for lane in range(N_LANES):
        run = index[min(lane, index.size - 1)]
        for number in range(n_numbers):
            S[first_command + number, lane] = waves[number, run]
        for number in range(filtered.size):
            S[filtered[number], lane] = waves[number, run]
        S[first_command + n_numbers - 1, lane] += offset_of_base


@entry
def find_peaks(
    log,
    block,
    columns,
    first,
    stall_torque,
    duty_per_rate,
    joint_limit,
    no_load_speed,
    n_joints,
    length,
    half_width,
    smallest_curl,
    peaks,
    curl,
    utilization,
    crosses,
):
    """Find the peaks of every driven joint of a block, and the lanes in which links may cross.

    Args:
        log: Log of the block.
        block: Its index. All that has an axis for the lanes also has one for the blocks before it,
            but for `curl` and `crosses`, which belong to one block at a time.
        columns: Columns of angles, rates and torques of the driven joints in the log.
        first: First sample that counts.
        stall_torque: Of the driven joints [N m].
        duty_per_rate: Of the driven joints [s/rad].
        joint_limit: Of the driven joints [rad].
        no_load_speed: Of the driven joints [rad/s].
        n_joints: Number of joints of the body.
        length: Lengths of the links [m].
        half_width: Half of their widths [m].
        smallest_curl: Curl below which no link crosses another [rad].
        peaks: Receives the peaks.
        curl: Receives the curl [rad].
        utilization: Receives the utilization [-].
        crosses: Receives whether links may cross.
    """
    scan_joints(
        log,
        columns,
        first[block],
        stall_torque[block],
        duty_per_rate[block],
        joint_limit[block],
        no_load_speed[block],
        n_joints,
        peaks[block],
        curl,
        utilization[block],
    )
    find_crossing(
        log,
        columns[0, 0],
        curl,
        smallest_curl[block],
        length[block],
        half_width[block],
        utilization[block],
        crosses,
    )
    for lane in range(N_LANES):
        if crosses[lane]:
            return True
    return False


@kernel
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
        first: First sample of each lane that counts, as a float.
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
    n_samples, n_rows, _ = log.shape
    n_driven = columns.shape[1]
    of_log, of_peaks, of_curl = as_rows(log), as_rows(peaks), as_rows(curl)
    of_stall, of_duty, of_first = as_rows(stall_torque), as_rows(duty_per_rate), as_rows(first)
    first_of_all = int(first.min())
    nothing = 0.0 * of_stall[0]
    largest_curl = nothing
    peaks[:] = 0.0
    curl[:first_of_all] = 0.0
    for sample in range(first_of_all, n_samples):
        counts = of_first[0] <= sample
        direction = nothing
        leftmost = nothing
        rightmost = nothing
        for joint in range(n_driven):
            angle = of_log[sample * n_rows + columns[0, joint]]
            rate = of_log[sample * n_rows + columns[1, joint]]
            torque = of_log[sample * n_rows + columns[2, joint]]
            # A product is selected before it is added, and thus rounded as it is in NumPy.
            added_duty = where(counts, rate * of_duty[joint], 0.0)
            share = torque / of_stall[joint] + added_duty
            driven_rate = where(rate * torque < 0.0, 0.0, rate)
            keep_larger(of_peaks, ANGLE * n_driven + joint, angle, counts)
            keep_larger(of_peaks, RATE * n_driven + joint, rate, counts)
            keep_larger(of_peaks, TORQUE * n_driven + joint, torque, counts)
            keep_larger(of_peaks, DUTY * n_driven + joint, share, counts)
            keep_larger(of_peaks, DRIVEN_RATE * n_driven + joint, driven_rate, counts)
            if joint < n_joints:
                direction = direction + angle
                leftmost = max(leftmost, direction)
                rightmost = min(rightmost, direction)
        bend = where(counts, leftmost - rightmost, 0.0)
        of_curl[sample] = bend
        largest_curl = max(largest_curl, bend)
    of_curl[n_samples] = largest_curl
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
def keep_larger(of_peaks, row, value, counts):
    """Keep the magnitude of a value that counts, if it is larger than those before."""
    of_peaks[row] = max(where(counts, magnitude(value), 0.0), of_peaks[row])


@kernel
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
