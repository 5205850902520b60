import numpy as np
import pytest
import xarray
from show.figures.runs import run

from laticauda.show.figures import plot_overlay, save_figure, sweep_sheet

ABOUT = {"robot": "mamba", "gait": "lateral_undulation", "duration": 12.0}
AXES = {
    "gait.amplitude": (np.radians([10.0, 30.0, 50.0]), {"long_name": "amplitude", "units": "rad"}),
    "gait.frequency": (
        np.radians([50.0, 100.0]),
        {"long_name": "angular frequency", "units": "rad/s"},
    ),
    "robot.n_links": (np.array([8.0, 9.0]), {"long_name": "number of links", "units": "1"}),
}


def swept(*names: str, listed: bool = False) -> xarray.Dataset:
    """Results of a sweep; the fastest point is the last but one, the last one failed."""
    shape = (6,) if listed else tuple(len(AXES[name][0]) for name in names)
    speed = np.linspace(0.1, 0.2, int(np.prod(shape)))
    speed[-1] = np.nan
    dims = ("trial",) if listed else names
    labels = {"forward_velocity": "m/s", "cost_of_transport": "1"}
    values = {
        name: (dims, speed.reshape(shape), {"units": unit, "long_name": name})
        for name, unit in labels.items()
    }
    coords = {
        name: (
            "trial" if listed else name,
            np.resize(AXES[name][0], 6) if listed else AXES[name][0],
            AXES[name][1],
        )
        for name in names
    }
    return xarray.Dataset(values, coords=coords, attrs=ABOUT)


def labels(figure) -> list[tuple[str, str]]:
    return [(ax.get_xlabel(), ax.get_ylabel()) for ax in figure.axes]


def test_several_trials_are_drawn_in_one_figure_with_their_names(tmp_path):
    figure = plot_overlay([run("lateral"), run("fin"), run("short")], ["a", "b", "c"])
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["a", "b", "c"]
    assert labels(figure) == [("x [m]", "y [m]"), ("time [s]", "speed, mean over a cycle [m/s]")]
    looks = {(line.get_color(), str(line.get_linestyle())) for line in figure.axes[1].lines}
    assert len(looks) == 3
    save_figure(figure, tmp_path / "a.png")


def test_a_run_without_a_whole_cycle_is_drawn_beside_others():
    still = run("still")
    figure = plot_overlay([run("lateral"), still], ["a", "b"])
    assert figure.axes[1].lines[1].get_xdata().size == still.time.size


def test_one_quantity_is_a_line_in_degrees():
    figure = sweep_sheet(swept("gait.amplitude"))
    assert labels(figure) == [
        ("amplitude [deg]", "forward velocity [m/s]"),
        ("amplitude [deg]", "cost of transport [-]"),
    ]
    assert figure.axes[0].lines[0].get_xdata() == pytest.approx([10.0, 30.0, 50.0])
    assert "1 of 3 without a value" in figure.get_suptitle()


def test_two_quantities_are_a_map_with_the_first_along_x():
    figure = sweep_sheet(swept("gait.amplitude", "gait.frequency"))
    assert labels(figure)[0] == ("amplitude [deg]", "angular frequency [deg/s]")
    mesh = figure.axes[0].collections[0]
    assert mesh.get_array().shape == (2, 3)
    assert mesh.get_array()[1, 0] == pytest.approx(0.12)


def test_of_more_quantities_the_map_says_where_it_lies():
    found = swept("gait.amplitude", "gait.frequency", "robot.n_links")
    figure = sweep_sheet(found)
    assert "through the fastest point, number of links [-] 8" in figure.get_suptitle()
    shown = figure.axes[0].collections[0].get_array()
    np.testing.assert_allclose(shown.filled(np.nan).T, found.forward_velocity.to_numpy()[:, :, 0])


def test_a_list_is_dots_and_what_is_held_is_no_axis():
    found = swept("gait.amplitude", "gait.frequency", listed=True)
    assert sweep_sheet(found).axes[0].collections[0].get_offsets().shape == (6, 2)
    held = swept("gait.amplitude", "robot.n_links").isel({"robot.n_links": [0]})
    assert len(sweep_sheet(held).axes) == 2


def test_dots_over_two_of_more_quantities_say_over_what_else_they_are():
    figure = sweep_sheet(swept("gait.amplitude", "gait.frequency", "robot.n_links", listed=True))
    assert "over all of number of links [-]" in figure.get_suptitle()
