import contextlib
import socket
import struct
import threading
import time

import numpy as np
import pytest
from patience import until

from laticauda.tank.lab import BODY, QtmServer
from laticauda.tank.operate.drivers import Clock, DeviceFailed
from laticauda.tank.operate.drivers.mocap import MocapDriver
from laticauda.tank.protocol import BodyPose, MocapFrame, qtm

TURN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


@pytest.fixture
def server():
    server = QtmServer(100.0, port=0)
    server.start()
    yield server
    server.stop()


def published(server: QtmServer, driver: MocapDriver, n: int) -> list:
    found, end, number = [], time.monotonic() + 20.0, 0
    while len(found) < n and time.monotonic() < end:
        pose = (
            BodyPose(position=np.array([1.0, 2.0, -0.15]), rotation=TURN, residual=0.0007)
            if number % 3
            else None
        )
        server.publish(MocapFrame(timestamp=5.0 + 0.01 * number, number=number, bodies=(pose,)))
        number += 1
        time.sleep(0.01)
        found += driver.receive()
    return found


def test_the_vendors_client_streams_the_body_with_both_times(server):
    clock = Clock()
    with MocapDriver(f"{server.host}:{server.port}", clock, BODY) as driver:
        found = published(server, driver, 9)
        assert driver.trouble == ""
    seen = [(arrival, frame) for arrival, frame in found if not frame.is_lost]
    assert len(seen) < len(found)
    arrival, frame = seen[0]
    assert frame.position == pytest.approx([1.0, 2.0, -0.15], abs=1e-6)
    assert frame.rotation == pytest.approx(TURN)
    assert frame.residual == pytest.approx(0.0007)
    assert frame.time >= 5.0
    assert 0.0 < arrival < clock.now()


@pytest.mark.parametrize(
    ("body", "ahead"),
    [(f"{BODY}-1+{BODY}-2+{BODY}-3", 0.005), (f"{BODY}/body", 0.0)],
    ids=["three labelled markers", "a segment of a skeleton"],
)
def test_markers_and_skeletons_give_the_pose_of_the_body(server, body, ahead):
    """The markers' origin is amid front and back, which are 50 and -40 mm from that of the body."""
    with MocapDriver(f"{server.host}:{server.port}", Clock(), body) as driver:
        found = published(server, driver, 6)
        assert driver.trouble == ""
    frames = [frame for _, frame in found]
    assert {frame.is_lost for frame in frames} == {False, True}
    seen = next(frame for frame in frames if not frame.is_lost)
    assert seen.position == pytest.approx(
        np.array([1.0, 2.0, -0.15]) + ahead * TURN[:, 0], abs=1e-6
    )
    assert seen.rotation == pytest.approx(TURN, abs=1e-6)


def test_a_marker_or_a_segment_that_is_unknown_is_refused_with_what_there_is(server):
    address = f"{server.host}:{server.port}"
    with pytest.raises(DeviceFailed, match=rf"has no 'left' among its markers: {BODY}-0, {BODY}-1"):
        MocapDriver(address, Clock(), f"{BODY}-1+{BODY}-2+left")
    with pytest.raises(DeviceFailed, match=rf"has no 'fish/tail' among its segments: {BODY}/body"):
        MocapDriver(address, Clock(), "fish/tail")


def test_the_only_body_needs_no_name_and_an_unknown_one_is_refused_with_what_there_is(server):
    with MocapDriver(f"{server.host}:{server.port}", Clock(), ""):
        pass
    with pytest.raises(DeviceFailed, match=rf"has no 'fish' among its bodies: {BODY}"):
        MocapDriver(f"{server.host}:{server.port}", Clock(), "fish")


def test_a_server_that_is_not_there_says_what_to_check(server):
    server.stop()
    with pytest.raises(
        DeviceFailed,
        match="cannot be reached: check that QTM runs there, and that its real-time server",
    ):
        MocapDriver(f"127.0.0.1:{server.port}", Clock())


def test_a_connection_that_breaks_is_told_and_made_again(server):
    with MocapDriver(f"{server.host}:{server.port}", Clock(), "") as driver:
        assert published(server, driver, 2)
        server.stop()
        until(lambda: driver.trouble)
        assert driver.trouble
        again = QtmServer(100.0, port=server.port)
        again.start()
        try:
            assert published(again, driver, 2)
        finally:
            again.stop()


