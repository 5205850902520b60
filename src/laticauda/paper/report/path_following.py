"""The path-following study for readers: tables, figures, and values in its chapter."""

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from laticauda.motion.gaits import GAIT_WORDS
from laticauda.paper.fin_effect import FinGain, find_fin_gains, simulate_band_gains
from laticauda.paper.measured import percent_change
from laticauda.paper.path_following import (
    FollowingCase,
    FollowingRun,
    HeldOutRun,
    PathFollowingStudy,
    group_by_law,
    read_simulated_power,
    read_simulated_velocity,
)
from laticauda.paper.report.chapter import build_paper_chapter
from laticauda.paper.report.columns import build_row
from laticauda.paper.report.shared_rows import (
    build_error_rows,
    build_fin_row,
    list_misprinted_changes,
)
from laticauda.paper.scores import (
    Score,
    compute_meter_costs,
    list_runs_by_way,
    score_null_predictions,
    score_simulations,
)
from laticauda.paper.settings import name_coefficients
from laticauda.show.reports import Chapter, ReportFigure, Row

if TYPE_CHECKING:
    from laticauda.paper.following_figures import ModelRun

SPEEDS = "table2-speeds"
"""Name of the figure of all speeds."""
HELD_OUT = "held-out"
"""Name of the figure and of the file of the held-out trial."""


def build_path_following_chapter(study: PathFollowingStudy) -> Chapter:
    """Return the study's contribution to the folder and the report.

    Args:
        study: Result of `run_path_following`.
    """
    trials = {f"figure-{case.figure:02d}": case.trial for case in study.cases}
    for own_study in study.own[:1]:
        name = own_study.settings.coefficients.name
        trials |= {f"figure-{case.figure:02d}-{name}": case.trial for case in own_study.cases}
    trials[HELD_OUT] = study.held_out.trial
    return build_paper_chapter(
        name="path-following",
        values={
            "study": study,
            **_collect_values(study),
            **_compare_with_published(study.held_out),
        },
        tables=_build_tables(study),
        n_figures=len(study.cases) + 2,
        figures=lambda: draw_path_following_figures(study),
        trials=trials,
    )


# ---- values in sentences -------------------------------------------------------------------------


def _collect_values(study: PathFollowingStudy) -> dict[str, Any]:
    """Return the values used in the sentences of the chapter."""
    settings = study.settings
    cases = study.cases
    first_case = cases[0]
    scores = score_simulations(study)
    gains = find_fin_gains(cases)
    return {
        "n_runs": settings.n_runs(first_case.run.joints, first_case.run.offset_bandwidth),
        "laws": group_by_law(first_case),
        "converged": [case.run.figures for case in cases if case.run.converged],
        "late_errors": [_summarize_late_errors(study, runs) for runs in list_runs_by_way(study)],
        "scores": scores,
        "best": _find_best_null(study),
        "outside_band": [case.figure for case in cases if not case.is_in_band],
        "groups": _describe_groups(study, scores[0]),
        "fin": _describe_fin(gains),
        "misprinted": list_misprinted_changes(gains),
        "costs": _compare_costs(study),
    }


def _find_best_null(study: PathFollowingStudy) -> Score:
    return min(score_null_predictions(study), key=lambda score: score.overall)


def _summarize_late_errors(
    study: PathFollowingStudy, runs: Sequence[FollowingRun]
) -> dict[str, Any]:
    """Return in which trials the cycle-mean error is not small in the last third."""
    figures_outside: list[int] = []
    rms_outside: list[float] = []
    for case, run in zip(study.cases, runs, strict=True):
        largest = run.last_third_largest
        if largest is None or largest > study.settings.accepted_error:
            figures_outside.append(case.figure)
            rms_outside.append(run.last_third_rms or 0.0)
    return {
        "name": runs[0].name,
        "outside": figures_outside,
        "largest": max(run.last_third_largest or 0.0 for run in runs),
        "rms": max(rms_outside, default=0.0),
    }


