"""A recorded run, cut into cycles of the gait, beside the same run by the model."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Float
from numpy.typing import ArrayLike

from laticauda.control.estimation import Estimate, JointSample, Mount, PoseSample, ReferenceSample
from laticauda.models.dynamics import Plant
from laticauda.robot import Robot
from laticauda.tank.operate.recording.entries import Event
from laticauda.tank.operate.recording.log import OperationLog
from laticauda.tank.operate.verdict.model_run import ModelRun, swim_model
from laticauda.tank.operate.verdict.signals import MEDIAN_LENGTH, running_median
from laticauda.trials.logs import interpolate_columns

PERIOD_WITHOUT_GAIT = 2.0
"""Length of a cycle if the references have no frequency [s]."""
POINTS_PER_CYCLE = 100
"""Points at which a cycle is evaluated, both ends included."""
PERIOD_ROUNDING = 1e-6
"""Share of a cycle that may be missing from the last one: it counts as whole if the run ended with
its last sample."""


@dataclass(frozen=True)
class Cycles:
    """The whole cycles of a run."""

    period: float
    """Length of a cycle [s]."""
    ends: Float[np.ndarray, " n_cycles"]
    """Time at which each cycle ended [s]."""

    def __len__(self) -> int:
        """Return the number of whole cycles."""
        return len(self.ends)

    @property
    def points(self) -> Float[np.ndarray, "n_cycles n_points"]:
        """Times at which every cycle is evaluated [s]."""
        phase = np.linspace(0.0, 1.0, POINTS_PER_CYCLE)
        return self.ends[:, np.newaxis] - self.period + self.period * phase

    def resample(
        self, times: ArrayLike, values: ArrayLike
    ) -> Float[np.ndarray, "n_cycles n_points n_columns"]:
        """Interpolate the columns of a series linearly to the points of every cycle."""
        columns = np.array(values, dtype=float).reshape(np.size(times), -1)
        return interpolate_columns(self.points, np.array(times), columns)

    def resample_scalar(
        self, times: ArrayLike, values: ArrayLike
    ) -> Float[np.ndarray, "n_cycles n_points"]:
        """Interpolate a series of numbers linearly to the points of every cycle."""
        return self.resample(times, values)[..., 0]


@dataclass(frozen=True)
class CycleMotion:
    """Motion of a robot as a whole, cycle by cycle."""

    center_of_mass: Float[np.ndarray, "n_cycles n_points n_axes"]
    """Position of the center of mass [m]."""
    heading: Float[np.ndarray, "n_cycles n_points"]
    """Heading [rad]."""

    @cached_property
    def advance(self) -> Float[np.ndarray, " n_steps"]:
        """Way from each cycle's mean position to the next's, along their mean heading [m]."""
        return np.real(self._step_in_body_axes)

    @cached_property
    def sideslip(self) -> Float[np.ndarray, " n_steps"]:
        """Way from each cycle's mean position to the next's, left of their mean heading [m]."""
        return np.imag(self._step_in_body_axes)

    @cached_property
    def turn(self) -> Float[np.ndarray, " n_steps"]:
        """Change of the mean heading from each cycle to the next [rad]."""
        return np.diff(self.heading.mean(axis=1))

    @cached_property
    def _step_in_body_axes(self) -> np.ndarray:
        """Step of the mean position from cycle to cycle: forward is real, left imaginary [m]."""
        position = self.center_of_mass.mean(axis=1) @ np.array([1.0, 1.0j])
        heading = self.heading.mean(axis=1)
        return np.diff(position) * np.exp(-0.5j * (heading[1:] + heading[:-1]))


@dataclass(frozen=True, kw_only=True)
class RecordedRun:
    """What was recorded of a run, and the same run by the model."""

    log: OperationLog
    """The recording, which begins before the run."""
    begin: float
    """Time at which the run began [s]."""
    mount: Mount
    """Mount of the marker body."""
    marker_link: int
    """Link that carries the marker body."""
    driven_columns: Sequence[int]
    """Columns of the joint references that drive yaw joints, followed by that of a driven fin."""
    estimates: Sequence[Estimate]
    """Estimates of the run."""
    joint_samples: Sequence[JointSample]
    """Joint samples of the run."""
    references: Sequence[ReferenceSample]
    """Joint references of the run."""
    marker_poses: Sequence[PoseSample]
    """Poses of the marker body with a rotation, in the order of their times; also those before the
    run."""
    cycles: Cycles
    """Whole cycles of the run."""
    model: ModelRun | None
    """The same run by the model; None: there is none that fits."""

    @classmethod
    def of(cls, log: OperationLog, plant: Plant[Any] | None) -> "RecordedRun":
        """Read a run from its recording, and let the model swim it.

        Args:
            log: The recording.
            plant: The same robot in its water with the joint law of its modules; None: there is no model.
        """
        robot = log.header.run.robot
        mount: Mount = getattr(log.header.estimator, "mount", Mount())
        estimates: list[Estimate] = log.of_run(Estimate)
        joint_samples: list[JointSample] = log.of_run(JointSample)
        references: list[ReferenceSample] = log.of_run(ReferenceSample)
        marker_poses = [pose for pose in log.of(PoseSample) if pose.rotation is not None]
        begin = log.span[0]
        end = begin
        if estimates and references and joint_samples:
            end = joint_samples[-1].time
        cycles = _whole_cycles(begin, end, _period(references))
        driven_columns = _driven_columns(robot)
        marker_link, _ = mount.on_link(robot)
        model = None
        if plant is not None and len(cycles) > 0 and len(references) > 1:
            is_in_plane = estimates[0].center_of_mass.size == 2
            has_same_joints = len(plant.robot.driven_joints) == len(driven_columns)
            if is_in_plane and has_same_joints:
                model = swim_model(plant, estimates[0], references, driven_columns, marker_link)
        return cls(
            log=log,
            begin=begin,
            mount=mount,
            marker_link=marker_link,
            driven_columns=driven_columns,
            estimates=estimates,
            joint_samples=joint_samples,
            references=references,
            marker_poses=sorted(marker_poses, key=lambda pose: pose.time),
            cycles=cycles,
            model=model,
        )

    @property
    def events(self) -> Sequence[Event]:
        """Events of the whole recording."""
        return self.log.of(Event)

    @property
    def comparable_model(self) -> ModelRun | None:
        """The model's run, if cycles and camera frames are enough to compare motion with it."""
        has_frames = len(self.marker_poses) > 2 * MEDIAN_LENGTH
        if len(self.cycles) < 2 or not has_frames:
            return None
        return self.model

    @cached_property
    def estimate_times(self) -> Float[np.ndarray, " n_estimates"]:
        """Times of the estimates [s]."""
        return np.array([estimate.time for estimate in self.estimates])

    @cached_property
    def motion(self) -> CycleMotion:
        """Motion of the robot, cycle by cycle, without single wrong camera frames."""
        center_of_mass = running_median([estimate.center_of_mass for estimate in self.estimates])
        heading = running_median(np.unwrap([estimate.heading for estimate in self.estimates]))
        return CycleMotion(
            center_of_mass=self.cycles.resample(self.estimate_times, center_of_mass),
            heading=self.cycles.resample_scalar(self.estimate_times, heading),
        )

    @cached_property
    def model_motion(self) -> CycleMotion | None:
        """Motion of the model, cycle by cycle; None: it cannot be compared."""
        model = self.comparable_model
        if model is None:
            return None
        return CycleMotion(
            center_of_mass=self.cycles.resample(model.time, model.center_of_mass),
            heading=self.cycles.resample_scalar(model.time, model.heading),
        )


def _period(references: Sequence[ReferenceSample]) -> float:
    """Return the length of a cycle [s]."""
    frequency = max((reference.frequency or 0.0 for reference in references), default=0.0)
    if not frequency:
        return PERIOD_WITHOUT_GAIT
    return 2.0 * math.pi / frequency


def _whole_cycles(begin: float, end: float, period: float) -> Cycles:
    """Return the whole cycles between two times; none if the run has no beginning."""
    if not math.isfinite(begin):
        return Cycles(period=period, ends=np.empty(0))
    n_cycles = int((end - begin) / period + PERIOD_ROUNDING)
    return Cycles(period=period, ends=begin + period * np.arange(1, n_cycles + 1))


def _driven_columns(robot: Robot) -> list[int]:
    """Return the columns of yaw joints among the references, followed by that of a driven fin."""
    yaw_joints = [column for column, joint in enumerate(robot.joints) if joint.axis == "yaw"]
    fin = range(robot.n_joints, len(robot.driven_joints))
    return [*yaw_joints, *fin]
