from dataclasses import replace

import numpy as np
import pytest

from laticauda.paper import StabilitySettings, run_stability
from laticauda.paper.report.stability import boundary_table, stability_chapter, stability_table
from laticauda.paper.swimmers import swimmers
from laticauda.reports.page import Paragraph, Picture, Points, page


@pytest.fixture(scope="module")
def study():
    return run_stability(
        StabilitySettings(
            look_ahead_distances=(0.18, 1.62, 3.24), gains=(0.2, 0.4), raw_gains=(0.4,), swimmers=swimmers()[:2]
        )
    )


def words(section) -> str:
    texts = [
        part.texts if isinstance(part, Points) else (part.text,)
        for part in section.parts
        if hasattr(part, "text") or isinstance(part, Points)
    ]
    return " ".join(text for group in texts for text in group)


def test_the_section_says_what_was_run_and_by_which_rule(study):
    said = words(stability_chapter(study).section({}))
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
        assert expected in said


def test_the_findings_are_computed(study):
    said = words(stability_chapter(study).section({}))
    without = study.maps[0]
    error = 100.0 * without.cycle_mean.rms[0, 1]
    assert without.cycle_mean.behaviors[0][1] == "limit cycle"
    assert (
        f"At the paper's gains (0.18 m, 0.4) with the mean heading: {without.swimmer.name}: limit cycle, {error:.1f} cm"
        in said
    )
    assert f"At the paper's gains (0.18 m, 0.4) with the raw heading: {without.swimmer.name}: settled" in said
    # 3.24 m is two lengths of the bare robot, and less than two of the one with the fin.
    assert (
        "0 of 2 loops that keep it swing in a limit cycle; of the 10 that do not keep it, 8 settle all the same" in said
    )
    assert (
        "The shortest that settles with the mean heading at a gain of 0.4: lateral undulation, without fin 1.62 m"
        in said
    )
    lost = without.cycle_mean.forward_velocity[0, 1]
    assert f"those in a limit cycle {lost:.3f} to {lost:.3f} m/s" in said


def test_the_tables_hold_every_point(study):
    table = stability_table(study)
    assert len(table.rows) == study.settings.n_runs
    rows = {row[:4]: row for row in table.rows}
    found = study.maps[1]
    row = rows[found.swimmer.name, "mean heading", 1.62, 0.4]
    assert row[4:6] == (found.cycle_mean.behaviors[1][1], found.cycle_mean.rms[1, 1])
    boundary = {row[:3]: row[3:] for row in boundary_table(study).rows}
    assert boundary[found.swimmer.name, "mean heading", 0.4] == (1.62, pytest.approx(1.62 / 2.12))


def test_the_figure_shows_every_swimmer(study):
    chapter = stability_chapter(study)
    figures = list(chapter.figures())
    assert len(figures) == chapter.n_figures == 1
    name, caption, figure = figures[0]
    assert name == "stability"
    assert "last third of 120 s" in caption
    titles = [ax.get_title(loc="left") for ax in figure.axes if ax.get_title(loc="left")]
    assert titles == ["(a)  lateral undulation, without fin", "(b)  lateral undulation, with fin"]
    section = chapter.section({name: (caption, b"")})
    assert sum(isinstance(part, Picture) for part in section.parts) == 1
    assert isinstance(section.parts[1], Paragraph)
    assert "<h2>Stability of path following</h2>" in page("t", [], [section])


def test_maps_without_the_papers_point_say_nothing_about_it(study):
    shifted = replace(study, settings=replace(study.settings, paper=(0.2, 0.4)))
    said = words(stability_chapter(shifted).section({}))
    assert "At the paper's gains" not in said
    assert "Rule of thumb" in said
    assert np.isfinite(study.maps[0].cycle_mean.rms).all()
