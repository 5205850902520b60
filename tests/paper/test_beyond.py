from dataclasses import replace
from math import degrees, radians, tan

import numpy as np
import pytest
import xarray

import laticauda as lc
from laticauda.paper import (
    BeyondSettings,
    CurvedSettings,
    DriftSettings,
    TurningSettings,
    run_beyond,
)
from laticauda.paper.beyond import curved_run, drift_laws, drift_run, turning_curve
from laticauda.paper.datasets import to_dataset
from laticauda.paper.runs import Runs
from laticauda.paper.settings import swimmers
from laticauda.scenarios import Planar

RUNS = Runs(model=Planar(), progress=None)
SMALL = BeyondSettings(
    drift=DriftSettings(duration=30.0, control_interval=0.1),
    curved=CurvedSettings(swimmers=swimmers()[1::2], waypoints=((0.0, 0.0), (1.0, 0.3), (2.0, 0.0))),
    turning=TurningSettings(offsets=(radians(4), radians(8)), swimmers=swimmers()[:2], duration=30.0),
)


@pytest.fixture(scope="module")
def study():
    return run_beyond(SMALL)


# ---- cross current -------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def drifts():
    settings = DriftSettings()
    return {law.name: drift_run(settings, law, RUNS) for law in settings.laws}


def test_the_integral_takes_the_drift_off_and_line_of_sight_alone_does_not(drifts):
    holds = DriftSettings().holds
    assert holds(drifts["integral line of sight"])
    assert abs(drifts["integral line of sight"].mean_error) < 0.05
    assert not holds(drifts["line of sight"])
    assert drifts["line of sight"].mean_error == pytest.approx(0.74, abs=0.02)


@pytest.mark.parametrize("name", ["line of sight", "line of sight, the paper's gains"])
def test_line_of_sight_keeps_what_geometry_says(drifts, name):
    # It heads for the point Delta ahead on the path, and travels along the path.
    run = drifts[name]
    kept = run.law.guidance.look_ahead_distance * tan(run.trial.sideslip)
    assert run.mean_error == pytest.approx(kept, rel=0.05)


def test_a_swing_about_the_path_shows_in_the_root_mean_square(drifts):
    for run in drifts.values():
        assert run.rms(2.0) >= abs(run.mean_error)
        assert abs(run.largest) >= run.rms(2.0)
    assert drifts["integral line of sight"].largest > 0.3


def test_a_mirrored_current_gives_the_mirrored_error():
    law = drift_laws()[2]  # settles in seconds
    settings = DriftSettings(duration=60.0)
    mirrored = replace(settings, current=(0.0, -0.05))
    one, other = (drift_run(each, law, RUNS).mean_error for each in (settings, mirrored))
    assert one == pytest.approx(-other, abs=2e-3)
    assert abs(drift_run(replace(settings, current=(0.0, 0.0)), law, RUNS).mean_error) < 2e-3


# ---- curved path ---------------------------------------------------------------------------------------------------


def test_a_run_ends_where_the_curve_does(study):
    for run in study.curved:
        assert run.is_cut_short
        x, _ = run.trial.center_of_mass[-1]
        assert run.trial.signals["along_track_distance"][-1] == pytest.approx(SMALL.curved.path.length, abs=0.05)
        assert x == pytest.approx(2.0, abs=0.1)
    short = curved_run(replace(SMALL.curved, most_duration=9.0), swimmers()[0], RUNS)
    assert not short.is_cut_short
    assert short.trial.duration == pytest.approx(9.0)


def test_a_straight_curve_is_followed_without_error_and_a_bend_on_its_outer_side():
    swimmer = swimmers()[1]
    straight = replace(SMALL.curved, waypoints=((0.0, 0.0), (1.5, 0.0), (3.0, 0.0)))
    assert straight.tightest_radius == np.inf
    assert curved_run(straight, swimmer, RUNS).rms() < 0.02
    left = replace(SMALL.curved, waypoints=((0.0, 0.0), (1.5, -0.6), (3.0, 0.0)))
    right = replace(SMALL.curved, waypoints=((0.0, 0.0), (1.5, 0.6), (3.0, 0.0)))
    one, other = curved_run(left, swimmer, RUNS), curved_run(right, swimmer, RUNS)
    at = [run.error.value[np.argmax(np.abs(run.error.value))] for run in (one, other)]
    assert at[0] < -0.02
    assert at[1] > 0.02
    assert one.rms() == pytest.approx(other.rms(), rel=0.15)
    assert one.largest == at[0]
    # The signals are held between control instants.
    assert np.all(np.diff(one.along.value) > -1e-3)


