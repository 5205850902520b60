import asyncio
import socket
import struct
import threading
import time

import numpy as np
import pytest
import qtm_rt

from laticauda.tank.lab import BODY, LOOPBACK, QtmServer, ServerFailed
from laticauda.tank.protocol import BodyPose, MocapFrame
from laticauda.tank.protocol.qtm import (
    PacketReader,
    PacketType,
    body_pose,
    decode_text,
    encode_text,
)


@pytest.fixture(scope="module")
def server():
    found = QtmServer(100.0, port=0)
    found.start()
    ended = threading.Event()

    def film():
        number = 0
        while not ended.wait(0.005):
            number += 1
            body = None
            if number % 2:
                body = BodyPose(
                    position=np.array([number * 1e-3, 2.0, -0.15]),
                    rotation=np.eye(3),
                    residual=0.001,
                )
            found.publish(MocapFrame(timestamp=number / 100.0, number=number, bodies=(body,)))

    thread = threading.Thread(target=film)
    thread.start()
    yield found
    ended.set()
    thread.join()
    found.stop()


def ask(server, questions):
    """What a coroutine of the vendor's client gives."""

    async def talk():
        client = await qtm_rt.connect(server.host, server.port, timeout=3)
        assert client is not None
        try:
            return await questions(client)
        finally:
            client.disconnect()

    return asyncio.run(talk())


def test_the_vendors_client_connects_and_lists_the_body(server):
    async def questions(client):
        import xml.etree.ElementTree as ElementTree

        xml = ElementTree.fromstring(await client.get_parameters(["6d", "general"]))
        state = await client.get_state()
        return (
            [b.text for b in xml.findall("*/Body/Name")],
            xml.findtext("*/Frequency"),
            state,
            len(xml.findall("*/Body/Points/Point")),
        )

    assert ask(server, questions) == ([BODY], "100", qtm_rt.QRTEvent.EventConnected, 5)


def test_the_vendors_client_streams_frames_and_sees_lost_bodies(server):
    async def questions(client):
        frames = []
        assert await client.stream_frames(components=["6dres"], on_packet=frames.append) == b"Ok"
        await asyncio.sleep(0.3)
        await client.stream_frames_stop()
        return frames

    frames = ask(server, questions)
    assert len(frames) > 10
    for frame in frames:
        _, ((position, matrix, residual),) = frame.get_6d_residual()
        pose = body_pose((*position, *matrix.matrix, *residual))
        assert (pose is None) == (frame.framenumber % 2 == 0)
        if pose is not None:
            assert pose.position == pytest.approx([frame.framenumber * 1e-3, 2.0, -0.15], rel=1e-5)
            assert frame.timestamp == pytest.approx(frame.framenumber * 1e4)


def test_a_client_may_ask_for_fewer_frames_or_for_one(server):
    async def questions(client):
        frames = []
        await client.stream_frames("frequency:25", components=["6d"], on_packet=frames.append)
        await asyncio.sleep(0.2)
        await client.stream_frames_stop()
        await asyncio.sleep(0.05)
        one = await client.get_current_frame(components=["6d", "skeleton"])
        return frames, one

    frames, one = ask(server, questions)
    assert {frame.framenumber % 4 for frame in frames} == {0}
    assert one.get_6d() is not None
    assert one.get_skeletons() is not None


def test_what_a_real_server_can_do_besides_is_answered_or_refused(server):
    async def questions(client):
        told = [
            await client.byte_order(),
            await client.qtm_version(),
            await client.take_control("x"),
        ]
        told += [await client.release_control(), await client.new(), await client.start()]
        with pytest.raises(qtm_rt.QRTCommandException, match="Parse error"):
            await client.stream_frames(components=["3d"], on_packet=print)
        with pytest.raises(qtm_rt.QRTCommandException, match="Parse error"):
            await client.send_xml("<QTM_Settings/>")
        return told

    assert ask(server, questions)[0] == b"Byte order is little endian"


def test_versions_that_we_do_not_speak_are_refused(server):
    with socket.create_connection((server.host, server.port), timeout=2) as wire:
        reader = PacketReader()
        wire.sendall(encode_text("version 1.99"))
        packets = []
        while len(packets) < 2:
            packets += reader.feed(wire.recv(1000))
    assert [(kind, decode_text(text)) for kind, text in packets] == [
        (PacketType.COMMAND, "QTM RT Interface connected"),
        (PacketType.ERROR, "Version NOT supported"),
    ]


def test_silent_connections_keep_out_nobody_who_asks(server):
    async def questions(client):
        return await client.get_parameters(["general"])

    silent = [socket.create_connection((server.host, server.port), timeout=5) for _ in range(40)]
    assert b"<Frequency>100<" in ask(server, questions)
    for wire in silent:
        wire.close()


@pytest.mark.parametrize("seed", range(20))
def test_random_bytes_do_not_bring_the_server_down(server, seed):
    random = np.random.default_rng(
        seed
    )  # not hypothesis: the other threads' checks of shapes disturb its chance
    words = [
        b"streamframes",
        b"getparameters",
        b"version 1.25",
        b"allframes 6d",
        b"frequency:\xff",
        b"\0",
        b" ",
    ]
    with socket.create_connection((server.host, server.port), timeout=2) as wire:
        for _ in range(10):
            text = b"".join(
                random.choice(words) if random.random() < 0.7 else random.bytes(5) for _ in range(4)
            )
            part = (
                struct.pack("<II", 8 + len(text), random.integers(0, 8)) + text
                if random.random() < 0.8
                else random.bytes(20)
            )
            try:
                wire.sendall(part)
            except OSError:  # we were hung up on
                break
    assert server._thread.is_alive()


def test_it_still_serves_after_all_that(server):
    time.sleep(0.1)

    async def questions(client):
        return await client.byte_order()

    assert ask(server, questions) == b"Byte order is little endian"


def test_it_listens_on_loopback_and_says_where_it_cannot(server):
    assert server.host == LOOPBACK
    with pytest.raises(
        ServerFailed, match=f"The cameras' server cannot listen at 127.0.0.1:{server.port}: "
    ):
        QtmServer(100.0, port=server.port).start()
