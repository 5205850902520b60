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
from laticauda.values import to_quaternion

Point = tuple[float, float, float]

PORT = 22223
"""Port for clients that use the least significant byte first."""
VERSION = "1.25"
"""Version of the protocol."""
BANNER = "QTM RT Interface connected"
"""First text of a server."""
LARGEST_PACKET = 1 << 20
"""Bytes of a packet at most; those of a few bodies are far smaller."""
HEADER = struct.Struct("<II")
"""Size and type of a packet."""
DATA_HEADER = struct.Struct("<qII")
"""Time in microseconds, number of the frame, number of components."""
COMPONENT_HEADER = struct.Struct("<II")
"""Size and type of a component."""
BODIES_HEADER = struct.Struct("<ihh")
"""Number of bodies or markers, and two rates."""
SKELETONS_HEADER = struct.Struct("<i")
"""Number of skeletons."""
MARKER = struct.Struct("<4f")
"""Position and residual of a marker [mm]."""
SKELETON = struct.Struct("<ii7f")
"""Number of segments, number of the segment, its position [mm] and its quaternion, w last."""
LOST_POSITION = np.full(3, np.nan)
"""Position of a body that is not seen."""
FARTHEST = 1000.0
"""Distance from the origin of the cameras' frame beyond which no camera sees anything [m]."""
ROTATION_ERROR = 0.01
"""Largest error of a rotation matrix that is one: of the products of its columns [-]."""
NUMBERS_OF_POSE = 12
"""Numbers of a pose: three of its position, nine of its rotation."""


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


COMPONENTS: dict[str, Component] = {
    "6d": Component.BODIES,
    "3dres": Component.MARKERS,
    "6dres": Component.BODIES_RESIDUAL,
    "skeleton": Component.SKELETONS,
}
"""Components by their names in commands."""


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
    """Splits a stream of bytes into packets; keeps the bytes of incomplete packets until the rest arrives.

    Args:
        largest_packet: Bytes of a packet at most.
    """

    def __init__(self, largest_packet: int = LARGEST_PACKET) -> None:
        self._largest_packet = largest_packet
        self._unfinished = b""

    def feed(self, data: bytes) -> Iterator[tuple[int, bytes]]:
        """Yield type and payload of every packet completed by `data`.

        Raises:
            ProtocolError: If a packet states an impossible size; the stream is unusable from there
                on.
        """
        self._unfinished += data
        while len(self._unfinished) >= HEADER.size:
            size, kind = HEADER.unpack_from(self._unfinished)
            if not HEADER.size <= size <= self._largest_packet:
                raise ProtocolError(f"a packet claims to have {size} bytes")
            if len(self._unfinished) < size:
                return
            payload = self._unfinished[HEADER.size : size]
            self._unfinished = self._unfinished[size:]
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
    microseconds = round(frame.timestamp * 1e6)
    header = DATA_HEADER.pack(microseconds, frame.number & 0xFFFFFFFF, len(components))
    encoded = [_encode_component(frame, component, points) for component in components]
    return encode_packet(PacketType.DATA, b"".join([header, *encoded]))


def _encode_component(frame: MocapFrame, component: Component, points: Sequence[Point]) -> bytes:
    """Encode one component of a data packet: headers, then the numbers of all bodies."""
    count = len(frame.bodies)
    if component == Component.MARKERS:
        count *= len(points)
    if component == Component.SKELETONS:
        count_header = SKELETONS_HEADER.pack(count)
    else:
        count_header = BODIES_HEADER.pack(count, 0, 0)
    bodies = b"".join(_encode_body(body, component, points) for body in frame.bodies)
    content = count_header + bodies
    return COMPONENT_HEADER.pack(COMPONENT_HEADER.size + len(content), component) + content


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
    sections: list[str] = []
    if "general" in asked:
        sections.append(f"<General><Frequency>{frequency:g}</Frequency></General>")
    if "3d" in asked:
        labels = [_label_xml(name, k) for name in bodies for k in range(len(bodies[name]))]
        sections.append(f"<The_3D>{''.join(labels)}</The_3D>")
    if "skeleton" in asked:
        skeletons = [_skeleton_xml(name) for name in bodies]
        sections.append(f"<Skeletons>{''.join(skeletons)}</Skeletons>")
    if "6d" in asked:
        listed = [_body_xml(name, points) for name, points in bodies.items()]
        sections.append(f"<The_6D>{''.join(listed)}</The_6D>")
    return f"<QTM_Parameters_Ver_{VERSION}>{''.join(sections)}</QTM_Parameters_Ver_{VERSION}>"


