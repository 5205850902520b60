"""What the links and joints of a robot bear at one instant, for controllers and sensors."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float


@dataclass(frozen=True, kw_only=True, eq=False)
class BodyLoads:
    """Loads at one instant, in the axes of links: along it to the head, to its left, up; links and joints tail first.

    What a joint bears is what the part of the body on its tail side does to the part on its head side,
    in the axes of the link on the tail side. Loads of many robots have one row per robot.
    """

    joint_torque: Float[np.ndarray, "*robots n_joints"]
    """Torque of every joint's drive [N m]."""
    joint_force: Float[np.ndarray, "*robots n_joints 3"]
    """Force in every joint [N]."""
    joint_moment: Float[np.ndarray, "*robots n_joints 3"]
    """Moment in every joint, about the joint [N m]."""
    water_force: Float[np.ndarray, "*robots n_links 3"]
    """Force of the water on every link, drag and added mass; the fin's is in that of the tail. On the ground, its
    friction [N]."""
    fin_force: Float[np.ndarray, "*robots 3"]
    """Force of a driven fin on the tail link in its joint, in the axes of the fin; 0 without one [N]."""
    pressure_difference: Float[np.ndarray, "*robots n_links"]
    """Mean pressure on the right side of every link less that on its left, in water [Pa]."""
