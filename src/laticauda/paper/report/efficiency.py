"""The efficiency study for readers: its figures, and its section of the report."""

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from laticauda.gaits import GAIT_WORDS
from laticauda.paper.dataset import write_netcdf
from laticauda.paper.efficiency import EfficiencyStudy, SweepResult
from laticauda.paper.repeats import Repeat
from laticauda.paper.report.efficiency_tables import (
    efficiency_tables,
    fin_table,
    maxima_table,
    repeat_table,
    score_table,
    table1,
)
from laticauda.paper.scores import scores
from laticauda.paper.settings import Group, SweepSettings
from laticauda.paper.table1 import FinGain, fin_gains, maxima
from laticauda.reports.chapter import Chapter, Pictures
from laticauda.reports.page import Heading, Paragraph, Part, Picture, Points, Section
from laticauda.robot import Water

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from laticauda.paper.figures.efficiency import Panel

JOINTS = {
    "prescribed": "The joints follow the gait exactly.",
    "pd": "The joints follow the gait by the PD law of the published simulations.",
    "servo": "The joints follow the gait as servos with limited torque and speed do.",
}


def efficiency_chapter(study: EfficiencyStudy, repeats: Sequence[Repeat] = ()) -> Chapter:
    """What the study puts into the folder and the report.

    Args:
        study: What `run_efficiency` returned.
        repeats: Repeated trials to draw beside the paper's (`load_repeats`).
    """
    return Chapter(
        section=lambda pictures: efficiency_section(study, pictures, repeats),
        tables=efficiency_tables(study) + ((repeat_table(repeats),) if repeats else ()),
        n_figures=sum(len(group.figures) for group in study.settings.groups),
        figures=lambda: efficiency_figures(study, repeats),
        data={"efficiency.nc": lambda path: write_netcdf(study, path)},
    )


def efficiency_figures(study: EfficiencyStudy, repeats: Sequence[Repeat] = ()) -> Iterator[tuple[str, str, "Figure"]]:
    """The study's Figs. 4 to 11, one after the other: the name of its file, what it shows, and the figure.

    Args:
        study: What `run_efficiency` returned.
        repeats: Repeated trials to draw beside the paper's.
    """
    from laticauda.paper.figures.efficiency import power_sheet, velocity_sheet

    for place, group in enumerate(study.settings.groups):
        panels = [_panel(study, sweep, place, repeats) for sweep in study.sweeps]
        sheets = ((velocity_sheet, "Forward velocity"), (power_sheet, "Power"))
        for number, (sheet, what) in zip(group.figures, sheets, strict=True):
            title = f"{what}: {group.name}"
            yield f"figure-{number:02d}", f"{title} (Fig. {number} of the paper).", sheet(panels, title)


def efficiency_section(study: EfficiencyStudy, pictures: Pictures, repeats: Sequence[Repeat] = ()) -> Section:
    """The study's part of the report.

    Args:
        study: What was run.
        pictures: By name of the figure, its caption and the content of its PNG file.
        repeats: Repeated trials that are drawn beside the paper's.
    """
    parts: list[Part] = [
        Heading(text="What was run"),
        Paragraph(text=_what(study)),
        Points(texts=(*_settings(study),)),
        Heading(text="What came out"),
        Points(texts=(*_findings(study),)),
        Heading(text="Errors, beside models without physics"),
        score_table(study),
        Heading(text="Table 1, row by row"),
        table1(study),
        Heading(text="The maxima"),
        maxima_table(study),
        Heading(text="What the fin changes"),
        fin_table(study),
        *_repeated(study, repeats),
        Heading(text="Figures"),
        *(
            Picture(png=png, caption=caption, description=f"{caption} The numbers are in sweeps.csv.")
            for _, (caption, png) in sorted(pictures.items())
        ),
    ]
    return Section(name="efficiency", title="Locomotion efficiency", parts=tuple(parts))


# ---- figures -------------------------------------------------------------------------------------------------------


def _panel(study: EfficiencyStudy, sweep: SweepResult, place: int, repeats: Sequence[Repeat]) -> "Panel":
    """One panel: the curves of one group, and the rows of Table 1 and repeated trials that lie on this sweep."""
    from laticauda.paper.figures.efficiency import Curve, Marks, Panel, Scatter

    settings, group = sweep.settings, study.settings.groups[place]
    cases = [case for case in study.cases if case.group == group and settings.contains(case.gait)]
    return Panel(
        parameter=settings.parameter,
        fixed=dict(settings.fixed),
        values=sweep.values,
        curves=tuple(
            Curve(label=model.title, velocity=sweep.forward_velocity[i, place], power=sweep.mechanical_power[i, place])
            for i, model in enumerate(study.settings.models)
        ),
        measured=Marks(
            at=np.array([getattr(case.gait, settings.parameter) for case in cases], dtype=float),
            velocity=np.array([case.measured_velocity for case in cases], dtype=float),
            power=np.array([case.measured_power for case in cases], dtype=float),
            is_maximum=np.array([case.starred == settings.parameter for case in cases], dtype=bool),
            scatter=tuple(
                Scatter(
                    at=getattr(repeat.gait, settings.parameter),
                    velocity=np.array(repeat.forward_velocity, dtype=float),
                    power=np.array(repeat.mean_power, dtype=float),
                )
                for repeat in repeats
                if _is_shown(repeat, group, settings)
            ),
        ),
    )


def _is_shown(repeat: Repeat, group: Group, sweep: SweepSettings) -> bool:
    """Whether a panel of this group and sweep has a place for repeated trials."""
    value = getattr(repeat.gait, sweep.parameter)
    within = sweep.low - 1e-9 <= value <= sweep.high + 1e-9
    same = repeat.gait.kind == group.gait and repeat.has_fin == group.has_fin
    return same and within and sweep.contains(repeat.gait)


