"""Trials as MCAP files: what ROS tools can draw, and everything else of the trial, so that it loads back equal.

The angles, rates and torques of the joints are in the messages of /joint_states, what they were asked for in those of
/joint_reference; every other time series has a topic of its own under /trial. No number is stored twice, but where the
center of mass and the links are is added as poses and transforms for viewers.
"""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from laticauda.errors import StorageFailed
from laticauda.kinematics import Posture
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
            raise ValueError("it is a recording, but no trial of laticauda.")
        if recording.lost:
            raise ValueError(recording.lost)
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
    names, places, turns = _frames(trial)
    recorder.metadata(METADATA, {"trial": json.dumps(dataset.attrs)})
    for k, moment in enumerate(trial.time + later):
        time = float(moment)
        recorder.joint_state(JOINTS, time, joints, trial.joint_angle[k], trial.joint_rate[k], trial.joint_torque[k])
        recorder.joint_state(REFERENCE, time, joints, trial.joint_angle_ref[k])
        recorder.pose(CENTER, time, places[k, 0], turns[k, 0])
        recorder.transforms(time, dict(zip(names, zip(places[k], turns[k], strict=True), strict=True)))
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


def _frames(trial: Trial) -> tuple[list[str], Any, Any]:
    """Where a viewer is to draw the robot, and the links of a planar one: names, places, turns (w, x, y, z)."""
    places, angles = trial.center_of_mass[:, np.newaxis], trial.heading[:, np.newaxis]
    if places.shape[2] == 2:
        if "link_angle" not in trial.not_measured:
            links = Posture(trial.robot.planar(), trial.center_of_mass, trial.link_angle).link_centers
            places, angles = np.concatenate((places, links), axis=1), np.hstack((angles, trial.link_angle))
        places = np.concatenate((places, np.zeros((*places.shape[:2], 1))), axis=2)
    level = np.zeros_like(angles)
    turns = np.stack((np.cos(0.5 * angles), level, level, np.sin(0.5 * angles)), axis=2)
    return ["robot", *(f"link_{i}" for i in range(angles.shape[1] - 1))], places, turns
