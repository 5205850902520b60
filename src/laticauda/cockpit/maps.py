"""Maps over two numbers of many trials: of a stored sweep, or of the gaits around what swims.

A sweep is the Dataset that `laticauda.studies` makes of it; the map of the gaits has the same form.
"""

# xarray's own annotations are partial: this module is the cockpit's door to it.
# pyright: reportUnknownMemberType=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from laticauda.cockpit.simulation import changed
from laticauda.gaits import Gait
from laticauda.robot import Water
from laticauda.scenarios import Planar, Scenario
from laticauda.simulate import numbers, swim_many
from laticauda.studies.trials import QUANTITIES

NO_SWEEP = "it is no sweep of laticauda: `laticauda sweep` makes a folder; pack it as .zip, or save it as .nc"
# What is in radians is shown in degrees.
SHOWN = {"rad": "deg", "rad/s": "deg/s"}
# The map of the gaits: its axes, in what is shown, what is seen of it, and how long every trial is.
AMPLITUDES = tuple(float(value) for value in range(5, 65, 5))  # [deg]
FREQUENCIES = tuple(float(value) for value in range(20, 220, 20))  # [deg/s]
OF_GAITS = ("forward_velocity", "mean_power", "cost_of_transport")
DURATION = 20.0  # [s]


@dataclass(frozen=True, kw_only=True, eq=False)
class Chart:
    """One quantity over two of the numbers that trials differ in."""

    map: "Map"
    """Whose."""
    quantity: str
    """Which, as the sweep calls it."""
    x: str
    """The number from left to right, as the sweep calls it."""
    y: str
    """That upward."""
    cut: Any
    """The quantity as a DataArray: over y and x of a grid, else over all points."""

    @property
    def title(self) -> str:
        """The quantity with its unit."""
        unit = QUANTITIES[self.quantity][0]
        return f"{self.quantity.replace('_', ' ').capitalize()} [{'-' if unit == '1' else unit}]"

    def nearest(self, x: float, y: float) -> dict[str, float]:
        """The numbers of the trial that is nearest, by name (SI, radians).

        Args:
            x: As shown.
            y: As shown.
        """
        off = [np.abs(self.map.ticks(name) - shown) for name, shown in ((self.x, x), (self.y, y))]
        if self.map.is_grid:
            at = {name: int(np.argmin(one)) for name, one in zip((self.x, self.y), off, strict=True)}
        else:
            spans = [max(float(np.ptp(self.map.ticks(name))), 1e-12) for name in (self.x, self.y)]
            at = {self.cut.dims[0]: int(np.argmin((off[0] / spans[0]) ** 2 + (off[1] / spans[1]) ** 2))}
        point = self.cut.isel(at)
        return {name: float(point[name]) for name in self.map.names}

    def place_of(self, scenario: Scenario) -> tuple[float, float] | None:
        """Where a scenario is on it, as shown; None if it has no such number."""
        x, y = self.map.shown_of(scenario, self.x), self.map.shown_of(scenario, self.y)
        return None if x is None or y is None else (x, y)


@dataclass(frozen=True, kw_only=True, eq=False)
class Map:
    """Many trials, and what they differ in."""

    name: str
    """Of the file or folder; "" for the gaits around what swims."""
    dataset: Any
    """The quantities, over a dimension for every number of a grid, else over points with the numbers along them."""

    @property
    def quantities(self) -> tuple[str, ...]:
        """What there is a map of."""
        return tuple(name for name in QUANTITIES if name in self.dataset and name != "succeeded")

    @property
    def is_grid(self) -> bool:
        """Whether there is every combination of the numbers' values."""
        return all(dim in self.dataset.coords for dim in self.dataset[self.quantities[0]].dims)

    @property
    def names(self) -> tuple[str, ...]:
        """What the trials differ in."""
        return tuple(map(str, self.dataset[self.quantities[0]].dims if self.is_grid else self.dataset.coords))

    @property
    def spanning(self) -> tuple[str, ...]:
        """Those with two values or more, which a map can have as its axes."""
        return tuple(name for name in self.names if np.unique(self.dataset[name]).size > 1)

    @property
    def about(self) -> Mapping[str, str]:
        """What all trials share: robot, gait, environment, joints."""
        attrs = self.dataset.attrs
        return {key: str(attrs[key]) for key in ("robot", "gait", "environment", "joints") if key in attrs}

    def unit(self, name: str) -> str:
        """Of a number, in SI and radians; "" for a pure one."""
        unit = str(self.dataset[name].attrs.get("units", ""))
        return "" if unit == "1" else unit

    def label(self, name: str) -> str:
        """A number in words, with its unit as shown."""
        words = name.partition(".")[2].replace(".", " ").replace("_", " ")
        return f"{words} [{SHOWN.get(self.unit(name), self.unit(name)) or '-'}]"

    def ticks(self, name: str) -> np.ndarray:
        """The values of a number, as shown: all different ones of a grid, else one per point."""
        values = np.asarray(self.dataset[name], dtype=float).ravel()
        return np.round(np.degrees(values), 9) if self.unit(name) in SHOWN else values

    def shown_of(self, scenario: Scenario, name: str) -> float | None:
        """What a scenario has of a number, as shown; None if it has none."""
        try:
            value = numbers.value_of(name, scenario)
        except (ValueError, AttributeError, TypeError):  # no fin, for instance, whose length it would be
            return None
        return round(math.degrees(value), 9) if self.unit(name) in SHOWN else value

    def chart(self, quantity: str, x: str, y: str, at: Mapping[str, int] | None = None) -> Chart:
        """A map of it.

        Args:
            quantity: One of `quantities`.
            x: One of `names`, from left to right.
            y: Likewise, upward.
            at: Which value of every other number of a grid, by its place; the first if it is not given.
        """
        cut = self.dataset[quantity]
        if self.is_grid:
            cut = cut.isel({name: (at or {}).get(name, 0) for name in self.names if name not in (x, y)})
            cut = cut.transpose(y, x)
        return Chart(map=self, quantity=quantity, x=x, y=y, cut=cut)


