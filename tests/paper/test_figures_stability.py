import numpy as np
import pytest
from matplotlib.collections import LineCollection, PatchCollection

from laticauda.figures import new_figure
from laticauda.paper.figures.stability import StabilityPanel, stability_map, stability_sheet


def panel(**changed) -> StabilityPanel:
    values = {
        "title": "somebody",
        "look_ahead_distances": np.array([0.18, 1.62, 3.24]),
        "gains": np.array([0.2, 0.4]),
        "raw_gains": np.array([0.4]),
        "rms": np.array([[0.01, 0.123, 0.0], [0.02, 0.06, 0.03], [0.0, 0.04, 0.05]]),
        "behaviors": (
            ("settled", "limit cycle", "settled"),
            ("settled", "still coming", "settled"),
            ("settled", "settled", "settled"),
        ),
        "rule": 3.24,
        "paper": (0.18, 0.4),
    }
    return StabilityPanel(**(values | changed))


@pytest.fixture
def ax():
    return new_figure(4, 3).subplots()


def test_every_cell_says_its_error_in_centimeters(ax):
    assert stability_map(panel(), ax) is ax
    cells = [text for text in ax.texts if text.get_text() not in ("mean heading", "raw")]
    assert [text.get_text() for text in cells] == ["1.0", "12", "<0.1", "2.0", "6.0", "3.0", "<0.1", "4.0", "5.0"]
    bold = [text.get_text() for text in cells if text.get_fontweight() == "bold"]
    assert bold == ["12", "6.0"]
    assert [label.get_text() for label in ax.get_xticklabels()] == ["0.2", "0.4", "0.4"]
    assert [label.get_text() for label in ax.get_yticklabels()] == ["0.18", "1.62", "3.24"]


def test_a_line_parts_what_settles_from_what_does_not_but_not_across_the_gap(ax):
    stability_map(panel(), ax)
    (boundary,) = (one for one in ax.collections if isinstance(one, LineCollection))
    edges = sorted(np.round(path.vertices, 9).tolist() for path in boundary.get_paths())
    assert edges == [[[0.5, -0.5], [0.5, 0.5]], [[0.5, 0.5], [0.5, 1.5]], [[0.5, 1.5], [1.5, 1.5]]]


def test_what_is_still_coming_is_hatched(ax):
    stability_map(panel(), ax)
    hatched = [patch for patch in ax.patches if patch.get_hatch()]
    assert [patch.get_xy() for patch in hatched] == [(0.5, 0.5)]


@pytest.mark.parametrize(("rule", "at"), [(3.24, [1.5]), (1.0, [0.5]), (4.0, [])])
def test_the_rule_is_a_line_under_the_first_distance_that_keeps_it(ax, rule, at):
    stability_map(panel(rule=rule), ax)
    assert [line.get_ydata()[0] for line in ax.lines] == at


def test_the_papers_point_is_framed_with_either_heading(ax):
    stability_map(panel(), ax)
    (frames,) = (one for one in ax.collections if isinstance(one, PatchCollection))
    centers = [path.vertices[:4].mean(axis=0) for path in frames.get_paths()]
    assert np.allclose(centers, [[1.0, 0.0], [2.45, 0.0]])


@pytest.mark.parametrize("n_panels", [1, 2, 3, 4])
def test_a_sheet_has_a_letter_per_map_and_one_scale(n_panels):
    figure = stability_sheet([panel()] * n_panels, "All", "small print")
    figure.canvas.draw()  # warnings of the layout are errors
    shown = [ax for ax in figure.axes if ax.get_visible() and ax.get_title(loc="left")]
    assert [ax.get_title(loc="left") for ax in shown] == [f"({letter})  somebody" for letter in "abcd"[:n_panels]]
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == [
        "settled | not settled (bold)",
        "not settled, still coming",
        "two robot lengths",
        "the paper's gains",
    ]


def test_a_map_without_raw_headings_has_no_words_above_it(ax):
    stability_map(panel(raw_gains=np.array([]), rms=np.full((3, 2), 0.01), behaviors=(("settled",) * 2,) * 3), ax)
    assert len(ax.texts) == 6
    assert ax.get_xlim() == (-0.5, 1.5)
