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
    force = np.empty((n_samples, len(FORCES), layout.n_bodies, 2, 1))
    records = layout.bodies_of(S)
    read = np.empty((n_samples, layout.n_bodies, len(READ)))
    # One by one, because the rows keep the accelerations of the last sample only.
    for k in range(n_samples):
        link_forces(S, *layout.chain, samples[k : k + 1, :, np.newaxis], force[k : k + 1])
        read[k] = records[:, READ]
    bodies = _Bodies(read)
    by_kind = np.moveaxis(force[..., 0], 1, 0)
    tail = layout.tail_link
    loads = SampledLoads.zeros(n_samples=n_samples, n_links=layout.n_bodies - tail, n_axes=2)
    loads.joint_force[:, :, :2] = _joint_forces(bodies, by_kind.sum(axis=0), records, mass)[
        :, tail:
    ]
    loads.joint_moment[:, :, MOMENT_UP] = _joint_moments(bodies)[:, tail:]
    # Fin bodies belong to the tail link.
    by_kind[:, :, tail] += by_kind[:, :, :tail].sum(axis=2)
    of_links = by_kind[:, :, tail:]
    of_water = of_links[FORCES_OF_WATER].sum(axis=0)
    c = bodies[rows.COS][:, tail:]
    s = bodies[rows.SIN][:, tail:]
    loads.water_force[:, :, :2] = _in_axes(c, s, x=of_water[:, :, 0], y=of_water[:, :, 1])
    return loads._replace(link_force=of_links)


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
    unbalanced_x = force[:, :, 0] - m * bodies[rows.QX] + across * s + along * c
    unbalanced_y = force[:, :, 1] - m * bodies[rows.QY] - across * c + along * s
    x = np.cumsum(unbalanced_x, axis=1)
    y = np.cumsum(unbalanced_y, axis=1)
    return _in_axes(c, s, x=x, y=y)[:, :-1]


def _in_axes(
    c: np.ndarray, s: np.ndarray, *, x: np.ndarray, y: np.ndarray
) -> Float[np.ndarray, "n_samples n_bodies 2"]:
    """Return vectors along and to the left of bodies, from those in world axes and the bodies' directions."""
    return np.stack((c * x + s * y, c * y - s * x), axis=2)


def _joint_moments(bodies: _Bodies) -> Float[np.ndarray, "n_samples n_joints"]:
    """Return the moment about the vertical in the joint at the tail end of every body but the first [N m]."""
    moment = (
        bodies[rows.A00] * bodies[rows.LINK_ACCELERATION]
        + bodies[rows.A01] * bodies[rows.QX]
        + bodies[rows.A02] * bodies[rows.QY]
        + bodies[rows.P0]
    )
    return moment[:, 1:]
