"""Figures of the runs of a batch: a few numbers of each run are kept while it is in memory, then evaluated together."""

from collections.abc import Sequence
from typing import NamedTuple, cast

import numpy as np
from jaxtyping import Float, Inexact, Int

from laticauda.gaits import Gait
from laticauda.planar import rows
from laticauda.planar.batch import PATH_ROWS, STEP, Block, Run
from laticauda.robot import has_power_model
from laticauda.trial import cycles, feasibility, metrics

Figure = Float[np.ndarray, " n_trials"]


class Steady(NamedTuple):
    """Start of the steady part of every run."""

    start: Inexact[np.ndarray, " n_runs"]
    """Start times [s]; nan if there is no steady part, complex if the runs carry derivatives."""
    before: Int[np.ndarray, " n_runs"]
    """Index of the last sample that is not later."""
    time: Float[np.ndarray, " n_samples"]
    """Times of all samples [s]."""

    @classmethod
    def of(cls, runs: Sequence[Run], time: np.ndarray) -> "Steady":
        """Find the steady part of every run.

        Args:
            runs: The runs, with their gaits.
            time: Times of their samples [s].
        """
        start = np.array([_steady_start(time, run.command.gait) for run in runs])
        before = np.searchsorted(time, np.nan_to_num(start), side="right") - 1
        if runs[0].slope is not None:
            # The steady part is a whole number of cycles, which get shorter as the frequency rises.
            change = np.array([cast(np.ndarray, run.slope)[rows.FREQUENCY] for run in runs])
            frequency = np.array([run.command.gait.frequency or np.inf for run in runs])
            start = start + 1j * STEP * ((time[-1] - start) / frequency * change)
        return cls(start, np.clip(before, 0, time.size - 2), time)


# Kept of a run: position at the start and at the end, position and velocity around the start of its
# steady part, heading and work at the end.
_PATH = [rows.X - rows.TIME, rows.Y - rows.TIME, rows.VX - rows.TIME, rows.VY - rows.TIME]
N_SAMPLED_NUMBERS = 2 + 2 + 4 + 4 + 1 + 4


def sample_block(block: Block, before: np.ndarray) -> np.ndarray:
    """Return the numbers that are kept of the runs of a block.

    Args:
        block: Results of the runs.
        before: Index of the last sample before the steady part of each run.
    """
    k, p = np.arange(before.size), block.center_of_mass
    around = block.log[before, :PATH_ROWS, k], block.log[before + 1, :PATH_ROWS, k]
    return np.concatenate(
        (p[0], p[-1], *(one[:, _PATH].T for one in around), block.heading[np.newaxis], block.work)
    )


def compute_figures(
    runs: Sequence[Run], weight: np.ndarray, left: np.ndarray, steady: Steady
) -> dict[str, np.ndarray]:
    """Compute the figures of all runs from the kept numbers; the results are meaningless where a run diverged.

    Args:
        runs: Runs of the batch.
        weight: Weights of their robots, see `carried_weight` [N].
        left: The kept numbers, one column per run.
        steady: Start of their steady parts.
    """
    start, end, a, b, c, d = (left[k : k + 2] for k in range(0, 12, 2))
    duration, heading, work = float(steady.time[-1]), left[12], left[13:]
    powered = {id(run.plant): has_power_model(run.plant.robot, run.plant.joints) for run in runs}
    at = steady.time[steady.before]
    step = steady.time[steady.before + 1] - at
    with np.errstate(all="ignore"):
        speed, power = _size(end - start) / duration, work / duration
        mean = cast(
            np.ndarray, np.where([powered[id(run.plant)] for run in runs], power[3], power[0])
        )
        begin = cycles.hermite((steady.start - at) / step, step, (a, c), (b, d))
        found = {
            "forward_velocity": speed,
            "steady_velocity": _size(end - begin) / (duration - steady.start),
            "mechanical_power": power[0],
            "net_power": power[1],
            "positive_power": power[2],
            "mean_power": mean,
            "cost_of_transport": np.where(
                speed.real > metrics.STILL, mean / (weight * speed), np.nan
            ),
            "x": end[0],
            "y": end[1],
            "heading": heading,
        }
        return {name: np.where(np.isfinite(one), one, np.nan) for name, one in found.items()}


def _size(vector: np.ndarray) -> np.ndarray:
    """Return |vector|, valid with complex steps; the first axis holds x and y."""
    return np.sqrt(vector[0] * vector[0] + vector[1] * vector[1])


def _steady_start(time: np.ndarray, gait: Gait) -> float:
    """Return the start of the steady part [s]; nan if there is none."""
    try:
        return cycles.steady_part(
            time, 2.0 * np.pi / gait.frequency if gait.frequency > 0.0 else None
        ).start
    except ValueError:
        return np.nan


def joint_peaks(runs: Sequence[Run], block: Block) -> dict[str, Figure]:
    """Compute the figures of `laticauda.trial.feasibility` for every run of a block whose log includes the joints.

    Args:
        runs: Runs of the block.
        block: Results of the runs.
    """
    layout, robots = runs[0].plant.layout, [run.plant.robot for run in runs]
    tail, n_joints = layout.tail_link, layout.n_bodies - 1
    log = block.log[:, rows.LOG_STATE :].reshape(block.time.size, 4, n_joints, len(runs))
    if len(robots[0].driven_joints) > robots[0].n_joints:
        log = np.concatenate((log, log[:, :, tail - 1 : tail]), axis=2)
    periods = [
        2.0 * np.pi / run.command.gait.frequency if run.command.gait.frequency > 0.0 else None
        for run in runs
    ]
    counts = np.stack(
        [feasibility.find_settled_samples(block.time, period) for period in periods], axis=1
    )
    with np.errstate(all="ignore"):
        return feasibility.compute_peaks(
            robots, log[:, 0, tail:], log[:, 1, tail:], log[:, 3, tail:], counts
        )
