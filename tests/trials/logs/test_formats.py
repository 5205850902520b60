"""Every format of trial files: what is written loads back equal, and what is damaged is refused."""

import dataclasses
import pickle
import shutil
import subprocess
import xml.etree.ElementTree as ET
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from laticauda.robot import load_robot
from laticauda.trials import Format, Trial, metrics
from laticauda.trials.logs import load_trial
from laticauda.trials.logs.mat import read_mat_columns
from laticauda.values.errors import StorageFailed, TrialFileError

LIBRARIES = {
    ".nc": "netCDF4",
    ".mcap": "mcap",
    ".parquet": "pyarrow",
    ".mat": "scipy",
    ".csv": "csv",
}
WHOLE = [ending for ending in Format.endings() if ending != ".csv"]


@pytest.fixture(params=WHOLE)
def ending(request: pytest.FixtureRequest) -> str:
    pytest.importorskip(LIBRARIES[request.param])
    return request.param


def test_a_trial_with_everything_loads_back_equal(full_trial, ending, tmp_path):
    path = tmp_path / f"run{ending}"
    full_trial.save(path)
    assert load_trial(path).equals(full_trial)


def test_a_trial_in_space_loads_back_equal(make_trial, ending, tmp_path):
    trial = make_trial(duration=1.0, n_axes=3, robot=load_robot("mamba-modules-fin"))
    trial.save(tmp_path / f"run{ending}")
    assert load_trial(tmp_path / f"run{ending}").equals(trial)


def test_a_trial_of_one_sample_and_a_time_before_zero_loads_back_equal(
    make_trial, ending, tmp_path
):
    trial = make_trial(duration=0.0)
    trial = dataclasses.replace(trial, time=trial.time - 3.3, not_measured=("work", "joint_torque"))
    trial.save(tmp_path / f"run{ending}")
    assert load_trial(tmp_path / f"run{ending}").equals(trial)


def test_a_file_without_its_end_is_refused(full_trial, ending, tmp_path):
    path = tmp_path / f"run{ending}"
    full_trial.save(path)
    content = path.read_bytes()
    for share in (0.0, 0.3, 0.6, 0.95):
        path.write_bytes(content[: int(share * len(content))])
        with pytest.raises(TrialFileError, match=f"Cannot load .*run{ending}: "):
            load_trial(path)


@settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(rubbish=st.binary(max_size=300))
def test_bytes_that_are_no_trial_are_refused(ending, tmp_path, rubbish):
    path = tmp_path / f"run{ending}"
    path.write_bytes(rubbish)
    with pytest.raises(TrialFileError, match=f"Cannot load .*run{ending}: "):
        load_trial(path)


def test_a_missing_file_is_said(ending, tmp_path):
    with pytest.raises(TrialFileError, match=f"Cannot read .*none{ending}: no such file"):
        load_trial(tmp_path / f"none{ending}")


def test_a_folder_that_does_not_exist_is_said(full_trial, ending, tmp_path):
    with pytest.raises(StorageFailed, match=f"none/run{ending}: cannot be written: No such file"):
        full_trial.save(tmp_path / "none" / f"run{ending}")


def test_a_table_alone_does_not_say_what_swam(full_trial, tmp_path):
    full_trial.save(tmp_path / "run.csv")
    with pytest.raises(TrialFileError, match="does not state the robot; give a column map"):
        load_trial(tmp_path / "run.csv")


# ---- read by others ------------------------------------------------------------------------------


