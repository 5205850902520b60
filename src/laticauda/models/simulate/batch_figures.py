"""Figures of the runs of a batch: a few numbers of each run are kept, then evaluated together.

The kernels overwrite their logs block by block. `sample_block` takes from a block what the figures
need, and `compute_figures` turns these numbers into the figures of all runs at once.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple, cast

import numpy as np
from jaxtyping import Bool, Float, Inexact, Int

from laticauda.models.planar import rows, sample_format
from laticauda.models.planar.batch import STEP, Block, Run
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
        frequency = np.array([run.command.gait.frequency for run in runs])
        steady = cls.at_frequencies(frequency, time)
        if runs[0].slope is None:
            return steady
        change = _change_of_start(runs, steady.start, float(time[-1]))
        return steady._replace(start=steady.start + 1j * STEP * change)

    @classmethod
    def at_frequencies(cls, frequency: Float[np.ndarray, " n_runs"], time: np.ndarray) -> "Steady":
        """Find the steady part of every run.

        Args:
            frequency: Frequencies of the gaits [rad/s].
            time: Times of the samples [s].
        """
        start = cycles.find_steady_starts(time, periods_of(frequency))
        before = np.searchsorted(time, np.nan_to_num(start), side="right") - 1
        return cls(start, np.clip(before, 0, time.size - 2), time)


def periods_of(frequency: Float[np.ndarray, " n_runs"]) -> Float[np.ndarray, " n_runs"]:
    """Return the periods of gaits [s]; nan where one stands still.

    Args:
        frequency: Frequencies of the gaits [rad/s].
    """
    with np.errstate(divide="ignore"):
        return np.where(frequency > 0.0, 2.0 * np.pi / frequency, np.nan)


def _change_of_start(runs: Sequence[Run], start: np.ndarray, end: float) -> np.ndarray:
    """Return the derivative of the start of the steady part with respect to each run's parameter.

    The steady part is a whole number of cycles, which get shorter as the frequency rises.
    """
    frequency = np.array([run.command.gait.frequency or np.inf for run in runs])
    change = np.array([cast(np.ndarray, run.slope)[rows.FREQUENCY] for run in runs])
    return (end - start) / frequency * change


def find_period(gait: Gait) -> float | None:
    """Return the period of a gait [s]; None if it stands still.

    Args:
        gait: The gait.
    """
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

_POSITION = [sample_format.column_of(row) for row in (rows.X, rows.Y)]
"""Rows of the position in the log of a block, which begins at TIME."""
_PATH = [sample_format.column_of(row) for row in (rows.X, rows.Y, rows.VX, rows.VY)]
"""Rows of position and velocity there."""


def sample_block(runs: Sequence[Run], block: Block, before: np.ndarray) -> np.ndarray:
    """Return the numbers that are kept of the runs of a block.

    Args:
        runs: Runs of the block.
        block: Results of the runs.
        before: Index of the last sample before the steady part of each run.
    """
    begin = np.zeros_like(before)
    end = np.full_like(before, -1)
    return np.concatenate(
        (
            block.at(begin)[_POSITION],
            block.at(end)[_POSITION],
            block.at(before)[_PATH],
            block.at(before + 1)[_PATH],
            block.heading[np.newaxis],
            block.work,
            water_paths.sample_water(runs, block, before),
        )
    )


class RunFacts(NamedTuple):
    """What figures depend on besides the motion, for every run."""

    weight: Inexact[np.ndarray, " n_runs"]
    """Weight of the robot, see `carried_weight` [N]."""
    is_on_ground: Bool[np.ndarray, " n_runs"]
    """Whether it crawls on ground."""
    has_power_model: Bool[np.ndarray, " n_runs"]
    """Whether its electrical power is known."""

    @classmethod
    def of(cls, runs: Sequence[Run]) -> "RunFacts":
        """Return the facts of runs, computed once per plant."""
        by_plant: dict[int, tuple[float, bool, bool]] = {}
        for run in runs:
            plant = run.plant
            if id(plant) not in by_plant:
                by_plant[id(plant)] = (
                    metrics.carried_weight(plant.robot, plant.environment),
                    isinstance(plant.environment, Ground),
                    has_power_model(plant.robot, plant.joints),
                )
        weight, is_on_ground, has_power = zip(
            *(by_plant[id(run.plant)] for run in runs), strict=True
        )
        return cls(np.array(weight), np.array(is_on_ground), np.array(has_power))

    def take(self, index: Int[np.ndarray, " n_taken"]) -> "RunFacts":
        """Return the facts at these indices, which may repeat."""
        return RunFacts(
            weight=self.weight[index],
            is_on_ground=self.is_on_ground[index],
            has_power_model=self.has_power_model[index],
        )


def compute_figures(facts: RunFacts, numbers: np.ndarray, steady: Steady) -> dict[str, np.ndarray]:
    """Compute the figures of all runs from the kept numbers.

    The results are meaningless where a run diverged.

    Args:
        facts: What the figures depend on besides the motion.
        numbers: The kept numbers, one column per run.
        steady: Start of the steady parts.
    """
    end = numbers[END]
    water = _WaterNumbers(*numbers[WATER].reshape(5, 2, -1))
    duration = float(steady.time[-1])
    with np.errstate(all="ignore"):
        displacement = end - numbers[START]
        speed = _magnitude(displacement) / duration
        transport_speed = _magnitude(displacement - water.end) / duration
        mechanical, net, positive, electrical = numbers[WORK] / duration
        mean_power = cast(np.ndarray, np.where(facts.has_power_model, electrical, mechanical))
        steady_displacement = end - _position_at_start_of(steady, numbers)
        steady_drift = water.end - _interpolate_at_start_of(
            steady,
            (water.position_before, water.position_after),
            (water.velocity_before, water.velocity_after),
        )
        steady_duration = duration - steady.start
        steady_transport_speed = _magnitude(steady_displacement - steady_drift) / steady_duration
        cost_of_transport = mean_power / (facts.weight * transport_speed)
        figures = RunFigures(
            forward_velocity=speed,
            steady_velocity=_magnitude(steady_displacement) / steady_duration,
            speed_through_water=np.where(facts.is_on_ground, np.nan, transport_speed),
            steady_speed_through_water=np.where(facts.is_on_ground, np.nan, steady_transport_speed),
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
    driven = _DrivenJoints.of(runs, block)
    with np.errstate(all="ignore"):
        return feasibility.compute_peaks(
            [run.plant.robot for run in runs],
            angle=driven.angle,
            rate=driven.rate,
            torque=driven.torque,
            counts=driven.counts,
        )


def joint_shares(
    runs: Sequence[Run], block: Block, n_windows: int
) -> Float[np.ndarray, "n_windows 7 n_driven n_runs"]:
    """Compute `feasibility.compute_joint_shares` of every run of a block, for windows of the time that counts.

    Args:
        runs: Runs of the block.
        block: Results of the runs; its log includes the joints.
        n_windows: Number of windows; what is largest in one of them changes smoothly with the numbers of a run,
            unless it has two equal peaks.
    """
    driven = _DrivenJoints.of(runs, block)
    robots = [run.plant.robot for run in runs]
    # The sample before those that count would count if the gait were a little faster.
    counts = driven.counts.copy()
    counts[:-1] |= driven.counts[1:]
    edges = np.linspace(0, block.time.size, n_windows + 1).astype(int)
    shares: list[np.ndarray] = []
    with np.errstate(all="ignore"):
        for first, end in pairwise(edges):
            window = slice(first, end)
            shares.append(
                feasibility.compute_joint_shares(
                    robots,
                    angle=driven.angle[window],
                    rate=driven.rate[window],
                    torque=driven.torque[window],
                    counts=counts[window],
                )
            )
    return np.stack(shares)


class _DrivenJoints(NamedTuple):
    """Logs of the driven joints of the runs of a block, by sample, joint and run."""

    angle: Float[np.ndarray, "n_samples n_driven n_runs"]
    """Angles [rad]."""
    rate: Float[np.ndarray, "n_samples n_driven n_runs"]
    """Rates [rad/s]."""
    torque: Float[np.ndarray, "n_samples n_driven n_runs"]
    """Torques [N m]."""
    counts: Bool[np.ndarray, "n_samples n_runs"]
    """Which samples count."""

    @classmethod
    def of(cls, runs: Sequence[Run], block: Block) -> "_DrivenJoints":
        """Return those of a block."""
        layout = runs[0].plant.layout
        robot = runs[0].plant.robot
        joints = sample_format.view_joints(block.log, layout.n_joints)
        if len(robot.driven_joints) > robot.n_joints:
            # The log holds the joint of a driven fin before the others; here it comes last.
            fin = joints[:, :, layout.tail_link - 1 : layout.tail_link]
            joints = np.concatenate((joints, fin), axis=2)
        driven = joints[:, :, layout.tail_link :]
        is_settled = [
            feasibility.find_settled_samples(block.time, find_period(run.command.gait))
            for run in runs
        ]
        return cls(
            angle=driven[:, sample_format.place_of(rows.ANGLE)],
            rate=driven[:, sample_format.place_of(rows.RATE)],
            torque=driven[:, sample_format.place_of(rows.TORQUE)],
            counts=np.stack(is_settled, axis=1),
        )
