"""`swim_many`: many trials in one call.

TO BE REPLACED: a stand-in that loops over `swim`, until the batch kernel is here. Only its signature is final.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from laticauda.gaits import Gait
from laticauda.robot import Environment, Robot
from laticauda.simulate.swimming import swim
from laticauda.trial import Trial


@dataclass(frozen=True, kw_only=True, eq=False)
class Swims:
    """What many trials came to; failed ones have nan."""

    forward_velocity: Float[np.ndarray, " n_trials"]
    """Straight-line displacement / time over the whole run (5) [m/s]."""
    steady_velocity: Float[np.ndarray, " n_trials"]
    """The same over whole gait cycles after the transient; nan if the run is too short for one [m/s]."""
    mechanical_power: Float[np.ndarray, " n_trials"]
    """Mean of sum |u phi'| [W]."""
    net_power: Float[np.ndarray, " n_trials"]
    """Mean of sum u phi' [W]."""
    positive_power: Float[np.ndarray, " n_trials"]
    """Mean of sum max(u phi', 0) [W]."""
    mean_power: Float[np.ndarray, " n_trials"]
    """Electrical power with servo joints, else the mechanical one [W]."""
    cost_of_transport: Float[np.ndarray, " n_trials"]
    """`mean_power` / (weight of the displaced water x `forward_velocity`); nan if the robot did not move [-]."""
    center_of_mass: Float[np.ndarray, "n_trials 2"]
    """At the end [m]."""
    heading: Float[np.ndarray, " n_trials"]
    """At the end [rad]."""
    succeeded: Bool[np.ndarray, " n_trials"]
    """Whether the run reached its end."""
    status: tuple[str, ...]
    """How it ended."""


def swim_many(
    robots: Robot | Sequence[Robot],
    gaits: Gait | Sequence[Gait],
    duration: float = 30.0,
    *,
    environments: Environment | Sequence[Environment] | None = None,
    joints: str = "prescribed",
    dt: float | None = None,
    offset_bandwidth: float = 10.0,
    ramp: float | None = None,
    threads: int | None = None,
) -> Swims:
    """Let many robots swim, each its gait, from straight and at rest (stand-in: one after the other).

    Args:
        robots: One, or a sequence; all have the same number of links.
        gaits: One, or a sequence.
        duration: Of every trial [s].
        environments: One, or a sequence; None takes the paper's water for each gait.
        joints: See `laticauda.simulate.plant`.
        dt: See `laticauda.simulate.plant` [s].
        offset_bandwidth: See `laticauda.simulate.plant` [rad/s].
        ramp: See `laticauda.simulate.plant` [s].
        threads: How many trials run at once; None is one per core.
    """
    n = max(len(x) if isinstance(x, Sequence) else 1 for x in (robots, gaits, environments))
    things: Any = zip(_repeated(robots, n), _repeated(gaits, n), _repeated(environments, n), strict=True)
    trials = [
        swim(
            robot,
            gait,
            duration,
            environment=environment,
            joints=joints,
            dt=dt,
            offset_bandwidth=offset_bandwidth,
            ramp=ramp,
        )
        for robot, gait, environment in things
    ]
    figures = {name: np.array([_figure(trial, name) for trial in trials]) for name in _FIGURES}
    return Swims(
        **figures,
        center_of_mass=np.array([trial.center_of_mass[-1] for trial in trials]),
        heading=np.array([trial.heading[-1] for trial in trials]),
        succeeded=np.array([trial.succeeded for trial in trials]),
        status=tuple(trial.status for trial in trials),
    )


_FIGURES = (
    "forward_velocity",
    "steady_velocity",
    "mechanical_power",
    "net_power",
    "positive_power",
    "mean_power",
    "cost_of_transport",
)


def _figure(trial: Trial, name: str) -> float:
    try:
        return getattr(trial, name) if trial.succeeded else math.nan
    except ValueError:
        return math.nan


def _repeated(thing: Any, n: int) -> Any:
    return thing if isinstance(thing, Sequence) else [thing] * n  # pyright: ignore[reportUnknownVariableType]
