"""What a tracker and a meter would show of a run, and where a run begins."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.identify.measurements import Measurement
from laticauda.identify.problem import Problem
from laticauda.interfaces import Start

SAMPLE_INTERVAL = 0.05  # of the logs that series are interpolated from [s]

Raw = dict[str, Any]
"""What a run gave, by name of figure or series; complex if it has a derivative."""
Values = Float[np.ndarray, " n_unknowns"]


def seen(measurement: Measurement, raw: Mapping[str, Any], side: Mapping[str, Any]) -> np.ndarray:
    """What a measurement would show of a run: the tracked point, the tracker's heading, the meter's power.

    Args:
        measurement: Says what was measured.
        raw: What the run gave, as `Raw`.
        side: Values of `SIDE` by name; what is missing is 0.
    """
    ahead, left = side.get("measured.offset_x", 0.0), side.get("measured.offset_y", 0.0)
    turned, more = side.get("measured.heading_offset", 0.0), side.get("measured.power_offset", 0.0)
    figures: list[Any] = []
    for name in measurement.figures:
        value: Any = raw[name]
        if name == "heading":
            value = value + turned
        elif name == "mean_power":
            value = value + more
        elif name == "x":
            value = value + ahead * np.cos(raw["heading"]) - left * np.sin(raw["heading"])
        elif name == "y":
            value = value + ahead * np.sin(raw["heading"]) + left * np.cos(raw["heading"])
        figures.append(value)
    parts = [np.array(figures)]
    for name in measurement.series:
        value = raw[f"{name} series"]
        if name == "heading":
            value = value + turned
        elif name == "center_of_mass" and (ahead != 0.0 or left != 0.0):
            c, s = np.cos(raw["heading series"]), np.sin(raw["heading series"])
            value = value + np.stack((ahead * c - left * s, ahead * s + left * c), axis=1)
        parts.append(np.ravel(value))
    return np.concatenate(parts)


def starts_of(problem: Problem, values: Values) -> list[Start]:
    """Where every trial begins."""
    found: list[Start] = []
    for i, measurement in enumerate(problem.measurements):
        side, begin = problem.side(i, values), measurement.start
        for name in ("start.x", "start.y", "start.heading", "start.velocity"):
            if name in side:
                begin = moved_start(begin, name, float(side[name]))
        found.append(begin)
    return found


def moved_start(start: Start, name: str, value: float) -> Start:
    """A start with one number added: identified starts are what is to be added to the stated ones."""
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
