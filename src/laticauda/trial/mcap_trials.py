"""Trials as MCAP files: what ROS tools can draw, and everything else of the trial, so that it loads back equal.

The angles, rates and torques of the joints are in the messages of /joint_states, what they were asked for in those of
/joint_reference; every other time series has a topic of its own under /trial. No number is stored twice, but where the
center of mass and the links are is added as poses and transforms for viewers.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from laticauda.errors import StorageFailed, TrialFileError
from laticauda.kinematics import link_centers
from laticauda.trial import flat
from laticauda.trial.layout import variable, variables
from laticauda.trial.mcap import Recorder
from laticauda.trial.recording import Logged, open_recording
from laticauda.trial.trial import Trial

METADATA = "laticauda_trial"
JOINTS, REFERENCE, CENTER, PREFIX = "/joint_states", "/joint_reference", "/center_of_mass", "/trial/"
OF_JOINTS = {
    "joint_angle": (JOINTS, "position"),
    "joint_rate": (JOINTS, "velocity"),
    "joint_torque": (JOINTS, "effort"),
    "joint_angle_ref": (REFERENCE, "position"),
}
"""Time series that are in the messages of joints: topic and field."""


def write_mcap(trial: Trial, path: Path) -> None:
    """Write a trial as an MCAP file of ROS 2 messages, for Foxglove, the ros2 bag tools and `load_trial`.

    Messages are stamped with the time of the trial. If that begins before 0, they all are later by as much; the topic
    /trial/time has it as it is.

    Args:
        trial: Any trial.
        path: The file.

    Raises:
        MissingExtra: If the package `mcap` is not installed.
        OSError: If the file cannot be written.
    """
    try:
        with Recorder(path, chunk_seconds=10.0, overwrite=True) as recorder:
            _record(trial, recorder)
    except StorageFailed as error:
        raise error.__cause__ or error from None  # whoever chose the name of the file says it


def _record(trial: Trial, recorder: Recorder) -> None:
    joints = [f"joint_{i}" for i in range(trial.joint_angle.shape[1])]
    others = [(described, values) for described, values in variables(trial) if described.name not in OF_JOINTS]
    later = max(-float(trial.time[0]), 0.0)
    poses = _Poses(trial)
    recorder.metadata(METADATA, {"trial": flat.text(trial)})
    for k, moment in enumerate(trial.time + later):
        time = float(moment)
        recorder.joint_state(JOINTS, time, joints, trial.joint_angle[k], trial.joint_rate[k], trial.joint_torque[k])
        recorder.joint_state(REFERENCE, time, joints, trial.joint_angle_ref[k])
        recorder.pose(CENTER, time, *poses.center(k))
        recorder.transforms(time, poses.links(k))
        for described, values in others:
            if values.ndim == 1:
                recorder.scalar(PREFIX + described.name, time, float(values[k]), described.units)
            else:
                labels = described.dimensions[1:]
                recorder.array(PREFIX + described.name, time, values[k], described.units, labels)


def read_mcap(path: Path) -> Trial:
    """The trial in an MCAP file, equal to what was written.

    Args:
        path: The file.

    Raises:
        MissingExtra: If the package `mcap` is not installed.
        TrialFileError: If it is no MCAP file, is not whole, or is a recording and no trial.
        KeyError: If something is missing from it.
        ValueError: If what it says is no trial.
    """
    recording = open_recording(path)
    if METADATA not in recording.metadata:
        raise TrialFileError(f"Cannot load {path}: it is a recording, but no trial of laticauda.")
    if recording.lost:
        raise TrialFileError(f"Cannot load {path}: {recording.lost}")
    found: dict[str, list[Any]] = {}
    for message in recording.messages():
        for name, values in _series(message):
            found.setdefault(name, []).append(values)

    def read(name: str) -> Any:
        return np.array(found[name]).reshape(len(found[name]), *_shape(found[name], name))

    return flat.read_back(read, recording.metadata[METADATA]["trial"])


def _series(message: Logged) -> list[tuple[str, Any]]:
    """What one message has of which time series."""
    if message.topic.startswith(PREFIX):
        data = message.content["data"]
        if message.kind == "std_msgs/Float64MultiArray":
            data = data.reshape([one["size"] for one in message.content["layout"]["dim"]])
        return [(message.topic.removeprefix(PREFIX), data)]
    return [(name, message.content[field]) for name, (topic, field) in OF_JOINTS.items() if topic == message.topic]


def _shape(rows: list[Any], name: str) -> tuple[int, ...]:
    return () if variable(name).dimensions == ("time",) else rows[0].shape


class _Poses:
    """Where a viewer is to draw the robot."""

    def __init__(self, trial: Trial) -> None:
        self._trial = trial
        self._is_planar = trial.center_of_mass.shape[1] == 2
        height = np.zeros((trial.time.size, 1))
        self._center = np.hstack((trial.center_of_mass, height))[:, :3]
        self._links = None
        if self._is_planar and "link_angle" not in trial.not_measured:
            middle = link_centers(trial.robot.planar(), trial.center_of_mass, trial.link_angle)
            self._links = np.concatenate((middle, np.zeros((*middle.shape[:2], 1))), axis=2)

    def center(self, k: int) -> tuple[Any, tuple[float, ...]]:
        """Place and orientation of the whole robot: its center of mass and heading."""
        return self._center[k], _turned(float(self._trial.heading[k]))

    def links(self, k: int) -> dict[str, tuple[Any, tuple[float, ...]]]:
        """Middle and direction of every link; of a trial in space, or without links, the whole robot's only."""
        frames = {"robot": self.center(k)}
        if self._links is not None:
            angles = self._trial.link_angle[k]
            frames |= {f"link_{i}": (self._links[k, i], _turned(float(a))) for i, a in enumerate(angles)}
        return frames


def _turned(angle: float) -> tuple[float, float, float, float]:
    """A turn about the vertical axis as w, x, y, z."""
    return float(np.cos(0.5 * angle)), 0.0, 0.0, float(np.sin(0.5 * angle))
