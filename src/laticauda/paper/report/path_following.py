"""The path-following study for readers: its figures, and its section of the report."""

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from laticauda.gaits import GAIT_WORDS
from laticauda.paper.following_dataset import write_following_netcdf
from laticauda.paper.path_following import FollowingCase, PathFollowingStudy
from laticauda.paper.report.path_following_tables import (
    cost_table,
    fin_change_table,
    loop_table,
    path_following_tables,
    prediction_table,
    table2,
    trial_table,
)
from laticauda.paper.report.path_following_words import findings, held_out_verdict, settings_in_words
from laticauda.paper.table2 import Prediction, null_predictions
from laticauda.reports.chapter import Chapter, Pictures
from laticauda.reports.page import Heading, Paragraph, Part, Picture, Points, Section

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from laticauda.paper.figures.following_speeds import SpeedRow

SPEEDS, HELD_OUT = "table2-speeds", "held-out"


def path_following_chapter(study: PathFollowingStudy) -> Chapter:
    """What the study puts into the folder and the report.

    Args:
        study: What `run_path_following` returned.
    """
    return Chapter(
        tables=path_following_tables(study),
        n_figures=len(study.cases) + 2,
        figures=lambda: path_following_figures(study),
        section=lambda pictures: path_following_section(study, pictures),
        data={"path_following.nc": lambda path: write_following_netcdf(study, path)},
    )


def path_following_figures(study: PathFollowingStudy) -> Iterator[tuple[str, str, "Figure"]]:
    """The speeds of all trials, Figs. 12 to 23, and the held-out trial: file name, caption, figure, one by one.

    Args:
        study: What `run_path_following` returned.
    """
    from laticauda.figures.following import follow_sheet
    from laticauda.paper.figures.following_speeds import following_speeds_sheet

    null = _best_null(study)
    title = "Forward velocity in path following (Table 2)"
    chosen = study.cases[0].run.name
    caption = (
        f"{title}: measured in the tank; simulated with {chosen}, in the other ways of the band, and with the "
        f"cycle-mean heading; and as the null model “{null.name}”, fitted to Table 1, predicts it."
    )
    rows = [_speed_row(study, case, speed) for case, speed in zip(study.cases, null.speeds, strict=True)]
    legend = f"null model fitted to Table 1: {null.name}"
    yield SPEEDS, caption, following_speeds_sheet(rows, title, chosen=f"simulated, {chosen}", null=legend)
    for case in study.cases:
        title = f"Path following: {case.group.name}, case {case.measured.case}"
        start = _start(case.measured.initial_cross_track_error, case.measured.initial_heading)
        sheet = follow_sheet(case.trial, title=f"{title}, {start}", note=_speeds(case))
        yield f"figure-{case.figure:02d}", f"{title} (Fig. {case.figure} of the paper). {_speeds(case)}.", sheet
    held = study.held_out
    start = _start(held.settings.initial_cross_track_error, held.settings.initial_heading)
    title = f"Held-out trial (published 2016): {GAIT_WORDS[held.settings.gait.kind]}, {held.settings.robot}, {start}"
    caption = "Path following: a trial of another publication (2016), on which no choice here rests."
    yield HELD_OUT, caption, follow_sheet(held.trial, title=title, note=f"Simulated with {held.run.name}")


def path_following_section(study: PathFollowingStudy, pictures: Pictures) -> Section:
    """The study's part of the report.

    Args:
        study: What was run.
        pictures: By name of the figure, its caption and the content of its PNG file.
    """
    parts: list[Part] = [
        Heading(text="What was run"),
        Paragraph(text=_what(study)),
        Points(texts=(*settings_in_words(study),)),
        Heading(text="What came out"),
        Points(texts=(*findings(study),)),
        Heading(text="Way to the path, trial by trial"),
        trial_table(study),
        Heading(text="Table 2, row by row"),
        table2(study),
        *_pictures(pictures, [SPEEDS], "table2.csv"),
        Heading(text="What closing the loop changes"),
        loop_table(study),
        Heading(text="Errors, beside models without physics"),
        prediction_table(study),
        *_fin(study),
        Heading(text="Energy per meter"),
        cost_table(study),
        Heading(text="A trial that no choice here rests on"),
        Points(texts=(*held_out_verdict(study),)),
        *_pictures(pictures, [HELD_OUT], "path_following.nc"),
        Heading(text="Figures"),
        *_pictures(pictures, [f"figure-{case.figure:02d}" for case in study.cases], "path_following.nc"),
    ]
    return Section(name="path-following", title="Path following", parts=tuple(parts))


# ---- figures -------------------------------------------------------------------------------------------------------


def _best_null(study: PathFollowingStudy) -> Prediction:
    return min(null_predictions(study), key=lambda prediction: prediction.overall)


def _speed_row(study: PathFollowingStudy, case: FollowingCase, null: float) -> "SpeedRow":
    from laticauda.paper.figures.following_speeds import SpeedRow

    laws = dict.fromkeys(run.joints for run in case.band)
    bandwidths = {law: [run.offset_bandwidth for run in case.band if run.joints == law] for law in laws}
    return SpeedRow(
        group=case.group.name,
        label=f"case {case.measured.case}",
        measured=case.measured.forward_velocity,
        simulated={
            f"{law} joints, {' and '.join(f'{each:g}' for each in bandwidths[law])} rad/s, raw heading": tuple(
                run.forward_velocity for run in case.band if run.joints == law
            )
            for law in laws
        },
        chosen=case.run.forward_velocity,
        cycle_mean=case.cycle_mean.forward_velocity,
        null=null,
    )


def _start(cross_track_error: float, heading: float) -> str:
    degrees = f"{math.degrees(heading):.2f}".replace("-", "\N{MINUS SIGN}")
    return f"from $p_y$ = {cross_track_error:g} m, heading {degrees}°"


def _speeds(case: FollowingCase) -> str:
    return (
        f"Forward velocity {case.measured.forward_velocity:.4f} m/s measured, {case.run.forward_velocity:.4f} m/s "
        f"simulated ({case.run.name})"
    )


def _pictures(pictures: Pictures, names: Sequence[str], numbers: str) -> Iterator[Picture]:
    for name in names:
        if name in pictures:
            caption, png = pictures[name]
            yield Picture(png=png, caption=caption, description=f"{caption} The numbers are in {numbers}.")


def _fin(study: PathFollowingStudy) -> Iterator[Part]:
    """What the fin changes, if the study has cases with and without it."""
    table = fin_change_table(study)
    if table.rows:
        yield Heading(text="What the fin changes in path following")
        yield table


# ---- words ---------------------------------------------------------------------------------------------------------


def _what(study: PathFollowingStudy) -> str:
    settings, first = study.settings, study.cases[0]
    n_runs = settings.n_runs(first.run.joints, first.run.offset_bandwidth)
    return (
        f"{n_runs} runs: the {len(study.cases)} trials of Table 2 from its initial conditions along the x axis, each "
        f"in {len(first.band)} ways with the raw heading and once with the heading's mean over the gait cycle; the "
        f"{len(settings.groups)} gaits unsteered; and a trial of another publication. Chosen for figures and tables: "
        f"{first.run.name}."
    )
