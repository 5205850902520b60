import re
from collections import Counter
from dataclasses import replace

from paper.reading import cells, said

from laticauda.paper.claims import find_misprints, load_claims, summarize_verdicts
from laticauda.paper.claims.judge import VERB_FORMS
from laticauda.paper.report.overview import (
    build_claims_chapter,
    build_summary_chapter,
    build_trust_chapter,
    judge_with_own_models,
)
from laticauda.paper.scores import score_study
from laticauda.show.reports.chapter import Picture

CURVES = ("forward_velocity", "mechanical_power", "steady_velocity")


def test_the_tables_hold_every_claim_and_every_misprint(study):
    found = load_claims(study)
    chapter = build_claims_chapter(found)
    rows = cells(chapter, "claims")
    assert [row["verdict"] for row in rows] == [claim.verdict for claim in found]
    assert rows[0]["the paper says"] == found[0].paper
    assert rows[0]["here"] == found[0].evidence
    assert [row["printed"] for row in cells(chapter, "misprints")] == [
        one.printed for one in find_misprints()
    ]


def test_the_chapter_counts_the_verdicts(study):
    found = load_claims(study)
    text = said(build_claims_chapter(found))
    assert f"conclusions: {summarize_verdicts(found)}." in text
    counts = Counter(claim.verdict for claim in found)
    assert f"{counts['holds in part']} hold in part" in text
    assert " 0 hold" not in text


def test_the_verdicts_are_counted_in_a_sentence(study):
    claim = load_claims(study)[0]
    verdicts = ("does not hold", "holds", "does not hold", "holds in part")
    claims = [replace(claim, verdict=verdict) for verdict in verdicts]
    words = "1 of 4 claims holds, 1 holds in part, 2 do not hold"
    assert summarize_verdicts(claims) == words
    assert summarize_verdicts(claims[1:2]) == "1 of 1 claims holds"


def test_every_row_is_marked_by_its_verdict_and_each_verdict_can_be_shown_alone(study):
    found = load_claims(study)
    html = build_claims_chapter(found).html({})
    assert re.findall(r'<tr data-mark="([^"]*)">', html) == [claim.verdict for claim in found]
    shown = re.findall(r'<input type="radio" name="verdict" value="([^"]*)"', html)
    assert shown == [
        "",
        *(name for name in VERB_FORMS if name in {claim.verdict for claim in found}),
    ]


def test_the_first_screen_has_one_result_and_the_verdicts_of_all_models(beside):
    results = {"efficiency": beside[0], "path_following": beside[1]}
    judged, own = load_claims(*beside), judge_with_own_models(results)
    chapter = build_summary_chapter(results, judged, own)
    ((name, caption, figure),) = chapter.figures()
    assert name == "speeds"
    shown = [len(line.get_xdata()) for line in figure.axes[0].lines if line.get_marker() != "None"]
    n_measured, n_followed = len(beside[0].measured), len(beside[1].cases)
    assert shown == [n_measured, n_followed, n_measured, n_followed]
    words = chapter.html({name: Picture(caption, b"")})
    own_errors = [score for score in score_study(beside[1]) if score.n_fitted and not score.is_null]
    assert f"<b>{own_errors[0].overall:.1f} %</b> on average" in words
    counts = Counter(claim.verdict for claim in own["mamba-identified"])
    for model, verdict, count in (
        ("the paper&#39;s coefficients", "holds", Counter(one.verdict for one in judged)["holds"]),
        ("mamba-identified", "holds", counts["holds"]),
    ):
        assert f'<td class="w">with {model}</td><td class="n">{count}</td>' in words, verdict
    for caveat in ("electrical", "physics (", "A verdict applies"):
        assert caveat not in words


def test_the_legend_of_the_first_figure_covers_no_point(beside):
    results = {"efficiency": beside[0], "path_following": beside[1]}
    ((_, _, figure),) = build_summary_chapter(results, load_claims(*beside)).figures()
    figure.canvas.draw()
    (legend,) = figure.legends
    assert not legend.get_window_extent().overlaps(figure.axes[0].get_window_extent())
    assert all(figure.bbox.x0 <= text.get_window_extent().x0 for text in legend.get_texts())
    assert all(text.get_window_extent().x1 <= figure.bbox.x1 for text in legend.get_texts())


