"""The efficiency study for readers: its tables, its figures, and the values in its chapter of the report."""

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from laticauda.paper.claims.quantities import best_null, fin_by_gait
from laticauda.paper.efficiency import EfficiencyStudy, Repeat, SweepResult, maxima
from laticauda.paper.measured import percent_change
from laticauda.paper.report.chapter import (
    build_row,
    convert_to_degrees,
    error_rows,
    fin_row,
    misprinted,
    paper_chapter,
)
from laticauda.paper.scores import fin_gains, score_study
from laticauda.paper.settings import Group, SweepSettings
from laticauda.show.reports.chapter import Chapter, Row

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from laticauda.paper.figures import Panel

NEAR = math.radians(
    5.0
)  # tolerance about the measured maximum, without the margin for rounding [rad, rad/s]


def efficiency_chapter(study: EfficiencyStudy, repeats: Sequence[Repeat] = ()) -> Chapter:
    """Return the study's contribution to the folder and the report.

    Args:
        study: Result of `run_efficiency`.
        repeats: Repeated trials to draw next to the paper's (`load_repeats`).
    """
    return paper_chapter(
        name="efficiency",
        values={"study": study, "repeats": repeats, **_findings(study, repeats)},
        tables=_tables(study, repeats),
        n_figures=sum(len(group.figures) for group in study.settings.groups),
        figures=lambda: efficiency_figures(study, repeats),
    )


def _findings(study: EfficiencyStudy, repeats: Sequence[Repeat]) -> dict[str, Any]:
    """Return the values used in the sentences of the chapter."""
    found, gains, starred, models = (
        score_study(study),
        fin_gains(study.cases),
        maxima(study),
        range(len(study.models)),
    )
    sweeps, groups = study.settings.sweeps, study.settings.groups
    return {
        "physical": [score for score in found if not score.is_null],
        "best": best_null(found),
        "n_maxima": len(starred),
        "n_near": [sum(one.distance(i) <= NEAR + 1e-9 for one in starred) for i in models],
        "n_at_end": [sum(one.at_the_end[i] for one in starred) for i in models],
        "fin": {kind: gain for kind, gain in fin_by_gait(study).items() if gain["measured"]},
        "misprinted": misprinted(gains),
        "n_repeats_shown": sum(
            any(_is_shown(r, g, sweep) for g in groups for sweep in sweeps) for r in repeats
        ),
    }


# ---- tables --------------------------------------------------------------------------------------


def _tables(study: EfficiencyStudy, repeats: Sequence[Repeat]) -> dict[str, list[Row]]:
    """Return all tables of the study, by name."""
    titles = {model.name: f"{model.name}: {model.title}" for model in study.settings.models}
    return {
        "table1": _table1(study),
        "table1-maxima": _maxima(study),
        "fin-gain": _fin(study),
        "errors": error_rows(study, "numbers fitted here", titles),
        "sweeps": _sweeps(study),
        **({"repeats": [build_row("repeats", repeat) for repeat in repeats]} if repeats else {}),
    }


def _table1(study: EfficiencyStudy) -> list[Row]:
    rows: list[Row] = []
    for case in study.cases:
        measured = case.measured.forward_velocity
        found = build_row("table1", case)
        for name, velocity, power in zip(
            study.models, case.forward_velocity, case.mechanical_power, strict=True
        ):
            found[f"{name}: v [m/s]"] = velocity
            found[f"{name}: error [%]"] = (
                None if measured is None else percent_change(measured, velocity)
            )
            found[f"{name}: mechanical power [W]"] = power
        rows.append(found)
    return rows


def _maxima(study: EfficiencyStudy) -> list[Row]:
    rows: list[Row] = []
    for entry in maxima(study):
        found = build_row("maxima", entry)
        for i, name in enumerate(study.models):
            found[f"{name}: fastest at [deg, deg/s]"] = convert_to_degrees(entry.simulated_at[i])
            found[f"{name}: at the end of the range"] = entry.at_the_end[i]
            found[f"{name}: v [m/s]"] = entry.simulated_velocity[i]
        rows.append(found)
    return rows


def _fin(study: EfficiencyStudy) -> list[Row]:
    rows: list[Row] = []
    for gain in fin_gains(study.cases):
        speeds = [
            gain.simulated(lambda case, i=i: case.forward_velocity[i])
            for i in range(len(study.models))
        ]
        simulated = {
            f"{name}: v [%]": speed for name, speed in zip(study.models, speeds, strict=True)
        }
        rows.append(
            fin_row(gain.measured, build_row("setting", gain.with_fin.measured.gait), simulated, {})
        )
    return rows


def _sweeps(study: EfficiencyStudy) -> list[Row]:
    return [
        {
            "model": model,
            "group": group.name,
            "over": sweep.settings.parameter.replace("_", " "),
            "value [deg, deg/s]": convert_to_degrees(float(value)),
            "v [m/s]": sweep.forward_velocity[m, g, i],
            "steady v [m/s]": sweep.steady_velocity[m, g, i],
            "mechanical power [W]": sweep.mechanical_power[m, g, i],
        }
        for sweep in study.sweeps
        for g, group in enumerate(study.settings.groups)
        for m, model in enumerate(study.models)
        for i, value in enumerate(sweep.values)
    ]


# ---- figures -------------------------------------------------------------------------------------


def efficiency_figures(
    study: EfficiencyStudy, repeats: Sequence[Repeat] = ()
) -> Iterator[tuple[str, str, "Figure"]]:
    """Yield the study's Figs. 4 to 11 one by one: file name, caption and figure.

    Args:
        study: Result of `run_efficiency`.
        repeats: Repeated trials to draw next to the paper's.
    """
    from laticauda.paper.figures import POWERS, VELOCITY, efficiency_sheet

    for place, group in enumerate(study.settings.groups):
        panels = [_panel(study, sweep, place, repeats) for sweep in study.sweeps]
        sheets = {"Forward velocity": VELOCITY, "Power": POWERS}
        for number, (what, ylabels) in zip(group.figures, sheets.items(), strict=True):
            title = f"{what}: {group.name}"
            sheet = efficiency_sheet(panels, title, ylabels)
            yield f"figure-{number:02d}", f"{title} (Fig. {number} of the paper).", sheet


def _panel(
    study: EfficiencyStudy, sweep: SweepResult, place: int, repeats: Sequence[Repeat]
) -> "Panel":
    """Return one panel: the curves of one group, and the rows of Table 1 and repeated trials that lie on this sweep."""
    from laticauda.paper.figures import Panel

    group, rows = study.settings.groups[place], [case.measured for case in study.cases]
    on_line = [row for row in rows if row.group == group.name and sweep.settings.contains(row.gait)]
    return Panel(
        sweep=sweep.settings,
        labels=tuple(model.title for model in study.settings.models),
        velocity=sweep.forward_velocity[:, place],
        power=sweep.mechanical_power[:, place],
        measured=tuple(on_line),
        repeats=tuple(repeat for repeat in repeats if _is_shown(repeat, group, sweep.settings)),
    )


def _is_shown(repeat: Repeat, group: Group, sweep: SweepSettings) -> bool:
    """Return whether repeated trials lie within a panel of this group and sweep."""
    within = sweep.low - 1e-9 <= getattr(repeat.gait, sweep.parameter) <= sweep.high + 1e-9
    return repeat.group == group.name and within and sweep.contains(repeat.gait)
