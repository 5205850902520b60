"""Numbers of the efficiency study that claims refer to: effect of the fin, agreement, trends."""

import math
from collections.abc import Mapping
from itertools import combinations
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.paper.claims.printed_numbers import (
    Numbers,
    collect_table_numbers,
    energy_change,
)
from laticauda.paper.efficiency import EfficiencyStudy, Maximum, SweepResult, find_maxima
from laticauda.paper.fin_effect import find_fin_gains, find_velocity_gains, simulate_velocity_gains
from laticauda.paper.measured import percent_change
from laticauda.paper.scores import Score, find_best_null, score_study

ANALYTICAL_SET = "analytical-set"
"""Name of the paper's coefficients for its analytical model."""
VORTEX_SET = "vortex-set"
"""Name of the paper's coefficients for its Vortex model."""
_ROUNDING = 1e-9
"""Distances are less by this, to allow for rounding [rad, rad/s]."""


def collect_efficiency_numbers(study: EfficiencyStudy) -> Numbers:
    """Return the findings of the efficiency study: effect of the fin, agreement, trends.

    Args:
        study: Result of `run_efficiency`.
    """
    return {
        "joints": study.trial_settings["joints"],
        "kind": study.trial_settings["model"],
        "model": study.judged_model,
        **_describe_fin(study),
        **_describe_agreement(study),
        **_describe_trends(study),
        **_describe_maxima(study),
    }


def _describe_maxima(study: EfficiencyStudy) -> Numbers:
    """Return where the sweeps are fastest [deg, deg/s]."""
    maxima = find_maxima(study)
    phase_shift = _find_phase_shift_maximum(study, maxima)
    distances = [maximum.distance(study.judged) - _ROUNDING for maximum in maxima]
    return {
        "optimum": math.degrees(phase_shift.simulated_at[study.judged]),
        "measured_optimum": math.degrees(phase_shift.measured_at),
        "distances": [math.degrees(distance) for distance in distances],
        "at_the_end": [maximum.at_the_end[study.judged] for maximum in maxima],
    }


def _find_phase_shift_maximum(study: EfficiencyStudy, maxima: tuple[Maximum, ...]) -> Maximum:
    """Return the maximum over the phase shift of the first group."""
    first_group = study.settings.groups[0]
    return next(
        maximum
        for maximum in maxima
        if maximum.parameter == "phase_shift" and maximum.group == first_group
    )


# ---- effect of the fin ---------------------------------------------------------------------------


class GainRow(NamedTuple):
    """How much faster the fin makes the robot in one case of Table 1."""

    group: str
    """Name of the group with the fin."""
    case: int
    """Number of the case [-]."""
    velocity_change: float
    """Measured change of the forward velocity [%]."""


def _describe_fin(study: EfficiencyStudy) -> Numbers:
    """Return the changes due to the fin [%]."""
    gains = find_fin_gains(study.cases)
    gains_with_velocity = [gain for gain in gains if gain.measured.velocity is not None]

    gain_rows: list[GainRow] = []
    measured_power: list[float] = []
    measured_energy: list[float] = []
    for gain in gains:
        velocity = gain.measured.velocity
        power = gain.measured.power
        if velocity is not None:
            case = gain.with_fin
            gain_rows.append(GainRow(case.group.name, case.measured.case, velocity))
        if power is not None:
            measured_power.append(power)
        if velocity is not None and power is not None:
            measured_energy.append(energy_change(power, velocity))
    measured_velocity = [row.velocity_change for row in gain_rows]

    simulated_velocity = simulate_velocity_gains(gains, study.judged)
    simulated_power = [
        gain.simulated_change(lambda case: case.mechanical_power[study.judged]) for gain in gains
    ]
    simulated_energy = [
        energy_change(power, velocity)
        for power, velocity in zip(simulated_power, simulated_velocity, strict=True)
    ]
    return {
        "gains": _describe_gains_by_gait(study),
        "gain": measured_velocity,
        "gain_rows": gain_rows,
        "gain_of_both_tables": [*measured_velocity, *collect_table_numbers()["gain"]],
        "simulated_gain": simulate_velocity_gains(gains_with_velocity, study.judged),
        "n_settings": len(gains),
        "power": measured_power,
        "simulated_power": simulated_power,
        "energy": measured_energy,
        "simulated_energy": simulated_energy,
    }


def _describe_gains_by_gait(study: EfficiencyStudy) -> Numbers:
    """Return by kind of gait how much faster the fin makes the robot [%]."""
    return {
        kind: {
            "measured": gains.measured,
            "by_model": gains.by_model,
            "simulated": gains.by_model[study.judged_model],
        }
        for kind, gains in find_velocity_gains(study).items()
    }


# ---- agreement -----------------------------------------------------------------------------------


def _describe_agreement(study: EfficiencyStudy) -> Numbers:
    """Return the errors of the simulated forward velocity over the measured rows of Table 1 [%]."""
    scores = score_study(study)
    judged_score = scores[study.judged]
    mean_error = _mean_error_by_group(study, judged_score)
    paper_errors = _find_paper_errors(study, scores)
    pairs = _pair_groups_without_and_with_fin(study)
    best_null = find_best_null(scores)
    return {
        "errors": _find_errors_by_group(study, judged_score),
        "mean_error": mean_error,
        "papers": paper_errors,
        "vortex_excess": [vortex - analytical for analytical, vortex in paper_errors.values()],
        "pairs": pairs,
        "excess_with_fin": [mean_error[fin] - mean_error[bare] for bare, fin in pairs],
        "overall": judged_score.overall,
        "n_measured": len(study.measured),
        "best": best_null,
        "excess_over_null": judged_score.overall - (best_null.leave_one_out or 0.0),
    }


