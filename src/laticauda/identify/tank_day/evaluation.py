"""Fit the three laws to a tank day, and judge them."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

import laticauda as lc
from laticauda.identify.conversion import from_trial
from laticauda.identify.fitting import fit
from laticauda.identify.measurements import Measurement
from laticauda.identify.result import Fit
from laticauda.identify.tank_day.folder import RUNS, Day, Noise
from laticauda.identify.tank_day.laws import FRICTION, laws_of, log_evidence
from laticauda.models.planar import PlanarPlant
from laticauda.models.simulate import Progress, silent
from laticauda.motion.gaits import JointAngles, recorded_gait
from laticauda.robot import Environment, Water
from laticauda.values import TrialFileError, optional_import

DECISIVE = 100.0
"""Odds above which a law counts as decided [-]."""
JOINTS = ("joints.speed_limit", "joints.position_gain")
"""Numbers of the joints that are fitted."""
_INTERVAL = 0.25
"""Interval between samples that are used [s]."""
_SMOOTHED = 0.2
"""Window of a cubic smoothing of joint angles, in cycles: keeps noise out of the forces [-]."""
_SMALLEST_SPEED = 0.05
"""Speed at which the drag area is stated if nothing swam faster [m/s]."""
_LARGEST_LOG_ODDS = 700.0
"""Logarithm of the largest odds: e^700 = 1e304 [-]."""
_N_FITS = 4.0
"""Fits of an evaluation: three laws and the joints."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Evaluation:
    """Results of a tank day."""

    fits: Mapping[str, Fit]
    """Fits by law, most probable first."""
    odds: Mapping[str, float]
    """Odds of the most probable law against each law, at most 1e304 [-]."""
    numbers: tuple[Mapping[str, Any], ...]
    """Rows of name, value, ends of the interval (low, high) and unit, by the best law.

    They are numbers of the water, drag area 2 F / (rho v^2) of the straight robot at the speed of
    the day, and joints; None for values not identified.
    """
    joints: Fit | None
    """Fit of the speed and stiffness of the joints (`JOINTS`); None if no gait was commanded."""
    verdict: tuple[str, ...]
    """Sentences on which law is the most probable, and on what the data do not determine."""


def evaluate(day: Day, *, threads: int | None = None, progress: Progress = silent) -> Evaluation:
    """Fit the three laws to a tank day, and judge them.

    Args:
        day: Contents of the folder, from `load_day`.
        threads: Number of threads; None uses all cores available to this process.
        progress: Called with the finished fraction.

    Raises:
        TrialFileError: If nothing was measured.
        SimulationFailed: If a trial cannot be simulated.
    """
    measurements = [_path_and_heading(name, trial, day.noise) for name, trial in day.trials.items()]
    measurements += day.tows
    if not measurements:
        raise TrialFileError(
            "No file was filled in: the tank day needs swim.csv, glide.csv, turn.csv or tows.csv."
        )
    fits: dict[str, Fit] = {}
    for name, law in laws_of(day.robot).items():
        in_water = [_in_environment(measurement, law.water) for measurement in measurements]
        fits[name] = fit(
            in_water, parameters=law.unknowns, n_starts=1, rivals=False, threads=threads
        )
        progress(len(fits) / _N_FITS)
    noise_factor = max(1.0, min(law_fit.noise_factor for law_fit in fits.values()))
    evidence = {name: log_evidence(law_fit, noise_factor) for name, law_fit in fits.items()}
    most_probable_first = sorted(fits, key=lambda name: -evidence[name])
    best_evidence = evidence[most_probable_first[0]]
    odds: dict[str, float] = {}
    for name in most_probable_first:
        log_odds = min(best_evidence - evidence[name], _LARGEST_LOG_ODDS)
        odds[name] = math.exp(log_odds)
    best = fits[most_probable_first[0]]
    identified_water = best.problem.scenarios_at(best.best)[0].environment
    joints = _fit_joints(day, identified_water, threads)
    return Evaluation(
        fits={name: fits[name] for name in most_probable_first},
        odds=odds,
        numbers=tuple(_numbers(day, best, joints)),
        joints=joints,
        verdict=tuple(_verdict(day, best, odds, joints)),
    )


def _in_environment(measurement: Measurement, environment: Environment) -> Measurement:
    scenario = replace(measurement.scenario, environment=environment)
    return replace(measurement, scenario=scenario)


def _measure(name: str, trial: lc.Trial, series: Mapping[str, float]) -> Measurement:
    """Return series of a trial as a measurement, at the interval of the tank day."""
    stride = max(1, round(_INTERVAL / _sample_interval(trial)))
    return from_trial(trial, name=name, series=series, every=stride)


def _sample_interval(trial: lc.Trial) -> float:
    return float(np.median(np.diff(trial.time)))