def test_the_tightest_radius_is_that_of_the_curve():
    # A parabola bends most at its vertex, with the radius 1/2c.
    parabola = tuple((x, 0.4 * x * x) for x in np.linspace(-2.0, 2.0, 41).tolist())
    assert replace(SMALL.curved, waypoints=parabola).tightest_radius == pytest.approx(1.25, rel=0.01)


# ---- turning -------------------------------------------------------------------------------------------------------


def test_a_turn_is_what_swim_gives_with_that_offset(study):
    swimmer = swimmers()[1]
    trial = lc.swim(lc.load_robot("mamba-fin"), replace(swimmer.gait, offset=radians(8)), 30.0)
    curve = study.turning[1]
    assert curve.turning_rate[1] == trial.turning_rate
    assert curve.path_speed[1] == trial.path_speed
    assert curve.mechanical_power[1] == trial.mechanical_power
    assert curve.radius[1] == pytest.approx(trial.path_speed / trial.turning_rate)


def test_positive_offsets_turn_left_and_larger_ones_more_tightly(study):
    for curve in study.turning:
        assert np.all(curve.turning_rate > 0.0)
        assert np.all(np.diff(curve.turning_rate) > 0.0)
        assert np.all(np.diff(curve.radius) < 0.0)
        # Small offsets turn in proportion.
        assert curve.turning_rate[1] == pytest.approx(2.0 * curve.turning_rate[0], rel=0.1)


def test_the_radius_is_that_of_the_circle_that_is_swum():
    settings = TurningSettings(offsets=(radians(12),), duration=120.0)
    swimmer = swimmers()[0]
    curve = turning_curve(settings, swimmer, RUNS)
    trial = lc.swim(lc.load_robot("mamba"), replace(swimmer.gait, offset=radians(12)), 120.0)
    points = trial.center_of_mass[trial.time > 40.0]
    # Least squares of x2 + y2 = 2 a x + 2 b y + c.
    left = np.column_stack((2.0 * points, np.ones(len(points))))
    a, b, c = np.linalg.lstsq(left, np.sum(points**2, axis=1), rcond=None)[0]
    assert curve.radius[0] == pytest.approx(np.sqrt(c + a * a + b * b), rel=0.1)


# ---- all of it -----------------------------------------------------------------------------------------------------


def test_progress_counts_every_run():
    told = []
    run_beyond(SMALL, progress=lambda done, total: told.append((done, total)))
    assert told == [(i + 1, SMALL.n_runs) for i in range(3 + 2 + 4)]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: DriftSettings(duration=10.0), "`duration` must be between 20 and 100000 s, got 10"),
        (lambda: DriftSettings(current=(0.0, np.inf)), r"`current\[1\]` must be .*finite"),
        (lambda: CurvedSettings(waypoints=((0.0, 0.0),)), "`waypoints` must hold at least 2 points, got 1"),
        (lambda: CurvedSettings(most_duration=1.0), "`most_duration` must be between 8 and 100000 s, got 1"),
        (lambda: TurningSettings(offsets=(0.2, 0.1)), r"`offsets` must hold at least one value \[rad\] and rise"),
        (lambda: TurningSettings(offsets=()), r"`offsets` must hold at least one value \[rad\] and rise"),
        (lambda: TurningSettings(duration=17.0), "`duration` must be between 18 and 100000 s, got 17"),
    ],
)
def test_settings_out_of_their_range_are_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_the_file_holds_what_was_found(study, tmp_path):
    to_dataset(study).to_netcdf(tmp_path / "beyond.nc")
    with xarray.open_dataset(tmp_path / "beyond.nc") as stored:
        stored.load()
    assert stored.equals(to_dataset(study))
    assert np.array_equal(stored.turning_radius, [curve.radius for curve in study.turning])
    law = stored.drift_error.sel(drift_law="integral line of sight")
    assert np.array_equal(law, study.drift[1].error.value)
    for i, run in enumerate(study.curved):
        kept = stored.curved_error[i].dropna("curved_time")
        assert np.array_equal(kept, run.error.value)
        assert kept.curved_time.values == pytest.approx(run.error.time)
        assert np.array_equal(stored.curved_along[i].dropna("curved_time"), run.along.value)
    assert stored.attrs["drift_current"].tolist() == [0.0, 0.05]
    names = {"drift_law", "curved_swimmer", "turning_swimmer"}
    assert {name for name, one in stored.variables.items() if "units" not in one.attrs} == names
    assert degrees(float(stored.offset[1])) == pytest.approx(8.0)
