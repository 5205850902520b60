import numpy as np
import pytest

import laticauda as lc
from laticauda.show.figures import style
from laticauda.show.reports.front import draw_front_sheet
from laticauda.show.reports.front_axes import choose_marked_points, draw_fronts
from laticauda.studies import Front, Optimization
from laticauda.studies.point_trials import FIGURES

GAIT = lc.lateral_undulation(amplitude=0.6, frequency=2.0, phase_shift=0.6)
EEL = lc.eel_like(amplitude=0.6, frequency=2.0, phase_shift=0.6)
X = np.linspace(0.1, 90.0, 40)


def made(gait: lc.Gait, y: np.ndarray) -> Front:
    """A front of these speeds over the powers `X`, with frequencies that rise along it."""
    sought = Optimization(
        scenario=lc.build_scenario("mamba-fin", gait, 15.0), bounds={"gait.frequency": (1.0, 3.0)}
    )
    figures = {**dict.fromkeys(FIGURES, X), "forward_velocity": y, "mechanical_power": X}
    values = np.linspace(1.0, 3.0, 40)[:, np.newaxis]
    return Front(
        optimization=sought, values=values, figures=figures, n_trials=40, n_infeasible=0, seed=1
    )


def test_the_fronts_are_drawn_with_their_marks_and_the_other_points():
    fronts = [made(GAIT, np.sqrt(X)), made(EEL, 2.0 * np.sqrt(X))]
    ax = draw_fronts(fronts, style.new_figure(3, 3).add_subplot())
    curves = [drawn for drawn in ax.lines if len(drawn.get_xdata()) == 40]
    assert [tuple(curve.get_ydata()) for curve in curves] == [
        tuple(one.figures["forward_velocity"]) for one in fronts
    ]
    points = [(one, i) for one in fronts for i in choose_marked_points(one)]
    assert [text.get_text() for text in ax.texts] == list("ABCDEFGHIJ")
    assert [text.xy for text in ax.texts] == [
        (X[i], one.figures["forward_velocity"][i]) for one, i in points
    ]
    assert all(
        choose_marked_points(one)[0] > 0 and choose_marked_points(one)[-1] == 39 for one in fronts
    )
    # Letters stand off the fronts: those of the lower one below it.
    assert [text.get_position()[1] > 0 for text in ax.texts] == [False] * 5 + [True] * 5
    words = [text.get_text() for text in ax.get_legend().get_texts()]
    assert words == ["lateral undulation", "eel-like motion", "the paper's gaits, simulated alike"]
    low, high = ax.get_ylim()
    assert low == 0.0 and high > 2.0 * np.sqrt(90.0)


def test_letters_of_costs_stand_where_less_of_both_would_be():
    falling = made(GAIT, np.linspace(5.0, 1.0, 40))
    ax = draw_fronts([falling], style.new_figure(3, 3).add_subplot())
    assert all(text.get_position()[0] < 0 and text.get_position()[1] < 0 for text in ax.texts)


@pytest.mark.parametrize("n_fronts", [1, 2])
def test_the_sheet_has_a_column_of_bodies_per_front_and_nothing_is_cut_off(n_fronts: int):
    figure = draw_front_sheet([made(GAIT, np.sqrt(X)), made(EEL, 2.0 * np.sqrt(X))][:n_fronts])
    figure.canvas.draw()
    columns = figure.axes[1:]
    assert len(columns) == n_fronts
    for column, letters in zip(columns, ("ABCDE", "FGHIJ"), strict=False):
        words = [text.get_text() for text in column.texts]
        assert words[::2] == list(letters)
        assert all(word.startswith("$\\omega$ = ") for word in words[1::2])
        boxes = [text.get_window_extent() for text in column.texts]
        assert all(figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1 for box in boxes)
        # Below each other, and the bodies between them.
        heights = [box.y0 for box in boxes[1::2]]
        assert heights == sorted(heights, reverse=True)
        assert len(column.collections) >= 3 * 5
