"""The efficiency study for readers: tables, figures, and values in its chapter of the report."""

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from laticauda.paper.efficiency import EfficiencyStudy, Maximum, SweepResult, find_maxima
from laticauda.paper.fin_effect import find_fin_gains, find_velocity_gains
from laticauda.paper.measured import percent_change
from laticauda.paper.repeats import Repeat
from laticauda.paper.report.chapter import build_paper_chapter
from laticauda.paper.report.columns import build_row, convert_to_degrees
from laticauda.paper.report.shared_rows import (
    build_error_rows,
    build_fin_row,
    list_misprinted_changes,
)
from laticauda.paper.scores import find_best_null, score_study
from laticauda.paper.settings import Group, SweepSettings
from laticauda.show.reports import Chapter, ReportFigure, Row

if TYPE_CHECKING:
    from laticauda.paper.figures import Panel

NEAR = math.radians(5.0)
"""Tolerance about the measured maximum, without the margin for rounding [rad, rad/s]."""
_ROUNDING = 1e-9
"""Margin for rounding [rad, rad/s]."""


def build_efficiency_chapter(study: EfficiencyStudy, repeats: Sequence[Repeat] = ()) -> Chapter:
    """Return the study's contribution to the folder and the report.

    Args:
        study: Result of `run_efficiency`.
        repeats: Repeated trials to draw next to the paper's (`load_repeats`).
    """
    return build_paper_chapter(
        name="efficiency",
        values={"study": study, "repeats": repeats, **_collect_values(study, repeats)},
        tables=_build_tables(study, repeats),
        n_figures=sum(len(group.figures) for group in study.settings.groups),
        figures=lambda: draw_efficiency_figures(study, repeats),
    )


def _collect_values(study: EfficiencyStudy, repeats: Sequence[Repeat]) -> dict[str, Any]:
    """Return the values used in the sentences of the chapter."""
    scores = score_study(study)
    maxima = find_maxima(study)
    models = range(len(study.models))
    return {
        "physical": [score for score in scores if not score.is_null],
        "best": find_best_null(scores),
        "n_maxima": len(maxima),
        "n_near": [_count_near(maxima, model) for model in models],
        "n_at_end": [_count_at_the_end(maxima, model) for model in models],
        "fin": {
            kind: gains for kind, gains in find_velocity_gains(study).items() if gains.measured
        },
        "misprinted": list_misprinted_changes(find_fin_gains(study.cases)),
        "n_repeats_shown": sum(_is_shown_in_any_panel(repeat, study) for repeat in repeats),
    }


def _count_near(maxima: Sequence[Maximum], model: int) -> int:
    """Return the number of simulated maxima near the measured ones."""
    return sum(maximum.distance(model) <= NEAR + _ROUNDING for maximum in maxima)


def _count_at_the_end(maxima: Sequence[Maximum], model: int) -> int:
    """Return the number of simulated maxima at the end of their range."""
    return sum(maximum.at_the_end[model] for maximum in maxima)


# ---- tables --------------------------------------------------------------------------------------


def _build_tables(study: EfficiencyStudy, repeats: Sequence[Repeat]) -> dict[str, list[Row]]:
    """Return all tables of the study, by name."""
    titles = {model.name: f"{model.name}: {model.title}" for model in study.settings.models}
    tables = {
        "table1": _build_table1(study),
        "table1-maxima": _build_maxima_table(study),
        "fin-gain": _build_fin_table(study),
        "errors": build_error_rows(study, "numbers fitted here", titles),
        "sweeps": _build_sweeps_table(study),
    }
    if repeats:
        tables["repeats"] = [build_row("repeats", repeat) for repeat in repeats]
    return tables


def _build_table1(study: EfficiencyStudy) -> list[Row]:
    rows: list[Row] = []
    for case in study.cases:
        measured_velocity = case.measured.forward_velocity
        row = build_row("table1", case)
        for index, model in enumerate(study.models):
            velocity = case.forward_velocity[index]
            error = None
            if measured_velocity is not None:
                error = percent_change(measured_velocity, velocity)
            row[f"{model}: v [m/s]"] = velocity
            row[f"{model}: error [%]"] = error
            row[f"{model}: mechanical power [W]"] = case.mechanical_power[index]
        rows.append(row)
    return rows


