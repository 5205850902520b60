"""Folders for rosbag2, read by the package rosbags, which others maintain."""

import pytest

import laticauda as lc
from laticauda.trials.logs import Recorder, write_bag
from laticauda.values.errors import StorageFailed, TrialFileError

pytest.importorskip("mcap")
rosbag2 = pytest.importorskip("rosbags.rosbag2")


def test_a_trial_in_a_folder_opens_as_a_bag_with_what_viewers_need_for_whoever_comes_late(
    make_trial, tmp_path
):
    from rosbags.typesys import Stores, get_typestore

    trial = make_trial(duration=1.0)
    write_bag(trial, tmp_path / "bag")
    assert sorted(path.name for path in (tmp_path / "bag").iterdir()) == [
        "bag_0.mcap",
        "metadata.yaml",
    ]
    assert lc.load_trial(tmp_path / "bag" / "bag_0.mcap").equals(trial)
    types, found = get_typestore(Stores.ROS2_HUMBLE), {}
    with rosbag2.Reader(tmp_path / "bag") as bag:
        assert bag.duration == round(1e9 * trial.duration) + 1
        for connection, time, raw in bag.messages():
            found.setdefault(connection.topic, []).append(
                (time, types.deserialize_cdr(raw, connection.msgtype))
            )
        qualities = {one.topic: one.ext.offered_qos_profiles for one in bag.connections}
        assert bag.message_count == sum(map(len, found.values()))
    for topic in ("/robot_description", "/tf_static"):
        ((time, _),), (quality,) = found[topic], qualities[topic]
        assert time == found["/tf"][0][0]
        assert (quality.durability.name, quality.depth) == ("TRANSIENT_LOCAL", 1)
    assert qualities["/tf"] == []


def test_a_recording_is_copied_as_it_is_and_one_without_its_end_is_refused(tmp_path):
    with Recorder(tmp_path / "tank.mcap") as recorder:
        recorder.scalar("/x", 1.0, 2.0)
    write_bag(tmp_path / "tank.mcap", tmp_path / "bag")
    content = (tmp_path / "tank.mcap").read_bytes()
    assert (tmp_path / "bag" / "bag_0.mcap").read_bytes() == content
    (tmp_path / "cut.mcap").write_bytes(content[:-40])
    with pytest.raises(
        TrialFileError, match=r"cut\.mcap is not intact: .* `laticauda replay --save` makes a trial"
    ):
        write_bag(tmp_path / "cut.mcap", tmp_path / "other")
    assert not (tmp_path / "other").exists()


def test_a_folder_that_holds_something_is_left_alone(tmp_path, make_trial):
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(StorageFailed, match="must be a new or an empty folder; name another one"):
        write_bag(make_trial(duration=1.0), tmp_path)
    with pytest.raises(
        StorageFailed, match=r"none/bag: cannot be created: no such file or directory\."
    ):
        write_bag(make_trial(duration=1.0), f"{tmp_path}/none/bag")
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