def _label_xml(body: str, k: int) -> str:
    return f"<Label><Name>{escape(body)}-{k}</Name></Label>"


def _skeleton_xml(body: str) -> str:
    return f'<Skeleton Name={quoteattr(body)}><Segment Name="body" ID="1"/></Skeleton>'


def _body_xml(name: str, points: Sequence[Point]) -> str:
    listed = "".join(
        f'<Point X="{1e3 * x:.3f}" Y="{1e3 * y:.3f}" Z="{1e3 * z:.3f}" '
        'Virtual="0" PhysicalId="0" Name=""/>'
        for x, y, z in points
    )
    return (
        f"<Body><Name>{escape(name)}</Name><Enabled>True</Enabled><Points>{listed}</Points></Body>"
    )


def _encode_body(body: BodyPose | None, component: Component, points: Sequence[Point]) -> bytes:
    """Encode a body's numbers as one component."""
    if component == Component.MARKERS:
        return _encode_markers(body, points)
    if component == Component.SKELETONS:
        return _encode_skeleton(body)
    n_numbers = NUMBERS_OF_POSE
    if component == Component.BODIES_RESIDUAL:
        n_numbers += 1
    if body is None:
        numbers = [math.nan] * n_numbers
    else:
        numbers = [*1e3 * body.position, *body.rotation.T.ravel(), 1e3 * body.residual]
    return struct.pack(f"<{n_numbers}f", *numbers[:n_numbers])


def _encode_markers(body: BodyPose | None, points: Sequence[Point]) -> bytes:
    if body is None:
        positions = np.full((len(points), 3), np.nan)
    else:
        positions = body.position + np.array(points) @ body.rotation.T
    return b"".join(MARKER.pack(*(1e3 * position).tolist(), 0.0) for position in positions)


def _encode_skeleton(body: BodyPose | None) -> bytes:
    """Encode a skeleton of one segment."""
    if body is None:
        position = LOST_POSITION
        w, x, y, z = [math.nan] * 4
    else:
        position = body.position
        w, x, y, z = to_quaternion(body.rotation)
    return SKELETON.pack(1, 1, *(1e3 * position).tolist(), x, y, z, w)


def body_pose(numbers: Sequence[float]) -> BodyPose | None:
    """Return the pose given by a body's numbers: position [mm], rotation by columns, and perhaps the residual [mm].

    Returns:
        The pose, or None if a number of its position or rotation is not finite: the body was not
        seen. A place beyond all cameras and a matrix that turns nothing are no pose either.
    """
    if not all(math.isfinite(number) for number in numbers[:NUMBERS_OF_POSE]):
        return None
    residual = math.nan
    if len(numbers) > NUMBERS_OF_POSE and 0.0 <= numbers[NUMBERS_OF_POSE] < math.inf:
        residual = 1e-3 * numbers[NUMBERS_OF_POSE]
    position = 1e-3 * np.array(numbers[:3])
    rotation = np.array(numbers[3:NUMBERS_OF_POSE]).reshape(3, 3).T
    if np.abs(position).max() > FARTHEST or not _is_rotation(rotation):
        return None
    return BodyPose(position=position, rotation=rotation, residual=residual)


def _is_rotation(matrix: Float[np.ndarray, "3 3"]) -> bool:
    """Return whether a matrix is a rotation, and not a mirror or anything else."""
    if np.abs(matrix).max() > 1.0 + ROTATION_ERROR:
        return False
    error = np.abs(matrix @ matrix.T - np.eye(3)).max()
    return bool(error <= ROTATION_ERROR and np.linalg.det(matrix) > 0.0)
