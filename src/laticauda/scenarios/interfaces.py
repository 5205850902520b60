"""Interface between plants and controllers: commands, observations, starts, and the controller base class."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeGuard, TypeVar, cast

import numpy as np
from jaxtyping import Float

from laticauda.motion.gaits import STRAIGHT, Gait
from laticauda.motion.joints import JointLaw
from laticauda.robot import Robot
from laticauda.sensing import EVALUATE_LOADS, BodyLoads, Observed, Reading
from laticauda.values import (
    BadArgument,
    Extensible,
    check_finite,
    check_instance,
    make_quickly,
    option,
    quantity,
    show_value,
    value_class,
)

if TYPE_CHECKING:
    from laticauda.scenarios.vector_control import VectorController

State = TypeVar("State")
FAR = 1e5
"""Largest coordinate [m] and angle [rad] of a start; beyond it, digits of the motion are lost."""
SHORTEST_INTERVAL = 1e-4
"""Shortest time between two control instants: what is shorter fills the memory with instants [s]."""


_LACKS = "The controller {name} must have a method `{method}`, as the documentation of `Controller` describes it."


class EffectorKind(NamedTuple):
    """How a command sets the effectors of one kind."""

    command_field: str
    """Field of the command with their values."""
    robot_field: str
    """Field of the robot with the effectors."""
    quantity: str
    """Field of an effector that is set; `max_` and this name is the field of its limit."""
    unit: str
    has_servo: bool
    """Whether a dead band is one of motion, about what is commanded, not one about 0."""

    def limit_of(self, effector: Any) -> float | None:
        """Return the limit of an effector of the kind; None if it is not driven.

        Args:
            effector: The effector.
        """
        return getattr(effector, f"max_{self.quantity}")

    def drives(self, effector: Any) -> bool:
        """Return whether a command drives an effector of the kind.

        Args:
            effector: The effector.
        """
        return self.limit_of(effector) is not None


EFFECTORS = (
    EffectorKind(
        command_field="thrusts",
        robot_field="thrusters",
        quantity="thrust",
        unit="N",
        has_servo=False,
    ),
    EffectorKind(
        command_field="deflections",
        robot_field="pectoral_fins",
        quantity="deflection",
        unit="rad",
        has_servo=True,
    ),
)
"""Kinds of effectors that a command may set."""
ORIENTATION = tuple(f"orientation_{part}" for part in "wxyz")
"""Signals of a spatial trial: orientation of module 0 as a quaternion. A measured trial may lack them."""


@dataclass(frozen=True, kw_only=True)
class Command:
    """Command to a plant, valid until the next control instant."""

    gait: Gait
    """The gait, including its own offset."""
    offset: float = 0.0
    """phi_0 that steering adds to the gait's offset; positive turns left [rad]."""
    pitch_offset: float = 0.0
    """Offset added for the pitch joints; positive turns down [rad]."""
    references: tuple[float, ...] | None = None
    """Reference of every joint from an external source, held until the next command: the gait and the offsets are then
    ignored, and the reference generator pauses. For joints driven by pd control or servos. One more
    value may follow for a driven fin, which otherwise moves with the gait [rad]."""
    enabled: tuple[bool, ...] | None = None
    """For every joint, whether its motor is on. If off, only the friction of the gear and of the skin acts. None: all
    are on. For joints driven by pd control or servos. One more value may follow for a driven fin
    [-]."""
    thrusts: tuple[float, ...] | None = None
    """Thrust of every driven thruster, one with a `max_thrust` that limits it, in order. None: its own thrust [N]."""
    deflections: tuple[float, ...] | None = None
    """Deflection of every pectoral fin with a `max_deflection`, in the same way [rad]."""

    @property
    def steered(self) -> Gait:
        """The gait with both offsets included, as required by a `laticauda.motion.gaits.Generator`."""
        pitch = self.gait.pitch
        if self.pitch_offset != 0.0:
            pitch = pitch or STRAIGHT
            pitch = replace(pitch, offset=pitch.offset + self.pitch_offset)
        return replace(self.gait, offset=self.gait.offset + self.offset, pitch=pitch)

    def effectors(self, robot: Robot) -> Robot:
        """Return the robot with its thrusters and pectoral fins set as commanded, each within its limit.

        Thrust within the dead band of a thruster is none. How long effectors take is the plant's matter.

        Args:
            robot: The robot with its effectors as built.

        Raises:
            ValueError: If the numbers of values and of driven effectors differ, or a value is not
                finite.
        """
        changes: dict[str, Any] = {}
        for kind in EFFECTORS:
            values = getattr(self, kind.command_field)
            if values is not None:
                effectors = getattr(robot, kind.robot_field)
                changes[kind.robot_field] = _set_effectors(kind, effectors, values)
        if not changes:
            return robot
        return replace(robot, **changes)

    def check_held(self, robot: Robot, joints: JointLaw) -> None:
        """Reject references and switches that do not fit a plant.

        Args:
            robot: Robot whose joints the plant drives.
            joints: Joint law that drives them.

        Raises:
            ValueError: If their number does not match the joints, with or without a driven fin, a
                reference is not a finite number, or the joints are prescribed.
        """
        for name in ("references", "enabled"):
            values = getattr(self, name)
            if values is None:
                continue
            if joints.prescribed:
                rule = "must be None for prescribed joints, which can neither jump nor go limp"
                advice = "use `joints` = `servo` or `pd`"
                raise BadArgument(name, f"{rule}; {advice}, got {len(values)} of them")
            n_joints = robot.n_joints
            n_driven_joints = len(robot.driven_joints)
            if len(values) not in (n_joints, n_driven_joints):
                rule = f"must have one entry per joint, {n_joints} of them"
                if n_driven_joints > n_joints:
                    rule += ", or one more for the fin"
                raise BadArgument(name, f"{rule}, got {len(values)}")
        if self.references:
            _check_references(self.references)


