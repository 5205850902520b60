"""What goes over the wires: the modules' CAN bus (`mamba.dbc`), the motion capture's packets, the power meter's lines.

No heavy library is loaded until a frame is encoded or a bus is opened.
"""

from laticauda.protocol.bus import BusAddress, BusFailed, bus_address, open_bus
from laticauda.protocol.can import decode, encode, from_frame, from_node, to_frame
from laticauda.protocol.bus import BusLoad, Traffic, bus_load, frame_bits
from laticauda.protocol.messages import (
    EVERY_NODE,
    FAULTS,
    N_NODES,
    Acceleration,
    CanMessage,
    CommandReply,
    EmergencyStop,
    Heartbeat,
    JointState,
    Loads,
    NodeCommand,
    NodeState,
    Order,
    ProtocolError,
    References,
    Result,
    Sync,
    references,
)
from laticauda.protocol.meter import MeterIdentity, MeterReading
from laticauda.protocol.qtm import BodyPose, MocapFrame

__all__ = [
    "EVERY_NODE",
    "FAULTS",
    "N_NODES",
    "Acceleration",
    "BodyPose",
    "BusAddress",
    "BusFailed",
    "BusLoad",
    "CanMessage",
    "CommandReply",
    "EmergencyStop",
    "Heartbeat",
    "JointState",
    "Loads",
    "MeterIdentity",
    "MeterReading",
    "MocapFrame",
    "NodeCommand",
    "NodeState",
    "Order",
    "ProtocolError",
    "References",
    "Result",
    "Sync",
    "Traffic",
    "bus_address",
    "bus_load",
    "decode",
    "encode",
    "frame_bits",
    "from_frame",
    "from_node",
    "open_bus",
    "references",
    "to_frame",
]
