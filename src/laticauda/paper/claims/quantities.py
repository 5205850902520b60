"""The numbers that claims are judged by, by study; `claims.toml` names them."""

import math
from collections.abc import Callable, Sequence
from itertools import combinations
from statistics import fmean
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.gaits import GAIT_WORDS
from laticauda.paper.efficiency import EfficiencyStudy
from laticauda.paper.links import LinksStudy
from laticauda.paper.parity import ParityStudy
from laticauda.paper.path_following import FollowingCase, PathFollowingStudy
from laticauda.paper.scores import scores
from laticauda.paper.side_trials import SHALLOW, SideTrials
from laticauda.paper.table1 import FinGain, fin_gains, maxima, percent_change
from laticauda.paper.table2 import fin_changes, table2_changes
from laticauda.robot import load_robot, load_water
from laticauda.trial import following as figures_of_path

PAPERS = ("analytical-set", "vortex-set")
"""The paper's coefficients for its analytical model, and for its Vortex model."""

Numbers = dict[str, Any]


def tables() -> Numbers:
    """Changes by the fin, recomputed from Table 2 [%]."""
    gain, power = ([*column] for column in zip(*table2_changes(), strict=True))
    return {"gain": gain, "power": power, "energy": [*map(_per, power, gain)]}


def robots() -> Numbers:
    """How much longer the fin makes the robot [%], and the coefficients that the paper identified."""
    robot, modules = load_robot("mamba-fin"), load_robot("mamba-modules-fin")
    assert robot.caudal_fin is not None
    fin, link = robot.caudal_fin.length, robot.modules[0].length
    longer, of_modules, of_printed = (100.0 * fin / length for length in (robot.length, modules.length, 20 * link))
    lateral, eel = (load_water(name).tangential_friction for name in ("paper-lateral", "paper-eel"))
    return {
        "fin": fin,
        "link": link,
        "length": robot.length,
        "n_links": robot.n_links,
        "n_modules": modules.n_links,
        "module": modules.modules[0].length,
        "longer": longer,
        "modules_longer": of_modules,
        "printed_longer": of_printed,
        "lateral_friction": lateral,
        "eel_friction": eel,
    }


# ---- efficiency ----------------------------------------------------------------------------------------------------


def efficiency(study: EfficiencyStudy) -> Numbers:
    """What the efficiency study says: the fin, agreement, trends.

    Args:
        study: What `run_efficiency` returned.
    """
    return {
        "joints": study.how["joints"],
        "kind": study.how["model"],
        "model": study.models[0],
        **_fin(study),
        **_agreement(study),
        **_trends(study),
        **_starred(study),
    }


def _fin(study: EfficiencyStudy) -> Numbers:
    """Changes by the fin [%]."""
    gains = fin_gains(study)
    known = [gain for gain in gains if gain.measured_velocity is not None]
    velocity = [gain.measured_velocity or 0.0 for gain in known]
    simulated_power = [
        percent_change(gain.without.mechanical_power[0], gain.with_fin.mechanical_power[0]) for gain in gains
    ]
    both = [gain for gain in known if gain.measured_power is not None]
    return {
        "gains": {
            kind: _gains(study, [gain for gain in known if gain.with_fin.group.gait == kind]) for kind in GAIT_WORDS
        },
        "gain": velocity,
        "gain_rows": [(g.with_fin.group.name, g.with_fin.index + 1, v) for g, v in zip(known, velocity, strict=True)],
        "gain_of_both_tables": [*velocity, *tables()["gain"]],
        "simulated_gain": [gain.simulated_velocity[0] for gain in known],
        "n_settings": len(gains),
        "power": [gain.measured_power for gain in gains if gain.measured_power is not None],
        "simulated_power": simulated_power,
        "energy": [_per(gain.measured_power or 0.0, gain.measured_velocity or 0.0) for gain in both],
        "simulated_energy": [
            _per(power, gain.simulated_velocity[0]) for power, gain in zip(simulated_power, gains, strict=True)
        ],
    }


def _gains(study: EfficiencyStudy, gains: Sequence[FinGain]) -> Numbers:
    by_model = {name: [gain.simulated_velocity[i] for gain in gains] for i, name in enumerate(study.models)}
    measured = [gain.measured_velocity for gain in gains]
    return {"measured": measured, "simulated": by_model[study.models[0]], "by_model": by_model}


def _per(power: float, velocity: float) -> float:
    """Change of energy per meter from those of power and velocity [%]."""
    return 100.0 * ((100.0 + power) / (100.0 + velocity) - 1.0)


