"""Trials over amplitude and frequency of a gait, for the gait map."""

import math
from dataclasses import replace

import numpy as np

import laticauda as lc

AMPLITUDES = tuple(float(value) for value in range(5, 65, 5))
"""Amplitudes of the map [deg]."""
FREQUENCIES = tuple(float(value) for value in range(20, 220, 20))
"""Frequencies of the map [deg/s]."""
QUANTITIES = ("forward_velocity", "mean_power", "cost_of_transport")
"""Mapped quantities of the trials."""
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
    """Compute trials of `DURATION` from rest in one batch: each of `QUANTITIES`, over frequency and amplitude.

    Args:
        scenario: The scenario.

    Raises:
        ValueError: If the batch cannot compute such trials.
    """
    base = replace(strip_scenario(scenario), duration=DURATION, sample_interval=SAMPLE_INTERVAL)
    trial_scenarios: list[lc.Scenario] = []
    for frequency in FREQUENCIES:
        for amplitude in AMPLITUDES:
            gait = change_wave(base.gait, amplitude, frequency)
            trial_scenarios.append(replace(base, motion=gait))
    swims = lc.swim_many(trial_scenarios)
    shape = (len(FREQUENCIES), len(AMPLITUDES))
    return {name: np.asarray(getattr(swims, name)).reshape(shape) for name in QUANTITIES}


def change_wave(gait: lc.Gait, amplitude_deg: float, frequency_deg_s: float) -> lc.Gait:
    """Return the gait with another amplitude [deg] and frequency [deg/s]."""
    amplitude = math.radians(amplitude_deg)
    frequency = math.radians(frequency_deg_s)
    return replace(gait, amplitude=amplitude, frequency=frequency)
