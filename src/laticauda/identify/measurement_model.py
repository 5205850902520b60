"""The measurement model: what a tracker and a meter would show of a run."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.identify.measurements import Measurement
from laticauda.interfaces import Resumed, Start

Run = dict[str, Any]
"""What a run gave, by name of figure or series; complex if it has a derivative."""


def measured_values(measurement: Measurement, run: Mapping[str, Any], nuisance: Mapping[str, Any]) -> np.ndarray:
    """What a measurement would show of a run: the tracked point, the tracker's heading, the meter's power.

    Args:
        measurement: Says what was measured.
        run: What the run gave.
        nuisance: Values of `NUISANCE` by name; what is missing is 0.
    """
    ahead, left = nuisance.get("measured.offset_x", 0.0), nuisance.get("measured.offset_y", 0.0)
    turned, more = nuisance.get("measured.heading_offset", 0.0), nuisance.get("measured.power_offset", 0.0)
    figures: list[Any] = []
    for name in measurement.figures:
        value: Any = run[name]
        if name == "heading":
            value = value + turned
        elif name == "mean_power":
            value = value + more
        elif name == "x":
            value = value + ahead * np.cos(run["heading"]) - left * np.sin(run["heading"])
        elif name == "y":
            value = value + ahead * np.sin(run["heading"]) + left * np.cos(run["heading"])
        figures.append(value)
    parts = [np.array(figures)]
    for name in measurement.series:
        value = run[f"{name} series"]
        if name == "heading":
            value = value + turned
        elif name == "center_of_mass" and (ahead != 0.0 or left != 0.0):
            c, s = np.cos(run["heading series"]), np.sin(run["heading series"])
            value = value + np.stack((ahead * c - left * s, ahead * s + left * c), axis=1)
        parts.append(np.ravel(value))
    return np.concatenate(parts)


def shifted(start: Start | Resumed, name: str, value: float) -> Start:
    """A start with one number added: identified starts are what is to be added to the stated ones.

    Args:
        start: As it is stated.
        name: Of the number: start.x, start.y, start.heading or start.velocity.
        value: What is added.
    """
    assert isinstance(start, Start)  # as measurements check
    x, y = start.center_of_mass
    if name == "start.heading":
        return replace(start, heading=start.heading + value)
    if name == "start.velocity":
        return replace(start, velocity=start.velocity + value)
    return replace(start, center_of_mass=(x + value, y) if name == "start.x" else (x, y + value))


def interpolated(time: Float[np.ndarray, " n"], values: np.ndarray, moments: Float[np.ndarray, " m"]) -> np.ndarray:
    """Samples at other moments: the cubic through the four nearest ones, on an even grid of at least four samples.

    Args:
        time: Of the samples [s].
        values: The samples, time first; may be complex.
        moments: [s].
    """
    step = (time[-1] - time[0]) / (time.size - 1)
    place = (moments - time[0]) / step
    first = np.clip(np.floor(place).astype(int) - 1, 0, max(time.size - 4, 0))
    s = place - first
    n = min(4, time.size)
    result = 0.0
    for j in range(n):
        others = [k for k in range(n) if k != j]
        weight = np.prod([(s - k) / (j - k) for k in others], axis=0)
        result = result + weight.reshape(-1, *[1] * (values.ndim - 1)) * values[first + j]
    return np.asarray(result)
