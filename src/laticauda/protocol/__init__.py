"""Wire protocols: the modules' CAN bus (`mamba.dbc`), the motion capture's packets, and the power meter's lines.

No heavy library is loaded until a frame is encoded or a bus is opened.
"""

from typing import TYPE_CHECKING

from laticauda.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.protocol.can import (
        BusAddress as BusAddress,
        BusFailed as BusFailed,
        bus_address as bus_address,
    )
    from laticauda.protocol.can import open_bus as open_bus
    from laticauda.protocol.can import decode as decode, encode as encode, from_frame as from_frame
    from laticauda.protocol.can import from_node as from_node, to_frame as to_frame
    from laticauda.protocol.messages import (
        EVERY_NODE as EVERY_NODE,
        FAULTS as FAULTS,
        N_NODES as N_NODES,
    )
    from laticauda.protocol.messages import Acceleration as Acceleration, CanMessage as CanMessage
    from laticauda.protocol.messages import (
        CommandReply as CommandReply,
        EmergencyStop as EmergencyStop,
    )
    from laticauda.protocol.messages import (
        Heartbeat as Heartbeat,
        JointState as JointState,
        Loads as Loads,
    )
    from laticauda.protocol.messages import (
        NodeCommand as NodeCommand,
        NodeState as NodeState,
        Order as Order,
    )
    from laticauda.protocol.messages import (
        ProtocolError as ProtocolError,
        References as References,
        Result as Result,
    )
    from laticauda.protocol.messages import Sync as Sync, references as references
    from laticauda.protocol.meter import MeterReading as MeterReading
    from laticauda.protocol.qtm import BodyPose as BodyPose, MocapFrame as MocapFrame

__getattr__, __dir__, __all__ = lazy_exports()
