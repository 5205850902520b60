from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.figures import style
from laticauda.reports.front import FrontLine, Mark, front, front_sheet

ROBOT = lc.load_robot("mamba-fin")
GAIT = lc.lateral_undulation(amplitude=0.6, frequency=2.0, phase_shift=0.6)


def line(label: str, scale: float) -> FrontLine:
    x = np.linspace(0.1, 9.0, 40)
    y = scale * np.sqrt(x)
    marks = tuple(
        Mark(x=float(x[i]), y=float(y[i]), text=f"number {i}", robot=ROBOT, gait=replace(GAIT, frequency=1.0 + i))
        for i in (10, 39)
    )
    others = np.array([[4.0, 0.1 * scale]])
    return FrontLine(label=label, x=x, y=y, marks=marks, others=others, others_label="others")


def test_the_fronts_are_drawn_with_their_marks_and_the_other_points():
    lines = [line("a", 1.0), line("b", 2.0)]
    ax = front(lines, style.new_figure(3, 3).add_subplot(), xlabel="power [W]", ylabel="speed [m/s]")
    curves = [drawn for drawn in ax.lines if len(drawn.get_xdata()) == 40]
    assert [tuple(curve.get_ydata()) for curve in curves] == [tuple(one.y) for one in lines]
    assert [text.get_text() for text in ax.texts] == ["A", "B", "C", "D"]
    assert [text.xy for text in ax.texts] == [(mark.x, mark.y) for one in lines for mark in one.marks]
    # Letters stand off the fronts: those of the lower one below it.
    assert [text.get_position()[1] > 0 for text in ax.texts] == [False, False, True, True]
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["a", "b", "others"]
    low, high = ax.get_ylim()
    assert low == 0.0 and high > 6.0


def test_letters_of_costs_stand_where_less_of_both_would_be():
    falling = replace(line("a", 1.0), y=np.linspace(5.0, 1.0, 40))
    ax = front([falling], style.new_figure(3, 3).add_subplot(), xlabel="x", ylabel="y")
    assert all(text.get_position()[0] < 0 and text.get_position()[1] < 0 for text in ax.texts)


@pytest.mark.parametrize("n_lines", [1, 2])
def test_the_sheet_has_a_column_of_bodies_per_front_and_nothing_is_cut_off(n_lines: int):
    lines = [line("a", 1.0), line("b", 2.0)][:n_lines]
    figure = front_sheet(lines, "Title", "note", xlabel="power [W]", ylabel="speed [m/s]")
    figure.canvas.draw()
    columns = figure.axes[1:]
    assert len(columns) == n_lines
    for column, one in zip(columns, lines, strict=True):
        words = [text.get_text() for text in column.texts]
        assert [mark.text for mark in one.marks] == words[1::2]
        boxes = [text.get_window_extent() for text in column.texts]
        assert all(figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1 for box in boxes)
        # Below each other, and the bodies between them.
        heights = [box.y0 for box in boxes[1::2]]
        assert heights == sorted(heights, reverse=True)
        assert len(column.collections) >= 3 * len(one.marks)
