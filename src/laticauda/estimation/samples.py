"""What state estimation takes in: motion-capture frames, joint samples and references.

Every sample says when it was taken, on the one clock of the recording. They may arrive late and out of order.
"""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from jaxtyping import Float

from laticauda.errors import BadArgument, finite, not_negative
from laticauda.robot import Robot

Vector: TypeAlias = Float[np.ndarray, " _"]


@dataclass(frozen=True, kw_only=True, eq=False)
class PoseSample:
    """Where motion capture saw the marker body; a body that is lost has nan in its position."""

    time: float
    """When the cameras took it [s]."""
    position: Float[np.ndarray, " 3"]
    """Of the marker body, world axes [m]."""
    rotation: Float[np.ndarray, "3 3"] | None = None
    """From the axes of the marker body to world axes; None if only its position is known [-]."""
    residual: float = 0.0
    """How well the markers fit the body, root mean square distance [m]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        object.__setattr__(self, "time", finite("time", self.time, "s"))
        object.__setattr__(self, "position", _array("position", self.position, (3,)))
        if self.rotation is not None:
            object.__setattr__(self, "rotation", _array("rotation", self.rotation, (3, 3)))

    @property
    def is_lost(self) -> bool:
        """Whether the body was not seen."""
        return not bool(np.isfinite(self.position).all())


@dataclass(frozen=True, kw_only=True, eq=False)
class JointSample:
    """What the joints report, tail first; nan where a module did not answer."""

    time: float
    """When all joints were sampled, at the Sync [s]."""
    angle: Vector
    """phi of every joint of the robot, or of its yaw joints only [rad]."""
    rate: Vector | None = None
    """phi', as the modules report it; None if they do not [rad/s]."""
    torque: Vector | None = None
    """Of every drive; None if the modules do not report it [N m]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        object.__setattr__(self, "time", finite("time", self.time, "s"))
        object.__setattr__(self, "angle", _array("angle", self.angle, (None,)))
        for name in ("rate", "torque"):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, _array(name, value, self.angle.shape))


@dataclass(frozen=True, kw_only=True, eq=False)
class ReferenceSample:
    """The references of the joints from this time on."""

    time: float
    """When it took effect, at the Sync [s]."""
    angle: Vector
    """phi_ref of every joint of the robot, and of a driven fin, or of its yaw joints only [rad]."""
    frequency: float = 0.0
    """Of the gait, an angular frequency; 0 while no gait runs [rad/s]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        object.__setattr__(self, "time", finite("time", self.time, "s"))
        object.__setattr__(self, "angle", _array("angle", self.angle, (None,)))
        object.__setattr__(self, "frequency", not_negative("frequency", self.frequency, "rad/s"))


Sample: TypeAlias = PoseSample | JointSample | ReferenceSample


def _array(name: str, value: object, shape: tuple[int | None, ...]) -> np.ndarray:
    array = np.array(value, dtype=np.float64)
    fits = array.ndim == len(shape) and all(size in (None, have) for size, have in zip(shape, array.shape, strict=True))
    if not fits:
        expected = " x ".join("n" if size is None else str(size) for size in shape)
        raise BadArgument(name, f"must hold {expected} numbers, got an array of shape {array.shape}")
    array.flags.writeable = False
    return array


def yaw_joints(robot: Robot, name: str, angle: Vector) -> Vector:
    """The columns of the yaw joints.

    Args:
        robot: Whose joints they are.
        name: What `angle` is called, for the message.
        angle: One number per joint of the robot, or per yaw joint; that of a driven fin may follow the former.

    Raises:
        ValueError: If there are as many as neither.
    """
    is_yaw = [joint.axis == "yaw" for joint in robot.joints]
    if angle.size in (len(is_yaw), len(robot.driven_joints)):
        return angle[: len(is_yaw)][is_yaw]
    if angle.size == sum(is_yaw):
        return angle
    raise BadArgument(name, f"must hold {len(is_yaw)} numbers, one per joint of the robot, got {angle.size}")
