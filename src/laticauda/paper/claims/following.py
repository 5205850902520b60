"""Claims about path following."""

import math
from collections.abc import Callable, Sequence
from statistics import fmean

import numpy as np

from laticauda.gaits import GAIT_WORDS
from laticauda.paper.claims.claim import Finding, Statement, percent, share, spread, verdict
from laticauda.paper.path_following import FollowingCase, FollowingRun, PathFollowingStudy
from laticauda.paper.table2 import fin_changes
from laticauda.trial import following

ABOUT_ZERO = 0.02  # mean error that still counts as zero [m]
FOLLOWED = 5.0  # root mean square of the heading error [deg]
NEARLY_DOUBLE = 75.0  # [%]
INDEPENDENT = 10.0  # spread within a group, share of its mean [%]


def _how(study: PathFollowingStudy) -> str:
    coefficients = study.settings.coefficients.name
    return f"Simulated, {study.how['joints']} joints, {coefficients}, bandwidth {study.how['offset_bandwidth']:g} rad/s"


def _converged(study: PathFollowingStudy, cases: Sequence[FollowingCase]) -> Finding:
    accepted = study.settings.accepted_error
    came = [case.run.converged for case in cases]
    rms = [_late(case.run) for case in cases]
    stayed = [value <= accepted for value in rms]
    ways = [run.converged and _late(run) <= accepted for case in cases for run in case.band]
    text = (
        f"{_how(study)}: {share(came)} came within 0.1 m for a whole gait cycle; the root mean square of the "
        f"cycle-mean error over the last third is at most {max(rms):.2g} m. Over all joint laws and bandwidths that "
        f"were tried, {share(ways)} runs came there and stayed."
    )
    return text, verdict(all(came), all(stayed))


def _late(run: FollowingRun) -> float:
    """Root mean square of the cycle-mean error over the last third [m]."""
    return math.inf if run.last_third_rms is None else run.last_third_rms


def _all_converge(study: PathFollowingStudy) -> Finding:
    return _converged(study, study.cases)


def _fin_converges(study: PathFollowingStudy) -> Finding:
    return _converged(study, [case for case in study.cases if case.group.has_fin])


def _about_zero(study: PathFollowingStudy) -> Finding:
    means = [case.run.figures["last_third_error"] for case in study.cases]
    ripples = [case.run.figures["ripple"] for case in study.cases]
    known = [value for value in means if value is not None]
    swing = [value for value in ripples if value is not None]
    near = [value is not None and abs(value) <= ABOUT_ZERO for value in means]
    text = f"{_how(study)}: mean error over the last third {spread(known, '+.4f', 'm')}"
    if swing:
        text += f"; swing about it, root mean square, {spread(swing, '.3f', 'm')}"
    return f"{text}.", verdict(all(near))


def _heading_follows(study: PathFollowingStudy) -> Finding:
    errors = [_heading_errors(case) for case in study.cases]
    mean, instant = zip(*errors, strict=True)
    text = (
        f"{_how(study)}: root mean square of the heading error over the last third {spread(mean, '.1f', 'deg')} for "
        f"its mean over the gait cycle, and {spread(instant, '.1f', 'deg')} with the gait's swing."
    )
    return text, verdict(max(mean) <= FOLLOWED, max(instant) <= FOLLOWED)


def _heading_errors(case: FollowingCase) -> tuple[float, float]:
    """Root mean square of the heading error over the last third, of its cycle mean and as it is [deg]."""
    trial = case.trial
    assert trial.period is not None
    begin = trial.time[0] + 2.0 / 3.0 * trial.duration
    error = np.degrees(trial.signals["heading_ref"] - trial.signals["heading_used"])
    middle, mean = following.mean_error(trial.time, error, trial.period)
    return _rms(mean[middle >= begin]), _rms(error[trial.time >= begin])


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _faster_convergence(study: PathFollowingStudy) -> Finding:
    words: list[str] = []
    parts: list[bool] = []
    for gait in dict.fromkeys(group.gait for group in study.settings.groups):
        for name, unit in (("convergence_time", "s"), ("convergence_distance", "m")):
            bare, fin = (_group_mean(study, gait, has_fin, name) for has_fin in (False, True))
            words.append(f"{GAIT_WORDS[gait]} {_shown(bare, unit)} without and {_shown(fin, unit)} with fin")
            parts.append(fin < bare)
    text = (
        f"{_how(study)}, mean over the cases until the path is reached: {'; '.join(words)}. The starts differ from "
        "case to case."
    )
    return text, verdict(*parts)


