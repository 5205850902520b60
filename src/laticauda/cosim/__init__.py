"""Other tools drive our plants.

A server that Octave, MATLAB and anything with sockets and JSON can talk to, and FMUs, which run without Python.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from laticauda.cosim.messages import MESSAGE_BYTES, PROTOCOL_VERSION

if TYPE_CHECKING:
    from laticauda.cosim.fmu import LinkingFailed, export_fmu
    from laticauda.cosim.server import Server, ServerFailed
    from laticauda.cosim.session import Session
    from laticauda.cosim.setup import Setup

__all__ = [
    "MESSAGE_BYTES",
    "PROTOCOL_VERSION",
    "LinkingFailed",
    "Server",
    "ServerFailed",
    "Session",
    "Setup",
    "export_fmu",
    "matlab_folder",
]

_HOMES = {
    "LinkingFailed": "fmu",
    "Server": "server",
    "ServerFailed": "server",
    "Session": "session",
    "Setup": "setup",
    "export_fmu": "fmu",
}


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        from importlib import import_module

        return getattr(import_module(f"laticauda.cosim.{_HOMES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def matlab_folder() -> Path:
    """The folder with the client for GNU Octave and MATLAB, to be added to their path."""
    return Path(__file__).parent / "matlab"
