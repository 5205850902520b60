"""A slice of campaigns/operate_table2.py: a series in the tank, and what report and identification make of it."""

import math
from dataclasses import replace
from pathlib import Path

import campaign_scripts
import pytest

import laticauda as lc
from laticauda.identify import fit, from_trial
from laticauda.paper import TABLE2, load_repeats
from laticauda.tank.operate.series import Series, run_series
from laticauda.tank.operate.settings import Calibration, load_operation

ROOT = Path(__file__).parents[3]
QUICK = Calibration(joint_zeros=True, idle_time=0.5, still_time=0.5)
DURATION = 6.0


@pytest.fixture(scope="module")
def campaign():
    return campaign_scripts.campaign("operate_table2")


@pytest.fixture(scope="module")
def done(campaign, tmp_path_factory) -> Series:
    """Two runs of the first setting, without steering."""
    series = load_operation(TABLE2)
    operation = replace(
        series.trials[0],
        following=None,
        duration=DURATION,
        rate=50.0,
        countdown=0.1,
        calibration=QUICK,
    )
    folder = tmp_path_factory.mktemp("series")
    return run_series(
        replace(series, trials=(operation,), repeats=2), folder, campaign.operate_in_tank
    )


def test_the_table_of_the_page_is_that_of_the_stored_answer(campaign):
    page = (ROOT / "docs/how-to/operate.md").read_text(encoding="utf-8")
    rows = campaign.stored()
    assert campaign.BEGIN in page
    if not rows:
        pytest.skip("nothing is stored: python campaigns/operate_table2.py --run")
    assert campaign.table(rows) in page
    assert campaign.summary(rows) in page


def test_two_runs_swim_alike_but_not_the_same(done: Series):
    assert done.is_complete
    (setting,) = done.settings
    first, second = (result.trial for result in setting.accepted)
    assert first is not None
    assert second is not None
    assert first.forward_velocity == pytest.approx(second.forward_velocity, rel=0.1)
    assert first.forward_velocity != second.forward_velocity
    for name in ("forward_velocity", "electrical_power", "total_power"):
        mean, deviation = setting.figure(name) or (0.0, None)
        assert mean > 0.0
        assert deviation is not None


def test_the_report_takes_the_repeats_of_a_series(done: Series):
    (repeat,) = load_repeats(done.folder / "repeats.csv")
    assert not repeat.has_fin
    assert len(repeat.forward_velocity) == 2
    velocity, _ = done.settings[0].figure("forward_velocity") or (0.0, None)
    assert repeat.velocity[0] == pytest.approx(velocity)


def test_identification_takes_the_trials_of_a_series_that_does_not_steer(done: Series):
    trials = [lc.load_trial(path) for path in sorted(done.folder.glob("*.nc"))]
    measurements = [
        from_trial(trial, name=f"run {i}", series={"center_of_mass": 0.003}, every=10)
        for i, trial in enumerate(trials)
    ]
    operation = done.file.trials[0]
    result = fit(
        measurements,
        parameters={"water.tangential_friction": (0.05, 1.0)},
        joints=operation.joint_law(),
        ramp=operation.ramp,
        offset_bandwidth=operation.offset_bandwidth,
        n_starts=1,
        noise="estimated",
    )
    truth = operation.pool().tangential_friction
    assert math.isclose(result.values["water.tangential_friction"], truth, rel_tol=0.25)