def _set_effectors(kind: EffectorKind, effectors: Sequence[Any], values: Sequence[float]) -> Any:
    """Return effectors of which those with a limit have the commanded values, each within its limit."""
    limit_field = f"max_{kind.quantity}"
    limits: dict[int, float] = {}
    for i, effector in enumerate(effectors):
        limit = kind.limit_of(effector)
        if limit is not None:
            limits[i] = limit
    if len(values) != len(limits):
        rule = f"must have one entry per effector with a `{limit_field}`, {len(limits)} in all"
        raise BadArgument(kind.command_field, f"{rule}, got {len(values)}")
    commanded = list(effectors)
    for (i, limit), value in zip(limits.items(), values, strict=True):
        finite_value = check_finite(f"{kind.command_field}[{i}]", value, kind.unit)
        limited_value = min(max(finite_value, -limit), limit)
        if not kind.has_servo and abs(limited_value) < effectors[i].dead_band:
            limited_value = 0.0
        commanded[i] = replace(effectors[i], **{kind.quantity: limited_value})
    return commanded


def _check_references(angles: Sequence[float]) -> None:
    """Reject references that are not finite numbers [rad]."""
    # A single sum checks all of them, a hundred times per second; the faulty one is located only if
    # the sum fails.
    are_floats = all(type(angle) is float for angle in angles)
    if are_floats and math.isfinite(math.fsum(map(abs, angles))):
        return
    for i, angle in enumerate(angles):
        check_finite(f"references[{i}]", angle, "rad")


@dataclass(frozen=True, kw_only=True)
class Observation(Observed):
    """Observable quantities of a plant at one instant, world axes, tail first."""

    time: float
    """Time [s]."""
    center_of_mass: Float[np.ndarray, " n_axes"]
    """Position of the center of mass [m]."""
    center_of_mass_velocity: Float[np.ndarray, " n_axes"]
    """Velocity of the center of mass [m/s]."""
    heading: float
    """Mean link angle (6), unwrapped [rad]."""
    heading_rate: float
    """Rate of the heading [rad/s]."""
    link_angle: Float[np.ndarray, " n_links"]
    """theta [rad]."""
    joint_angle: Float[np.ndarray, " n_joints"]
    """phi [rad]."""
    joint_rate: Float[np.ndarray, " n_joints"]
    """phi' [rad/s]."""
    pitch: float = 0.0
    """Mean pitch of the links, positive downward: (6) in the vertical plane; 0 in the planar model [rad]."""
    contact_force: Float[np.ndarray, "n_links 3"] | None = None
    """In a scene: total contact force on every link at the end of the last command [N]."""
    ranges: Float[np.ndarray, " n_rays"] | None = None
    """Distance that the head measures along every ray of `Spatial.rays`, infinite if nothing is hit [m]."""
    energy: float = 0.0
    """Electrical energy since the start, or the joints' work if the robot has no power model [J]."""
    readings: Mapping[str, Reading] = field(default_factory=dict[str, Reading])
    """What each sensor of the model last told, by its name."""

    def give_loads(self, evaluate: Callable[[], BodyLoads]) -> None:
        """Say how the loads are computed; for whoever makes the observation, before anybody sees it.

        Args:
            evaluate: Computes them.
        """
        vars(self)[EVALUATE_LOADS] = evaluate

    def with_readings(self, readings: Mapping[str, Reading]) -> "Observation":
        """Return the same observation with readings of sensors.

        Args:
            readings: The last reading of each sensor, by its name.
        """
        fields = {**vars(self), "readings": readings}
        return make_quickly(type(self), **fields)


