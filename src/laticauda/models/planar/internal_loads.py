"""What the joints of a planar body carry, at every sample of a log.

The kernels give, for the state in a sample, the force on every body and all accelerations. Newton's law
for everything on the tail side of a joint, sum (m a - f) = -F, then gives the force F that this part exerts
on the rest. The moment is that of the recursion, s^T (I^A a + p^A): what the bodies on the head side need
about the joint.
"""

from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.models.dynamics.sampled_loads import FORCES, FORCES_OF_WATER, SampledLoads
from laticauda.models.planar import rows
from laticauda.models.planar.layout import Layout

READ = (
    rows.COS,
    rows.SIN,
    rows.LINK_RATE,
    rows.LINK_ACCELERATION,
    rows.QX,
    rows.QY,
    rows.A00,
    rows.A01,
    rows.A02,
    rows.P0,
)
"""Rows of a body that hold what is needed of a moment."""
MOMENT_UP = 2
"""Place of the moment about the vertical in `SampledLoads.joint_moment`."""


class _Bodies:
    """Rows of all bodies at all samples: time, body."""

    def __init__(self, values: Float[np.ndarray, "n_samples n_bodies n_rows"]) -> None:
        self._values = values

    def __getitem__(self, row: int) -> np.ndarray:
        return self._values[:, :, READ.index(row)]


def compute_loads(
    link_forces: Any,
    layout: Layout,
    S: Float[np.ndarray, " n_rows"],
    samples: Float[np.ndarray, "n_samples n_numbers"],
    mass: float,
) -> SampledLoads:
    """Return the loads at every sample of a march.

    Args:
        link_forces: The kernel `stepping.link_forces` for one lane.
        layout: The robot in the kernels' form.
        S: All rows under the command of the march; they are changed.
        samples: Samples of the march.
        mass: Mass of the whole robot [kg].
    """
    n_samples = len(samples)
    tail = layout.tail_link
    loads = SampledLoads.zeros(n_samples=n_samples, n_links=layout.n_bodies - tail, n_axes=2)
    force = np.empty((n_samples, len(FORCES), layout.n_bodies, 2, 1))
    records = layout.bodies_of(S)
    read = np.empty((n_samples, layout.n_bodies, len(READ)))
    # One by one, because the rows keep the accelerations of the last sample only.
    for k in range(n_samples):
        link_forces(S, *layout.chain, samples[k : k + 1, :, np.newaxis], force[k : k + 1])
        read[k] = records[:, READ]
    bodies = _Bodies(read)
    by_kind = np.moveaxis(force[..., 0], 1, 0)
    whole_force = by_kind.sum(axis=0)
    joint_force = _joint_forces(bodies, whole_force, records, mass)
    loads.joint_force[:, :, :2] = joint_force[:, tail:]
    joint_moment = _joint_moments(bodies)
    loads.joint_moment[:, :, MOMENT_UP] = joint_moment[:, tail:]
    if tail > 0:
        loads.fin_force[:, :2] = joint_force[:, tail - 1]
        loads.fin_moment[:, MOMENT_UP] = joint_moment[:, tail - 1]
    # Fin bodies belong to the tail link.
    by_kind[:, :, tail] += by_kind[:, :, :tail].sum(axis=2)
    of_water = by_kind[FORCES_OF_WATER].sum(axis=0)
    water_force = _in_axes(bodies, x=of_water[:, :, 0], y=of_water[:, :, 1])
    loads.water_force[:, :, :2] = water_force[:, tail:]
    return loads._replace(link_force=by_kind[:, :, tail:])


def _joint_forces(
    bodies: _Bodies,
    force: Float[np.ndarray, "n_samples n_bodies 2"],
    records: Float[np.ndarray, "n_bodies n_rows"],
    mass: float,
) -> Float[np.ndarray, "n_samples n_joints 2"]:
    """Return the force in the joint at the head end of every body but the last: along that body, to its left [N]."""
    c = bodies[rows.COS]
    s = bodies[rows.SIN]
    m = mass * records[:, rows.MASS_SHARE]
    arm = mass * records[:, rows.FIRST_MOMENT_SHARE]
    across = arm * bodies[rows.LINK_ACCELERATION]
    along = arm * bodies[rows.LINK_RATE] ** 2
    # Mass times acceleration of each body's center of mass.
    needed_x = m * bodies[rows.QX] - across * s - along * c
    needed_y = m * bodies[rows.QY] + across * c - along * s
    unused_x = force[:, :, 0] - needed_x
    unused_y = force[:, :, 1] - needed_y
    x = np.cumsum(unused_x, axis=1)
    y = np.cumsum(unused_y, axis=1)
    in_axes = _in_axes(bodies, x=x, y=y)
    return in_axes[:, :-1]


def _in_axes(
    bodies: _Bodies,
    *,
    x: Float[np.ndarray, "n_samples n_bodies"],
    y: Float[np.ndarray, "n_samples n_bodies"],
) -> Float[np.ndarray, "n_samples n_bodies 2"]:
    """Return vectors along bodies and to their left, from those in world axes."""
    c = bodies[rows.COS]
    s = bodies[rows.SIN]
    along = c * x + s * y
    left = c * y - s * x
    return np.stack((along, left), axis=2)


def _joint_moments(bodies: _Bodies) -> Float[np.ndarray, "n_samples n_joints"]:
    """Return the moment about the vertical in the joint at the tail end of every body but the first [N m]."""
    moment = bodies[rows.A00] * bodies[rows.LINK_ACCELERATION] + bodies[rows.P0]
    moment += bodies[rows.A01] * bodies[rows.QX]
    moment += bodies[rows.A02] * bodies[rows.QY]
    return moment[:, 1:]
