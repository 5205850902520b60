"""Driver of the motion capture, with the vendor's own client, whose event loop runs in a thread."""

# qtm_rt has no types: this module passes typed frames on.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportUnknownLambdaType=false

import asyncio
import logging
import threading
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any, NamedTuple
from xml.etree import ElementTree

import numpy as np

from laticauda.control.estimation import PoseSample
from laticauda.tank.operate.drivers.base import MotionCapture, host_and_port
from laticauda.tank.protocol.clock import Clock
from laticauda.tank.protocol.qtm import LOST_POSITION, BodyPose, PacketReader, body_pose
from laticauda.tank.protocol.worker import DeviceFailed, hardware
from laticauda.values import from_quaternion

CONNECT_TIME = 5.0
"""Longest wait for a connection [s, wall clock]."""
ANSWER_TIME = CONNECT_TIME + 2.0
"""Longest wait until the body has been found, too [s, wall clock]."""
LOOK_INTERVAL = 0.05
"""Time between two looks at whether the connection is to end [s, wall clock]."""
LARGEST_PACKET = 1 << 24
"""Bytes of a packet at most; the parameters of many skeletons are the largest."""
N_LISTED = 20
"""Names that a message lists at most."""
TICKS_PER_SECOND = 1e6
"""Ticks of the clock by which packets are stamped [1/s]."""


def pose_sample(time: float, pose: BodyPose | None) -> PoseSample:
    """Return the pose sample of a body.

    Args:
        time: Time at which the cameras took the frame [s].
        pose: Pose of the body; None: not seen.
    """
    if pose is None:
        return PoseSample(time=time, position=LOST_POSITION)
    residual = 0.0 if np.isnan(pose.residual) else pose.residual
    return PoseSample(time=time, position=pose.position, rotation=pose.rotation, residual=residual)


def _pose_of_body(packet: Any, indices: Sequence[int]) -> BodyPose | None:
    """Return the pose of a rigid body."""
    _, bodies = packet.get_6d_residual()
    position, matrix, residual = bodies[indices[0]]
    return body_pose((*position, *matrix.matrix, *residual))


def _pose_of_markers(packet: Any, indices: Sequence[int]) -> BodyPose | None:
    """Return the pose of three labeled markers: front, back and left.

    The x axis goes from the second to the first, the origin is midway, and y is toward the third.
    """
    _, markers = packet.get_3d_markers_residual()
    front, back, left = np.array([markers[index][:3] for index in indices])
    x_axis = front - back
    z_axis = np.cross(x_axis, left - back)
    if not np.linalg.norm(z_axis) > 0.0:  # a marker is not seen, or the three are collinear
        return None
    y_axis = np.cross(z_axis, x_axis)
    unit_axes = [axis / np.linalg.norm(axis) for axis in (x_axis, y_axis, z_axis)]
    origin = 0.5 * (front + back)
    return body_pose((*origin.tolist(), *np.concatenate(unit_axes).tolist()))


def _pose_of_segment(packet: Any, indices: Sequence[int]) -> BodyPose | None:
    """Return the pose of a skeleton's segment."""
    _, skeletons = packet.get_skeletons()
    segments: list[Any] = []
    for skeleton in skeletons:
        segments += skeleton
    _, position, quaternion = segments[indices[0]]
    rotation = from_quaternion(quaternion.w, quaternion.x, quaternion.y, quaternion.z)
    return body_pose((*position, *rotation.T.ravel().tolist()))


class BodyForm(NamedTuple):
    """What a body is in QTM: one of three kinds."""

    parameters: str
    """QTM's name of the parameters that list them."""
    description: str
    """What they are, in messages."""
    component: str
    """Component of a packet that has them."""
    pose: Callable[[Any, Sequence[int]], BodyPose | None]
    """Returns the pose from a packet, and indices in the list; None: not seen."""


RIGID_BODY = BodyForm(parameters="6d", description="bodies", component="6dres", pose=_pose_of_body)
THREE_MARKERS = BodyForm(
    parameters="3d", description="markers", component="3dres", pose=_pose_of_markers
)
SEGMENT = BodyForm(
    parameters="skeleton", description="segments", component="skeleton", pose=_pose_of_segment
)


def _form_of(body: str) -> BodyForm:
    """Return what a name stands for: NAME, FRONT+BACK+LEFT or SKELETON/SEGMENT."""
    if "/" in body:
        return SEGMENT
    if body.count("+") == 2:
        return THREE_MARKERS
    return RIGID_BODY


