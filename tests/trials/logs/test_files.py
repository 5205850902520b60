import csv
import dataclasses
import os
import tomllib
import warnings
from datetime import datetime

import netCDF4
import numpy as np
import pytest
import xarray
from hypothesis import given, settings, strategies as st

from laticauda.motion.gaits import EelLike, Gait
from laticauda.robot import Robot, load_ground, load_robot, robot_names
from laticauda.trials import Trial
from laticauda.trials.logs import load_trial
from laticauda.values.errors import StorageFailed, TrialFileError

FLOATS = st.floats(allow_nan=False, allow_infinity=False)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "run.nc"


def test_a_loaded_trial_equals_the_saved_one(make_trial, full_trial, path):
    for trial in (make_trial(), full_trial, make_trial(n_axes=3), make_trial(gait=None)):
        trial.save(path)
        assert load_trial(path).equals(trial)


@pytest.mark.parametrize("name", robot_names())
def test_every_preset_comes_back_with_its_trial(make_trial, path, name):
    trial = make_trial(duration=1.0, robot=load_robot(name), environment=load_ground("coulomb"))
    trial.save(str(path))
    assert load_trial(str(path)).equals(trial)


@settings(max_examples=50)
@given(
    values=st.lists(FLOATS, min_size=26 * 9, max_size=26 * 9),
    amplitude=st.floats(0.0, 3.0),
    setting=st.floats(allow_nan=False),
    status=st.text(st.characters(exclude_categories=["Cs", "Cc"]), max_size=40),
)
def test_every_float_and_text_comes_back_to_the_last_bit(
    make_trial, tmp_path_factory, values, amplitude, setting, status
):
    gait = Gait(
        envelope=EelLike(), amplitude=amplitude, frequency=1.0, phase_shift=-amplitude / 3.0
    )
    angle = np.array(values).reshape(26, 9)
    trial = make_trial(
        duration=0.5, link_angle=angle, gait=gait, notes={"x": setting}, status=status
    )
    path = tmp_path_factory.getbasetemp() / "any.nc"
    trial.save(path)
    assert load_trial(path).equals(trial)


def test_a_robot_of_one_link_or_of_a_thousand_comes_back(make_trial, path):
    mamba = load_robot("mamba")
    for n_links in (1, 1000):
        modules = tuple(
            dataclasses.replace(mamba.modules[0], mass=0.8 + 1e-3 * i) for i in range(n_links)
        )
        robot = Robot(name="long", modules=modules, joints=mamba.joints[:1] * (n_links - 1))
        trial = make_trial(duration=0.1, robot=robot)
        trial.save(path)
        assert load_trial(path).equals(trial)


def test_the_file_opens_in_xarray_with_dimensions_and_units(full_trial, path):
    full_trial.save(path)
    with xarray.open_dataset(path) as data:
        assert dict(data.sizes) == {"time": 51, "link": 4, "joint": 3, "axes": 2}
        assert data.link_angle.dims == ("time", "link")
        assert data.link_force_drag.dims == ("time", "link", "axes")
        assert list(data.axis.values) == ["x", "y"]
        assert all(
            np.issubdtype(data[name].dtype, np.number)
            for name in data.dims
            if name in data and name != "time"
        )
        chosen = data.swap_dims(axes="axis").center_of_mass.sel(axis="y")
        np.testing.assert_array_equal(chosen, full_trial.center_of_mass[:, 1])
        assert data.attrs["Conventions"].startswith("CF-")
        scenario = tomllib.loads(data.attrs["scenario"])
        assert (scenario["robot"]["name"], scenario["gait"]["envelope"]["kind"]) == (
            "odd one",
            "custom",
        )
        assert data.joint_torque.attrs["units"] == "N m"
        for name, variable in data.data_vars.items():
            assert variable.attrs["units"], name
            assert variable.attrs["long_name"], name


def test_the_dataset_in_memory_is_the_one_in_the_file_but_for_dates_and_the_dimension_of_texts(
    make_trial, full_trial, path
):
    for trial in (make_trial(), full_trial):
        trial.save(path)
        with xarray.open_dataset(path, decode_times=False) as data:
            since = data.time.attrs["units"]
            data.time.attrs = dict(trial.to_dataset().time.attrs)
            xarray.testing.assert_identical(trial.to_dataset(), data.swap_dims(axes="axis").load())
        assert (
            datetime.fromisoformat(f"{since.removeprefix('seconds since ')}+00:00").isoformat()
            == trial.created
        )
    assert full_trial.to_dataset().link_angle.sel(time=0.5, link=3) == full_trial.link_angle[25, 3]


def test_xarray_reads_the_clock_on_the_wall(make_trial, path):
    trial = dataclasses.replace(make_trial(), created="2026-11-27T12:00:00.250000+01:00")
    trial.save(path)
    with xarray.open_dataset(path) as data:
        assert data.time.values[[0, 1]].astype(str).tolist() == [
            "2026-11-27T11:00:00.250000000",
            "2026-11-27T11:00:00.270000000",
        ]
        assert data.time.attrs["standard_name"] == "time"


