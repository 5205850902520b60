"""The numbers used in claims and reports, by study; `claims.toml` refers to them by name."""

import math
from collections.abc import Callable, Mapping, Sequence
from itertools import combinations
from statistics import fmean
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda import scenarios
from laticauda.motion import gaits
from laticauda.paper.efficiency import Case, EfficiencyStudy, maxima
from laticauda.paper.measured import path_following_trials, percent_change, printed_changes
from laticauda.paper.path_following import FollowingCase, PathFollowingStudy
from laticauda.paper.scores import FinGain, Score, fin_gains, score_study
from laticauda.paper.side_trials import ROBOT, SHALLOW, SideTrials
from laticauda.robot import load_robot, load_water
from laticauda.trials import following as figures_of_path

PAPERS = ("analytical-set", "vortex-set")
"""Names of the paper's coefficients for its analytical model and for its Vortex model."""

Numbers = dict[str, Any]

MODELS: Numbers = {"dt": 0.0005, "path": 1.8e-5}
"""Difference between planar and spatial model over the distance, at a step [s]; result of campaigns/parity.py."""


def tables() -> Numbers:
    """Return the changes due to the fin, recomputed from Table 2 [%]."""
    changes = printed_changes(path_following_trials())
    gain, power = ([getattr(change, name) for change in changes] for name in ("velocity", "power"))
    return {"gain": gain, "power": power, "energy": [*map(_per, power, gain)]}


def robots() -> Numbers:
    """Return how much longer the fin makes the robot [%], and the coefficients that the paper identified."""
    robot, modules = load_robot("mamba-fin"), load_robot("mamba-modules-fin")
    assert robot.caudal_fin is not None
    fin, link = robot.caudal_fin.length, robot.modules[0].length
    longer, of_modules, of_printed = (
        100.0 * fin / length for length in (robot.length, modules.length, 20 * link)
    )
    return {
        "fin": fin,
        "link": link,
        "robot": robot,
        "modules": modules,
        "longer": longer,
        "modules_longer": of_modules,
        "printed_longer": of_printed,
        "lateral_friction": load_water("paper-lateral").tangential_friction,
        "eel_friction": load_water("paper-eel").tangential_friction,
    }


# ---- efficiency ----------------------------------------------------------------------------------


def efficiency(study: EfficiencyStudy) -> Numbers:
    """Return the findings of the efficiency study: effect of the fin, agreement, trends.

    Args:
        study: Result of `run_efficiency`.
    """
    found = maxima(study)
    phase = next(
        one
        for one in found
        if (one.parameter, one.group) == ("phase_shift", study.settings.groups[0])
    )
    return {
        "joints": study.how["joints"],
        "kind": study.how["model"],
        "model": study.models[study.judged],
        **_fin(study),
        **_agreement(study),
        **_trends(study),
        "optimum": math.degrees(phase.simulated_at[study.judged]),
        "measured_optimum": math.degrees(phase.measured_at),
        # Less by a billionth, to allow for rounding.
        "distances": [math.degrees(one.distance(study.judged) - 1e-9) for one in found],
        "at_the_end": [one.at_the_end[study.judged] for one in found],
    }


def fin_by_gait(study: EfficiencyStudy) -> dict[str, Numbers]:
    """Return by gait how much faster the fin makes the robot where measured: as measured, and by model [%].

    Args:
        study: Result of `run_efficiency`.
    """
    gains = [gain for gain in fin_gains(study.cases) if gain.measured.velocity is not None]
    kinds = {
        kind: [gain for gain in gains if gain.with_fin.group.gait == kind]
        for kind in gaits.GAIT_WORDS
    }
    return {
        kind: {
            "measured": [gain.measured.velocity for gain in here],
            "by_model": {name: _faster(here, i) for i, name in enumerate(study.models)},
        }
        for kind, here in kinds.items()
    }


def best_null(found: Sequence[Score]) -> Score:
    """Return the null model with the smallest error on rows of Table 1 to which it was not fitted.

    Args:
        found: Scores of Table 1.
    """
    return min(
        (one for one in found if one.leave_one_out is not None),
        key=lambda score: score.leave_one_out or 0.0,
    )


def _fin(study: EfficiencyStudy) -> Numbers:
    """Return the changes due to the fin [%]."""
    gains = fin_gains(study.cases)
    known = [(gain, gain.measured.velocity) for gain in gains if gain.measured.velocity is not None]
    velocity = [value for _, value in known]
    power = [
        (gain.measured.power, value) for gain, value in known if gain.measured.power is not None
    ]
    simulated_power = [
        gain.simulated(lambda case: case.mechanical_power[study.judged]) for gain in gains
    ]
    by_gait = fin_by_gait(study)
    return {
        "gains": {
            kind: {**found, "simulated": found["by_model"][study.models[study.judged]]}
            for kind, found in by_gait.items()
        },
        "gain": velocity,
        "gain_rows": [
            (gain.with_fin.group.name, gain.with_fin.measured.case, value) for gain, value in known
        ],
        "gain_of_both_tables": [*velocity, *tables()["gain"]],
        "simulated_gain": _faster([gain for gain, _ in known], study.judged),
        "n_settings": len(gains),
        "power": [gain.measured.power for gain in gains if gain.measured.power is not None],
        "simulated_power": simulated_power,
        "energy": [_per(*pair) for pair in power],
        "simulated_energy": [*map(_per, simulated_power, _faster(gains, study.judged))],
    }


