"""A trial from a film: path, heading and joint angles, with gaps said."""

from dataclasses import replace

import numpy as np

from laticauda.film.tracking.body import BodyTrack
from laticauda.motion.gaits import Gait, JointAngles, lateral_undulation, recorded_gait
from laticauda.robot import Environment, Robot, kinematics
from laticauda.trials import Trial
from laticauda.trials.logs import (
    ColumnMap,
    Heading,
    JointColumns,
    Position,
    TimeColumn,
    build_measured_trial,
)
from laticauda.values import BadArgument
from laticauda.values.tables import Table

X, Y, YAW, TIME = "x", "y", "heading", "time"
JOINT = "joint {}"
"""Names of columns of the table that a trial is built from."""


def build_trial(
    track: BodyTrack,
    robot: Robot,
    environment: Environment,
    *,
    gait: Gait | None = None,
    start: float | None = None,
    stop: float | None = None,
    longest_gap: float = 0.2,
    smoothing: float = 0.2,
) -> Trial:
    """Return a measured trial.

    Args:
        track: The body in every frame.
        robot: What swam.
        environment: What it was in.
        gait: Commanded gait; None: the joint angles that were seen.
        start: Time in the film at which the trial begins; None: its first frame [s].
        stop: Time in the film at which it ends; None: its last frame [s].
        longest_gap: Gaps up to this long are filled by straight lines [s].
        smoothing: Rates are slopes of cubic fits over this time [s].

    Raises:
        ValueError: If a gap is longer, or the motion is none of this robot.
    """
    begin, end = _span_of_trial(track, start, stop)
    joint_angle = kinematics.joint_angles(track.link_angle)
    columns: dict[str, np.ndarray | str] = {
        TIME: track.time,
        X: track.center_of_mass[:, 0],
        Y: track.center_of_mass[:, 1],
        YAW: kinematics.heading(track.link_angle),
    }
    for i, angle in enumerate(joint_angle.T):
        columns[JOINT.replace("{}", str(i))] = angle
    joints = None
    if joint_angle.shape[1]:
        joints = JointColumns(columns=JOINT)
    column_map = ColumnMap(
        robot=robot,
        environment=environment,
        gait=gait,
        start=begin,
        stop=end,
        longest_gap=longest_gap,
        smoothing=smoothing,
        time=TimeColumn(column=TIME),
        center_of_mass=Position(position=(X, Y)),
        heading=Heading(column=YAW),
        joint_angle=joints,
    )
    trial = build_measured_trial(Table(columns=columns), column_map, source=track.points.source)
    if gait is None:
        trial = replace(trial, scenario=replace(trial.scenario, gait=_gait_seen(trial)))
    return replace(trial, status=" ".join([trial.status, *track.notes, *_describe_cut(track)]))


def _gait_seen(trial: Trial) -> Gait:
    """Return the motion of the joints as it was seen; that of a body that holds straight has no frequency."""
    if not np.any(trial.joint_angle):
        return lateral_undulation(amplitude=0.0, frequency=0.0, phase_shift=0.0)
    return recorded_gait(JointAngles.of(trial))


def _span_of_trial(
    track: BodyTrack, start: float | None, stop: float | None
) -> tuple[float, float]:
    """Return when a trial begins and ends: as asked for, within the time in which the body was seen [s]."""
    begin, end = _seen_from_to(track)
    if start is not None:
        if start >= end:
            rule = f"must be before the body was last seen, at {end:.4g} s"
            raise BadArgument("start", f"{rule}, got {start:g} s")
        begin = max(begin, start)
    if stop is not None:
        if stop <= begin:
            rule = f"must be after the trial begins, at {begin:.4g} s"
            raise BadArgument("stop", f"{rule}, got {stop:g} s")
        end = min(end, stop)
    return begin, end


def _seen_from_to(track: BodyTrack) -> tuple[float, float]:
    """Return the times of the first and the last frame in which the whole body was seen [s]."""
    is_seen = np.isfinite(track.center_of_mass).all(axis=1)
    is_seen &= np.isfinite(track.link_angle).all(axis=1)
    if np.count_nonzero(is_seen) < 2:
        raise ValueError("the whole body must be seen in two frames at least.")
    seen_frames = np.flatnonzero(is_seen)
    return float(track.time[seen_frames[0]]), float(track.time[seen_frames[-1]])


def _describe_cut(track: BodyTrack) -> list[str]:
    begin, end = _seen_from_to(track)
    if begin == track.time[0] and end == track.time[-1]:
        return []
    return [f"The whole body was seen from {begin:.2f} s to {end:.2f} s of the film."]
