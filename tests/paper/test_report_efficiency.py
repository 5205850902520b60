from dataclasses import replace
from math import radians

import numpy as np
import pytest
from paper.reading import cells, said

import laticauda as lc
from laticauda.paper import Repeat
from laticauda.paper.report.efficiency import build_efficiency_chapter, draw_efficiency_figures
from laticauda.show.reports.chapter import write_chapter


def gait(alpha: float, omega: float, delta: float) -> lc.Gait:
    return lc.lateral_undulation(
        amplitude=radians(alpha), frequency=radians(omega), phase_shift=radians(delta)
    )


REPEATS = (
    # On all three sweeps, on none, beyond the range of one, and with the fin.
    Repeat(
        gait=gait(30, 110, 40),
        has_fin=False,
        forward_velocity=(0.13, 0.14),
        mean_power=(100.0, None),
    ),
    Repeat(gait=gait(33, 97, 40), has_fin=False, forward_velocity=(0.11,), mean_power=(None,)),
    Repeat(gait=gait(60, 110, 40), has_fin=False, forward_velocity=(0.12,), mean_power=(None,)),
    Repeat(
        gait=gait(30, 130, 40), has_fin=True, forward_velocity=(0.2, 0.22), mean_power=(None, None)
    ),
)


def test_the_chapter_writes_data_tables_and_figures(study, tmp_path):
    small = replace(study, settings=replace(study.settings, groups=study.settings.groups[:1]))
    small = replace(
        small, cases=tuple(case for case in study.cases if case.group in small.settings.groups)
    )
    small = replace(small, sweeps=tuple(first_group(sweep) for sweep in study.sweeps))
    chapter = build_efficiency_chapter(small)
    assert chapter.n_figures == 2
    files, html = write_chapter(chapter, tmp_path, lambda done: None)
    assert sorted(files) == sorted(path.name for path in tmp_path.iterdir())
    assert {"sweeps.csv", "table1.csv", "figure-04.png", "figure-08.pdf"} < set(files)
    assert "repeats.csv" not in files
    assert html.count("<img ") == 2 and ">nan<" not in html


def first_group(sweep):
    names = ("forward_velocity", "steady_velocity", "mechanical_power")
    return replace(sweep, **{name: getattr(sweep, name)[:, :1] for name in names})


def test_repeated_trials_are_drawn_where_they_belong(study):
    sheets = {name: figure for name, _, figure in draw_efficiency_figures(study, REPEATS)}
    assert [greens(ax) for ax in sheets["figure-04"].axes] == [[0.13, 0.14]] * 3
    assert [greens(ax) for ax in sheets["figure-05"].axes] == [[], [0.2, 0.22], []]
    assert [greens(ax) for ax in sheets["figure-06"].axes] == [[]] * 3
    labels = [text.get_text() for text in sheets["figure-04"].legends[0].get_texts()]
    assert labels[-2:] == [
        "repeated trials, beside their setting",
        "their mean and standard deviation",
    ]
    plain = next(draw_efficiency_figures(study))[2]
    assert len(plain.legends[0].get_texts()) == len(labels) - 2


def greens(ax) -> list[float]:
    """Values of the repeated trials on some axes, drawn to the right of their setting."""
    from laticauda.paper.figures import REPEATS as COLOR

    drawn = [
        line
        for line in ax.lines
        if line.get_color() == COLOR and line.get_markerfacecolor() == "none"
    ]
    return sorted(float(value) for line in drawn for value in line.get_ydata())


def test_the_report_counts_repeated_trials_and_tells_their_mean(study):
    chapter = build_efficiency_chapter(study, REPEATS)
    assert "6 trials of 4 settings were given. 2 of the settings lie on a sweep" in said(chapter)
    first, *_ = cells(chapter, "repeats")
    assert (first["group"], first["trials"]) == ("lateral undulation, without fin", "2")
    assert (first["electrical power: mean [W]"], first["electrical power: deviation [W]"]) == (
        "100",
        "",
    )
    assert float(first["v: mean [m/s]"]) == pytest.approx(0.135)
    assert float(first["v: deviation [m/s]"]) == pytest.approx(np.std([0.13, 0.14], ddof=1))
    assert "Repeated" not in said(build_efficiency_chapter(study))


def test_coefficients_that_are_no_preset_are_described_too(study):
    own = replace(
        study.settings.models[0],
        waters={"eel_like": replace(lc.load_water("paper-eel"), name="mine")},
    )
    changed = replace(
        study, settings=replace(study.settings, models=(own, study.settings.models[1]))
    )
    assert "mine (C_f 0.17, C_D 1.75, C_A 1.5" in said(build_efficiency_chapter(changed))


def test_errors_maxima_and_the_fin_are_told_from_the_numbers(study):
    words = said(build_efficiency_chapter(study))
    error = study.cases[0].forward_velocity[0] / study.cases[0].measured.forward_velocity - 1.0
    assert float(
        cells(build_efficiency_chapter(study), "table1")[0]["analytical-set: error [%]"]
    ) == pytest.approx(100 * error)
    for text in (
        "Mean error over the 20 measured rows of Table 1: analytical-set 15.7 %",
        "(constant + fin + eel, 3 numbers fitted to these rows) 6.2 %, and 7.3 % for rows left out of its fit",
        "of 12 maxima lie inside their range and within 5 deg or deg/s of the measured ones",
        "The fin makes lateral undulation faster by 47 to 83 % as measured; simulated: analytical-set 20 to 23 %",
        "lateral undulation, with fin, case 3, change of power printed +10.11 %, recomputed from the table +4.79 %",
    ):
        assert text in words


def test_the_tables_of_the_study_have_all_their_rows(study):
    rows = {name: len(table) for name, table in build_efficiency_chapter(study).tables.items()}
    points = sum(sweep.forward_velocity.size for sweep in study.sweeps)
    assert rows == {
        "table1": 22,
        "table1-maxima": 12,
        "fin-gain": 11,
        "errors": 6,
        "sweeps": points,
    }


def test_table_1_as_a_file_is_table_1(study):
    first, *_ = cells(build_efficiency_chapter(study), "table1")
    assert (first["amplitude [deg]"], first["frequency [deg/s]"], first["phase shift [deg]"]) == (
        "30",
        "130",
        "40",
    )
    assert first["measured: v [m/s]"] == "0.1514"
    assert float(first["analytical-set: v [m/s]"]) == pytest.approx(
        study.cases[0].forward_velocity[0]
    )
