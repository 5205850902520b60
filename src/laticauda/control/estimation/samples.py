"""Inputs and outputs of state estimation: samples, the mount of the markers, and estimates.

Every sample carries the time at which it was taken, on the one clock of the recording. Samples may
arrive late and out of order.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np
from jaxtyping import Float

from laticauda.robot import Robot, body
from laticauda.scenarios import Observation
from laticauda.values import (
    BadArgument,
    check_finite,
    check_instance,
    check_not_negative,
    option,
    quantity,
    value_class,
)

Offset: TypeAlias = tuple[float, float] | tuple[float, float, float]
"""Position from the middle of a module: forward, left, and up, 0 if it is left out [m]."""
Vector: TypeAlias = Float[np.ndarray, " _"]


@dataclass(frozen=True, kw_only=True, eq=False)
class PoseSample:
    """Pose of the marker body from motion capture; the position of a lost body contains nan."""

    time: float
    """Time at which the cameras took the frame [s]."""
    position: Float[np.ndarray, " 3"]
    """Position of the marker body, world axes [m]."""
    rotation: Float[np.ndarray, "3 3"] | None = None
    """Rotation from the axes of the marker body to world axes; None if only its position is known."""
    residual: float = 0.0
    """Residual of the fit of the markers to the body, root mean square distance [m]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        _store_checked(self, position=(3,), rotation=(3, 3))

    @property
    def is_lost(self) -> bool:
        """Whether the body was not seen."""
        return not bool(np.isfinite(self.position).all())