def _describe_groups(study: PathFollowingStudy, score: Score) -> list[dict[str, Any]]:
    """Return the errors of the speeds of every group, and changes by closing the loop [%]."""
    groups: list[dict[str, Any]] = []
    for group, mean_error in zip(study.settings.groups, score.by_group, strict=True):
        cases = [case for case in study.cases if case.group == group]
        errors = [
            percent_change(case.measured.forward_velocity, case.run.forward_velocity)
            for case in cases
        ]
        changes = {
            "run": _known([case.change_by_the_loop(case.run) for case in cases]),
            "cycle_mean": _known([case.change_by_the_loop(case.cycle_mean) for case in cases]),
        }
        description = {
            "name": cases[0].group.name.replace(",", ""),
            "mean_error": mean_error,
            "errors": errors,
            "swings": [math.degrees(case.run.offset_swing) for case in cases],
            "changes": changes,
        }
        groups.append(description)
    return groups


def _known(values: Sequence[float | None]) -> list[float]:
    return [value for value in values if value is not None]


def _describe_fin(gains: Sequence[FinGain[FollowingCase]]) -> dict[str, Any]:
    """Return by kind of gait how much faster the fin makes the robot [%]."""
    changes_by_kind: dict[str, Any] = {}
    for gain in gains:
        kind = gain.with_fin.group.gait
        changes = changes_by_kind.setdefault(kind, {"measured": [], "simulated": [], "band": []})
        changes["measured"].append(gain.measured.velocity)
        changes["simulated"].append(gain.simulated_change(read_simulated_velocity))
        changes["band"] += simulate_band_gains(gain)
    return changes_by_kind


class GaitCosts(NamedTuple):
    """Measured energy per meter with one gait."""

    gait: str
    """Kind of gait."""
    without: float
    """Without the fin [J/m]."""
    with_fin: float
    """With the fin [J/m]."""


def _compare_costs(study: PathFollowingStudy) -> list[GaitCosts]:
    """Return the measured energy per meter without and with the fin, gait by gait."""
    measured_costs: dict[str, float] = {}
    for group, costs in compute_meter_costs(study).items():
        measured, _ = np.mean(costs, axis=1).tolist()
        measured_costs[group] = measured
    costs_of_gait: dict[str, dict[bool, float]] = {}
    for group in study.settings.groups:
        costs_by_fin = costs_of_gait.setdefault(group.gait, {})
        costs_by_fin[group.has_fin] = measured_costs[group.name]
    return [
        GaitCosts(gait, without=costs_by_fin[False], with_fin=costs_by_fin[True])
        for gait, costs_by_fin in costs_of_gait.items()
        if len(costs_by_fin) == 2
    ]


def _compare_with_published(held_out: HeldOutRun) -> dict[str, Any]:
    """Return by how much the held-out trial exceeds the published ranges [m/s, deg]."""
    published = held_out.settings
    offset = [math.degrees(end) for end in held_out.offset]
    published_offset = [math.degrees(end) for end in published.offset]
    return {
        "velocity_beyond": _measure_excess(held_out.velocity, published.velocity),
        "mean_velocity_beyond": _measure_excess(held_out.mean_velocity, published.velocity),
        "offset": offset,
        "published_offset": published_offset,
        "offset_beyond": _measure_excess(offset, published_offset),
    }


def _measure_excess(ends: Sequence[float], published_ends: Sequence[float]) -> dict[str, float]:
    """Return by how much a range extends beyond a published one, and on which sides."""
    low, high = ends
    published_low, published_high = published_ends
    excess = {"below": published_low - low, "above": high - published_high}
    return {side: distance for side, distance in excess.items() if distance > 0.0}


# ---- figures -------------------------------------------------------------------------------------


def draw_path_following_figures(study: PathFollowingStudy) -> Iterator[ReportFigure]:
    """Yield all figures one by one.

    They are the speeds of all trials, Figs. 12 to 23 and the held-out trial; in all of them our first
    model stands beside the coefficients of the study.

    Args:
        study: Result of `run_path_following`.
    """
    yield _draw_speeds(study)
    for index in range(len(study.cases)):
        yield _draw_case(study, index)
    yield _draw_held_out(study)


