import numpy as np
import pytest
from matplotlib.collections import LineCollection, PatchCollection

from laticauda.figures import new_figure
from laticauda.paper import Loops, swimmers
from laticauda.paper.report.stability import stability_map, stability_sheet

PAPER = (0.18, 0.4)
BARE = swimmers()[0]  # 1.62 m long


def panel(distances=(0.18, 1.62, 3.24), raw=True) -> tuple[Loops, Loops]:
    """Two maps; the second gain swings at the first distance, and is still coming at the second."""

    def loops(heading: str, gains: list[float], rms: list[list[float]], before: list[list[float]]) -> Loops:
        return Loops(
            swimmer=BARE,
            heading=heading,
            look_ahead_distances=np.array(distances),
            gains=np.array(gains),
            rms=np.array(rms).reshape(len(distances), len(gains)),
            rms_before=np.array(before).reshape(len(distances), len(gains)),
            forward_velocity=np.ones((len(distances), len(gains))),
            tolerance=0.055,
        )

    rms, before = [[0.01, 0.123], [0.02, 0.06], [0.0, 0.04]], [[0.01, 0.123], [0.02, 0.2], [0.0, 0.04]]
    others = [[0.0], [0.03], [0.05]]
    beside = ([0.4], others, others) if raw else ([], [[], [], []], [[], [], []])
    return loops("cycle_mean", [0.2, 0.4], rms, before), loops("raw", *beside)


@pytest.fixture
def ax():
    return new_figure(4, 3).subplots()


def test_every_cell_says_its_error_in_centimeters(ax):
    assert stability_map(*panel(), ax, PAPER) is ax
    cells = [text for text in ax.texts if text.get_text() not in ("mean heading", "raw")]
    assert [text.get_text() for text in cells] == ["1.0", "12", "2.0", "6.0", "<0.1", "4.0", "<0.1", "3.0", "5.0"]
    bold = [text.get_text() for text in cells if text.get_fontweight() == "bold"]
    assert bold == ["12", "6.0"]
    assert [label.get_text() for label in ax.get_xticklabels()] == ["0.2", "0.4", "0.4"]
    assert [label.get_text() for label in ax.get_yticklabels()] == ["0.18", "1.62", "3.24"]


def test_a_line_parts_what_settles_from_what_does_not_but_not_across_the_gap(ax):
    stability_map(*panel(), ax, PAPER)
    boundaries = [one for one in ax.collections if isinstance(one, LineCollection)]
    edges = sorted(np.round(path.vertices, 9).tolist() for one in boundaries for path in one.get_paths())
    assert edges == [[[0.5, -0.5], [0.5, 0.5]], [[0.5, 0.5], [0.5, 1.5]], [[0.5, 1.5], [1.5, 1.5]]]


def test_what_is_still_coming_is_hatched(ax):
    stability_map(*panel(), ax, PAPER)
    hatched = [patch for patch in ax.patches if patch.get_hatch()]
    assert [patch.get_xy() for patch in hatched] == [(0.5, 0.5)]


@pytest.mark.parametrize(
    ("distances", "at"), [((0.18, 1.62, 3.24), [1.5]), ((0.18, 3.5, 4.0), [0.5]), ((0.18, 1.62, 3.2), [])]
)
def test_two_lengths_are_a_line_under_the_first_distance_that_keeps_them(ax, distances, at):
    assert BARE.length == pytest.approx(1.62)
    stability_map(*panel(distances), ax, PAPER)
    assert [line.get_ydata()[0] for line in ax.lines] == at


def test_the_papers_point_is_framed_with_either_heading(ax):
    stability_map(*panel(), ax, PAPER)
    frames = [one for one in ax.collections if isinstance(one, PatchCollection)]
    centers = [path.vertices[:4].mean(axis=0) for one in frames for path in one.get_paths()]
    assert np.allclose(centers, [[1.0, 0.0], [2.45, 0.0]])


@pytest.mark.parametrize("n_panels", [1, 2, 3, 4])
def test_a_sheet_has_a_letter_per_map_and_one_scale(n_panels):
    figure = stability_sheet([*panel()] * n_panels, "All", PAPER, "small print")
    figure.canvas.draw()  # warnings of the layout are errors
    shown = [ax for ax in figure.axes if ax.get_visible() and ax.get_title(loc="left")]
    assert [ax.get_title(loc="left") for ax in shown] == [f"({letter})  {BARE.name}" for letter in "abcd"[:n_panels]]
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == [
        "settled | not settled (bold)",
        "not settled, still coming",
        "two robot lengths",
        "the paper's gains",
    ]


def test_a_map_without_raw_headings_has_no_words_above_it(ax):
    stability_map(*panel(raw=False), ax, PAPER)
    assert len(ax.texts) == 6
    assert ax.get_xlim() == (-0.5, 1.5)