def _mean_error_by_group(study: EfficiencyStudy, score: Score) -> dict[str, float]:
    """Return the mean absolute error of a predictor by name of the group [%]."""
    names = [group.name for group in study.settings.groups]
    return dict(zip(names, score.by_group, strict=True))


def _find_errors_by_group(study: EfficiencyStudy, score: Score) -> dict[str, list[float]]:
    """Return the errors of a predictor, row by row, by name of the group [%]."""
    errors: dict[str, list[float]] = {group.name: [] for group in study.settings.groups}
    for case, measured, predicted in zip(study.measured, score.measured, score.speeds, strict=True):
        errors[case.group.name].append(percent_change(measured, predicted))
    return errors


class PaperErrors(NamedTuple):
    """Mean absolute errors with the paper's two sets of coefficients."""

    analytical: float
    """With those for its analytical model [%]."""
    vortex: float
    """With those for its Vortex model [%]."""


def _find_paper_errors(study: EfficiencyStudy, scores: tuple[Score, ...]) -> dict[str, PaperErrors]:
    """Return by group with the fin the errors with the paper's coefficients, if all were run."""
    score_of_model = dict(zip(study.models, scores, strict=False))
    if ANALYTICAL_SET not in score_of_model or VORTEX_SET not in score_of_model:
        return {}
    analytical = _mean_error_by_group(study, score_of_model[ANALYTICAL_SET])
    vortex = _mean_error_by_group(study, score_of_model[VORTEX_SET])
    errors: dict[str, PaperErrors] = {}
    for group in study.settings.groups:
        if group.has_fin:
            errors[group.name] = PaperErrors(analytical[group.name], vortex[group.name])
    return errors


def _pair_groups_without_and_with_fin(study: EfficiencyStudy) -> list[tuple[str, str]]:
    """Return the names of the groups without and with the fin, gait by gait."""
    groups_with_fin = [group for group in study.settings.groups if group.has_fin]
    groups_without_fin = [group for group in study.settings.groups if not group.has_fin]
    pairs: list[tuple[str, str]] = []
    for bare_group in groups_without_fin:
        for fin_group in groups_with_fin:
            if fin_group.gait == bare_group.gait:
                pairs.append((bare_group.name, fin_group.name))
    return pairs


# ---- trends --------------------------------------------------------------------------------------


def _describe_trends(study: EfficiencyStudy) -> Numbers:
    """Return trends of velocity over the frequency, and of power over all settings."""
    sweep = next(sweep for sweep in study.sweeps if sweep.settings.parameter == "frequency")
    velocities = _measured_velocities_by_frequency(study, sweep)
    by_frequency: dict[str, float] = {}
    frequency_ratios: list[float] = []
    from_130_to_150: dict[str, float] = {}
    for group, velocity_at in velocities.items():
        lowest = min(velocity_at)
        highest = max(velocity_at)
        by_frequency[group] = percent_change(velocity_at[lowest], velocity_at[highest])
        frequency_ratios.append(percent_change(lowest, highest))
        if 130 in velocity_at and 150 in velocity_at:
            from_130_to_150[group] = percent_change(velocity_at[130], velocity_at[150])
    alike = {group.name: _rank_power_alike(study, group.name) for group in study.settings.groups}
    return {
        "explained": [
            _explained_by_line_through_origin(sweep.values, curve)
            for curve in sweep.forward_velocity[study.judged]
        ],
        "by_frequency": by_frequency,
        "frequency_changes": [*by_frequency.values()],
        "faster_by": max(frequency_ratios),
        "alike": alike,
        "alike_shares": [sum(flags) / len(flags) for flags in alike.values()],
        "from_130_to_150": from_130_to_150,
    }


def _measured_velocities_by_frequency(
    study: EfficiencyStudy, sweep: SweepResult
) -> Mapping[str, dict[int, float]]:
    """Return measured velocities [m/s] on the line of a sweep by group and frequency [deg/s]."""
    velocities: dict[str, dict[int, float]] = {group.name: {} for group in study.settings.groups}
    for case in study.measured:
        gait = case.measured.gait
        if sweep.settings.contains(gait):
            frequency = round(math.degrees(gait.frequency))
            velocities[case.group.name][frequency] = case.measured.forward_velocity or 0.0
    return velocities


def _rank_power_alike(study: EfficiencyStudy, group: str) -> list[bool]:
    """Return for each pair of settings whether measured and simulated power rank it alike."""
    cases = [
        case
        for case in study.cases
        if case.group.name == group and case.measured.mean_power is not None
    ]
    measured = [case.measured.mean_power or 0.0 for case in cases]
    simulated = [case.mechanical_power[study.judged] for case in cases]
    alike: list[bool] = []
    for i, k in combinations(range(len(cases)), 2):
        alike.append((measured[i] - measured[k]) * (simulated[i] - simulated[k]) > 0.0)
    return alike


def _explained_by_line_through_origin(
    x: Float[np.ndarray, " n"], y: Float[np.ndarray, " n"]
) -> float:
    """Return the coefficient of determination of the best line y = k x [-]."""
    residual = y - x * float(x @ y) / float(x @ x)
    return 1.0 - float(residual @ residual) / float(np.sum((y - np.mean(y)) ** 2))
