from dataclasses import replace
from math import radians

import numpy as np
import pytest

from laticauda.figures import new_figure
from laticauda.paper import Repeat, efficiency_settings
from laticauda.paper.figures.efficiency import (
    POWERS,
    VELOCITY,
    Panel,
    draw_panel,
    efficiency_sheet,
)
from laticauda.paper.measured import table1


def panel(velocity=(0.1, np.nan), power=(90.0, 95.0)) -> Panel:
    sweep = replace(efficiency_settings().sweeps[0], low=radians(10), high=radians(50), step=radians(20))
    rows = [replace(row, starred=star) for row, star in zip(table1()[:2], ("amplitude", None), strict=True)]
    return Panel(
        sweep=sweep,
        labels=("one", "other"),
        velocity=np.array([[0.05, 0.1, 0.12], [0.06, 0.11, 0.1]]),
        power=np.array([[1.0, 3.0, 9.0], [2.0, 4.0, 5.0]]),
        measured=tuple(
            replace(row, gait=replace(row.gait, amplitude=at), forward_velocity=v, mean_power=p)
            for row, at, v, p in zip(rows, sweep.values[1:], velocity, power, strict=True)
        ),
        repeats=(),
    )


@pytest.fixture
def ax():
    return new_figure(3, 2).subplots()


def test_velocities_are_drawn_over_degrees_and_missing_ones_are_left_out(ax):
    assert draw_panel(panel(), ax, *VELOCITY) is ax
    one, other, star = ax.lines
    assert np.allclose(one.get_xdata(), [10, 30, 50])
    assert np.allclose(other.get_ydata(), [0.06, 0.11, 0.1])
    assert np.allclose(star.get_xydata(), [[30, 0.1]])
    assert ax.get_xlabel() == "amplitude $\\alpha$ [deg]"
    assert ax.get_ylabel() == "forward velocity [m/s]"


def test_lines_are_told_apart_by_dashes_too(ax):
    draw_panel(panel(), ax, *VELOCITY)
    one, other, _ = ax.lines
    assert one.get_linestyle() != other.get_linestyle()
    assert one.get_color() != other.get_color()


def test_mechanical_and_electrical_power_have_axes_of_their_own():
    figure = efficiency_sheet([panel(), panel()], "title", POWERS)
    above, below = figure.axes[:2], figure.axes[2:]
    assert above[0].get_ylabel() == "mechanical power,\nsimulated [W]"
    assert below[0].get_ylabel() == "electrical power,\nmeasured [W]"
    assert above[0].get_ylim()[1] < below[0].get_ylim()[1]
    assert [len(ax.lines) for ax in figure.axes] == [2, 2, 2, 2]


def test_power_that_was_not_measured_is_said_to_be_missing(ax):
    draw_panel(panel(power=(np.nan, np.nan)), ax, POWERS[1])
    assert [text.get_text() for text in ax.texts] == ["not available"]
    assert draw_panel(panel(power=(np.nan, np.nan)), ax, POWERS[0]) is ax


@pytest.mark.parametrize("ylabels", [VELOCITY, POWERS], ids=["velocity", "powers"])
@pytest.mark.parametrize("measured", [(0.1, 0.2), (np.nan, np.nan)], ids=["measured", "missing"])
def test_a_sheet_shows_everything_on_scales_from_zero(ylabels, measured):
    figure = efficiency_sheet([panel(measured, measured)] * 3, "Forward velocity", ylabels)
    figure.canvas.draw()  # warnings of the layout are errors
    for ax in figure.axes:
        low, high = ax.get_ylim()
        assert low == 0.0
        drawn = np.concatenate([[0.0], *(line.get_ydata() for line in ax.lines)])
        assert np.max(drawn) < high
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["one", "other", "measured, fastest of its sweep", "measured, another setting"]
    titles = [ax.get_title(loc="left") for ax in figure.axes[:3]]
    assert titles[0] == "(a)  $\\omega$ = 110°/s, $\\delta$ = 40°"


def scattered() -> Panel:
    one = panel()
    gaits = [row.gait for row in one.measured]
    repeats = (
        Repeat(gait=gaits[0], has_fin=False, forward_velocity=(0.1, 0.12, 0.14), mean_power=(80.0, None, None)),
        Repeat(gait=gaits[1], has_fin=False, forward_velocity=(0.3,), mean_power=(None,)),
    )
    return replace(one, repeats=repeats)


def test_repeated_trials_are_dots_beside_their_setting_with_mean_and_deviation(ax):
    draw_panel(scattered(), ax, *VELOCITY)
    (bar,) = ax.containers
    mean, _, (stem,) = bar.lines
    assert mean.get_ydata() == pytest.approx([0.12])
    low, high = stem.get_segments()[0][:, 1]
    assert (low, high) == pytest.approx((0.1, 0.14))  # the sample's deviation is 0.02
    dots = [line for line in ax.lines if line.get_markerfacecolor() == "none"]
    assert [list(line.get_ydata()) for line in dots] == [[0.1, 0.12, 0.14], [0.3]]
    for line, at in zip(dots, (30.0, 50.0), strict=True):
        assert np.all(np.asarray(line.get_xdata()) > at)
        assert np.max(line.get_xdata()) < at + 0.05 * 40.0
    assert ax.get_xlim()[1] > np.max(dots[1].get_xdata())


def test_repeated_trials_stay_on_the_scale_and_get_a_legend():
    figure = efficiency_sheet([scattered(), panel()], "title", VELOCITY)
    figure.canvas.draw()
    assert figure.axes[0].get_ylim()[1] > 0.3
    assert len(figure.legends[0].get_texts()) == 6
    assert len(efficiency_sheet([panel()], "title", VELOCITY).legends[0].get_texts()) == 4


def test_a_power_that_only_repeated_trials_have_is_shown(ax):
    one = scattered()
    measured = tuple(replace(row, mean_power=None) for row in one.measured)
    draw_panel(replace(one, measured=measured), ax, POWERS[1])
    assert not ax.texts
    assert [list(line.get_ydata()) for line in ax.lines] == [[80.0]]
