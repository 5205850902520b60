"""What the joints of a body in space carry, as read from MuJoCo's force and torque sensors in water.

MuJoCo computes the load between a body and its parent from the inertia of everything behind the joint;
`laticauda.water.mujoco.sensors` adds what the water does there. The planar model does neither: the two
agree because both are right.
"""

from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float, Int

from laticauda.models.dynamics.sampled_loads import SampledLoads
from laticauda.values import DIRECTIONS

N_AXES = len(DIRECTIONS)


class SensedLoads(NamedTuple):
    """Loads at one moment, see `laticauda.models.dynamics.sampled_loads`."""

    joint_force: Float[np.ndarray, "n_joints 3"]
    """Force in every joint [N]."""
    joint_moment: Float[np.ndarray, "n_joints 3"]
    """Moment in every joint [N m]."""
    water_force: Float[np.ndarray, "n_links 3"]
    """Force of the water on every link [N]."""
    fin_force: Float[np.ndarray, " 3"]
    """Force in the joint of a driven fin [N]."""
    fin_moment: Float[np.ndarray, " 3"]
    """Moment in it [N m]."""

    def write(
        self, loads: SampledLoads, sample: int, link_force: Float[np.ndarray, "n_kinds n_links 3"]
    ) -> None:
        """Write the loads to a sample of a log.

        Args:
            loads: Loads of the log.
            sample: Index of the sample.
            link_force: Forces of every kind on every link, world axes [N].
        """
        loads.link_force[:, sample] = link_force
        loads.joint_force[sample] = self.joint_force
        loads.joint_moment[sample] = self.joint_moment
        loads.water_force[sample] = self.water_force
        loads.fin_force[sample] = self.fin_force
        loads.fin_moment[sample] = self.fin_moment


class LoadSensors:
    """The sensors `force_i` and `torque_i` of a robot, which are at the tail end of module i = 1, 2, ...

    Args:
        model: A `mujoco.MjModel` with sensors (`mjcf.build_spec`).
        bodies: Bodies of the robot's modules in it, tail first.
        prefix: Prefix of the robot's names in it.
        has_driven_fin: Whether it has such sensors at the joint of a fin.
    """

    def __init__(
        self,
        model: Any,
        bodies: Int[np.ndarray, " n_links"],
        *,
        prefix: str,
        has_driven_fin: bool,
    ) -> None:
        ahead = range(1, len(bodies))
        self._bodies = bodies
        sites = [model.site(f"{prefix}module_{i}_tail").id for i in ahead]
        self._sites = np.array(sites, dtype=int)
        self._forces = _columns(model, [f"{prefix}force_{i}" for i in ahead])
        self._torques = _columns(model, [f"{prefix}torque_{i}" for i in ahead])
        self._prefix = prefix
        self._has_driven_fin = has_driven_fin

    def read(self, data: Any, of_water: Float[np.ndarray, "n_links 3"]) -> SensedLoads:
        """Return the loads in the axes of the modules.

        Args:
            data: A `mujoco.MjData` after `mj_forward`.
            of_water: Forces of the water on the modules, world axes [N].
        """
        from_site = _rotations(data.site_xmat[self._sites])
        to_module = np.swapaxes(_rotations(data.xmat[self._bodies]), 1, 2)
        turn = to_module[:-1] @ from_site
        fin_force = np.zeros(N_AXES)
        fin_moment = np.zeros(N_AXES)
        if self._has_driven_fin:
            # The fin is behind its parent, which is what the sensors tell the load of.
            fin_force = -data.sensor(f"{self._prefix}fin_force").data
            fin_moment = -data.sensor(f"{self._prefix}fin_torque").data
        return SensedLoads(
            joint_force=_turned(turn, data.sensordata[self._forces]),
            joint_moment=_turned(turn, data.sensordata[self._torques]),
            water_force=_turned(to_module, of_water),
            fin_force=fin_force,
            fin_moment=fin_moment,
        )


def _rotations(flat: Float[np.ndarray, "n 9"]) -> Float[np.ndarray, "n 3 3"]:
    """Return rotation matrices from MuJoCo's rows of nine numbers."""
    return flat.reshape(-1, N_AXES, N_AXES)


def _turned(
    turn: Float[np.ndarray, "n 3 3"], vectors: Float[np.ndarray, "n 3"]
) -> Float[np.ndarray, "n 3"]:
    """Return vectors, each turned by its own rotation."""
    return np.einsum("nab,nb->na", turn, vectors)


def _columns(model: Any, names: list[str]) -> Int[np.ndarray, "n_sensors 3"]:
    """Return where the readings of some sensors are in the data."""
    first = np.array([model.sensor(name).adr[0] for name in names], dtype=int)
    return first[:, np.newaxis] + np.arange(N_AXES)
