"""Packets of the real-time protocol of Qualisys Track Manager (QTM), version 1.25, which the tank's cameras use.

A packet consists of its size and its type, each four bytes, least significant first, and its
payload. Positions are in mm on the wire and in m here; rotation matrices are sent column by column.
A body that is not seen has nan in all its numbers on the wire, and is None here.

References:
    Qualisys AB, "QTM Real-time Server Protocol Documentation", version 1.25; qualisys/qualisys_python_sdk.
"""

import math
import struct
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from enum import IntEnum
from xml.sax.saxutils import escape, quoteattr

import numpy as np
from jaxtyping import Float

from laticauda.tank.protocol.messages import ProtocolError
from laticauda.values.angles import to_quaternion

Point = tuple[float, float, float]

PORT = 22223  # for clients that use the least significant byte first
VERSION = "1.25"
BANNER = "QTM RT Interface connected"
LARGEST = 1 << 20  # bytes; packets of a few bodies are far smaller
HEADER = struct.Struct("<II")
DATA_HEADER = struct.Struct("<qII")
COMPONENT_HEADER = struct.Struct("<II")
BODIES_HEADER = struct.Struct("<ihh")
LOST = np.full(3, np.nan)


class PacketType(IntEnum):
    """Content of a packet."""

    ERROR = 0
    COMMAND = 1
    XML = 2
    DATA = 3
    NO_MORE_DATA = 4
    EVENT = 6


class Event(IntEnum):
    """Event that a server reports."""

    CONNECTED = 1
    SHUTTING_DOWN = 11


class Component(IntEnum):
    """Component of a frame that a data packet may contain."""

    BODIES = 5
    MARKERS = 9
    BODIES_RESIDUAL = 11
    SKELETONS = 18


COMPONENTS: dict[str, Component] = dict(
    zip(("6d", "3dres", "6dres", "skeleton"), Component, strict=True)
)


@dataclass(frozen=True, kw_only=True, eq=False)
class BodyPose:
    """Pose of a body as seen by the cameras."""

    position: Float[np.ndarray, " 3"]
    """Position of its origin, in the cameras' frame [m]."""
    rotation: Float[np.ndarray, "3 3"]
    """Its axes as columns, in the cameras' frame [-]."""
    residual: float = math.nan
    """Mean distance of its markers from their positions according to the pose; nan: not requested [m]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MocapFrame:
    """All bodies at one instant."""

    timestamp: float
    """Time on the cameras' clock [s]."""
    number: int
    """Increases by one every frame; lost frames leave gaps [-]."""
    bodies: tuple[BodyPose | None, ...]
    """Poses in the order of the server's list; None: not seen."""


def encode_packet(kind: PacketType, payload: bytes) -> bytes:
    """Encode a packet for transmission."""
    return HEADER.pack(HEADER.size + len(payload), kind) + payload


def encode_text(text: str, kind: PacketType = PacketType.COMMAND) -> bytes:
    """Encode the packet of a command, an answer, an error or an XML text."""
    return encode_packet(kind, text.encode() + b"\0")


def encode_event(event: Event) -> bytes:
    """Encode the packet of an event."""
    return encode_packet(PacketType.EVENT, bytes([event]))


class PacketReader:
    """Splits a stream of bytes into packets; keeps the bytes of incomplete packets until the rest arrives."""

    def __init__(self) -> None:
        self._waiting = b""

    def feed(self, data: bytes) -> Iterator[tuple[int, bytes]]:
        """Yield type and payload of every packet completed by `data`.

        Raises:
            ProtocolError: If a packet states an impossible size; the stream is unusable from there
                on.
        """
        self._waiting += data
        while len(self._waiting) >= HEADER.size:
            size, kind = HEADER.unpack_from(self._waiting)
            if not HEADER.size <= size <= LARGEST:
                raise ProtocolError(f"a packet claims to have {size} bytes")
            if len(self._waiting) < size:
                return
            payload, self._waiting = self._waiting[HEADER.size : size], self._waiting[size:]
            yield kind, payload


def decode_text(payload: bytes) -> str:
    """Return the text in the payload of a command, an error or an XML packet; invalid UTF-8 is replaced."""
    return payload.split(b"\0", 1)[0].decode(errors="replace")


