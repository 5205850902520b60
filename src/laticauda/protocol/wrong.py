"""What is wrong with what came over a connection."""

from laticauda.errors import LaticaudaError


class ProtocolError(LaticaudaError, ValueError):
    """What came over a connection breaks its protocol: it says how."""
