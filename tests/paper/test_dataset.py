import numpy as np
import xarray

from laticauda.paper import to_dataset


def test_the_file_holds_what_the_study_found(study, tmp_path):
    to_dataset(study).to_netcdf(tmp_path / "efficiency.nc")
    with xarray.open_dataset(tmp_path / "efficiency.nc") as stored:
        stored.load()
    assert stored.equals(to_dataset(study))
    for sweep in study.sweeps:
        name = sweep.settings.parameter
        assert np.array_equal(stored[name], sweep.values)
        assert np.array_equal(stored[f"forward_velocity_over_{name}"], sweep.forward_velocity)
        assert np.array_equal(stored[f"mechanical_power_over_{name}"], sweep.mechanical_power)
    assert stored.sizes["case"] == 22
    assert int(stored.measured_velocity.isnull().sum()) == 2
    assert stored.attrs["joints"] == "prescribed"


def test_every_number_has_a_unit_or_is_a_count(study):
    dataset = to_dataset(study)
    bare = [name for name in dataset.variables if "units" not in dataset[name].attrs]
    assert set(bare) == {"model", "group", "case_group", "case_number", "case_starred"}


def test_curves_are_found_by_name(study):
    curve = to_dataset(study).forward_velocity_over_amplitude.sel(
        model="analytical-set", group="eel-like motion, with fin"
    )
    assert np.array_equal(curve, study.sweeps[0].forward_velocity[0, 3])
