"""What bodies and brains agree on: commands, observations and starts, and what a controller is."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

import numpy as np
from jaxtyping import Float

from laticauda.actuation.laws import JointLaw
from laticauda.errors import BadArgument, finite, instance
from laticauda.extensions import Extensible
from laticauda.gaits import Gait
from laticauda.gaits.gait import STRAIGHT
from laticauda.quantities import option, quantity, value
from laticauda.robot import Robot

State = TypeVar("State")
FAR = 1e5  # beyond it, digits of the motion are lost
EFFECTORS = (("thrusts", "thrusters", "thrust", "N"), ("deflections", "pectoral_fins", "deflection", "rad"))
"""What a command says of effectors: its field, the robot's, the number of one of them, and its unit."""
ORIENTATION = tuple(f"orientation_{part}" for part in "wxyz")
"""Signals of a spatial trial: which way module 0 is turned, as a quaternion. A measured trial may lack them."""


@dataclass(frozen=True, kw_only=True)
class Command:
    """What is asked of a plant until the next control instant."""

    gait: Gait
    """The gait; its own offset counts too."""
    offset: float = 0.0
    """phi_0 that steering adds to the gait's offset; positive turns left [rad]."""
    pitch_offset: float = 0.0
    """The same for the pitch joints; positive turns down [rad]."""
    references: tuple[float, ...] | None = None
    """Reference of every joint, from somewhere else, held until the next command: the gait and the offsets do not count
    then, and the reference generator stands still. For joints driven by pd control or servos. One more may follow for a
    driven fin, which moves by the gait without it [rad]."""
    enabled: tuple[bool, ...] | None = None
    """For every joint, whether its motor is on. Where it is not, only the gear's friction acts, and the skin. None: all
    are on. For joints driven by pd control or servos. One more may follow for a driven fin [-]."""
    thrusts: tuple[float, ...] | None = None
    """Of every driven thruster, one with a `max_thrust`, in order; it gives no more than that. None: its own [N]."""
    deflections: tuple[float, ...] | None = None
    """The same of every pectoral fin with a `max_deflection` [rad]."""

    @property
    def steered(self) -> Gait:
        """The gait with both offsets in it, as a `laticauda.gaits.Generator` takes it."""
        pitch, gait = self.gait.pitch, self.gait
        if self.pitch_offset != 0.0:
            pitch = pitch or STRAIGHT
            pitch = replace(pitch, offset=pitch.offset + self.pitch_offset)
        return replace(gait, offset=gait.offset + self.offset, pitch=pitch)

    def effectors(self, robot: Robot) -> Robot:
        """The robot with its thrusters and pectoral fins as this command has them, each within its limit.

        Args:
            robot: With them as they are built.

        Raises:
            ValueError: If there are not as many numbers as driven ones, or one is not finite.
        """
        changes: dict[str, Any] = {}
        for name, group, number, unit in EFFECTORS:
            built, asked = getattr(robot, group), getattr(self, name)
            driven = [i for i, one in enumerate(built) if getattr(one, f"max_{number}") is not None]
            if asked is None:
                continue
            if len(asked) != len(driven):
                rule = f"must have one entry per effector with a `max_{number}`, {len(driven)} in all, got {len(asked)}"
                raise BadArgument(name, rule)
            changes[group] = list(built)
            for i, one in zip(driven, asked, strict=True):
                most = getattr(built[i], f"max_{number}")
                given = min(max(finite(f"{name}[{i}]", one, unit), -most), most)
                changes[group][i] = replace(built[i], **{number: given})
        return replace(robot, **changes) if changes else robot

    def check_held(self, robot: Robot, joints: JointLaw) -> None:
        """Refuse references and switches that do not fit a plant.

        Args:
            robot: Whose joints the plant drives.
            joints: By what law.

        Raises:
            ValueError: If there are not as many as joints, a driven fin counted or not, a reference is no finite
                number, or the joints are prescribed.
        """
        for name in ("references", "enabled"):
            values = getattr(self, name)
            if values is None:
                continue
            if joints.prescribed:
                rule = "must be None for prescribed joints, which can neither jump nor go limp"
                raise BadArgument(name, f"{rule}; take `joints` = `servo` or `pd`, got {len(values)} of them")
            n, most = robot.n_joints, len(robot.driven_joints)
            if len(values) not in (n, most):
                rule = f"must have one entry per joint, {n} of them{', or one more for the fin' if most > n else ''}"
                raise BadArgument(name, f"{rule}, got {len(values)}")
        # One sum tells for all of them, a hundred times a second; only if something is wrong, which one.
        held = self.references or ()
        if not (all(type(angle) is float for angle in held) and math.isfinite(math.fsum(map(abs, held)))):
            for i, angle in enumerate(held):
                finite(f"references[{i}]", angle, "rad")


@dataclass(frozen=True, kw_only=True)
class Observation:
    """What can be seen of a plant at one instant, world axes, tail first."""

    time: float
    """[s]."""
    center_of_mass: Float[np.ndarray, " n_axes"]
    """[m]."""
    center_of_mass_velocity: Float[np.ndarray, " n_axes"]
    """[m/s]."""
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
    pitch: float = 0.0
    """Mean pitch of the links, positive downward: (6) in the vertical plane; 0 in the planar model [rad]."""
    contact_force: Float[np.ndarray, "n_links 3"] | None = None
    """In a scene the force of all contacts on every link, as it was when the last command ended [N]."""
    ranges: Float[np.ndarray, " n_rays"] | None = None
    """How far the head sees along every ray of `Spatial.rays`, infinite where nothing is [m]."""


