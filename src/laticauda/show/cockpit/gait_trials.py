"""Trials over amplitude and frequency of a gait, for the gait map."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

import laticauda as lc
from laticauda.studies import COSTS, describe_limits, swim_points, swum_figure
from laticauda.trials.feasibility import CAN_DO

AMPLITUDES = tuple(float(value) for value in range(5, 65, 5))
"""Amplitudes of the map [deg]."""
FREQUENCIES = tuple(float(value) for value in range(20, 220, 20))
"""Frequencies of the map [deg/s]."""
QUANTITIES = ("forward_velocity", "mean_power", "cost_of_transport")
"""Mapped quantities of the trials; where the water moves, the velocity is that through it."""
SHARE = "utilization"
"""Share of what the robot offers, computed with them; a robot can do up to 1."""
DURATION = 20.0
"""Duration of every trial [s]."""
SAMPLE_INTERVAL = 0.05
"""Time between two samples of a trial [s]."""


def strip_scenario(scenario: lc.Scenario) -> lc.Scenario:
    """Return what the map depends on, in the plane and without steering.

    Scenarios for which this is the same share a map.

    Args:
        scenario: The scenario.
    """
    gait = replace(scenario.gait, amplitude=0.0, frequency=0.0)
    return replace(scenario, motion=gait, model=lc.Planar(joints=scenario.model.joints))


def map_gaits(scenario: lc.Scenario) -> dict[str, np.ndarray]:
    """Compute trials of `DURATION` from rest in one batch: `QUANTITIES` and `SHARE`, over frequency and amplitude.

    Args:
        scenario: The scenario.

    Raises:
        ValueError: If the batch cannot compute such trials.
    """
    base = _scenario_of_trials(scenario)
    shape = (len(FREQUENCIES), len(AMPLITUDES))
    amplitude, frequency = np.meshgrid(np.radians(AMPLITUDES), np.radians(FREQUENCIES))
    points = np.stack((amplitude.ravel(), frequency.ravel()), axis=1)
    results = swim_points(base, ("gait.amplitude", "gait.frequency"), points)
    # The fastest over ground would be the gait that leaves most to a current.
    results["forward_velocity"] = results[swum_figure("forward_velocity", base)]
    return {name: results[name].reshape(shape) for name in (*QUANTITIES, SHARE)}


def _scenario_of_trials(scenario: lc.Scenario) -> lc.Scenario:
    """Return what the trials of the map share."""
    return replace(strip_scenario(scenario), duration=DURATION, sample_interval=SAMPLE_INTERVAL)


class Trial(NamedTuple):
    """A trial of the map."""

    amplitude: float
    """Amplitude of the gait [deg]."""
    frequency: float
    """Frequency of the gait [deg/s]."""


def find_best_trial(values: np.ndarray, shares: np.ndarray, quantity: str) -> Trial | None:
    """Return the best trial that the robot can do; if it can do none, the best of all; None if all failed.

    Args:
        values: A quantity of every trial, nan where one failed.
        shares: `SHARE` of every trial.
        quantity: Name of the quantity.
    """
    is_candidate = np.isfinite(values)
    if not is_candidate.any():
        return None
    is_possible = is_candidate & (shares <= CAN_DO)
    if is_possible.any():
        is_candidate = is_possible
    worth = values
    if quantity in COSTS:
        worth = -values
    best = np.argmax(np.where(is_candidate, worth, -np.inf))
    return _trial_at(int(best))


def name_limit(scenario: lc.Scenario, results: Mapping[str, np.ndarray]) -> str:
    """Return what limits the speed of the robot on a map; "" if nothing does.

    Args:
        scenario: The scenario of the map.
        results: Result of `map_gaits`.
    """
    shares = results[SHARE]
    trials = [find_best_trial(results["forward_velocity"], shares, "forward_velocity")]
    if np.any(shares > CAN_DO):  # between two trials of the map it may be faster, up to the limit
        first_beyond = int(np.argmin(np.where(shares > CAN_DO, shares, np.inf)))
        trials.append(_trial_at(first_beyond))
    base = _scenario_of_trials(scenario)
    for trial in trials:
        if trial is None:
            continue
        motion = change_wave(base.gait, trial.amplitude, trial.frequency)
        limit = describe_limits([replace(base, motion=motion)])
        if limit:
            return limit
    return ""


def _trial_at(index: int) -> Trial:
    """Return the trial at a flat index of the map."""
    row, column = divmod(index, len(AMPLITUDES))
    return Trial(amplitude=AMPLITUDES[column], frequency=FREQUENCIES[row])


def change_wave(gait: lc.Gait, amplitude_deg: float, frequency_deg_s: float) -> lc.Gait:
    """Return the gait with another amplitude [deg] and frequency [deg/s]."""
    amplitude = math.radians(amplitude_deg)
    frequency = math.radians(frequency_deg_s)
    return replace(gait, amplitude=amplitude, frequency=frequency)