@pytest.mark.parametrize(
    ("created", "zero"), [("some day", "1970-01-01 00:00:00"), ("2026-11-27", "2026-11-27 00")]
)
def test_a_trial_that_does_not_say_when_it_was_made_begins_in_1970_and_one_without_a_zone_in_utc(
    make_trial, path, created, zero
):
    dataclasses.replace(make_trial(), created=created).save(path)
    with netCDF4.Dataset(path) as file:
        assert file["time"].units.startswith(f"seconds since {zero}")


def test_what_else_the_conventions_ask_for_is_in_the_file(full_trial, path):
    full_trial.save(path)
    with netCDF4.Dataset(path) as file:
        assert file.history == f"{full_trial.created} made by laticauda {full_trial.version}"
        assert all(variable.long_name for variable in file.variables.values())


def test_a_figure_can_be_drawn_from_a_loaded_trial_alone(make_trial, path):
    trial = make_trial()
    trial.save(path)
    assert load_trial(path).summary() == trial.summary()


def test_an_older_file_is_replaced_and_nothing_else_is_left(make_trial, full_trial, path):
    make_trial().save(path)
    full_trial.save(path)
    assert load_trial(path).equals(full_trial)
    assert os.listdir(path.parent) == ["run.nc"]


@pytest.mark.parametrize(
    ("where", "failure", "message"),
    [
        (
            "os.fsync",
            OSError(28, "No space left on device"),
            r"run\.nc: cannot be written: No space left on device;",
        ),
        (
            "xarray.Dataset.to_netcdf",
            RuntimeError("NetCDF: HDF error"),
            r"HDF error; is the disk full\?",
        ),
    ],
)
def test_a_failed_write_leaves_the_old_file_and_no_litter(
    full_trial, path, monkeypatch, where, failure, message
):
    def fail(*_arguments: object, **_options: object) -> None:
        raise failure

    full_trial.save(path)
    with monkeypatch.context() as patch, pytest.raises(StorageFailed, match=message):
        patch.setattr(where, fail)
        full_trial.save(path)
    assert load_trial(path).equals(full_trial)
    assert os.listdir(path.parent) == ["run.nc"]


def test_why_a_file_cannot_be_written_is_said_by_the_system(full_trial, path, monkeypatch):
    def refuse(*_arguments: object, **_options: object) -> None:
        raise PermissionError(13, "Permission denied")  # as netCDF says of a full disk

    def fill(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("xarray.Dataset.to_netcdf", refuse)
    monkeypatch.setattr("pathlib.Path.write_bytes", fill)
    with pytest.raises(StorageFailed, match=r"run\.nc: cannot be written: No space left on device"):
        full_trial.save(path)


def test_where_nothing_can_be_written_the_reason_is_given(make_trial, tmp_path):
    trial = make_trial(duration=1.0)
    with pytest.raises(
        StorageFailed, match=r"missing.run\.nc: cannot be written: No such file or directory"
    ):
        trial.save(tmp_path / "missing" / "run.nc")
    with pytest.raises(StorageFailed, match=r": cannot be written: Is a directory"):
        trial.save(tmp_path)
    with pytest.raises(
        StorageFailed, match=r"missing.run\.csv: cannot be written: No such file or directory"
    ):
        trial.save(tmp_path / "missing" / "run.csv")
    assert os.listdir(tmp_path) == []


def test_where_nothing_can_be_read_the_reason_is_given(tmp_path):
    with pytest.raises(
        TrialFileError, match=r"Cannot read .*none\.nc: no such file or directory\."
    ):
        load_trial(tmp_path / "none.nc")
    with pytest.raises(TrialFileError, match=r"Cannot load .*: it is a folder without metadata"):
        load_trial(tmp_path)


@pytest.mark.parametrize(
    "content", [b"", b"x", b"time,heading\n0,1\n" * 100, b"\x89HDF\r\n\x1a\n" + bytes(600)]
)
def test_a_file_that_is_no_netcdf_is_refused(path, content):
    path.write_bytes(content)
    with pytest.raises(
        TrialFileError, match=r"Cannot load .*run\.nc: it is not a netCDF file, or it is damaged\."
    ):
        load_trial(path)


def test_a_netcdf_file_of_something_else_is_refused(path):
    xarray.Dataset({"temperature": ("time", [1.0, 2.0])}).to_netcdf(path)
    with pytest.raises(TrialFileError, match="it is a netCDF file, but not a trial of laticauda"):
        load_trial(path)


def test_a_file_of_a_newer_laticauda_is_refused(make_trial, path):
    make_trial().save(path)
    with netCDF4.Dataset(path, "a") as file:
        file.setncattr("laticauda_trial", 99)
    with pytest.raises(
        TrialFileError, match="it has format 99, but this version of laticauda reads format 2"
    ):
        load_trial(path)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        (
            "scenario",
            'kind = "scenario"\nname = 3',
            r"Cannot load .*run\.nc: scenario: key `name`: is not known",
        ),
        ("scenario", "=", r"Cannot load .*run\.nc: "),
        (
            "scenario",
            'kind = "walk"',
            r'scenario: key `kind`: must be one of "scenario", "experiment"',
        ),
        ("scenario", 'kind = "experiment"\nnotes = 3', r"scenario: key `robot`: is missing"),
        ("link_force", '["lift"]', "it has no `link_force_lift`"),
        ("state", '{"gone": {"dtype": "<f8"}}', "it has no `bytes`"),
        ("state", '{"gone": 3}', r"Cannot load .*run\.nc: "),
        ("has_electrical_work", 1, "it has no `electrical_work`"),
    ],
)
def test_a_file_with_a_wrong_attribute_is_refused_with_the_reason(
    make_trial, path, name, value, message
):
    make_trial(duration=1.0).save(path)
    with netCDF4.Dataset(path, "a") as file:
        file.setncattr(name, value)
    with pytest.raises(TrialFileError, match=message):
        load_trial(path)