def test_the_package_mcap_reads_what_the_trial_holds(full_trial: Trial, tmp_path: Path):
    reader, decoders = pytest.importorskip("mcap.reader"), pytest.importorskip("mcap_ros2.decoder")
    full_trial.save(tmp_path / "run.mcap")
    found: dict[str, list[object]] = {}
    stamps: list[float] = []
    with (tmp_path / "run.mcap").open("rb") as file:
        for _, channel, record, message in reader.make_reader(
            file, decoder_factories=[decoders.DecoderFactory()]
        ).iter_decoded_messages():
            found.setdefault(channel.topic, []).append(message)
            if channel.topic == "/joint_states":
                stamps.append(record.log_time / 1e9)
    joints = found["/joint_states"]
    assert np.array_equal([one.position for one in joints], full_trial.joint_angle)
    assert np.array_equal([one.velocity for one in joints], full_trial.joint_rate)
    assert np.array_equal([one.effort for one in joints], full_trial.joint_torque)
    assert joints[0].name == ["joint_0", "joint_1", "joint_2"]
    assert np.array_equal(
        [one.position for one in found["/joint_reference"]], full_trial.joint_angle_ref
    )
    assert np.array_equal([one.data for one in found["/trial/heading"]], full_trial.heading)
    poses = [one.pose for one in found["/center_of_mass"]]
    assert np.array_equal(
        [[one.position.x, one.position.y] for one in poses], full_trial.center_of_mass
    )
    assert np.allclose(
        [2.0 * np.arctan2(one.orientation.z, one.orientation.w) for one in poses],
        full_trial.heading,
    )
    links = [f"module_{i}" for i in range(4)]
    moving = [(one.header.frame_id, one.child_frame_id) for one in found["/tf"][0].transforms]
    assert moving == list(zip(["world", "world", *links], ["robot", *links], strict=False))
    (description,), (static,) = found["/robot_description"], found["/tf_static"]
    still = [one.child_frame_id for one in static.transforms]
    assert {one.get("name") for one in ET.fromstring(description.data).iter("link")} == {
        *links,
        *still,
    }
    made = datetime.fromisoformat(full_trial.created).timestamp()
    assert np.allclose(stamps, full_trial.time + made, atol=1e-6)


