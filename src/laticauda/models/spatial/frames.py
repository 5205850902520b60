"""The links of a robot as frames, as in ROS: their names in the URDF and their poses.

The frames form the same tree as the links of the URDF, with `module_0` in the world;
`spatial.bodies` defines their origins. Viewers draw the robot from the URDF and the poses.
"""

from typing import TypeAlias

import numpy as np
from jaxtyping import Float

from laticauda.models.spatial.bodies import ballast_of, build_bodies, mounts
from laticauda.models.spatial.urdf import urdf
from laticauda.robot import Module, Robot
from laticauda.scenarios import Model
from laticauda.values import from_quaternion

UNTURNED = (1.0, 0.0, 0.0, 0.0)
Places: TypeAlias = Float[np.ndarray, "n_samples 3"]
Turns: TypeAlias = Float[np.ndarray, "n_samples 4"]
Angles: TypeAlias = Float[np.ndarray, "n_samples _n_joints"]


class Frames:
    """The frames of one robot, each with its parent's name, a position [m] and an orientation (w, x, y, z) [-].

    Args:
        robot: The robot with all of its modules, not reduced to the plane.
        model: Model of the robot, if known; it determines the depth of the modules' ballast.
    """

    def __init__(self, robot: Robot, model: Model | None = None) -> None:
        self.robot, self.description, self._ballast = robot, urdf(robot), ballast_of(robot, model)
        self._bodies = build_bodies(robot)
        still = {
            one.name: (one.parent, one.position, UNTURNED)
            for one in self._bodies
            if not one.joint and one.parent
        }
        self.fixed = still | {
            one.name: (one.body, one.position, one.orientation) for one in mounts(robot)
        }
        """Frames that are fixed to their parent: a fin without a joint, thrusters, pectoral fins."""

    def moving(
        self,
        center_of_mass: Float[np.ndarray, "n_samples n_axes"],
        orientation: Turns,
        joint_angle: Angles,
        fin_angle: Angles,
    ) -> dict[str, tuple[str, Places, Turns]]:
        """Return all other frames at the given samples.

        Args:
            center_of_mass: Center of mass of the robot with its fin; a planar one is at the height
                0 [m].
            orientation: Orientation of the tail module, as a quaternion [-].
            joint_angle: Angles of all joints, or of the yaw joints only if the others are straight
                [rad].
            fin_angle: Angles of the fin's joints, starting at its root [rad].
        """
        robot, n = self.robot, len(center_of_mass)
        is_whole = joint_angle.shape[1] == robot.n_joints
        names = [
            f"joint_{i}" for i, joint in enumerate(robot.joints) if is_whole or joint.axis == "yaw"
        ]
        names += [f"fin_hinge_{k}" if k else "fin_joint" for k in robot.fin_joints]
        angles = dict(zip(names, np.hstack((joint_angle, fin_angle)).T, strict=True))
        found: dict[str, tuple[str, Places, Turns]] = {}
        rotation, place = {"": from_quaternion(*orientation.T)}, {"": np.zeros((3, n))}
        moment, mass = np.zeros((3, n)), 0.0
        for body in self._bodies:
            half = 0.5 * angles.get(body.joint_name, np.zeros(n))
            turn = np.stack((np.cos(half), *(along * np.sin(half) for along in body.axis)), axis=1)
            held, offset = rotation[body.parent], np.array(body.position)
            turned = rotation[body.name] = np.einsum("ijn,jkn->ikn", held, from_quaternion(*turn.T))
            origin = place[body.name] = place[body.parent] + np.einsum("ijn,j->in", held, offset)
            low = self._ballast if isinstance(body.part, Module) else 0.0
            moment += body.mass * (origin + body.center * turned[:, 0] - low * turned[:, 2])
            mass += body.mass
            if body.joint is not None:
                found[body.name] = body.parent, np.tile(offset, (n, 1)), turn
        center = np.zeros((3, n))
        center[: center_of_mass.shape[1]] = center_of_mass.T
        return {"module_0": ("world", (center - moment / mass).T, orientation), **found}
