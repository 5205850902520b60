"""Chapters about all studies together: the first screen of the report, and the paper's claims."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from laticauda.paper.claims import (
    Claim,
    count_verdicts,
    find_misprints,
    load_claims,
    summarize_verdicts,
)
from laticauda.paper.claims.judge import VERB_FORMS
from laticauda.paper.efficiency import EfficiencyStudy
from laticauda.paper.path_following import PathFollowingStudy
from laticauda.paper.report.chapter import build_paper_chapter
from laticauda.paper.report.columns import build_row
from laticauda.paper.runs import Coefficients
from laticauda.paper.scores import Score, score_study
from laticauda.paper.settings import name_coefficients
from laticauda.show.reports import Chapter, ReportFigure, Row

TABLES = {"efficiency": "Table 1", "path_following": "Table 2"}
"""Tables of the paper, by the study that repeats them."""
LEGEND_HEIGHT = 0.45
"""Height of the legend below the figure of speeds [in]."""
MARKERS = {"Table 1": "o", "Table 2": "D"}
"""Markers of speeds, by table."""


class Predictors(NamedTuple):
    """Predictions of the speeds of one table."""

    name: str
    """Name of the coefficients of the study."""
    simulations: list[Score]
    """Ways to simulate with coefficients from other sources; the first is the chosen one."""
    own: list[Score]
    """Our own models, which are fitted to Table 1."""
    null: Score
    """The best of the models without physics."""


def _collect_predictors(results: Mapping[str, Any]) -> dict[str, Predictors]:
    """Return the predictors of every table that was repeated."""
    predictors: dict[str, Predictors] = {}
    for study_name, table in TABLES.items():
        if study_name not in results:
            continue
        study = results[study_name]
        coefficients = _first_coefficients(study)
        simulations: list[Score] = []
        own: list[Score] = []
        null: list[Score] = []
        for score in score_study(study):
            if score.is_null:
                null.append(score)
            elif score.n_fitted is None:
                simulations.append(score)
            else:
                own.append(score)
        predictors[table] = Predictors(
            name=name_coefficients(coefficients),
            simulations=simulations,
            own=own,
            null=min(null, key=_error_of),
        )
    return predictors


def _first_coefficients(study: EfficiencyStudy | PathFollowingStudy) -> Coefficients:
    if isinstance(study, EfficiencyStudy):
        return study.settings.models[0]
    return study.settings.coefficients


def _error_of(score: Score) -> float:
    return score.overall


# ---- the first screen ----------------------------------------------------------------------------


def build_summary_chapter(
    results: Mapping[str, Any],
    claims: Sequence[Claim],
    own: Mapping[str, Sequence[Claim]] | None = None,
) -> Chapter:
    """Return the chapter on the first screen of the report.

    Args:
        results: Results of the studies, by their names in `Experiments`.
        claims: Claims judged by these results.
        own: Claims judged with other models, by name. None: no others.
    """
    predictors = _collect_predictors(results)
    first = next(iter(predictors.values()))
    claims_of_model = {first.name: claims, **(own or {})}
    counts: dict[str, Any] = {}
    for model, judged_claims in claims_of_model.items():
        title = f"with {model}"
        counts[title] = count_verdicts(judged_claims)
    return build_paper_chapter(
        name="summary",
        values={
            "n_claims": len(claims),
            "counts": counts,
            "verdicts": list(VERB_FORMS),
            "predictors": predictors,
            "error_rows": _list_error_rows(predictors),
        },
        n_figures=1,
        figures=lambda: _draw_speeds(predictors),
    )


class ErrorRow(NamedTuple):
    """Mean errors of one predictor, on the first screen."""

    name: str
    """The predictor."""
    errors: list[float | None]
    """Mean error by table; None if it does not predict it [%]."""


def _list_error_rows(predictors: Mapping[str, Predictors]) -> list[ErrorRow]:
    """Return the errors of our first model, of the first coefficients, and of the best formula without physics."""
    tables = [*predictors.values()]
    rows: list[ErrorRow] = []
    for model in _names_of_own_models(tables)[:1]:
        errors = [_find_error(table.own, model) for table in tables]
        rows.append(ErrorRow(name=f"{model}, two numbers fitted to Table 1", errors=errors))
    if all(table.simulations for table in tables):
        chosen: list[float | None] = [table.simulations[0].overall for table in tables]
        rows.append(ErrorRow(name=tables[0].name, errors=chosen))
    null_errors: list[float | None] = []
    for table in tables:
        left_out = table.null.leave_one_out
        null_errors.append(left_out or table.null.overall)
    null_name = "best formula without physics, fitted to Table 1"
    rows.append(ErrorRow(name=null_name, errors=null_errors))
    return rows


def _names_of_own_models(tables: Sequence[Predictors]) -> list[str]:
    names: dict[str, None] = {}
    for table in tables:
        for score in table.own:
            names[_short_name(score)] = None
    return list(names)


def _short_name(score: Score) -> str:
    """Return the name of a model without the way it was run."""
    return score.name.split(",")[0]


def _find_error(scores: Sequence[Score], model: str) -> float | None:
    for score in scores:
        if _short_name(score) == model:
            return score.overall
    return None


def _draw_speeds(predictors: Mapping[str, Predictors]) -> Iterator[ReportFigure]:
    """Yield the figure of the first screen: file name, caption and figure."""
    from laticauda.show.figures import style
    from laticauda.show.reports import Mark, draw_parity

    speeds: dict[str, np.ndarray] = {}
    marks: list[Mark] = []
    for table, scores in predictors.items():
        for score in scores.simulations[:1]:
            speeds[f"{table}: {scores.name}"] = np.array([score.measured, score.speeds])
            marks.append(Mark(color=style.GRAY, marker=MARKERS[table]))
    for table, scores in predictors.items():
        for score in scores.own[:1]:
            name = _short_name(score)
            speeds[f"{table}: {name}"] = np.array([score.measured, score.speeds])
            marks.append(Mark(color=style.BLUE, marker=MARKERS[table]))
    side = 0.6 * style.DOUBLE_COLUMN
    figure = style.new_figure(side, side + LEGEND_HEIGHT)
    ax = draw_parity(speeds, figure.subplots(), quantity="forward velocity [m/s]", marks=marks)
    ax.set(ylabel="simulated forward velocity [m/s]")
    handles, _ = ax.get_legend_handles_labels()
    style.outside_legend(
        figure, handles, "outside lower center", ncols=2, handlelength=1.2, columnspacing=1.0
    )
    yield ReportFigure(
        name="speeds", caption="Simulated against measured speeds of the robot.", figure=figure
    )


def build_trust_chapter(results: Mapping[str, Any]) -> Chapter:
    """Return the chapter on what to make of the first screen.

    Args:
        results: Results of the studies, by their names in `Experiments`.
    """
    return build_paper_chapter(name="trust", values={"predictors": _collect_predictors(results)})


# ---- claims --------------------------------------------------------------------------------------


def judge_with_own_models(results: Mapping[str, Any]) -> dict[str, tuple[Claim, ...]]:
    """Judge the claims with each of the project's own models in place of the paper's coefficients.

    Args:
        results: Results of the studies, by their names in `Experiments`; the side trials are not
            run with these models.
    """
    studies_of_model: dict[str, list[Any]] = {}
    for study in results.values():
        for name, own_study in _list_own_studies(study):
            studies_of_model.setdefault(name, []).append(own_study)
    return {name: load_claims(*studies) for name, studies in studies_of_model.items()}


def _list_own_studies(study: Any) -> list[tuple[str, Any]]:
    """Return a study as if each of our own models were the one to judge, with its name."""
    if isinstance(study, EfficiencyStudy):
        return [
            (model.name, replace(study, judged=index))
            for index, model in enumerate(study.settings.models)
            if model.n_fitted is not None
        ]
    if isinstance(study, PathFollowingStudy):
        return [(own_study.settings.coefficients.name, own_study) for own_study in study.own]
    return []


def build_claims_chapter(
    claims: Sequence[Claim], own: Mapping[str, Sequence[Claim]] | None = None
) -> Chapter:
    """Return the claims' contribution to the folder and the report.

    Args:
        claims: Result of `laticauda.paper.claims.load_claims`.
        own: Claims judged with other models, by name; their verdicts come before those of `claims`.
            None: no others.
    """
    rows = [build_row("claims", claim) for claim in claims]
    for model, own_claims in (own or {}).items():
        for row, own_claim in zip(rows, own_claims, strict=True):
            _add_verdict(row, f"with {model}", own_claim)
    return build_paper_chapter(
        name="claims",
        values={"summary": summarize_verdicts(claims), "counts": count_verdicts(claims)},
        tables={
            "claims": rows,
            "misprints": [build_row("misprints", misprint) for misprint in find_misprints()],
        },
    )


def _add_verdict(row: Row, column: str, claim: Claim) -> None:
    """Add a column with another verdict; that with the paper's coefficients stays the last."""
    last_verdict = row.pop("verdict")
    row[column] = claim.verdict
    row["verdict"] = last_verdict