GIANT = struct.pack("<II", 0x7FFFFFFF, 3)
EMPTY = struct.pack("<II", 0, 1)
GREETING = qtm.encode_text(qtm.BANNER)
PARAMETERS = qtm.encode_text(qtm.answer_parameters(100.0, {"fish": ()}, {"6d"}), qtm.PacketType.XML)
ENTITY_BOMB = qtm.encode_text(
    '<!DOCTYPE a [<!ENTITY a "aaaaaaaaaa">'
    + "".join(
        f'<!ENTITY {b} "{f"&{a};" * 10}">' for a, b in zip("abcdefgh", "bcdefghi", strict=True)
    )
    + "]><X><The_6D><Body><Name>&i;</Name></Body></The_6D></X>",
    qtm.PacketType.XML,
)
MANY_NAMES = qtm.encode_text(
    f"<X>{'<Body><Name>fish</Name></Body>' * 5000}</X>", qtm.PacketType.XML
)


class HostileCameras:
    """A server that speaks QTM's protocol up to a point, and then something else without end."""

    def __init__(self, greeting=GREETING, parameters=PARAMETERS, stream=b""):
        self._listening = socket.create_server(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self._listening.getsockname()[1]}"
        self._answers = {
            b"version": qtm.encode_text("Version set to 1.25"),
            b"getparameters": parameters,
        }
        self._greeting = greeting
        self._stream = stream
        self._wires = []
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self):
        while True:
            try:
                wire, _ = self._listening.accept()
            except OSError:
                return
            self._wires.append(wire)
            threading.Thread(target=self._talk, args=(wire,), daemon=True).start()

    def _talk(self, wire):
        try:
            wire.sendall(self._greeting)
            while question := wire.recv(1000).lower():
                for word, answer in self._answers.items():
                    if word in question:
                        wire.sendall(answer)
                while b"streamframes" in question and self._stream:
                    wire.sendall(self._stream)
        except OSError:
            pass

    def close(self):
        for wire in (self._listening, *self._wires):
            with contextlib.suppress(OSError):
                wire.shutdown(socket.SHUT_RDWR)
            wire.close()


@pytest.mark.parametrize(
    ("hostile", "message"),
    [
        ({"greeting": EMPTY}, "does not speak QTM's protocol: a packet claims to have 0 bytes"),
        (
            {"greeting": b"HTTP/1.1 400 no\r\n\r\n"},
            "does not speak QTM's protocol: a packet claims",
        ),
        ({"greeting": b""}, ""),
        ({"parameters": b""}, "does not answer: check that QTM runs there"),
        ({"parameters": ENTITY_BOMB}, "gives parameters that are no XML: limit on input"),
        ({"parameters": MANY_NAMES}, "the motion capture has (fish, ){19}fish and 4980 more"),
    ],
)
def test_a_server_of_anything_else_is_refused_in_a_sentence(hostile, message, monkeypatch, capfd):
    monkeypatch.setattr("laticauda.tank.operate.drivers.mocap.CONNECT_TIME", 0.5)
    cameras = HostileCameras(**hostile)
    if message:
        with pytest.raises(DeviceFailed, match=message):
            MocapDriver(cameras.address, Clock())
    else:
        MocapDriver(cameras.address, Clock()).close()
    cameras.close()
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    ("stream", "message"),
    [
        (GIANT + b"x" * 60000, "a packet claims to have 2147483647 bytes"),
        (EMPTY, "a packet claims to have 0 bytes"),
        (qtm.encode_packet(qtm.PacketType.DATA, b""), "unpack_from requires a buffer"),
        (struct.pack("<II", 8, 99), "99 is not a valid QRTPacketType"),
    ],
)
def test_a_stream_of_anything_else_is_told_and_printed_nowhere(stream, message, capfd):
    cameras = HostileCameras(stream=stream)
    with MocapDriver(cameras.address, Clock()) as driver:
        until(lambda: driver.trouble)
        assert f"does not speak QTM's protocol: {message}" in driver.trouble
        assert driver.receive() == ()
    cameras.close()
    assert capfd.readouterr().err == ""
