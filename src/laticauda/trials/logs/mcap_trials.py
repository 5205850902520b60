"""Trials as MCAP files: data that ROS tools can draw, plus everything else in the trial, so that it loads back equal.

Angles, rates and torques of the joints are in the messages of /joint_states, commanded angles in
those of /joint_reference; every other time series has its own topic under /trial. No number is
stored twice, except that the positions of center of mass and links are added as poses and
transforms for viewers, along with the robot's URDF.
"""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from laticauda.models.spatial import Frames
from laticauda.scenarios import ORIENTATION
from laticauda.trials import Format, Trial
from laticauda.trials.dataset import assembled, describe_series, read_epoch
from laticauda.trials.logs.recorder import WORLD, Recorder
from laticauda.trials.logs.recording import Logged, open_recording
from laticauda.values import StorageFailed

if TYPE_CHECKING:
    import xarray

METADATA = "laticauda_trial"
JOINTS, REFERENCE, CENTER, PREFIX = (
    "/joint_states",
    "/joint_reference",
    "/center_of_mass",
    "/trial/",
)
OF_JOINTS = {
    "joint_angle": (JOINTS, "position"),
    "joint_rate": (JOINTS, "velocity"),
    "joint_torque": (JOINTS, "effort"),
    "joint_angle_ref": (REFERENCE, "position"),
}
"""Time series stored in joint messages: topic and field."""


class McapFile(Format):
    """ROS 2 messages for Foxglove, the ros2 bag tools and `load_trial`.

    Time 0 of the trial is its wall-clock creation time; for an operated run, the recorded start.
    The topic /trial/time has the trial's own time.
    """

    called: ClassVar[str] = "mcap"
    title: ClassVar[str] = "MCAP, ROS 2"

    @staticmethod
    def write(dataset: "xarray.Dataset", path: Path) -> None:
        """Write a trial as an MCAP file; see `Format.write`."""
        try:
            with Recorder(
                path, chunk_seconds=10.0, overwrite=True, epoch=read_epoch(dataset.attrs)
            ) as recorder:
                _record(dataset, recorder)
        except StorageFailed as error:
            raise (
                error.__cause__ or error
            ) from None  # the caller that chose the file name reports it

    @staticmethod
    def read(path: Path) -> "xarray.Dataset":
        """Read the trial in an MCAP file; see `Format.read`."""
        recording = open_recording(path)
        if METADATA not in recording.metadata:
            raise ValueError("it is a recording, but not a trial of laticauda.")
        if recording.lost:
            raise ValueError(recording.lost)
        found: dict[str, list[Any]] = {}
        for message in recording.messages():
            for name, values in _series(message):
                found.setdefault(name, []).append(values)

        def read(name: str) -> Any:
            rows = found[name]
            shape = () if describe_series(name).dimensions == ("time",) else rows[0].shape
            return np.array(rows).reshape(len(rows), *shape)

        return assembled(read, json.loads(recording.metadata[METADATA]["trial"]))


def _record(dataset: "xarray.Dataset", recorder: Recorder) -> None:
    trial = Trial.from_dataset(dataset)
    joints = [f"joint_{i}" for i in range(trial.joint_angle.shape[1])]
    series = {
        str(name): one for name, one in dataset.variables.items() if one.dims[:1] == ("time",)
    }
    others = {PREFIX + name: one for name, one in series.items() if name not in OF_JOINTS}
    bodies = Frames(trial.robot, trial.scenario.model)
    frames = {"robot": _robot(trial)} | _links(trial, bodies)
    recorder.metadata(METADATA, {"trial": json.dumps(dataset.attrs)})
    recorder.robot(float(trial.time[0]), bodies.description, bodies.fixed)
    for k, time in enumerate(trial.time.tolist()):
        recorder.joint_state(
            JOINTS, time, joints, trial.joint_angle[k], trial.joint_rate[k], trial.joint_torque[k]
        )
        recorder.joint_state(REFERENCE, time, joints, trial.joint_angle_ref[k])
        at = {
            name: (parent, places[k], turns[k]) for name, (parent, places, turns) in frames.items()
        }
        recorder.pose(CENTER, time, *at["robot"][1:])
        recorder.transforms(time, at)
        for topic, one in others.items():
            if one.ndim == 1:
                recorder.scalar(topic, time, float(one.values[k]), one.attrs["units"])
            else:
                recorder.array(
                    topic, time, one.values[k], one.attrs["units"], [str(of) for of in one.dims[1:]]
                )


def _series(message: Logged) -> list[tuple[str, Any]]:
    """Return the time series found in one message, as names and values."""
    if message.topic.startswith(PREFIX):
        data = message.content["data"]
        if message.kind == "std_msgs/Float64MultiArray":
            data = data.reshape([one["size"] for one in message.content["layout"]["dim"]])
        return [(message.topic.removeprefix(PREFIX), data)]
    return [
        (name, message.content[field])
        for name, (topic, field) in OF_JOINTS.items()
        if topic == message.topic
    ]


def _robot(trial: Trial) -> tuple[str, Any, Any]:
    """Return the frame at the center of mass, rotated by the heading."""
    places = np.zeros((trial.time.size, 3))
    places[:, : trial.center_of_mass.shape[1]] = trial.center_of_mass
    return WORLD, places, _upright(trial.heading)


def _links(trial: Trial, bodies: Frames) -> dict[str, tuple[str, Any, Any]]:
    """Return the frames of the links, if they were measured."""
    if {"link_angle", "joint_angle"} & {*trial.not_measured}:
        return {}
    turns = _upright(trial.link_angle[:, 0])
    if all(name in trial.signals for name in ORIENTATION):
        turns = np.stack([trial.signals[name] for name in ORIENTATION], axis=1)
    return bodies.moving(trial.center_of_mass, turns, trial.joint_angle, trial.fin_angle)


def _upright(angle: Any) -> Any:
    """Return the orientation given by a rotation about the vertical, as quaternions."""
    level = np.zeros_like(angle)
    return np.stack((np.cos(0.5 * angle), level, level, np.sin(0.5 * angle)), axis=1)
