"""What an estimator says about the robot, and where on the robot the markers sit."""

import math
from dataclasses import dataclass
from typing import Any, Literal, Protocol, TypeAlias, runtime_checkable

import numpy as np
from jaxtyping import Float

from laticauda.errors import BadArgument, instance
from laticauda.estimation.samples import Sample
from laticauda.interfaces import Observation
from laticauda.quantities import quantity, value
from laticauda.robot import Robot
from laticauda.robot.reduction import reduce_to_plane

Status: TypeAlias = Literal["tracking", "bridging", "lost"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Estimate:
    """Where the robot is and how it moves at one instant, in the plane, world axes, tail first."""

    time: float
    """[s]."""
    status: Status
    """`tracking`: motion capture sees the robot; `bridging`: a drop-out is being bridged; `lost`: for too long [-]."""
    age: float
    """Time since the last frame that was accepted [s]."""
    center_of_mass: Float[np.ndarray, " 2"]
    """p [m]."""
    center_of_mass_velocity: Float[np.ndarray, " 2"]
    """p' [m/s]."""
    heading: float
    """Mean link angle (6), unwrapped [rad]."""
    heading_rate: float
    """[rad/s]."""
    link_angle: Float[np.ndarray, " n_links"]
    """theta [rad]."""
    joint_angle: Float[np.ndarray, " n_joints"]
    """phi [rad]."""
    joint_rate: Float[np.ndarray, " n_joints"]
    """phi' [rad/s]."""
    center_of_mass_std: float
    """Standard deviation of p per axis; 0 where the estimator does not know [m]."""
    heading_std: float
    """Of the heading; 0 where the estimator does not know [rad]."""
    current: Float[np.ndarray, " 2"] | None = None
    """Velocity the water moves to; None where it is not estimated [m/s]."""
    current_std: float = 0.0
    """Its standard deviation along its less certain direction [m/s]."""

    def observation(self) -> Observation:
        """What a controller gets of it."""
        return Observation(
            time=self.time,
            center_of_mass=self.center_of_mass,
            center_of_mass_velocity=self.center_of_mass_velocity,
            heading=self.heading,
            heading_rate=self.heading_rate,
            link_angle=self.link_angle,
            joint_angle=self.joint_angle,
            joint_rate=self.joint_rate,
        )


@value
class Mount:
    """Where the marker body sits.

    The paper's is on "the last module", the one that also carries the caudal fin: the tail, module 0 here.
    """

    module: int = quantity("", "which module of the robot carries it, 0 = tail", ge=0, default=0)
    offset: tuple[float, float] = quantity(
        "m", "its place from the middle of that module: toward the head, to the left", default=(0.0, 0.0)
    )
    angle: float = quantity("rad", "from the module's axis to the x axis of the marker body", default=0.0)

    def on_link(self, robot: Robot) -> tuple[int, tuple[float, float]]:
        """The link of `robot.planar()` that carries it, and its place from the middle of that link [m].

        Args:
            robot: Whose module it is; its pitch joints are straight.

        Raises:
            ValueError: If the robot has no such module.
        """
        instance("robot", robot, Robot)
        if self.module >= len(robot.modules):
            raise BadArgument("module", f"must be < {len(robot.modules)}, the number of modules, got {self.module}")
        plane = reduce_to_plane(robot.modules, robot.joints)
        along, across = self.offset
        return plane.link[self.module], (plane.shift[self.module] + along, across)

    def link_yaw(self, rotation: Float[np.ndarray, "3 3"]) -> float:
        """The angle of the link that a measured `rotation` means, in [-pi, pi] [rad]."""
        return math.atan2(float(rotation[1, 0]), float(rotation[0, 0])) - self.angle


@runtime_checkable
class StateEstimator(Protocol):
    """From samples, one by one, to estimates: what `Estimator` and `KinematicEstimator` share."""

    def init(self) -> Any:
        """The state before the first sample."""
        ...

    def step(self, state: Any, sample: Sample) -> Any:
        """The state that follows `state` by one more `sample`."""
        ...

    def estimate(self, state: Any, time: float | None = None) -> Estimate | None:
        """Where the robot is in `state`, at `time` [s] or at the last sample; None before that is known."""
        ...


def status_at(age: float, bridging_after: float, lost_after: float) -> Status:
    """What the time since the last accepted frame means.

    Args:
        age: That time [s].
        bridging_after: See `Estimator` [s].
        lost_after: See `Estimator` [s].
    """
    return "tracking" if age <= bridging_after else "bridging" if age <= lost_after else "lost"
