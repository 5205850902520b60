from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.figures import new_figure
from laticauda.paper.report.beyond import mean_errors, runs_sheet
from laticauda.trial.cycles import CycleMean

LINES = {
    "one": CycleMean(np.array([2.0, 3.0, 9.0]), np.array([0.1, 0.2, 0.3])),
    "other": CycleMean(np.array([2.0, 3.0, 11.0]), np.array([0.1, -0.2, 0.0])),
}


@pytest.fixture(scope="module")
def followed():
    controller = lc.PathFollowing(
        gait=lc.lateral_undulation(amplitude=np.deg2rad(30), frequency=np.deg2rad(90), phase_shift=np.deg2rad(40)),
        path=lc.StraightLine(),
        guidance=lc.LineOfSight(look_ahead_distance=0.5),
        heading=lc.HeadingController(gain=0.3, max_offset=np.deg2rad(20)),
        interval=0.2,
    )
    water = replace(lc.load_water("paper-lateral"), current=(0.0, 0.03))
    return lc.run(lc.plant(lc.load_robot("mamba-fin"), water), controller, 40.0)


def test_errors_are_drawn_with_their_band():
    ax = new_figure(4, 2).subplots()
    assert mean_errors(LINES, ax, xlabel="time [s]", tolerance=0.05) is ax
    drawn = [line for line in ax.lines if line.get_label() in ("one", "other")]
    assert [line.get_ydata().tolist() for line in drawn] == [[0.1, 0.2, 0.3], [0.1, -0.2, 0.0]]
    assert drawn[0].get_linestyle() != drawn[1].get_linestyle()
    assert ax.get_xlim() == (0.0, 11.0)
    assert ax.patches[0].get_label() == "\N{PLUS-MINUS SIGN}5 cm"
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("time [s]", "mean cross-track\nerror [m]")


def test_no_tolerance_no_band():
    ax = new_figure(4, 2).subplots()
    mean_errors({"one": LINES["one"]}, ax, xlabel="time [s]")
    assert not ax.patches
    assert ax.get_xlim() == (0.0, 9.0)


def test_the_sheet_shows_every_way_with_its_path_and_the_errors_below(followed):
    runs = {name: (followed, error) for name, error in (*LINES.items(), ("third", LINES["one"]))}
    figure = runs_sheet(runs, "Runs", xlabel="time [s]", tolerance=0.05)
    figure.canvas.draw()  # warnings of the layout are errors
    ways, below = figure.axes[:2], figure.axes[2]
    assert [ax.get_title(loc="left") for ax in ways] == ["(a)  one", "(b)  other"]
    assert [ax.get_xlabel() for ax in ways] == ["", "x [m]"]
    assert below.get_title(loc="left") == "(c)"
    assert below.get_xlabel() == "time [s]"
    assert {text.get_text() for text in figure.legends[0].get_texts()} == {
        "\N{PLUS-MINUS SIGN}5 cm",
        "one",
        "other",
        "third",
    }
    for ax in ways:
        assert any("current 0.03 m/s" in text.get_text() for text in ax.texts)
