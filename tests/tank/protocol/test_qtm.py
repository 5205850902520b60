import math
import struct
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given, strategies as st
from qtm_rt import QRTPacket

from laticauda.tank.protocol import BodyPose, MocapFrame, ProtocolError
from laticauda.tank.protocol.qtm import (
    Component,
    Event,
    PacketReader,
    PacketType,
    answer_parameters,
    body_pose,
    decode_text,
    encode_event,
    encode_frame,
    encode_packet,
    encode_text,
)
from laticauda.values.angles import from_quaternion

METERS = st.floats(-50, 50, width=32)


def turned(roll: float, pitch: float, yaw: float) -> np.ndarray:
    def about(axis: int, angle: float) -> np.ndarray:
        c, s = math.cos(angle), math.sin(angle)
        matrix, (i, j) = np.eye(3), [(1, 2), (2, 0), (0, 1)][axis]
        matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = c, -s, s, c
        return matrix

    return about(0, roll) @ about(1, pitch) @ about(2, yaw)


# Plain numbers: the run-time check of shapes must not run while hypothesis draws.
POSES = st.tuples(
    st.tuples(METERS, METERS, METERS),
    st.tuples(st.floats(-3, 3), st.floats(-1.5, 1.5), st.floats(-3, 3)),
    st.floats(0, 0.1),
)
FRAMES = st.tuples(
    st.integers(0, 10**12), st.integers(0, 2**32 - 1), st.lists(POSES | st.none(), max_size=3)
)


def made(numbers) -> MocapFrame:
    time, number, poses = numbers
    bodies = [
        pose and BodyPose(position=np.array(pose[0]), rotation=turned(*pose[1]), residual=pose[2])
        for pose in poses
    ]
    return MocapFrame(timestamp=time / 1e6, number=number, bodies=tuple(bodies))


def payload(packet: bytes) -> bytes:
    ((kind, found),) = PacketReader().feed(packet)
    assert kind == PacketType.DATA
    return found


@given(frame=FRAMES)
def test_the_vendors_package_reads_the_same_numbers(frame):
    frame = made(frame)
    components = (Component.BODIES, Component.BODIES_RESIDUAL)
    packet = QRTPacket(payload(encode_frame(frame, components)))
    assert (packet.timestamp, packet.framenumber) == (round(frame.timestamp * 1e6), frame.number)
    _, plain = packet.get_6d()
    _, bodies = packet.get_6d_residual()
    assert len(plain) == len(bodies) == len(frame.bodies)
    for (position, matrix, residual), expected in zip(bodies, frame.bodies, strict=True):
        pose = body_pose((*position, *matrix.matrix, *residual))
        assert (pose is None) == (expected is None)
        if pose is not None and expected is not None:
            np.testing.assert_allclose(pose.position, expected.position, rtol=1e-6, atol=1e-9)
            np.testing.assert_allclose(pose.rotation, expected.rotation, atol=1e-7)
            assert pose.residual == pytest.approx(expected.residual, rel=1e-6, abs=1e-12)


@given(frame=FRAMES)
def test_the_vendors_package_reads_the_same_markers_and_segments(frame):
    frame = made(frame)
    points = ((0.05, 0.0, 0.0), (0.0, 0.04, -0.01))
    packet = QRTPacket(
        payload(encode_frame(frame, (Component.MARKERS, Component.SKELETONS), points))
    )
    _, markers = packet.get_3d_markers_residual()
    _, skeletons = packet.get_skeletons()
    assert (len(markers), len(skeletons)) == (2 * len(frame.bodies), len(frame.bodies))
    for k, body in enumerate(frame.bodies):
        (number, position, turned), first = skeletons[k][0], markers[2 * k : 2 * k + 2]
        assert number == 1
        if body is None:
            assert np.isnan([*position, *turned, *first[0][:3]]).all()
            continue
        np.testing.assert_allclose(1e-3 * np.array(position), body.position, rtol=1e-6, atol=1e-9)
        np.testing.assert_allclose(
            from_quaternion(turned.w, turned.x, turned.y, turned.z), body.rotation, atol=1e-6
        )
        for marker, point in zip(first, points, strict=True):
            at = body.position + body.rotation @ point
            np.testing.assert_allclose(1e-3 * np.array(marker[:3]), at, rtol=1e-6, atol=1e-7)


