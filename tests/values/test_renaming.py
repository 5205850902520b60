"""Columns that a file calls otherwise: named by a flag, a task, a scenario or in Python, with every unit kept."""

import shlex
from math import radians
from pathlib import Path

import numpy as np
import pytest

import laticauda as lc
from laticauda.cli import main
from laticauda.identify import from_table
from laticauda.paper import load_repeats
from laticauda.scenarios import load_scenario
from laticauda.trials.measured import load_speeds
from laticauda.values import TrialFileError
from laticauda.values.tables import parse_columns, parse_sheet, rename_columns

TIMES = [0.05 * i for i in range(40)]
DEGREES = [[20.0 * np.sin(3.0 * t), 25.0 * np.sin(3.0 * t + 0.7)] for t in TIMES]


def angles(path: Path, header: str, scale: float = 1.0, time: float = 1.0) -> Path:
    """Two joints under any header; `scale` and `time` are the units of the file."""
    rows = [[time * t, scale * a, scale * b] for t, (a, b) in zip(TIMES, DEGREES, strict=True)]
    lines = [header, *(",".join(map(repr, map(float, row))) for row in rows)]
    path.write_text("\n".join(lines))
    return path


FORMS = {
    "t [s],JointAngle0,JointAngle1": ("time=t [s]", "joint_{}_deg=JointAngle{}"),
    "t,JointAngle1,JointAngle2": ("joint_{}_deg=JointAngle{}",),
    "Time (s),q1 [deg],q2 [deg]": ("time=Time", "joint_{}=q{}"),
    "timestamp,phi_1_deg,phi_2_deg": ("time_s=timestamp", "joint_{}=phi_{}_deg"),
    "Zeit,Schwanz,Kopf": ("time=Zeit", "joint_1_deg=Schwanz", "joint_2_deg=Kopf"),
    "sec,J01,J02": ("time_s=sec", "joint_{}_deg=J{}"),
    "t,joint_0 [deg],joint_1 [deg]": ("joint_{}=joint_{}",),
    "stamp,a=1,a=2": ("time=stamp", "joint_1_deg=a=1", "joint_2_deg=a=2"),
    "Time,t,joint_2_deg": ("time=Time", "joint_1_deg=t", "joint_2_deg=joint_2_deg"),
    '"time, elapsed [s]","left, 1",right': (
        "time=time, elapsed",
        "joint_1_deg=left, 1",
        "joint_2_deg=right",
    ),
}


@pytest.mark.parametrize("header", FORMS)
def test_angles_under_any_names_are_read_by_those_that_are_given(tmp_path, header):
    columns = parse_columns(FORMS[header])
    found = lc.load_joint_angles(angles(tmp_path / "a.csv", header), columns=columns)
    assert found.time == pytest.approx(TIMES)
    np.testing.assert_allclose(np.degrees(found.angle).T, DEGREES, atol=1e-9)


@pytest.mark.parametrize(
    ("header", "scale", "time", "columns"),
    [
        (
            "t [ms],a [rad],b [rad]",
            radians(1.0),
            1e3,
            {"time": "t", "joint_1": "a", "joint_2": "b"},
        ),
        ("t [us],a1,a2", radians(1.0), 1e6, {"time": "t", "joint_{}_rad": "a{}"}),
        ("clock,a1,a2", 1.0, 1e3, {"time_ms": "clock", "joint_{}_deg": "a{}"}),
        (
            "clock,a1 (\N{DEGREE SIGN}),a2 (\N{DEGREE SIGN})",
            1.0,
            1e9,
            {"time_ns": "clock", "joint_{}": "a{}"},
        ),
    ],
)
def test_units_are_those_of_the_file_or_of_the_given_name(tmp_path, header, scale, time, columns):
    path = angles(tmp_path / "a.csv", header, scale, time)
    found = lc.load_joint_angles(path, columns=columns)
    assert found.time == pytest.approx(TIMES)
    np.testing.assert_allclose(np.degrees(found.angle).T, DEGREES, atol=1e-9)


