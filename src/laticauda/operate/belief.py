"""What the filter believes, and the past that a late sample may take it back to."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from laticauda.operate.filtering import Gaussian
from laticauda.operate.samples import Sample
from laticauda.operate.twin import TwinState

Vector: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class Belief:
    """What the filter believes right after one sample."""

    time: float
    """[s]."""
    known: Gaussian | None
    """What is estimated; None before the first frame."""
    asked: Vector
    """phi_ref in force [rad]."""
    smooth: Vector
    """phi_ref after the filter that stands for the joints' lag [rad]."""
    smooth_rate: Vector
    """Its rate [rad/s]."""
    frequency: float
    """Of the gait [rad/s]."""
    joint: Vector | None
    """The last joint angles, before the first frame [rad]."""
    seen: float
    """When the last frame that was believed was taken; -inf before [s]."""
    twin: TwinState | None
    """The plant that runs along; None without one."""
    twin_failed: bool
    """Whether the twin had to be given up [-]."""
    n_refused: int
    """Frames in a row that were not believed [-]."""
    n_stray: np.ndarray
    """Samples in a row that were not believed, per joint [-]."""


Past: TypeAlias = tuple[tuple[Sample | None, Belief], ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class EstimatorState:
    """The filter's state: what it believes now, and the last few samples with what it believed after each."""

    history: Past
    """Oldest first; the first one has no sample."""
    n_outliers: int = 0
    """Frames that were not believed so far [-]."""
    n_late: int = 0
    """Samples that came too late and were left out so far [-]."""

    @property
    def belief(self) -> Belief:
        """After the last sample."""
        return self.history[-1][1]


def nothing_seen(n_joints: int, time: float) -> Belief:
    """What is believed before the first sample.

    Args:
        n_joints: Of the planar robot [-].
        time: From when on [s].
    """
    nothing = np.zeros(n_joints)
    return Belief(
        time=time,
        known=None,
        asked=nothing,
        smooth=nothing,
        smooth_rate=nothing,
        frequency=0.0,
        joint=None,
        seen=-math.inf,
        twin=None,
        twin_failed=False,
        n_refused=0,
        n_stray=np.zeros(n_joints, dtype=np.int64),
    )


def remembered(history: Sequence[tuple[Sample | None, Belief]], horizon: float) -> Past:
    """The end of a history that a late sample may still go back to.

    Args:
        history: Oldest first.
        horizon: How late a sample may come [s].
    """
    oldest = history[-1][1].time - horizon
    keep = 0
    while keep + 1 < len(history) and history[keep + 1][1].time <= oldest:
        keep += 1
    return ((None, history[keep][1]), *history[keep + 1 :])
