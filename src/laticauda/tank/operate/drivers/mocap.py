"""Driver of the motion capture, with the vendor's own client package, whose event loop runs in a thread."""

# qtm_rt has no types: this module passes typed frames on.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false
# pyright: reportUnknownLambdaType=false

import asyncio
import logging
import threading
from collections.abc import Sequence
from typing import Any
from xml.etree import ElementTree

import numpy as np

from laticauda.control.estimation import PoseSample
from laticauda.tank.operate.drivers.base import MotionCapture, host_and_port
from laticauda.tank.protocol.clock import Clock
from laticauda.tank.protocol.qtm import LOST_POSITION, BodyPose, body_pose
from laticauda.tank.protocol.worker import DeviceFailed, hardware
from laticauda.values.angles import from_quaternion

CONNECT_TIME = 5.0  # [s, wall clock]


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


def _of_body(packet: Any, at: Sequence[int]) -> BodyPose | None:
    """Return the pose of a rigid body."""
    position, matrix, residual = packet.get_6d_residual()[1][at[0]]
    return body_pose((*position, *matrix.matrix, *residual))


def _of_markers(packet: Any, at: Sequence[int]) -> BodyPose | None:
    """Return the pose of three labeled markers: x from the second to the first, origin midway, y toward the third."""
    front, back, left = np.array([packet.get_3d_markers_residual()[1][one][:3] for one in at])
    x, z = front - back, np.cross(front - back, left - back)
    if not np.linalg.norm(z) > 0.0:  # a marker is not seen, or the three are collinear
        return None
    axes = [axis / np.linalg.norm(axis) for axis in (x, np.cross(z, x), z)]
    return body_pose((*(0.5 * (front + back)).tolist(), *np.concatenate(axes).tolist()))


def _of_segment(packet: Any, at: Sequence[int]) -> BodyPose | None:
    """Return the pose of a skeleton's segment."""
    segments = [segment for skeleton in packet.get_skeletons()[1] for segment in skeleton]
    _, position, turned = segments[at[0]]
    return body_pose(
        (*position, *from_quaternion(turned.w, turned.x, turned.y, turned.z).T.ravel().tolist())
    )


FORMS = {
    "6d": ("bodies", "6dres", _of_body),
    "3d": ("markers", "3dres", _of_markers),
    "skeleton": ("segments", "skeleton", _of_segment),
}
"""Forms of a body, by QTM's name of the parameters: in words, as a component of a packet, and how to get its pose."""


class MocapDriver(MotionCapture):
    """A body in QTM; the address is HOST:PORT, with the port for the least significant byte first.

    The body is a rigid body NAME, three labeled markers FRONT+BACK+LEFT or a segment
    SKELETON/SEGMENT.
    """

    called = "qtm"

    def __init__(self, address: str, clock: Clock, body: str = "") -> None:
        super().__init__(address, clock, body)
        self._qtm = hardware("qtm-rt", "qtm_rt")
        logging.getLogger("qtm_rt").addHandler(
            logging.NullHandler()
        )  # our messages report its errors
        self._form = "skeleton" if "/" in body else "3d" if body.count("+") == 2 else "6d"
        self._called, self._component, self._pose = FORMS[self._form]
        self._at: list[int] = []  # indices of the body, or its markers, in the server's list
        self._first: DeviceFailed | None = None
        self._ready = threading.Event()
        self._start()
        if not self._ready.wait(CONNECT_TIME + 2.0) or self._first is not None:
            failed = self._first or DeviceFailed(
                f"The motion capture at {address} does not answer."
            )
            self.close()
            raise failed

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
                known = isinstance(error, DeviceFailed)
                said = f"The motion capture at {self._address} fails: {error!r}."
                self._first = error if known else DeviceFailed(said)
                self._ready.set()
            raise

    async def _connected(self) -> None:
        host, port = host_and_port(self._address)
        gone = asyncio.Event()
        asked = self._qtm.connect(
            host, port, on_disconnect=lambda _: gone.set(), timeout=CONNECT_TIME
        )
        link: Any = await asyncio.wait_for(asked, CONNECT_TIME)
        if link is None:
            raise DeviceFailed(
                f"The motion capture at {self._address} cannot be reached: check that QTM runs there, and that its "
                "real-time server has this port."
            )
        try:
            await self._find_body(link)
            # The client waits for the first frame; cameras that do not measure yet are not a
            # connection error.
            stream = link.stream_frames(
                frames="allframes", components=[self._component], on_packet=self._on_packet
            )
            begun = asyncio.ensure_future(stream)
            # Its result is not awaited: whether frames arrive says the same.
            begun.add_done_callback(lambda begun: begun.cancelled() or begun.exception())
            self._trouble = ""
            self._ready.set()
            while not (self._ended.is_set() or gone.is_set()):
                await asyncio.sleep(0.05)
        finally:
            if link.has_transport():
                link.disconnect()
                await asyncio.sleep(0.0)  # lets the transport close
        if gone.is_set() and not self._ended.is_set():
            raise DeviceFailed(f"the motion capture at {self._address} closed the connection")

    async def _find_body(self, link: Any) -> None:
        """Find the indices of the body in the list."""
        names = _names(ElementTree.fromstring(await link.get_parameters([self._form])))
        listed = ", ".join(names) or "none"
        wanted = self._body.split("+") if self._form == "3d" else [self._body or listed]
        if not self._body and len(names) != 1:
            raise DeviceFailed(
                f"The body must be named by `mocap_body`: the motion capture has {listed}."
            )
        for name in wanted:
            if name not in names:
                raise DeviceFailed(
                    f"The motion capture has no {name!r} among its {self._called}: {listed}."
                )
        self._at = [names.index(name) for name in wanted]

    def _on_packet(self, packet: Any) -> None:
        """Take in one packet, in the thread of the event loop."""
        arrival = self._clock.now()
        try:
            pose = self._pose(packet, self._at)
            stamp = packet.timestamp / 1e6
        except Exception as error:  # an invalid packet is a lost frame
            self._trouble = f"invalid packet from the motion capture: {error}"
            return
        self._received.append((arrival, pose_sample(stamp, pose)))


def _names(told: ElementTree.Element) -> list[str]:
    """Return the names of all bodies, labels or segments, in the order of the packets."""
    segments = (
        (skeleton, part) for skeleton in told.iter("Skeleton") for part in skeleton.iter("Segment")
    )
    names = ["/".join(str(one.get("Name")) for one in pair) for pair in segments]
    texts = [*told.findall(".//Body/Name"), *told.findall(".//Label/Name")]
    return names + [(one.text or "").strip() for one in texts]
