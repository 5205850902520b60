from collections.abc import Mapping, Sequence

import numpy as np
import pytest
import xarray

from laticauda.show.figures import save_figure, sweep_sheet

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


def with_shares(found: xarray.Dataset, *shares: float) -> xarray.Dataset:
    """The same results, with the share of what the robot offers."""
    dims, shape = found.forward_velocity.dims, found.forward_velocity.shape
    return found.assign(utilization=(dims, np.resize(shares, shape), {"units": "1"}))


def stars(figure) -> list[tuple[float, ...]]:
    """Where each panel has its star."""
    lines = [line for ax in figure.axes for line in ax.lines if line.get_marker() == "*"]
    return [tuple(np.round(line.get_xydata()[0], 6)) for line in lines]


def test_stars_mark_the_best_that_the_robot_can_do():
    found = swept("gait.amplitude", "gait.frequency")
    assert stars(sweep_sheet(found)) == [(50.0, 50.0), (10.0, 50.0)]
    weak = with_shares(found, 1.2, 1.0, 0.8, 0.9, 1.5, 2.0)
    figure = sweep_sheet(weak)
    assert stars(figure) == [(30.0, 100.0), (10.0, 100.0)]
    assert "0.16 m/s" in [text.get_text() for text in figure.axes[0].texts]
    line = with_shares(swept("gait.amplitude"), 1.2, 0.9, 1.3)
    assert stars(sweep_sheet(line)) == [(30.0, 0.15), (30.0, 0.15)]


def test_the_limit_of_the_robot_is_a_line_with_its_name(tmp_path):
    asked: list[Sequence[Mapping[str, float]]] = []

    def name_limits(points: Sequence[Mapping[str, float]]) -> str:
        asked.append(points)
        return "servos"

    grid = swept("gait.amplitude", "gait.frequency", "robot.n_links")
    figure = sweep_sheet(with_shares(grid, 0.5, 0.5, 0.8, 0.8, 1.5, 2.0), name_limits)
    save_figure(figure, tmp_path / "map.png")
    texts = [text.get_text() for text in figure.axes[0].texts]
    assert "limit: servos" in texts
    assert any(text.endswith(" m/s") for text in texts)
    assert "the fastest is limited by: servos" in figure.get_suptitle().replace("\n", " ")
    for points in asked:
        for point in points:
            assert set(point) == {"gait.amplitude", "gait.frequency", "robot.n_links"}


def test_beyond_the_limit_a_line_is_shaded_and_dots_are_crossed_out():
    figure = sweep_sheet(with_shares(swept("gait.amplitude"), 0.5, 1.5, 1.6), lambda _: "servos")
    assert figure.axes[0].get_legend().get_texts()[0].get_text() == "beyond the limit: servos"
    found = swept("gait.amplitude", "gait.frequency", listed=True)
    figure = sweep_sheet(with_shares(found, 0.5, 1.5, 0.6))
    (crosses,) = [line for line in figure.axes[0].lines if line.get_marker() == "x"]
    assert len(crosses.get_xdata()) == 2


def test_where_the_robot_can_do_nothing_there_is_no_star():
    found = with_shares(swept("gait.amplitude", "gait.frequency"), 1.5)
    figure = sweep_sheet(found, lambda _: "servos")
    assert stars(figure) == []
    assert "all points are beyond the limit of servos" in figure.get_suptitle()


def test_where_nothing_limits_the_robot_the_figure_says_so():
    found = with_shares(swept("gait.amplitude", "gait.frequency"), 0.5)
    figure = sweep_sheet(found, lambda _: "")
    assert "no trial comes to a limit of the robot" in figure.get_suptitle()
