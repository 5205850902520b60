"""Co-simulation: plants driven by other tools; and animats of FARMS, which are read.

A server for Octave, MATLAB and any other program with sockets and JSON, and FMUs and C libraries,
which run without Python.

- `server`: sockets, threads and limits of the TCP server
- `session`: requests and answers of one client
- `world`: a client's robot, and its log in `history`
- `messages`: lines of JSON, and the fields of requests; `decoding`: from fields to values
- `schema`: JSON Schema of the messages
- `budget`: memory limits
- `native`: planar kernels without Python, and libraries in C
- `fmu`, `web`: FMUs, and web pages without a server
- `farms`: animats of FARMS, read as robots and networks
- `clients`: programs in other languages that talk to the server
"""

from pathlib import Path
from typing import TYPE_CHECKING

from laticauda.values import lazy_exports

if TYPE_CHECKING:
    from laticauda.connect.farms import FarmsAnimat as FarmsAnimat, load_farms as load_farms
    from laticauda.connect.fmu import LinkingFailed as LinkingFailed, export_fmu as export_fmu
    from laticauda.connect.messages import (
        MESSAGE_BYTES as MESSAGE_BYTES,
        PROTOCOL_VERSION as PROTOCOL_VERSION,
    )
    from laticauda.connect.native.c_library import export_c as export_c
    from laticauda.connect.schema import message_schema as message_schema
    from laticauda.connect.server import Server as Server, ServerFailed as ServerFailed
    from laticauda.connect.session import Session as Session
    from laticauda.connect.slider_ranges import LIMITS as LIMITS


def clients_folder() -> Path:
    """Return the folder of the server's clients: `c`, `julia`, and `matlab`, also for GNU Octave."""
    return Path(__file__).parent / "clients"


__getattr__, __dir__, __all__ = lazy_exports(
    __name__,
    {
        "laticauda.connect.farms": ["FarmsAnimat", "load_farms"],
        "laticauda.connect.fmu": ["LinkingFailed", "export_fmu"],
        "laticauda.connect.messages": ["MESSAGE_BYTES", "PROTOCOL_VERSION"],
        "laticauda.connect.native.c_library": ["export_c"],
        "laticauda.connect.schema": ["message_schema"],
        "laticauda.connect.server": ["Server", "ServerFailed"],
        "laticauda.connect.session": ["Session"],
    },
    own=["clients_folder"],
    plain={"laticauda.connect.slider_ranges": ["LIMITS"]},
)