# ---- words ---------------------------------------------------------------------------------------------------------


def _what(study: EfficiencyStudy) -> str:
    return (
        f"{study.settings.n_runs} trials of {study.settings.duration:g} s, straight and from rest: both gaits, without "
        "and with the caudal fin, every row of Table 1 and sweeps of amplitude, frequency and phase shift. The "
        "frequency is an angular frequency, as in the paper. The paper shows its ranges only in its figures; those "
        "here are our choice."
    )


def _settings(study: EfficiencyStudy) -> Iterator[str]:
    how = study.how
    joints = JOINTS.get(str(how["joints"]), "")
    ramp = f"the amplitude rises over the first {how['ramp']:g} s" if how["ramp"] else "the gait starts at once"
    yield (
        f"Model: {how['model']}; joints: {how['joints']}. {joints} Time step {how['dt']:g} s; {ramp}; reference "
        f"generator's bandwidth {how['offset_bandwidth']:g} rad/s (of no effect here: nothing steers)."
    )
    yield "Robots: {}.".format(", ".join(dict.fromkeys(group.robot for group in study.settings.groups)))
    for model in study.settings.models:
        waters = [f"{water_in_words(model.water(gait))} for {GAIT_WORDS[gait]}" for gait in model.waters]
        yield f"{model.name} ({model.title}): {'; '.join(waters)}."
    for sweep in study.settings.sweeps:
        low, high, step = (f"{math.degrees(value):g}" for value in (sweep.values[0], sweep.values[-1], sweep.step))
        held = ", ".join(f"{name.replace('_', ' ')} {math.degrees(value):g}" for name, value in sweep.fixed.items())
        name = sweep.parameter.replace("_", " ")
        yield f"Sweep of the {name}: {low} to {high} in steps of {step}, at {held} [deg, deg/s]."


def water_in_words(water: Water) -> str:
    """A water's name, with its coefficients and forms in brackets.

    Args:
        water: Any water.
    """
    return (
        f"{water.name} (C_f {water.tangential_friction:g}, C_D {water.normal_drag:g}, C_A {water.added_mass:g}, "
        f"form of the added mass: {water.added_mass_form}, rotational loads: {water.rotational}, "
        f"drag {water.drag.words})"
    )


def _repeated(study: EfficiencyStudy, repeats: Sequence[Repeat]) -> list[Part]:
    """What is said about repeated trials, if there are any."""
    if not repeats:
        return []
    settings = study.settings
    shown = [
        repeat
        for repeat in repeats
        if any(_is_shown(repeat, group, sweep) for group in settings.groups for sweep in settings.sweeps)
    ]
    n_trials = sum(len(repeat.forward_velocity) for repeat in repeats)
    text = (
        f"{n_trials} trials of {len(repeats)} settings were given. {len(shown)} of the settings lie on a sweep of the "
        "figures and are drawn there, a little to the right of their value."
    )
    return [Heading(text="Repeated trials"), Paragraph(text=text), repeat_table(repeats)]


def _findings(study: EfficiencyStudy) -> Iterator[str]:
    found = scores(study)
    physical = [score for score in found if score.n_fitted is None]
    null = [score for score in found if score.leave_one_out is not None]
    best = min(null, key=lambda score: score.leave_one_out or 0.0)
    errors = ", ".join(f"{score.name} {score.overall:.1f} %" for score in physical)
    yield (
        f"Mean error over the {len(study.measured)} measured rows of Table 1: {errors}; the best model without physics "
        f"({best.name}, {best.n_fitted} numbers fitted to these rows) {best.overall:.1f} %, and "
        f"{best.leave_one_out:.1f} % for rows left out of its fit."
    )
    starred = maxima(study)
    for i, name in enumerate(study.models):
        near = sum(abs(entry.simulated_at[i] - entry.measured_at) <= math.radians(5.0) + 1e-9 for entry in starred)
        ends = sum(entry.at_the_end[i] for entry in starred)
        yield (
            f"{name}: {near} of {len(starred)} maxima lie within 5 deg or deg/s of the measured ones; {ends} of the "
            "simulated ones lie at the end of their range."
        )
    yield from _fin_findings(fin_gains(study), study.models)


def _fin_findings(gains: tuple[FinGain, ...], models: tuple[str, ...]) -> Iterator[str]:
    for kind in dict.fromkeys(gain.with_fin.group.gait for gain in gains):
        here = [gain for gain in gains if gain.with_fin.group.gait == kind and gain.measured_velocity is not None]
        measured = _range([gain.measured_velocity for gain in here if gain.measured_velocity is not None])
        simulated = [f"{name} {_range([g.simulated_velocity[i] for g in here])}" for i, name in enumerate(models)]
        yield f"The fin makes {GAIT_WORDS[kind]} faster by {measured} as measured; simulated: {', '.join(simulated)}."
    for gain in gains:
        for what in gain.misprints:
            printed, value = getattr(gain, f"printed_{what}"), getattr(gain, f"measured_{what}")
            yield (
                f"Misprint in the paper's Table 1: {gain.with_fin.group.name}, case {gain.with_fin.index + 1}, change "
                f"of {what} printed {printed:+.2f} %, recomputed from the table {value:+.2f} %."
            )


def _range(values: list[float]) -> str:
    low, high = (f"{value:.0f}".replace("-", "\N{MINUS SIGN}") for value in (min(values), max(values)))
    return f"{low} to {high} %"
