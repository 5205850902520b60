import struct
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from laticauda.trials.logs import Recorder, open_recording
from laticauda.values.errors import TrialFileError

writer = pytest.importorskip("mcap.writer", reason="the package mcap is not installed")


@pytest.fixture(scope="module")
def content(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Ten chunks of ten messages."""
    path = tmp_path_factory.mktemp("mcap") / "run.mcap"
    with Recorder(path) as recorder:
        for i in range(100):
            recorder.scalar("/x", 0.1 * i, float(i))
            if i % 10 == 9:
                recorder.flush()
    return path.read_bytes()


def chunks(content: bytes) -> list[tuple[int, int]]:
    """Where each chunk begins and ends."""
    found, at = [], 8
    while at < len(content) - 8:
        opcode, length = struct.unpack_from("<BQ", content, at)
        if opcode == 6:
            found.append((at, at + 9 + length))
        at += 9 + length
    return found


def numbers(path: Path) -> list[float]:
    return [one.content["data"] for one in open_recording(path).messages()]


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_wherever_a_file_is_cut_all_complete_chunks_are_recovered(content, tmp_path, data):
    cut = data.draw(st.integers(8, len(content) - 9))
    path = tmp_path / "cut.mcap"
    path.write_bytes(content[:cut])
    complete = sum(end <= cut for _, end in chunks(content))
    assert numbers(path) == list(range(10 * complete))
    if cut < len(content) - 40:  # with its footer a file counts as complete
        assert "cut.mcap is not intact: it is truncated" in open_recording(path).lost


def test_a_damaged_chunk_is_left_out_and_said(content, tmp_path):
    path = tmp_path / "bad.mcap"
    begin, end = chunks(content)[3]
    path.write_bytes(content[: end - 20] + bytes([content[end - 20] ^ 0xFF]) + content[end - 19 :])
    assert begin < end - 20
    assert numbers(path) == [i for i in range(100) if not 30 <= i < 40]
    assert "a chunk of" in open_recording(path).lost


@pytest.mark.parametrize("sought", [b"keel", b"\x0f\x04", b"\x06\x00\x00"])
def test_damage_outside_of_chunks_is_said(tmp_path, sought: bytes):
    path = tmp_path / "bad.mcap"
    with Recorder(path) as recorder:
        recorder.metadata("robot", {"name": "keel"})
        recorder.scalar("/x", 0.0, 1.0)
    assert open_recording(path).lost == ""
    content = bytearray(path.read_bytes())
    if sought[0] == 6:  # the kind of a record: the chunk is no chunk any more
        at = chunks(bytes(content))[0][0]
    else:
        at = content.index(sought)
    content[at] ^= 1
    path.write_bytes(content)
    assert (
        open_recording(path).lost == "bad.mcap is not intact: it is damaged: its checksum is wrong."
    )


def test_the_bytes_of_any_writer_are_read(tmp_path):
    path = tmp_path / "other.mcap"
    with path.open("wb") as file:
        other = writer.Writer(file, use_chunking=False)
        other.start()
        text = other.register_schema("text", "jsonschema", b"{}")
        jason = other.register_channel("/json", "json", text)
        other.add_message(jason, 1_500_000_000, b'{"a": 1}', 0)
        raw = other.register_channel("/raw", "own", 0)
        other.add_message(raw, 2_000_000_000, b"\x01\x02", 0)
        other.finish()
    found = list(open_recording(path).messages())
    assert [(one.topic, one.time, one.content) for one in found] == [
        ("/json", 1.5, {"a": 1}),
        ("/raw", 2.0, b"\x01\x02"),
    ]
    assert open_recording(path).lost == ""


def test_a_message_that_is_not_of_its_type_is_said(tmp_path):
    path = tmp_path / "other.mcap"
    with path.open("wb") as file:
        other = writer.Writer(file)
        other.start("ros2")
        schema = other.register_schema("std_msgs/msg/Float64", "ros2msg", b"float64 data\n")
        channel = other.register_channel("/x", "cdr", schema)
        other.add_message(channel, 0, b"\x00\x01\x00\x00abc", 0)
        other.finish()
    with pytest.raises(
        TrialFileError, match=r"other.mcap: topic /x: A message of std_msgs/Float64 is damaged"
    ):
        list(open_recording(path).messages())


def test_what_is_no_mcap_file_is_refused(tmp_path):
    with pytest.raises(TrialFileError, match=r"Cannot read .*none.mcap: no such file"):
        open_recording(tmp_path / "none.mcap")
    path = tmp_path / "text.mcap"
    path.write_text("time,x\n")
    with pytest.raises(TrialFileError, match="it is not an MCAP file"):
        open_recording(path)
