import time

import numpy as np
import pytest
from patience import until

from laticauda.tank.lab import BODY, QtmServer
from laticauda.tank.operate.drivers import Clock, DeviceFailed
from laticauda.tank.operate.drivers.mocap import MocapDriver
from laticauda.tank.protocol import BodyPose, MocapFrame

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