def _faster(gains: Sequence[FinGain[Case]], model: int) -> list[float]:
    return [gain.simulated(lambda case: case.forward_velocity[model]) for gain in gains]


def _per(power: float, velocity: float) -> float:
    """Return the change of energy per meter from the changes of power and velocity [%]."""
    return 100.0 * ((100.0 + power) / (100.0 + velocity) - 1.0)


def _agreement(study: EfficiencyStudy) -> Numbers:
    """Return the errors of the simulated forward velocity over the measured rows of Table 1 [%]."""
    groups, found = study.settings.groups, score_study(study)
    mean = {
        one.name: dict(zip((group.name for group in groups), one.by_group, strict=True))
        for one in found
    }
    judged, by_papers = (
        found[study.judged],
        [mean[name] for name in PAPERS if set(PAPERS) <= set(study.models)],
    )
    own = mean[judged.name]
    papers = {
        group.name: [one[group.name] for one in by_papers]
        for group in groups
        if group.has_fin and by_papers
    }
    pairs = [
        (a.name, b.name)
        for a in groups
        for b in groups
        if a.gait == b.gait and a.has_fin < b.has_fin
    ]
    errors: dict[str, list[float]] = {group.name: [] for group in groups}
    for case, measured, speed in zip(study.measured, judged.measured, judged.speeds, strict=True):
        errors[case.group.name].append(percent_change(measured, speed))
    best = best_null(found)
    return {
        "errors": errors,
        "mean_error": own,
        "papers": papers,
        "vortex_excess": [other - one for one, other in papers.values()],
        "pairs": pairs,
        "excess_with_fin": [own[fin] - own[bare] for bare, fin in pairs],
        "overall": judged.overall,
        "n_measured": len(study.measured),
        "best": best,
        "excess_over_null": judged.overall - (best.leave_one_out or 0.0),
    }


def _trends(study: EfficiencyStudy) -> Numbers:
    """Return trends of velocity over the frequency, and of power over all settings."""
    sweep = next(sweep for sweep in study.sweeps if sweep.settings.parameter == "frequency")
    speeds: dict[str, dict[int, float]] = {
        group.name: {} for group in study.settings.groups
    }  # by degrees per second
    for case in study.measured:
        if sweep.settings.contains(gait := case.measured.gait):
            speeds[case.group.name][round(math.degrees(gait.frequency))] = (
                case.measured.forward_velocity or 0.0
            )
    ends = {name: (min(found), max(found)) for name, found in speeds.items()}
    changes = {
        name: percent_change(speeds[name][low], speeds[name][high])
        for name, (low, high) in ends.items()
    }
    alike = {group.name: _alike(study, group.name) for group in study.settings.groups}
    return {
        "explained": [
            _through_origin(sweep.values, curve) for curve in sweep.forward_velocity[study.judged]
        ],
        "by_frequency": changes,
        "frequency_changes": [*changes.values()],
        "faster_by": max(percent_change(*pair) for pair in ends.values()),
        "alike": alike,
        "alike_shares": [sum(values) / len(values) for values in alike.values()],
        "from_130_to_150": {
            name: percent_change(found[130], found[150])
            for name, found in speeds.items()
            if {130, 150} <= {*found}
        },
    }


def _alike(study: EfficiencyStudy, group: str) -> list[bool]:
    """Return for each pair of settings whether measured and simulated power rank it alike."""
    cases = [
        case
        for case in study.cases
        if case.group.name == group and case.measured.mean_power is not None
    ]
    rows = [
        (case.measured.mean_power or 0.0, case.mechanical_power[study.judged]) for case in cases
    ]
    return [(one[0] - other[0]) * (one[1] - other[1]) > 0.0 for one, other in combinations(rows, 2)]


def _through_origin(x: Float[np.ndarray, " n"], y: Float[np.ndarray, " n"]) -> float:
    """Return the coefficient of determination of the best line y = k x [-]."""
    residual = y - x * float(x @ y) / float(x @ x)
    return 1.0 - float(residual @ residual) / float(np.sum((y - np.mean(y)) ** 2))


# ---- other studies -------------------------------------------------------------------------------


