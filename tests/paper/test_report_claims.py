import re
from dataclasses import replace

from paper.reading import cells, said

from laticauda.paper.claims import find_misprints, load_claims
from laticauda.paper.report.overview import (
    VERDICTS,
    build_claims_chapter,
    build_summary_chapter,
    judge_with_own_models,
)
from laticauda.paper.scores import score_study

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
    assert text.startswith(f"{len(found)} statements")
    for verdict in {claim.verdict for claim in found}:
        assert f"{verdict} {sum(claim.verdict == verdict for claim in found)}" in text
    assert "holds 0" not in text


def test_every_row_is_marked_by_its_verdict_and_each_verdict_can_be_shown_alone(study):
    found = load_claims(study)
    html = build_claims_chapter(found).html({})
    assert re.findall(r'<tr data-mark="([^"]*)">', html) == [claim.verdict for claim in found]
    shown = re.findall(r'<input type="radio" name="verdict" value="([^"]*)"', html)
    assert shown == ["", *(name for name in VERDICTS if name in {claim.verdict for claim in found})]


def test_the_first_screen_says_the_errors_beside_those_of_a_model_without_physics(study, following):
    judged = load_claims(study, following)
    chapter = build_summary_chapter({"efficiency": study, "path_following": following}, judged)
    ((name, caption, figure),) = chapter.figures()
    assert name == "speeds"
    shown = [len(line.get_xdata()) for line in figure.axes[0].lines if line.get_marker() != "None"]
    assert shown == [len(study.measured), len(following.cases)]
    text = said(chapter, {name: (caption, b"")})
    for table, done in (("Table 1", study), ("Table 2", following)):
        first = score_study(done)[0]
        null = min(
            (one for one in score_study(done) if one.n_fitted is not None),
            key=lambda one: one.overall,
        )
        assert f"{table}: {first.name} misses the measured speeds by {first.overall:.1f} %" in text
        assert (
            f"({null.name}, {null.n_fitted} numbers fitted to Table 1) by {null.overall:.1f} %"
            in text
        )
    assert f"{len(judged)} claims of the paper" in text


def test_the_first_screen_says_whether_the_simulation_beats_the_model_without_physics(study):
    cases = [
        replace(case, forward_velocity=(case.measured.forward_velocity or 1.0,) * 2)
        for case in study.cases
    ]
    perfect = replace(study, cases=tuple(cases))
    for one, sentence in ((perfect, "tells more than that does"), (study, "do not bear")):
        assert sentence in said(build_summary_chapter({"efficiency": one}, ()))


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


def test_the_first_screen_names_our_own_models_apart_from_those_without_physics(beside):
    results = {"efficiency": beside[0], "path_following": beside[1]}
    text = said(build_summary_chapter(results, load_claims(*beside)))
    assert "Our own models, two numbers fitted to Table 1: mamba-identified 5.0 %." in text
    assert "a model that knows no physics (constant per group" in text
