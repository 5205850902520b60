"""Figures of the runs of a batch: a few numbers of each run are kept, then evaluated together.

The kernels overwrite their logs block by block. `sample_block` takes from a block what the figures
need, and `compute_figures` turns these numbers into the figures of all runs at once.
"""

from collections.abc import Sequence
from typing import NamedTuple, cast

import numpy as np
from jaxtyping import Float, Inexact, Int

from laticauda.models.planar import rows, sample_format
from laticauda.models.planar.batch import PATH_ROWS, STEP, Block, Run
from laticauda.models.simulate import water_paths
from laticauda.models.simulate.run_figures import Figure, RunFigures
from laticauda.motion.gaits import Gait
from laticauda.robot import Ground, has_power_model
from laticauda.trials import cycles, feasibility, metrics


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
            start = start + 1j * STEP * _change_of_start(runs, start, float(time[-1]))
        return cls(start, np.clip(before, 0, time.size - 2), time)


def _steady_start(time: np.ndarray, gait: Gait) -> float:
    """Return the start of the steady part [s]; nan if there is none."""
    try:
        return cycles.steady_part(time, _period_of(gait)).start
    except ValueError:
        return np.nan


def _change_of_start(runs: Sequence[Run], start: np.ndarray, end: float) -> np.ndarray:
    """Return the derivative of the start of the steady part with respect to each run's parameter.

    The steady part is a whole number of cycles, which get shorter as the frequency rises.
    """
    frequency = np.array([run.command.gait.frequency or np.inf for run in runs])
    change = np.array([cast(np.ndarray, run.slope)[rows.FREQUENCY] for run in runs])
    return (end - start) / frequency * change


def _period_of(gait: Gait) -> float | None:
    """Return the period of a gait [s]; None if it stands still."""
    if gait.frequency > 0.0:
        return 2.0 * np.pi / gait.frequency
    return None


# ---- what is kept of a run: rows of a table with one column per run ------------------------------

START = slice(0, 2)
"""Rows of the position of the center of mass at the start [m]."""
END = slice(2, 4)
"""Rows of the position at the end [m]."""
POSITION_BEFORE = slice(4, 6)
"""Rows of the position at the last sample before the steady part [m]."""
VELOCITY_BEFORE = slice(6, 8)
"""Rows of the velocity at that sample [m/s]."""
POSITION_AFTER = slice(8, 10)
"""Rows of the position at the next sample [m]."""
VELOCITY_AFTER = slice(10, 12)
"""Rows of the velocity at that sample [m/s]."""
HEADING = 12
"""Row of the heading at the end [rad]."""
WORK = slice(13, 17)
"""Rows of the work at the end: absolute, net and positive work of the joints, electrical work [J]."""
WATER = slice(17, 17 + water_paths.N_NUMBERS)
"""Rows of the motion of the water where the robot was, see `water_paths.sample_water`."""
N_SAMPLED_NUMBERS = WATER.stop
"""Number of rows."""

_PATH = [sample_format.column_of(row) for row in (rows.X, rows.Y, rows.VX, rows.VY)]
"""Rows of position and velocity in the log of a block, which begins at TIME."""


def sample_block(runs: Sequence[Run], block: Block, before: np.ndarray) -> np.ndarray:
    """Return the numbers that are kept of the runs of a block.

    Args:
        runs: Runs of the block.
        block: Results of the runs.
        before: Index of the last sample before the steady part of each run.
    """
    position = block.center_of_mass
    run = np.arange(before.size)
    sample_before = block.log[before, :PATH_ROWS, run][:, _PATH]
    sample_after = block.log[before + 1, :PATH_ROWS, run][:, _PATH]
    return np.concatenate(
        (
            position[0],
            position[-1],
            sample_before.T,
            sample_after.T,
            block.heading[np.newaxis],
            block.work,
            water_paths.sample_water(runs, block, before),
        )
    )


