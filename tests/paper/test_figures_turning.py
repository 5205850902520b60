import numpy as np
import pytest

from laticauda.figures import new_figure
from laticauda.paper import swimmers
from laticauda.paper.beyond import TurningCurve
from laticauda.paper.report.beyond import turning, turning_sheet

LINES = [
    TurningCurve(
        swimmer=swimmer,
        offset=np.radians([2.0, 10.0, 20.0]),
        turning_rate=np.radians([2.0, 10.0, 21.0]) * scale,
        path_speed=np.array([0.11, 0.1, 0.07]) * scale,
        mechanical_power=np.ones(3),
    )
    for swimmer, scale in zip(swimmers(), (1.0, 1.2, 0.8, 1.1), strict=True)
]


@pytest.fixture
def ax():
    return new_figure(3, 2).subplots()


@pytest.mark.parametrize(
    ("name", "first", "label"),
    [
        ("turning_rate", [2.0, 10.0, 21.0], "turning rate [deg/s]"),
        ("radius", [0.11 / np.radians(2.0), 0.1 / np.radians(10.0), 0.07 / np.radians(21.0)], "radius [m]"),
        ("path_speed", [0.11, 0.1, 0.07], "path speed [m/s]"),
    ],
)
def test_a_quantity_is_drawn_over_degrees(ax, name, first, label):
    assert turning(LINES, name, ax) is ax
    assert np.allclose(ax.lines[0].get_xdata(), [2, 10, 20])
    assert np.allclose(ax.lines[0].get_ydata(), first)
    assert ax.get_ylabel() == label
    assert ax.get_xlabel() == "offset $\\phi_0$ [deg]"


def test_every_line_differs_from_the_others_without_color_too(ax):
    turning(LINES, "turning_rate", ax)
    looks = {(line.get_marker(), line.get_linestyle()) for line in ax.lines}
    assert len(looks) == len(LINES)


def test_the_sheet_shows_all_three_and_names_the_lines():
    figure = turning_sheet(LINES, "Turning")
    figure.canvas.draw()  # warnings of the layout are errors
    assert [ax.get_yscale() for ax in figure.axes] == ["linear", "log", "linear"]
    assert [text.get_text() for text in figure.legends[0].get_texts()] == [line.swimmer.name for line in LINES]
    radii = figure.axes[1]
    low, high = radii.get_ylim()
    assert low < min(line.radius.min() for line in LINES)
    assert high > max(line.radius.max() for line in LINES)
    assert figure.axes[0].get_ylim()[0] == 0.0
