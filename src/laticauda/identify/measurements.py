"""What was measured, figures of a trial or time series of it with their noise, and what that would be of a run."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.errors import BadArgument, finite, instance, one_of, positive, whole
from laticauda.gaits import Gait
from laticauda.interfaces import Start
from laticauda.scenarios import Scenario
from laticauda.simulate.numbers import UNITS

SERIES = {"center_of_mass": "m", "heading": "rad", "joint_angle": "rad", "joint_torque": "N m"}
"""Time series that a trial can be compared with, and their units."""

Numbers = Float[np.ndarray, " n"]
Run = dict[str, Any]
"""What a run gave, by name of figure or series; complex if it has a derivative."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Measurement:
    """A scenario and what one trial of it gave, from straight and at rest: figures, time series, or both.

    The noise of every number is taken as normal and independent of all others, with the standard deviation given.

    Raises:
        ValueError: If a field is out of its range, a number is not finite, or nothing was measured.
    """

    name: str
    """What tables and messages call it; no two of a fit alike."""
    scenario: Scenario
    """What swam, how and where: robot, gait, water, start and duration; what is not identified stays as it is there."""
    group: str = ""
    """Which measurements it belongs with, to be left out together; "": those of its gait, with or without fin."""
    figures: Mapping[str, tuple[float, float]] = field(default_factory=dict[str, tuple[float, float]])
    """By name of the figure (of `Swims`; x, y, heading: at the end): value and standard deviation of its noise."""
    time: Numbers | None = None
    """When the series were sampled, from the begin of the trial; None without series [s]."""
    series: Mapping[str, tuple[np.ndarray, float]] = field(default_factory=dict[str, tuple[np.ndarray, float]])
    """By name, of `SERIES`: samples, time first, and standard deviation of the noise of each."""
    selected_from: int = 1
    """Of how many settings that are about as good it was taken for being the best; 1: it was not selected [-]."""

    def __post_init__(self) -> None:
        """Check every field once, and freeze what it holds."""
        if not isinstance(self.name, str) or not self.name.strip():  # pyright: ignore[reportUnnecessaryIsInstance]
            raise BadArgument("name", f"must be a text that is not empty, got {self.name!r}")
        instance("scenario", self.scenario, Scenario)
        instance("scenario.motion", self.scenario.motion, Gait)
        instance("scenario.start", self.scenario.start, Start)
        checked: dict[str, Any] = {
            "group": self.group or _usual_group(self.scenario),
            "selected_from": whole(f"selected_from` of `{self.name}", self.selected_from, 1),
            "figures": MappingProxyType({name: self._figure(name, pair) for name, pair in self.figures.items()}),
        }
        if (self.time is None) != (not self.series):
            raise BadArgument(f"time` of `{self.name}", "must be given for series, and only for them")
        if self.time is not None:
            checked["time"] = self._checked_time(self.time)
            series = {name: self._one_series(name, pair, checked["time"].size) for name, pair in self.series.items()}
            checked["series"] = MappingProxyType(series)
        for name, value in checked.items():
            object.__setattr__(self, name, value)
        if not self.figures and not self.series:
            raise BadArgument(
                "figures", f"or `series` of `{self.name}` must hold something that was measured, got nothing"
            )

    def _figure(self, name: object, pair: Sequence[float]) -> tuple[float, float]:
        known = one_of(f"figures` of `{self.name}", name, tuple(UNITS))
        where = f"figures[{known!r}]` of `{self.name}"
        value, sigma = _pair(where, pair)
        return finite(where, value, UNITS[known]), positive(f"sigma of {where}", sigma, UNITS[known])

    def _checked_time(self, given: object) -> Numbers:
        time = _frozen(f"time` of `{self.name}", given)
        if time.ndim != 1 or time.size == 0 or np.any(np.diff(time) <= 0.0):
            raise BadArgument(
                "time", f"of `{self.name}` must be moments that increase, got an array of shape {time.shape}"
            )
        if time[0] < 0.0 or time[-1] > self.scenario.duration * (1.0 + 1e-9):
            raise BadArgument(
                "time",
                f"of `{self.name}` must lie between 0 and its `duration` of {self.scenario.duration:g} s, "
                f"got {time[0]:g} to {time[-1]:g} s",
            )
        return time

    def _one_series(self, name: object, pair: Sequence[Any], n: int) -> tuple[np.ndarray, float]:
        known = one_of(f"series` of `{self.name}", name, tuple(SERIES))
        where = f"series[{known!r}]` of `{self.name}"
        given, sigma = _pair(where, pair)
        values = _frozen(where, given)
        n_axes = 1 if known == "heading" else 2
        if values.ndim != n_axes or len(values) != n or (known == "center_of_mass" and values.shape[1] != 2):
            shape = {"center_of_mass": f"({n}, 2)", "heading": f"({n},)"}.get(known, f"({n}, n_joints)")
            raise BadArgument(where, f"must have the shape {shape}, got {values.shape}")
        return values, positive(f"sigma of {where}", sigma, SERIES[known])

    @property
    def selection_bias(self) -> float:
        """How many standard deviations of the noise its figures are too great for being selected, on average [-]."""
        return mean_of_the_greatest(self.selected_from)

    def without_bias(self, figure: str) -> float:
        """A figure less what selection adds to it on average; power is not what a setting was selected for.

        Args:
            figure: Its name.
        """
        value, sigma = self.figures[figure]
        return value - self.selection_bias * sigma if figure.endswith("_velocity") else value


