from pathlib import Path

import numpy as np
import pytest

from laticauda.trials.logs import Recorder, open_recording
from laticauda.values.errors import StorageFailed

reader = pytest.importorskip("mcap.reader", reason="the package mcap is not installed")


def record_everything(path: Path, n: int = 30) -> None:
    with Recorder(path, chunk_seconds=0.1) as recorder:
        recorder.metadata("robot", {"name": "mamba"})
        for i in range(n):
            time = 0.01 * i
            recorder.joint_state(
                "/joint_states", time, ["a", "b"], [i, 2.0], [3.0, 4.0], np.array([5.0, 6.0])
            )
            recorder.pose("/body", time, (1.0, 2.0, 3.0), (0.5, 0.5, 0.5, 0.5))
            recorder.transforms(time, {"tail": ("world", (1.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))})
            recorder.scalar("/power/electrical", time, 92.0 + i, unit="W")
            recorder.array("/matrix", time, np.arange(6.0).reshape(2, 3), labels=("row", "column"))
            recorder.can_frame("/can", time, 0x201, b"\x01\x02\x03")
        recorder.json("/settings", time, {"rate": 100})
        recorder.event(time, "stopped", {"by": "operator"}, level="warning")


def test_the_package_mcap_and_another_decoder_read_what_was_recorded(tmp_path):
    decoders = pytest.importorskip("mcap_ros2.decoder")
    path = tmp_path / "run.mcap"
    record_everything(path)
    with path.open("rb") as file:
        found = reader.make_reader(file, decoder_factories=[decoders.DecoderFactory()])
        assert found.get_header().profile == "ros2"
        messages = list(found.iter_decoded_messages())
        assert [(one.name, one.metadata) for one in found.iter_metadata()] == [
            ("robot", {"name": "mamba"})
        ]
    by_topic = {channel.topic: message for _, channel, _, message in messages}
    assert len(messages) == 6 * 30 + 2
    assert {channel.message_encoding for _, channel, _, _ in messages} == {
        "cdr"
    }  # ros2 bag takes no mixture
    assert by_topic["/joint_states"].position == [29.0, 2.0]
    assert by_topic["/joint_states"].effort == [5.0, 6.0]
    assert by_topic["/joint_states"].header.stamp.nanosec == 290_000_000
    assert by_topic["/body"].pose.orientation.w == 0.5
    assert by_topic["/tf"].transforms[0].child_frame_id == "tail"
    assert by_topic["/power/electrical"].data == 121.0
    assert [dim.size for dim in by_topic["/matrix"].layout.dim] == [2, 3]
    assert (by_topic["/can"].id, by_topic["/can"].dlc, by_topic["/can"].data[:3]) == (
        0x201,
        3,
        b"\x01\x02\x03",
    )
    assert (by_topic["/events"].name, by_topic["/events"].level) == ("stopped", 30)
    assert by_topic["/events"].msg == '{"by": "operator"}'


def test_our_reader_reads_the_same(tmp_path):
    path = tmp_path / "run.mcap"
    record_everything(path)
    recording = open_recording(path)
    assert recording.lost == ""
    assert (recording.start, recording.stop) == (0.0, 0.29)
    assert recording.metadata == {"robot": {"name": "mamba"}}
    assert recording.topics["/power/electrical"].unit == "W"
    assert recording.topics["/can"].n_messages == 30
    powers = [
        (one.time, one.content["data"])
        for one in open_recording(path).messages("/power/electrical")
    ]
    assert powers == [(round(0.01 * i, 9), 92.0 + i) for i in range(30)]


def test_an_event_is_on_disk_at_once(tmp_path):
    path = tmp_path / "run.mcap"
    recorder = Recorder(path, chunk_seconds=1e6)
    recorder.scalar("/x", 0.0, 1.0)
    recorder.event(0.0, "leak", level="error")
    assert [one.topic for one in open_recording(path).messages()] == ["/x", "/events"]
    recorder.close()
    recorder.close()  # a second time does nothing


