"""Trials as MCAP files: data that ROS tools can draw, plus everything else in the trial, so that it loads back equal.

Angles, rates and torques of the joints are in the messages of /joint_states, commanded angles in
those of /joint_reference; every other time series has its own topic under /trial. No number is
stored twice, except that the positions of center of mass and links are added as poses and
transforms for viewers, along with the robot's URDF.
"""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from laticauda.models.spatial import Frames
from laticauda.scenarios import ORIENTATION
from laticauda.trials import Format, Trial
from laticauda.trials.dataset import assembled, describe_series, read_epoch
from laticauda.trials.logs.recorder import WORLD, Frame, Recorder
from laticauda.trials.logs.recording import Logged, open_recording
from laticauda.values import StorageFailed

if TYPE_CHECKING:
    import xarray

METADATA = "laticauda_trial"
"""Metadata record that holds everything in a trial that is no time series, as JSON, under `trial`."""
JOINTS = "/joint_states"
"""Topic with angles, rates and torques of the joints."""
REFERENCE = "/joint_reference"
"""Topic with commanded angles of the joints."""
CENTER = "/center_of_mass"
"""Topic with the pose of the robot, for viewers."""
PREFIX = "/trial/"
"""Begin of the topics of all other time series."""
SECONDS_PER_CHUNK = 10.0
"""Time that a chunk of the file covers [s]."""


class _JointField(NamedTuple):
    """Where a time series of the joints is stored."""

    topic: str
    field: str
    """Field of sensor_msgs/JointState."""


JOINT_FIELDS = {
    "joint_angle": _JointField(topic=JOINTS, field="position"),
    "joint_rate": _JointField(topic=JOINTS, field="velocity"),
    "joint_torque": _JointField(topic=JOINTS, field="effort"),
    "joint_angle_ref": _JointField(topic=REFERENCE, field="position"),
}
"""Time series that are stored in messages of joints."""


class _MovingFrame(NamedTuple):
    """A frame at every sample; the fields are those of `recorder.Frame`."""

    parent: str
    position: Any
    """x, y, z in the axes of the parent, one row per sample [m]."""
    quaternion: Any
    """Orientation w, x, y, z, one row per sample [-]."""

    def at(self, sample: int) -> Frame:
        """Return the frame at one sample."""
        return self.parent, self.position[sample], self.quaternion[sample]


class _NamedValues(NamedTuple):
    """The values of a time series in one message."""

    name: str
    values: Any


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
                path,
                chunk_seconds=SECONDS_PER_CHUNK,
                overwrite=True,
                epoch=read_epoch(dataset.attrs),
            ) as recorder:
                _record_trial(dataset, recorder)
        except StorageFailed as error:
            # The caller that chose the file name reports the cause.
            raise (error.__cause__ or error) from None

    @staticmethod
    def read(path: Path) -> "xarray.Dataset":
        """Read the trial in an MCAP file; see `Format.read`."""
        recording = open_recording(path)
        if METADATA not in recording.metadata:
            raise ValueError("it is a recording, but not a trial of laticauda.")
        if recording.lost:
            raise ValueError(recording.lost)
        rows_by_name: dict[str, list[Any]] = {}
        for message in recording.messages():
            for name, values in _extract_values(message):
                rows_by_name.setdefault(name, []).append(values)

        def read_series(name: str) -> Any:
            rows = rows_by_name[name]
            if describe_series(name).dimensions == ("time",):
                return np.array(rows).reshape(len(rows))
            return np.array(rows).reshape(len(rows), *np.shape(rows[0]))

        return assembled(read_series, json.loads(recording.metadata[METADATA]["trial"]))


def _record_trial(dataset: "xarray.Dataset", recorder: Recorder) -> None:
    trial = Trial.from_dataset(dataset)
    joint_names = [f"joint_{i}" for i in range(trial.joint_angle.shape[1])]
    other_series = {
        PREFIX + str(name): variable
        for name, variable in dataset.variables.items()
        if variable.dims[:1] == ("time",) and name not in JOINT_FIELDS
    }
    link_frames = Frames(trial.robot, trial.scenario.model)
    robot_frame = _frame_of_robot(trial)
    moving_frames = {"robot": robot_frame, **_frames_of_links(trial, link_frames)}
    recorder.metadata(METADATA, {"trial": json.dumps(dataset.attrs)})
    recorder.robot(float(trial.time[0]), link_frames.description, link_frames.fixed)
    for sample, time in enumerate(trial.time.tolist()):
        recorder.joint_state(
            JOINTS,
            time,
            joint_names,
            position=trial.joint_angle[sample],
            velocity=trial.joint_rate[sample],
            effort=trial.joint_torque[sample],
        )
        recorder.joint_state(REFERENCE, time, joint_names, trial.joint_angle_ref[sample])
        recorder.pose(
            CENTER,
            time,
            position=robot_frame.position[sample],
            quaternion=robot_frame.quaternion[sample],
        )
        frames = {name: frame.at(sample) for name, frame in moving_frames.items()}
        recorder.transforms(time, frames)
        for topic, variable in other_series.items():
            _record_values(recorder, topic, time, variable=variable, sample=sample)


def _record_values(
    recorder: Recorder, topic: str, time: float, *, variable: "xarray.Variable", sample: int
) -> None:
    """Record one sample of a time series: a number or an array."""
    values = variable.values[sample]
    unit = variable.attrs["units"]
    if variable.ndim == 1:
        recorder.scalar(topic, time, float(values), unit)
        return
    labels = [str(dimension) for dimension in variable.dims[1:]]
    recorder.array(topic, time, values, unit, labels)


def _extract_values(message: Logged) -> list[_NamedValues]:
    """Return the values of time series in one message."""
    if message.topic.startswith(PREFIX):
        values = message.content["data"]
        if message.kind == "std_msgs/Float64MultiArray":
            shape = [dimension["size"] for dimension in message.content["layout"]["dim"]]
            # Of a robot without joints, no number comes, and not as an array.
            values = np.asarray(values, dtype=float).reshape(shape)
        return [_NamedValues(name=message.topic.removeprefix(PREFIX), values=values)]
    return [
        _NamedValues(name=name, values=message.content[joint_field.field])
        for name, joint_field in JOINT_FIELDS.items()
        if joint_field.topic == message.topic
    ]


def _frame_of_robot(trial: Trial) -> _MovingFrame:
    """Return the frame at the center of mass, rotated by the heading."""
    position = np.zeros((trial.time.size, 3))
    position[:, : trial.center_of_mass.shape[1]] = trial.center_of_mass
    return _MovingFrame(parent=WORLD, position=position, quaternion=_rotate_upright(trial.heading))


def _frames_of_links(trial: Trial, link_frames: Frames) -> dict[str, _MovingFrame]:
    """Return the frames of the links, if they were measured."""
    if "link_angle" in trial.not_measured or "joint_angle" in trial.not_measured:
        return {}
    orientation = _rotate_upright(trial.link_angle[:, 0])
    if all(name in trial.signals for name in ORIENTATION):
        orientation = np.stack([trial.signals[name] for name in ORIENTATION], axis=1)
    frames = link_frames.compute_moving_frames(
        trial.center_of_mass, orientation, trial.joint_angle, trial.fin_angle
    )
    return {name: _MovingFrame(*frame) for name, frame in frames.items()}


def _rotate_upright(angle: Any) -> Any:
    """Return the orientation given by a rotation about the vertical [rad], as quaternions."""
    level = np.zeros_like(angle)
    return np.stack((np.cos(0.5 * angle), level, level, np.sin(0.5 * angle)), axis=1)