def test_without_models_of_our_own_the_result_is_that_of_the_coefficients(study, following):
    results = {"efficiency": study, "path_following": following}
    bare = replace(study, settings=replace(study.settings, models=study.settings.models[:1]))
    for shown in (results, {"efficiency": bare}):
        text = said(build_summary_chapter(shown, load_claims(study)))
        error = score_study(study)[0].overall
        assert f"the speeds of Table 1 are off by {error:.1f} % on average" in text


def test_what_to_trust_says_the_errors_beside_those_of_a_formula_without_physics(study, following):
    text = said(build_trust_chapter({"efficiency": study, "path_following": following}))
    for table, done in (("Table 1", study), ("Table 2", following)):
        first = score_study(done)[0]
        null = min((one for one in score_study(done) if one.is_null), key=lambda one: one.overall)
        start = (
            f"{table}: with the paper's coefficients ({first.name}) the simulated speeds are off by"
        )
        assert f"{start} {first.overall:.1f} % on average" in text
        assert (
            f"({null.name}, {null.n_fitted} numbers fitted to Table 1) is off by {null.overall:.1f} %"
            in text
        )


def test_what_to_trust_says_whether_the_simulation_beats_the_formula_without_physics(study):
    cases = [
        replace(case, forward_velocity=(case.measured.forward_velocity or 1.0,) * 2)
        for case in study.cases
    ]
    perfect = replace(study, cases=tuple(cases))
    for one, sentence in (
        (perfect, "the simulation is the closer of the two."),
        (study, "so these speeds are no evidence for the coefficients."),
    ):
        assert sentence in said(build_trust_chapter({"efficiency": one}))


def test_long_texts_break_into_lines_on_the_page_and_verdicts_do_not(study):
    html = build_claims_chapter(load_claims(study)).html({})
    assert '<td class="w">At the same setting' in html
    assert "<td>holds in part</td>" in html


def test_each_of_our_own_models_has_a_column_of_verdicts_and_the_last_is_the_papers(beside):
    results = {"efficiency": beside[0], "path_following": beside[1]}
    found, own = load_claims(*beside), judge_with_own_models(results)
    assert list(own) == ["mamba-identified"]
    assert own["mamba-identified"] == load_claims(replace(beside[0], judged=1), *beside[1].own)
    rows = cells(build_claims_chapter(found, own), "claims")
    assert [*rows[0]][-2:] == ["with mamba-identified", "verdict"]
    assert [row["verdict"] for row in rows] == [claim.verdict for claim in found]
    assert [row["with mamba-identified"] for row in rows] == [
        claim.verdict for claim in own["mamba-identified"]
    ]
    alone = replace(beside[0].settings, models=beside[0].settings.models[1:])
    sweeps = [{name: getattr(one, name)[1:] for name in CURVES} for one in beside[0].sweeps]
    cases = [{name: getattr(one, name)[1:] for name in CURVES[:2]} for one in beside[0].cases]
    first = replace(
        beside[0],
        settings=alone,
        sweeps=tuple(
            replace(one, **part) for one, part in zip(beside[0].sweeps, sweeps, strict=True)
        ),
        cases=tuple(replace(one, **part) for one, part in zip(beside[0].cases, cases, strict=True)),
    )
    judged = load_claims(replace(beside[0], judged=1))
    assert [claim.verdict for claim in load_claims(first)] == [claim.verdict for claim in judged]


def test_what_to_trust_names_our_own_models_apart_from_those_without_physics(beside):
    text = said(build_trust_chapter({"efficiency": beside[0], "path_following": beside[1]}))
    words = (
        "Our own models, with two numbers fitted to Table 1, are off by 5.0 % (mamba-identified)."
    )
    assert words in text
    assert "A formula without any physics (constant per group" in text