def _usual_group(scenario: Scenario) -> str:
    """Gait, with or without fin."""
    return f"{scenario.gait.words}, {'without' if scenario.robot.caudal_fin is None else 'with'} fin"


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


def mean_of_the_greatest(n: int) -> float:
    """Mean of the greatest of n independent standard normal numbers: 0, 0.564, 0.846, 1.029 for n = 1 to 4 [-].

    Of n settings that are equally good in truth, the one that is measured best stands in the table. Its noise is the
    greatest of n. With the distribution function F and the density f of the standard normal,

        E[max] = n integral x f(x) F(x)^(n-1) dx

    Args:
        n: How many, at least 1.

    Raises:
        ValueError: If it is no whole number >= 1.
    """
    whole("n", n, 1)
    if n == 1:
        return 0.0
    x = np.linspace(-10.0, 10.0, 4001)
    density = np.exp(-0.5 * x * x) / math.sqrt(2.0 * math.pi)
    share = np.array([0.5 * math.erfc(-value / math.sqrt(2.0)) for value in x])
    return float(n * np.sum(x * density * share ** (n - 1)) * (x[1] - x[0]))


def with_noise(measurement: Measurement, rng: np.random.Generator) -> Measurement:
    """The same measurement with other noise of the size that it states: for simulated measurements.

    Args:
        measurement: Without noise.
        rng: Where it comes from.
    """
    figures = {
        name: (value + sigma * rng.standard_normal(), sigma) for name, (value, sigma) in measurement.figures.items()
    }
    series = {
        name: (values + sigma * rng.standard_normal(values.shape), sigma)
        for name, (values, sigma) in measurement.series.items()
    }
    return replace(measurement, figures=figures, series=series)


def _pair(where: str, pair: Sequence[Any]) -> tuple[Any, Any]:
    if not isinstance(pair, Sequence) or len(pair) != 2:  # pyright: ignore[reportUnnecessaryIsInstance]
        raise BadArgument(where, f"must be a pair: what was measured, and the sigma of its noise, got {pair!r}")
    return pair[0], pair[1]


def _frozen(name: str, given: object) -> np.ndarray:
    """A copy of an array of finite numbers that nobody can write to."""
    values = np.array(given, dtype=float)
    if not np.all(np.isfinite(values)):
        at = int(np.argwhere(~np.isfinite(values))[0][0]) if values.ndim else 0
        raise BadArgument(name, f"must be finite numbers; sample {at} is {values[at] if values.ndim else values}")
    values.setflags(write=False)
    return values
