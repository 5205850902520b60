"""The efficiency study as tables: Table 1 row by row, its maxima, what the fin changes, and how far off all is."""

import math
from collections.abc import Sequence

from laticauda.paper.efficiency import EfficiencyStudy
from laticauda.paper.repeats import Repeat
from laticauda.paper.scores import scores
from laticauda.paper.table1 import fin_gains, maxima
from laticauda.reports.tables import Cell, Column, Table
from laticauda.trial.null_models import group_name

SYMBOLS = {"amplitude": "amplitude", "frequency": "frequency", "phase_shift": "phase shift"}
SETTING = (
    Column(name="amplitude [deg]"),
    Column(name="frequency [deg/s]"),
    Column(name="phase shift [deg]"),
)


def degrees(angle: float) -> float:
    """An angle or a rate to read; a billionth of a degree is rounding noise.

    Args:
        angle: [rad, or rad/s].

    Returns:
        [deg, or deg/s].
    """
    return round(math.degrees(angle), 9)


def efficiency_tables(study: EfficiencyStudy) -> tuple[Table, ...]:
    """All tables of the study.

    Args:
        study: What `run_efficiency` returned.
    """
    return table1(study), maxima_table(study), fin_table(study), score_table(study), sweep_table(study)


def table1(study: EfficiencyStudy) -> Table:
    """Table 1, measured and simulated, all 22 rows.

    Args:
        study: What `run_efficiency` returned.
    """
    simulated = [
        column
        for name in study.models
        for column in (
            Column(name=f"{name}: v [m/s]", form=".4f"),
            Column(name=f"{name}: error [%]", form="+.1f"),
            Column(name=f"{name}: mechanical power [W]", form=".1f"),
        )
    ]
    rows: list[tuple[Cell, ...]] = []
    for case in study.cases:
        gait, measured = case.gait, case.measured_velocity
        row: list[Cell] = [case.group.name, case.index + 1]
        row += [degrees(gait.amplitude), degrees(gait.frequency), degrees(gait.phase_shift)]
        row += [SYMBOLS.get(case.starred or "", ""), measured, case.measured_power]
        for velocity, power in zip(case.forward_velocity, case.mechanical_power, strict=True):
            row += [velocity, None if measured is None else 100.0 * (velocity / measured - 1.0), power]
        rows.append(tuple(row))
    return Table(
        name="table1",
        grouped=True,
        caption="Table 1 at every setting: measured and simulated forward velocity v, equation (5). Where the paper "
        "has no measurement (NA), the simulation is a prediction. The powers are not comparable: the measured one is "
        "electrical, above idle; the simulated one is mechanical.",
        columns=(
            Column(name="group"),
            Column(name="case"),
            *SETTING,
            Column(name="fastest over"),
            Column(name="measured: v [m/s]", form=".4f"),
            Column(name="measured: electrical power [W]", form=".2f"),
            *simulated,
        ),
        rows=tuple(rows),
    )


def maxima_table(study: EfficiencyStudy) -> Table:
    """The starred entries of Table 1: where the robot is fastest, and where the simulation is.

    Args:
        study: What `run_efficiency` returned.
    """
    simulated = [
        column
        for name in study.models
        for column in (
            Column(name=f"{name}: fastest at [deg, deg/s]"),
            Column(name=f"{name}: at the end of the range"),
            Column(name=f"{name}: v [m/s]", form=".4f"),
        )
    ]
    rows: list[tuple[Cell, ...]] = []
    for entry in maxima(study):
        row: list[Cell] = [entry.group.name, SYMBOLS[entry.parameter]]
        row += [degrees(entry.measured_at), entry.measured_velocity]
        for at, end, velocity in zip(entry.simulated_at, entry.at_the_end, entry.simulated_velocity, strict=True):
            row += [degrees(at), end, velocity]
        rows.append(tuple(row))
    return Table(
        name="table1-maxima",
        grouped=True,
        caption="Table 1 as maxima of sweeps: the starred parameter at which the robot was fastest and its speed "
        "there, beside the maximum of the simulated sweep. At the end of the range, the maximum may lie beyond. "
        "A measured maximum is the best of noisy values, so its speed is biased upward.",
        columns=(
            Column(name="group"),
            Column(name="over"),
            Column(name="measured: fastest at [deg, deg/s]"),
            Column(name="measured: v [m/s]", form=".4f"),
            *simulated,
        ),
        rows=tuple(rows),
    )