@pytest.mark.parametrize("name", ["scenario", "status", "version", "state"])
def test_a_file_without_an_attribute_is_refused_by_its_name(make_trial, path, name):
    make_trial(duration=1.0).save(path)
    with netCDF4.Dataset(path, "a") as file:
        file.delncattr(name)
    with pytest.raises(TrialFileError, match=f"Cannot load .*: it has no `{name}`"):
        load_trial(path)


def test_a_file_that_another_program_edited_in_place_is_taken_as_it_is(make_trial, path):
    trial = make_trial(duration=1.0)
    trial.save(path)
    with netCDF4.Dataset(path, "a") as file:
        file.setncattr("comment", "the good one")
        file.createVariable("depth", "f8", ("time",))[:] = 0.5
    assert load_trial(path).equals(trial)
    trial.save(path)
    with netCDF4.Dataset(path, "a") as file:
        file["joint_torque"][7, 3] = 0.25
    assert load_trial(path).joint_torque[7, 3] == 0.25


def test_one_wrong_bit_anywhere_is_found(full_trial, path):
    full_trial.save(path)
    content = path.read_bytes()
    rng = np.random.default_rng(3)
    for place in (0, len(content) - 1, *rng.integers(0, len(content) - 82, 200)):
        damaged = bytearray(content)
        damaged[place] ^= 1 << int(rng.integers(8))
        path.write_bytes(damaged)
        with pytest.raises(
            TrialFileError, match=r"Cannot load .*run\.nc: it is damaged: its checksum is wrong\."
        ):
            load_trial(path)


def test_a_file_that_was_cut_off_is_refused(full_trial, path):
    full_trial.save(path)
    content = path.read_bytes()
    for size in (1, 100, 4096, len(content) // 2, len(content) - 200):
        path.write_bytes(content[:size])
        with pytest.raises(
            TrialFileError,
            match=r"Cannot load .*run\.nc: it is not a netCDF file, or it is damaged\.",
        ):
            load_trial(path)


def test_a_file_whose_arrays_do_not_belong_together_is_refused(make_trial, path):
    make_trial(duration=1.0).save(path)
    with netCDF4.Dataset(path, "a") as file:
        file["time"][3] = 0.0
    with pytest.raises(TrialFileError, match="`time` must increase strictly"):
        load_trial(path)
    make_trial(duration=1.0).save(path)
    with netCDF4.Dataset(path, "a") as file:
        file.renameVariable("joint_torque", "torque")
    with pytest.raises(TrialFileError, match="it has no `joint_torque`"):
        load_trial(path)


def test_a_csv_has_a_header_with_units_and_every_number(full_trial, tmp_path):
    full_trial.save(tmp_path / "run.csv")
    with (tmp_path / "run.csv").open(newline="") as file:
        rows = list(csv.reader(file))
    header, numbers = rows[0], np.array(rows[1:], dtype=float)
    assert len(set(header)) == len(header)
    assert numbers.shape == (full_trial.time.size, len(header))
    assert header[:3] == ["time [s]", "center_of_mass_x [m]", "center_of_mass_y [m]"]
    np.testing.assert_array_equal(
        numbers[:, header.index("joint_torque_2 [N m]")], full_trial.joint_torque[:, 2]
    )
    force = full_trial.link_force["drag"]
    np.testing.assert_array_equal(
        numbers[:, header.index("link_force_drag_3_y [N]")], force[:, 3, 1]
    )


def test_saving_and_loading_warn_of_nothing(full_trial, path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        full_trial.save(path)
        trial = load_trial(path)
    assert isinstance(trial, Trial)