def side(study: SideTrials) -> Numbers:
    """Return the findings of the side trials: changes in %, and the factor of power for twice the links.

    Args:
        study: Result of `run_side_trials`.
    """

    def in_words(changes: Mapping[str, float]) -> dict[str, float]:
        return {gaits.GAIT_WORDS[kind]: value for kind, value in changes.items()}

    settings, first = study.settings, study.settings.doubled[0]
    kept: dict[str, list[tuple[str, float, float]]] = {}
    for one in study.doublings:
        assert one.shorter.gait is not None
        row = (one.shorter.gait.words, one.velocity_change, one.power_factor)
        kept.setdefault(one.kept, []).append(row)
    _, change, factor = zip(*kept["phase shift"], strict=True)
    return {
        "joints": study.how["joints"],
        "settings": settings,
        "shallow": SHALLOW,
        "by_depth": in_words(study.by_depth),
        "by_added_inertia": in_words(study.by_added_inertia),
        "inertia_changes": [*study.by_added_inertia.values()],
        "optimum": math.degrees(study.pd_optimum),
        "robot": ROBOT,
        **{
            name: math.degrees(getattr(first, name))
            for name in ("amplitude", "frequency", "phase_shift")
        },
        "same_phase_shift": kept["phase shift"],
        "same_waves": kept["number of waves"],
        "velocity_change": change,
        "power_factor": factor,
    }


def following(study: PathFollowingStudy) -> Numbers:
    """Return the findings of the path-following study.

    Args:
        study: Result of `run_path_following`.
    """
    how, figures = study.how, [case.run.figures for case in study.cases]
    means = [figure["last_third_error"] for figure in figures]
    mean_heading, heading = zip(*map(_heading_errors, study.cases), strict=True)
    gains, convergence = fin_gains(study.cases), _convergence(study)
    sources: dict[str, Callable[[FollowingCase], float]] = {
        "measured velocity": lambda case: case.measured.forward_velocity,
        "measured power": lambda case: case.measured.mean_power,
        "simulated velocity": lambda case: case.run.forward_velocity,
        "simulated power": lambda case: case.run.mechanical_power,
    }
    return {
        "how": f"{how['joints']} joints, {study.settings.coefficients.name}, {scenarios.loop_in_words(how)}",
        "all": _kept(study, study.cases),
        "fin": _kept(study, [case for case in study.cases if case.group.has_fin]),
        "means": [math.nan if value is None else value for value in means],
        "known_means": [value for value in means if value is not None],
        "ripples": [figure["ripple"] for figure in figures if figure["ripple"] is not None],
        "mean_heading": mean_heading,
        "heading": heading,
        "convergence": convergence,
        "later_with_fin": [fin - bare for _, _, bare, fin in convergence],
        "gain": [gain.measured.velocity for gain in gains],
        "simulated_gain": [gain.simulated(sources["simulated velocity"]) for gain in gains],
        "band_gain": [change for gain in gains for change in band_gains(gain)],
        "spreads": {name: _spreads(study, figure) for name, figure in sources.items()},
    }


def band_gains(gain: FinGain[FollowingCase]) -> list[float]:
    """Return how much faster the fin makes the robot, for every combination in the band [%].

    Args:
        gain: Change from a case of Table 2 to the case with the fin.
    """
    ways = range(len(gain.without.band))
    return [gain.simulated(lambda case, way=way: case.band[way].forward_velocity) for way in ways]


def _kept(study: PathFollowingStudy, cases: Sequence[FollowingCase]) -> Numbers:
    """Return which runs converged to the path, and which stayed there."""
    accepted = study.settings.accepted_error
    rms = [_late(case.run) for case in cases]
    return {
        "came": [case.run.converged for case in cases],
        "rms": rms,
        "stayed": [value <= accepted for value in rms],
        "ways": [run.converged and _late(run) <= accepted for case in cases for run in case.band],
    }


def _late(run: Any) -> float:
    """Return the root mean square of the cycle-mean error over the last third [m]."""
    return math.inf if run.last_third_rms is None else run.last_third_rms


def _heading_errors(case: FollowingCase) -> tuple[float, float]:
    """Return the root mean square of the heading error over the last third, of its cycle mean and unaveraged [deg]."""
    trial = case.trial
    assert trial.period is not None
    begin = trial.time[0] + 2.0 / 3.0 * trial.duration
    error = np.degrees(trial.signals["heading_ref"] - trial.signals["heading_used"])
    late = figures_of_path.last_third(trial.time, error, trial.period), error[trial.time >= begin]
    return float(np.sqrt(np.mean(late[0] ** 2))), float(np.sqrt(np.mean(late[1] ** 2)))


def _convergence(study: PathFollowingStudy) -> list[tuple[str, str, float, float]]:
    """Return by gait time [s] and distance [m] to reach the path, without and with the fin; infinite if not reached."""

    def mean(gait: str, has_fin: bool, name: str) -> float:
        cases = [
            case for case in study.cases if (case.group.gait, case.group.has_fin) == (gait, has_fin)
        ]
        values = [case.run.figures[name] for case in cases]
        return fmean(math.inf if value is None else value for value in values)

    return [
        (gaits.GAIT_WORDS[gait], unit, mean(gait, False, name), mean(gait, True, name))
        for gait in dict.fromkeys(group.gait for group in study.settings.groups)
        for name, unit in (("convergence_time", "s"), ("convergence_distance", "m"))
    ]


def _spreads(study: PathFollowingStudy, figure: Callable[[FollowingCase], float]) -> list[float]:
    """Return by group the difference between largest and smallest value over the mean [%]."""
    found = [
        [figure(case) for case in study.cases if case.group == group]
        for group in study.settings.groups
    ]
    return [100.0 * (max(values) - min(values)) / fmean(values) for values in found]
