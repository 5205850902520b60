"""The run as the model swims it: its joints under the law of the modules, driven by the references that were sent."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.control.estimation import Estimate, ReferenceSample
from laticauda.models.dynamics import Plant
from laticauda.motion import gaits
from laticauda.scenarios import Command, Start
from laticauda.values import Log

STILL = gaits.Gait(amplitude=0.0, frequency=0.0, phase_shift=0.0)
"""Gait of a command whose references are given instead."""


@dataclass(frozen=True, kw_only=True)
class ModelRun:
    """The model's motion, at every tick but the first at which references were sent."""

    time: Float[np.ndarray, " n_ticks"]
    """Times of the ticks [s]."""
    joint_angle: Float[np.ndarray, "n_ticks n_driven"]
    """Angles of the yaw joints, followed by that of a driven fin [rad]."""
    center_of_mass: Float[np.ndarray, "n_ticks 2"]
    """Position of the center of mass [m]."""
    heading: Float[np.ndarray, " n_ticks"]
    """Heading [rad]."""
    marker_link_angle: Float[np.ndarray, " n_ticks"]
    """Angle of the link that carries the marker body [rad]."""


def swim_model(
    plant: Plant[Any],
    start: Estimate,
    references: Sequence[ReferenceSample],
    driven_columns: Sequence[int],
    marker_link: int,
) -> ModelRun | None:
    """Send the references of a run to the model; None if the simulation fails.

    Args:
        plant: The robot in its water, with the joint law of its modules.
        start: First estimate of the run, from which the model starts.
        references: References that were sent.
        driven_columns: Columns of these references that drive the plant's joints.
        marker_link: Link that carries the marker body.
    """
    x, y = start.center_of_mass.tolist()
    state = plant.init(Start(center_of_mass=(x, y), heading=start.heading), Command(gait=STILL))
    joint_angle: list[np.ndarray] = []
    center_of_mass: list[np.ndarray] = []
    heading: list[float] = []
    marker_link_angle: list[float] = []
    for reference, following in pairwise(references):
        interval = following.time - reference.time
        command = _command(reference, driven_columns)
        state, log, failure = plant.march(state, command, interval, interval)
        if failure is not None:
            return None
        joint_angle.append(_driven_joint_angle(log))
        center_of_mass.append(log.center_of_mass[-1, :2])
        heading.append(log.heading[-1])
        marker_link_angle.append(log.link_angle[-1, marker_link])
    return ModelRun(
        time=np.array([reference.time for reference in references[1:]]),
        joint_angle=np.array(joint_angle),
        center_of_mass=np.array(center_of_mass),
        heading=np.array(heading),
        marker_link_angle=np.array(marker_link_angle),
    )


def _command(reference: ReferenceSample, driven_columns: Sequence[int]) -> Command:
    """Return the command that sends one set of references to the plant."""
    angles = tuple(reference.angle[driven_columns].tolist())
    return Command(gait=STILL, references=angles, enabled=(True,) * len(angles))


def _driven_joint_angle(log: Log) -> Float[np.ndarray, " n_driven"]:
    """Return the last joint angles of a log, followed by that of a driven fin [rad]."""
    joint_angle = log.joint_angle[-1]
    if "fin_angle_0" not in log.signals:
        return np.append(joint_angle, [])
    return np.append(joint_angle, log.signals["fin_angle_0"][-1])
