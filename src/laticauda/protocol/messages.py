"""What goes over the robot's CAN bus, as values: one class per message of `mamba.dbc`, with its signals.

Nodes are the joint modules. Node 1 is the joint nearest the tail, so node i drives joint i - 1 of the code; the node
behind the last of them drives a driven fin.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Annotated, TypeAlias

from laticauda.errors import BadArgument, LaticaudaError

N_NODES = 19  # Mamba's 18 joints, and a driven fin
PER_FRAME = 4  # references in one frame
N_GROUPS = -(-N_NODES // PER_FRAME)
EVERY_NODE = 0


class ProtocolError(LaticaudaError, ValueError):
    """What came over a connection breaks its protocol: it says how."""


@dataclass(frozen=True)
class Signal:
    """How a field goes over the bus, least significant byte first.

    A field without one: a flag has 1 bit, a word 8, and a whole number says which one of several frames it is.
    """

    bits: int
    """Of a number [-]."""
    signed: bool = False
    """Whether it may be negative."""
    scale: str = "1"
    """What one step of it is worth, in the unit."""
    unit: str = ""
    """Of the number."""
    says: str = ""
    """What it is."""
    names: tuple[str, ...] = ()
    """Of the numbers, where the field has several; one has the field's."""


def _number(scale: str, unit: str, says: str, *names: str) -> Signal:
    return Signal(16, True, scale, unit, says, names)


class NodeState(IntEnum):
    """What a node is doing."""

    STARTUP = 0
    """Power has come on; it listens, and answers nothing but its heartbeat."""
    CALIBRATING = 1
    """It reads the offset of its angle sensor from memory, and tests its sensors."""
    READY = 2
    """Well, and limp: the motor is off."""
    ACTIVE = 3
    """The motor follows the references."""
    HOLD = 4
    """References stay away; it holds the last one."""
    LIMP = 5
    """References stayed away for too long; the motor is off until the node is enabled again."""
    FAULT = 6
    """Something is wrong (see the flags of its heartbeat); the motor is off until the fault is gone and cleared."""

    @property
    def is_on(self) -> bool:
        """Whether the motor is on."""
        return self in (NodeState.ACTIVE, NodeState.HOLD)


class Order(IntEnum):
    """What a node can be told."""

    ENABLE = 1
    """Follow references, from where the joint stands; from READY and LIMP."""
    DISABLE = 2
    """Motor off."""
    SET_ZERO = 3
    """From now on, the angle at which the joint stands reads `angle`; from READY and LIMP."""
    CLEAR = 4
    """Forget the faults whose cause is gone."""


class Result(IntEnum):
    """What became of an order."""

    DONE = 0
    REFUSED = 1
    """Not in this state."""
    UNKNOWN = 2
    """No such order."""


@dataclass(frozen=True, kw_only=True)
class EmergencyStop:
    """All motors off at once, and off they stay until they are cleared. Anyone may send it."""

    reason: Annotated[int, Signal(8)] = 0
    """0 unknown, 1 the operator's key, 2 the supervisor, 3 a module [-]."""


@dataclass(frozen=True, kw_only=True)
class NodeCommand:
    """An order to one node, or to all of them; every node that it is meant for answers with a `CommandReply`."""

    node: Annotated[int, Signal(8, says="0: all nodes")] = EVERY_NODE
    """Which; 0: all [-]."""
    order: Order
    """What [-]."""
    angle: Annotated[float, _number("0.0001", "rad", "SET_ZERO: what the present joint angle shall read")] = 0.0
    """For SET_ZERO: what the present joint angle shall read [rad]."""


@dataclass(frozen=True, kw_only=True)
class Sync:
    """The moment at which all nodes take up their latest references, and measure."""

    counter: Annotated[int, Signal(16)]
    """One more every time; 65535 is followed by 0 [-]."""


@dataclass(frozen=True, kw_only=True)
class References:
    """Reference angles of four joints in a row. They count from the next `Sync` on."""

    group: int
    """0: nodes 1 to 4, 1: nodes 5 to 8, and so on [-]."""
    angles: Annotated[
        tuple[float, float, float, float],
        _number("0.0001", "rad", "reference angle", "Angle1", "Angle2", "Angle3", "Angle4"),
    ]
    """phi_ref [rad]."""


