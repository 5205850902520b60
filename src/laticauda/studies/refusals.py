"""Which limits refused the points of an optimization."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from laticauda.studies.design_limits import BATTERY, battery_share, largest_share, limits_of_body
from laticauda.studies.optimization import (
    VIOLATION,
    Optimization,
    find_bodies,
    speed_of_range,
)
from laticauda.studies.sampling import Table
from laticauda.trials.feasibility import ROUNDING

JOINTS = "joints"
SPEED = "speed"


def count_refusals(
    optimization: Optimization, points: Table, results: Mapping[str, Any]
) -> dict[str, int]:
    """Return how many points every limit refused, each counted where it is exceeded most.

    Args:
        optimization: The optimization; without limits of a design, nothing is counted.
        points: Points that were tried.
        results: Their figures, and `VIOLATION`.
    """
    if not optimization.limits_design:
        return {}
    refused = np.flatnonzero(results[VIOLATION] > 0.0)
    counts: dict[str, int] = {}
    bodies = find_bodies(optimization, points[refused])
    speed = results[speed_of_range(optimization.scenario)]
    for row, i in enumerate(refused.tolist()):
        shares = {JOINTS: results["utilization"][[i]] / optimization.servo_share}
        for name, limit in optimization.load_limits.items():
            shares[name.replace("_", " ")] = results[name][[i]] / limit
        if bodies:
            shares |= limits_of_body(optimization, bodies[row])
            idle_power = np.array([bodies[row].idle_power])
            battery = battery_share(
                optimization, results["mean_power"][[i]], speed[[i]], idle_power
            )
            if battery is not None:
                shares[BATTERY] = battery
        finite_shares = {
            name: values for name, values in shares.items() if np.all(np.isfinite(values))
        }
        largest = largest_share(finite_shares)
        limit = largest.limit
        if largest.share <= 1.0 + ROUNDING:
            # No share is too large: it did not swim, or it is too slow.
            limit = JOINTS
            if np.isfinite(speed[i]):
                limit = SPEED
        counts[limit] = counts.get(limit, 0) + 1
    return counts
