"""What `laticauda reproduce` prints when all is done."""

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from laticauda.cli.tables import aligned, number

if TYPE_CHECKING:
    from laticauda.paper.efficiency import EfficiencyStudy
    from laticauda.paper.path_following import PathFollowingStudy
    from laticauda.paper.report.reproduce import Reproduction
    from laticauda.paper.scores import Score

HEADS = {"lateral_undulation": "lateral", "eel_like": "eel-like"}
"""The gaits as short as a terminal likes them."""


def facts_of(done: "Reproduction") -> dict[str, Any]:
    """For JSON: what was run, the errors [%] by predictor, the verdicts, and the files.

    Args:
        done: What was run and written.
    """
    from laticauda.packaging import __version__
    from laticauda.paper.scores import scores

    results = done.results
    found: dict[str, Any] = {"status": "All runs reached their end."}
    if (study := results.efficiency) is not None:
        errors = _errors(study, scores(study), "numbers_fitted", "leave_one_out", "leave_one_group_out")
        found["efficiency"] = {"settings": study.how, "n_runs": study.settings.n_runs, "errors": errors}
    if (study := results.path_following) is not None:
        errors = _errors(study, scores(study), "numbers_fitted_to_table1")
        found["path_following"] = {"settings": study.how, "errors": errors, "trials": _trials(study)}
    return found | {
        "claims": Counter(claim.verdict for claim in results.claims),
        "output": str(done.folder),
        "files": done.files,
        "version": __version__,
    }


def as_text(done: "Reproduction") -> str:
    """The errors by predictor, the verdicts on the paper's claims, and where the report is.

    Args:
        done: What was run and written.
    """
    from laticauda.paper.scores import scores

    results = done.results
    parts: list[str] = []
    if (study := results.efficiency) is not None:
        parts += [
            f"Locomotion efficiency, {study.settings.n_runs} runs, {study.how['joints']} joints.\n"
            "Mean error of the forward velocity over the measured rows of the paper's Table 1 [%]:",
            _table(study, scores(study), "leave_one_out"),
        ]
    if (study := results.path_following) is not None:
        limit = study.settings.accepted_error
        held = sum(case.run.last_third_rms is not None and case.run.last_third_rms < limit for case in study.cases)
        parts += [
            f"Path following, {study.how['joints']} joints, offset bandwidth {study.how['offset_bandwidth']:g} rad/s: "
            f"{held} of {len(study.cases)} trials keep the mean\nerror under {100 * limit:g} cm in their last third. "
            "Mean error of the forward velocity over the paper's Table 2 [%]:",
            _table(study, scores(study)),
        ]
    verdicts = Counter(claim.verdict for claim in results.claims)
    parts.append(f"The paper's claims: {', '.join(f'{verdict} {count}' for verdict, count in verdicts.items())}.")
    parts.append(f"{len(done.files)} files in {done.folder}; open {done.folder / 'report.html'}")
    return "\n\n".join(parts)


def _errors(
    study: "EfficiencyStudy | PathFollowingStudy", found: "Sequence[Score]", fitted: str, *more: str
) -> dict[str, Any]:
    """By predictor: how many numbers are fitted, and its errors."""
    groups = [group.name for group in study.settings.groups]
    return {
        score.name: {
            fitted: score.n_fitted,
            "mape_percent": score.overall,
            "mape_percent_by_group": dict(zip(groups, score.by_group, strict=True)),
            **{f"{name}_percent": getattr(score, name) for name in more},
        }
        for score in found
    }


def _trials(study: "PathFollowingStudy") -> list[dict[str, Any]]:
    return [
        {
            "group": case.group.name,
            "case": case.measured.case,
            "measured_velocity": case.measured.forward_velocity,
            "forward_velocity": case.run.forward_velocity,
            "last_third_rms": case.run.last_third_rms,
            **case.run.figures,
        }
        for case in study.cases
    ]


def _table(study: "EfficiencyStudy | PathFollowingStudy", found: "Sequence[Score]", left_out: str = "") -> str:
    """Errors by predictor, a line each."""
    heads = [f"{HEADS[group.gait]}, fin" if group.has_fin else HEADS[group.gait] for group in study.settings.groups]
    rows = [["", "all rows", *heads, *(["rows left out"] if left_out else [])]]
    for score in found:
        name = score.name if score.n_fitted is None else f"null model: {score.name}"
        values = [score.overall, *score.by_group, *([getattr(score, left_out)] if left_out else [])]
        rows.append([name, *("-" if value is None else number(value) for value in values)])
    return aligned(rows, right=range(1, len(rows[0])))
