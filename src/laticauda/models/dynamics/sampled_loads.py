"""Loads at the samples of a march: forces on the links of a body, and what its joints carry.

What a joint carries is a force and a moment: those of the part of the body on its tail side on the part
on its head side, in the axes of the link on the tail side (along it to the head, to its left, up), the
moment about the joint. So the moment about a joint's axis has the sign of the joint's torque: it is the
torque of the drive less that of the skin.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.sensing import BodyLoads
from laticauda.values import DIRECTIONS

FORCES = ("drag", "added_mass", "effector")
"""Kinds of forces on a link, in the order of the first axis of an array of them."""
FORCES_OF_WATER = slice(0, 2)
"""Those of them that the water exerts on the link itself."""
LEFT = DIRECTIONS.index("left")


class SampledLoads(NamedTuple):
    """Loads at every sample; those of robots side by side have one more axis, the last one."""

    link_force: Float[np.ndarray, "n_kinds n_samples n_links n_axes *lanes"]
    """Forces of every kind on every link, world axes [N]."""
    joint_force: Float[np.ndarray, "n_samples n_joints 3 *lanes"]
    """Force in every joint: along, left, up [N]."""
    joint_moment: Float[np.ndarray, "n_samples n_joints 3 *lanes"]
    """Moment in every joint, about the same axes [N m]."""
    water_force: Float[np.ndarray, "n_samples n_links 3 *lanes"]
    """Force of the water on every link, drag and added mass: along, left, up [N]."""
    fin_force: Float[np.ndarray, "n_samples 3 *lanes"]
    """Force of a fin on the tail link, in the axes of the fin's root [N]; 0 unless the fin has a joint there."""
    fin_moment: Float[np.ndarray, "n_samples 3 *lanes"]
    """Moment of it about that joint, about the same axes [N m]."""

    def at(self, index: slice) -> "SampledLoads":
        """Return the loads at a slice of the samples."""
        return SampledLoads(
            link_force=self.link_force[:, index],
            joint_force=self.joint_force[index],
            joint_moment=self.joint_moment[index],
            water_force=self.water_force[index],
            fin_force=self.fin_force[index],
            fin_moment=self.fin_moment[index],
        )

    def of_lane(self, lane: int) -> "SampledLoads":
        """Return the loads of one robot of those side by side."""
        return SampledLoads(*(values[..., lane] for values in self))

    def body_loads(
        self,
        joint_torque: Float[np.ndarray, " n_joints"],
        side_areas: Float[np.ndarray, " n_links"],
    ) -> BodyLoads:
        """Return the loads at the first sample.

        Args:
            joint_torque: Torques of the joints' drives there [N m].
            side_areas: Area of a side of every link [m^2].
        """
        return BodyLoads(
            joint_torque=joint_torque,
            joint_force=self.joint_force[0],
            joint_moment=self.joint_moment[0],
            water_force=self.water_force[0],
            fin_force=self.fin_force[0],
            pressure_difference=self.water_force[0, :, LEFT] / side_areas,
        )

    @classmethod
    def zeros(
        cls, *, n_samples: int, n_links: int, n_axes: int, lanes: tuple[int, ...] = ()
    ) -> "SampledLoads":
        """Return loads to be filled in; `lanes` is the number of robots side by side, if there are several."""
        of_joints = (n_samples, n_links - 1, len(DIRECTIONS), *lanes)
        of_fin = (n_samples, len(DIRECTIONS), *lanes)
        return cls(
            link_force=np.zeros((len(FORCES), n_samples, n_links, n_axes, *lanes)),
            joint_force=np.zeros(of_joints),
            joint_moment=np.zeros(of_joints),
            water_force=np.zeros((n_samples, n_links, len(DIRECTIONS), *lanes)),
            fin_force=np.zeros(of_fin),
            fin_moment=np.zeros(of_fin),
        )


def join_loads(parts: Iterable[SampledLoads | None]) -> SampledLoads | None:
    """Return the loads of consecutive stretches, each of which begins with the last sample of the one before.

    Args:
        parts: Loads of each stretch; None, also as the result: they were not requested.
    """
    kept: list[SampledLoads] = []
    for part in parts:
        if part is None:
            return None
        kept.append(part.at(slice(1, None)) if kept else part)
    return SampledLoads(
        link_force=np.concatenate([part.link_force for part in kept], axis=1),
        joint_force=np.concatenate([part.joint_force for part in kept]),
        joint_moment=np.concatenate([part.joint_moment for part in kept]),
        water_force=np.concatenate([part.water_force for part in kept]),
        fin_force=np.concatenate([part.fin_force for part in kept]),
        fin_moment=np.concatenate([part.fin_moment for part in kept]),
    )


def fin_load_signals(loads: SampledLoads) -> dict[str, np.ndarray]:
    """Return what the joint of a driven fin bears, as signals: `fin_force_along` and so on.

    Args:
        loads: The loads.
    """
    signals: dict[str, np.ndarray] = {}
    for k, direction in enumerate(DIRECTIONS):
        signals[f"fin_force_{direction}"] = loads.fin_force[:, k]
        signals[f"fin_moment_{direction}"] = loads.fin_moment[:, k]
    return signals