@value_class
class Start:
    """Start of a run: straight, and at rest unless it has a forward velocity."""

    center_of_mass: tuple[float, float] = quantity(
        "m", "Center of mass", default=(0.0, 0.0), ge=-FAR, le=FAR
    )
    heading: float = quantity(
        "rad", "Direction in which the robot points", default=0.0, ge=-FAR, le=FAR
    )
    velocity: float = quantity(
        "m/s", "Forward speed, along the body", default=0.0, ge=-100.0, le=100.0
    )
    depth: float | None = quantity(
        "m", "Axis depth at mass center, free root; None: the environment's", default=None
    )
    pitch: float = quantity(
        "rad", "Downward, with a free root", default=0.0, ge=-0.5 * math.pi, le=0.5 * math.pi
    )
    roll: float = quantity(
        "rad", "About its axis; positive lifts the left side", default=0.0, ge=-math.pi, le=math.pi
    )

    def check_planar(self) -> None:
        """Reject a start out of the plane, for a body that stays in it."""
        for name in ("depth", "pitch", "roll"):
            if getattr(self, name) not in (None, 0.0):
                rule = "must be left out unless `model` is `spatial` with a free root, got"
                raise BadArgument(f"start.{name}", f"{rule} {getattr(self, name)}")


@value_class
class Resumed:
    """Start of a run that continues another one: the final state of the plant."""

    state: Mapping[str, Any] = option("The state's arrays by name, as `Plant.pack` returns them")

    def __post_init__(self) -> None:
        """Store plain numbers, which can be compared and saved."""
        check_instance("state", self.state, Mapping)
        state = {
            name: tuple(np.asarray(values, dtype=float).tolist())
            for name, values in self.state.items()
        }
        object.__setattr__(self, "state", state)


class Controller(Extensible, Generic[State], group="controllers"):
    """Base of controllers, which decide the next command. Their state is a value, as is that of a plant.

    A custom controller is a subclass of this class; if it is a frozen dataclass, it is stored with
    its trials.
    """

    gait: Gait
    """Initial gait of a run."""
    interval: float
    """Time between two control instants, at which `step` is called [s]; infinite: called once."""

    def init(self) -> State:
        """Return the state before the first control instant."""
        raise NotImplementedError(_LACKS.format(name=type(self).__name__, method="init"))

    def step(self, state: State, observation: Observation) -> tuple[State, Command]:
        """Return the next state, from `state` and `observation`, and the command until the next control instant.

        Args:
            state: State after the last control instant, or from `init`.
            observation: Current observation of the robot.
        """
        raise NotImplementedError(_LACKS.format(name=type(self).__name__, method="step"))

    def signals(self, state: State) -> Mapping[str, float]:
        """Return internal quantities in `state` for the Trial's log: always the same names, finite, in SI units.

        By default, the `signals` attribute of the state.

        Args:
            state: State returned by `step`.
        """
        return getattr(state, "signals", {})

    def check(self, robot: Robot) -> None:
        """Raise a ValueError if `robot` cannot do what the controller may command.

        Args:
            robot: Robot to be controlled.
        """

    @classmethod
    def vectorize(cls, controllers: Sequence[Any]) -> "VectorController | None":
        """Return one object that steers a robot for each of many controllers, by arrays.

        By default None: the controllers are called one after the other. It stands for `init` and
        `step`; a subclass that changes these is not asked.

        Args:
            controllers: Controllers of this class, one for each robot; the fields of all have values of
                the same classes.
        """
        del controllers
        return None


