"""Figures of what the joints carry: how large bending moment, shear force and axial force get in any joint.

The terms are those of beams, for the section of the body at a joint: across it, the *shear force* and the
*bending moment*, both to the left and upward; along it, the *axial force*. In the plane nothing acts upward.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from laticauda.trials.feasibility import find_settled_samples
from laticauda.values import DIRECTIONS

ACROSS = ("left", "up")
PEAK = "peak_"
"""Begin of the names of figures that are the largest at any moment."""
RMS = "rms_"
"""Begin of the names of root mean squares."""


class _Load(NamedTuple):
    """A load of a joint: some components of a vector."""

    is_moment: bool
    """Whether it is of the moment, otherwise of the force."""
    directions: tuple[str, ...]
    """The components."""


LOADS = {
    "bending_moment": _Load(is_moment=True, directions=ACROSS),
    "shear_force": _Load(is_moment=False, directions=ACROSS),
    "axial_force": _Load(is_moment=False, directions=("along",)),
}
"""What figures are about, by the ends of their names."""
LOAD_FIGURES = (
    "peak_bending_moment",
    "rms_bending_moment",
    "peak_shear_force",
    "rms_shear_force",
    "peak_axial_force",
    "rms_axial_force",
)
"""Names of the figures of a trial that was run with `link_forces`."""

JointVectors = Float[np.ndarray, "n_samples n_joints 3"]


def compute_load_figure(
    name: str,
    joint_force: JointVectors,
    joint_moment: JointVectors,
    counts: Bool[np.ndarray, " n_samples"],
) -> float:
    """Compute a figure of a run.

    Of every joint, the largest magnitude or the root mean square is found; the figure is that of the joint
    in which it is largest, and 0 without joints.

    Args:
        name: One of `LOAD_FIGURES`.
        joint_force: Force in every joint [N].
        joint_moment: Moment in every joint [N m].
        counts: Which samples count, see `laticauda.trials.feasibility.find_settled_samples`.
    """
    statistic, load = _split(name)
    vectors = joint_moment if load.is_moment else joint_force
    components = [DIRECTIONS.index(direction) for direction in load.directions]
    squares = np.sum(vectors[counts][:, :, components] ** 2, axis=2)
    if statistic == RMS:
        squares = np.mean(squares, axis=0)
    return float(np.sqrt(np.max(squares, initial=0.0)))


def _split(name: str) -> tuple[str, _Load]:
    """Return the statistic and the load that a figure is about."""
    for statistic in (PEAK, RMS):
        if name.startswith(statistic):
            return statistic, LOADS[name.removeprefix(statistic)]
    raise KeyError(name)


def make_load_figure(name: str) -> Callable[[Any], float]:
    """Return a function that computes a figure of a trial.

    It raises a ValueError if the trial was run without loads.

    Args:
        name: One of `LOAD_FIGURES`.
    """

    def figure_of(trial: Any) -> float:  # a `Trial`, whose class is made of this function
        if trial.joint_force is None:
            raise ValueError(
                "The trial has no `joint_force`: swim it again with `link_forces=True`."
            )
        counts = find_settled_samples(trial.time, trial.period)
        return compute_load_figure(name, trial.joint_force, trial.joint_moment, counts)

    return figure_of