def map_of(dataset: Any, name: str) -> Map:
    """The map of a stored sweep.

    Args:
        dataset: As `laticauda.studies.open_sweep` gives it.
        name: What the user calls it.

    Raises:
        ValueError: If it is none, does not span a map, or no trial of it was run.
    """
    found = Map(name=name, dataset=dataset)
    if not found.quantities:
        raise ValueError(f"{NO_SWEEP}.")
    dims = list(dataset[found.quantities[0]].dims)
    found = replace(found, dataset=(dataset.sortby(dims) if found.is_grid else dataset).load())
    if len(found.spanning) < 2:
        listed = ", ".join(found.names) or "nothing"
        raise ValueError(f"a map needs two numbers that differ from trial to trial; this sweep is over {listed}.")
    if not any(np.isfinite(found.dataset[one]).any() for one in found.quantities):
        raise ValueError("none of its trials has been run yet.")
    return found


def base_of(scenario: Scenario) -> Scenario:
    """What the map of the gaits depends on: scenarios with equal ones share it. It is in the plane, without steering.

    Args:
        scenario: What swims how.
    """
    gait = replace(scenario.gait, amplitude=0.0, frequency=0.0)
    return replace(scenario, motion=gait, model=Planar(joints=scenario.model.joints))


def map_of_gaits(scenario: Scenario) -> Map:
    """Trials of `DURATION` from rest side by side, over amplitude and frequency.

    Args:
        scenario: What swims how.

    Raises:
        ValueError: If the batch cannot compute such trials.
    """
    import xarray

    base = replace(base_of(scenario), duration=DURATION, sample_interval=0.05)
    gaits = [with_wave(base.gait, amplitude, frequency) for amplitude in AMPLITUDES for frequency in FREQUENCIES]
    swims = swim_many([replace(base, motion=gait) for gait in gaits])
    axes = (("gait.amplitude", AMPLITUDES, "rad"), ("gait.frequency", FREQUENCIES, "rad/s"))
    names, shape = tuple(name for name, _, _ in axes), tuple(len(values) for _, values, _ in axes)
    dataset = xarray.Dataset(
        {name: (names, np.asarray(getattr(swims, name)).reshape(shape)) for name in OF_GAITS},
        coords={name: (name, list(map(math.radians, values)), {"units": unit}) for name, values, unit in axes},
    )
    return Map(name="", dataset=dataset)


def with_wave(gait: Gait, amplitude_deg: float, frequency_deg_s: float) -> Gait:
    """The gait with another amplitude [deg] and frequency [deg/s]."""
    return replace(gait, amplitude=math.radians(amplitude_deg), frequency=math.radians(frequency_deg_s))


def with_numbers(scenario: Scenario, values: Mapping[str, float]) -> Scenario:
    """A scenario with other numbers.

    Args:
        scenario: As it is.
        values: By their name, with dots (SI, radians).

    Raises:
        ValueError: If the scenario has no such number, or they do not go together.
    """
    known = numbers.parameters(scenario, each=True)
    for name in values:
        numbers.look_up(name, known, "sweep")
    after = numbers.changed(scenario, values)
    assert isinstance(after.environment, Water)
    return changed(scenario, robot=after.robot, gait=after.gait, environment=after.environment)