def test_the_links_of_a_viewer_are_where_the_links_are(make_trial, tmp_path):
    from laticauda.robot.kinematics import Posture

    pytest.importorskip("mcap")
    from laticauda.trials.logs import open_recording

    trial = make_trial(duration=1.0)
    trial.save(tmp_path / "run.mcap")
    last = list(open_recording(tmp_path / "run.mcap").messages("/tf"))[-1].content["transforms"]
    ends = Posture(trial.robot, trial.center_of_mass, trial.link_angle, trial.fin_angle).link_ends[
        -1
    ]
    place, angle = np.zeros(2), 0.0
    for i, one in enumerate(one for one in last if one["child_frame_id"] != "robot"):
        turn, offset = one["transform"]["rotation"], one["transform"]["translation"]
        place = place + np.array(
            [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        ) @ [
            offset["x"],
            offset["y"],
        ]
        angle += 2.0 * np.arctan2(turn["z"], turn["w"])
        assert np.allclose(place, ends[i], atol=1e-12) and offset["z"] == 0.0
        assert np.isclose(np.sin(angle - trial.link_angle[-1, i]), 0.0, atol=1e-12)


def test_the_same_trial_makes_the_same_file(full_trial, tmp_path):
    pytest.importorskip("mcap")
    for name in ("one.mcap", "two.mcap"):
        full_trial.save(tmp_path / name)
    assert (tmp_path / "one.mcap").read_bytes() == (tmp_path / "two.mcap").read_bytes()


def test_where_nobody_measured_how_the_robot_was_bent_its_place_alone_is_drawn(
    make_trial, tmp_path
):
    pytest.importorskip("mcap")
    from laticauda.trials.logs import open_recording

    dataclasses.replace(make_trial(duration=1.0), not_measured=("joint_angle",)).save(
        tmp_path / "run.mcap"
    )
    first = next(open_recording(tmp_path / "run.mcap").messages("/tf")).content["transforms"]
    assert [one["child_frame_id"] for one in first] == ["robot"]


def test_pandas_reads_the_columns_of_a_parquet_file_and_their_units(full_trial, tmp_path):
    pyarrow = pytest.importorskip("pyarrow.parquet")
    full_trial.save(tmp_path / "run.parquet")
    table = pyarrow.read_table(tmp_path / "run.parquet")
    assert np.array_equal(table.column("joint_angle_2").to_numpy(), full_trial.joint_angle[:, 2])
    assert table.schema.field("joint_torque_0").metadata == {b"unit": b"N m"}


@pytest.mark.parametrize("place", [232, 320])
def test_a_mat_file_that_crashes_its_library_is_refused(tmp_path, place):
    scipy = pytest.importorskip("scipy.io")
    path = tmp_path / "run.mat"
    scipy.savemat(path, {"units": {"time": "s", "angle": "rad"}})
    content = bytearray(path.read_bytes())
    content[place] ^= 1 if place == 232 else 1 << 7
    path.write_bytes(content)
    with pytest.raises(TrialFileError, match=r"run\.mat: it is not a \.mat file, or it is damaged"):
        load_trial(path)


def test_a_mat_file_that_keeps_its_library_for_ever_is_refused(full_trial, tmp_path, monkeypatch):
    full_trial.save(tmp_path / "run.mat")
    monkeypatch.setattr("laticauda.trials.logs.mat._PATIENCE", 0.001)
    with pytest.raises(
        TrialFileError, match=r"run\.mat: it is damaged: reading it takes longer than 0\.001 s"
    ):
        load_trial(tmp_path / "run.mat")


@pytest.mark.skipif(shutil.which("octave-cli") is None, reason="GNU Octave is not installed")
def test_octave_reads_a_mat_file(full_trial, tmp_path):
    pytest.importorskip("scipy")
    full_trial.save(tmp_path / "run.mat")
    script = """
    load run.mat
    v = norm(center_of_mass(end, :) - center_of_mass(1, :)) / (time(end) - time(1));
    is_custom = any(strfind(scenario, 'kind = "custom"'));
    printf("%.17g\\n%.17g\\n%s\\n%d\\n%d\\n", v, joint_angle(3, 2), units.joint_torque, is_custom, rows(joint_angle));
    """
    (tmp_path / "read.m").write_text(script)
    done = subprocess.run(
        ["octave-cli", "--no-init-file", "read.m"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 0, done.stderr
    speed, angle, unit, is_custom, rows = done.stdout.splitlines()
    known = metrics.forward_velocity(full_trial.time, full_trial.center_of_mass)
    assert float(speed) == pytest.approx(known, rel=1e-14)
    assert float(angle) == full_trial.joint_angle[2, 1]
    assert unit == "N m"
    assert is_custom == "1"
    assert int(rows) == full_trial.time.size


def test_a_recording_is_no_trial(tmp_path):
    pytest.importorskip("mcap")
    from laticauda.trials.logs import Recorder

    with Recorder(tmp_path / "lab.mcap") as recorder:
        recorder.scalar("/x", 0.0, 1.0)
    with pytest.raises(TrialFileError, match=r"lab.mcap: it is a recording, but not a trial"):
        load_trial(tmp_path / "lab.mcap")


def test_a_trial_is_the_same_behind_its_dataset(full_trial):
    dataset = full_trial.to_dataset()
    assert Trial.from_dataset(dataset).equals(full_trial)
    with pytest.raises(KeyError, match="joint_torque"):
        Trial.from_dataset(dataset.drop_vars("joint_torque"))


def test_a_format_of_ones_own_is_one_class(full_trial, tmp_path):
    class Pickled(Format):
        called = "pickle"

        @staticmethod
        def write(dataset, path):
            path.write_bytes(pickle.dumps(dataset))

        @staticmethod
        def read(path):
            return pickle.loads(path.read_bytes())

    assert ".pickle" in Format.endings()
    full_trial.save(tmp_path / "run.pickle")
    assert load_trial(tmp_path / "run.pickle").equals(full_trial)
    del Format._members["pickle"]


# ---- .mat, which a process of its own reads ------------------------------------------------------


@pytest.mark.parametrize("version", ["4", "5"])
def test_columns_of_a_mat_file_of_either_version_are_read(version: str, tmp_path: Path):
    scipy_io = pytest.importorskip("scipy.io")
    scipy_io.savemat(tmp_path / "run.mat", {"time": np.arange(3.0)}, format=version)
    np.testing.assert_array_equal(read_mat_columns(tmp_path / "run.mat")["time"], [0.0, 1.0, 2.0])


def test_bytes_that_do_not_begin_like_a_mat_file_start_no_process(monkeypatch, tmp_path: Path):
    pytest.importorskip("scipy")
    monkeypatch.setattr(subprocess, "run", None)
    (tmp_path / "run.mat").write_bytes(b"time,x\n0.0,1.0\n" * 20)
    with pytest.raises(ValueError, match=r"it is not a \.mat file"):
        read_mat_columns(tmp_path / "run.mat")
