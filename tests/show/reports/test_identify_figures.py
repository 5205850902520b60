import numpy as np
import pytest

from laticauda.show.figures import new_figure
from laticauda.show.reports import identify_axes as draw


@pytest.fixture
def ax():
    return new_figure(4.0, 3.0).subplots()


def test_what_is_equal_lies_on_the_line_and_both_axes_have_one_scale(ax):
    values = np.array([0.1, 0.2, 0.3])
    draw.draw_parity({"a": np.stack((values, values))}, ax, quantity="speed [m/s]")
    assert ax.get_xlim() == ax.get_ylim()
    np.testing.assert_array_equal(*ax.lines[-1].get_data())
    assert ax.get_xlabel() == "measured speed [m/s]"


def test_what_is_not_identified_has_no_bar_but_words(ax):
    draw.draw_intervals(
        {
            "a": draw.ParameterIntervals(covariance=np.array([0.9, 1.1]), profile=None),
            "b": draw.ParameterIntervals(covariance=None, profile=np.array([0.5, np.nan])),
        },
        ax,
        confidence=0.95,
    )
    assert [text.get_text() for text in ax.texts] == ["not identified"]
    assert ax.get_xlim()[0] < 0.5


def test_correlations_leave_out_the_diagonal_and_dash_what_is_unknown(ax):
    draw.draw_correlations(
        ["a", "b", "c"], np.array([[1.0, -0.5, np.nan], [-0.5, 1.0, np.nan], [np.nan] * 3]), ax
    )
    shown = [text.get_text() for text in ax.texts]
    assert shown.count("\N{MINUS SIGN}0.50") == 2
    assert shown.count("\N{EN DASH}") == 4


def test_what_is_not_known_yet_is_an_open_mark_at_the_top(ax):
    draw.draw_expected_deviations(["a"], np.array([[np.inf], [0.1]]), ax, ylabel="sigma", limit=0.5)
    (beyond,) = (line for line in ax.lines if line.get_markerfacecolor() == "white")
    assert list(beyond.get_xdata()) == [0]
    assert "open: not known" in [text.get_text() for text in ax.texts]


def test_a_bar_per_measurement(ax):
    draw.draw_residuals(["one", "two"], [1.0, -4.0], ["a", "b"], ax, label="off")
    assert len(ax.patches) == 2
    assert ax.get_xlim()[0] < -4.0
