import math
import shutil
import warnings
from types import SimpleNamespace

import numpy as np
import pytest

import laticauda as lc
from laticauda.cockpit import Cockpit, Live
from laticauda.cockpit.board import gait_map_picture
from laticauda.cockpit.files import opened, received_sweep
from laticauda.cockpit.maps import with_numbers
from laticauda.cockpit.pages import Event
from laticauda.cockpit.simulation import changed
from laticauda.errors import TrialFileError
from laticauda.studies import Grid, Rows, Sweep, open_sweep, run_sweep

pytest.importorskip("viser")
GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
SCENARIO = lc.scenario("mamba-fin", GAIT)
AMPLITUDES, DRAGS, FREQUENCIES = (0.3, 0.5, 0.6), (1.0, 1.75), (1.5, 2.0, 2.25, 2.5)
VALUES = {"gait.amplitude": AMPLITUDES, "water.normal_drag": DRAGS, "gait.frequency": FREQUENCIES}
SHARED = {"scenario": lc.scenario("mamba-fin", GAIT, 3.0)}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A grid of three numbers, in the folder of `laticauda sweep`, packed, and as netCDF."""
    path = tmp_path_factory.mktemp("sweep") / "grid"
    run_sweep(Sweep(points=Grid(values=VALUES), **SHARED), path)
    shutil.make_archive(str(path), "zip", path.parent, "grid")
    open_sweep(path).to_netcdf(path.with_suffix(".nc"), engine="netcdf4")
    return path


@pytest.mark.parametrize("ending", ["", ".zip", ".nc"])
def test_every_point_of_the_map_is_that_trial_of_the_sweep(folder, ending):
    sweep = opened(folder.with_suffix(ending))
    whole = open_sweep(folder)
    assert sweep.is_grid
    assert sweep.spanning == tuple(VALUES)
    chart = sweep.chart("forward_velocity", "gait.frequency", "gait.amplitude", {"water.normal_drag": 1})
    assert sweep.label(chart.x) == "frequency [deg/s]"
    expected = whole.forward_velocity.sel({"water.normal_drag": DRAGS[1]}).to_numpy()
    np.testing.assert_array_equal(np.asarray(chart.cut), expected)
    turned = sweep.chart("forward_velocity", "gait.amplitude", "gait.frequency", {"water.normal_drag": 1})
    np.testing.assert_array_equal(np.asarray(turned.cut), expected.T)
    found = chart.nearest(math.degrees(2.2), math.degrees(0.52))
    assert found == {"gait.frequency": 2.25, "gait.amplitude": 0.5, "water.normal_drag": 1.75}


def test_what_is_clicked_swims_as_the_sweep_says(folder):
    sweep = opened(folder)
    chart = sweep.chart("forward_velocity", "gait.frequency", "gait.amplitude", {"water.normal_drag": 0})
    after = with_numbers(changed(SCENARIO, current=(0.0, 0.0)), chart.nearest(0.0, 0.0))
    trial = lc.swim(after.robot, after.gait, SHARED["scenario"].duration, environment=after.environment)
    assert after.environment.normal_drag == DRAGS[0]
    assert float(chart.cut[0, 0]) == pytest.approx(trial.forward_velocity, rel=1e-6)
    assert chart.place_of(after) == pytest.approx((math.degrees(1.5), math.degrees(0.3)))


def test_a_list_of_points_is_a_map_of_dots(tmp_path):
    points = {"gait.amplitude": (0.3, 0.6, 0.4), "gait.frequency": (2.5, 1.5, 2.0), "gait.phase_shift": (0.6, 0.7, 0.8)}
    run_sweep(Sweep(points=Rows(values=points), **SHARED), tmp_path / "list")
    sweep = opened(tmp_path / "list")
    chart = sweep.chart("mean_power", "gait.amplitude", "gait.phase_shift")
    assert not sweep.is_grid
    assert chart.cut.shape == (3,)
    assert chart.nearest(math.degrees(0.57), math.degrees(0.69)) == {name: values[1] for name, values in points.items()}
    picture = gait_map_picture(
        sweep.ticks(chart.x).tolist(),
        sweep.ticks(chart.y).tolist(),
        np.asarray(chart.cut),
        chart.title,
        ("across", "up"),
    )
    assert len(np.unique(picture.pixels.reshape(-1, 3), axis=0)) > 10


def test_a_quantity_that_no_trial_has_is_drawn_gray():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        picture = gait_map_picture((1.0, 2.0), (1.0, 2.0, 3.0), np.full((3, 2), np.nan), "Nothing [-]", ("", ""))
    assert tuple(picture.pixels[picture.pixels.shape[0] // 2, picture.pixels.shape[1] // 2]) == (200, 200, 200)


def test_what_is_no_sweep_says_why(folder, tmp_path):
    lc.swim(SCENARIO.robot, GAIT, 1.0).save(tmp_path / "trial.nc")
    one = open_sweep(folder).isel({"water.normal_drag": 0, "gait.frequency": 0}, drop=True)
    one.to_netcdf(tmp_path / "line.nc", engine="netcdf4")
    shutil.make_archive(str(tmp_path / "other"), "zip", tmp_path, "trial.nc")
    for name, message in (
        ("trial.nc", "Cannot load trial.nc: it is no sweep of laticauda"),
        ("line.nc", "a map needs two numbers that differ from trial to trial; this sweep is over gait.amplitude"),
        ("other.zip", "Cannot load other.zip: it is no sweep of laticauda"),
    ):
        with pytest.raises(TrialFileError, match=message):
            received_sweep(name, (tmp_path / name).read_bytes())
    for name in ("broken.zip", "broken.nc", "broken.txt"):
        with pytest.raises(TrialFileError, match=f"Cannot load {name}: "):
            received_sweep(name, b"nothing")
    with pytest.raises(ValueError, match=r"`sweep` must name numbers of .*, got 'robot\.caudal_fin\.height'"):
        with_numbers(lc.scenario("mamba", GAIT), {"robot.caudal_fin.height": 0.1})


class Page:
    """Stands for a browser's page: keeps what it is told."""

    def __init__(self):
        self.told = []

    def add_notification(self, title, text, **settings):
        self.told.append(text)