def _build_maxima_table(study: EfficiencyStudy) -> list[Row]:
    rows: list[Row] = []
    for maximum in find_maxima(study):
        row = build_row("maxima", maximum)
        for index, model in enumerate(study.models):
            fastest_at = convert_to_degrees(maximum.simulated_at[index])
            row[f"{model}: fastest at [deg, deg/s]"] = fastest_at
            row[f"{model}: at the end of the range"] = maximum.at_the_end[index]
            row[f"{model}: v [m/s]"] = maximum.simulated_velocity[index]
        rows.append(row)
    return rows


def _build_fin_table(study: EfficiencyStudy) -> list[Row]:
    rows: list[Row] = []
    for gain in find_fin_gains(study.cases):
        simulated: Row = {}
        for index, model in enumerate(study.models):
            simulated[f"{model}: v [%]"] = percent_change(
                gain.without.forward_velocity[index], gain.with_fin.forward_velocity[index]
            )
        row = build_fin_row(
            gain.measured,
            setting=build_row("setting", gain.with_fin.measured.gait),
            velocity=simulated,
            power={},
        )
        rows.append(row)
    return rows


def _build_sweeps_table(study: EfficiencyStudy) -> list[Row]:
    rows: list[Row] = []
    for sweep in study.sweeps:
        for group_index, group in enumerate(study.settings.groups):
            for model_index, model in enumerate(study.models):
                for value_index, value in enumerate(sweep.values):
                    point = (model_index, group_index, value_index)
                    row: Row = {
                        "model": model,
                        "group": group.name,
                        "over": sweep.settings.parameter.replace("_", " "),
                        "value [deg, deg/s]": convert_to_degrees(float(value)),
                        "v [m/s]": sweep.forward_velocity[point],
                        "steady v [m/s]": sweep.steady_velocity[point],
                        "mechanical power [W]": sweep.mechanical_power[point],
                    }
                    rows.append(row)
    return rows


# ---- figures -------------------------------------------------------------------------------------


def draw_efficiency_figures(
    study: EfficiencyStudy, repeats: Sequence[Repeat] = ()
) -> Iterator[ReportFigure]:
    """Yield the study's Figs. 4 to 11 one by one.

    Args:
        study: Result of `run_efficiency`.
        repeats: Repeated trials to draw next to the paper's.
    """
    from laticauda.paper.figures import POWERS, VELOCITY, draw_efficiency_sheet

    axis_labels = {"Forward velocity": VELOCITY, "Power": POWERS}
    for group_index, group in enumerate(study.settings.groups):
        panels = [_build_panel(study, sweep, group_index, repeats) for sweep in study.sweeps]
        for number, subject in zip(group.figures, axis_labels, strict=True):
            title = f"{subject}: {group.name}"
            sheet = draw_efficiency_sheet(panels, title, axis_labels[subject])
            yield ReportFigure(
                name=f"figure-{number:02d}",
                caption=f"{title} (Fig. {number} of the paper).",
                figure=sheet,
            )


def _build_panel(
    study: EfficiencyStudy, sweep: SweepResult, group_index: int, repeats: Sequence[Repeat]
) -> "Panel":
    """Return one panel: curves of a group, and rows and repeated trials that lie on this sweep."""
    from laticauda.paper.figures import Panel

    group = study.settings.groups[group_index]
    rows_on_line = [
        case.measured
        for case in study.cases
        if case.measured.group == group.name and sweep.settings.contains(case.measured.gait)
    ]
    shown_repeats = [repeat for repeat in repeats if _is_shown(repeat, group, sweep.settings)]
    return Panel(
        sweep=sweep.settings,
        labels=tuple(model.title for model in study.settings.models),
        velocity=sweep.forward_velocity[:, group_index],
        power=sweep.mechanical_power[:, group_index],
        measured=tuple(rows_on_line),
        repeats=tuple(shown_repeats),
    )


def _is_shown_in_any_panel(repeat: Repeat, study: EfficiencyStudy) -> bool:
    for group in study.settings.groups:
        for sweep in study.settings.sweeps:
            if _is_shown(repeat, group, sweep):
                return True
    return False


def _is_shown(repeat: Repeat, group: Group, sweep: SweepSettings) -> bool:
    """Return whether repeated trials lie within a panel of this group and sweep."""
    if repeat.group != group.name or not sweep.contains(repeat.gait):
        return False
    value = getattr(repeat.gait, sweep.parameter)
    return sweep.low - _ROUNDING <= value <= sweep.high + _ROUNDING
