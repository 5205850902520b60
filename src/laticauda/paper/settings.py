"""The settings of the paper's experiments, from `paper.toml`: what is run, and what the paper prints beside it."""

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.errors import BadArgument
from laticauda.gaits import Gait, envelope_of
from laticauda.quantities import one_among, option, quantity, value
from laticauda.robot import Parameters, Robot, Water, load_water
from laticauda.trial.null_models import group_name

PARAMETERS = ("amplitude", "frequency", "phase_shift")
"""The gait's parameters that the paper sweeps."""


@dataclass(frozen=True, kw_only=True)
class Coefficients:
    """One set of fluid coefficients, by gait: a curve of every figure."""

    name: str
    """What tables and files call it."""
    title: str
    """What a legend says."""
    waters: Mapping[str, str | Water]
    """A water for every kind of gait: itself, or its name (`load_water`)."""
    parameters: Parameters | None = None
    """What they change about a robot, if they come from a parameter file."""

    def water(self, gait: str) -> Water:
        """The water for a kind of gait.

        Args:
            gait: The gait's kind.
        """
        water = self.waters[gait]
        return water if isinstance(water, Water) else load_water(water)

    def robot(self, robot: Robot, gait: str) -> Robot:
        """A robot with what these parameters change about it.

        Args:
            robot: What swims.
            gait: The gait's kind.
        """
        return robot if self.parameters is None else self.parameters.robot(robot, gait)


@value
class SweepSettings:
    """A range of one parameter of the gait, the other two held."""

    parameter: str = option("Of the gait", check=one_among(*PARAMETERS))
    low: float = quantity("rad", "Where it begins")
    high: float = quantity("rad", "Where it ends; within the sweep if the steps lead there")
    step: float = quantity("rad", "Between two values", gt=0.0)
    fixed: Mapping[str, float] = option("The other two parameters; rad, frequency in rad/s, as all here")

    def __post_init__(self) -> None:
        """Check every field once."""
        if not 0.0 < self.low <= self.high:
            raise BadArgument("low", f"must be > 0 and <= `high`, got {self.low} and {self.high}")
        if set(self.fixed) != set(PARAMETERS) - {self.parameter}:
            raise BadArgument("fixed", f"must hold the parameters that are not swept, got {', '.join(self.fixed)}")

    @property
    def values(self) -> Float[np.ndarray, " n_values"]:
        """What the parameter is set to, in rising order [rad, rad/s]."""
        count = math.floor((self.high - self.low) / self.step + 1e-9) + 1
        return self.low + self.step * np.arange(count)

    def gait(self, kind: str, value: float) -> Gait:
        """The gait of one point of the sweep.

        Args:
            kind: The gait's kind.
            value: Of the parameter [rad, rad/s].
        """
        angles = {**self.fixed, self.parameter: float(value)}
        return Gait(
            envelope=envelope_of(kind),
            amplitude=angles["amplitude"],
            frequency=angles["frequency"],
            phase_shift=angles["phase_shift"],
        )

    def contains(self, gait: Gait) -> bool:
        """Whether a gait lies on this sweep's line, whatever its kind and its value of the parameter.

        Args:
            gait: Any gait.
        """
        return all(abs(getattr(gait, name) - value) < 1e-6 for name, value in self.fixed.items())


@dataclass(frozen=True, kw_only=True)
class Group:
    """One gait with one configuration of the robot: a part of Table 1."""

    gait: str
    """The gait's kind."""
    robot: str
    """The robot's name (`load_robot`)."""
    has_fin: bool
    """Whether it wears the caudal fin."""
    figures: tuple[int, int]
    """Numbers of the paper's figures of forward velocity and of power."""
    cases: tuple[Gait, ...]
    """The settings of Table 1, in its order."""
    maxima: Mapping[str, int]
    """By parameter, the index of the case that the paper stars as the fastest of that sweep, from 0 [-]."""
    printed_velocity_change: tuple[float | None, ...]
    """By case, the printed change of forward velocity by the fin; None where there is none [%]."""
    printed_power_change: tuple[float | None, ...]
    """The same for the power [%]."""

    @property
    def name(self) -> str:
        """What tables and files call it."""
        return group_name(self.gait, self.has_fin)

    def starred(self, case: int) -> str | None:
        """The parameter whose maximum a case is said to be, if any.

        Args:
            case: Its index in `cases`, from 0.
        """
        return next((name for name, index in self.maxima.items() if index == case), None)


@value
class EfficiencySettings:
    """What the efficiency study runs: every sweep and every case, for every group and set of coefficients."""

    duration: float = quantity("s", "Of every trial", gt=0.0)
    models: tuple[Coefficients, ...] = option("The curves of every figure; the first one is the paper's own")
    sweeps: tuple[SweepSettings, ...] = option("One per panel of the figures")
    groups: tuple[Group, ...] = option("The parts of Table 1")

    def __post_init__(self) -> None:
        """Check what has a range."""
        for name in ("models", "sweeps", "groups"):
            if not getattr(self, name):
                raise BadArgument(name, "must hold at least one entry, got none")

    @property
    def n_runs(self) -> int:
        """How many trials the study takes."""
        values = sum(sweep.values.size for sweep in self.sweeps) * len(self.groups)
        return len(self.models) * (values + sum(len(group.cases) for group in self.groups))


@cache
def paper_table() -> Mapping[str, Any]:
    """The content of `paper.toml`, as it is written there."""
    return tomllib.loads(files("laticauda.paper").joinpath("paper.toml").read_text(encoding="utf-8"))


@cache
def efficiency_settings() -> EfficiencySettings:
    """The settings that come with laticauda; `dataclasses.replace` makes others."""
    table = paper_table()["efficiency"]
    return EfficiencySettings(
        duration=table["duration"],
        models=tuple(Coefficients(**model) for model in table["models"]),
        sweeps=tuple(_sweep(sweep) for sweep in table["sweeps"]),
        groups=tuple(_group(group) for group in table["groups"]),
    )


def paper_coefficients() -> Coefficients:
    """The paper's own coefficients, by gait: the first curve of its figures."""
    return efficiency_settings().models[0]


def _sweep(table: Mapping[str, Any]) -> SweepSettings:
    low, high, step = (math.radians(table[key]) for key in ("from_deg", "to_deg", "step_deg"))
    fixed = {name: math.radians(value) for name, value in table["fixed_deg"].items()}
    return SweepSettings(parameter=table["parameter"], low=low, high=high, step=step, fixed=fixed)


def _group(table: Mapping[str, Any]) -> Group:
    rows = [dict(zip(PARAMETERS, map(math.radians, row), strict=True)) for row in table["cases_deg"]]
    velocity, power = printed_changes(table, len(rows))
    return Group(
        gait=table["gait"],
        robot=table["robot"],
        has_fin=table["robot"].endswith("-fin"),
        figures=tuple(table["figures"]),
        cases=tuple(Gait(envelope=envelope_of(table["gait"]), **row) for row in rows),
        maxima={name: case - 1 for name, case in table["maxima"].items()},
        printed_velocity_change=velocity,
        printed_power_change=power,
    )


def printed_changes(
    table: Mapping[str, Any], n_cases: int
) -> tuple[tuple[float | None, ...], tuple[float | None, ...]]:
    """What the paper prints as the change by the fin, of forward velocity and of power, by case [%].

    Args:
        table: A group as it is written in `paper.toml`.
        n_cases: How many cases the group has.
    """
    absent = [""] * n_cases
    velocity, power = (
        tuple(None if value == "" else float(value) for value in table.get(f"printed_{name}_change", absent))
        for name in ("velocity", "power")
    )
    return velocity, power