def fin_table(study: EfficiencyStudy) -> Table:
    """What the fin changes: measured, as printed, and simulated.

    Args:
        study: What `run_efficiency` returned.
    """
    rows: list[tuple[Cell, ...]] = []
    for gain in fin_gains(study):
        gait = gain.with_fin.gait
        row: list[Cell] = [gain.with_fin.group.name.split(",")[0], gain.with_fin.index + 1]
        row += [degrees(gait.amplitude), degrees(gait.frequency), degrees(gait.phase_shift)]
        row += [gain.measured_velocity, *gain.simulated_velocity, gain.printed_velocity]
        row += [gain.measured_power, gain.printed_power, ", ".join(gain.misprints)]
        rows.append(tuple(row))
    simulated = [Column(name=f"{name}: v [%]", form="+.1f") for name in study.models]
    return Table(
        name="fin-gain",
        grouped=True,
        caption="What the fin changes, in percent of the robot without it: recomputed from the speeds and powers of "
        "Table 1, simulated, and as the paper prints it.",
        columns=(
            Column(name="gait"),
            Column(name="case"),
            *SETTING,
            Column(name="measured: v [%]", form="+.2f"),
            *simulated,
            Column(name="printed: v [%]", form="+.2f"),
            Column(name="measured: electrical power [%]", form="+.2f"),
            Column(name="printed: electrical power [%]", form="+.2f"),
            Column(name="misprint"),
        ),
        rows=tuple(rows),
    )


def score_table(study: EfficiencyStudy) -> Table:
    """Mean errors by group and overall, the null models beside the physical ones.

    Args:
        study: What `run_efficiency` returned.
    """
    titles = {model.name: f"{model.name}: {model.title}" for model in study.settings.models}
    rows: list[tuple[Cell, ...]] = [
        (
            titles.get(score.name, f"null model: {score.name}"),
            score.n_fitted or 0,
            *score.by_group,
            score.overall,
            score.leave_one_out,
            score.leave_one_group_out,
        )
        for score in scores(study)
    ]
    groups = [Column(name=f"{group.name} [%]", form=".1f") for group in study.settings.groups]
    return Table(
        name="errors",
        caption="Mean absolute percentage error of the forward velocity over the measured rows of Table 1. The null "
        "models know no physics and are fitted to these rows; so their errors with rows or groups left out of the fit "
        "count more. The paper's coefficients were fitted there by hand to curves of the robot without fin; they are "
        "not changed here.",
        columns=(
            Column(name="predictor of v"),
            Column(name="numbers fitted here"),
            *groups,
            Column(name="all rows [%]", form=".1f"),
            Column(name="leaving one row out [%]", form=".1f"),
            Column(name="leaving one group out [%]", form=".1f"),
        ),
        rows=tuple(rows),
    )


def repeat_table(repeats: Sequence[Repeat]) -> Table:
    """Repeated trials: mean and standard deviation of every setting.

    Args:
        repeats: What `load_repeats` returned.
    """
    rows: list[tuple[Cell, ...]] = []
    for repeat in repeats:
        gait = repeat.gait
        row: list[Cell] = [group_name(gait.kind, repeat.has_fin)]
        row += [degrees(gait.amplitude), degrees(gait.frequency), degrees(gait.phase_shift)]
        row += [len(repeat.forward_velocity), *repeat.velocity, *(repeat.power or (None, None))]
        rows.append(tuple(row))
    return Table(
        name="repeats",
        grouped=True,
        caption="The repeated trials that were given: mean and standard deviation (of a sample) of every setting. One "
        "trial has no deviation.",
        columns=(
            Column(name="group"),
            *SETTING,
            Column(name="trials"),
            Column(name="v: mean [m/s]", form=".4f"),
            Column(name="v: deviation [m/s]", form=".4f"),
            Column(name="electrical power: mean [W]", form=".2f"),
            Column(name="electrical power: deviation [W]", form=".2f"),
        ),
        rows=tuple(rows),
    )


def sweep_table(study: EfficiencyStudy) -> Table:
    """Every simulated point of every sweep, a row each.

    Args:
        study: What `run_efficiency` returned.
    """
    rows: list[tuple[Cell, ...]] = []
    for sweep in study.sweeps:
        for g, group in enumerate(study.settings.groups):
            for m, model in enumerate(study.models):
                for i, value in enumerate(sweep.values):
                    row = [model, group.name, SYMBOLS[sweep.settings.parameter], degrees(float(value))]
                    curves = (sweep.forward_velocity, sweep.steady_velocity, sweep.mechanical_power)
                    rows.append((*row, *(float(curve[m, g, i]) for curve in curves)))
    heads = ("model", "group", "over", "value [deg, deg/s]", "v [m/s]", "steady v [m/s]", "mechanical power [W]")
    return Table(
        name="sweeps",
        caption="Every simulated point.",
        columns=tuple(Column(name=head) for head in heads),
        rows=tuple(rows),
    )
