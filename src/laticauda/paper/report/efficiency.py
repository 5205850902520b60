"""The efficiency study for readers: its figures, and what its chapter of the report speaks of."""

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from laticauda.paper.datasets import to_dataset
from laticauda.paper.efficiency import EfficiencyStudy, SweepResult
from laticauda.paper.repeats import Repeat
from laticauda.paper.report.chapter import Chapter
from laticauda.paper.report.efficiency_tables import efficiency_tables
from laticauda.paper.scores import scores
from laticauda.paper.settings import Group, SweepSettings
from laticauda.paper.table1 import fin_gains, maxima

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from laticauda.paper.figures.efficiency import Panel

NEAR = math.radians(5.0)  # of the measured maximum; by less than rounding more [rad, rad/s]


def efficiency_chapter(study: EfficiencyStudy, repeats: Sequence[Repeat] = ()) -> Chapter:
    """What the study puts into the folder and the report.

    Args:
        study: What `run_efficiency` returned.
        repeats: Repeated trials to draw beside the paper's (`load_repeats`).
    """
    return Chapter(
        name="efficiency",
        values={"study": study, "settings": study.settings, "repeats": repeats, **_findings(study, repeats)},
        tables=efficiency_tables(study, repeats),
        n_figures=sum(len(group.figures) for group in study.settings.groups),
        figures=lambda: efficiency_figures(study, repeats),
        data={"efficiency.nc": lambda: to_dataset(study)},
    )


def _findings(study: EfficiencyStudy, repeats: Sequence[Repeat]) -> dict[str, Any]:
    """What the sentences of the chapter are made of."""
    found, gains, starred = scores(study), fin_gains(study), maxima(study)
    kinds = dict.fromkeys(gain.with_fin.group.gait for gain in gains)
    known = {k: [g for g in gains if g.with_fin.group.gait == k and g.measured_velocity is not None] for k in kinds}
    sweeps, groups = study.settings.sweeps, study.settings.groups
    return {
        "physical": [score for score in found if score.n_fitted is None],
        "best": min((s for s in found if s.leave_one_out is not None), key=lambda score: score.leave_one_out or 0.0),
        "n_maxima": len(starred),
        "n_near": [
            sum(abs(entry.simulated_at[i] - entry.measured_at) <= NEAR + 1e-9 for entry in starred)
            for i in range(len(study.models))
        ],
        "n_at_end": [sum(entry.at_the_end[i] for entry in starred) for i in range(len(study.models))],
        "fin": {
            kind: {
                "measured": [gain.measured_velocity for gain in here],
                "simulated": [[gain.simulated_velocity[i] for gain in here] for i in range(len(study.models))],
            }
            for kind, here in known.items()
        },
        "misprinted": [
            (gain.with_fin, what, getattr(gain, f"printed_{what}"), getattr(gain, f"measured_{what}"))
            for gain in gains
            for what in gain.misprints
        ],
        "n_repeats_shown": sum(any(_is_shown(r, g, sweep) for g in groups for sweep in sweeps) for r in repeats),
    }


# ---- figures -------------------------------------------------------------------------------------------------------


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