@pytest.mark.parametrize(
    ("header", "words", "message"),
    [
        ("t [s],a1,a2", ["time=t", "joint_{}_deg=b{}"], "no column `b{}` for `joint_{}_deg`; it has"),
        ("t [s],alpha,b", ["joint_1=alhpa"], r"no column `alhpa` for `joint_1`; did you mean `alpha`\?; it"),
        ("t [s],a1,a2", ["time=t", "joint_1=a1", "joint_2=a1"], "`a1` must have one name, got `joint_1` and"),
        ("t,joint_1_deg,b", ["joint_1_deg=b"], "`joint_1_deg` would be two columns, `joint_1_deg` and `b`"),
        ("t,a1 [deg],a2 [deg]", ["joint_{}_rad=a{}"], r"column `a1 \[deg\]` is in deg, but `joint_1_rad` in rad: con"),
        ("t_ms,a1,a2", ["time_s=t_ms", "joint_{}_deg=a{}"], "`t_ms` is in ms, but `time_s` in s: convert it"),
        ("t_s,a1,a2", ["time_ms=t_s", "joint_{}_deg=a{}"], "`t_s` is in s, but `time_ms` in ms: convert it"),
        ("t,a2,a3", ["joint_{}_deg=a{}"], "`a{}` must count from 0 or 1 without a gap, got a2, a3: name each"),
        ("t,a1,a3", ["joint_{}_deg=a{}"], "`a{}` must count from 0 or 1 without a gap, got a1, a3: name each"),
        ("t,a1,a01", ["joint_{}_deg=a{}"], "`a1` and `a01` have the same number"),
        ("t,a1,a2", ["joint_{}_deg=a"], "`joint_{}_deg` and `a` must both hold {}, once"),
        ("t,a1,a2", ["angle_{}=a{}"], "column `angle_{}` is not known; name columns time, joint_1, joint_2"),
    ],
)  # fmt: skip
def test_names_that_cannot_be_right_are_refused(tmp_path, header, words, message):
    path = angles(tmp_path / "a.csv", header)
    with pytest.raises(TrialFileError, match=f"a.csv: .*{message}"):
        lc.load_joint_angles(path, columns=parse_columns(words))


@pytest.mark.parametrize("words", [["time"], ["=t"], ["time="], ["time= "]])
def test_words_of_another_form_are_refused(words):
    with pytest.raises(ValueError, match=r"`column` must be NAME=HEADER, such as time="):
        parse_columns(words)
    with pytest.raises(ValueError, match="`column` must give `time` once, got 'time=b', too"):
        parse_columns(["time=a", "time=b"])


GUESSED = {
    "t [s],JointAngle0,JointAngle1": "'joint_{}_deg=JointAngle{}'",
    "Timestamp,q1,q2": "time=Timestamp 'joint_{}_deg=q{}'",
    "elapsedTime,phi 1 [deg],phi 2 [deg]": "time=elapsedTime 'joint_{}=phi {}'",
    "Sekunde,motor_1_pos,motor_2_pos": "time=Sekunde 'joint_{}_deg=motor_{}_pos'",
    "Zeit [s],J1,J2": "'time=Zeit [s]' 'joint_{}_deg=J{}'",
    "time,joint_0_deg,joint_1_deg": "'joint_{}=joint_{}_deg'",
    "ROS Time,angle[0],angle[1]": "'time=ROS Time' 'joint_{}_deg=angle[{}]'",
}


@pytest.mark.parametrize("header", GUESSED)
def test_the_advice_for_angles_reads_the_file_as_it_stands(tmp_path, header):
    path = angles(tmp_path / "a.csv", header)
    with pytest.raises(TrialFileError, match="must have a column `time_s`") as refused:
        lc.load_joint_angles(path)
    advice = str(refused.value).split("--column ")[1]
    assert advice == GUESSED[header]
    found = lc.load_joint_angles(path, columns=parse_columns(shlex.split(advice)))
    np.testing.assert_allclose(np.degrees(found.angle).T, DEGREES, atol=1e-9)


def test_there_is_no_advice_where_nothing_can_be_guessed(tmp_path):
    path = angles(tmp_path / "a.csv", "t,left,right")
    with pytest.raises(TrialFileError, match=r"at the tail, got t, left, right$"):
        lc.load_joint_angles(path)


SPEEDS = """Gait;Amplitude [deg];Frequency [deg/s];Phase shift [deg];Speed [m/s];Power [W]
LU;30;130;40;0,1514;106,63
LU;25;130;40;0,1300;90,00
"""
PLAIN = "gait,alpha_deg,omega_deg_s,delta_deg,v_m_s,P_avg_W\nLU,30,130,40,.1514,106.63\nLU,25,130,40,.13,90\n"


def speeds(folder: Path, text: str = SPEEDS) -> Path:
    path = folder / "speeds.csv"
    path.write_text(text)
    return path


def advised(path: Path) -> dict[str, str]:
    with pytest.raises(TrialFileError, match="If so, say --column") as refused:
        load_speeds(path)
    return parse_columns(shlex.split(str(refused.value).split("--column ")[1]))


def test_the_advice_for_speeds_reads_the_file_as_it_stands(tmp_path):
    path = speeds(tmp_path)
    columns = advised(path)
    assert columns["omega_deg_s"] == "Frequency [deg/s]"
    plain = tmp_path / "plain.csv"
    plain.write_text(PLAIN)
    assert load_speeds(path, columns) == load_speeds(plain)
    found, expected = from_table(path, columns=columns), from_table(plain)
    assert [row.figures for row in found] == [row.figures for row in expected]
    assert load_repeats(path, columns) == load_repeats(plain)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[deg/s]", "[Hz]", r"`Frequency \[Hz\]` is in Hz, but `omega_deg_s` in deg/s: convert it"),
        ("[deg/s]", "[rad/s]", r"`Frequency \[rad/s\]` is in rad/s, but `omega_deg_s` in deg/s"),
        ("[m/s]", "[cm/s]", r"`Speed \[cm/s\]` is in cm/s, but `v_m_s` in m/s"),
        ("[W]", "[mW]", r"is in mW, but `P_avg_W` in W"),
        ("e [deg]", "e [rad]", r"`Amplitude \[rad\]` is in rad, but `alpha_deg` in deg"),
    ],
)
def test_speeds_in_another_unit_than_the_given_name_says_are_refused(tmp_path, old, new, message):
    path = speeds(tmp_path, SPEEDS.replace(old, new))
    columns = advised(path)
    with pytest.raises(TrialFileError, match=message):
        load_speeds(path, columns)


