"""The path-following study for readers: its tables, its figures, and the values in its chapter of the report."""

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.motion.gaits import GAIT_WORDS
from laticauda.paper.claims.quantities import band_gains
from laticauda.paper.measured import percent_change
from laticauda.paper.path_following import (
    FollowingCase,
    FollowingRun,
    HeldOutRun,
    PathFollowingStudy,
    group_by_law,
)
from laticauda.paper.report.chapter import build_row, error_rows, fin_row, misprinted, paper_chapter
from laticauda.paper.scores import (
    FinGain,
    Score,
    fin_gains,
    in_all_ways,
    meter_costs,
    null_predictions,
    score_simulations,
)
from laticauda.show.reports.chapter import Chapter, Row

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SPEEDS, HELD_OUT = "table2-speeds", "held-out"


def path_following_chapter(study: PathFollowingStudy) -> Chapter:
    """Return the study's contribution to the folder and the report.

    Args:
        study: Result of `run_path_following`.
    """
    return paper_chapter(
        name="path-following",
        values={"study": study, **_findings(study), **_beyond_the_published(study.held_out)},
        tables=_tables(study),
        n_figures=len(study.cases) + 2,
        figures=lambda: path_following_figures(study),
        trials={f"figure-{case.figure:02d}": case.trial for case in study.cases}
        | {HELD_OUT: study.held_out.trial},
    )


def _findings(study: PathFollowingStudy) -> dict[str, Any]:
    """Return the values used in the sentences of the chapter."""
    settings, cases, ways, gains = (
        study.settings,
        study.cases,
        score_simulations(study),
        fin_gains(study.cases),
    )
    kinds = dict.fromkeys(gain.with_fin.group.gait for gain in gains)
    by_kind = {kind: [gain for gain in gains if gain.with_fin.group.gait == kind] for kind in kinds}
    return {
        "n_runs": settings.n_runs(cases[0].run.joints, cases[0].run.offset_bandwidth),
        "laws": group_by_law(cases[0]),
        "there": [case.run.figures for case in cases if case.run.converged],
        "kept": [_kept(study, runs) for runs in in_all_ways(study)],
        "errors": ways,
        "best": _best_null(study),
        "outside_band": [case.figure for case in cases if not case.is_in_band],
        "groups": [
            _group(score, [case for case in cases if case.group == group])
            for group, score in zip(settings.groups, ways[0].by_group, strict=True)
        ],
        "fin": {
            kind: {
                "measured": [gain.measured.velocity for gain in here],
                "simulated": [
                    gain.simulated(lambda case: case.run.forward_velocity) for gain in here
                ],
                "band": [change for gain in here for change in band_gains(gain)],
            }
            for kind, here in by_kind.items()
        },
        "misprinted": misprinted(gains),
        "costs": [*_costs(study)],
    }


def _kept(study: PathFollowingStudy, runs: Sequence[FollowingRun]) -> dict[str, Any]:
    """Return in which trials the cycle-mean error does not stay small in the last third, and how large it is."""
    outside = [
        (case.figure, run)
        for case, run in zip(study.cases, runs, strict=True)
        if run.last_third_largest is None or run.last_third_largest > study.settings.accepted_error
    ]
    return {
        "name": runs[0].name,
        "outside": [figure for figure, _ in outside],
        "largest": max(run.last_third_largest or 0.0 for run in runs),
        "rms": max((run.last_third_rms or 0.0 for _, run in outside), default=0.0),
    }


def _group(mean_error: float, cases: Sequence[FollowingCase]) -> dict[str, Any]:
    """Return the errors of the speeds of one group, and the changes caused by closing the loop [%]."""
    changes = {
        name: [case.change_by_the_loop(getattr(case, name)) for case in cases]
        for name in ("run", "cycle_mean")
    }
    return {
        "name": cases[0].group.name.replace(",", ""),
        "mean_error": mean_error,
        "errors": [
            percent_change(case.measured.forward_velocity, case.run.forward_velocity)
            for case in cases
        ],
        "swings": [math.degrees(case.run.offset_swing) for case in cases],
        "changes": {
            name: [value for value in values if value is not None]
            for name, values in changes.items()
        },
    }


def _costs(study: PathFollowingStudy) -> Iterator[tuple[str, float, float]]:
    """Yield the measured energy per meter without and with the fin, gait by gait [J/m]."""
    costs = {
        group: np.mean(found, axis=1).tolist()[0] for group, found in meter_costs(study).items()
    }
    for gait in dict.fromkeys(group.gait for group in study.settings.groups):
        pair = {
            group.has_fin: costs[group.name]
            for group in study.settings.groups
            if group.gait == gait
        }
        if len(pair) == 2:
            yield gait, pair[False], pair[True]


def _beyond_the_published(held: HeldOutRun) -> dict[str, Any]:
    """Return by how much the held-out trial exceeds the published ranges: velocity, mean velocity [m/s] and offset."""
    offset, published = (
        [math.degrees(end) for end in ends] for ends in (held.offset, held.settings.offset)
    )
    return {
        "velocity_beyond": _outside(held.velocity, held.settings.velocity),
        "mean_velocity_beyond": _outside(held.mean_velocity, held.settings.velocity),
        "offset": offset,
        "published_offset": published,
        "offset_beyond": _outside(offset, published),
    }


def _outside(found: Sequence[float], known: Sequence[float]) -> dict[str, float]:
    """Return by how much a range extends beyond another one, and on which sides."""
    sides = {"below": known[0] - found[0], "above": found[1] - known[1]}
    return {side: by for side, by in sides.items() if by > 0.0}