@dataclass(frozen=True, kw_only=True, eq=False)
class JointSample:
    """Joint measurements, tail first; nan if a module did not answer."""

    time: float
    """Time at which all joints were sampled, at the Sync [s]."""
    angle: Vector
    """phi of every joint of the robot, or of its yaw joints only [rad]."""
    rate: Vector | None = None
    """phi', as reported by the modules; None if they do not report it [rad/s]."""
    torque: Vector | None = None
    """Torque of every drive; None if the modules do not report it [N m]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        _store_checked(self, angle=(None,))
        _store_checked(self, rate=self.angle.shape, torque=self.angle.shape)


@dataclass(frozen=True, kw_only=True, eq=False)
class ReferenceSample:
    """Joint references from this time on."""

    time: float
    """Time at which they took effect, at the Sync [s]."""
    angle: Vector
    """phi_ref of every joint of the robot, and of a driven fin, or of its yaw joints only [rad]."""
    frequency: float = 0.0
    """Angular frequency of the gait; 0 while no gait runs [rad/s]."""

    def __post_init__(self) -> None:
        """Check every field once."""
        _store_checked(self, angle=(None,))
        frequency = check_not_negative("frequency", self.frequency, "rad/s")
        object.__setattr__(self, "frequency", frequency)


Sample: TypeAlias = PoseSample | JointSample | ReferenceSample


Shape: TypeAlias = tuple[int | None, ...]
"""Size of an array along each axis; None: any."""


def _store_checked(sample: Sample, **shapes: Shape) -> None:
    """Check the time, and store read-only arrays of these shapes; None stays None."""
    object.__setattr__(sample, "time", check_finite("time", sample.time, "s"))
    for name, shape in shapes.items():
        numbers: object = getattr(sample, name)
        if numbers is None:
            continue
        array = np.array(numbers, dtype=np.float64)
        if not _fits(array.shape, shape):
            expected = " x ".join(_describe_size(size) for size in shape)
            rule = f"must hold {expected} numbers"
            raise BadArgument(name, f"{rule}, got an array of shape {array.shape}")
        array.flags.writeable = False
        object.__setattr__(sample, name, array)


def _fits(actual: tuple[int, ...], shape: Shape) -> bool:
    """Return whether an array has the required shape."""
    if len(actual) != len(shape):
        return False
    return all(size in (None, n) for size, n in zip(shape, actual, strict=True))


def _describe_size(size: int | None) -> str:
    if size is None:
        return "n"
    return str(size)


Status: TypeAlias = Literal["tracking", "bridging", "lost"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Estimate(Observation):
    """Estimated observation of the robot with its uncertainty, as input of a controller."""

    status: Status
    """`tracking`: motion capture sees the robot; `bridging`: it does not for a moment; `lost`: it
    does not for too long [-]."""
    age: float
    """Time since the last accepted frame [s]."""
    center_of_mass_std: float = 0.0
    """Standard deviation of p per axis; 0 if the estimator does not provide it [m]."""
    heading_std: float = 0.0
    """Standard deviation of the heading; 0 if the estimator does not provide it [rad]."""
    current: Float[np.ndarray, " 2"] | None = None
    """Velocity that the water moves to; None if it is not estimated [m/s]."""
    current_std: float = 0.0
    """Standard deviation of the current along its less certain direction [m/s]."""


class MarkerPosition(NamedTuple):
    """Position of the marker body on the planar reduction of a robot."""

    link: int
    """Link that carries it, from 0 at the tail."""
    offset: tuple[float, float]
    """Its position from the middle of that link: forward, left [m]."""


@value_class
class Mount:
    """Mount of the marker body on the robot.

    In the paper, it is on "the last module", which also carries the caudal fin: the tail, module 0
    here.
    """

    module: int = quantity("", "the module that carries it, 0 = tail", ge=0, default=0)
    offset: Offset = quantity(
        "m", "its position from that module's middle: forward, left, up", default=(0.0, 0.0)
    )
    angle: float = quantity(
        "rad", "from the module's axis to the x axis of the marker body", default=0.0
    )

    def on_link(self, robot: Robot) -> MarkerPosition:
        """Return the link of `robot.planar()` that carries the body, and its position on the link.

        Args:
            robot: Robot that the module belongs to; its pitch joints are straight.

        Raises:
            ValueError: If the robot has no such module.
        """
        check_instance("robot", robot, Robot)
        n_modules = len(robot.modules)
        if self.module >= n_modules:
            rule = f"must be < {n_modules}, the number of modules"
            raise BadArgument("module", f"{rule}, got {self.module}")
        plane = body.reduce_to_plane(robot.modules, robot.joints)
        forward, left = self.offset[:2]
        return MarkerPosition(
            link=plane.link[self.module],
            offset=(plane.shift[self.module] + forward, left),
        )

    def link_yaw(self, rotation: Float[np.ndarray, "3 3"]) -> float:
        """Return the link angle that follows from a `rotation`, to within whole turns [rad].

        Args:
            rotation: Rotation from the body's axes to world axes.
        """
        body_yaw = math.atan2(float(rotation[1, 0]), float(rotation[0, 0]))
        return body_yaw - self.angle


@value_class
class StateEstimator:
    """Base class of `Estimator` and `KinematicEstimator`: from samples to estimates.

    The state is a value.

    Raises:
        ValueError: If a field is out of its range, or the robot has no module that carries the
            markers.
    """

    robot: Robot = option("the robot; in the plane, with straight pitch joints")
    mount: Mount = option("where the marker body sits", default_factory=Mount)
    bridging_after: float = quantity(
        "s", "after this long without a frame, it is `bridging`", gt=0.0, default=0.05
    )
    lost_after: float = quantity(
        "s", "after this long without a frame, it is `lost`", gt=0.0, default=1.5
    )

    def __post_init__(self) -> None:
        """Reject a mount that is not on the robot."""
        self.mount.on_link(self.robot)

    @cached_property
    def on_link(self) -> MarkerPosition:
        """See `Mount.on_link`."""
        return self.mount.on_link(self.robot)

    def init(self) -> Any:
        """Return the state before the first sample."""
        raise NotImplementedError

    def step(self, state: Any, sample: Sample) -> Any:
        """Return the state that follows `state` after one more `sample`.

        Args:
            state: State so far.
            sample: Measurement and its time.
        """
        raise NotImplementedError

    def steps(self, state: Any, samples: Sequence[Sample]) -> Any:
        """Return the state after several `samples` that arrived at once, in this order.

        Args:
            state: State so far.
            samples: Measurements in the order in which they are processed.
        """
        for sample in samples:
            state = self.step(state, sample)
        return state

    def estimate(self, state: Any, time: float | None = None) -> Estimate | None:
        """Return the estimate for `state`; None if it is not known yet.

        Args:
            state: State so far.
            time: Requested time; None for that of the last sample [s].
        """
        raise NotImplementedError

    def status_at(self, age: float) -> Status:
        """Return the status for the time since the last accepted frame, `age` [s].

        Args:
            age: Time since the last accepted frame [s].
        """
        if age <= self.bridging_after:
            return "tracking"
        if age <= self.lost_after:
            return "bridging"
        return "lost"
