import numpy as np
import pytest

from laticauda.figures import new_figure
from laticauda.paper.figures.turning import TurningLine, turning_radii, turning_rates, turning_sheet, turning_speeds

LINES = [
    TurningLine(
        label=f"{gait}, {fin}",
        is_eel_like=gait == "eel",
        has_fin=fin == "fin",
        offset=np.radians([2.0, 10.0, 20.0]),
        turning_rate=np.radians([2.0, 10.0, 21.0]) * scale,
        radius=np.array([4.0, 0.7, 0.2]) / scale,
        path_speed=np.array([0.11, 0.1, 0.07]) * scale,
    )
    for gait, fin, scale in (
        ("lateral", "bare", 1.0),
        ("lateral", "fin", 1.2),
        ("eel", "bare", 0.8),
        ("eel", "fin", 1.1),
    )
]


@pytest.fixture
def ax():
    return new_figure(3, 2).subplots()


@pytest.mark.parametrize(
    ("draw", "first", "label"),
    [
        (turning_rates, [2.0, 10.0, 21.0], "turning rate [deg/s]"),
        (turning_radii, [4.0, 0.7, 0.2], "radius [m]"),
        (turning_speeds, [0.11, 0.1, 0.07], "path speed [m/s]"),
    ],
)
def test_a_quantity_is_drawn_over_degrees(ax, draw, first, label):
    assert draw(LINES, ax) is ax
    assert np.allclose(ax.lines[0].get_xdata(), [2, 10, 20])
    assert np.allclose(ax.lines[0].get_ydata(), first)
    assert ax.get_ylabel() == label
    assert ax.get_xlabel() == "offset $\\phi_0$ [deg]"


def test_every_line_differs_from_the_others_without_color_too(ax):
    turning_rates(LINES, ax)
    looks = {(line.get_marker(), line.get_linestyle()) for line in ax.lines}
    assert len(looks) == len(LINES)


def test_the_sheet_shows_all_three_and_names_the_lines():
    figure = turning_sheet(LINES, "Turning")
    figure.canvas.draw()  # warnings of the layout are errors
    assert [ax.get_yscale() for ax in figure.axes] == ["linear", "log", "linear"]
    assert [text.get_text() for text in figure.legends[0].get_texts()] == [line.label for line in LINES]
    radii = figure.axes[1]
    low, high = radii.get_ylim()
    assert low < 0.2 / 1.2
    assert high > 4.0 / 0.8
    assert figure.axes[0].get_ylim()[0] == 0.0