class MocapDriver(MotionCapture):
    """A body in QTM; the address is HOST:PORT, with the port for the least significant byte first.

    The body is a rigid body NAME, three labeled markers FRONT+BACK+LEFT or a segment
    SKELETON/SEGMENT.
    """

    called = "qtm"

    def __init__(self, address: str, clock: Clock, body: str = "") -> None:
        super().__init__(address, clock, body)
        self._qtm = hardware("qtm-rt", "qtm_rt")
        # Our own messages report its errors.
        logging.getLogger("qtm_rt").addHandler(logging.NullHandler())
        _bound_packets()
        self._form = _form_of(body)
        self._indices: list[int] = []
        """Indices of the body, or of its markers, in the server's list."""
        self._first_error: DeviceFailed | None = None
        self._wire_error: Exception | None = None
        """Why the vendor's client gave up the connection; None: it did not."""
        self._ready = threading.Event()
        self._start()
        has_answered = self._ready.wait(ANSWER_TIME)
        if not has_answered or self._first_error is not None:
            error = self._first_error or DeviceFailed(
                f"The motion capture at {address} does not answer."
            )
            self.close()
            raise error

    @classmethod
    def check(cls, address: str) -> None:
        """See `Driver.check`."""
        host_and_port(address)

    def work(self) -> None:
        """Handle one connection, from beginning to end."""
        try:
            asyncio.run(self._connected())
        except Exception as error:
            if not self._ready.is_set():  # the first error is for the creator of this driver
                self._first_error = self._explain(error)
                self._ready.set()
            raise

    def _explain(self, error: Exception) -> DeviceFailed:
        if isinstance(error, DeviceFailed):
            return error
        device = f"The motion capture at {self._address}"
        if self._wire_error is not None:
            return DeviceFailed(f"{device} does not speak QTM's protocol: {self._wire_error}.")
        if isinstance(error, TimeoutError):
            return DeviceFailed(f"{device} does not answer: check that QTM runs there.")
        if isinstance(error, ElementTree.ParseError):
            return DeviceFailed(f"{device} gives parameters that are no XML: {error}.")
        return DeviceFailed(f"{device} fails: {error!r}.")

    def _note_wire_error(self, _: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        """Keep an error that asyncio would print, with a traceback."""
        self._wire_error = context.get("exception") or self._wire_error

    async def _connected(self) -> None:
        host, port = host_and_port(self._address)
        is_gone = asyncio.Event()
        self._wire_error = None
        asyncio.get_running_loop().set_exception_handler(self._note_wire_error)
        connecting = self._qtm.connect(
            host, port, on_disconnect=lambda _: is_gone.set(), timeout=CONNECT_TIME
        )
        link: Any = await asyncio.wait_for(connecting, CONNECT_TIME)
        if link is None:
            raise DeviceFailed(
                f"The motion capture at {self._address} cannot be reached: check that QTM runs "
                "there, and that its real-time server has this port."
            )
        try:
            await self._find_body(link)
            # The client waits for the first frame; cameras that do not measure yet are not a
            # connection error.
            stream = link.stream_frames(
                frames="allframes", components=[self._form.component], on_packet=self._on_packet
            )
            streaming = asyncio.ensure_future(stream)
            # Its result is not awaited: whether frames arrive says the same.
            streaming.add_done_callback(lambda future: future.cancelled() or future.exception())
            self._trouble = ""
            self._ready.set()
            while not (self._ended.is_set() or is_gone.is_set()):
                await asyncio.sleep(LOOK_INTERVAL)
        finally:
            if link.has_transport():
                link.disconnect()
                await asyncio.sleep(0.0)  # lets the transport close
        if is_gone.is_set() and not self._ended.is_set():
            device = f"the motion capture at {self._address}"
            if self._wire_error is not None:
                raise DeviceFailed(f"{device} does not speak QTM's protocol: {self._wire_error}")
            raise DeviceFailed(f"{device} closed the connection")

    async def _find_body(self, link: Any) -> None:
        """Find the indices of the body in the list."""
        answer = await link.get_parameters([self._form.parameters])
        names = _names(ElementTree.fromstring(answer))
        listed = ", ".join(names[:N_LISTED]) or "none"
        if len(names) > N_LISTED:
            listed += f" and {len(names) - N_LISTED} more"
        if not self._body and len(names) != 1:
            raise DeviceFailed(
                f"The body must be named by `mocap_body`: the motion capture has {listed}."
            )
        body_names = [self._body or names[0]]
        if self._form is THREE_MARKERS:
            body_names = self._body.split("+")
        for name in body_names:
            if name not in names:
                raise DeviceFailed(
                    f"The motion capture has no {name!r} among its {self._form.description}: "
                    f"{listed}."
                )
        self._indices = [names.index(name) for name in body_names]

    def _on_packet(self, packet: Any) -> None:
        """Take in one packet, in the thread of the event loop."""
        arrival = self._clock.now()
        try:
            pose = self._form.pose(packet, self._indices)
            stamp = packet.timestamp / TICKS_PER_SECOND
        except Exception as error:  # an invalid packet is a lost frame
            self._trouble = f"invalid packet from the motion capture: {error}"
            return
        self._received.append((arrival, pose_sample(stamp, pose)))


def _bound_packets() -> None:
    """Let the vendor's client refuse packets of impossible sizes.

    By itself it reads one of no bytes forever, and keeps all that comes of one of gigabytes.
    """
    vendor_receiver: Any = import_module("qtm_rt.receiver").Receiver

    class BoundedReceiver(vendor_receiver):
        def __init__(self, handlers: Any) -> None:
            super().__init__(handlers)
            self._reader = PacketReader(LARGEST_PACKET)

        def data_received(self, data: bytes) -> None:
            for kind, payload in self._reader.feed(data):
                self._parse_received(payload, kind)

    vendor_protocol: Any = import_module("qtm_rt.protocol")
    vendor_protocol.Receiver = BoundedReceiver


def _names(parameters: ElementTree.Element) -> list[str]:
    """Return the names of all bodies, labels or segments, in the order of the packets."""
    names: list[str] = []
    for skeleton in parameters.iter("Skeleton"):
        for segment in skeleton.iter("Segment"):
            names.append(f"{skeleton.get('Name')}/{segment.get('Name')}")
    for path in (".//Body/Name", ".//Label/Name"):
        for element in parameters.findall(path):
            names.append((element.text or "").strip())
    return names
