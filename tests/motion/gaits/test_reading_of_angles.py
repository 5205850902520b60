"""One line says what was read of a table of joint angles; it is kept with the trial, and shown."""

from pathlib import Path

import pytest

import laticauda as lc
from laticauda.cli import main
from laticauda.scenarios import load_scenario, save_scenario
from laticauda.values import TableWarning

ROWS = [[0.05 * i, 0.5 * i, -0.4 * i] for i in range(40)]
SPAN = "40 of 40 rows, from 0 to 1.95 s, no gaps"


def table(folder: Path, names: str, rows: list[list[float]], separator: str = ",") -> Path:
    path = folder / "angles.csv"
    lines = [separator.join(f"{number:.6g}" for number in row) for row in rows]
    path.write_text("\n".join([names.replace(",", separator), *lines]))
    return path


def test_the_line_of_a_plain_table_is_kept_with_its_trial(tmp_path, capsys):
    angles = lc.load_joint_angles(table(tmp_path, "time_s,joint_1_deg,joint_2_deg", ROWS))
    assert angles.reading == f"angles.csv: {SPAN}"
    trial = lc.swim(lc.load_robot("chain", 3), lc.recorded_gait(angles), 1.0)
    assert trial.settings["reading"] == angles.reading
    trial.save(tmp_path / "run.nc")
    assert lc.load_trial(tmp_path / "run.nc").settings["reading"] == angles.reading
    assert main(["trial", "show", str(tmp_path / "run.nc")]) == 0
    assert f"read    angles.csv: {SPAN}" in capsys.readouterr().out
    save_scenario(trial.scenario, tmp_path / "run.toml")
    assert load_scenario(tmp_path / "run.toml").gait.recorded == angles
    gait = lc.eel_like(amplitude=0.3, frequency=2.0, phase_shift=0.7)
    assert "reading" not in lc.swim("mamba", gait, 0.1).settings
    assert lc.JointAngles.of(trial).reading == ""


@pytest.mark.parametrize(
    ("names", "separator", "change", "columns", "remark"),
    [
        ("time_s,joint_1_deg,joint_2_deg", ";", (0, 0.0), None, "semicolons between columns"),
        ("time_s,joint_1_deg,joint_2_deg", "\t", (0, 0.0), None, "tabs between columns"),
        ("t,a,b", ",", (0, 0.0), {"joint_1_deg": "a", "joint_2_deg": "b"}, "joint_1_deg is `a`, joint_2_deg is `b`"),
        ("t [s],a1,a2", ",", (0, 0.0), {"time": "t", "joint_{}_deg": "a{}"}, "time is `t`, joint_{}_deg is `a{}`"),
        ("time_s,joint_1_deg,joint_2_deg", ",", (0, 12.3), None, "its times begin at 12.3 s; time 0 is its first row"),
        ("time_s,joint_1_deg,joint_2_deg", ",", (2, 360.0), None, "whole turns were taken out of joint_2_deg"),
    ],
)  # fmt: skip
@pytest.mark.filterwarnings("ignore::laticauda.values.TableWarning")
def test_the_line_says_what_was_not_taken_as_it_is_written(
    tmp_path, names, separator, change, columns, remark
):
    column, added = change
    rows = [list(row) for row in ROWS]
    for row in rows[10 * (column == 2) :]:
        row[column] += added
    path = table(tmp_path, names, rows, separator)
    assert lc.load_joint_angles(path, columns=columns).reading == f"angles.csv: {SPAN}; {remark}"


def test_a_warning_says_the_same(tmp_path):
    rows = [[t + 5.0, a, b] for t, a, b in ROWS]
    with pytest.warns(TableWarning, match="its times begin at 5 s; time 0 is its first row"):
        lc.load_joint_angles(table(tmp_path, "time_s,joint_1_deg,joint_2_deg", rows))
