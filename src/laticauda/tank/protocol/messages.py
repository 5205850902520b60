"""Messages on the robot's CAN bus, as values: one class per message of `mamba.dbc`, with its signals.

Nodes are the joint modules. Node 1 is the joint nearest the tail, so node i drives joint i - 1 of
the code; the node after the last one moves a driven fin.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Annotated, TypeAlias

from laticauda.values import BadArgument, LaticaudaError

N_NODES = 19
"""Number of nodes: Mamba's 18 joints, and a driven fin."""
REFERENCES_PER_FRAME = 4
"""References in one frame."""
N_GROUPS = math.ceil(N_NODES / REFERENCES_PER_FRAME)
"""Frames that carry the references of all nodes."""
EVERY_NODE = 0
"""Number that addresses all nodes."""


class ProtocolError(LaticaudaError, ValueError):
    """Raised if data received over a connection violate its protocol; the message says how."""


@dataclass(frozen=True)
class Signal:
    """Encoding of a field on the bus, least significant byte first.

    Without a signal, a flag has 1 bit and a word 8, and an integer says which of several frames it
    is.
    """

    bits: int
    """Number of bits per number [-]."""
    signed: bool = False
    """Whether it may be negative."""
    scale: str = "1"
    """Value of one step, in the unit."""
    unit: str = ""
    """Unit of the number."""
    description: str = ""
    """Description."""
    names: tuple[str, ...] = ()
    """Names of the numbers if the field has several; a single one has the field's name."""


def _number(scale: str, unit: str, description: str, *names: str) -> Signal:
    """Return the encoding of a signed number of 16 bits."""
    return Signal(
        bits=16, signed=True, scale=scale, unit=unit, description=description, names=names
    )


class NodeState(IntEnum):
    """State of a node."""

    STARTUP = 0
    """Power is on; the node listens, and sends nothing but its heartbeat."""
    CALIBRATING = 1
    """The node reads the offset of its angle sensor from memory, and tests its sensors."""
    READY = 2
    """No fault, and limp: the motor is off."""
    ACTIVE = 3
    """The motor follows the references."""
    HOLD = 4
    """References are missing; the node holds the last one."""
    LIMP = 5
    """References were missing for too long; the motor is off until the node is enabled again."""
    FAULT = 6
    """Something is wrong (see the flags of its heartbeat); the motor is off until the fault is gone and cleared."""

    @property
    def is_on(self) -> bool:
        """Whether the motor is on."""
        return self in (NodeState.ACTIVE, NodeState.HOLD)


class Order(IntEnum):
    """Order to a node."""

    ENABLE = 1
    """Follow references, starting at the present joint angle; from READY and LIMP."""
    DISABLE = 2
    """Turn the motor off."""
    SET_ZERO = 3
    """Make the present joint angle read `angle` from now on; from READY and LIMP."""
    CLEAR = 4
    """Clear the faults whose cause is gone."""


class Result(IntEnum):
    """Outcome of an order."""

    DONE = 0
    REFUSED = 1
    """Not allowed in this state."""
    UNKNOWN = 2
    """No such order."""


@dataclass(frozen=True, kw_only=True)
class EmergencyStop:
    """Turns all motors off at once, until they are cleared; anyone may send it."""

    reason: Annotated[int, Signal(8)] = 0
    """0 unknown, 1 the operator's key, 2 the supervisor, 3 a module [-]."""


@dataclass(frozen=True, kw_only=True)
class NodeCommand:
    """An order to one node, or to all of them; every addressed node answers with a `CommandReply`."""

    node: Annotated[int, Signal(8, description="0: all nodes")] = EVERY_NODE
    """Number of the node; 0: all nodes [-]."""
    order: Order
    """The order [-]."""
    angle: Annotated[
        float, _number("0.0001", "rad", "SET_ZERO: what the present joint angle is to read")
    ] = 0.0
    """For SET_ZERO: value that the present joint angle shall read [rad]."""


@dataclass(frozen=True, kw_only=True)
class Sync:
    """Instant at which all nodes apply their latest references, and measure."""

    counter: Annotated[int, Signal(16)]
    """Increases by one every time; 65535 is followed by 0 [-]."""


@dataclass(frozen=True, kw_only=True)
class References:
    """Reference angles of four consecutive joints, which take effect at the next `Sync`."""

    group: int
    """0: nodes 1 to 4, 1: nodes 5 to 8, and so on [-]."""
    angles: Annotated[
        tuple[float, float, float, float],
        _number("0.0001", "rad", "reference angle", "Angle1", "Angle2", "Angle3", "Angle4"),
    ]
    """phi_ref [rad]."""