@pytest.mark.parametrize(
    ("header", "words", "message"),
    [
        ("t [min],a1,a2", ["time=t [min]", "joint_{}_deg=a{}"], "`time` must be in s, ms, us, ns, but the file says"),
        ("t [fortnights],a1,a2", ["time=t [fortnights]", "joint_{}_deg=a{}"], "is in fortnights, which is no unit"),
        ("t,a1 [turns],a2 [turns]", ["joint_{}=a{}"], "`joint_1` must be in deg or rad, but the file says turns"),
        ("t,a1 [gon],a2 [gon]", ["joint_{}=a{} [gon]"], r"`a1 \[gon\]` is in gon, which is no unit known here"),
        ("t,a1 (rev),a2 (rev)", ["joint_{}_deg=a{}"], r"`a1 \(rev\)` is in rev, but `joint_1_deg` in deg: convert"),
    ],
)  # fmt: skip
def test_a_unit_that_is_not_converted_is_refused(tmp_path, header, words, message):
    path = angles(tmp_path / "a.csv", header)
    with pytest.raises(TrialFileError, match=message):
        lc.load_joint_angles(path, columns=parse_columns(words))


def test_a_unit_row_is_that_of_the_columns_under_their_new_names():
    sheet = parse_sheet(b"Zeit,q1\nms,deg\n0,1\n50,2\n")
    renamed = rename_columns(sheet, {"time": "Zeit", "joint_1": "q1"})
    assert renamed.names == ["time", "joint_1"]
    assert renamed.units == {"time": "ms", "joint_1": "deg"}


def test_commands_and_files_take_the_names(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    angles(tmp_path / "a.csv", "t [s],JointAngle0,JointAngle1")
    chain = ["swim", "--robot", "chain", "--n-links", "3", "--duration", "1"]
    names = ["time=t [s]", "joint_{}_deg=JointAngle{}"]
    assert main([*chain, "--joint-angles", "a.csv", "--column", *names, "--json"]) == 0
    printed = capsys.readouterr().out
    text = """kind = "scenario"
robot = "chain"
n_links = 3
[gait]
kind = "lateral-undulation"
[gait.recorded]
file = "a.csv"
columns = { time = "t [s]", "joint_{}_deg" = "JointAngle{}" }
"""
    (tmp_path / "scenario.toml").write_text(text)
    recorded = load_scenario("scenario.toml").gait.recorded
    assert recorded.time == pytest.approx(TIMES)
    assert str(recorded.angle[1][7])[:12] in printed
    for words, message in (
        (["--column", *names], "--column must be given with --joint-angles"),
        (["--joint-angles", "a.csv", "--column", names[0], "--column", names[1]], "given once"),
        (["--joint-angles", "a.nc", "--column", *names], "with a table, but a.nc is a trial"),
        (["--joint-angles", "a.csv", "--column", "x"], "--column must be NAME=HEADER, such as"),
    ):
        assert main([*chain, *words]) != 0
        assert message in capsys.readouterr().err
    (tmp_path / "scenario.toml").write_text(text.replace('"t [s]"', "1"))
    with pytest.raises(
        ValueError, match=r"gait.recorded.columns.* must hold names of columns, got 1"
    ):
        load_scenario("scenario.toml")


def test_a_task_takes_the_names(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    columns = advised(speeds(tmp_path))
    words = [f"{name}={header}" for name, header in columns.items()]
    identify = ["identify", "--table", "speeds.csv", "--parameters", "water.normal_drag", "--quick"]
    assert main([*identify, "--starts", "1", "--output", "typed", "--column", *words]) == 0
    assert main(["identify", "--table1", "--parameters", "water.normal_drag", "--column", *words])
    assert "--column must be given with --table: it says what" in capsys.readouterr().err
    table = ", ".join(f'"{name}" = "{header}"' for name, header in columns.items())
    (tmp_path / "task.toml").write_text(
        'kind = "identification"\nstarts = 1\nparameters = [{ name = "water.normal_drag" }]\n'
        f'options = {{}}\n[table]\nfile = "speeds.csv"\ncolumns = {{ {table} }}\n'.replace(
            "options = {}\n", ""
        )
    )
    assert main(["identify", "task.toml", "--quick", "--output", "filed"]) == 0
    typed, filed = (Path(folder, "parameters.toml").read_text() for folder in ("typed", "filed"))
    number = next(line for line in typed.splitlines() if "normal_drag" in line)
    assert number in filed
