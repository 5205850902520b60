"""The efficiency study as tables: Table 1 row by row, its maxima, what the fin changes, and how far off all is."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from laticauda.gaits import Gait
from laticauda.paper.efficiency import EfficiencyStudy
from laticauda.paper.repeats import Repeat
from laticauda.paper.scores import scores
from laticauda.paper.table1 import fin_gains, maxima
from laticauda.trial.null_models import group_name

if TYPE_CHECKING:
    from pandas import DataFrame

Row = dict[str, Any]


def efficiency_tables(study: EfficiencyStudy, repeats: Sequence[Repeat] = ()) -> "dict[str, DataFrame]":
    """All tables of the study, by name.

    Args:
        study: What `run_efficiency` returned.
        repeats: Repeated trials, a table more.
    """
    from pandas import DataFrame

    rows = {
        "table1": _table1(study),
        "table1-maxima": _maxima(study),
        "fin-gain": _fin(study),
        "errors": _errors(study),
        "sweeps": _sweeps(study),
    }
    if repeats:
        rows["repeats"] = [_repeat(repeat) for repeat in repeats]
    return {name: DataFrame(found) for name, found in rows.items()}


def degrees(angle: float) -> float:
    """An angle or a rate to read; a billionth of a degree is rounding noise.

    Args:
        angle: [rad, or rad/s].

    Returns:
        [deg, or deg/s].
    """
    return round(math.degrees(angle), 9)


def _setting(gait: Gait) -> Row:
    return {
        "amplitude [deg]": degrees(gait.amplitude),
        "frequency [deg/s]": degrees(gait.frequency),
        "phase shift [deg]": degrees(gait.phase_shift),
    }


def _table1(study: EfficiencyStudy) -> list[Row]:
    rows: list[Row] = []
    for case in study.cases:
        measured = case.measured_velocity
        row: Row = {"group": case.group.name, "case": case.index + 1, **_setting(case.gait)}
        row["fastest over"] = (case.starred or "").replace("_", " ")
        row["measured: v [m/s]"] = measured
        row["measured: electrical power [W]"] = case.measured_power
        for name, velocity, power in zip(study.models, case.forward_velocity, case.mechanical_power, strict=True):
            row[f"{name}: v [m/s]"] = velocity
            row[f"{name}: error [%]"] = None if measured is None else 100.0 * (velocity / measured - 1.0)
            row[f"{name}: mechanical power [W]"] = power
        rows.append(row)
    return rows


def _maxima(study: EfficiencyStudy) -> list[Row]:
    rows: list[Row] = []
    for entry in maxima(study):
        row: Row = {"group": entry.group.name, "over": entry.parameter.replace("_", " ")}
        row["measured: fastest at [deg, deg/s]"] = degrees(entry.measured_at)
        row["measured: v [m/s]"] = entry.measured_velocity
        for i, name in enumerate(study.models):
            row[f"{name}: fastest at [deg, deg/s]"] = degrees(entry.simulated_at[i])
            row[f"{name}: at the end of the range"] = entry.at_the_end[i]
            row[f"{name}: v [m/s]"] = entry.simulated_velocity[i]
        rows.append(row)
    return rows


def _fin(study: EfficiencyStudy) -> list[Row]:
    return [
        {"gait": gain.with_fin.group.name.split(",")[0], "case": gain.with_fin.index + 1}
        | _setting(gain.with_fin.gait)
        | {"measured: v [%]": gain.measured_velocity}
        | {f"{name}: v [%]": value for name, value in zip(study.models, gain.simulated_velocity, strict=True)}
        | {
            "printed: v [%]": gain.printed_velocity,
            "measured: electrical power [%]": gain.measured_power,
            "printed: electrical power [%]": gain.printed_power,
            "misprint": ", ".join(gain.misprints),
        }
        for gain in fin_gains(study)
    ]


def _errors(study: EfficiencyStudy) -> list[Row]:
    titles = {model.name: f"{model.name}: {model.title}" for model in study.settings.models}
    groups = [f"{group.name} [%]" for group in study.settings.groups]
    return [
        {
            "predictor of v": titles.get(score.name, f"null model: {score.name}"),
            "numbers fitted here": score.n_fitted or 0,
            **dict(zip(groups, score.by_group, strict=True)),
            "all rows [%]": score.overall,
            "leaving one row out [%]": score.leave_one_out,
            "leaving one group out [%]": score.leave_one_group_out,
        }
        for score in scores(study)
    ]


def _sweeps(study: EfficiencyStudy) -> list[Row]:
    return [
        {
            "model": model,
            "group": group.name,
            "over": sweep.settings.parameter.replace("_", " "),
            "value [deg, deg/s]": degrees(float(value)),
            "v [m/s]": sweep.forward_velocity[m, g, i],
            "steady v [m/s]": sweep.steady_velocity[m, g, i],
            "mechanical power [W]": sweep.mechanical_power[m, g, i],
        }
        for sweep in study.sweeps
        for g, group in enumerate(study.settings.groups)
        for m, model in enumerate(study.models)
        for i, value in enumerate(sweep.values)
    ]


def _repeat(repeat: Repeat) -> Row:
    (velocity, deviation), (power, power_deviation) = repeat.velocity, repeat.power or (None, None)
    return {
        "group": group_name(repeat.gait.kind, repeat.has_fin),
        **_setting(repeat.gait),
        "trials": len(repeat.forward_velocity),
        "v: mean [m/s]": velocity,
        "v: deviation [m/s]": deviation,
        "electrical power: mean [W]": power,
        "electrical power: deviation [W]": power_deviation,
    }