def _draw_speeds(study: PathFollowingStudy) -> ReportFigure:
    from laticauda.paper.speed_figures import LabeledSpeeds, draw_speeds_sheet

    best_null = _find_best_null(study)
    title = "Forward velocity in path following (Table 2)"
    chosen = study.cases[0].run.name
    own_speeds: list[LabeledSpeeds] = []
    for own_study in study.own[:1]:
        label = name_coefficients(own_study.settings.coefficients)
        speeds = [case.run.forward_velocity for case in own_study.cases]
        own_speeds.append(LabeledSpeeds(label=label, speeds=speeds))
    own_words = ""
    if own_speeds:
        own_words = f"simulated with {own_speeds[0].label}; "
    name = name_coefficients(study.settings.coefficients)
    caption = (
        f"{title}: measured in the tank; {own_words}simulated with {name} and "
        f"{chosen}, in the other ways of the band, and with the cycle-mean heading; and as the "
        f"null model “{best_null.name}”, fitted to Table 1, predicts it."
    )
    sheet = draw_speeds_sheet(
        study.cases,
        title,
        chosen=f"{name}, as in the figures",
        null=LabeledSpeeds(label=f"without physics: {best_null.name}", speeds=best_null.speeds),
        own=own_speeds,
    )
    return ReportFigure(name=SPEEDS, caption=caption, figure=sheet)


def _model_run(study: PathFollowingStudy, trial_run: FollowingCase | HeldOutRun) -> "ModelRun":
    """Return a trial of a study as it is drawn."""
    from laticauda.paper.following_figures import ModelRun

    coefficients = name_coefficients(study.settings.coefficients)
    return ModelRun(
        label=f"{coefficients}, {trial_run.run.joints} joints",
        trial=trial_run.trial,
        forward_velocity=trial_run.run.forward_velocity,
    )


def _draw_case(study: PathFollowingStudy, index: int) -> ReportFigure:
    """Draw a case with our first model, if there is one, beside the coefficients of the study."""
    from laticauda.paper.following_figures import draw_following_sheet

    case = study.cases[index]
    row = case.measured
    runs: list[ModelRun] = []
    speeds = [f"measured {row.forward_velocity:.4f}"]
    ways: list[str] = []
    for shown_study in (*study.own[:1], study):
        shown_case = shown_study.cases[index]
        name = name_coefficients(shown_study.settings.coefficients)
        runs.append(_model_run(shown_study, shown_case))
        speeds.append(f"{name} {shown_case.run.forward_velocity:.4f}")
        ways.append(f"{name}: {shown_case.run.name}")
    title = f"Path following: {case.group.name}, case {row.case}"
    start = _describe_start(row.initial_cross_track_error, row.initial_heading)
    note = f"Forward velocity [m/s]: {'; '.join(speeds)}"
    sheet = draw_following_sheet(
        runs, title=f"{title}, {start}", measured_velocity=row.forward_velocity
    )
    caption = (
        f"{title} (Fig. {case.figure} of the paper). {note}. Simulated with {'; '.join(ways)}."
    )
    return ReportFigure(name=f"figure-{case.figure:02d}", caption=caption, figure=sheet)


def _draw_held_out(study: PathFollowingStudy) -> ReportFigure:
    from laticauda.paper.following_figures import draw_following_sheet

    published = study.held_out.settings
    start = _describe_start(published.initial_cross_track_error, published.initial_heading)
    gait = GAIT_WORDS[published.gait.kind]
    runs: list[ModelRun] = []
    ways: list[str] = []
    for shown_study in (*study.own[:1], study):
        held_out = shown_study.held_out
        runs.append(_model_run(shown_study, held_out))
        ways.append(f"{name_coefficients(shown_study.settings.coefficients)}: {held_out.run.name}")
    sheet = draw_following_sheet(
        runs,
        title=f"A trial of another publication (2016): {gait}, {published.robot}, {start}",
    )
    caption = (
        "Path following: a trial of another publication (2016), on which no choice here rests. "
        f"Simulated with {'; '.join(ways)}."
    )
    return ReportFigure(name=HELD_OUT, caption=caption, figure=sheet)


