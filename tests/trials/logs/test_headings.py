"""Headings and yaw angles: lost ones, whole turns, jumps that no body makes, and units, as for positions."""

from pathlib import Path

import numpy as np
import pytest

from laticauda.trials.logs import load_trial
from laticauda.trials.trial import Trial
from laticauda.values import TrialFileError

TIMES = 0.02 * np.arange(500)
HEADING = 0.5 + 0.3 * np.sin(3.0 * TIMES)
MAP = """kind = "columns"
robot = "mamba"
[time]
column = "t"
[center_of_mass]
position = ["x", "y"]
[heading]
column = "yaw"
unit = "UNIT"
"""


def read(folder: Path, yaw: np.ndarray, unit: str = "rad", lost: slice | None = None) -> Trial:
    """A robot at 0.15 m/s, whose position is (0, 0) where it was lost."""
    x, y = 1.0 + 0.15 * TIMES, 0.5 + 0.0 * TIMES
    if lost is not None:
        x, y = x.copy(), y.copy()
        x[lost] = y[lost] = 0.0
    columns = zip(TIMES, x, y, yaw.tolist(), strict=True)
    rows = [f"{a:.4f},{b:.6f},{c:.6f},{d!r}" for a, b, c, d in columns]
    (folder / "log.csv").write_text("\n".join(["t,x,y,yaw", *rows]))
    (folder / "map.toml").write_text(MAP.replace("UNIT", unit))
    return load_trial(folder / "log.csv", folder / "map.toml")


def assert_heading(trial: Trial, atol: float = 1e-6) -> None:
    turns = np.round((trial.heading[0] - HEADING[0]) / (2.0 * np.pi))
    np.testing.assert_allclose(trial.heading - 2.0 * np.pi * turns, HEADING, atol=atol)


@pytest.mark.parametrize("code", [0.0, -1.0, 3.1, 99.0, -999.0, 1e6])
@pytest.mark.parametrize("where", [slice(101, 103), slice(50, 54), slice(200, 201)])
def test_a_constant_in_place_of_a_lost_angle_is_filled_and_said(tmp_path, code, where):
    yaw = HEADING.copy()
    yaw[where] = code
    trial = read(tmp_path, yaw)
    n_lost = where.stop - where.start
    assert f"`yaw` was lost in {n_lost} samples, at " in trial.status
    assert f"Measured; {n_lost} of 500 samples had gaps in angle of yaw" in trial.status
    assert_heading(trial, atol=0.01)


def test_an_angle_is_lost_with_its_position(tmp_path):
    yaw = HEADING.copy()
    yaw[100:104] = 0.55  # close to the angle itself: only the position shows it
    trial = read(tmp_path, yaw, lost=slice(100, 104))
    assert "gaps in angle of yaw, x, y" in trial.status
    assert_heading(trial, atol=0.01)


@pytest.mark.parametrize("middle", [0.0, 90.0, 180.0, 270.0])
@pytest.mark.parametrize("unit", ["deg", "rad"])
def test_whole_turns_are_taken_out_and_said(tmp_path, middle, unit):
    offset = np.radians(middle) - HEADING.mean()
    yaw = np.mod(HEADING + offset, 2.0 * np.pi)
    scale = 1.0 if unit == "rad" else 180.0 / np.pi
    trial = read(tmp_path, scale * yaw, unit)
    change = np.diff(trial.heading) - np.diff(HEADING)
    np.testing.assert_allclose(change, 0.0, atol=1e-6)
    assert ("whole turns were taken out of `yaw`" in trial.status.lower()) == (middle == 0.0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ((250, np.pi), "`yaw` jumps by 1[78].* deg from 4.98 s to 5 s: no body turns that fast; were its ends"),
        ((250, 1.0), "`yaw` jumps by 5[678].* deg from 4.98 s to 5 s"),
        ((1, -0.7), r"`yaw` jumps by|must hold numbers at both ends"),
        ((480, 2.0), "`yaw` jumps by 11[45].* deg from 9.58 s to 9.6 s"),
    ],
)  # fmt: skip
def test_a_jump_that_no_body_makes_is_refused(tmp_path, change, message):
    first, jump = change
    yaw = HEADING.copy()
    yaw[first:] += jump
    with pytest.raises(TrialFileError, match=message):
        read(tmp_path, yaw)


def test_degrees_that_are_taken_for_radians_are_refused(tmp_path):
    message = "`yaw` turns faster than 20 rad/s most of the time; is its unit deg"
    with pytest.raises(TrialFileError, match=message):
        read(tmp_path, np.degrees(HEADING))


def test_radians_that_are_called_degrees_are_said(tmp_path):
    trial = read(tmp_path, HEADING, "deg")
    assert "`yaw` only reaches 0.8 deg, as angles in rad would." in trial.status
    assert "as angles in rad would" not in read(tmp_path, np.degrees(HEADING), "deg").status


def test_a_body_that_turns_round_and_round_is_no_jump(tmp_path):
    trial = read(tmp_path, 5.0 * TIMES)
    assert trial.heading[-1] - trial.heading[0] == pytest.approx(5.0 * TIMES[-1])
