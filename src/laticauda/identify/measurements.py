"""`Measurement`: figures or series of one trial, with their noise."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np
from jaxtyping import Float

import laticauda as lc
from laticauda.identify.selection_bias import mean_of_the_greatest
from laticauda.identify.series import SERIES, SERIES_KINDS
from laticauda.identify.towing import LOADS, Tow
from laticauda.identify.unknowns import Prior, name_field
from laticauda.models.simulate import UNITS
from laticauda.scenarios import warn_of_doubt
from laticauda.trials import arrays
from laticauda.values import (
    LARGEST,
    BadArgument,
    Quantity,
    check_choice,
    check_instance,
    check_items,
    check_whole_number,
    renamed_names,
)

_PAIR = "a pair of what was measured and the sigma of its noise"
_ROUNDING = 1e-9
"""By how much the last sample may exceed the duration, which is often computed [-]."""

Numbers = Float[np.ndarray, " n"]

__getattr__ = renamed_names(__name__, {"from_trial": "laticauda.identify.conversion:from_trial"})


@dataclass(frozen=True, kw_only=True, eq=False)
class Measurement:
    """A scenario and the results of one trial of it: figures, time series, or both.

    The trial begins straight and at rest.

    The noise of every number is assumed normal with the given standard deviation, and independent
    of all others.

    Raises:
        ValueError: If a field is out of its range, a number is not finite, or nothing was measured.
    """

    name: str
    """Name in tables and messages; unique within a fit."""
    scenario: lc.Scenario
    """Robot, gait, water, start and duration; numbers not identified keep their values in it."""
    group: str = ""
    """Group of measurements left out together; "": those of its gait, with or without fin."""
    figures: Mapping[str, tuple[float, float]] = field(
        default_factory=dict[str, tuple[float, float]]
    )
    """Value and standard deviation of the noise by name of the figure.

    The figures are those of `Swims`; x, y, heading: at the end. Of a tow, they are its loads.
    """
    time: Numbers | None = None
    """Sample times of the series, from the beginning of the trial; None without series [s]."""
    series: Mapping[str, tuple[np.ndarray, float | np.ndarray]] = field(
        default_factory=dict[str, tuple[np.ndarray, float | np.ndarray]]
    )
    """Samples, time first, and standard deviation of their noise, by name from `SERIES`.

    The standard deviation is one number for all samples, or an array of their shape.
    """
    selected_from: int = 1
    """Number of about equally good settings from which it was selected as the best [-]."""
    free_start: bool = True
    """Whether its start is unknown, if a path or a heading is used; False: it is exact."""
    assumed: str = ""
    """What was assumed about its noise, in a sentence; "": its noise was stated."""
    tow: Tow | None = None
    """How the straight robot was towed; if given, nothing swam, and the figures are loads."""

    def __post_init__(self) -> None:
        """Check every field once, and freeze its contents."""
        self._check_kinds()
        self._set("group", self.group or self._usual_group)
        n_settings = check_whole_number(self._named("selected_from"), self.selected_from, 1)
        self._set("selected_from", n_settings)
        figures = {name: self._checked_figure(name, pair) for name, pair in self.figures.items()}
        self._set("figures", MappingProxyType(figures))
        if (self.time is None) != (not self.series):
            rule = "must be given with series, and only with series"
            raise BadArgument(self._named("time"), rule)
        if self.time is not None:
            time = self._checked_time(self.time)
            series = {
                name: self._checked_series(name, pair, time.size)
                for name, pair in self.series.items()
            }
            self._set("time", time)
            self._set("series", MappingProxyType(series))
        if not self.figures and not self.series:
            rule = f"or `series` of `{self.name}` must hold something measured, got none"
            raise BadArgument("figures", rule)

    def _check_kinds(self) -> None:
        is_text = isinstance(self.name, str)  # pyright: ignore[reportUnnecessaryIsInstance]
        if not is_text or not self.name.strip():
            raise BadArgument("name", f"must be a non-empty text, got {self.name!r}")
        check_instance("scenario", self.scenario, lc.Scenario)
        check_instance("figures", self.figures, Mapping)
        check_instance("series", self.series, Mapping)
        check_instance("scenario.motion", self.scenario.motion, lc.Gait)
        check_instance("scenario.start", self.scenario.start, lc.Start)

    def _named(self, field_name: str) -> str:
        """Return how a message names a field of this measurement."""
        return name_field(field_name, self.name)

    def _set(self, field_name: str, content: object) -> None:
        object.__setattr__(self, field_name, content)

    @property
    def _usual_group(self) -> str:
        with_or_without = "without"
        if self.scenario.robot.caudal_fin is not None:
            with_or_without = "with"
        return f"{self.scenario.gait.words}, {with_or_without} fin"

    @property
    def _units_of_figures(self) -> Mapping[str, str]:
        if self.tow is not None:
            return LOADS
        return UNITS

    def _checked_figure(self, name: object, pair: Sequence[float]) -> tuple[float, float]:
        units = self._units_of_figures
        figure = check_choice(self._named("figures"), name, tuple(units))
        argument = self._named(f"figures[{figure!r}]")
        value, sigma = check_items(None, _PAIR, (2,), argument, pair)
        checked_value = Quantity(unit=units[figure], text="").checked(argument, value)
        return checked_value, _checked_sigma(argument, sigma, units[figure])

    def _checked_time(self, values: object) -> Numbers:
        time = arrays.check_times(self._named("time"), values)
        duration = self.scenario.duration
        if time[0] < 0.0 or time[-1] > duration * (1.0 + _ROUNDING):
            rule = f"of `{self.name}` must lie between 0 and its `duration` of {duration:g} s"
            raise BadArgument("time", f"{rule}, got {time[0]:g} to {time[-1]:g} s")
        return time

    def _checked_series(
        self, name: object, pair: Sequence[Any], n_samples: int
    ) -> tuple[np.ndarray, float | np.ndarray]:
        series = check_choice(self._named("series"), name, tuple(SERIES))
        argument = self._named(f"series[{series!r}]")
        samples, sigma = check_items(None, _PAIR, (2,), argument, pair)
        shape = (n_samples, *SERIES_KINDS[series].sample_shape)
        checked_samples = arrays.check_floats(argument, samples, shape)
        largest = np.max(np.abs(checked_samples), initial=0.0)
        if largest > LARGEST:
            raise BadArgument(argument, f"must hold numbers up to {LARGEST:g}, got {largest:g}")
        if np.ndim(sigma) == 0:
            return checked_samples, _checked_sigma(argument, sigma, SERIES[series])
        return checked_samples, _checked_sigmas(argument, sigma, checked_samples.shape)

    @property
    def starts(self) -> dict[str, Prior | None]:
        """Start values that a fit adds to its unknowns, and the prior of each; None if it has none.

        A start that the sensor saw has the sensor's noise. If a series begins with the trial, its
        first sample contains this information, and a prior would count it twice.
        """
        if not self.free_start or self.time is None:
            return {}
        starts: dict[str, Prior | None] = {}
        sees_path = "center_of_mass" in self.series
        if sees_path:
            starts["start.x"] = self._prior_of_start("center_of_mass")
            starts["start.y"] = self._prior_of_start("center_of_mass")
        if sees_path or "heading" in self.series:
            starts["start.heading"] = self._prior_of_start("heading")
        if starts and self.coasts:
            starts["start.velocity"] = None
        return starts

    def _prior_of_start(self, series_name: str) -> Prior | None:
        """Return what a sensor says of the offset from the stated start beside its samples."""
        if self.time is None or self.time[0] == 0.0 or series_name not in self.series:
            return None
        _, sigma = self.series[series_name]
        if isinstance(sigma, np.ndarray):
            sigma = root_mean_square(sigma[0])
        return Prior(mean=0.0, sd=sigma)

    @property
    def swims(self) -> bool:
        """Whether the joints moved it: it was neither towed nor only coasting."""
        return self.tow is None and self.scenario.gait.amplitude != 0.0

    @property
    def coasts(self) -> bool:
        """Whether the straight robot was released at a speed."""
        start = self.scenario.start
        is_straight = self.scenario.gait.amplitude == 0.0
        return is_straight and isinstance(start, lc.Start) and start.velocity != 0.0

    def without_bias(self, figure: str) -> float:
        """Return a figure minus its mean selection bias; only velocities were selected for.

        Args:
            figure: Name of the figure.
        """
        value, sigma = self.figures[figure]
        if not figure.endswith("_velocity"):
            return value
        return value - mean_of_the_greatest(self.selected_from) * sigma


def _checked_sigma(argument: str, sigma: object, unit: str) -> float:
    return Quantity(unit=unit, text="", gt=0.0).checked(f"sigma of {argument}", sigma)


LARGEST_SIGMAS: Mapping[str, tuple[float, str]] = {
    "center_of_mass": (0.5, "did you mean {meant:g} ({sigma:g} mm)?"),
    "heading": (1.0, "is it in degrees?"),
    "joint_angle": (1.0, "is it in degrees?"),
}
"""Noise that no camera has, in the series' unit, and what was probably meant."""


def warn_of_noise(measurement: Measurement) -> None:
    """Warn of stated noise that hides all motion, because it is in another unit.

    Args:
        measurement: A measurement that is about to be fitted; others may hold any noise.
    """
    for name, (largest, hint) in LARGEST_SIGMAS.items():
        if name not in measurement.series:
            continue
        sigma = float(np.min(measurement.series[name][1]))
        if sigma > largest:
            noise = f"`series` of `{measurement.name}`: sigma of {name} of {sigma:g} {SERIES[name]}"
            meant = hint.format(meant=1e-3 * sigma, sigma=sigma)
            warn_of_doubt(f"{noise} hides all motion; {meant}")


def _checked_sigmas(argument: str, sigmas: object, shape: tuple[int, ...]) -> np.ndarray:
    checked_sigmas = arrays.check_floats(f"sigma of {argument}", sigmas, shape)
    smallest = np.min(checked_sigmas, initial=np.inf)
    if smallest <= 0.0:
        raise BadArgument(f"sigma of {argument}", f"must be > 0, got {smallest:g}")
    return checked_sigmas


def root_mean_square(values: np.ndarray) -> float:
    """Return the root mean square of some numbers."""
    return float(np.sqrt(np.mean(values**2)))
