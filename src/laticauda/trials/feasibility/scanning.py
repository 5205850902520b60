"""Utilization of many runs from the peaks of their joints, for which no log is needed any more.

A pass over the log that is made elsewhere, in compiled code, finds the peaks; here is what it needs to
know of a robot, and what follows from what it finds.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.robot import Robot
from laticauda.trials.feasibility.actuators import Offer
from laticauda.trials.feasibility.link_overlap import (
    SHARPEST_BEND,
    find_smallest_crossing_curl,
    measure_neighbor_overlap,
    measure_room_of_neighbors,
)

_ROUNDING = 1e-9
"""Relative error of a share that is computed only to see whether it may be the largest [-]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ScanLimits:
    """What a pass over the log of a robot's joints compares with, one number per driven joint."""

    robot: Robot
    """The robot, in its planar form."""
    stall_torque: Float[np.ndarray, " n_driven"]
    """Torque at standstill [N m]."""
    duty_per_rate: Float[np.ndarray, " n_driven"]
    """Duty that friction and back-EMF need per rate [s/rad]."""
    joint_limit: Float[np.ndarray, " n_driven"]
    """Largest angle [rad]."""
    no_load_speed: Float[np.ndarray, " n_driven"]
    """Rate without load [rad/s]."""
    has_dry_friction: bool
    """Whether the duty also depends on dry friction, which such a pass leaves out."""
    smallest_crossing_curl: float
    """Difference in direction below which no link can cross another [rad]."""
    size_of_neighbors: Float[np.ndarray, " n_joints"]
    """Half width of neighboring links per half length, for every joint of the body [-]."""
    length: Float[np.ndarray, " n_links"]
    """Lengths of the links [m]."""
    half_width: Float[np.ndarray, " n_links"]
    """Half of their widths [m]."""

    @classmethod
    def of(cls, robot: Robot) -> "ScanLimits":
        """Return the limits of a robot.

        Args:
            robot: The robot, in its planar form.
        """
        offer = Offer.of([robot])
        duty_of_friction = offer.viscous_friction / offer.stall_torque
        duty_per_rate = duty_of_friction + 1.0 / offer.no_load_speed
        lengths = [module.length for module in robot.modules]
        half_widths = [module.section.half_width for module in robot.modules]
        size_of_neighbors: list[float] = []
        for joint in range(robot.n_joints):
            half_size, half_length = measure_room_of_neighbors(robot, joint)
            size_of_neighbors.append(half_size / half_length)
        return cls(
            robot=robot,
            stall_torque=offer.stall_torque[:, 0],
            duty_per_rate=duty_per_rate[:, 0],
            joint_limit=offer.joint_limit[:, 0],
            no_load_speed=offer.no_load_speed[:, 0],
            has_dry_friction=bool(np.any(offer.dry_friction)),
            smallest_crossing_curl=find_smallest_crossing_curl(robot),
            length=np.array(lengths),
            half_width=np.array(half_widths),
            size_of_neighbors=np.array(size_of_neighbors),
        )


def include_neighbors(
    limits: Sequence[ScanLimits],
    utilization: Float[np.ndarray, " n_runs"],
    body_angle: Float[np.ndarray, "n_joints n_runs"],
) -> Float[np.ndarray, " n_runs"]:
    """Return the utilization of many runs, in which neighboring links count that fold over each other.

    Args:
        limits: Limits of each run's robot.
        utilization: Utilization by everything else [-].
        body_angle: Largest angles of the joints of the body [rad].
    """
    largest = utilization.copy()
    first = limits[0]
    size_of_neighbors = first.size_of_neighbors[:, np.newaxis]
    if any(run is not first for run in limits):
        size_of_neighbors = np.stack([run.size_of_neighbors for run in limits], axis=1)
    bend = np.minimum(body_angle, SHARPEST_BEND)
    fold_of_joints = size_of_neighbors * np.tan(0.5 * bend)
    fold = np.max(fold_of_joints, axis=0, initial=0.0)
    # Hardly ever do links fold over each other before something else is used up.
    threshold = utilization * (1.0 - _ROUNDING)
    may_be_largest = fold >= threshold
    for run in map(int, np.flatnonzero(may_be_largest)):
        overlap = measure_neighbor_overlap(limits[run].robot, body_angle[:, run])
        largest[run] = max(largest[run], overlap.share)
    return largest
