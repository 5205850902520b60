import statistics
from math import radians
from pathlib import Path

import pytest

from laticauda.errors import TrialFileError
from laticauda.paper import load_repeats

HEAD = "gait,config,alpha_deg,omega_deg_s,delta_deg,v_m_s,P_avg_W\n"


@pytest.fixture
def load(tmp_path: Path):
    def load(text: str):
        path = tmp_path / "mine.csv"
        path.write_text(text, encoding="utf-8")
        return load_repeats(path)

    return load


def test_trials_of_a_setting_come_together_with_mean_and_deviation(load):
    rows = ("LU,nofin,30,130,40,0.15,100", "EEL,fin,30,130,40,0.17,", "LU,nofin,30.0,130,40,0.14,104")
    lateral, eel = load(HEAD + "\n".join(rows))
    assert (lateral.gait.kind, lateral.has_fin) == ("lateral_undulation", False)
    assert (lateral.gait.amplitude, lateral.gait.phase_shift) == (radians(30), radians(40))
    assert lateral.forward_velocity == (0.15, 0.14)
    assert lateral.velocity == (pytest.approx(0.145), pytest.approx(statistics.stdev([0.15, 0.14])))
    assert lateral.power == (pytest.approx(102.0), pytest.approx(statistics.stdev([100, 104])))
    assert (eel.gait.kind, eel.has_fin) == ("eel_like", True)


def test_one_trial_has_no_deviation_and_a_missing_power_is_none(load):
    (one,) = load(HEAD + "EEL,fin,30,130,40,0.17,\n")
    assert one.velocity == (0.17, None)
    assert one.mean_power == (None,)
    assert one.power is None


def test_the_power_may_be_left_out_and_columns_come_in_any_order(load):
    (one,) = load("\ufeffv_m_s,gait,config,delta_deg,omega_deg_s,alpha_deg\n0.1, LU ,nofin,40,130,30\n\n")
    assert one.forward_velocity == (0.1,)
    assert one.gait.frequency == radians(130)
    assert one.power is None


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEAD + "LU,nofin,30,130,40,0.15,\nLU,nofin,30,130,x,0.1,\n", "row 3: `delta_deg` must be a number, got 'x'."),
        (HEAD + "\nLU,nofin,30,130,40,0,\n", "row 3: `v_m_s` must be > 0 m/s, got 0.0."),
        (HEAD + "LU,nofin,-1,130,40,0.1,\n", "row 2: `alpha_deg` must be >= 0 deg, got -1.0."),
        (HEAD + "LU,nofin,30,nan,40,0.1,\n", "row 2: `omega_deg_s` must be a finite number in deg/s, got nan."),
        (HEAD + "LU,nofin,30,130,40,0.1,-5\n", "row 2: `P_avg_W` must be > 0 W, got -5.0."),
        (HEAD + "LU,none,30,130,40,0.1,\n", "row 2: `config` must be one of `nofin`, `fin`, got 'none'"),
        (HEAD + "lateral,fin,30,130,40,0.1,\n", "row 2: `gait` must be one of `LU`, `EEL`, got 'lateral'"),
        (HEAD + "LU,nofin,30,130,40\n", "row 2: it must have a cell per column."),
        (HEAD + "LU,nofin,30,130,40,0.1,1,2\n", "row 2: it must have a cell per column."),
        (HEAD, "it has no trials."),
        ("", "row 1: column `gait` is missing."),
        (HEAD.replace("v_m_s", "v_ms"), "row 1: column `v_ms` is not known; did you mean `v_m_s`?"),
        (HEAD.replace("v_m_s", "gait"), "row 1: column `gait` must not be given twice."),
    ],
)
def test_what_is_wrong_is_refused_with_its_row(load, text, message):
    with pytest.raises(TrialFileError) as refused:
        load(text)
    assert f"mine.csv: {message}" in str(refused.value)


def test_a_file_that_cannot_be_read_is_refused(tmp_path: Path):
    with pytest.raises(TrialFileError, match=r"none\.csv: no such file$"):
        load_repeats(tmp_path / "none.csv")
    (tmp_path / "latin.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(TrialFileError, match=r"latin\.csv: is not a text in UTF-8"):
        load_repeats(tmp_path / "latin.csv")
