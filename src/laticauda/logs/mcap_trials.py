"""Trials as MCAP files: what ROS tools can draw, and everything else of the trial, so that it loads back equal.

The angles, rates and torques of the joints are in the messages of /joint_states, what they were asked for in those of
/joint_reference; every other time series has a topic of its own under /trial. No number is stored twice, but where the
center of mass and the links are is added as poses and transforms for viewers.
"""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from laticauda.errors import StorageFailed, TrialFileError
from laticauda.kinematics import link_centers
from laticauda.logs.recorder import Recorder
from laticauda.logs.recording import Logged, open_recording
from laticauda.trial import Format, Trial
from laticauda.trial.dataset import assembled, variable

if TYPE_CHECKING:
    import xarray

METADATA = "laticauda_trial"
JOINTS, REFERENCE, CENTER, PREFIX = "/joint_states", "/joint_reference", "/center_of_mass", "/trial/"
OF_JOINTS = {
    "joint_angle": (JOINTS, "position"),
    "joint_rate": (JOINTS, "velocity"),
    "joint_torque": (JOINTS, "effort"),
    "joint_angle_ref": (REFERENCE, "position"),
}
"""Time series that are in the messages of joints: topic and field."""


class McapFile(Format):
    """ROS 2 messages for Foxglove, the ros2 bag tools and `load_trial`.

    They are stamped with the time of the trial. If that begins before 0, they all are later by as much; the topic
    /trial/time has it as it is.
    """

    called: ClassVar[str] = "mcap"
    title: ClassVar[str] = "MCAP, ROS 2"

    @staticmethod
    def write(dataset: "xarray.Dataset", path: Path) -> None:
        """Write a trial as an MCAP file; see `Format.write`."""
        try:
            with Recorder(path, chunk_seconds=10.0, overwrite=True) as recorder:
                _record(dataset, recorder)
        except StorageFailed as error:
            raise error.__cause__ or error from None  # whoever chose the name of the file says it

    @staticmethod
    def read(path: Path) -> "xarray.Dataset":
        """The trial in an MCAP file; see `Format.read`."""
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
            rows = found[name]
            shape = () if variable(name).dimensions == ("time",) else rows[0].shape
            return np.array(rows).reshape(len(rows), *shape)

        return assembled(read, json.loads(recording.metadata[METADATA]["trial"]))


def _record(dataset: "xarray.Dataset", recorder: Recorder) -> None:
    trial = Trial.from_dataset(dataset)
    joints = [f"joint_{i}" for i in range(trial.joint_angle.shape[1])]
    series = {str(name): one for name, one in dataset.variables.items() if one.dims[:1] == ("time",)}
    others = {PREFIX + name: one for name, one in series.items() if name not in OF_JOINTS}
    later = max(-float(trial.time[0]), 0.0)
    poses = _Poses(trial)
    recorder.metadata(METADATA, {"trial": json.dumps(dataset.attrs)})
    for k, moment in enumerate(trial.time + later):
        time = float(moment)
        recorder.joint_state(JOINTS, time, joints, trial.joint_angle[k], trial.joint_rate[k], trial.joint_torque[k])
        recorder.joint_state(REFERENCE, time, joints, trial.joint_angle_ref[k])
        recorder.pose(CENTER, time, *poses.center(k))
        recorder.transforms(time, poses.links(k))
        for topic, one in others.items():
            if one.ndim == 1:
                recorder.scalar(topic, time, float(one.values[k]), one.attrs["units"])
            else:
                recorder.array(topic, time, one.values[k], one.attrs["units"], [str(of) for of in one.dims[1:]])


def _series(message: Logged) -> list[tuple[str, Any]]:
    """What one message has of which time series."""
    if message.topic.startswith(PREFIX):
        data = message.content["data"]
        if message.kind == "std_msgs/Float64MultiArray":
            data = data.reshape([one["size"] for one in message.content["layout"]["dim"]])
        return [(message.topic.removeprefix(PREFIX), data)]
    return [(name, message.content[field]) for name, (topic, field) in OF_JOINTS.items() if topic == message.topic]


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
