from dataclasses import replace
from itertools import combinations
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from matplotlib.text import Text

from laticauda.figures import new_figure
from laticauda.paper import path_following_settings, path_following_trials
from laticauda.paper.figures.following_speeds import following_speeds, following_speeds_sheet
from laticauda.paper.path_following import FollowingCase
from laticauda.paper.settings import Group


def row(group: Group, case: int, measured: float = 0.09) -> FollowingCase:
    own = replace(path_following_trials()[case - 1], case=case, forward_velocity=measured)

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


ONE, OTHER = path_following_settings().groups[:2]
ROWS = [row(ONE, 1), row(ONE, 2, measured=0.2), row(OTHER, 1)]
NULL = (0.1, 0.1, 0.1)


@pytest.fixture
def ax():
    return new_figure(5, 3).subplots()


def test_every_trial_has_its_row_below_the_one_before_and_every_group_its_name(ax):
    assert following_speeds(ROWS, NULL, ax) is ax
    heights = ax.get_yticks()
    assert [label.get_text() for label in ax.get_yticklabels()] == ["case 1", "case 2", "case 1"]
    assert ax.yaxis_inverted()
    assert np.all(np.diff(heights) > 0.0)
    names = {text.get_text(): text.get_position()[1] for text in ax.texts}
    assert list(names) == [ONE.name, OTHER.name]
    assert names[ONE.name] < heights[0]
    assert heights[1] < names[OTHER.name] < heights[2]


def test_the_bar_spans_the_simulated_speeds_and_every_speed_has_a_mark(ax):
    following_speeds(ROWS[1:2], NULL[1:2], ax)
    bar, *marks = ax.lines
    assert list(bar.get_xdata()) == [0.04, 0.06]
    shown = sorted(float(x) for line in marks for x in line.get_xdata())
    assert shown == [0.03, 0.04, 0.05, 0.06, 0.06, 0.1, 0.2]
    assert ax.get_xlim()[0] == 0.0


def test_what_the_marks_mean_is_in_the_legend_and_shapes_differ_too():
    figure = following_speeds_sheet(ROWS, "Speeds", chosen="chosen runs", null=("no physics", NULL))
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
    looks = [(line.get_marker(), line.get_markersize(), line.get_markerfacecolor()) for line in legend.get_lines()]
    assert len(set(looks)) == len(looks)
    assert figure.axes[0].get_xlabel() == "forward velocity [m/s]"


def test_no_text_of_the_sheet_lies_on_another():
    figure = following_speeds_sheet(ROWS, "Speeds", chosen="chosen runs", null=("no physics", NULL))
    figure.canvas.draw()
    texts = [text for text in figure.findobj(Text) if text.get_text().strip() and text.get_visible()]
    for one, other in combinations((text.get_window_extent() for text in texts), 2):
        assert not one.overlaps(other) or min(one.x1, other.x1) - max(one.x0, other.x0) <= 1.0