def _describe_start(cross_track_error: float, heading: float) -> str:
    degrees = f"{math.degrees(heading):.2f}".replace("-", "\N{MINUS SIGN}")
    return f"from $p_y$ = {cross_track_error:g} m, heading {degrees}°"


# ---- tables --------------------------------------------------------------------------------------


def _build_tables(study: PathFollowingStudy) -> dict[str, list[Row]]:
    """Return all tables of the study, by name."""
    return {
        "following-trials": [_build_trial_row(case) for case in study.cases],
        "table2": [_build_table2_row(case) for case in study.cases],
        "following-loop": [_build_loop_row(case) for case in study.cases],
        "following-errors": build_error_rows(study, "numbers fitted to Table 1", {}),
        "following-fin": [_build_fin_row(gain) for gain in find_fin_gains(study.cases)],
        "following-joules": _build_joules_table(study),
        "following-runs": _build_runs_table(study),
    }


def _build_trial_row(case: FollowingCase) -> Row:
    return {
        **build_row("case", case),
        "figure": case.figure,
        **build_row("start", case),
        **build_row("figures", case.run),
    }


def _build_table2_row(case: FollowingCase) -> Row:
    speeds = [run.forward_velocity for run in case.band]
    error = percent_change(case.measured.forward_velocity, case.run.forward_velocity)
    subject = {"case": case, "error": error, "low": min(speeds), "high": max(speeds)}
    return build_row("case", case) | build_row("start", case) | build_row("table2", subject)


def _build_loop_row(case: FollowingCase) -> Row:
    row = build_row("case", case)
    row["unsteered: steady v [m/s]"] = case.free_velocity
    for heading, run in (("raw", case.run), ("cycle mean", case.cycle_mean)):
        subject = {"run": run, "change": case.change_by_the_loop(run)}
        for title, cell in build_row("loop", subject).items():
            row[f"{heading}: {title}"] = cell
    return row


def _build_fin_row(gain: FinGain[FollowingCase]) -> Row:
    changes_in_band = simulate_band_gains(gain)
    velocity: Row = {
        "simulated: v [%]": gain.simulated_change(read_simulated_velocity),
        "band: lowest [%]": min(changes_in_band),
        "band: highest [%]": max(changes_in_band),
    }
    power: Row = {"simulated: mechanical power [%]": gain.simulated_change(read_simulated_power)}
    return build_fin_row(gain.measured, setting={}, velocity=velocity, power=power)


def _build_joules_table(study: PathFollowingStudy) -> list[Row]:
    rows: list[Row] = []
    for group, costs in compute_meter_costs(study).items():
        for number, (measured, simulated) in enumerate(costs.T.tolist(), start=1):
            rows.append(_build_joules_row(group, f"case {number}", measured, simulated))
        measured, simulated = np.mean(costs, axis=1).tolist()
        rows.append(_build_joules_row(group, "mean", measured, simulated))
    return rows


def _build_joules_row(group: str, trial: str, measured: float, simulated: float) -> Row:
    return {
        "group": group,
        "trial": trial,
        "measured: electrical [J/m]": measured,
        "simulated: mechanical [J/m]": simulated,
    }


def _build_runs_table(study: PathFollowingStudy) -> list[Row]:
    rows: list[Row] = []
    for case in study.cases:
        cells_of_case = build_row("case", case)
        for run in (*case.band, case.cycle_mean):
            rows.append(cells_of_case | _build_run_cells(run))
    held_out: Row = {"group": "held out", "case": 1}
    rows.append(held_out | _build_run_cells(study.held_out.run))
    return rows


def _build_run_cells(run: FollowingRun) -> Row:
    return build_row("runs", run) | build_row("figures", run)
