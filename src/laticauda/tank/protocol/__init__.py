"""Wire protocols: the modules' CAN bus (`mamba.dbc`), the motion capture's packets, and the power meter's lines.

No heavy library is loaded until a frame is encoded or a bus is opened.

messages    what modules and operator say to each other, one class a message
layouts     which numbers of a message stand at which bits of its frame
packing     messages to bytes, and back
can         frames and buses of python-can
qtm         packets of the motion capture
meter       lines of the power meter
worker      a thread that survives exceptions, common to all drivers
clock       the operator's clock, and real-time priority
"""

from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.tank.protocol.can import (
        BusAddress as BusAddress,
        BusFailed as BusFailed,
        bus_address as bus_address,
        from_frame as from_frame,
        open_bus as open_bus,
        to_frame as to_frame,
    )
    from laticauda.tank.protocol.messages import (
        Acceleration as Acceleration,
        CanMessage as CanMessage,
        CommandReply as CommandReply,
        EVERY_NODE as EVERY_NODE,
        EmergencyStop as EmergencyStop,
        FAULTS as FAULTS,
        Heartbeat as Heartbeat,
        JointState as JointState,
        Loads as Loads,
        N_NODES as N_NODES,
        NodeCommand as NodeCommand,
        NodeState as NodeState,
        Order as Order,
        ProtocolError as ProtocolError,
        References as References,
        Result as Result,
        Sync as Sync,
        encode_references as encode_references,
    )
    from laticauda.tank.protocol.meter import MeterReading as MeterReading
    from laticauda.tank.protocol.packing import (
        decode as decode,
        encode as encode,
        from_node as from_node,
    )
    from laticauda.tank.protocol.qtm import BodyPose as BodyPose, MocapFrame as MocapFrame
    from laticauda.tank.protocol.worker import hardware as hardware

__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.tank.protocol.can": [
            "BusAddress",
            "BusFailed",
            "bus_address",
            "from_frame",
            "open_bus",
            "to_frame",
        ],
        "laticauda.tank.protocol.messages": [
            "Acceleration",
            "CanMessage",
            "CommandReply",
            "EVERY_NODE",
            "EmergencyStop",
            "FAULTS",
            "Heartbeat",
            "JointState",
            "Loads",
            "N_NODES",
            "NodeCommand",
            "NodeState",
            "Order",
            "ProtocolError",
            "References",
            "Result",
            "Sync",
            "encode_references",
        ],
        "laticauda.tank.protocol.meter": ["MeterReading"],
        "laticauda.tank.protocol.packing": ["decode", "encode", "from_node"],
        "laticauda.tank.protocol.qtm": ["BodyPose", "MocapFrame"],
    },
    plain={
        "laticauda.tank.protocol.worker": ["hardware"],
    },
    renamed={"references": "encode_references"},
)
