"""From one pose and the joint angles to every link and the center of mass, and back."""

from typing import TYPE_CHECKING

from laticauda.packaging import lazy_exports

if TYPE_CHECKING:
    from laticauda.angles import from_quaternion as from_quaternion, to_quaternion as to_quaternion
    from laticauda.kinematics.poses import Posture as Posture, center_of_mass as center_of_mass, heading as heading
    from laticauda.kinematics.poses import joint_angles as joint_angles, levers as levers, link_angles as link_angles
    from laticauda.kinematics.poses import ModulePoses as ModulePoses, module_poses as module_poses, turn as turn

__getattr__, __dir__, __all__ = lazy_exports()
