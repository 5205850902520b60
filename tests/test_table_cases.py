"""Cases from the field, each with its source in tests/cases/*/case.md: tables and recordings that others brought."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

import laticauda as lc
from laticauda.cli import main
from laticauda.identify import from_table
from laticauda.trials.logs import load_trial
from laticauda.trials.logs.recording import open_recording
from laticauda.values import TableWarning
from laticauda.values.errors import TrialFileError

CASES = Path(__file__).parent / "cases"
PLAIN = CASES / "f01_unix_time" / "ja_plain.csv"
MAP = (CASES / "f04_c3d_lost_marker_zero" / "c3.toml").read_text()


def assert_same_angles(found: lc.JointAngles) -> None:
    plain = lc.load_joint_angles(PLAIN)
    assert found.time == pytest.approx(plain.time, abs=1e-6)
    np.testing.assert_allclose(found.angle, plain.angle, atol=1e-9)


def case_f01_unix_time(_):
    with pytest.warns(TableWarning, match="`time_s` counts s since 1970; time 0 is its first row"):
        found = lc.load_joint_angles(CASES / "f01_unix_time" / "ja_unixtime.csv")
    assert_same_angles(found)


def test_a_command_says_in_a_line_what_it_did_not_take_as_it_is_written(capsys):
    file = CASES / "f01_unix_time" / "ja_unixtime.csv"
    words = ["swim", "--robot", "chain", "--n-links", "9", "--joint-angles", str(file)]
    assert main([*words, "--duration", "6", "--json"]) == 0
    printed = capsys.readouterr()
    line = f"laticauda: {file}: `time_s` counts s since 1970; time 0 is its first row"
    assert line in printed.err.splitlines()
    assert json.loads(printed.out)["forward_velocity"] > 0.03


def case_f03_wrap_360(_):
    with pytest.warns(TableWarning, match="whole turns were taken out of joint_1_deg"):
        found = lc.load_joint_angles(CASES / "f03_wrap_360" / "ja_jump360.csv")
    assert_same_angles(found)


def case_f04_c3d_lost_marker_zero(_):
    pytest.importorskip("ezc3d")
    folder = CASES / "f04_c3d_lost_marker_zero"
    trial = load_trial(folder / "czero.c3d", folder / "c3.toml")
    assert trial.status.startswith("Measured; 6 of 1000 samples had gaps in m X, m Y")
    assert np.max(np.abs(np.diff(trial.center_of_mass, axis=0))) < 0.01


def case_f06_c3d_duplicate_labels(_):
    pytest.importorskip("ezc3d")
    folder = CASES / "f06_c3d_duplicate_labels"
    with pytest.raises(TrialFileError, match="The file has `m` more than once"):
        load_trial(folder / "cdup.c3d", folder / "c3.toml")


def case_f07_qtm_duplicate_names(folder):
    """Like f06, in a TSV export of Qualisys Track Manager."""
    rows = "".join(f"{1.5 * i}\t0\t0\t0\t0\t0\n" for i in range(100))
    head = "NO_OF_FRAMES\t100\nFREQUENCY\t100\nDATA_INCLUDED\t3D\nMARKER_NAMES\tm\tm\n"
    (folder / "run.tsv").write_text(head + rows)
    (folder / "map.toml").write_text(MAP)
    with pytest.raises(TrialFileError, match="The file has `m X` more than once"):
        load_trial(folder / "run.tsv", folder / "map.toml")


def c3d(path: Path, points: np.ndarray, first_frame: int = 0) -> None:
    """A marker m at 100 Hz [mm]."""
    ezc3d = pytest.importorskip("ezc3d")
    file = ezc3d.c3d()
    file["header"]["points"]["first_frame"] = first_frame
    file["parameters"]["POINT"]["RATE"]["value"] = [100.0]
    file["parameters"]["POINT"]["LABELS"]["value"] = ("m",)
    file["parameters"]["POINT"]["UNITS"]["value"] = ("mm",)
    file["data"]["points"] = np.vstack((points.T, np.ones(len(points))))[:, np.newaxis]
    file.write(str(path))


def track(n_frames: int) -> np.ndarray:
    """0.15 m/s from 1 m on [mm]."""
    points = np.full((n_frames, 3), 10.0)
    points[:, 0] = 1e3 + 1.5 * np.arange(n_frames)
    return points


def case_f08_c3d_65535_frames(folder):
    c3d(folder / "long.c3d", track(70_000))
    (folder / "map.toml").write_text(MAP)
    trial = load_trial(folder / "long.c3d", folder / "map.toml")
    assert trial.time.size == 70_000
    assert trial.center_of_mass[-1, 0] == pytest.approx(1.0 + 0.0015 * 69_999, abs=1e-3)
    assert "70000 of 70000 rows" in trial.settings["reading"]
    counted = "its header counts 65535 frames; it has 70000 by the length of the file"
    assert counted in trial.settings["reading"]


def case_f09_semicolon_table(_):
    folder = CASES / "f09_semicolon_table"
    assert_same_angles(lc.load_joint_angles(folder / "ja_semi.csv"))
    first, second = (from_table(folder / f"semicolon{end}.csv") for end in ("", "_deccomma"))
    assert [row.figures for row in first] == [row.figures for row in second]
    assert [row.scenario for row in first] == [row.scenario for row in second]


def case_f11_nanoseconds(_):
    folder = CASES / "f11_nanoseconds"
    trial = load_trial(folder / "l_ns.csv", folder / "l_ns.toml")
    assert trial.forward_velocity == pytest.approx(0.15, abs=1e-4)
    assert "`t` counts ns since 1970; time 0 is its first row" in trial.status
    assert "`t` counts ns since 1970" in trial.settings["reading"]


def case_g08_rosbag_folder_not_read_back(folder):
    pytest.importorskip("mcap")
    trial = lc.swim(
        "mamba", lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7), 0.5
    )
    trial.save(folder / "t.nc")
    lc.trials.logs.write_bag(trial, folder / "ros")
    assert load_trial(folder / "ros").equals(load_trial(folder / "ros" / "ros_0.mcap"))
    shutil.copy(folder / "ros" / "ros_0.mcap", folder / "ros" / "ros_1.mcap")
    with pytest.raises(TrialFileError, match=r"it is split into ros_0.mcap, ros_1.mcap; name one"):
        load_trial(folder / "ros")
    for name, cure in (("old.bag", "rosbags-convert"), ("new.db3", "ros2 bag convert")):
        (folder / name).write_bytes(b"#ROSBAG V2.0\n")
        with pytest.raises(TrialFileError, match=cure):
            load_trial(folder / name)
    with pytest.raises(TrialFileError, match=r"a folder without metadata\.yaml: not a bag"):
        load_trial(CASES)


def case_p12_mcap_no_message_index(folder):
    """Also without chunks, and with another compression."""
    writer = pytest.importorskip("mcap.writer")
    forms = [
        {"index_types": writer.IndexType.NONE},
        {"index_types": writer.IndexType.CHUNK},
        {"use_chunking": False},
        {"compression": writer.CompressionType.LZ4},
    ]
    for form in forms:
        assert len(write_messages(folder / "any.mcap", b"\x00\x01\x00\x00" + bytes(8), form)) == 50


def case_p14_mcap_large_messages(folder):
    pytest.importorskip("mcap")
    content = b"\x00\x01\x00\x00" + bytes(8)
    assert len(write_messages(folder / "any.mcap", content, {"chunk_size": 16})) == 50


def write_messages(path: Path, content: bytes, form: dict) -> list:
    """Write 50 messages in a form of MCAP, and read them."""
    from mcap.writer import Writer

    with path.open("wb") as file:
        writer = Writer(file, **form)
        writer.start(profile="ros2", library="test")
        definition = b"float64 data"
        schema = writer.register_schema("std_msgs/msg/Float64", "ros2msg", definition)
        channel = writer.register_channel("/x", "cdr", schema)
        for i in range(50):
            writer.add_message(channel, log_time=i * 10**7, publish_time=i * 10**7, data=content)
        writer.finish()
    return list(open_recording(path).messages())


def case_p15_first_frame(folder):
    c3d(folder / "late.c3d", track(1000), first_frame=250)
    (folder / "map.toml").write_text(MAP)
    trial = load_trial(folder / "late.c3d", folder / "map.toml")
    assert trial.time[0] == 0.0
    assert trial.forward_velocity == pytest.approx(0.15, abs=1e-4)


KNOWN = {name: value for name, value in globals().items() if name.startswith("case_")}


@pytest.mark.parametrize("name", KNOWN)
def test_a_case_from_the_field_is_read_right_or_refused_with_its_cause(name, tmp_path):
    KNOWN[name](tmp_path)


@pytest.mark.parametrize("where", [slice(100, 106), slice(0, 5), slice(990, 1000), slice(100, 900)])
@pytest.mark.parametrize("code", [0.0, -16512.0, 9999.0, -1e6])
def test_a_marker_that_was_lost_is_no_place_whatever_stands_there(tmp_path, code, where):
    points = track(1000)
    points[where] = code
    c3d(tmp_path / "lost.c3d", points)
    (tmp_path / "map.toml").write_text(MAP)
    n_lost = where.stop - where.start
    is_filled = 0 < where.start and where.stop < 1000 and n_lost < 10
    if not is_filled:
        with pytest.raises(TrialFileError, match=r"`m X` must (hold numbers at both|have no gap)"):
            load_trial(tmp_path / "lost.c3d", tmp_path / "map.toml")
        return
    trial = load_trial(tmp_path / "lost.c3d", tmp_path / "map.toml")
    assert "Measured; 6 of 1000 samples had gaps" in trial.status
    np.testing.assert_allclose(
        trial.center_of_mass[:, 0], 1e-3 * points[:, 0][0] + 0.0015 * np.arange(1000), atol=1e-4
    )
    if code:
        assert "`m` was lost in 6 samples, at (" in trial.status


def test_markers_that_change_places_are_refused(tmp_path):
    points = track(1000)
    points[300:] += [700.0, 0.0, 0.0]
    c3d(tmp_path / "confused.c3d", points)
    (tmp_path / "map.toml").write_text(MAP)
    with pytest.raises(TrialFileError, match=r"`m` jumps by 0.701 m from 2.99 s to 3 s, farther"):
        load_trial(tmp_path / "confused.c3d", tmp_path / "map.toml")


# ---- ten more inputs of each kind ----------------------------------------------------------------


def angle_table(folder: Path, times: list, name: str = "time_s", end: str = "\n") -> Path:
    """The angles of f01 at other times."""
    rows = PLAIN.read_text().split()
    lines = [rows[0].replace("time_s", name)]
    for time, row in zip(times, rows[1:], strict=True):
        lines.append(",".join([str(time), *row.split(",")[1:]]))
    (folder / "angles.csv").write_bytes(end.join(lines).encode())
    return folder / "angles.csv"


PLAIN_TIMES = [float(row.split(",")[0]) for row in PLAIN.read_text().split()[1:]]


@pytest.mark.parametrize("unit", ["s", "ms", "us", "ns"])
@pytest.mark.parametrize("name", ["t", "time_s"])
@pytest.mark.parametrize("epoch", [700_000_000, 4_000_000_000])
def test_times_since_1970_are_those_of_a_run_whatever_their_unit_is_called(
    tmp_path, unit, name, epoch
):
    factor = {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9}[unit]
    times = [
        epoch * factor + round(factor * time, 6 if unit == "s" else None) for time in PLAIN_TIMES
    ]
    with pytest.warns(TableWarning, match=f"counts {unit} since 1970; time 0 is its first row"):
        assert_same_angles(lc.load_joint_angles(angle_table(tmp_path, times, name)))


@pytest.mark.parametrize("name", ["time_s", "time_ms", "time_ns", "t"])
@pytest.mark.parametrize(
    "form", ["17:30:{:06.3f}", "2026-11-29T17:30:{:06.3f}", "2026-11-29 17:30:{:06.3f}Z"]
)
def test_clocks_and_dates_are_in_s_whatever_the_name_says(tmp_path, name, form):
    path = angle_table(tmp_path, [form.format(time) for time in PLAIN_TIMES], name)
    with pytest.warns(TableWarning, match="time 0 is its first row"):
        assert_same_angles(lc.load_joint_angles(path))


@pytest.mark.parametrize("turns", [1, -1, 2, 7])
@pytest.mark.parametrize("row", [1, 5, 60, 119])
def test_whole_turns_from_any_row_on_are_taken_out(tmp_path, turns, row):
    lines = PLAIN.read_text().split()
    for i in range(row, len(lines)):
        time, first, *others = lines[i].split(",")
        lines[i] = ",".join([time, repr(float(first) + 360.0 * turns), *others])
    (tmp_path / "angles.csv").write_text("\n".join(lines))
    if row == 1:  # all of them: nothing shows that they are turns but their size
        with pytest.raises(TrialFileError, match="must be between -180 and 180 deg"):
            lc.load_joint_angles(tmp_path / "angles.csv")
        return
    with pytest.warns(TableWarning, match="whole turns were taken out of joint_1_deg"):
        assert_same_angles(lc.load_joint_angles(tmp_path / "angles.csv"))


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("sign", ["\u2028", "\x0c", "\x0b", "\x1c", "\x85"])
def test_only_ends_of_lines_end_a_row(tmp_path, end, sign):
    path = angle_table(tmp_path, PLAIN_TIMES, end=end)
    path.write_bytes(f"# a{sign}b{end}".encode() + path.read_bytes())
    assert_same_angles(lc.load_joint_angles(path))


@pytest.mark.parametrize(
    "cell", ["1_0", "0x1F", "1.2.3", "1;5", "--1", "1e", "ten", "1 2", "+-3", "1d0"]
)
def test_what_only_a_program_takes_for_a_number_is_refused(tmp_path, cell):
    path = angle_table(tmp_path, PLAIN_TIMES)
    lines = path.read_text().split("\n")
    lines[7] = f'{PLAIN_TIMES[6]},"{cell}",{",".join(lines[7].split(",")[2:])}'
    path.write_text("\n".join(lines))
    with pytest.raises(TrialFileError, match=r"`joint_1_deg` must hold numbers, got .* in row 8"):
        lc.load_joint_angles(path)
    speeds = f'gait,alpha_deg,omega_deg_s,delta_deg,v_m_s\nLU,30,130,40,"{cell}"\n'
    (tmp_path / "speeds.csv").write_text(speeds)
    with pytest.raises(TrialFileError, match="row 2: `v_m_s` must be a number, got"):
        from_table(tmp_path / "speeds.csv")
