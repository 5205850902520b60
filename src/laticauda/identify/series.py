"""Time series with which a trial can be compared: one row of a table for each kind.

A new kind is one more row of `SERIES_KINDS`: its unit, its shape, and where it stands in the logs
of the planar model; a trial has an array of the same name. What a displaced sensor shows of it is
said in `laticauda.identify.sensing`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from laticauda.models.planar import rows, sample_format
from laticauda.trials import Trial

if TYPE_CHECKING:
    from laticauda.models.planar import Block, Run

SeriesOfLane = Callable[["Block", int, "Run"], np.ndarray]
"""Function that returns the series, time first, of the run in one lane of a block's log."""


@dataclass(frozen=True, kw_only=True)
class SeriesKind:
    """One kind of time series."""

    unit: str
    """Unit of its samples."""
    sample_shape: tuple[int | None, ...]
    """Shape of one sample; None: one number per joint between links."""
    of_lane: SeriesOfLane
    """Takes it from the log of a batch of planar runs."""
    needs_joints: bool = False
    """Whether the planar model must log its joints."""


def _lane_center_of_mass(block: "Block", lane: int, run: "Run") -> np.ndarray:
    return block.center_of_mass[:, :, lane]


def _lane_heading(block: "Block", lane: int, run: "Run") -> np.ndarray:
    return block.log[:, sample_format.column_of(rows.HEADING), lane]


def _lane_joint_angle(block: "Block", lane: int, run: "Run") -> np.ndarray:
    return _lane_joint_rows(block, lane, run, row=rows.ANGLE)


def _lane_joint_torque(block: "Block", lane: int, run: "Run") -> np.ndarray:
    return _lane_joint_rows(block, lane, run, row=rows.TORQUE)


def _lane_joint_rows(block: "Block", lane: int, run: "Run", *, row: int) -> np.ndarray:
    """Return a quantity of the joints between links.

    In the log (`planar.sample_format`), the joints of a fin come first, if it has some.

    Args:
        block: Results of the runs.
        lane: Number of the run in the block.
        run: The run.
        row: Name of the quantity in `rows`.
    """
    layout = run.plant.layout
    n_joints = layout.n_joints
    n_fin_joints = layout.tail_link
    columns = sample_format.columns_of_joints(row, n_joints)
    return block.log[:, columns, lane][:, n_fin_joints:]


SERIES_KINDS = {
    "center_of_mass": SeriesKind(
        unit="m",
        sample_shape=(2,),
        of_lane=_lane_center_of_mass,
    ),
    "heading": SeriesKind(
        unit="rad",
        sample_shape=(),
        of_lane=_lane_heading,
    ),
    "joint_angle": SeriesKind(
        unit="rad",
        sample_shape=(None,),
        of_lane=_lane_joint_angle,
        needs_joints=True,
    ),
    "joint_torque": SeriesKind(
        unit="N m",
        sample_shape=(None,),
        of_lane=_lane_joint_torque,
        needs_joints=True,
    ),
}
"""Kinds of series by name."""
SERIES = {name: kind.unit for name, kind in SERIES_KINDS.items()}
"""Names of the series, and their units."""


def series_of_trial(trial: Trial, name: str) -> np.ndarray:
    """Return a series of a trial, time first; of a path in space, its x and y.

    Args:
        trial: The trial.
        name: Name of the series, from `SERIES`.
    """
    samples = getattr(trial, name)
    if SERIES_KINDS[name].sample_shape == (2,):
        return samples[:, :2]
    return samples
