"""A map over two numbers of many trials, wherever they are from: what is drawn, and what a click on it asks for."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float

from laticauda.cockpit.settings import Setting
from laticauda.robot import Water
from laticauda.scenarios import Scenario
from laticauda.simulate.numbers import changed, look_up, parameters, value_of

# What is in radians is shown in degrees.
SHOWN = {"rad": "deg", "rad/s": "deg/s"}


@dataclass(frozen=True, kw_only=True)
class Axis:
    """A number that differs from trial to trial."""

    name: str
    """As `laticauda.studies.Sweep` calls it, with dots."""
    unit: str
    """Of `values`; "" for a pure number."""
    values: tuple[float, ...]
    """Of a grid all different, else one per trial (SI, radians)."""

    @property
    def label(self) -> str:
        """With its unit as shown."""
        return f"{self.title} [{SHOWN.get(self.unit, self.unit) or '-'}]"

    @property
    def title(self) -> str:
        """In words."""
        return self.name.partition(".")[2].replace(".", " ").replace("_", " ")

    @property
    def ticks(self) -> tuple[float, ...]:
        """The values as shown."""
        return tuple(map(self.shown, self.values))

    def of(self, setting: Setting) -> float | None:
        """What a setting has of it, as shown; None if it has no such number."""
        try:
            return self.shown(value_of(self.name, _scenario(setting)))
        except (ValueError, AttributeError, TypeError):  # no fin, for instance, whose length it would be
            return None

    def nearest(self, setting: Setting) -> float:
        """The value that is nearest to a setting's, as shown; the first if that has none."""
        own = self.of(setting)
        return self.ticks[0] if own is None else min(self.ticks, key=lambda value: abs(value - own))

    def shown(self, value: float) -> float:
        """A value in the unit that is shown, without the last digits that degrees lose."""
        return round(math.degrees(value), 9) if self.unit in SHOWN else value


@dataclass(frozen=True, kw_only=True, eq=False)
class Chart:
    """One quantity over two axes: of a grid, or of single points."""

    x: Axis
    """From left to right."""
    y: Axis
    """Upward."""
    values: Float[np.ndarray, "n_y n_x"] | Float[np.ndarray, " n_points"]
    """Nan where a trial failed, or is still to come."""
    title: str
    """Of the quantity, with its unit."""
    others: Mapping[str, Sequence[float]] = field(default_factory=dict[str, Sequence[float]])
    """What else the points differ in, by name: one value for a grid, else one per point (SI, radians)."""

    def nearest(self, x: float, y: float) -> dict[str, float]:
        """The numbers of the trial that is nearest, by name (SI, radians).

        Args:
            x: As shown.
            y: As shown.
        """
        across, up = (np.asarray(axis.ticks) for axis in (self.x, self.y))
        if self.values.ndim == 2:
            i, j, k = int(np.argmin(np.abs(across - x))), int(np.argmin(np.abs(up - y))), 0
        else:
            wide, high = (max(float(np.ptp(values)), 1e-12) for values in (across, up))
            i = j = k = int(np.argmin(((across - x) / wide) ** 2 + ((up - y) / high) ** 2))
        others = {name: values[k] for name, values in self.others.items()}
        return {**others, self.x.name: self.x.values[i], self.y.name: self.y.values[j]}

    def place_of(self, setting: Setting) -> tuple[float, float] | None:
        """Where a setting is on it, as shown; None if it has no such number."""
        x, y = self.x.of(setting), self.y.of(setting)
        return None if x is None or y is None else (x, y)


def with_values(setting: Setting, values: Mapping[str, float]) -> Setting:
    """A setting with other numbers.

    Args:
        setting: As it is.
        values: By their name, with dots (SI, radians).

    Raises:
        ValueError: If the setting has no such number, or they do not go together.
    """
    water = setting.environment
    if not all(name.startswith("gait.") for name in values):
        known = parameters(_scenario(setting), each=True)
        for name in values:
            look_up(name, known, "sweep")
    swims = changed(_scenario(setting), values)
    after = replace(setting, robot=swims.robot, gait=swims.gait)
    if not isinstance(swims.environment, Water) or swims.environment == water:
        return after
    return replace(after, water=swims.environment, current=swims.environment.current)


def _scenario(setting: Setting) -> Scenario:
    return Scenario(robot=setting.robot, motion=setting.gait, environment=setting.environment)
