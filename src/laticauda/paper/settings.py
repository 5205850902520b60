"""The settings of the paper's experiments, from `paper.toml`.

A study has groups (one gait with one configuration of the robot), and every group has its cases,
the rows of Table 1 or 2. `load_efficiency_settings` and `load_path_following_settings` return the
settings that come with laticauda.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

import laticauda as lc
from laticauda.motion import gaits
from laticauda.paper.measured import (
    MeasuredCase,
    MeasuredPathFollowing,
    read_path_following_trials,
    read_table1,
)
from laticauda.paper.runs import Coefficients
from laticauda.trials import group_name
from laticauda.values import (
    BadArgument,
    check_not_empty,
    check_one_among,
    codec,
    files,
    option,
    quantity,
    value_class,
)

PARAMETERS = ("amplitude", "frequency", "phase_shift")
"""Gait parameters that the paper sweeps."""
LEAST_DURATION = 15.0
"""Least duration of a run: a steady part requires 10 s and one gait cycle, 4 s in Table 2 [s]."""
_ROUNDING = 1e-9
"""Share of a step by which rounding may move the last value beyond its range [-]."""
_SAME_VALUE = 1e-6
"""Largest difference of parameters that are the same [rad, rad/s]."""


@value_class
class SweepSettings:
    """A range of one parameter of the gait, with the other two held fixed."""

    parameter: str = option("Parameter of the gait", check=check_one_among(*PARAMETERS))
    low: float = quantity("rad", "First value")
    high: float = quantity("rad", "Last value; included if the steps reach it")
    step: float = quantity("rad", "Step between values", gt=0.0)
    fixed: Mapping[str, float] = option("The other two parameters; in rad, the frequency in rad/s")

    def __post_init__(self) -> None:
        """Check every field once."""
        if not 0.0 < self.low <= self.high:
            raise BadArgument("low", f"must be > 0 and <= `high`, got {self.low} and {self.high}")
        if set(self.fixed) != set(PARAMETERS) - {self.parameter}:
            raise BadArgument(
                "fixed", f"must hold the parameters that are not swept, got {', '.join(self.fixed)}"
            )

    @property
    def values(self) -> Float[np.ndarray, " n_values"]:
        """Values of the parameter, in ascending order [rad, rad/s]."""
        n_values = math.floor((self.high - self.low) / self.step + _ROUNDING) + 1
        return self.low + self.step * np.arange(n_values)

    def gait(self, kind: str, value: float) -> lc.Gait:
        """Return the gait at one point of the sweep.

        Args:
            kind: Kind of gait.
            value: Value of the parameter [rad, rad/s].
        """
        angles: dict[str, Any] = {**self.fixed, self.parameter: float(value)}
        return lc.Gait(envelope=gaits.envelope_of(kind), **angles)

    def contains(self, gait: lc.Gait) -> bool:
        """Return whether a gait lies on the line of this sweep, whatever its kind and its value.

        Args:
            gait: Any gait.
        """
        return all(
            abs(getattr(gait, name) - value) < _SAME_VALUE for name, value in self.fixed.items()
        )


@value_class
class Group:
    """One gait with one configuration of the robot: a part of Tables 1 and 2."""

    gait: str = option("The gait's kind")
    robot: str = option("The robot's name (`load_robot`)")
    figures: tuple[int, ...] = quantity(
        "", "Numbers in the paper: of velocity and power, or by case of Table 2"
    )

    @property
    def has_fin(self) -> bool:
        """Whether the robot has the caudal fin."""
        return self.robot.endswith("-fin")

    @property
    def name(self) -> str:
        """Name in tables and files."""
        return group_name(self.gait, self.has_fin)

    @property
    def cases(self) -> tuple[MeasuredCase, ...]:
        """Its cases in Table 1."""
        return tuple(row for row in read_table1() if row.group == self.name)

    @property
    def path_following_cases(self) -> tuple[MeasuredPathFollowing, ...]:
        """Its cases in Table 2, one per figure."""
        rows = [row for row in read_path_following_trials() if row.group == self.name]
        return tuple(rows[: len(self.figures)])


@value_class
class EfficiencySettings:
    """Settings of the efficiency study: each group swims all sweeps and cases with each model."""

    duration: float = quantity("s", "Duration of every trial", gt=0.0)
    models: tuple[Coefficients, ...] = option(
        "The curves of every figure; the first one is the paper's own"
    )
    sweeps: tuple[SweepSettings, ...] = option("One per panel of the figures")
    groups: tuple[Group, ...] = option("The parts of Table 1")

    def __post_init__(self) -> None:
        """Check the fields."""
        for name in ("models", "sweeps", "groups"):
            check_not_empty(name, getattr(self, name), "entry")

    @property
    def n_runs(self) -> int:
        """Number of trials in the study."""
        n_values = sum(sweep.values.size for sweep in self.sweeps) * len(self.groups)
        n_cases = sum(len(group.cases) for group in self.groups)
        return len(self.models) * (n_values + n_cases)


@value_class
class HeldOut:
    """A published trial of the same robot, on which no choice here is based."""

    gait: lc.Gait = option("Commanded gait, without the steering")
    robot: str = option("The robot's name (`load_robot`)")
    initial_cross_track_error: float = quantity(
        "m", "Initial distance from the path, positive to its left"
    )
    initial_heading: float = quantity("rad", "Initial heading")
    velocity: tuple[float, float] = quantity(
        "m/s", "Smallest and largest forward velocity that was published"
    )
    offset: tuple[float, float] = quantity("rad", "Smallest and largest offset that was published")


@value_class
class PathFollowingSettings:
    """Settings of the path-following study: all cases of Table 2, in every way of the band."""

    duration: float = quantity("s", "Time after which a run ends", ge=LEAST_DURATION, le=1e5)
    distance: float = quantity("m", "Progress along the path after which it ends earlier", gt=0.0)
    following: lc.Following = option("How every run is steered along the x axis")
    coefficients: Coefficients = option("Water of every gait")
    accepted_error: float = quantity(
        "m", "Limit of the mean error over the gait cycle at the end", gt=0.0
    )
    joint_laws: tuple[str, ...] = option("Joint laws of the band")
    offset_bandwidths: tuple[float, ...] = quantity(
        "rad/s", "Bandwidths of the reference generator in the band"
    )
    groups: tuple[Group, ...] = option("The parts of Table 2")
    held_out: HeldOut = option("The trial of another publication")
    own: tuple[Coefficients, ...] = option(
        "Further models that run every trial, each with its own joints", default=()
    )

    def __post_init__(self) -> None:
        """Check the fields."""
        for name in ("joint_laws", "offset_bandwidths", "groups"):
            check_not_empty(name, getattr(self, name), "entry")
        for group in self.groups:
            n_cases = len(group.path_following_cases)
            if n_cases != len(group.figures):
                rule = f"must be at most as many as Table 2 has cases of {group.name}, {n_cases}"
                raise BadArgument("figures", f"{rule}, got {len(group.figures)}")

    @property
    def n_cases(self) -> int:
        """Number of cases [-]."""
        return sum(len(group.figures) for group in self.groups)

    def controller(self, gait: lc.Gait, heading_estimate: Any = "raw") -> lc.PathFollowing:
        """Return the controller that steers every run along the x axis.

        Args:
            gait: Gait of the robot.
            heading_estimate: Heading that is used: raw or cycle_mean.
        """
        return replace(self.following, heading_estimate=heading_estimate).controller(gait)

    def band(self, joints: str, offset_bandwidth: float) -> tuple[tuple[str, float], ...]:
        """Return all combinations of joint law and bandwidth [rad/s] in which a case is run.

        Args:
            joints: The chosen joint law.
            offset_bandwidth: The chosen bandwidth [rad/s].
        """
        combinations = list(product(self.joint_laws, self.offset_bandwidths))
        chosen = (joints, float(offset_bandwidth))
        if chosen not in combinations:
            combinations.insert(0, chosen)
        return tuple(combinations)

    def n_runs(self, joints: str, offset_bandwidth: float) -> int:
        """Return the number of runs: bands, cycle means, unsteered runs and the held-out run.

        Args:
            joints: The chosen joint law.
            offset_bandwidth: The chosen bandwidth [rad/s].
        """
        n_in_band = len(self.band(joints, offset_bandwidth))
        n_own = len(self.own)
        # The models of our own run every case twice, with the raw and with the cycle-mean heading.
        n_per_case = n_in_band + 1 + 2 * n_own
        n_unsteered_and_held_out = len(self.groups) + 1
        return self.n_cases * n_per_case + n_unsteered_and_held_out * (1 + n_own)


@cache
def load_efficiency_settings() -> EfficiencySettings:
    """Return the settings that come with laticauda; `dataclasses.replace` makes others."""
    table = _read_table("efficiency")
    for sweep in table["sweeps"]:
        angles = sweep.pop("fixed_deg")
        sweep["fixed"] = {name: math.radians(angle) for name, angle in angles.items()}
    settings = codec.decode(EfficiencySettings, table)
    return replace(settings, models=(*settings.models, *load_own_models()))


@cache
def load_own_models() -> tuple[Coefficients, ...]:
    """Return the project's own models of Mamba, used in addition to the paper's coefficients."""
    models: list[Coefficients] = []
    for entry in _read_table("own"):
        parameters = lc.load_parameters(entry.pop("parameters"))
        models.append(Coefficients.of(parameters, **entry))
    return tuple(models)


@cache
def load_path_following_settings() -> PathFollowingSettings:
    """Return the settings that come with laticauda; `dataclasses.replace` makes others."""
    table = _read_table("path_following")
    held_out = table["held_out"]
    held_out["offset"] = [math.radians(angle) for angle in held_out.pop("offset_deg")]
    table["coefficients"] = load_paper_coefficients()
    table["own"] = load_own_models()
    return codec.decode(PathFollowingSettings, table)


def load_paper_coefficients() -> Coefficients:
    """Return the paper's own coefficients, by gait: the first curve of its figures."""
    return load_efficiency_settings().models[0]


def name_coefficients(coefficients: Coefficients) -> str:
    """Return what coefficients are called in figures and sentences.

    Args:
        coefficients: The paper's, or others.
    """
    if coefficients == load_paper_coefficients():
        return "the paper's coefficients"
    return coefficients.title


def _read_table(study: str) -> Any:
    """Return the part of `paper.toml` about a study; the caller may change it."""
    return files.read_toml(Path(__file__).with_name("paper.toml"))[study]