@value
class Start:
    """Where a run begins: straight, and at rest unless it is to coast."""

    center_of_mass: tuple[float, float] = quantity("m", "Center of mass", default=(0.0, 0.0), ge=-FAR, le=FAR)
    heading: float = quantity("rad", "Which way the robot looks", default=0.0, ge=-FAR, le=FAR)
    velocity: float = quantity("m/s", "Forward, along the body", default=0.0, ge=-100.0, le=100.0)
    depth: float | None = quantity("m", "Axis depth at the center of mass, free root; None: its place's", default=None)
    pitch: float = quantity("rad", "Downward, with a free root", default=0.0, ge=-0.5 * math.pi, le=0.5 * math.pi)
    roll: float = quantity("rad", "About its axis; positive lifts its left side", default=0.0, ge=-math.pi, le=math.pi)

    def check_planar(self) -> None:
        """Refuse a start out of the plane, for a body that stays in it."""
        for name in ("depth", "pitch", "roll"):
            if getattr(self, name) not in (None, 0.0):
                rule = "must be left out unless `model` is `spatial` with a free root, got"
                raise BadArgument(f"start.{name}", f"{rule} {getattr(self, name)}")


@value
class Resumed:
    """Where a run begins that goes on with another one: in the state that the plant was left in."""

    state: Mapping[str, Any] = option("The state's arrays by name, as `Plant.pack` gives them")

    def __post_init__(self) -> None:
        """Keep plain numbers, which compare and can be stored."""
        instance("state", self.state, Mapping)
        state = {name: tuple(np.asarray(values, dtype=float).tolist()) for name, values in self.state.items()}
        object.__setattr__(self, "state", state)


class Controller(Extensible, Generic[State], group="controllers"):
    """What decides the next command. Its state is a value, as a plant's is.

    One's own is a class below this one; as a frozen dataclass it is stored with its trials.
    """

    gait: Gait
    """The gait that a run starts with."""
    interval: float
    """Time between two control instants, at which it is asked [s]; infinite: once."""

    def init(self) -> State:
        """The state before the first control instant."""
        raise NotImplementedError

    def step(self, state: State, observation: Observation) -> tuple[State, Command]:
        """The state after `observation` was made in `state`, and the command until the next control instant.

        Args:
            state: What was kept of the last control instant, or `init`.
            observation: What is seen of the robot now.
        """
        raise NotImplementedError

    def signals(self, state: State) -> Mapping[str, float]:
        """What it had in mind when it made `state`, for the Trial's log: always the same names, finite, in SI units.

        Unless told otherwise, the `signals` that its state has.

        Args:
            state: What `step` returned.
        """
        return getattr(state, "signals", {})

    def check(self, robot: Robot) -> None:
        """Raise a ValueError if `robot` cannot do what the controller may command.

        Args:
            robot: What is to be controlled.
        """


@value
class OpenLoop(Controller[None]):
    """The controller that looks at nothing: one command from start to end."""

    command: Command = option("Held all the time")
    interval: float = quantity("s", "Between two control instants; infinite: asked once", default=math.inf, gt=0.0)

    @property
    def gait(self) -> Gait:  # pyright: ignore[reportIncompatibleVariableOverride]  # as frozen as a field
        """That of the command."""
        return self.command.gait

    def init(self) -> None:
        """No state."""

    def step(self, state: None, observation: Observation) -> tuple[None, Command]:
        """The command, whatever `state` and `observation` are.

        Args:
            state: None: it keeps nothing.
            observation: Not looked at.
        """
        return None, self.command


def check_waves(robot: Robot, gait: Gait) -> None:
    """Refuse a gait that moves a fin or pitch joints which the robot does not have.

    Args:
        robot: What swims.
        gait: What it is to swim.

    Raises:
        ValueError: If so.
    """
    instance("gait", gait, Gait)
    if gait.fin is not None and 0 not in robot.fin_joints:
        raise BadArgument("gait.fin", f"must be None unless the fin is driven (`caudal_fin.joint`), got {gait.fin}")
    if gait.pitch is not None and all(joint.axis == "yaw" for joint in robot.joints):
        raise BadArgument("gait.pitch", f"must be None for a robot without pitch joints, got {gait.pitch}")


def fin_signals(
    joints: range,
    angle: Float[np.ndarray, "n_samples n_joints"],
    rate: Float[np.ndarray, "n_samples n_joints"],
    reference: Float[np.ndarray, "n_samples n_joints"],
    torque: Float[np.ndarray, "n_samples n_joints"],
) -> dict[str, np.ndarray]:
    """What the fin's joints do, as signals of a log: all of a driven root, angles and rates of passive hinges.

    Args:
        joints: About which the fin moves, from the root on: 0 is a driven root, 1 and on are passive hinges.
        angle: Of each of them [rad].
        rate: The same [rad/s].
        reference: What a driven one is asked for [rad].
        torque: Of its actuator [N m].
    """
    found: dict[str, np.ndarray] = {}
    for i, k in enumerate(joints):
        found |= {f"fin_angle_{k}": angle[:, i], f"fin_rate_{k}": rate[:, i]}
        if k == 0:
            found |= {"fin_angle_ref": reference[:, i], "fin_torque": torque[:, i]}
    return found
