import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import combinations
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.text import Annotation, Text
from show.figures.runs import RUNS, run

import laticauda as lc
from laticauda.show.figures import (
    new_figure,
    plot_joint_angle,
    plot_joint_torque,
    plot_speed,
    save_figure,
    swim_sheet,
)
from laticauda.show.figures.style import DOUBLE_COLUMN
from laticauda.show.figures.timing import plot_timing

LABELS = ["x [m]", "y [m]", "time [s]", "speed [m/s]", "joint angle [deg]", "joint torque [N m]"]


@pytest.fixture
def ax() -> Axes:
    return new_figure(3.5, 2.5).add_subplot()


@cache
def sheet(name: str) -> Figure:
    figure = swim_sheet(run(name))
    figure.canvas.draw()
    return figure


def texts(figure: Figure) -> list[Text]:
    """Every text that is seen."""
    found = [
        text for text in figure.findobj(Text) if text.get_visible() and text.get_text().strip()
    ]
    # Tick labels beyond the limits of their axes are not drawn.
    for axis in (axis for ax in figure.axes for axis in (ax.xaxis, ax.yaxis)):
        low, high = sorted(axis.get_view_interval())
        slack = 1e-9 * (high - low)
        for tick in axis.get_major_ticks():
            if not low - slack <= tick.get_loc() <= high + slack:
                found = [text for text in found if text not in (tick.label1, tick.label2)]
    return found


@pytest.mark.parametrize("name", RUNS)
def test_a_sheet_can_be_made_of_every_run(name: str):
    figure = sheet(name)
    assert figure.get_figwidth() == DOUBLE_COLUMN
    labels = [text for ax in figure.axes for text in (ax.get_xlabel(), ax.get_ylabel()) if text]
    assert set(labels) == set(LABELS)


@pytest.mark.parametrize("name", RUNS)
def test_no_text_of_a_sheet_lies_on_another_or_outside(name: str):
    figure = sheet(name)
    boxes = {text: text.get_window_extent() for text in texts(figure)}
    page = figure.bbox
    for text, box in boxes.items():
        inside = box.x0 >= page.x0 and box.x1 <= page.x1 and box.y0 >= page.y0 and box.y1 <= page.y1
        assert inside, text.get_text()
    for one, other in combinations(boxes, 2):
        a, b = boxes[one], boxes[other]
        apart = min(a.x1, b.x1) - max(a.x0, b.x0) <= 1.0 or min(a.y1, b.y1) - max(a.y0, b.y0) <= 1.0
        assert apart, (one.get_text(), other.get_text())


@pytest.mark.parametrize("name", RUNS)
def test_all_text_is_8_or_9_points(name: str):
    assert {text.get_fontsize() for text in texts(sheet(name))} <= {8.0, 9.0}


def test_the_speed_is_shown_with_its_mean_and_the_measured(ax: Axes):
    trial = run("lateral")
    assert plot_speed(trial, ax) is ax
    lines = {line.get_label(): line for line in ax.get_lines()}
    assert set(lines) == {"forward", "mean over a cycle", "measured, 0.151 m/s"}
    late = np.asarray(lines["mean over a cycle"].get_ydata())[-100:]
    np.testing.assert_allclose(late, trial.steady_velocity, rtol=1e-6)
    assert lines["measured, 0.151 m/s"].get_ydata()[0] == 0.1514


@pytest.mark.parametrize(
    ("name", "labels"), [("curve", {"forward", "mean over a cycle"}), ("tiny", {"forward"})]
)
def test_what_there_is_not_is_not_shown(ax: Axes, name: str, labels: set[str]):
    plot_speed(run(name), ax)
    shown = {line.get_label() for line in ax.get_lines()}
    assert {label for label in shown if not label.startswith("measured")} == labels


@pytest.mark.parametrize(
    ("figure", "name"), [(plot_joint_angle, "joint_angle"), (plot_joint_torque, "joint_torque")]
)
def test_every_joint_has_a_line_and_a_place_on_the_labeled_scale(ax: Axes, figure, name: str):
    trial = run("lateral")
    assert figure(trial, ax) is ax
    (lines,) = [found for found in ax.collections if isinstance(found, LineCollection)]
    drawn = np.array([path.vertices[:, 1] for path in lines.get_paths()]).T
    factor = 180.0 / np.pi if name == "joint_angle" else 1.0
    np.testing.assert_allclose(drawn, factor * getattr(trial, name))
    (scale,) = [other for other in ax.get_figure().axes if other is not ax]
    assert scale.get_title(loc="left") == "joint"
    assert [text.get_text() for text in scale.get_yticklabels()] == ["0 (tail)", "7 (head)"]


@pytest.mark.parametrize("plot", [plot_joint_angle, plot_joint_torque])
def test_what_was_not_measured_is_not_drawn_as_zeros(ax: Axes, plot):
    trial = run("lateral")
    series = {name: getattr(trial, name) for name in ("time", "center_of_mass")}
    series["center_of_mass_velocity"] = trial.center_of_mass_velocity
    plot(lc.Trial.measured(series, scenario=trial.scenario, version="1"), ax)
    assert not ax.collections and not ax.lines
    assert [text.get_text() for text in ax.texts] == ["not measured"]


def test_only_the_end_of_a_run_can_be_shown(ax: Axes):
    plot_joint_torque(run("lateral"), ax, last=5.0, scale=False)
    assert ax.get_xlim() == pytest.approx((25.0, 30.0))
    assert ax.get_figure().axes == [ax]


def test_the_times_beside_the_postures_are_those_of_the_run():
    figure = sheet("lateral")
    told = [text.get_text() for text in figure.axes[0].findobj(Annotation)]
    assert told == ["0 s", "15 s", "30 s"]


def test_figures_touch_nothing_global():
    before = dict(mpl.rcParams)
    swim_sheet(run("lateral"))
    assert dict(mpl.rcParams) == before
    code = "import sys, laticauda.show.figures; sys.exit('matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


def test_figures_can_be_made_in_several_threads(tmp_path: Path):
    names = ["lateral", "curve"]
    trials = [run(name) for name in names]

    def draw(i: int) -> bytes:
        path = tmp_path / f"{i}.png"
        save_figure(swim_sheet(trials[i % len(names)]), path)
        return path.read_bytes()

    with ThreadPoolExecutor(4) as pool:
        pictures = list(pool.map(draw, range(4)))
    assert pictures == 2 * [draw(i) for i in range(2)]


@pytest.mark.parametrize("suffix", [".png", ".pdf"])
def test_the_same_run_gives_the_same_file(tmp_path: Path, suffix: str):
    for name in ("a", "b"):
        save_figure(swim_sheet(run("lateral")), (tmp_path / name).with_suffix(suffix))
    assert (tmp_path / "a").with_suffix(suffix).read_bytes() == (tmp_path / "b").with_suffix(
        suffix
    ).read_bytes()


def test_the_marks_of_a_loop_are_median_99_9_percent_and_largest(ax):
    plot_timing(ax, np.linspace(0.001, 0.02, 1000), 0.01, "latency")
    marks = [text.get_text() for text in ax.texts]
    assert "median 10.50" in marks
    assert "largest 20.00" in marks
    assert any(text.startswith("99.9 % 19.98") for text in marks)
    assert ax.get_xlabel() == "latency [ms]"
