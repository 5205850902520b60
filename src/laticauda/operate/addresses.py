"""Where bus and cameras are, as somebody types it."""

from dataclasses import replace
from typing import Any

from laticauda.operate.settings import Connection
from laticauda.protocol import bus_address


def addressed(usual: Connection, *, can: str | None = None, mocap: str | None = None) -> Connection:
    """Connections with other addresses.

    Args:
        usual: What holds otherwise.
        can: The bus: udp_multicast:GROUP:PORT, virtual:NAME or socketcan:can0; None: as usual.
        mocap: The motion capture: HOST:PORT; None: as usual.

    Raises:
        ValueError: If one is none.
    """
    changes: dict[str, Any] = {}
    if can is not None:
        address = bus_address(can)
        changes |= {"can_interface": address.interface, "can_channel": address.channel, "can_port": address.port}
    if mocap is not None:
        host, _, port = mocap.rpartition(":")
        if not host or not port.isdigit():
            raise ValueError(f"`mocap` must be HOST:PORT, got {mocap!r}.")
        changes |= {"mocap_host": host, "mocap_port": int(port)}
    return replace(usual, **changes)