def _path_and_heading(name: str, trial: lc.Trial, noise: Noise) -> Measurement:
    """Return path and heading of a trial whose joints follow their logged angles."""
    sensors = {"center_of_mass": noise.path_m, "heading": noise.heading_rad}
    measurement = _measure(name, trial, sensors)
    smooth_angle = _smoothed_joint_angle(trial)
    time_from_start = trial.time - trial.time[0]
    angles = JointAngles(
        time=tuple(time_from_start.tolist()),
        angle=tuple(map(tuple, smooth_angle.T.tolist())),
    )
    scenario = replace(measurement.scenario, motion=recorded_gait(angles))
    return replace(measurement, scenario=scenario)


def _smoothed_joint_angle(trial: lc.Trial) -> np.ndarray:
    """Return the joint angles without most of their noise."""
    signal = optional_import("The tank day", "scipy", "identify", "scipy.signal")
    period = trial.period or 0.0
    half_window = max(2, round(_SMOOTHED * period / _sample_interval(trial) / 2.0))
    longest_window = (trial.time.size - 1) // 2 * 2 - 1  # the window must be odd
    window = min(2 * half_window + 1, longest_window)
    return signal.savgol_filter(trial.joint_angle, window, 3, axis=0)


def _fit_joints(day: Day, water: Environment, threads: int | None) -> Fit | None:
    """Fit the numbers of the joints to how they followed the commanded gaits."""
    series = {"joint_angle": day.noise.joint_angle_rad}
    measurements: list[Measurement] = []
    for name, trial in day.trials.items():
        moves_joints = trial.gait is not None and trial.gait.amplitude != 0.0
        if moves_joints:
            measurement = _measure(name, trial, series)
            measurements.append(_in_environment(measurement, water))
    if not measurements:
        return None
    return fit(measurements, parameters=JOINTS, joints=lc.SpeedServo(), n_starts=1, threads=threads)


def _numbers(day: Day, best: Fit, joints: Fit | None) -> list[dict[str, Any]]:
    """Return the rows of the numbers of the water, of the drag area and of the joints."""
    table = best.table()
    numbers = [table[k] for k in best.problem.of_interest]
    speeds = [trial.forward_velocity for trial in day.trials.values()]
    speed_of_day = max([_SMALLEST_SPEED, *speeds])
    numbers.append(_drag_area(best, speed_of_day))
    if joints is not None:
        numbers += joints.table()
    return numbers


def _drag_area(best: Fit, speed: float) -> dict[str, Any]:
    """Return the drag area of the straight robot, with the interval that its friction gives it."""
    scenario = best.problem.scenarios_at(best.best)[0]
    water = cast(Water, scenario.environment)
    (friction,) = [row for row in best.table() if row["name"] == FRICTION]

    def area(tangential_friction: float | None) -> float | None:
        if tangential_friction is None:
            return None
        changed_water = replace(water, tangential_friction=tangential_friction)
        plant = PlanarPlant(robot=scenario.robot, environment=changed_water)
        force_along, _, _ = plant.towing_load(speed)
        return -2.0 * force_along / (water.density * speed**2)

    return {
        "name": f"drag area at {speed:.2g} m/s",
        "value": area(friction["value"]),
        "low": area(friction["low"]),
        "high": area(friction["high"]),
        "unit": "m^2",
    }


def _verdict(day: Day, best: Fit, odds: Mapping[str, float], joints: Fit | None) -> list[str]:
    """Return sentences on which law is the most probable, and on what the data do not determine."""
    best_law, *other_laws = odds
    sentences = [f"The law is `{best_law}`, the most probable of {len(odds)}."]
    for law in other_laws:
        judgment = "the data do not distinguish them"
        if odds[law] > DECISIVE:
            judgment = "decided"
        sentences.append(f"Against `{law}`: odds of {odds[law]:.3g} to 1, {judgment}.")
    sentences += [warning for warning in best.warnings if warning.startswith("chi^2")]
    for k in best.problem.of_interest:
        if _is_hardly_determined(best, k):
            name = best.estimates[k].name
            sentences.append(
                f"The data hardly determine `{name}`: it is essentially its prior, from tables."
            )
    if joints is None or joints[JOINTS[0]].interval is None:
        sentences.append(
            "The data do not determine the speed of the joints: "
            "no commanded gait was too fast for them."
        )
    missing_files = [run for run in RUNS if run not in day.trials]
    if not day.tows:
        missing_files.append("tows")
    for name in missing_files:
        sentences.append(f"Without {name}.csv the data tell less: RUNS.md explains what it is for.")
    return sentences


def _is_hardly_determined(best: Fit, k: int) -> bool:
    """Return whether unknown k is hardly better known than before the tank day."""
    sigma = best.estimates[k].sigma
    if sigma is None:
        return True
    return best.problem.unknowns[k].is_known_from_prior(sigma)
