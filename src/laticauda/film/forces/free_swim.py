"""How fast the model swims with the filmed joint angles: every draw's mean cycle, repeated, its root free."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.film.chain import ChainMotion
from laticauda.film.forces.assumptions import Draw
from laticauda.film.forces.window import SAMPLES_PER_CYCLE, Window
from laticauda.models.simulate import Swims, swim_many
from laticauda.motion.gaits import JointAngles, recorded_gait
from laticauda.scenarios import Start, limit_case

KNOTS_PER_CYCLE = 24
"""Knots of the repeated joint angles in a cycle."""
SETTLING_CYCLES = 8
"""Cycles until a swim that begins with the filmed speed is steady."""
COUNTED_CYCLES = 4
"""Cycles after these that are counted."""
STEPS_PER_CYCLE = 40
"""Time steps of a cycle."""


class FreeSwims(NamedTuple):
    """Figures of the steady swims of many draws; nan where one diverged."""

    speed: Float[np.ndarray, " n_draws"]
    """Speed [m/s]."""
    power: Float[np.ndarray, " n_draws"]
    """Mean of sum |torque x rate| [W]."""


def swim_draws(
    motions: ChainMotion,
    draws: tuple[Draw, ...],
    window: Window,
    speed: float,
    *,
    n_swims: int,
    threads: int | None = None,
) -> FreeSwims:
    """Let every draw swim its mean cycle again and again, straight ahead, until it is steady.

    Args:
        motions: A motion of every draw, at the moments of the window.
        draws: Its body and water.
        window: Whole cycles.
        speed: Speed at which the swims begin [m/s].
        n_swims: Number of draws that swim; the figures of the others are nan.
        threads: Number of threads; None uses all cores.
    """
    n_swims = min(len(draws), n_swims)
    period = window.duration / window.n_cycles
    gaits = [recorded_gait(_repeat_cycle(motions[i], window)) for i in range(n_swims)]
    begin = SETTLING_CYCLES * period
    end = (SETTLING_CYCLES + COUNTED_CYCLES) * period

    def swim_until(duration: float) -> Swims:
        return swim_many(
            [draw.robot for draw in draws[:n_swims]],
            gaits,
            duration,
            environments=[draw.water for draw in draws[:n_swims]],
            starts=Start(velocity=speed),
            dt=period / STEPS_PER_CYCLE,
            sample_interval=period / 4.0,
            threads=threads,
        )

    # What is odd about a filmed swim is said of the film (`list_doubts`), not of its draws.
    with limit_case():
        before = swim_until(begin)
        after = swim_until(end)
    distance = np.linalg.norm(after.center_of_mass - before.center_of_mass, axis=1)
    work = after.mechanical_power * end - before.mechanical_power * begin
    unknown = np.full(len(draws) - n_swims, np.nan)
    return FreeSwims(
        speed=np.append(distance / (end - begin), unknown),
        power=np.append(work / (end - begin), unknown),
    )


def _repeat_cycle(motion: ChainMotion, window: Window) -> JointAngles:
    """Return the mean cycle of a motion, repeated; its amplitude grows in the first cycle from nothing."""
    cycle = window.mean_cycle(motion.joint_angle)[:: SAMPLES_PER_CYCLE // KNOTS_PER_CYCLE]
    n_cycles = SETTLING_CYCLES + COUNTED_CYCLES
    angle = np.vstack((np.tile(cycle, (n_cycles, 1)), cycle[:1]))
    time = np.arange(len(angle)) / KNOTS_PER_CYCLE
    share = np.minimum(time, 1.0)
    growth = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    period = window.duration / window.n_cycles
    angle = growth[:, np.newaxis] * angle
    return JointAngles(
        time=tuple((period * time).tolist()),
        angle=tuple(tuple(joint_angle.tolist()) for joint_angle in angle.T),
    )
