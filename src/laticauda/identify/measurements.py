"""What was measured, figures or series with their noise: by a trial, and what a run would give."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np
from jaxtyping import Float

import laticauda as lc
from laticauda.errors import BadArgument, instance, one_of, whole
from laticauda.planar.model import PlanarPlant
from laticauda.quantities import LARGEST, Quantity, quantity, several, value
from laticauda.simulate.numbers import UNITS
from laticauda.trial import arrays

SERIES = {"center_of_mass": "m", "heading": "rad", "joint_angle": "rad", "joint_torque": "N m"}
"""Time series that a trial can be compared with, and their units."""
LOADS = {"drag": "N", "side_force": "N", "yaw_moment": "N m"}
"""What a tow gives, and the units: see `Tow`."""
_PAIR = "a pair of what was measured and the sigma of its noise"
_COLUMNS: dict[str, tuple[int, ...]] = {"heading": (), "center_of_mass": (2,)}  # of series; others: any number of them

Numbers = Float[np.ndarray, " n"]
Run = dict[str, Any]
"""What a run gave, by name of figure or series; complex if it has a derivative."""


@value
class Tow:
    """A straight robot that is pulled at a constant velocity, and the loads that hold it: `LOADS`.

    The drag is along the body, the side force across it, positive for a positive angle as the yaw moment about the
    middle of the links is where it turns the robot further away.
    """

    speed: float = quantity("m/s", "Through the water", gt=0.0)
    angle: float = quantity("rad", "From the direction of the tow to the heading", default=0.0)

    def loads(self, scenario: lc.Scenario) -> dict[str, float]:
        """The loads of the water.

        Args:
            scenario: Of robot and water; what else it has does not count.
        """
        plant = PlanarPlant(robot=scenario.robot, environment=scenario.environment)
        along, across, moment = plant.towing_load(self.speed, self.angle)
        return dict(zip(LOADS, (-along, across, moment), strict=True))


@dataclass(frozen=True, kw_only=True, eq=False)
class Measurement:
    """A scenario and what one trial of it gave, from straight and at rest: figures, time series, or both.

    The noise of every number is taken as normal and independent of all others, with the standard deviation given.

    Raises:
        ValueError: If a field is out of its range, a number is not finite, or nothing was measured.
    """

    name: str
    """What tables and messages call it; no two of a fit alike."""
    scenario: lc.Scenario
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
    free_start: bool = True
    """Whether where it began is unknown to a fit, if a path or a heading counts; False: the start is exact."""
    tow: Tow | None = None
    """How the straight robot was towed; then nothing swam, and figures are loads."""

    def __post_init__(self) -> None:
        """Check every field once, and freeze what it holds."""
        if not isinstance(self.name, str) or not self.name.strip():  # pyright: ignore[reportUnnecessaryIsInstance]
            raise BadArgument("name", f"must be a text that is not empty, got {self.name!r}")
        instance("scenario", self.scenario, lc.Scenario)
        instance("figures", self.figures, Mapping)
        instance("series", self.series, Mapping)
        instance("scenario.motion", self.scenario.motion, lc.Gait)
        instance("scenario.start", self.scenario.start, lc.Start)
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
        for name, one in checked.items():
            object.__setattr__(self, name, one)
        if not self.figures and not self.series:
            raise BadArgument("figures", f"or `series` of `{self.name}` must hold something measured, got nothing")

    def _figure(self, name: object, pair: Sequence[float]) -> tuple[float, float]:
        units = UNITS if self.tow is None else LOADS
        known = one_of(f"figures` of `{self.name}", name, tuple(units))
        where = f"figures[{known!r}]` of `{self.name}"
        value, sigma = several(None, _PAIR, (2,), where, pair)
        return Quantity(unit=units[known], text="").checked(where, value), _noise(where, sigma, units[known])

    def _checked_time(self, given: object) -> Numbers:
        time = arrays.times(f"time` of `{self.name}", given)
        if time[0] < 0.0 or time[-1] > self.scenario.duration * (1.0 + 1e-9):
            rule = f"of `{self.name}` must lie between 0 and its `duration` of {self.scenario.duration:g} s"
            raise BadArgument("time", f"{rule}, got {time[0]:g} to {time[-1]:g} s")
        return time

    def _one_series(self, name: object, pair: Sequence[Any], n: int) -> tuple[np.ndarray, float]:
        known = one_of(f"series` of `{self.name}", name, tuple(SERIES))
        where = f"series[{known!r}]` of `{self.name}"
        given, sigma = several(None, _PAIR, (2,), where, pair)
        values = arrays.floats(where, given, (n, *_COLUMNS.get(known, (None,))))
        if np.any(np.abs(values) > LARGEST):
            raise BadArgument(where, f"must hold numbers up to {LARGEST:g}, got {np.max(np.abs(values)):g}")
        return values, _noise(where, sigma, SERIES[known])

    @property
    def starts(self) -> dict[str, tuple[float, float] | None]:
        """What of its begin a fit adds to its unknowns, and what is known of each before: mean and standard deviation.

        A start that the sensor saw has the sensor's noise. Where a series begins with the trial, its first sample says
        so, and a prior would say it twice.
        """
        if not self.free_start or self.time is None:
            return {}
        seen = {name: None if self.time[0] == 0.0 else (0.0, sigma) for name, (_, sigma) in self.series.items()}
        found = {f"start.{name}": seen["center_of_mass"] for name in "xy" if "center_of_mass" in seen}
        found |= {"start.heading": seen.get("heading")} if found or "heading" in seen else {}
        return found | ({"start.velocity": None} if found and self.coasts else {})

    @property
    def coasts(self) -> bool:
        """Whether the straight robot was let go with a speed."""
        start = self.scenario.start
        return self.scenario.gait.amplitude == 0.0 and isinstance(start, lc.Start) and start.velocity != 0.0

    def without_bias(self, figure: str) -> float:
        """A figure less what selection adds to it on average; power is not what a setting was selected for.

        Args:
            figure: Its name.
        """
        value, sigma = self.figures[figure]
        bias = mean_of_the_greatest(self.selected_from) if figure.endswith("_velocity") else 0.0
        return value - bias * sigma


def _usual_group(scenario: lc.Scenario) -> str:
    """Gait, with or without fin."""
    return f"{scenario.gait.words}, {'without' if scenario.robot.caudal_fin is None else 'with'} fin"


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
    """A trial, simulated or recorded, as a measurement. It must begin straight, about where it says, and at rest.

    A gait without amplitude is a coast-down: that one begins with the speed that it has.

    Args:
        trial: With a gait.
        name: What tables and messages call it.
        figures: Names of figures, and the standard deviation of each one's noise in its own unit.
        series: The same for series; of a path in space its x and y.
        every: Which samples of the series count: every so many. Samples so close that their noise is the same
            noise say nothing new, and a fit that counts them all is too sure of itself.
        group: Which measurements it belongs with, to be left out together; "": those of its gait, with or without fin.
        free_start: Whether where it began is unknown to a fit, if a path or a heading counts; False: the start is
            exact. The first sample has noise as all others have: taken for exact, it pushes them.

    Raises:
        ValueError: If the trial has no gait, or an argument is out of its range.
    """
    instance("trial", trial, lc.Trial)
    if trial.gait is None:
        raise BadArgument("trial", "must have a gait to be identified from, got one without")
    step = whole("every", every, 1)
    time = trial.time[::step] - trial.time[0]
    at_end = {"x": trial.center_of_mass[-1, 0], "y": trial.center_of_mass[-1, 1], "heading": trial.heading[-1]}
    chosen: dict[str, Any] = {
        one_of("figures", figure, tuple(UNITS)): (at_end.get(figure, getattr(trial, figure, None)), sigma)
        for figure, sigma in (figures or {}).items()
    }
    columns: dict[str, Any] = {}
    for known, sigma in (series or {}).items():
        values = getattr(trial, one_of("series", known, tuple(SERIES)))[::step]
        columns[known] = (values[:, :2] if known == "center_of_mass" else values, sigma)
    x, y = trial.center_of_mass[0, :2]
    speed = float(np.linalg.norm(trial.center_of_mass_velocity[0])) if trial.gait.amplitude == 0.0 else 0.0
    return Measurement(
        name=name,
        scenario=lc.Scenario(
            robot=trial.robot,
            motion=trial.gait,
            environment=trial.environment,
            start=lc.Start(center_of_mass=(float(x), float(y)), heading=float(trial.heading[0]), velocity=speed),
            duration=trial.duration,
        ),
        group=group,
        free_start=free_start,
        figures=chosen,
        time=time if columns else None,
        series=columns,
    )


def measured_values(measurement: Measurement, run: Mapping[str, Any], nuisance: Mapping[str, Any]) -> np.ndarray:
    """What a measurement would show of a run: the tracked point, the tracker's heading, the meter's power.

    Args:
        measurement: Says what was measured.
        run: What the run gave.
        nuisance: Values of `NUISANCE` by name; what is missing is 0.
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
        start = {axis: nuisance.get(f"start.{axis}", 0.0) for axis in "xy"}  # water is everywhere the same
        if name in offset:
            return value + start[name] + offset[name]
        return value + np.array([*start.values()]) + np.stack((offset["x"], offset["y"]), axis=-1)

    figures = np.array([shown(name) for name in measurement.figures])
    return np.concatenate([figures, *(np.ravel(shown(name, " series")) for name in measurement.series)])


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


def _noise(where: str, sigma: object, unit: str) -> float:
    return Quantity(unit=unit, text="", gt=0.0).checked(f"sigma of {where}", sigma)
