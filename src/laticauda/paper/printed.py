"""What `laticauda reproduce` prints when all is done."""

import json
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from laticauda.cli.tables import aligned, number

if TYPE_CHECKING:
    from laticauda.paper.efficiency import EfficiencyStudy
    from laticauda.paper.following_settings import FollowingGroup
    from laticauda.paper.path_following import PathFollowingStudy
    from laticauda.paper.report.reproduce import Reproduction
    from laticauda.paper.settings import Group


def as_json(done: "Reproduction") -> str:
    """What was run, the errors [%] by predictor, the verdicts, and the files.

    Args:
        done: What was run and written.
    """
    from laticauda.packaging import __version__

    results = done.results
    found: dict[str, Any] = {"status": "All runs reached their end."}
    if results.efficiency is not None:
        found["efficiency"] = _efficiency_errors(results.efficiency)
    if results.path_following is not None:
        found["path_following"] = _following_errors(results.path_following)
    found |= {
        "claims": Counter(claim.verdict for claim in results.claims),
        "output": str(done.folder),
        "files": done.files,
        "version": __version__,
    }
    return json.dumps(found, indent=2, allow_nan=False)


def as_text(done: "Reproduction") -> str:
    """The errors by predictor, the verdicts on the paper's claims, and where the report is.

    Args:
        done: What was run and written.
    """
    results = done.results
    parts: list[str] = []
    if results.efficiency is not None:
        parts += _efficiency_text(results.efficiency)
    if results.path_following is not None:
        parts += _following_text(results.path_following)
    verdicts = Counter(claim.verdict for claim in results.claims)
    counted = ", ".join(f"{verdict} {count}" for verdict, count in verdicts.items())
    parts.append(f"The paper's claims: {counted}.")
    parts.append(f"{len(done.files)} files in {done.folder}; open {done.folder / 'report.html'}")
    return "\n\n".join(parts)


def _efficiency_errors(study: "EfficiencyStudy") -> dict[str, Any]:
    from laticauda.paper.scores import scores

    groups = [group.name for group in study.settings.groups]
    errors = {
        score.name: {
            "numbers_fitted": score.n_fitted,
            "mape_percent": score.overall,
            "mape_percent_by_group": dict(zip(groups, score.by_group, strict=True)),
            "leave_one_out_percent": score.leave_one_out,
            "leave_one_group_out_percent": score.leave_one_group_out,
        }
        for score in scores(study)
    }
    return {"settings": study.how, "n_runs": study.settings.n_runs, "errors": errors}


def _efficiency_text(study: "EfficiencyStudy") -> Iterator[str]:
    from laticauda.paper.scores import scores

    yield (
        f"Locomotion efficiency, {study.settings.n_runs} runs, {study.how['joints']} joints.\n"
        "Mean error of the forward velocity over the measured rows of the paper's Table 1 [%]:"
    )
    rows = [["", "all rows", *map(_head, study.settings.groups), "rows left out"]]
    for score in scores(study):
        left_out = "-" if score.leave_one_out is None else number(score.leave_one_out)
        rows.append([_predictor(score.name, score.n_fitted), *_shares(score.overall, score.by_group), left_out])
    yield aligned(rows, right=range(1, len(rows[0])))


def _following_errors(study: "PathFollowingStudy") -> dict[str, Any]:
    from laticauda.paper.table2 import following_scores

    groups = [group.name for group in study.settings.groups]
    errors = {
        score.name: {
            "numbers_fitted_to_table1": score.n_fitted,
            "mape_percent": score.overall,
            "mape_percent_by_group": dict(zip(groups, score.by_group, strict=True)),
        }
        for score in following_scores(study)
    }
    trials = [
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
    return {"settings": study.how, "errors": errors, "trials": trials}


def _following_text(study: "PathFollowingStudy") -> Iterator[str]:
    from laticauda.paper.table2 import following_scores

    limit = study.settings.accepted_error
    held = sum(case.run.last_third_rms is not None and case.run.last_third_rms < limit for case in study.cases)
    yield (
        f"Path following, {study.how['joints']} joints, offset bandwidth {study.how['offset_bandwidth']:g} rad/s: "
        f"{held} of {len(study.cases)} trials keep the mean\nerror under {100 * limit:g} cm in their last third. "
        "Mean error of the forward velocity over the paper's Table 2 [%]:"
    )
    rows = [["", "all rows", *map(_head, study.settings.groups)]]
    for score in following_scores(study):
        rows.append([_predictor(score.name, score.n_fitted), *_shares(score.overall, score.by_group)])
    yield aligned(rows, right=range(1, len(rows[0])))


def _head(group: "Group | FollowingGroup") -> str:
    """A group's name as short as a terminal likes it."""
    gait = {"lateral_undulation": "lateral", "eel_like": "eel-like"}[group.gait]
    return f"{gait}, fin" if group.has_fin else gait


def _predictor(name: str, n_fitted: int | None) -> str:
    return name if n_fitted is None else f"null model: {name}"


def _shares(overall: float, by_group: Sequence[float]) -> list[str]:
    return [number(overall), *map(number, by_group)]
