"""Chapters about all studies together: the first screen of the report, and the paper's claims."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from laticauda.paper.claims import Claim, find_misprints, load_claims
from laticauda.paper.efficiency import EfficiencyStudy
from laticauda.paper.path_following import PathFollowingStudy
from laticauda.paper.report.chapter import build_paper_chapter
from laticauda.paper.report.columns import build_row
from laticauda.paper.scores import Score, score_study
from laticauda.show.reports import Chapter, ReportFigure, Row

VERDICTS = ("holds", "holds in part", "does not hold", "not tested here")
"""All verdicts, the best first."""
TABLES = {"efficiency": "Table 1", "path_following": "Table 2"}
"""Tables of the paper, by the study that repeats them."""


def _count_verdicts(claims: Sequence[Claim]) -> dict[str, int]:
    """Return the number of claims with each verdict that occurs."""
    counts = Counter(claim.verdict for claim in claims)
    return {verdict: counts[verdict] for verdict in VERDICTS if counts[verdict]}


# ---- the first screen ----------------------------------------------------------------------------


def build_summary_chapter(results: Mapping[str, Any], claims: Sequence[Claim]) -> Chapter:
    """Return the chapter on the first screen of the report.

    Args:
        results: Results of the studies, by their names in `Experiments`.
        claims: Claims judged by these results.
    """
    scores_by_table = {
        table: score_study(results[study]) for study, table in TABLES.items() if study in results
    }
    return build_paper_chapter(
        name="summary",
        values={
            "n_claims": len(claims),
            "counts": _count_verdicts(claims),
            "predictors": scores_by_table,
        },
        n_figures=1,
        figures=lambda: _draw_speeds(scores_by_table),
    )


def _draw_speeds(
    scores_by_table: Mapping[str, Sequence[Score]],
) -> Iterator[ReportFigure]:
    """Yield the figure of the first screen: file name, caption and figure."""
    from laticauda.show.figures import style
    from laticauda.show.reports import draw_parity

    speeds: dict[str, np.ndarray] = {}
    for table, scores in scores_by_table.items():
        for score in _choose_shown(scores):
            short_name = score.name.split(",")[0]
            speeds[f"{table}: {short_name}"] = np.array([score.measured, score.speeds])
    side = 0.55 * style.DOUBLE_COLUMN
    figure = style.new_figure(side, side)
    ax = draw_parity(speeds, figure.subplots(), quantity="forward velocity [m/s]")
    ax.set(ylabel="simulated forward velocity [m/s]")
    style.add_legend(ax, loc="upper left")
    yield ReportFigure(
        name="speeds", caption="Simulated against measured speeds of the robot.", figure=figure
    )


def _choose_shown(scores: Sequence[Score]) -> list[Score]:
    """Return the first simulation, and our first model that is fitted to Table 1, if any."""
    first_simulation, *more_scores = scores
    fitted_models = [score for score in more_scores if score.n_fitted and not score.is_null]
    return [first_simulation, *fitted_models[:1]]


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
        values={"n_claims": len(claims), "counts": _count_verdicts(claims)},
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