def test_what_does_not_fit_is_refused_and_the_file_stays_whole(tmp_path):
    path = tmp_path / "run.mcap"
    with Recorder(path) as recorder:
        recorder.scalar("/x", 0.0, 1.0)
        with pytest.raises(
            ValueError, match="`topic` /x must keep its type std_msgs/Float64, got can_msgs/Frame"
        ):
            recorder.can_frame("/x", 0.0, 1, b"")
        with pytest.raises(ValueError, match="`data` must have at most 8 bytes, got 9"):
            recorder.can_frame("/can", 0.0, 1, bytes(9))
        with pytest.raises(ValueError, match=r"`time` must be >= 0 s, got -1.0"):
            recorder.scalar("/x", -1.0, 1.0)
        with pytest.raises(ValueError, match="`time` must be a finite number in s, got nan"):
            recorder.scalar("/x", float("nan"), 1.0)
        with pytest.raises(ValueError, match="`level` must be one of debug, info"):
            recorder.event(0.0, "x", level="bad")
        with pytest.raises(ValueError, match="`data` must be data that JSON can hold"):
            recorder.event(0.0, "x", object())
    with pytest.raises(StorageFailed, match="it is closed"):
        recorder.scalar("/x", 1.0, 1.0)
    assert len(list(open_recording(path).messages())) == 1
    with pytest.raises(ValueError, match="`chunk_seconds` must be > 0 s, got 0"):
        Recorder(tmp_path / "other.mcap", chunk_seconds=0)


def test_a_frame_of_the_bus_is_written_as_the_codec_of_its_type_writes_it(tmp_path):
    from laticauda.trials.logs import ros2

    with Recorder(tmp_path / "run.mcap") as recorder:
        recorder.can_frame("/can", 12.345678901, 0x7FF, b"\x01\x02")
        with pytest.raises(ValueError, match=r"`time` must be >= 0 s, got -1\.0\."):
            recorder.can_frame("/can", -1.0, 1, b"")
        with pytest.raises(ValueError, match=r"`identifier` must be from 0 to 2\^32 - 1, got -1\."):
            recorder.can_frame("/can", 0.0, -1, b"")
    with (tmp_path / "run.mcap").open("rb") as file:
        ((_, _, message),) = list(reader.make_reader(file).iter_messages())
    content = {
        "header": {"stamp": ros2.to_ros_time(12_345_678_901), "frame_id": ""},
        "id": 0x7FF,
        "is_rtr": False,
        "is_extended": False,
        "is_error": False,
        "dlc": 2,
        "data": b"\x01\x02".ljust(8, b"\x00"),
    }
    assert message.data == ros2.encode("can_msgs/Frame", content)


def test_the_clock_on_the_wall_is_in_the_stamps_and_our_reader_counts_from_its_time_0(tmp_path):
    from mcap.reader import make_reader

    epoch = 1_790_000_000_123_456_789
    with Recorder(tmp_path / "run.mcap", epoch=epoch) as recorder:
        recorder.scalar("/x", -0.5, 1.0)
        recorder.event(0.25, "begun")
        with pytest.raises(
            ValueError, match=r"`time` must be >= -1\.79e\+09 s, got -2000000000\.0"
        ):
            recorder.scalar("/x", -2e9, 1.0)
    with (tmp_path / "run.mcap").open("rb") as file:
        stamps = [message.log_time for _, _, message in make_reader(file).iter_messages()]
    assert stamps == [epoch - 500_000_000, epoch + 250_000_000]
    recording = open_recording(tmp_path / "run.mcap")
    assert (recording.epoch, recording.start, recording.stop) == (epoch, -0.5, 0.25)
    (event,) = recording.messages(since=0.0)
    assert event.time == 0.25
    assert event.content["stamp"] == {"sec": 1_790_000_000, "nanosec": 373_456_789}