def check_interval(controller: Controller[Any]) -> None:
    """Reject a controller whose control instants cannot follow one another.

    Args:
        controller: A controller, perhaps one of the user's own, whose fields nobody has checked.

    Raises:
        ValueError: If its `interval` is no time, or too short.
    """
    interval = getattr(controller, "interval", None)
    if interval == math.inf:
        return
    seconds = check_finite("motion.interval", interval, "s, between two control instants")
    if seconds < SHORTEST_INTERVAL:
        rule = f"must be >= {SHORTEST_INTERVAL:g} s, between two control instants, got {seconds:g}"
        raise BadArgument("motion.interval", rule)


def decide(
    controller: Controller[Any], state: Any, observation: Observation
) -> tuple[Any, Command]:
    """Return the next state and command of a controller, which may be one of the user's own.

    Args:
        controller: The controller.
        state: Its state after the last control instant, or from `init`.
        observation: Current observation of the robot.

    Raises:
        ValueError: If its `step` returns anything but a state and a command.
    """
    decision = cast(object, controller.step(state, observation))
    if not _is_pair(decision):
        rule = "must return two things, the next state and a Command, got"
        raise BadArgument("motion.step", f"{rule} {show_value(decision)}")
    next_state, command = decision
    check_instance("command", command, Command)
    return next_state, command


def _is_pair(decision: object) -> TypeGuard[tuple[Any, Any]]:
    return isinstance(decision, tuple) and len(cast(tuple[object, ...], decision)) == 2


@value_class
class OpenLoop(Controller[None]):
    """Controller that ignores observations: one command from start to end."""

    command: Command = option("Command that is always held")
    interval: float = quantity(
        "s",
        "Time between control instants; infinite: called once",
        default=math.inf,
        ge=SHORTEST_INTERVAL,
    )

    @property
    def gait(self) -> Gait:  # pyright: ignore[reportIncompatibleVariableOverride]  # as frozen as a field
        """Gait of the command."""
        return self.command.gait

    def init(self) -> None:
        """Return no state."""

    def step(self, state: None, observation: Observation) -> tuple[None, Command]:
        """Return the command, whatever `state` and `observation` are.

        Args:
            state: None: the controller has no state.
            observation: Ignored.
        """
        return None, self.command


def check_waves(robot: Robot, gait: Gait) -> None:
    """Reject a gait that moves a fin or pitch joints that the robot does not have.

    Args:
        robot: The robot that swims.
        gait: The gait that it is to swim.

    Raises:
        ValueError: If the gait does so.
    """
    check_instance("gait", gait, Gait)
    if gait.fin is not None and 0 not in robot.fin_joints:
        rule = "must be None unless the fin is driven (`caudal_fin.joint`)"
        raise BadArgument("gait.fin", f"{rule}, got {gait.fin}")
    if gait.pitch is not None and all(joint.axis == "yaw" for joint in robot.joints):
        rule = "must be None for a robot without pitch joints"
        raise BadArgument("gait.pitch", f"{rule}, got {gait.pitch}")


def fin_signals(
    joints: range,
    angle: Float[np.ndarray, "n_samples n_joints"],
    rate: Float[np.ndarray, "n_samples n_joints"],
    reference: Float[np.ndarray, "n_samples n_joints"],
    torque: Float[np.ndarray, "n_samples n_joints"],
) -> dict[str, np.ndarray]:
    """Return the motion of the fin's joints as signals: all of a driven root, angles and rates of passive hinges.

    Args:
        joints: Joints of the fin, from the root on: 0 is a driven root, 1 and above are passive
            hinges.
        angle: Angle of each joint [rad].
        rate: Rate of each joint [rad/s].
        reference: Reference angle of a driven joint [rad].
        torque: Torque of its actuator [N m].
    """
    signals: dict[str, np.ndarray] = {}
    for column, joint in enumerate(joints):
        signals[f"fin_angle_{joint}"] = angle[:, column]
        signals[f"fin_rate_{joint}"] = rate[:, column]
        if joint == 0:
            signals["fin_angle_ref"] = reference[:, column]
            signals["fin_torque"] = torque[:, column]
    return signals
