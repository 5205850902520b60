from dataclasses import replace
from itertools import combinations
from math import radians
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from matplotlib.text import Text

from laticauda.paper import (
    Repeat,
    load_efficiency_settings,
    load_path_following_settings,
    read_path_following_trials,
)
from laticauda.paper.figures import (
    POWERS,
    VELOCITY,
    Panel,
    draw_efficiency_sheet,
    draw_panel,
)
from laticauda.paper.measured import read_table1
from laticauda.paper.path_following import FollowingCase
from laticauda.paper.settings import Group
from laticauda.paper.speed_figures import LabeledSpeeds, draw_following_speeds, draw_speeds_sheet
from laticauda.show.figures import new_figure


def panel(velocity=(0.1, np.nan), power=(90.0, 95.0)) -> Panel:
    sweep = replace(
        load_efficiency_settings().sweeps[0], low=radians(10), high=radians(50), step=radians(20)
    )
    rows = [
        replace(row, starred=star)
        for row, star in zip(read_table1()[:2], ("amplitude", None), strict=True)
    ]
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
    figure = draw_efficiency_sheet([panel(), panel()], "title", POWERS)
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
    figure = draw_efficiency_sheet([panel(measured, measured)] * 3, "Forward velocity", ylabels)
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


def test_a_sweep_of_one_value_is_drawn_too(ax):
    whole = panel()
    sweep = replace(whole.sweep, high=whole.sweep.low)
    single = replace(
        whole, sweep=sweep, velocity=whole.velocity[:, :1], power=whole.power[:, :1], measured=()
    )
    draw_panel(single, ax, *VELOCITY)
    assert [list(line.get_xdata()) for line in ax.lines] == [[pytest.approx(10.0)]] * 2


def scattered() -> Panel:
    one = panel()
    gaits = [row.gait for row in one.measured]
    repeats = (
        Repeat(
            gait=gaits[0],
            has_fin=False,
            forward_velocity=(0.1, 0.12, 0.14),
            mean_power=(80.0, None, None),
        ),
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
    figure = draw_efficiency_sheet([scattered(), panel()], "title", VELOCITY)
    figure.canvas.draw()
    assert figure.axes[0].get_ylim()[1] > 0.3
    assert len(figure.legends[0].get_texts()) == 6
    assert len(draw_efficiency_sheet([panel()], "title", VELOCITY).legends[0].get_texts()) == 4


def test_a_power_that_only_repeated_trials_have_is_shown(ax):
    one = scattered()
    measured = tuple(replace(row, mean_power=None) for row in one.measured)
    draw_panel(replace(one, measured=measured), ax, POWERS[1])
    assert not ax.texts
    assert [list(line.get_ydata()) for line in ax.lines] == [[80.0]]


def row(group: Group, case: int, measured: float = 0.09) -> FollowingCase:
    own = replace(read_path_following_trials()[case - 1], case=case, forward_velocity=measured)

    def run(joints: str, speed: float) -> Any:
        return SimpleNamespace(joints=joints, offset_bandwidth=10.0, forward_velocity=speed)

    return FollowingCase(
        measured=own,
        group=group,
        figure=12,
        trial=cast(Any, None),
        run=run("pd", 0.06),
        band=(run("pd", 0.05), run("pd", 0.06), run("servo", 0.04)),
        cycle_mean=run("pd", 0.03),
        free_velocity=0.1,
    )


ONE, OTHER = load_path_following_settings().groups[:2]
ROWS = [row(ONE, 1), row(ONE, 2, measured=0.2), row(OTHER, 1)]
NULL = (0.1, 0.1, 0.1)


def test_every_trial_has_its_row_below_the_one_before_and_every_group_its_name(ax):
    assert draw_following_speeds(ROWS, NULL, ax) is ax
    heights = ax.get_yticks()
    assert [label.get_text() for label in ax.get_yticklabels()] == ["case 1", "case 2", "case 1"]
    assert ax.yaxis_inverted()
    assert np.all(np.diff(heights) > 0.0)
    names = {text.get_text(): text.get_position()[1] for text in ax.texts}
    assert list(names) == [ONE.name, OTHER.name]
    assert names[ONE.name] < heights[0]
    assert heights[1] < names[OTHER.name] < heights[2]


def test_the_bar_spans_the_simulated_speeds_and_every_speed_has_a_mark(ax):
    draw_following_speeds(ROWS[1:2], NULL[1:2], ax)
    bar, *marks = ax.lines
    assert list(bar.get_xdata()) == [0.04, 0.06]
    shown = sorted(float(x) for line in marks for x in line.get_xdata())
    assert shown == [0.03, 0.04, 0.05, 0.06, 0.06, 0.1, 0.2]
    assert ax.get_xlim()[0] == 0.0


def test_what_the_marks_mean_is_in_the_legend_and_shapes_differ_too():
    figure = draw_speeds_sheet(
        ROWS, "Speeds", chosen="chosen runs", null=LabeledSpeeds("no physics", NULL)
    )
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == [
        "measured in the tank",
        "chosen runs",
        "the same, cycle-mean heading",
        "no physics",
        "pd joints, 10 and 10 rad/s, raw heading",
        "servo joints, 10 rad/s, raw heading",
        "range of these",
    ]
    looks = [
        (line.get_marker(), line.get_markersize(), line.get_markerfacecolor())
        for line in legend.get_lines()
    ]
    assert len(set(looks)) == len(looks)
    assert figure.axes[0].get_xlabel() == "forward velocity [m/s]"


def test_no_text_of_the_sheet_lies_on_another():
    figure = draw_speeds_sheet(
        ROWS, "Speeds", chosen="chosen runs", null=LabeledSpeeds("no physics", NULL)
    )
    figure.canvas.draw()
    texts = [
        text for text in figure.findobj(Text) if text.get_text().strip() and text.get_visible()
    ]
    for one, other in combinations((text.get_window_extent() for text in texts), 2):
        assert not one.overlaps(other) or min(one.x1, other.x1) - max(one.x0, other.x0) <= 1.0
