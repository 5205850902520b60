from dataclasses import replace

import numpy as np
import pytest
from paper.reading import said

from laticauda.paper import StabilitySettings, run_stability
from laticauda.paper.report.stability import stability_chapter
from laticauda.paper.settings import swimmers


@pytest.fixture(scope="module")
def study():
    return run_stability(
        StabilitySettings(
            look_ahead_distances=(0.18, 1.62, 3.24), gains=(0.2, 0.4), raw_gains=(0.4,), swimmers=swimmers()[:2]
        )
    )


def test_the_section_says_what_was_run_and_by_which_rule(study):
    text = said(stability_chapter(study))
    for expected in (
        "18 runs of line of sight",
        "3 look-ahead distances with 2 gains for the mean heading",
        "takes 120 s and begins 0.5 m beside the path",
        "asked for every 0.2 s",
        "below 5 cm",
        "joints: prescribed",
        "Lateral undulation: amplitude 30 deg, frequency 90 deg/s, phase shift 40 deg",
        "mamba (1.62 m) and mamba-fin (2.12 m)",
        "paper-lateral (C_f 0.3",
    ):
        assert expected in text


def test_the_findings_are_computed(study):
    text = said(stability_chapter(study))
    without = study.maps[0]
    error = 100.0 * without.rms[0, 1]
    assert without.behaviors[0][1] == "limit cycle"
    assert (
        f"At the paper's gains (0.18 m, 0.4) with the mean heading: {without.swimmer.name}: limit cycle, {error:.1f} cm"
        in text
    )
    assert f"At the paper's gains (0.18 m, 0.4) with the raw heading: {without.swimmer.name}: settled" in text
    # 3.24 m is two lengths of the bare robot, and less than two of the one with the fin.
    assert (
        "0 of 2 loops that keep it swing in a limit cycle; of the 10 that do not keep it, 8 settle all the same" in text
    )
    assert (
        "The shortest that settles with the mean heading at a gain of 0.4: lateral undulation, without fin 1.62 m"
        in text
    )
    lost = without.forward_velocity[0, 1]
    assert f"those in a limit cycle {lost:.3f} to {lost:.3f} m/s" in text


def test_the_tables_hold_every_point(study):
    tables = stability_chapter(study).tables
    points = tables["stability"]
    assert len(points) == study.settings.n_runs
    found = study.maps[2]
    keys = ["swimmer", "heading", "look-ahead distance [m]", "gain [-]"]
    row = points.set_index(keys).loc[(found.swimmer.name, "mean heading", 1.62, 0.4)]
    assert row["behavior"] == found.behaviors[1][1]
    assert row["rms of the mean error, last third [m]"] == found.rms[1, 1]
    boundary = tables["stability-boundary"].set_index(["swimmer", "heading", "gain [-]"])
    assert tuple(boundary.loc[(found.swimmer.name, "mean heading", 0.4)]) == (1.62, pytest.approx(1.62 / 2.12))


def test_the_figure_shows_every_swimmer(study):
    chapter = stability_chapter(study)
    figures = list(chapter.figures())
    assert len(figures) == chapter.n_figures == 1
    name, caption, figure = figures[0]
    assert name == "stability"
    assert "last third of 120 s" in caption
    titles = [ax.get_title(loc="left") for ax in figure.axes if ax.get_title(loc="left")]
    assert titles == ["(a)  lateral undulation, without fin", "(b)  lateral undulation, with fin"]
    assert chapter.html({name: (caption, b"")}).count("<img ") == 1


def test_maps_without_the_papers_point_say_nothing_about_it(study):
    shifted = replace(study, settings=replace(study.settings, paper=(0.2, 0.4)))
    text = said(stability_chapter(shifted))
    assert "At the paper's gains" not in text
    assert "Rule of thumb" in text
    assert np.isfinite(study.maps[0].rms).all()