def compute_figures(
    runs: Sequence[Run], weight: np.ndarray, numbers: np.ndarray, steady: Steady
) -> dict[str, np.ndarray]:
    """Compute the figures of all runs from the kept numbers.

    The results are meaningless where a run diverged.

    Args:
        runs: Runs of the batch.
        weight: Weights of their robots, see `carried_weight` [N].
        numbers: The kept numbers, one column per run.
        steady: Start of their steady parts.
    """
    end = numbers[END]
    water = _WaterNumbers(*numbers[WATER].reshape(5, 2, -1))
    is_on_ground = [isinstance(run.plant.environment, Ground) for run in runs]
    duration = float(steady.time[-1])
    has_power_models = _have_power_models(runs)
    with np.errstate(all="ignore"):
        displacement = end - numbers[START]
        speed = _magnitude(displacement) / duration
        transport_speed = _magnitude(displacement - water.end) / duration
        mechanical, net, positive, electrical = numbers[WORK] / duration
        mean_power = cast(np.ndarray, np.where(has_power_models, electrical, mechanical))
        steady_displacement = end - _position_at_start_of(steady, numbers)
        steady_drift = water.end - _interpolate_at_start_of(
            steady,
            (water.position_before, water.position_after),
            (water.velocity_before, water.velocity_after),
        )
        steady_duration = duration - steady.start
        steady_transport_speed = _magnitude(steady_displacement - steady_drift) / steady_duration
        cost_of_transport = mean_power / (weight * transport_speed)
        figures = RunFigures(
            forward_velocity=speed,
            steady_velocity=_magnitude(steady_displacement) / steady_duration,
            speed_through_water=np.where(is_on_ground, np.nan, transport_speed),
            steady_speed_through_water=np.where(is_on_ground, np.nan, steady_transport_speed),
            mechanical_power=mechanical,
            net_power=net,
            positive_power=positive,
            mean_power=mean_power,
            cost_of_transport=np.where(
                transport_speed.real > metrics.STILL, cost_of_transport, np.nan
            ),
        )
    values = {**vars(figures), "x": end[0], "y": end[1], "heading": numbers[HEADING]}
    return {name: np.where(np.isfinite(value), value, np.nan) for name, value in values.items()}


def _have_power_models(runs: Sequence[Run]) -> list[bool]:
    """Return whether the electrical power of every run is known; computed once per plant."""
    by_plant = {id(run.plant): has_power_model(run.plant.robot, run.plant.joints) for run in runs}
    return [by_plant[id(run.plant)] for run in runs]


def _position_at_start_of(steady: Steady, numbers: np.ndarray) -> np.ndarray:
    """Return where every run was when its steady part began [m]."""
    return _interpolate_at_start_of(
        steady,
        (numbers[POSITION_BEFORE], numbers[POSITION_AFTER]),
        (numbers[VELOCITY_BEFORE], numbers[VELOCITY_AFTER]),
    )


def _interpolate_at_start_of(
    steady: Steady, values: tuple[np.ndarray, np.ndarray], rates: tuple[np.ndarray, np.ndarray]
) -> np.ndarray:
    """Return values at the start of the steady part, from those and their rates at the samples around it."""
    time_before = steady.time[steady.before]
    interval = steady.time[steady.before + 1] - time_before
    return cycles.hermite((steady.start - time_before) / interval, interval, values, rates)


class _WaterNumbers(NamedTuple):
    """What is kept of the water of all runs, see `water_paths.sample_water`."""

    end: np.ndarray
    """Displacement of the water at the end [m]."""
    position_before: np.ndarray
    """Displacement at the last sample before the steady part [m]."""
    velocity_before: np.ndarray
    """Velocity at that sample [m/s]."""
    position_after: np.ndarray
    """Displacement at the next sample [m]."""
    velocity_after: np.ndarray
    """Velocity at that sample [m/s]."""


def _magnitude(vector: np.ndarray) -> np.ndarray:
    """Return |vector|, valid with complex steps; the first axis holds x and y."""
    return np.sqrt(vector[0] * vector[0] + vector[1] * vector[1])


# ---- peak demands, of blocks whose log includes the joints ---------------------------------------


def joint_peaks(runs: Sequence[Run], block: Block) -> dict[str, Figure]:
    """Compute the figures of `laticauda.trials.feasibility` for every run of a block.

    Args:
        runs: Runs of the block.
        block: Results of the runs; its log includes the joints.
    """
    layout = runs[0].plant.layout
    robots = [run.plant.robot for run in runs]
    joints = sample_format.view_joints(block.log, layout.n_joints)
    if len(robots[0].driven_joints) > robots[0].n_joints:
        # The log holds the joint of a driven fin before the others; here it comes last.
        fin = joints[:, :, layout.tail_link - 1 : layout.tail_link]
        joints = np.concatenate((joints, fin), axis=2)
    driven = joints[:, :, layout.tail_link :]
    is_settled = [
        feasibility.find_settled_samples(block.time, _period_of(run.command.gait)) for run in runs
    ]
    with np.errstate(all="ignore"):
        return feasibility.compute_peaks(
            robots,
            angle=driven[:, sample_format.place_of(rows.ANGLE)],
            rate=driven[:, sample_format.place_of(rows.RATE)],
            torque=driven[:, sample_format.place_of(rows.TORQUE)],
            counts=np.stack(is_settled, axis=1),
        )
