"""Measurements: figures or series with their noise, taken from a trial or predicted from a run."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np
from jaxtyping import Float

import laticauda as lc
from laticauda.models.planar.model import PlanarPlant
from laticauda.models.simulate.numbers import UNITS
from laticauda.trials import arrays
from laticauda.values.checks import check_choice, check_instance, check_whole_number
from laticauda.values.errors import BadArgument
from laticauda.values.quantities import LARGEST, Quantity, check_items, quantity, value_class

SERIES = {"center_of_mass": "m", "heading": "rad", "joint_angle": "rad", "joint_torque": "N m"}
"""Time series with which a trial can be compared, and their units."""
LOADS = {"drag": "N", "side_force": "N", "yaw_moment": "N m"}
"""Loads of a tow, and their units; see `Tow`."""
_PAIR = "a pair of what was measured and the sigma of its noise"
_COLUMNS: dict[str, tuple[int, ...]] = {
    "heading": (),
    "center_of_mass": (2,),
}  # of a series; others have any number

Numbers = Float[np.ndarray, " n"]
Run = dict[str, Any]
"""Results of a run, by name of figure or series; complex if they carry a derivative."""


@value_class
class Tow:
    """Tow of a straight robot at a constant velocity, and the loads that hold it (`LOADS`).

    The drag is along the body, and the side force across it. For a positive angle, the side force
    is positive, and the yaw moment about the middle of the links is positive if it turns the robot
    further away.
    """

    speed: float = quantity("m/s", "Speed through the water", gt=0.0)
    angle: float = quantity(
        "rad", "Angle from the direction of the tow to the heading", default=0.0
    )

    def loads(self, scenario: lc.Scenario) -> dict[str, float]:
        """Compute the loads exerted by the water.

        Args:
            scenario: Scenario that provides robot and water; all else is ignored.
        """
        plant = PlanarPlant(robot=scenario.robot, environment=scenario.environment)
        along, across, moment = plant.towing_load(self.speed, self.angle)
        return dict(zip(LOADS, (-along, across, moment), strict=True))


@dataclass(frozen=True, kw_only=True, eq=False)
class Measurement:
    """A scenario and the results of one trial of it, begun straight and at rest: figures, time series, or both.

    The noise of every number is assumed normal with the given standard deviation, and independent
    of all others.

    Raises:
        ValueError: If a field is out of its range, a number is not finite, or nothing was measured.
    """

    name: str
    """Name in tables and messages; unique within a fit."""
    scenario: lc.Scenario
    """Robot, gait, water, start and duration of the trial; numbers that are not identified keep their values in it."""
    group: str = ""
    """Group of measurements that are left out together; "": those of its gait, with or without fin."""
    figures: Mapping[str, tuple[float, float]] = field(
        default_factory=dict[str, tuple[float, float]]
    )
    """Value and standard deviation of the noise by name of the figure (of `Swims`; x, y, heading: at the end)."""
    time: Numbers | None = None
    """Sample times of the series, from the beginning of the trial; None without series [s]."""
    series: Mapping[str, tuple[np.ndarray, float]] = field(
        default_factory=dict[str, tuple[np.ndarray, float]]
    )
    """Samples, time first, and standard deviation of the noise of each, by name from `SERIES`."""
    selected_from: int = 1
    """Number of about equally good settings from which it was selected as the best; 1: it was not selected [-]."""
    free_start: bool = True
    """Whether its start is unknown to a fit, if a path or a heading is used; False: the start is exact."""
    tow: Tow | None = None
    """How the straight robot was towed; if given, nothing swam, and the figures are loads."""

    def __post_init__(self) -> None:
        """Check every field once, and freeze its contents."""
        if not isinstance(self.name, str) or not self.name.strip():  # pyright: ignore[reportUnnecessaryIsInstance]
            raise BadArgument("name", f"must be a non-empty text, got {self.name!r}")
        check_instance("scenario", self.scenario, lc.Scenario)
        check_instance("figures", self.figures, Mapping)
        check_instance("series", self.series, Mapping)
        check_instance("scenario.motion", self.scenario.motion, lc.Gait)
        check_instance("scenario.start", self.scenario.start, lc.Start)
        has_fin = self.scenario.robot.caudal_fin is not None
        checked: dict[str, Any] = {
            "group": self.group
            or f"{self.scenario.gait.words}, {'with' if has_fin else 'without'} fin",
            "selected_from": check_whole_number(
                f"selected_from` of `{self.name}", self.selected_from, 1
            ),
            "figures": MappingProxyType(
                {name: self._figure(name, pair) for name, pair in self.figures.items()}
            ),
        }
        if (self.time is None) != (not self.series):
            raise BadArgument(
                f"time` of `{self.name}", "must be given with series, and only with series"
            )
        if self.time is not None:
            checked["time"] = self._checked_time(self.time)
            series = {
                name: self._one_series(name, pair, checked["time"].size)
                for name, pair in self.series.items()
            }
            checked["series"] = MappingProxyType(series)
        for name, one in checked.items():
            object.__setattr__(self, name, one)
        if not self.figures and not self.series:
            raise BadArgument(
                "figures", f"or `series` of `{self.name}` must hold something measured, got none"
            )

    def _figure(self, name: object, pair: Sequence[float]) -> tuple[float, float]:
        units = UNITS if self.tow is None else LOADS
        known = check_choice(f"figures` of `{self.name}", name, tuple(units))
        where = f"figures[{known!r}]` of `{self.name}"
        value, sigma = check_items(None, _PAIR, (2,), where, pair)
        return Quantity(unit=units[known], text="").checked(where, value), _noise(
            where, sigma, units[known]
        )

    def _checked_time(self, given: object) -> Numbers:
        time = arrays.check_times(f"time` of `{self.name}", given)
        if time[0] < 0.0 or time[-1] > self.scenario.duration * (1.0 + 1e-9):
            rule = f"of `{self.name}` must lie between 0 and its `duration` of {self.scenario.duration:g} s"
            raise BadArgument("time", f"{rule}, got {time[0]:g} to {time[-1]:g} s")
        return time

    def _one_series(self, name: object, pair: Sequence[Any], n: int) -> tuple[np.ndarray, float]:
        known = check_choice(f"series` of `{self.name}", name, tuple(SERIES))
        where = f"series[{known!r}]` of `{self.name}"
        given, sigma = check_items(None, _PAIR, (2,), where, pair)
        values = arrays.check_floats(where, given, (n, *_COLUMNS.get(known, (None,))))
        if np.any(np.abs(values) > LARGEST):
            raise BadArgument(
                where, f"must hold numbers up to {LARGEST:g}, got {np.max(np.abs(values)):g}"
            )
        return values, _noise(where, sigma, SERIES[known])

    @property
    def starts(self) -> dict[str, tuple[float, float] | None]:
        """Start values that a fit adds to its unknowns, and the prior of each: mean and standard deviation.

        A start that the sensor saw has the sensor's noise. If a series begins with the trial, its
        first sample contains this information, and a prior would count it twice.
        """
        if not self.free_start or self.time is None:
            return {}
        seen = {
            name: None if self.time[0] == 0.0 else (0.0, sigma)
            for name, (_, sigma) in self.series.items()
        }
        found = {
            f"start.{name}": seen["center_of_mass"] for name in "xy" if "center_of_mass" in seen
        }
        found |= {"start.heading": seen.get("heading")} if found or "heading" in seen else {}
        return found | ({"start.velocity": None} if found and self.coasts else {})

    @property
    def coasts(self) -> bool:
        """Whether the straight robot was released at a speed."""
        start = self.scenario.start
        return (
            self.scenario.gait.amplitude == 0.0
            and isinstance(start, lc.Start)
            and start.velocity != 0.0
        )

    def without_bias(self, figure: str) -> float:
        """Return a figure minus its mean selection bias; power has none, as settings were not selected for it.

        Args:
            figure: Name of the figure.
        """
        value, sigma = self.figures[figure]
        bias = mean_of_the_greatest(self.selected_from) if figure.endswith("_velocity") else 0.0
        return value - bias * sigma


def from_trial(
    trial: lc.Trial,
    *,
    name: str,
    figures: Mapping[str, float] | None = None,
    series: Mapping[str, float] | None = None,
    every: int = 1,
    group: str = "",
    free_start: bool = True,
) -> Measurement:
    """Convert a trial, simulated or recorded, to a measurement.

    The trial must begin straight, about where it says, and at rest. A gait without amplitude is a
    coast-down, which begins with the speed that it has.

    Args:
        trial: Trial that has a gait.
        name: Name in tables and messages.
        figures: Names of figures, and the standard deviation of the noise of each in its own unit.
        series: Names of series, with the same; of a path in space, its x and y.
        every: Stride between the samples of the series that are used. Samples so close that they
            share their noise add no information, and a fit that uses them all is overconfident.
        group: Group of measurements that are left out together; "": those of its gait, with or
            without fin.
        free_start: Whether its start is unknown to a fit, if a path or a heading is used; False:
            the start is exact.
            The first sample is as noisy as all others: if taken as exact, it shifts them.

    Raises:
        ValueError: If the trial has no gait, or an argument is out of its range.
    """
    check_instance("trial", trial, lc.Trial)
    if trial.gait is None:
        raise BadArgument("trial", "must have a gait to be identified from, got one without")
    step = check_whole_number("every", every, 1)
    time = trial.time[::step] - trial.time[0]
    at_end = {
        "x": trial.center_of_mass[-1, 0],
        "y": trial.center_of_mass[-1, 1],
        "heading": trial.heading[-1],
    }
    chosen: dict[str, Any] = {
        check_choice("figures", figure, tuple(UNITS)): (
            at_end.get(figure, getattr(trial, figure, None)),
            sigma,
        )
        for figure, sigma in (figures or {}).items()
    }
    columns: dict[str, Any] = {}
    for known, sigma in (series or {}).items():
        values = getattr(trial, check_choice("series", known, tuple(SERIES)))[::step]
        columns[known] = (values[:, :2] if known == "center_of_mass" else values, sigma)
    x, y = trial.center_of_mass[0, :2]
    speed = (
        float(np.linalg.norm(trial.center_of_mass_velocity[0]))
        if trial.gait.amplitude == 0.0
        else 0.0
    )
    return Measurement(
        name=name,
        scenario=lc.Scenario(
            robot=trial.robot,
            motion=trial.gait,
            environment=trial.environment,
            start=lc.Start(
                center_of_mass=(float(x), float(y)), heading=float(trial.heading[0]), velocity=speed
            ),
            duration=trial.duration,
        ),
        group=group,
        free_start=free_start,
        figures=chosen,
        time=time if columns else None,
        series=columns,
    )


def measured_values(
    measurement: Measurement, run: Mapping[str, Any], nuisance: Mapping[str, Any]
) -> np.ndarray:
    """Return what a measurement would show of a run: the tracked point, the tracker's heading, the meter's power.

    Args:
        measurement: Defines what was measured.
        run: Results of the run.
        nuisance: Values of the `NUISANCE` parameters by name; missing ones are 0.
    """
    ahead, left = nuisance.get("measured.offset_x", 0.0), nuisance.get("measured.offset_y", 0.0)

    def shown(name: str, of: str = "") -> Any:
        value = run[f"{name}{of}"]
        if name == "heading":
            return value + nuisance.get("measured.heading_offset", 0.0)
        if name == "mean_power":
            return value + nuisance.get("measured.power_offset", 0.0)
        if name not in ("x", "y", "center_of_mass"):
            return value
        c, s = np.cos(run[f"heading{of}"]), np.sin(run[f"heading{of}"])
        offset = {"x": ahead * c - left * s, "y": ahead * s + left * c}
        start = {
            axis: nuisance.get(f"start.{axis}", 0.0) for axis in "xy"
        }  # the water is the same everywhere
        if name in offset:
            return value + start[name] + offset[name]
        return value + np.array([*start.values()]) + np.stack((offset["x"], offset["y"]), axis=-1)

    figures = np.array([shown(name) for name in measurement.figures])
    return np.concatenate(
        [figures, *(np.ravel(shown(name, " series")) for name in measurement.series)]
    )


def mean_of_the_greatest(n: int) -> float:
    """Return the mean maximum of n independent standard normal numbers: 0, 0.564, 0.846, 1.029 for n = 1 to 4 [-].

    Of n settings that are truly equally good, the one that is measured best appears in the table.
    Its noise is the maximum of n. With the distribution function F and the density f of the
    standard normal distribution,

        E[max] = n integral x f(x) F(x)^(n-1) dx

    Args:
        n: Number of settings, at least 1.

    Raises:
        ValueError: If n is not a whole number >= 1.
    """
    check_whole_number("n", n, 1)
    if n == 1:
        return 0.0
    x = np.linspace(-10.0, 10.0, 4001)
    density = np.exp(-0.5 * x * x) / math.sqrt(2.0 * math.pi)
    share = np.array([0.5 * math.erfc(-value / math.sqrt(2.0)) for value in x])
    return float(n * np.sum(x * density * share ** (n - 1)) * (x[1] - x[0]))


def _noise(where: str, sigma: object, unit: str) -> float:
    return Quantity(unit=unit, text="", gt=0.0).checked(f"sigma of {where}", sigma)