@given(
    texts=st.lists(st.text(alphabet=st.characters(exclude_characters="\0", codec="utf-8"))),
    cut=st.integers(1, 7),
)
def test_texts_come_back_however_the_stream_is_cut(texts, cut):
    stream = b"".join(map(encode_text, texts))
    reader = PacketReader()
    found = [p for i in range(0, len(stream), cut) for p in reader.feed(stream[i : i + cut])]
    assert found == [(PacketType.COMMAND, text.encode() + b"\0") for text in texts]
    assert [decode_text(data) for _, data in found] == texts


@given(data=st.binary(max_size=200))
def test_random_bytes_give_packets_or_a_protocol_error(data):
    try:
        for _, found in PacketReader().feed(data):
            decode_text(found)
    except ProtocolError as error:
        assert "bytes" in str(error)


def test_impossible_sizes_are_said():
    with pytest.raises(ProtocolError, match="a packet claims to have 4 bytes"):
        list(PacketReader().feed(struct.pack("<II", 4, 1)))
    assert list(PacketReader().feed(encode_packet(PacketType.NO_MORE_DATA, b""))) == [(4, b"")]


def test_an_event_is_one_byte():
    assert list(PacketReader().feed(encode_event(Event.SHUTTING_DOWN))) == [
        (PacketType.EVENT, b"\x0b")
    ]


def test_what_a_client_asks_for_is_answered_and_nothing_else():
    bodies = {"fish & fin": [(0.01, -0.02, 0.0)], "other": []}
    root = ElementTree.fromstring(answer_parameters(100.0, bodies, {"general", "6d"}))
    assert root.tag == "QTM_Parameters_Ver_1.25"
    assert root.findtext("General/Frequency") == "100"
    assert [body.findtext("Name") for body in root.findall("The_6D/Body")] == [
        "fish & fin",
        "other",
    ]
    (point,) = root.findall("The_6D/Body/Points/Point")
    assert [point.get(axis) for axis in "XYZ"] == ["10.000", "-20.000", "0.000"]  # mm
    for word, tag in {
        "general": "General",
        "6d": "The_6D",
        "3d": "The_3D",
        "skeleton": "Skeletons",
    }.items():
        assert [
            one.tag
            for one in ElementTree.fromstring(answer_parameters(50.0, bodies, {word, "image"}))
        ] == [tag]
    root = ElementTree.fromstring(answer_parameters(50.0, bodies, {"3d", "skeleton"}))
    assert [label.text for label in root.findall("The_3D/Label/Name")] == ["fish & fin-0"]
    assert [one.get("Name") for one in root.iter("Skeleton")] == ["fish & fin", "other"]


def test_a_body_has_no_residual_where_none_was_asked_for():
    pose = body_pose((1000.0, 0.0, -500.0, *np.eye(3).ravel().tolist()))
    assert pose.position.tolist() == [1.0, 0.0, -0.5]
    assert math.isnan(pose.residual)
    assert body_pose((math.nan, *[0.0] * 11)) is None


@pytest.mark.parametrize(
    ("position", "rotation"),
    [
        ((3e38, 0.0, 0.0), np.eye(3)),
        ((1.0, 2.0, 3.0), np.zeros((3, 3))),
        ((1.0, 2.0, 3.0), 1e30 * np.ones((3, 3))),
        ((1.0, 2.0, 3.0), -np.eye(3)),
        ((1.0, 2.0, 3.0), 1.1 * np.eye(3)),
    ],
)
def test_a_place_beyond_all_cameras_and_what_is_no_rotation_are_no_pose(position, rotation):
    assert body_pose((*position, *rotation.ravel().tolist())) is None


@pytest.mark.parametrize("residual", [math.inf, -math.inf, -1.0])
def test_an_impossible_residual_is_unknown(residual):
    pose = body_pose((1.0, 2.0, 3.0, *np.eye(3).ravel().tolist(), residual))
    assert pose is not None and math.isnan(pose.residual)
