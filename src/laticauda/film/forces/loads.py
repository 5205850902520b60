"""Loads of every draw of a motion: forces along the body, torques, and what the water does not explain."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.film.chain import ChainMotion
from laticauda.film.forces.assumptions import Draw
from laticauda.film.forces.progress import ignore_progress
from laticauda.models.planar import GivenMotion, evaluate_motion
from laticauda.models.planar.model import PlanarPlant
from laticauda.scenarios import Planar


@dataclass(frozen=True, kw_only=True, eq=False)
class LoadDraws:
    """Loads of many draws at the same moments, world axes."""

    link_force: Float[np.ndarray, "n_draws n_times n_links 2"]
    """Force of the water on every link [N]."""
    joint_torque: Float[np.ndarray, "n_draws n_times n_joints"]
    """Torque of every joint [N m]."""
    joint_rate: Float[np.ndarray, "n_draws n_times n_joints"]
    """Rate of every joint [rad/s]."""
    left_over: Float[np.ndarray, "n_draws n_times 3"]
    """Moment [N m] and force [N] that the water does not explain."""

    @property
    def power(self) -> Float[np.ndarray, "n_draws n_times"]:
        """Sum of |torque x rate| over the joints [W]."""
        return np.sum(np.abs(self.joint_torque * self.joint_rate), axis=2)

    @property
    def net_power(self) -> Float[np.ndarray, "n_draws n_times"]:
        """Sum of torque x rate: what the water and the body take [W]."""
        return np.sum(self.joint_torque * self.joint_rate, axis=2)


def evaluate_draws(
    motions: ChainMotion,
    draws: tuple[Draw, ...],
    scale: Float[np.ndarray, " n_draws"],
    *,
    on_progress: Callable[[float], object] = ignore_progress,
) -> LoadDraws:
    """Return the loads of every draw.

    Args:
        motions: A motion of every draw.
        draws: Its body and water.
        scale: Factor of the root's motion: how much larger the film's scale may be.
        on_progress: Called with the share of draws that are done.
    """
    n_draws, n_times = motions.coordinates.shape[:2]
    n_links = draws[0].robot.n_links
    n_joints = n_links - 1
    link_force = np.empty((n_draws, n_times, n_links, 2))
    torque = np.empty((n_draws, n_times, n_joints))
    left_over = np.empty((n_draws, n_times, 3))
    for i, draw in enumerate(draws):
        motion = motions[i]
        plant = PlanarPlant(robot=draw.robot, environment=draw.water, settings=Planar())
        loads = evaluate_motion(plant, _scale_motion(motion, float(scale[i])))
        link_force[i] = loads.link_force
        torque[i] = loads.joint_torque
        acceleration = float(scale[i]) * motion.accelerations[:, :2]
        left_over[i] = loads.left_over(acceleration, motion.accelerations[:, 2])
        on_progress((i + 1) / n_draws)
    return LoadDraws(
        link_force=link_force,
        joint_torque=torque,
        joint_rate=motions.rates[..., 3:],
        left_over=left_over,
    )


def _scale_motion(motion: ChainMotion, scale: float) -> GivenMotion:
    """Return a motion whose path, but not its angles, is larger by a factor."""
    return GivenMotion(
        time=motion.time,
        center_of_mass=scale * motion.center_of_mass,
        velocity=scale * motion.rates[:, :2],
        heading=motion.heading,
        heading_rate=motion.rates[:, 2],
        joint_angle=motion.joint_angle,
        joint_rate=motion.rates[:, 3:],
        joint_acceleration=motion.accelerations[:, 3:],
    )