def encode_frame(
    frame: MocapFrame,
    components: Sequence[Component] = (Component.BODIES_RESIDUAL,),
    points: Sequence[Point] = (),
) -> bytes:
    """Encode the data packet of a frame.

    Args:
        frame: Frame that the cameras saw.
        components: Components to send; as a skeleton, every body has one segment.
        points: Positions of the markers of every body in its own axes [m].
    """
    parts = [
        DATA_HEADER.pack(round(frame.timestamp * 1e6), frame.number & 0xFFFFFFFF, len(components))
    ]
    for component in components:
        body = b"".join(_body_bytes(body, component, points) for body in frame.bodies)
        count = len(frame.bodies) * (len(points) if component == Component.MARKERS else 1)
        head = BODIES_HEADER.pack(count, 0, 0)[: 4 if component == Component.SKELETONS else None]
        parts += [
            COMPONENT_HEADER.pack(COMPONENT_HEADER.size + len(head + body), component),
            head,
            body,
        ]
    return encode_packet(PacketType.DATA, b"".join(parts))


def answer_parameters(
    frequency: float, bodies: Mapping[str, Sequence[Point]], asked: Set[str]
) -> str:
    """Return the answer to `getparameters`.

    Args:
        frequency: Frames per second [Hz].
        bodies: Positions of the markers of every body in its own axes, by its name [m].
        asked: Any of `general`, `6d`, `3d` (the labels of all markers) and `skeleton` (one of one
            segment per body).
    """
    said = f"<General><Frequency>{frequency:g}</Frequency></General>" if "general" in asked else ""
    if "3d" in asked:
        labels = (
            f"{escape(name)}-{k}" for name, points in bodies.items() for k in range(len(points))
        )
        said += f"<The_3D>{''.join(f'<Label><Name>{label}</Name></Label>' for label in labels)}</The_3D>"
    if "skeleton" in asked:
        skeletons = (
            f'<Skeleton Name={quoteattr(name)}><Segment Name="body" ID="1"/></Skeleton>'
            for name in bodies
        )
        said += f"<Skeletons>{''.join(skeletons)}</Skeletons>"
    listed = "".join(
        f"<Body><Name>{escape(name)}</Name><Enabled>True</Enabled><Points>"
        + "".join(
            f'<Point X="{1e3 * x:.3f}" Y="{1e3 * y:.3f}" Z="{1e3 * z:.3f}" Virtual="0" PhysicalId="0" Name=""/>'
            for x, y, z in points
        )
        + "</Points></Body>"
        for name, points in bodies.items()
    )
    said += f"<The_6D>{listed}</The_6D>" if "6d" in asked else ""
    return f"<QTM_Parameters_Ver_{VERSION}>{said}</QTM_Parameters_Ver_{VERSION}>"


def _body_bytes(body: BodyPose | None, component: Component, points: Sequence[Point]) -> bytes:
    """Encode a body's numbers as one component."""
    if component == Component.MARKERS:
        at = (
            np.full((len(points), 3), np.nan)
            if body is None
            else body.position + np.array(points) @ body.rotation.T
        )
        return b"".join(struct.pack("<4f", *(1e3 * place).tolist(), 0.0) for place in at)
    if component == Component.SKELETONS:
        place, (w, *xyz) = (
            (body.position, to_quaternion(body.rotation)) if body else (LOST, [math.nan] * 4)
        )
        return struct.pack("<ii7f", 1, 1, *(1e3 * place).tolist(), *xyz, w)
    n = 12 + (component == Component.BODIES_RESIDUAL)
    if body is None:
        return struct.pack(f"<{n}f", *[math.nan] * n)
    numbers = (*1e3 * body.position, *body.rotation.T.ravel(), 1e3 * body.residual)
    return struct.pack(f"<{n}f", *numbers[:n])


def body_pose(numbers: Sequence[float]) -> BodyPose | None:
    """Return the pose given by a body's numbers: position [mm], rotation by columns, and perhaps the residual [mm].

    Returns:
        The pose, or None if a number of its position or rotation is not finite: the body was not
            seen.
    """
    if not all(math.isfinite(number) for number in numbers[:12]):
        return None
    residual = 1e-3 * numbers[12] if len(numbers) > 12 else math.nan
    rotation = np.array(numbers[3:12]).reshape(3, 3).T
    return BodyPose(position=1e-3 * np.array(numbers[:3]), rotation=rotation, residual=residual)