@dataclass(frozen=True, kw_only=True)
class JointState:
    """A node's answer to every `Sync`: its measurements at that instant."""

    node: int
    """Number of the node [-]."""
    angle: Annotated[float, _number("0.0001", "rad", "joint angle")]
    """phi [rad]."""
    rate: Annotated[float, _number("0.001", "rad/s", "joint rate")]
    """phi' [rad/s]."""
    current: Annotated[float, _number("0.001", "A", "motor current")]
    """Current of the motor, at its own supply [A]."""
    torque: Annotated[float, _number("0.001", "Nm", "motor torque at the joint")]
    """Torque of the motor at the joint, from its current [N m]."""


@dataclass(frozen=True, kw_only=True)
class Loads:
    """Readings of the force/torque sensor at the joint, in the axes of the module on its tail side.

    They are what the part of the robot on the tail side does to the part on the head side.
    """

    node: int
    """Number of the node [-]."""
    force: Annotated[
        tuple[float, float, float] | None,
        _number(
            "0.01",
            "N",
            "force/torque sensor; -32768: not available",
            "ForceAlong",
            "ForceLeft",
            "ForceUp",
        ),
    ]
    """Force along, to the left, up; None if the sensor provides none [N]."""
    torque: Annotated[float, _number("0.001", "Nm", "force/torque sensor, about the joint's axis")]
    """Torque about the joint's axis [N m]."""


@dataclass(frozen=True, kw_only=True)
class Acceleration:
    """Readings of the accelerometer, in the axes of the module on the joint's tail side; at rest, it shows g upward."""

    node: int
    """Number of the node [-]."""
    along: Annotated[float, _number("0.001", "m/s2", "accelerometer")]
    """Component along the module [m/s^2]."""
    left: Annotated[float, _number("0.001", "m/s2", "accelerometer")]
    """Component to the left [m/s^2]."""
    up: Annotated[float, _number("0.001", "m/s2", "accelerometer")]
    """Upward component [m/s^2]."""


@dataclass(frozen=True, kw_only=True)
class Heartbeat:
    """Status of a node, sent ten times a second and at every change of its state."""

    node: int
    """Number of the node [-]."""
    state: NodeState
    """State of the node [-]."""
    leak: bool = False
    """Water in the module [-]."""
    over_temperature: bool = False
    """The motor was too hot [-]."""
    over_current: bool = False
    """The motor's current was too high for too long [-]."""
    stuck: bool = False
    """The joint did not move although the motor pulled [-]."""
    references_lost: bool = False
    """References were missing while the node was active [-]."""
    emergency_stopped: bool = False
    """An `EmergencyStop` was sent [-]."""
    not_calibrated: bool = False
    """The zero has not been set since power came on [-]."""
    bus_errors: bool = False
    """The node was off the bus since its last heartbeat [-]."""
    temperature: Annotated[float, _number("0.1", "degC", "of the motor")] = 20.0
    """Temperature of the motor [deg C]."""
    voltage: Annotated[float, Signal(16, scale="0.01", unit="V", description="of the supply")] = (
        35.0
    )
    """Voltage of the supply that runs through the modules [V]."""
    error_count: Annotated[int, Signal(8, description="transmit errors")] = 0
    """The controller's count of transmit errors, up to 255 [-]."""
    counter: Annotated[int, Signal(8, description="one more every time")] = 0
    """Increases by one every time; 255 is followed by 0 [-]."""

    @property
    def faults(self) -> tuple[str, ...]:
        """Names of the flags that keep a node in FAULT."""
        return tuple(name for name in FAULTS if getattr(self, name))


FAULTS = ("leak", "over_temperature", "over_current", "stuck", "emergency_stopped")
"""Flags of a heartbeat that keep a node in FAULT."""


@dataclass(frozen=True, kw_only=True)
class CommandReply:
    """A node's answer to a `NodeCommand`."""

    node: int
    """Number of the node [-]."""
    order: Annotated[int, Signal(8)]
    """Order that it answers; a number that is not an `Order` is returned unchanged [-]."""
    result: Result
    """Outcome of the order [-]."""
    state: NodeState
    """State of the node after the order [-]."""


CanMessage: TypeAlias = (
    EmergencyStop
    | NodeCommand
    | Sync
    | References
    | JointState
    | Loads
    | Acceleration
    | Heartbeat
    | CommandReply
)


def encode_references(angles: Sequence[float]) -> tuple[References, ...]:
    """Return the frames that carry the references of all joints.

    Args:
        angles: phi_ref of every joint, tail first, then of a driven fin [rad]; 1 to 19 of them.
            Places beyond the last one are zero.

    Raises:
        ValueError: If there are more joints than nodes, or none.
    """
    if not 1 <= len(angles) <= N_NODES:
        raise BadArgument(
            "angles", f"must be 1 to {N_NODES} numbers, one per joint, got {len(angles)}"
        )
    padded = [float(angle) for angle in angles]
    padded += [0.0] * (-len(padded) % REFERENCES_PER_FRAME)
    return tuple(
        References(
            group=k // REFERENCES_PER_FRAME,
            angles=(padded[k], padded[k + 1], padded[k + 2], padded[k + 3]),
        )
        for k in range(0, len(padded), REFERENCES_PER_FRAME)
    )
