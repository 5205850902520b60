from dataclasses import replace

import numpy as np
import pytest
import xarray

import laticauda as lc
from laticauda.paper import BEHAVIORS, Loops, StabilitySettings, run_stability
from laticauda.paper.datasets import to_dataset
from laticauda.paper.settings import swimmers
from laticauda.paper.stability import behavior
from laticauda.trial.following import mean_error

SMALL = StabilitySettings(
    look_ahead_distances=(0.18, 1.62), gains=(0.2, 0.4), raw_gains=(0.4,), swimmers=swimmers()[:1]
)


@pytest.fixture(scope="module")
def study():
    return run_stability(SMALL)


def test_a_loop_has_settled_swings_or_is_still_coming():
    # To be still coming, the mean square must have halved.
    rms = np.array([0.049, 0.051, 0.051, 0.1, 0.1])
    before = np.array([0.049, 0.051, 0.04, 0.1 * 2**0.5 * 1.001, 0.1 * 2**0.5 * 0.999])
    found = behavior(rms, before, 0.05)
    assert found.tolist() == ["settled", "limit cycle", "limit cycle", "still coming", "limit cycle"]


def test_the_papers_gains_swing_with_the_mean_heading_and_settle_with_the_raw_one(study):
    mean, raw = study.maps
    assert (mean.heading, raw.heading) == ("cycle_mean", "raw")
    assert mean.behaviors[0][1] == "limit cycle"
    assert raw.behaviors[0][0] == "settled"
    assert mean.behaviors[1].tolist() == ["settled", "settled"]


def test_a_point_is_what_a_run_of_its_own_gives(study):
    swimmer = swimmers()[0]
    controller = lc.PathFollowing(
        gait=swimmer.gait,
        path=lc.StraightLine(),
        guidance=lc.LineOfSight(look_ahead_distance=1.62),
        heading=lc.HeadingController(gain=0.2, max_offset=SMALL.max_offset),
        heading_estimate="cycle_mean",
        interval=0.2,
    )
    plant = lc.plant(lc.load_robot("mamba"), lc.load_water("paper-lateral"))
    trial = lc.run(plant, controller, 120.0, start=lc.Start(center_of_mass=(0.0, 0.5)), sample_interval=0.2)
    time, error = mean_error(trial.time, trial.signals["cross_track_error"], 4.0)
    rms = [np.sqrt(np.mean(error[(time >= begin) & (time < end)] ** 2)) for begin, end in ((80, 121), (40, 80))]
    loops = study.maps[0]
    assert (loops.rms[1, 0], loops.rms_before[1, 0]) == pytest.approx(rms, rel=1e-6)
    assert loops.forward_velocity[1, 0] == trial.forward_velocity


def test_a_start_on_the_other_side_of_the_path_gives_the_same_map():
    # A long look-ahead distance; the gait itself starts to one side, which a mirrored start does not mirror.
    one = replace(SMALL, look_ahead_distances=(1.62,), raw_gains=())
    left, right = (run_stability(replace(one, initial_cross_track_error=side)).maps[0] for side in (0.5, -0.5))
    assert np.array_equal(left.behaviors, right.behaviors)
    assert left.rms_before == pytest.approx(right.rms_before, abs=0.01)


def test_the_shortest_distance_is_beyond_all_that_swing():
    def shortest(*column: str):
        rms = {"settled": 0.01, "limit cycle": 0.1, "still coming": 0.1}
        before = {"settled": 0.01, "limit cycle": 0.1, "still coming": 0.2}
        loops = Loops(
            swimmer=SMALL.swimmers[0],
            heading="cycle_mean",
            look_ahead_distances=np.array([0.1, 0.2, 0.3, 0.4])[: len(column)],
            gains=np.array([0.4]),
            rms=np.array([[rms[one]] for one in column]),
            rms_before=np.array([[before[one]] for one in column]),
            forward_velocity=np.ones((len(column), 1)),
            tolerance=0.05,
        )
        assert [row[0] for row in loops.behaviors] == list(column)
        (found,) = loops.shortest
        return found

    settled, swings, coming = BEHAVIORS
    assert shortest(settled, settled, settled, settled) == 0.1
    assert shortest(settled, swings, settled, settled) == 0.3
    assert shortest(swings, coming, settled, coming) == 0.3
    assert shortest(settled, settled, settled, swings) is None
    assert shortest(swings, coming, coming, coming) is None


def test_progress_counts_every_run():
    told = []
    one = replace(SMALL, look_ahead_distances=(1.62,), duration=18.0)
    run_stability(one, progress=lambda done, total: told.append((done, total)))
    assert told == [(i + 1, 3) for i in range(3)]
    assert one.n_runs == 3
    assert StabilitySettings().n_runs == 4 * 8 * 7


def test_the_default_map_holds_the_papers_point_and_twice_every_robot():
    settings = StabilitySettings()
    assert settings.paper[0] in settings.look_ahead_distances
    assert settings.paper[1] in settings.gains
    assert all(max(settings.look_ahead_distances) >= 2.0 * one.length - 1e-9 for one in settings.swimmers)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"look_ahead_distances": (0.2, 0.1)}, "`look_ahead_distances` must rise, got 0.2, 0.1"),
        ({"look_ahead_distances": ()}, "`look_ahead_distances` must hold at least one entry, got none"),
        ({"gains": (0.0, 0.1)}, r"`gains\[0\]` must be > 0, got 0"),
        ({"duration": 17.0}, "`duration` must be between 18 and 100000 s, got 17"),
        ({"tolerance": -1.0}, "`tolerance` must be > 0 m, got -1"),
        ({"swimmers": ()}, "`swimmers` must hold at least one entry, got none"),
    ],
)
def test_settings_out_of_their_range_are_refused(changed, message):
    with pytest.raises(ValueError, match=message):
        replace(SMALL, **changed)


def test_the_file_holds_the_maps(study, tmp_path):
    to_dataset(study).to_netcdf(tmp_path / "stability.nc")
    with xarray.open_dataset(tmp_path / "stability.nc") as stored:
        stored.load()
    assert stored.equals(to_dataset(study))
    name = "lateral undulation, without fin"
    assert np.array_equal(stored.rms_cycle_mean.sel(swimmer=name), study.maps[0].rms)
    assert float(stored.rms_raw.sel(swimmer=name, look_ahead_distance=1.62, gain_raw=0.4)) == study.maps[1].rms[1, 0]
    words = stored.attrs["behaviors"].split(", ")
    codes = stored.behavior_cycle_mean.sel(swimmer=name).values
    assert [[words[code] for code in row] for row in codes] == study.maps[0].behaviors.tolist()
    assert stored.attrs["joints"] == "prescribed"
    assert set(stored.variables) - {"swimmer"} == {
        name for name, one in stored.variables.items() if "units" in one.attrs
    }