# ---- figures -------------------------------------------------------------------------------------


def path_following_figures(study: PathFollowingStudy) -> Iterator[tuple[str, str, "Figure"]]:
    """Yield the speeds of all trials, Figs. 12 to 23 and the held-out trial one by one: file name, caption and figure.

    Args:
        study: Result of `run_path_following`.
    """
    from laticauda.paper.figures import following_speeds_sheet
    from laticauda.show.figures import follow_sheet

    null = _best_null(study)
    title = "Forward velocity in path following (Table 2)"
    chosen = study.cases[0].run.name
    caption = (
        f"{title}: measured in the tank; simulated with {chosen}, in the other ways of the band, and with the "
        f"cycle-mean heading; and as the null model “{null.name}”, fitted to Table 1, predicts it."
    )
    predicted = (f"null model fitted to Table 1: {null.name}", null.speeds)
    sheet = following_speeds_sheet(
        study.cases, title, chosen=f"simulated, {chosen}", null=predicted
    )
    yield SPEEDS, caption, sheet
    for case in study.cases:
        title = f"Path following: {case.group.name}, case {case.measured.case}"
        start = _start(case.measured.initial_cross_track_error, case.measured.initial_heading)
        sheet = follow_sheet(case.trial, title=f"{title}, {start}", note=_speeds(case))
        yield (
            f"figure-{case.figure:02d}",
            f"{title} (Fig. {case.figure} of the paper). {_speeds(case)}.",
            sheet,
        )
    held = study.held_out
    start = _start(held.settings.initial_cross_track_error, held.settings.initial_heading)
    title = f"Held-out trial (published 2016): {GAIT_WORDS[held.settings.gait.kind]}, {held.settings.robot}, {start}"
    caption = (
        "Path following: a trial of another publication (2016), on which no choice here rests."
    )
    yield (
        HELD_OUT,
        caption,
        follow_sheet(held.trial, title=title, note=f"Simulated with {held.run.name}"),
    )


def _best_null(study: PathFollowingStudy) -> Score:
    return min(null_predictions(study), key=lambda prediction: prediction.overall)


def _start(cross_track_error: float, heading: float) -> str:
    degrees = f"{math.degrees(heading):.2f}".replace("-", "\N{MINUS SIGN}")
    return f"from $p_y$ = {cross_track_error:g} m, heading {degrees}°"


def _speeds(case: FollowingCase) -> str:
    return (
        f"Forward velocity {case.measured.forward_velocity:.4f} m/s measured, {case.run.forward_velocity:.4f} m/s "
        f"simulated ({case.run.name})"
    )


# ---- tables --------------------------------------------------------------------------------------


def _tables(study: PathFollowingStudy) -> dict[str, list[Row]]:
    """Return the tables by name: Table 2 row by row, every run, effects of the loop and of the fin, errors, costs."""
    cases = study.cases
    return {
        "following-trials": [
            build_row("case", case)
            | {"figure": case.figure}
            | build_row("start", case)
            | build_row("figures", case.run)
            for case in cases
        ],
        "table2": [_table2(case) for case in cases],
        "following-loop": [_loop(case) for case in cases],
        "following-errors": error_rows(study, "numbers fitted to Table 1", {}),
        "following-fin": [_fin(gain) for gain in fin_gains(cases)],
        "following-joules": [*_joules(study)],
        "following-runs": [*_runs(study)],
    }


def _table2(case: FollowingCase) -> Row:
    speeds = [run.forward_velocity for run in case.band]
    error = percent_change(case.measured.forward_velocity, case.run.forward_velocity)
    known = {"case": case, "error": error, "low": min(speeds), "high": max(speeds)}
    return build_row("case", case) | build_row("start", case) | build_row("table2", known)


def _loop(case: FollowingCase) -> Row:
    found = build_row("case", case) | {"unsteered: steady v [m/s]": case.free_velocity}
    for heading, run in (("raw", case.run), ("cycle mean", case.cycle_mean)):
        here = build_row("loop", {"run": run, "change": case.change_by_the_loop(run)})
        found |= {f"{heading}: {title}": one for title, one in here.items()}
    return found


def _fin(gain: FinGain[FollowingCase]) -> Row:
    band = band_gains(gain)
    velocity: Row = {"simulated: v [%]": gain.simulated(lambda case: case.run.forward_velocity)}
    velocity |= {"band: lowest [%]": min(band), "band: highest [%]": max(band)}
    power = {
        "simulated: mechanical power [%]": gain.simulated(lambda case: case.run.mechanical_power)
    }
    return fin_row(gain.measured, {}, velocity, power)


def _joules(study: PathFollowingStudy) -> Iterator[Row]:
    for group, costs in meter_costs(study).items():
        trials = [(f"case {i}", pair) for i, pair in enumerate(costs.T.tolist(), 1)]
        for trial, pair in (*trials, ("mean", np.mean(costs, axis=1).tolist())):
            both = zip(
                ("measured: electrical [J/m]", "simulated: mechanical [J/m]"), pair, strict=True
            )
            yield {"group": group, "trial": trial, **dict(both)}


def _runs(study: PathFollowingStudy) -> Iterator[Row]:
    runs = [
        (build_row("case", case), run)
        for case in study.cases
        for run in (*case.band, case.cycle_mean)
    ]
    for names, run in (*runs, ({"group": "held out", "case": 1}, study.held_out.run)):
        yield {**names, **build_row("runs", run), **build_row("figures", run)}
