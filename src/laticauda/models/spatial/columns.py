"""Columns of a sample of the spatial model's log; see `rows` for their order."""

from typing import NamedTuple

from laticauda.models.spatial import rows

HEADER = rows.STATE_ROWS
"""Start of what is the same for every robot: center of mass, heading, orientation."""
LINKS = rows.STATE_ROWS + rows.SAMPLE_HEADER
"""Start of the links."""


class SampleColumns(NamedTuple):
    """Where a sample holds what depends on the numbers of links and joints."""

    link_angle: slice
    """Angles of the links about the vertical [rad]."""
    joint_angle: slice
    """Angles of the body's joints [rad]."""
    joint_rate: slice
    """Rates of the body's joints [rad/s]."""
    joint_reference: slice
    """References of the body's joints [rad]."""
    joint_torque: slice
    """Torques of the body's joints [N m]."""
    fin: slice
    """Angles [rad], rates [rad/s], references [rad] and torques [N m] of the fin's joints."""
    contact_force: slice
    """In a scene, forces on the links along x, y and z [N]."""


def columns_of(n_links: int, n_fin_joints: int) -> SampleColumns:
    """Return the columns of a robot's sample.

    Args:
        n_links: Number of its modules.
        n_fin_joints: Number of its fin's joints, driven or passive.
    """
    n_joints = n_links - 1
    joints = LINKS + n_links
    fin = joints + 4 * n_joints
    end = fin + 4 * n_fin_joints
    return SampleColumns(
        link_angle=slice(LINKS, joints),
        joint_angle=slice(joints, joints + n_joints),
        joint_rate=slice(joints + n_joints, joints + 2 * n_joints),
        joint_reference=slice(joints + 2 * n_joints, joints + 3 * n_joints),
        joint_torque=slice(joints + 3 * n_joints, fin),
        fin=slice(fin, end),
        contact_force=slice(end, end + 3 * n_links),
    )