@dataclass(frozen=True, kw_only=True)
class JointState:
    """A node's answer to every `Sync`: what it measured at that moment."""

    node: int
    """Who [-]."""
    angle: Annotated[float, _number("0.0001", "rad", "joint angle")]
    """phi [rad]."""
    rate: Annotated[float, _number("0.001", "rad/s", "joint rate")]
    """phi' [rad/s]."""
    current: Annotated[float, _number("0.001", "A", "motor current")]
    """Of the motor, at its own supply [A]."""
    torque: Annotated[float, _number("0.001", "Nm", "motor torque at the joint")]
    """Of the motor at the joint, from its current [N m]."""


@dataclass(frozen=True, kw_only=True)
class Loads:
    """The force/torque sensor at the joint, in axes of the module on its tail side."""

    node: int
    """Who [-]."""
    force: Annotated[
        tuple[float, float, float] | None,
        _number("0.01", "N", "force/torque sensor; -32768: not available", "ForceAlong", "ForceLeft", "ForceUp"),
    ]
    """Along, to the left, up; None where the sensor has none to give [N]."""
    torque: Annotated[float, _number("0.001", "Nm", "force/torque sensor, about the joint's axis")]
    """About the joint's axis [N m]."""


@dataclass(frozen=True, kw_only=True)
class Acceleration:
    """The accelerometer, in axes of the module on the joint's tail side: at rest it shows g upward."""

    node: int
    """Who [-]."""
    along: Annotated[float, _number("0.001", "m/s2", "accelerometer")]
    """[m/s^2]."""
    left: Annotated[float, _number("0.001", "m/s2", "accelerometer")]
    """[m/s^2]."""
    up: Annotated[float, _number("0.001", "m/s2", "accelerometer")]
    """[m/s^2]."""


@dataclass(frozen=True, kw_only=True)
class Heartbeat:
    """How a node is: ten times a second, and at every change of its state."""

    node: int
    """Who [-]."""
    state: NodeState
    """What it is doing [-]."""
    leak: bool = False
    """Water in the module [-]."""
    over_temperature: bool = False
    """The motor was too hot [-]."""
    over_current: bool = False
    """The motor's current was too great for too long [-]."""
    stuck: bool = False
    """The joint did not move although the motor pulled [-]."""
    references_lost: bool = False
    """References stayed away while it was active [-]."""
    emergency_stopped: bool = False
    """Somebody sent an `EmergencyStop` [-]."""
    not_calibrated: bool = False
    """Nobody has set its zero since power came on [-]."""
    bus_errors: bool = False
    """It was off the bus since its last heartbeat [-]."""
    temperature: Annotated[float, _number("0.1", "degC", "of the motor")] = 20.0
    """Of the motor [deg C]."""
    voltage: Annotated[float, Signal(16, scale="0.01", unit="V", says="of the supply")] = 35.0
    """Of the supply that runs through the modules [V]."""
    error_count: Annotated[int, Signal(8, says="transmit errors")] = 0
    """The controller's count of transmit errors, as far as 255 [-]."""
    counter: Annotated[int, Signal(8, says="one more every time")] = 0
    """One more every time; 255 is followed by 0 [-]."""

    @property
    def faults(self) -> tuple[str, ...]:
        """The names of the flags that keep a node in FAULT."""
        return tuple(name for name in FAULTS if getattr(self, name))


FAULTS = ("leak", "over_temperature", "over_current", "stuck", "emergency_stopped")


@dataclass(frozen=True, kw_only=True)
class CommandReply:
    """A node's answer to a `NodeCommand`."""

    node: int
    """Who [-]."""
    order: Annotated[int, Signal(8)]
    """Which order it answers; a number that is no `Order` comes back as it came [-]."""
    result: Result
    """What became of it [-]."""
    state: NodeState
    """The node's state after it [-]."""


CanMessage: TypeAlias = (
    EmergencyStop | NodeCommand | Sync | References | JointState | Loads | Acceleration | Heartbeat | CommandReply
)


def references(angles: Sequence[float]) -> tuple[References, ...]:
    """The frames that carry the references of all joints.

    Args:
        angles: phi_ref of every joint, tail first, then of a driven fin [rad]; 1 to 19 of them. Places beyond the last
            one are zero.

    Raises:
        ValueError: If there are more joints than nodes, or none.
    """
    if not 1 <= len(angles) <= N_NODES:
        raise BadArgument("angles", f"must be 1 to {N_NODES} numbers, one per joint, got {len(angles)}")
    padded = [float(angle) for angle in angles]
    padded += [0.0] * (-len(padded) % PER_FRAME)
    return tuple(
        References(group=k // PER_FRAME, angles=(padded[k], padded[k + 1], padded[k + 2], padded[k + 3]))
        for k in range(0, len(padded), PER_FRAME)
    )
