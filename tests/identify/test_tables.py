import csv
from math import degrees

import pytest
from identify.trials import FRICTION

from laticauda.identify import compare_laws, fit, from_table, from_table1
from laticauda.trials import MeasuredTrials
from laticauda.trials.measured import KINDS
from laticauda.values.errors import SkippedRowsWarning, TrialFileError

ROW = {"gait": "LU", "alpha_deg": 30, "omega_deg_s": 130, "delta_deg": 40, "v_m_s": 0.15}


@pytest.fixture
def written(tmp_path):
    def write(*rows):
        path = tmp_path / "mine.csv"
        with open(path, "w", newline="") as file:
            table = csv.DictWriter(file, list(rows[0]))
            table.writeheader()
            table.writerows(rows)
        return path

    return write


def table1_rows():
    short = {kind: name for name, kind in KINDS.items()}
    for trial in MeasuredTrials.named("table1")().trials():
        gait = trial.gait
        yield {
            "gait": short[gait.kind],
            "config": "fin" if trial.has_fin else "nofin",
            "alpha_deg": round(degrees(gait.amplitude), 9),
            "omega_deg_s": round(degrees(gait.frequency), 9),
            "delta_deg": round(degrees(gait.phase_shift), 9),
            "v_m_s": trial.forward_velocity or "",
            "P_avg_W": trial.mean_power or "",
            "selected_from": 3 if trial.is_maximum else 1,
        }


def test_table_1_as_a_file_gives_the_same_numbers(written):
    path = written(*table1_rows())
    with pytest.warns(
        SkippedRowsWarning, match=r"mine.csv: 2 of 22 rows have no speed: rows 5, 16"
    ):
        mine = from_table(path)
    for one, other in zip(mine, from_table1(), strict=True):
        assert (one.name, one.figures, one.selected_from) == (
            other.name,
            other.figures,
            other.selected_from,
        )
        assert one.scenario == other.scenario
    found, printed = (
        fit(rows, parameters=[FRICTION], noise="estimated", n_starts=1, rivals=False)
        for rows in (mine, from_table1())
    )
    assert f"{found[FRICTION]}" == f"{printed[FRICTION]}"
    powers = [one.figures for one in from_table1("mean_power")]
    with pytest.warns(SkippedRowsWarning, match="of 22 rows have no power: rows"):
        assert [one.figures for one in from_table(path, "mean_power")] == powers


def test_a_row_may_say_its_robot_and_noise_and_settings_may_repeat(written):
    own = {**ROW, "robot": "mamba-modules", "v_sigma_m_s": 0.004, "duration_s": 20}
    first, second, third = from_table(
        written(own, own, {**own, "gait": "EEL", "robot": ""}), robot="amphibot"
    )
    assert first.scenario.robot.name == "mamba-modules"
    assert (first.figures["forward_velocity"], first.scenario.duration) == ((0.15, 0.004), 20.0)
    assert second.name == f"{first.name} (2)"
    assert (third.scenario.gait.kind, third.scenario.robot.name) == ("eel_like", "amphibot")
    finned, bare = from_table(written({**ROW, "config": "fin"}, {**ROW, "config": "nofin"}))
    assert (finned.scenario.robot.caudal_fin is None, bare.scenario.robot.caudal_fin is None) == (
        False,
        True,
    )


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"v_m_s": 15.0}, "`v_m_s` of 15 at `omega_deg_s` of 130"),
        ({"omega_deg_s": 2.3}, "`v_m_s` of 0.15 at `omega_deg_s` of 2.3"),
        (
            {"omega_deg_s": 0.36},
            "more than anything swims; is one in another unit, such as cm/s, rad/s or Hz?",
        ),
        (
            {"alpha_deg": 0.52},
            "column `alpha_deg` only reaches 0.52, too little for deg; is it in rad?",
        ),
        ({"delta_deg": 0.7}, "column `delta_deg` only reaches 0.7"),
        (
            {"omega_rad_s": 2.3},
            "row 1: column `omega_rad_s` is not known; did you mean `omega_deg_s`?",
        ),
        ({"v_cm_s": 15}, "row 1: column `v_cm_s` is not known; did you mean `v_m_s`?"),
        (
            {"config": "fin", "robot": "amphibot"},
            "`config` must be nofin for `amphibot`, which has no caudal fin",
        ),
    ],
)
def test_wrong_units_and_wrong_robots_are_refused_by_name(written, changes, words):
    with pytest.raises(TrialFileError) as refused:
        from_table(written({**ROW, **changes}))
    assert words in str(refused.value)


def test_a_speed_in_another_unit_is_refused_with_all_its_rows(written):
    fast = {**ROW, "v_m_s": 15.0}
    with pytest.raises(TrialFileError, match=r"mine.csv: rows 2, 4: `v_m_s` of 15 at"):
        from_table(written(fast, ROW, fast, ROW))


def test_a_table_without_a_power_has_none_to_identify_from(written):
    with pytest.raises(TrialFileError, match="none of its rows has a mean power"):
        from_table(written(ROW), "mean_power")


def test_laws_are_fitted_one_by_one_to_the_same_measurements(written):
    rows = from_table(
        written(*({**ROW, "omega_deg_s": omega, "v_m_s": omega / 900} for omega in (90, 110, 130)))
    )
    found = compare_laws(rows, ["paper", "mamba-identified"], parameters=[FRICTION], n_starts=1)
    assert list(found) == ["paper", "mamba-identified"]
    for name, one in found.items():
        (alone,) = compare_laws(rows, [name], parameters=[FRICTION], n_starts=1).values()
        assert (one.values, one.chi2) == (alone.values, alone.chi2)
        assert [m.figures for m in one.problem.measurements] == [m.figures for m in rows]
    joints = {type(one.problem.model.joints).__name__ for one in found.values()}
    assert len(joints) == 2