def _agreement(study: EfficiencyStudy) -> Numbers:
    """Errors of the simulated forward velocity over the measured rows of Table 1 [%]."""
    groups = study.settings.groups
    errors = {group.name: _errors(study, group.name, 0) for group in groups}
    mean = {name: _mean(values) for name, values in errors.items()}
    places = [study.models.index(name) for name in PAPERS] if set(PAPERS) <= set(study.models) else []
    papers = {g.name: [_mean(_errors(study, g.name, i)) for i in places] for g in groups if g.has_fin and places}
    pairs = [(bare.name, fin.name) for bare in groups for fin in groups if _are_pair(bare, fin)]
    found = scores(study)
    best = min((s for s in found if s.leave_one_out is not None), key=lambda score: score.leave_one_out or 0.0)
    return {
        "errors": errors,
        "mean_error": mean,
        "papers": papers,
        "vortex_excess": [other - one for one, other in papers.values()],
        "pairs": pairs,
        "excess_with_fin": [mean[fin] - mean[bare] for bare, fin in pairs],
        "overall": found[0].overall,
        "n_measured": len(study.measured),
        "best": best,
        "excess_over_null": found[0].overall - (best.leave_one_out or 0.0),
    }


def _errors(study: EfficiencyStudy, group: str, model: int) -> list[float]:
    return [
        percent_change(case.measured_velocity, case.forward_velocity[model])
        for case in study.measured
        if case.group.name == group and case.measured_velocity is not None
    ]


def _mean(errors: list[float]) -> float:
    """Mean absolute error [%]."""
    return float(np.mean(np.abs(errors)))


def _are_pair(bare: Any, fin: Any) -> bool:
    return bare.gait == fin.gait and not bare.has_fin and fin.has_fin


def _trends(study: EfficiencyStudy) -> Numbers:
    """Velocity over the frequency, and power over all settings."""
    sweep = next(sweep for sweep in study.sweeps if sweep.settings.parameter == "frequency")
    changes: dict[str, float] = {}
    faster: list[float] = []
    for group in study.settings.groups:
        rows = [case for case in study.measured if case.group == group and sweep.settings.contains(case.gait)]
        slow, fast = (pick(rows, key=lambda case: case.gait.frequency) for pick in (min, max))
        changes[group.name] = percent_change(slow.measured_velocity or 0.0, fast.measured_velocity or 0.0)
        faster.append(percent_change(slow.gait.frequency, fast.gait.frequency))
    alike = {group.name: _alike(study, group) for group in study.settings.groups}
    speeds = {(c.group.name, round(math.degrees(c.gait.frequency))): c.measured_velocity for c in study.cases}
    pairs = {g.name: (speeds[g.name, 130] or 0.0, speeds[g.name, 150] or 0.0) for g in study.settings.groups}
    return {
        "explained": [_through_origin(sweep.values, curve) for curve in sweep.forward_velocity[0]],
        "by_frequency": changes,
        "frequency_changes": [*changes.values()],
        "faster_by": max(faster),
        "alike": alike,
        "alike_shares": [sum(values) / len(values) for values in alike.values()],
        "from_130_to_150": {name: percent_change(*pair) for name, pair in pairs.items() if all(pair)},
    }


def _alike(study: EfficiencyStudy, group: Any) -> list[bool]:
    """Whether measured and simulated power order each pair of settings alike."""
    cases = [case for case in study.cases if case.group == group and case.measured_power is not None]
    rows = [(case.measured_power or 0.0, case.mechanical_power[0]) for case in cases]
    return [(one[0] - other[0]) * (one[1] - other[1]) > 0.0 for one, other in combinations(rows, 2)]


def _through_origin(x: Float[np.ndarray, " n"], y: Float[np.ndarray, " n"]) -> float:
    """Coefficient of determination of the best line y = k x [-]."""
    residual = y - x * float(x @ y) / float(x @ x)
    return 1.0 - float(residual @ residual) / float(np.sum((y - np.mean(y)) ** 2))


def _starred(study: EfficiencyStudy) -> Numbers:
    """The maxima of Table 1 beside the simulated ones [deg, deg/s]."""
    found = maxima(study)
    phase = next(one for one in found if (one.parameter, one.group) == ("phase_shift", study.settings.groups[0]))
    return {
        "optimum": math.degrees(phase.simulated_at[0]),
        "measured_optimum": math.degrees(phase.measured_at),
        # A billionth less, which is rounding.
        "distances": [math.degrees(abs(one.simulated_at[0] - one.measured_at) - 1e-9) for one in found],
        "at_the_end": [one.at_the_end[0] for one in found],
    }


# ---- the others ----------------------------------------------------------------------------------------------------


def side(study: SideTrials) -> Numbers:
    """What the side trials say [%].

    Args:
        study: What `run_side_trials` returned.
    """
    return {
        "joints": study.joints,
        "coefficients": study.settings.coefficients.name,
        "shallow": SHALLOW,
        "by_depth": {GAIT_WORDS[kind]: value for kind, value in study.by_depth.items()},
        "by_added_inertia": {GAIT_WORDS[kind]: value for kind, value in study.by_added_inertia.items()},
        "inertia_changes": [*study.by_added_inertia.values()],
    }


