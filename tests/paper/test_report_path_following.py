from dataclasses import replace
from itertools import islice

import numpy as np
import pytest
from paper.reading import cells, said

import laticauda as lc
from laticauda.paper.report.path_following import build_path_following_chapter
from laticauda.show.reports.chapter import write_chapter


def words_of(study) -> str:
    return said(build_path_following_chapter(study))


def kept(following, largest: float, *, but: int | None = None):
    """The same study, with the mean error of the last third as said; 30 cm in one figure."""
    cases = [
        replace(
            case,
            run=replace(
                case.run,
                last_third_largest=0.3 if case.figure == but else largest,
                last_third_rms=0.1,
            ),
        )
        for case in following.cases
    ]
    return replace(following, cases=tuple(cases))


def test_the_chapter_writes_tables_data_and_figures(following, tmp_path):
    one = following.settings.groups[0]
    small = replace(
        following, settings=replace(following.settings, groups=(one,)), cases=following.cases[:3]
    )
    chapter = build_path_following_chapter(small)
    drawn: list[int] = []
    files, html = write_chapter(chapter, tmp_path, drawn.append)
    assert sorted(files) == sorted(file.name for file in tmp_path.iterdir())
    names = ["table2-speeds", "figure-12", "figure-13", "figure-14", "held-out"]
    assert {f"{name}{end}" for name in names for end in (".png", ".pdf")} < set(files)
    assert {
        "figure-12.nc",
        "held-out.nc",
        "table2.csv",
        "following-trials.csv",
        "following-runs.csv",
    } < set(files)
    for name, run in (("figure-13", small.cases[1].trial), ("held-out", small.held_out.trial)):
        assert lc.load_trial(tmp_path / f"{name}.nc").equals(run)
    assert drawn == [1, 2, 3, 4, 5]
    assert chapter.n_figures == 5
    assert build_path_following_chapter(following).n_figures == 14
    assert html.count("<img ") == 5 and ">nan<" not in html


def test_the_section_says_what_was_run(following):
    words = words_of(following)
    for text in (
        "41 runs: the 12 trials of Table 2",
        "look-ahead distance of 0.18 m; heading gain 0.4, offset within ±20 deg, asked for every 0.05 s",
        "18 s or 9 m of progress in x, whichever comes first",
        "p_y positive, that is to the left of the path",
        "prescribed: The joints follow the gait exactly. Time step 0.05 s, smooth start of 1 s, bandwidth 4 and 10",
        "paper-eel (C_f 0.17, C_D 1.75, C_A 1.5",
    ):
        assert text in words


def test_misprints_and_costs_of_the_paper_are_pointed_out(following):
    words = words_of(following)
    for text in (
        "lateral undulation, with fin, case 1, change of power printed +89.04 %, recomputed from the table +89.11 %",
        "eel-like motion, with fin, case 2, change of power printed +94.51 %, recomputed from the table +94.91 %",
        "a meter of eel-like motion takes 574 J without the fin and 591 J with it",
        "per meter the fin does not save energy",
        "mean stride per group, 4 numbers fitted to Table 1): 11.3 %",
        "the fin makes lateral undulation faster by 107 to 122 % as measured",
    ):
        assert text in words


def test_trials_that_do_not_keep_to_the_path_are_named(following):
    assert "within 5 cm over the last third in all 12 trials (at most 4 cm)." in words_of(
        kept(following, 0.04)
    )
    one = words_of(kept(following, 0.04, but=17))
    assert (
        "in 11 of the 12 trials (not in Fig. 17): it is up to 30 cm, with an rms of up to 10 cm."
        in one
    )
    all_of_them = words_of(kept(following, 0.2, but=17))
    assert "in none of the 12 trials: it is up to 30 cm, with an rms of up to 10 cm." in all_of_them


def test_measured_speeds_are_counted_in_the_band_of_the_simulated_ones(following):
    def with_measured(speed_of):
        cases = [
            replace(case, measured=replace(case.measured, forward_velocity=speed_of(i, case)))
            for i, case in enumerate(following.cases)
        ]
        return words_of(replace(following, cases=tuple(cases)))

    def middle(case):
        speeds = [run.forward_velocity for run in case.band]
        return (min(speeds) + max(speeds)) / 2.0

    assert "lies in the band of all 12 trials." in with_measured(lambda i, case: middle(case))
    above = with_measured(lambda i, case: 9.9 if i in (1, 3) else middle(case))
    assert "lies in the band of 10 of the 12 trials; not in that of Figs. 13 and 15." in above
    below = with_measured(lambda i, case: 1e-3)
    assert "lies in the band of none of the 12 trials." in below


def test_a_fin_that_takes_less_energy_per_meter_saves_it(following):
    cheap = [
        replace(case, measured=replace(case.measured, mean_power=1.0))
        if case.group.has_fin
        else case
        for case in following.cases
    ]
    words = words_of(replace(following, cases=tuple(cheap)))
    assert words.count("per meter the fin saves energy") == 2 and "does not save" not in words


