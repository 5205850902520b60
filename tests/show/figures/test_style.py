import numpy as np
import pytest
from matplotlib.colors import to_rgb

from laticauda.show.figures import style


def gray(color: object) -> float:
    """How light a color is in gray print."""
    return float(np.dot(to_rgb(color), (0.299, 0.587, 0.114)))  # pyright: ignore


@pytest.mark.parametrize("n_joints", [1, 2, 8, 18, 49])
def test_joints_get_lighter_from_tail_to_head_also_in_gray_print(n_joints: int):
    colors, norm = style.joint_colors(n_joints)
    shades = [gray(colors(norm(i))[:3]) for i in range(n_joints)]
    assert len(set(shades)) == n_joints
    assert shades == sorted(shades)


def test_the_colors_of_figures_differ_in_gray_print():
    shades = sorted(gray(color) for color in (style.INK, style.BLUE, style.AMBER))
    assert min(np.diff(shades)) > 0.2


def test_no_line_is_lost_on_white_paper():
    colors, _ = style.joint_colors(8)
    assert max(gray(colors(i)[:3]) for i in range(8)) < 0.75


def test_a_title_that_is_wider_than_the_figure_is_broken_into_lines():
    figure = style.new_figure(3.0, 2.0)
    text = style.add_title(
        figure, "Short", "a note that is much longer than this figure is wide, " * 2
    )
    lines = text.get_text().split("\n")
    assert lines[0] == "Short"
    assert len(lines) > 3
    assert text.get_window_extent().x1 <= figure.bbox.x1
    assert style.add_title(figure, "Short").get_text() == "Short"


def test_lines_of_panels_differ_in_color_and_dashes_without_changes_for_others():
    figure, panels = style.new_panels(2, width=5.0)
    assert len(panels) == len(figure.axes) == 2
    lines = [panels[0].plot([0.0, 1.0])[0] for _ in range(4)]
    assert [line.get_color() for line in lines] == [color for color, _ in style.LINES]
    assert len({str(line.get_linestyle()) for line in lines}) > 1
    (plain,) = style.new_figure(2.0, 2.0).subplots().plot([0.0, 1.0])
    assert plain.get_color() not in [color for color, _ in style.LINES]