def links(study: LinksStudy) -> Numbers:
    """What twice the links bring in speed [%] and cost in power [-].

    Args:
        study: What `run_links` returned.
    """
    settings = study.settings
    rows = [(d.kept, GAIT_WORDS[d.shorter.gait.kind], d.velocity_change, d.power_factor) for d in study.doublings]
    same_phase_shift = [row[1:] for row in rows if row[0] == "phase shift"]
    return {
        "joints": study.how["joints"],
        "coefficients": settings.coefficients.name,
        "robot": settings.robot,
        "short": settings.n_links[0],
        "long": settings.n_links[1],
        **{name: math.degrees(getattr(settings, name)) for name in ("amplitude", "frequency", "phase_shift")},
        "same_phase_shift": same_phase_shift,
        "same_waves": [row[1:] for row in rows if row[0] == "number of waves"],
        "velocity_change": [change for _, change, _ in same_phase_shift],
        "power_factor": [factor for _, _, factor in same_phase_shift],
    }


def parity(study: ParityStudy) -> Numbers:
    """How far both models are apart at the smallest step.

    Args:
        study: What `run_parity` returned.
    """
    dt, path = min(study.worst("path").items())
    return {"joints": study.joints, "dt": dt, "path": path}


def following(study: PathFollowingStudy) -> Numbers:
    """What the path-following study says.

    Args:
        study: What `run_path_following` returned.
    """
    figures = [case.run.figures for case in study.cases]
    means = [figure["last_third_error"] for figure in figures]
    mean_heading, heading = zip(*(_heading_errors(case) for case in study.cases), strict=True)
    changes = fin_changes(study)
    convergence = [*_convergence(study)]
    sources: dict[str, Callable[[FollowingCase], float]] = {
        "measured velocity": lambda case: case.measured.forward_velocity,
        "measured power": lambda case: case.measured.mean_power,
        "simulated velocity": lambda case: case.run.forward_velocity,
        "simulated power": lambda case: case.run.mechanical_power,
    }
    return {
        "joints": study.how["joints"],
        "bandwidth": study.how["offset_bandwidth"],
        "coefficients": study.settings.coefficients.name,
        "all": _kept(study, study.cases),
        "fin": _kept(study, [case for case in study.cases if case.group.has_fin]),
        "means": [math.nan if value is None else value for value in means],
        "known_means": [value for value in means if value is not None],
        "ripples": [figure["ripple"] for figure in figures if figure["ripple"] is not None],
        "mean_heading": mean_heading,
        "heading": heading,
        "convergence": convergence,
        "later_with_fin": [fin - bare for _, _, bare, fin in convergence],
        "gain": [change.measured_velocity for change in changes],
        "simulated_gain": [change.simulated_velocity for change in changes],
        "band_gain": [value for change in changes for value in change.band_velocity],
        "spreads": {name: _spreads(study, figure) for name, figure in sources.items()},
    }


def _kept(study: PathFollowingStudy, cases: Sequence[FollowingCase]) -> Numbers:
    """Which runs came to the path, and which stayed there."""
    accepted = study.settings.accepted_error
    rms = [_late(case.run) for case in cases]
    return {
        "came": [case.run.converged for case in cases],
        "rms": rms,
        "stayed": [value <= accepted for value in rms],
        "ways": [run.converged and _late(run) <= accepted for case in cases for run in case.band],
    }


def _late(run: Any) -> float:
    """Root mean square of the cycle-mean error over the last third [m]."""
    return math.inf if run.last_third_rms is None else run.last_third_rms


def _heading_errors(case: FollowingCase) -> tuple[float, float]:
    """Root mean square of the heading error over the last third, of its cycle mean and as it is [deg]."""
    trial = case.trial
    assert trial.period is not None
    begin = trial.time[0] + 2.0 / 3.0 * trial.duration
    error = np.degrees(trial.signals["heading_ref"] - trial.signals["heading_used"])
    middle, mean = figures_of_path.mean_error(trial.time, error, trial.period)
    late = mean[middle >= begin], error[trial.time >= begin]
    return float(np.sqrt(np.mean(late[0] ** 2))), float(np.sqrt(np.mean(late[1] ** 2)))


def _convergence(study: PathFollowingStudy) -> list[tuple[str, str, float, float]]:
    """By gait, time [s] and distance [m] until the path is reached, without and with the fin; infinite if it is not."""

    def mean(gait: str, has_fin: bool, name: str) -> float:
        cases = [case for case in study.cases if (case.group.gait, case.group.has_fin) == (gait, has_fin)]
        values = [case.run.figures[name] for case in cases]
        return fmean(math.inf if value is None else value for value in values)

    return [
        (GAIT_WORDS[gait], unit, mean(gait, False, name), mean(gait, True, name))
        for gait in dict.fromkeys(group.gait for group in study.settings.groups)
        for name, unit in (("convergence_time", "s"), ("convergence_distance", "m"))
    ]


def _spreads(study: PathFollowingStudy, figure: Callable[[FollowingCase], float]) -> list[float]:
    """By group, largest minus smallest value over their mean [%]."""
    found: list[float] = []
    for group in study.settings.groups:
        values = [figure(case) for case in study.cases if case.group == group]
        found.append(100.0 * (max(values) - min(values)) / fmean(values))
    return found