def test_trials_that_never_converge_are_counted(following):
    lost = tuple(
        replace(case, run=replace(case.run, figures=dict.fromkeys(case.run.figures)))
        for case in following.cases
    )
    assert "none of the 12 trials converges" in words_of(replace(following, cases=lost))


def test_the_held_out_trial_is_judged_by_the_published_ranges(following):
    held = following.held_out
    words = words_of(following)
    assert "from a heading of \N{MINUS SIGN}88.3 deg and p_y = 1.97 m" in words
    low, high = np.degrees(held.offset)
    assert low > -10.0
    assert f"which is {high - 15.0:.1f} deg above the published range" in words
    within = replace(held, velocity=(0.03, 0.1), mean_velocity=(0.05, 0.17), offset=(-0.1, 0.1))
    words = words_of(replace(following, held_out=within))
    assert (
        "the velocity along the heading is 0.030 to 0.100 m/s, which is within the published range"
        in words
    )
    assert "0.0500 to 0.1700 m/s, which is 0.01 m/s above the published range" in words
    lost = replace(held, run=replace(held.run, figures=dict.fromkeys(held.run.figures)))
    assert "It does not converge." in words_of(replace(following, held_out=lost))


def test_the_tables_hold_the_numbers_of_the_study(following):
    chapter = build_path_following_chapter(following)
    rows = zip(
        cells(chapter, "table2"), cells(chapter, "following-trials"), following.cases, strict=True
    )
    for row, trial, case in rows:
        assert float(row["measured: v [m/s]"]) == case.measured.forward_velocity
        assert float(row["simulated: v [m/s]"]) == pytest.approx(case.run.forward_velocity)
        speeds = [run.forward_velocity for run in case.band]
        assert float(row["band: lowest v [m/s]"]) == pytest.approx(min(speeds))
        assert row["measured v in the band"] == (
            "yes" if min(speeds) <= case.measured.forward_velocity <= max(speeds) else "no"
        )
        assert int(trial["figure"]) == case.figure
        assert float(trial["start: p_y [m]"]) == case.measured.initial_cross_track_error
        assert float(trial["last third: rms error [m]"]) == pytest.approx(case.run.last_third_rms)
        assert (trial["converged after [m]"] == "") == (not case.run.has_come)
    assert len(cells(chapter, "following-runs")) == 12 * 3 + 1
    assert len(cells(chapter, "following-errors")) == 3 + 5


def test_the_change_by_the_loop_is_that_of_the_steady_speeds(following):
    for row, case in zip(
        cells(build_path_following_chapter(following), "following-loop"),
        following.cases,
        strict=True,
    ):
        free, steady = float(row["unsteered: steady v [m/s]"]), float(row["raw: steady v [m/s]"])
        assert free == pytest.approx(case.free_velocity)
        assert float(row["raw: change from unsteered [%]"]) == pytest.approx(
            100.0 * (steady / free - 1.0)
        )


def test_energy_per_meter_is_given_for_every_trial_and_group(following):
    assert len(cells(build_path_following_chapter(following), "following-joules")) == 16


def test_our_own_model_is_drawn_beside_the_papers_coefficients_and_the_measured_speed(beside):
    _, following = beside
    ((_, caption, figure),) = islice(build_path_following_chapter(following).figures(), 1, 2)
    path, error, heading, distance = figure.axes
    case, own_case = following.cases[0], following.own[0].cases[0]
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == [
        f"identified from Table 1, geared servo, speed-servo joints: {own_case.run.forward_velocity:.4f} m/s",
        f"the paper's coefficients, prescribed joints: {case.run.forward_velocity:.4f} m/s",
        f"measured: {case.measured.forward_velocity:.4f} m/s",
        "reference heading of the first",
    ]
    own, paper, measured = distance.lines
    end = paper.get_xydata()[-1]
    assert end[1] / end[0] == pytest.approx(case.run.forward_velocity, rel=1e-6)
    assert own.get_ydata()[-1] != paper.get_ydata()[-1]
    slope = np.divide(*np.diff(measured.get_xydata(), axis=0)[0][::-1])
    assert slope == pytest.approx(case.measured.forward_velocity)
    assert f"Forward velocity [m/s]: measured {case.measured.forward_velocity:.4f}; " in caption
    figure.canvas.draw()
    texts = [figure._suptitle, *figure.legends[0].get_texts()]
    assert all(text.get_window_extent().x1 <= figure.bbox.x1 for text in texts)
    assert [ax.get_title(loc="left") for ax in (path, error, heading, distance)] == [
        "(a)",
        "(b)",
        "(c)",
        "(d)",
    ]


def test_speeds_of_our_own_model_are_marked_in_the_figure_of_all_speeds(beside):
    ((_, caption, figure),) = islice(build_path_following_chapter(beside[1]).figures(), 1)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[1] == "identified from Table 1, geared servo"
    stars = [line.get_xdata()[0] for line in figure.axes[0].lines if line.get_marker() == "*"]
    assert stars == [case.run.forward_velocity for case in beside[1].own[0].cases]
    assert "simulated with identified from Table 1" in caption
