"""How far the water moved where the robots of a block were: what is subtracted for a speed through the water."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Inexact, Int

from laticauda.models.planar import rows
from laticauda.models.planar.batch import STEP, Block, Run
from laticauda.models.planar.layout import flow_rows
from laticauda.robot import Water
from laticauda.trials import metrics

N_NUMBERS = 10
"""Numbers that are kept of the water of a run, see `sample_water`."""
_CURRENT = [rows.CURRENT_X, rows.CURRENT_Y]


def sample_water(
    runs: Sequence[Run], block: Block, before: Int[np.ndarray, " n_runs"]
) -> Inexact[np.ndarray, "n_numbers n_runs"]:
    """Return how far the water had moved at the end of each run, and around the begin of its steady part.

    Args:
        runs: Runs of the block.
        block: Results of the runs.
        before: Index of the last sample before the steady part of each run.

    Returns:
        Displacement of the water at the end [m]; displacement [m] and velocity [m/s] at the sample
        before the steady part; the same at the next sample. Two rows each, for x and y. All are 0 in
        still water and on ground, complex if the runs carry derivatives, and nan where these are not
        known: with respect to the numbers of a flow.
    """
    numbers = np.zeros((N_NUMBERS, len(runs)), dtype=block.work.dtype)
    for i, run in enumerate(runs):
        velocity = _water_velocity(run, block, i)
        if velocity is None:
            continue
        displacement = metrics.cumulative_integral(block.time, velocity)
        kept_samples = (
            displacement[-1],
            displacement[before[i]],
            velocity[before[i]],
            displacement[before[i] + 1],
            velocity[before[i] + 1],
        )
        numbers[:, i] = np.concatenate(kept_samples)
    return numbers


def _water_velocity(run: Run, block: Block, i: int) -> Inexact[np.ndarray, "n_samples 2"] | None:
    """Return the velocity of the water where the robot was [m/s]; None: it is 0."""
    water = run.plant.environment
    if not isinstance(water, Water):
        return None
    if water.flow is not None:
        return _flow_velocity(run, water, block, i)
    if water.is_still and not _changes_current(run):
        return None
    velocity = np.array(water.uniform[:2], dtype=block.work.dtype)
    if run.slope is not None:
        velocity = velocity + 1j * STEP * run.slope[_CURRENT]
    return np.broadcast_to(velocity, (block.time.size, 2))


def _changes_current(run: Run) -> bool:
    """Return whether a parameter is a number of a uniform current."""
    return run.slope is not None and any(run.slope[row] for row in _CURRENT)


def _flow_velocity(
    run: Run, water: Water, block: Block, i: int
) -> Inexact[np.ndarray, "n_samples 2"]:
    """Return the velocity of a flow where the robot was [m/s]; nan if the run diverged."""
    position = block.center_of_mass[:, :, i]
    if block.n_samples[i] < block.time.size or not np.all(np.isfinite(position)):
        return np.full((block.time.size, 2), np.nan, dtype=block.work.dtype)
    real_position = np.real(position)
    velocity = water.velocity(real_position, block.time)
    if run.slope is None:
        return velocity
    if _changes_flow(run, run.slope):
        return np.full((block.time.size, 2), np.nan, dtype=complex)
    assert water.flow is not None
    x, y = real_position.T
    height = np.full(x.shape, -(water.depth or 0.0))
    motion = water.flow.motion(x, y, height, block.time)
    change_x, change_y = np.imag(position).T
    changes = np.empty(velocity.shape)
    changes[:, 0] = motion.u_x * change_x + motion.u_y * change_y
    changes[:, 1] = motion.v_x * change_x + motion.v_y * change_y
    return velocity + 1j * changes


def _changes_flow(run: Run, slope: Float[np.ndarray, " rows"]) -> bool:
    """Return whether a parameter is a number of the flow itself, or the height at which it acts."""
    begin = int(run.plant.layout.template[rows.FLOW])
    n_numbers = flow_rows(run.plant.environment).numbers.size
    return bool(slope[rows.HEIGHT] or np.any(slope[begin : begin + n_numbers]))
