"""State and samples of a plant: as its kernels log them, and by quantity."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.models.dynamics.sampled_loads import SampledLoads
from laticauda.scenarios import Command
from laticauda.values import BadArgument, Log

MOST_SAMPLES = 2_000_000
"""Largest number of samples; a longer log would take gigabytes."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PlantState:
    """Everything that a run needs to continue, as one vector; its model's `rows` define the layout."""

    values: Float[np.ndarray, " n"]
    effectors: tuple[float, ...] | None = None
    """What effectors with a rise time or a servo do now, see `effector_dynamics`; None: their first command."""


class Samples(NamedTuple):
    """Logged samples, by quantity; the first axis is time."""

    observed: dict[str, np.ndarray]
    """Fields of an `Observation`."""
    reference: np.ndarray
    """References that the joints followed [rad]."""
    offset: np.ndarray
    """phi_0 of every joint, or one for all [rad]."""
    torque: np.ndarray
    """Joint torques [N m]."""
    work: np.ndarray
    """Absolute, net, positive and electrical work [J]."""
    fin: tuple[np.ndarray, ...]
    """Angle, rate, reference and torque of the fin's joints."""
    signals: Mapping[str, np.ndarray]
    """Further signals."""
    link_force: Mapping[str, np.ndarray] | None = None
    """Forces on every link that are always logged, requested or not [N]."""


class Stretch(NamedTuple):
    """Raw samples of one march; `Plant.log` makes a log of several stretches at once."""

    samples: np.ndarray
    """Samples as the kernels logged them; the first axis is time."""
    command: Command
    """Command, held throughout."""
    loads: SampledLoads | None = None
    """Loads at the samples, if requested."""
    effectors: np.ndarray | None = None
    """What the driven effectors did at the samples, one row each; None: what the command says."""

    def at(self, index: slice) -> "Stretch":
        """Return the stretch with a slice of its samples."""
        loads = None
        if self.loads is not None:
            loads = self.loads.at(index)
        effectors = None
        if self.effectors is not None:
            effectors = self.effectors[index]
        return Stretch(self.samples[index], self.command, loads, effectors)


class Advance(NamedTuple):
    """A plant after a number of time steps under one command."""

    state: PlantState
    """The state at the end, or that at the start if the run diverged."""
    stretch: Stretch
    """Samples, up to the failure if the run diverged."""
    failure: str | None
    """What went wrong, in a sentence; None if nothing did."""


class Grid(NamedTuple):
    """The steps of a march."""

    n_intervals: int
    """Number of intervals between samples."""
    n_steps: int
    """Time steps in each."""
    dt: float
    """Time step [s]."""


def count_steps(interval: float, longest_step: float) -> int:
    """Return the number of equal time steps in an interval.

    Args:
        interval: The interval [s].
        longest_step: Largest time step [s].
    """
    return max(1, math.ceil(interval / longest_step - 1e-9))


@lru_cache(maxsize=16)  # nearly all marches of a run with a controller are of the same length
def divide_into_steps(duration: float, sample_interval: float, longest_step: float) -> Grid:
    """Return the steps of a march.

    Args:
        duration: Duration of the march [s].
        sample_interval: Time between two samples of the log; adjusted so that it divides the duration [s].
        longest_step: Largest time step [s].
    """
    n_intervals = max(1, round(duration / sample_interval))
    interval = duration / n_intervals
    n_steps = count_steps(interval, longest_step)
    return Grid(n_intervals=n_intervals, n_steps=n_steps, dt=interval / n_steps)


class March(NamedTuple):
    """A plant after a number of time steps under one command, with a log of them."""

    state: PlantState
    """The state at the end, or that at the start if the run diverged."""
    log: Log
    """Log of the steps, up to the failure if the run diverged."""
    failure: str | None
    """What went wrong, in a sentence; None if nothing did."""


def join_samples(stretches: Sequence[Stretch]) -> np.ndarray:
    """Return the samples of consecutive stretches, each of which begins with the last sample of the one before."""
    samples = [stretches[0].samples]
    for stretch in stretches[1:]:
        samples.append(stretch.samples[1:])
    if len(samples) == 1:
        return samples[0]
    return np.concatenate(samples)


def count_samples(stretches: Sequence[Stretch]) -> list[int]:
    """Return how many samples of each stretch remain in `join_samples`."""
    counts = [len(stretch.samples) - 1 for stretch in stretches]
    counts[0] += 1
    return counts


def check_size(duration: float, sample_interval: float) -> None:
    """Reject a log that is too large for memory.

    Args:
        duration: Duration of the run [s].
        sample_interval: Time between two samples [s].

    Raises:
        ValueError: If there would be more than `MOST_SAMPLES` samples.
    """
    longest = MOST_SAMPLES * sample_interval
    if duration > longest:
        rule = f"must be <= {longest:g} s at a `sample_interval` of {sample_interval:g} s, got {duration:g}"
        raise BadArgument("duration", f"{rule}; a longer `sample_interval` allows a longer run")
