"""What the sensors show of a run: the tracked point, the tracker's heading, the meter's power.

Sensors are seldom where the model thinks: a marker sits ahead of the center of mass, a tracker's
zero is not the tank's axis, a meter adds the power of its electronics. Such numbers are the
`NUISANCE` parameters of a measurement, 0 unless they are identified.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from laticauda.identify.measurements import Measurement

Nuisance = Mapping[str, Any]
"""Values of the `NUISANCE` parameters of a measurement by name; missing ones are 0."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RunResults:
    """Results of one run, filled in while it is simulated; complex if they carry a derivative."""

    figures: dict[str, Any] = field(default_factory=dict[str, Any])
    """Figures by name (x, y, heading: at the end), or the loads of a tow."""
    series: dict[str, Any] = field(default_factory=dict[str, Any])
    """Series by name, at the times of the measurement, and always the heading with them."""


def measured_values(measurement: "Measurement", run: RunResults, nuisance: Nuisance) -> np.ndarray:
    """Return what a measurement would show of a run: its figures, then its series.

    Args:
        measurement: Defines what was measured.
        run: Results of the run.
        nuisance: Values of the `NUISANCE` parameters by name; missing ones are 0.
    """
    figures = [_shown_figure(name, run, nuisance) for name in measurement.figures]
    series = [np.ravel(_shown_series(name, run, nuisance)) for name in measurement.series]
    return np.concatenate([np.array(figures), *series])


def figures_seen(measurement: "Measurement") -> list[str]:
    """Return the names of the figures of a run on which the measured figures depend.

    Args:
        measurement: Defines what was measured.
    """
    names = list(measurement.figures)
    # The tracked point is off the center of mass in a direction that turns with the heading.
    if ("x" in names or "y" in names) and "heading" not in names:
        names.append("heading")
    return names


def _shown_figure(name: str, run: RunResults, nuisance: Nuisance) -> Any:
    value = run.figures[name]
    if name == "heading":
        return value + nuisance.get("measured.heading_offset", 0.0)
    if name == "mean_power":
        return value + nuisance.get("measured.power_offset", 0.0)
    if name == "x":
        offset_x, _ = _offset_of_tracked_point(run.figures["heading"], nuisance)
        return value + nuisance.get("start.x", 0.0) + offset_x
    if name == "y":
        _, offset_y = _offset_of_tracked_point(run.figures["heading"], nuisance)
        return value + nuisance.get("start.y", 0.0) + offset_y
    return value


def _shown_series(name: str, run: RunResults, nuisance: Nuisance) -> Any:
    samples = run.series[name]
    if name == "heading":
        return samples + nuisance.get("measured.heading_offset", 0.0)
    if name == "center_of_mass":
        # The water is the same everywhere, so that another start only shifts the path.
        start = np.array([nuisance.get("start.x", 0.0), nuisance.get("start.y", 0.0)])
        offset = _offset_of_tracked_point(run.series["heading"], nuisance)
        return samples + start + np.stack(offset, axis=-1)
    return samples


def _offset_of_tracked_point(heading: Any, nuisance: Nuisance) -> tuple[Any, Any]:
    """Return x and y of the tracked point as seen from the center of mass [m]."""
    ahead = nuisance.get("measured.offset_x", 0.0)
    left = nuisance.get("measured.offset_y", 0.0)
    cosine, sine = np.cos(heading), np.sin(heading)
    return ahead * cosine - left * sine, ahead * sine + left * cosine