def _group_mean(study: PathFollowingStudy, gait: str, has_fin: bool, name: str) -> float:
    """Mean of a figure over the cases of a group; infinite if a run never came to the path."""
    cases = [case for case in study.cases if (case.group.gait, case.group.has_fin) == (gait, has_fin)]
    values = [case.run.figures[name] for case in cases]
    return fmean(math.inf if value is None else value for value in values)


def _shown(value: float, unit: str) -> str:
    return f"{value:.2f} {unit}" if math.isfinite(value) else "(not reached in all cases)"


def _speed_doubles(study: PathFollowingStudy) -> Finding:
    changes = fin_changes(study)
    measured = [change.measured_velocity for change in changes]
    simulated = [change.simulated_velocity for change in changes]
    band = [value for change in changes for value in change.band_velocity]
    text = (
        f"Recomputed from Table 2: {', '.join(percent(value) for value in measured)}. {_how(study)}: "
        f"{', '.join(percent(value) for value in simulated)}; over all joint laws and bandwidths {spread(band)}."
    )
    return text, verdict(min(measured) >= NEARLY_DOUBLE, min(simulated) >= NEARLY_DOUBLE)


def _independent(study: PathFollowingStudy) -> Finding:
    sources: dict[str, Callable[[FollowingCase], float]] = {
        "measured velocity": lambda case: case.measured.forward_velocity,
        "measured power": lambda case: case.measured.mean_power,
        "simulated velocity": lambda case: case.run.forward_velocity,
        "simulated power": lambda case: case.run.mechanical_power,
    }
    spreads = {name: _spreads(study, figure) for name, figure in sources.items()}
    words = "; ".join(f"{name} {spread(found, '.0f')}" for name, found in spreads.items())
    text = f"Largest minus smallest value over the mean, in the four groups: {words}. {_how(study)}."
    return text, verdict(*(max(found) <= INDEPENDENT for found in spreads.values()))


def _spreads(study: PathFollowingStudy, figure: Callable[[FollowingCase], float]) -> list[float]:
    """By group, largest minus smallest value over their mean [%]."""
    found: list[float] = []
    for group in study.settings.groups:
        values = [figure(case) for case in study.cases if case.group == group]
        found.append(100.0 * (max(values) - min(values)) / fmean(values))
    return found


STATEMENTS = (
    Statement(
        key="path-converges",
        where="4.6, Figs. 12a to 23a",
        paper="The robot reaches the path and follows it in all 12 trials.",
        rule="All come within 0.1 m for a gait cycle; all stay there on average over the last third of the run.",
        needs=("following",),
        judge=_all_converge,
    ),
    Statement(
        key="path-about-zero",
        where="4.6, Figs. 12b to 23b",
        paper="The cross-track error converges to zero and oscillates about it.",
        rule="The mean error over the last third is within 2 cm of zero in all trials.",
        needs=("following",),
        judge=_about_zero,
    ),
    Statement(
        key="path-heading",
        where="4.6, Figs. 12c to 23c",
        paper="The heading follows its reference in all trials.",
        rule="The heading error is 5 deg or less (root mean square, last third) as a mean over the gait cycle; with "
        "the gait's swing.",
        needs=("following",),
        judge=_heading_follows,
    ),
    Statement(
        key="path-faster-with-fin",
        where="4.6, Figs. 12 to 17",
        paper="With the fin the robot comes to the path much sooner.",
        rule="The mean over the cases is smaller with the fin, in each gait: for time; for distance.",
        needs=("following",),
        judge=_faster_convergence,
    ),
    Statement(
        key="path-speed-doubles",
        where="4.6, Table 2",
        paper="Along the path the fin nearly doubles the speed: printed +107, +122, +109, +102, +86 and +78 %.",
        rule="All gains are +75 % or more as measured; as simulated.",
        needs=("following",),
        judge=_speed_doubles,
    ),
    Statement(
        key="path-independent",
        where="4.6",
        paper="Speed and power do not depend on where the robot starts; the gait sets them without feedback.",
        rule="Within every group they differ by 10 % or less: measured velocity; measured power; simulated velocity; "
        "simulated power.",
        needs=("following",),
        judge=_independent,
    ),
    Statement(
        key="path-same-controller",
        where="Abstract, 5",
        paper="The controller for the robot without fin works with the fin as it is.",
        rule="With the same settings all trials with the fin come within 0.1 m for a gait cycle; all stay there.",
        needs=("following",),
        judge=_fin_converges,
    ),
)
