from itertools import combinations

import numpy as np
import pytest
from matplotlib.text import Text

from laticauda.figures import new_figure
from laticauda.paper.figures.following_speeds import SpeedRow, following_speeds, following_speeds_sheet


def row(group: str, label: str, **changed) -> SpeedRow:
    values = {
        "group": group,
        "label": label,
        "measured": 0.09,
        "simulated": {"pd joints": (0.05, 0.06), "servo joints": (0.04,)},
        "chosen": 0.06,
        "cycle_mean": 0.03,
        "null": 0.1,
    }
    return SpeedRow(**(values | changed))


ROWS = [row("one", "case 1"), row("one", "case 2", measured=0.2), row("other", "case 1")]


@pytest.fixture
def ax():
    return new_figure(5, 3).subplots()


def test_every_trial_has_its_row_below_the_one_before_and_every_group_its_name(ax):
    assert following_speeds(ROWS, ax) is ax
    heights = ax.get_yticks()
    assert [label.get_text() for label in ax.get_yticklabels()] == ["case 1", "case 2", "case 1"]
    assert ax.yaxis_inverted()
    assert np.all(np.diff(heights) > 0.0)
    names = {text.get_text(): text.get_position()[1] for text in ax.texts}
    assert list(names) == ["one", "other"]
    assert names["one"] < heights[0]
    assert heights[1] < names["other"] < heights[2]


def test_the_bar_spans_the_simulated_speeds_and_every_speed_has_a_mark(ax):
    following_speeds(ROWS[1:2], ax)
    bar, *marks = ax.lines
    assert list(bar.get_xdata()) == [0.04, 0.06]
    shown = sorted(float(x) for line in marks for x in line.get_xdata())
    assert shown == [0.03, 0.04, 0.05, 0.06, 0.06, 0.1, 0.2]
    assert ax.get_xlim()[0] == 0.0


def test_what_the_marks_mean_is_in_the_legend_and_shapes_differ_too():
    figure = following_speeds_sheet(ROWS, "Speeds", chosen="chosen runs", null="no physics")
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == [
        "measured in the tank",
        "chosen runs",
        "the same, cycle-mean heading",
        "no physics",
        "pd joints",
        "servo joints",
        "range of these",
    ]
    looks = [(line.get_marker(), line.get_markersize(), line.get_markerfacecolor()) for line in legend.get_lines()]
    assert len(set(looks)) == len(looks)
    assert figure.axes[0].get_xlabel() == "forward velocity [m/s]"


def test_no_text_of_the_sheet_lies_on_another():
    figure = following_speeds_sheet(ROWS, "Speeds", chosen="chosen runs", null="no physics")
    figure.canvas.draw()
    texts = [text for text in figure.findobj(Text) if text.get_text().strip() and text.get_visible()]
    for one, other in combinations((text.get_window_extent() for text in texts), 2):
        assert not one.overlaps(other) or min(one.x1, other.x1) - max(one.x0, other.x0) <= 1.0
