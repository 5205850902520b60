"""From one pose and the joint angles to every link and the center of mass, and back."""

from laticauda.kinematics.poses import (
    center_of_mass,
    center_of_mass_velocity,
    fin_line,
    heading,
    joint_angles,
    joint_positions,
    link_angles,
    link_centers,
    link_ends,
    link_velocities,
    trailing_edge,
    trailing_edge_velocity,
)
from laticauda.kinematics.space import (
    ModulePoses,
    from_quaternion,
    module_poses,
    to_quaternion,
    turned_about_vertical,
)

__all__ = [
    "ModulePoses",
    "center_of_mass",
    "center_of_mass_velocity",
    "fin_line",
    "from_quaternion",
    "heading",
    "joint_angles",
    "joint_positions",
    "link_angles",
    "link_centers",
    "link_ends",
    "link_velocities",
    "module_poses",
    "to_quaternion",
    "trailing_edge",
    "trailing_edge_velocity",
    "turned_about_vertical",
]
