import statistics
from dataclasses import replace
from math import radians
from pathlib import Path

import numpy as np
import pytest

import laticauda as lc
from laticauda.paper import load_efficiency_settings, load_repeats, run_efficiency, runs as module
from laticauda.values.errors import SimulationFailed, TrialFileError


def test_every_row_of_table_1_is_what_swim_gives_at_its_setting(study):
    assert len(study.cases) == 22
    for case in study.cases:
        robot = lc.load_robot(case.group.robot)
        trial = lc.swim(robot, case.measured.gait, 30.0)  # the paper's coefficients by default
        assert case.forward_velocity[0] == trial.forward_velocity
        assert case.mechanical_power[0] == trial.mechanical_power
        vortex = lc.swim(robot, case.measured.gait, 30.0, environment=lc.load_water("paper-vortex"))
        assert case.forward_velocity[1] == vortex.forward_velocity


def test_a_curve_and_the_table_agree_where_they_meet(study):
    met = 0
    for sweep in study.sweeps:
        for case in study.cases:
            at = np.abs(sweep.values - getattr(case.measured.gait, sweep.settings.parameter)) < 1e-9
            if sweep.settings.contains(case.measured.gait) and np.any(at):
                curves = sweep.forward_velocity[:, study.settings.groups.index(case.group)]
                assert curves[:, at][:, 0] == pytest.approx(case.forward_velocity, rel=1e-9)
                met += 1
    assert met >= 12


def test_rows_that_were_not_measured_are_kept_as_predictions(study):
    rows = [case.measured for case in study.cases]
    missing = [(row.group, row.case) for row in rows if row.forward_velocity is None]
    assert missing == [("lateral undulation, without fin", 4), ("eel-like motion, without fin", 5)]
    assert len(study.measured) == 20
    assert all(np.all(np.isfinite(case.forward_velocity)) for case in study.cases)


def test_progress_counts_up_to_all_runs():
    settings = replace(
        load_efficiency_settings(), sweeps=load_efficiency_settings().sweeps[:1], duration=15.0
    )
    settings = replace(
        settings, sweeps=(replace(settings.sweeps[0], step=1.0),), models=settings.models[:1]
    )
    told: list[tuple[int, int]] = []
    run_efficiency(settings, progress=lambda done, total: told.append((done, total)))
    assert [done for done, _ in told] == list(range(1, settings.n_runs + 1))
    assert {total for _, total in told} == {settings.n_runs}


def test_a_trial_that_blows_up_is_named(monkeypatch):
    def fail(*args, **settings):
        raise SimulationFailed("The run blew up at 3 s.")

    monkeypatch.setattr(module, "run_scenario", fail)
    message = r"mamba, lateral_undulation, amplitude 30, frequency 130, phase shift 40 \[deg, deg/s\], paper-lateral: "
    with pytest.raises(SimulationFailed, match=message + "The run blew up at 3 s."):
        run_efficiency(
            replace(load_efficiency_settings(), models=load_efficiency_settings().models[:1])
        )


def test_a_joint_law_that_does_not_exist_is_refused():
    with pytest.raises(ValueError, match="`joints` must be one of"):
        run_efficiency(joints="magic")


def test_a_model_that_does_not_exist_is_refused():
    with pytest.raises(ValueError, match="`model` must be one of"):
        run_efficiency(model="magic")


def test_a_set_of_coefficients_may_bring_its_own_waters(study):
    settings = load_efficiency_settings()
    own = replace(
        settings.models[0],
        waters={kind: settings.models[0].water(kind) for kind in settings.models[0].waters},
    )
    short = replace(settings, sweeps=(replace(settings.sweeps[0], step=1.0),), models=(own,))
    assert [case.forward_velocity for case in run_efficiency(short).cases] == [
        case.forward_velocity[:1] for case in study.cases
    ]


HEAD = "gait,config,alpha_deg,omega_deg_s,delta_deg,v_m_s,P_avg_W\n"


@pytest.fixture
def load(tmp_path: Path):
    def load(text: str):
        path = tmp_path / "mine.csv"
        path.write_text(text, encoding="utf-8")
        return load_repeats(path)

    return load


def test_trials_of_a_setting_come_together_with_mean_and_deviation(load):
    rows = (
        "LU,nofin,30,130,40,0.15,100",
        "EEL,fin,30,130,40,0.17,",
        "LU,nofin,30.0,130,40,0.14,104",
    )
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
    (one,) = load(
        "\ufeffv_m_s,gait,config,delta_deg,omega_deg_s,alpha_deg\n0.1, LU ,nofin,40,130,30\n\n"
    )
    assert one.forward_velocity == (0.1,)
    assert one.gait.frequency == radians(130)
    assert one.power is None


def test_a_row_without_a_velocity_is_no_trial(load):
    rows = "LU,nofin,30,130,40,0.15,100\nLU,nofin,30,130,40,,104\n"
    (repeat,) = load(HEAD + rows)
    assert repeat.forward_velocity == (0.15,)
    assert repeat.mean_power == (100.0,)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            HEAD + "LU,nofin,30,130,40,0.15,\nLU,nofin,30,130,x,0.1,\n",
            "row 3: `delta_deg` must be a number, got 'x'.",
        ),
        (HEAD + "\nLU,nofin,30,130,40,0,\n", "row 3: `v_m_s` must be > 0 m/s, got 0.0."),
        (HEAD + "LU,nofin,-1,130,40,0.1,\n", "row 2: `alpha_deg` must be >= 0 deg, got -1.0."),
        (
            HEAD + "LU,nofin,30,nan,40,0.1,\n",
            "row 2: `omega_deg_s` must be a finite number in deg/s, got nan.",
        ),
        (HEAD + "LU,nofin,30,130,40,0.1,-5\n", "row 2: `P_avg_W` must be > 0 W, got -5.0."),
        (
            HEAD + "LU,none,30,130,40,0.1,\n",
            "row 2: `config` must be one of `nofin`, `fin`, got 'none'",
        ),
        (
            HEAD + "lateral,fin,30,130,40,0.1,\n",
            "row 2: `gait` must be one of `LU`, `EEL`, got 'lateral'",
        ),
        (HEAD + "LU,nofin,30,130,40\n", "row 2 must have 7 cells, as row 1 has, got 5."),
        (HEAD + "LU,nofin,30,130,40,0.1,1,2\n", "row 2 must have 7 cells, as row 1 has, got 8."),
        (HEAD, "the table has no rows."),
        ("", "it is not a text file of columns, or it is empty."),
        (HEAD.replace("v_m_s", "v_ms"), "row 1: column `v_ms` is not known; did you mean `v_m_s`?"),
        (HEAD.replace("v_m_s", "gait"), "row 1 must name every column once, got `gait` twice."),
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
    with pytest.raises(TrialFileError, match=r"latin\.csv: it is not a text file of columns"):
        load_repeats(tmp_path / "latin.csv")
