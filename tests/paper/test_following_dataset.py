from dataclasses import replace

import numpy as np
import xarray

from laticauda.paper import path_following_settings, run_path_following
from laticauda.paper.datasets import to_dataset
from laticauda.trial import following as figures


def test_the_file_holds_what_the_study_found(following, tmp_path):
    to_dataset(following).to_netcdf(tmp_path / "path_following.nc")
    with xarray.open_dataset(tmp_path / "path_following.nc") as stored:
        stored.load()
    assert stored.equals(to_dataset(following))
    assert stored.sizes["case"] == 13  # the held-out trial is the last
    assert stored.attrs["chosen_way"] == "prescribed joints, 10 rad/s, delay 0 s, raw heading"
    assert stored.attrs["joints"] == "prescribed"


def test_figures_are_found_by_case_and_way(following):
    dataset = to_dataset(following)
    for case in following.cases:
        row = dataset.sel(case=f"{case.group.name}, case {case.measured.case}")
        for run in (*case.band, case.cycle_mean):
            assert float(row.forward_velocity.sel(way=run.name)) == run.forward_velocity
            for name in figures.FIGURES:
                stored = float(row[name].sel(way=run.name))
                assert stored == run.figures[name] or (np.isnan(stored) and run.figures[name] is None)
        assert float(row.measured_forward_velocity) == case.measured.forward_velocity


def test_series_are_those_of_the_chosen_runs_and_nan_behind_their_ends():
    settings = path_following_settings()
    groups = (replace(settings.groups[1], figures=(15, 16)),)
    short = replace(settings, duration=15.0, distance=0.5, joint_laws=("prescribed",), groups=groups)
    study = run_path_following(short)
    dataset = to_dataset(study)
    trials = [*(case.trial for case in study.cases), study.held_out.trial]
    assert len({trial.time.size for trial in trials}) > 1
    for i, trial in enumerate(trials):
        n = trial.time.size
        assert np.array_equal(dataset.run_time[i, :n], trial.time)
        assert np.array_equal(dataset.run_y[i, :n], trial.center_of_mass[:, 1])
        assert np.array_equal(dataset.run_offset[i, :n], trial.signals["offset"])
        assert np.all(np.isnan(dataset.run_time[i, n:]))


def test_every_number_has_a_unit_or_is_a_count(following):
    dataset = to_dataset(following)
    bare = [name for name in dataset.variables if "units" not in dataset[name].attrs]
    assert set(bare) == {"case", "way", "paper_figure"}