def test_a_loaded_sweep_is_the_map_and_a_click_on_it_sets_its_numbers(folder):
    cockpit, page = Cockpit(Live(SCENARIO), port=0), Page()
    board = controls = cockpit._board
    try:
        file = SimpleNamespace(name="grid.zip", content=folder.with_suffix(".zip").read_bytes())
        controls._load(SimpleNamespace(client=page, target=SimpleNamespace(value=file)))
        cockpit.frame()
        assert page.told == []
        assert board._on.value  # a loaded one is shown
        assert "**grid.zip**: mamba-fin, lateral undulation, paper-lateral, prescribed." in controls._about.content
        assert controls._others["gait.frequency"].value == f"{math.degrees(2.0):.6g}"  # as it swims here
        # The third number takes the place of the second.
        controls._y.value = "gait.frequency"
        controls._choose(SimpleNamespace(client=page, target=controls._y))
        controls._others["water.normal_drag"].value = "1.75"
        cockpit.frame()
        assert controls._others["water.normal_drag"].visible
        assert not controls._others["gait.frequency"].visible
        right, down, _ = board._place(math.degrees(0.6), math.degrees(2.5))
        eye, goal = np.array([0.3, -2.0, 1.5]), board._frame.position + np.array([right, 0.0, -down])
        board._click(Event(page, None, (eye, goal - eye)))
        assert (cockpit.live.scenario.gait.amplitude, cockpit.live.scenario.gait.frequency) == (0.6, 2.5)
        assert cockpit.live.scenario.environment.normal_drag == 1.75
        controls._x.value = "gait.frequency"  # that the other axis has: they change places
        controls._choose(SimpleNamespace(client=page, target=controls._x))
        assert (controls._x.value, controls._y.value) == ("gait.frequency", "gait.amplitude")
        cockpit.frame()
        controls._load(
            SimpleNamespace(client=page, target=SimpleNamespace(value=SimpleNamespace(name="x.nc", content=b"")))
        )
        assert page.told[0].startswith("Cannot load x.nc: ")
        assert controls._sweep is not None
    finally:
        cockpit.close()
