"""What the joints of planar bodies carry: at every sample of a log, or in every robot of a fleet.

The kernels give, for a state, the force on every body and all accelerations. Newton's law for everything
on the tail side of a joint, sum (m a - f) = -F, then gives the force F that this part exerts on the rest.
The moment is that of the recursion, s^T (I^A a + p^A): what the bodies on the head side need about the
joint.
"""

from typing import Any, Protocol, runtime_checkable

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


Numbers = Float[np.ndarray, "n_states n_bodies ..."]


@runtime_checkable
class Bodies(Protocol):
    """Rows of all bodies in many states."""

    def __getitem__(self, row: int, /) -> Numbers:
        """Return a row of every body in every state."""
        ...


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
    in_lane = samples[:, :, np.newaxis]
    return _compute(link_forces, layout, S, in_lane, np.array([mass])).of_lane(0)


def compute_loads_of_lanes(
    link_forces: Any,
    layout: Layout,
    lanes: Float[np.ndarray, "n_rows n_lanes"],
    samples: Float[np.ndarray, "n_samples n_numbers n_lanes"],
    masses: Float[np.ndarray, " n_lanes"],
) -> SampledLoads:
    """Return the loads at every sample of a march of robots side by side, one lane each.

    Args:
        link_forces: The kernel `stepping.link_forces` for so many lanes.
        layout: The robots in the kernels' form.
        lanes: All rows under the commands of the march; they are left as they are.
        samples: Samples of the march, in lanes of the kernels' kind.
        masses: Masses of the robots [kg].
    """
    return _compute(link_forces, layout, lanes.copy(), samples, masses)


def _compute(
    link_forces: Any,
    layout: Layout,
    S: Float[np.ndarray, "n_rows ..."],
    samples: Float[np.ndarray, "n_samples n_numbers n_lanes"],
    masses: Float[np.ndarray, " n_lanes"],
) -> SampledLoads:
    """Return the loads at every sample in every lane; the rows are changed."""
    n_samples, _, n_lanes = samples.shape
    tail = layout.tail_link
    loads = SampledLoads.zeros(
        n_samples=n_samples, n_links=layout.n_bodies - tail, n_axes=2, lanes=(n_lanes,)
    )
    force = np.empty((n_samples, len(FORCES), layout.n_bodies, 2, n_lanes))
    end = rows.HEADER_ROWS + layout.n_bodies * rows.BODY_ROWS
    records = S[rows.HEADER_ROWS : end].reshape(layout.n_bodies, rows.BODY_ROWS, n_lanes)
    read = np.empty((n_samples, layout.n_bodies, len(READ), n_lanes))
    # One by one, because the rows keep the accelerations of the last sample only.
    for k in range(n_samples):
        link_forces(S, *layout.chain, samples[k : k + 1], force[k : k + 1])
        read[k] = records[:, READ]
    bodies = {row: read[:, :, k] for k, row in enumerate(READ)}
    by_kind = np.moveaxis(force, 1, 0)
    joint_force = joint_forces(
        bodies,
        by_kind.sum(axis=0),
        masses=masses * records[:, rows.MASS_SHARE],
        first_moments=masses * records[:, rows.FIRST_MOMENT_SHARE],
    )
    loads.joint_force[:, :, :2] = joint_force[:, tail:]
    joint_moment = joint_moments(bodies)
    loads.joint_moment[:, :, MOMENT_UP] = joint_moment[:, tail:]
    if tail > 0:
        loads.fin_force[:, :2] = joint_force[:, tail - 1]
        loads.fin_moment[:, MOMENT_UP] = joint_moment[:, tail - 1]
    # Fin bodies belong to the tail link.
    by_kind[:, :, tail] += by_kind[:, :, :tail].sum(axis=2)
    of_water = by_kind[FORCES_OF_WATER].sum(axis=0)
    water_force = in_axes_of_bodies(bodies, of_water)
    loads.water_force[:, :, :2] = water_force[:, tail:]
    return loads._replace(link_force=by_kind[:, :, tail:])


def joint_forces(
    bodies: Bodies,
    force: Float[np.ndarray, "n_states n_bodies 2 *lanes"],
    *,
    masses: Float[np.ndarray, "..."],
    first_moments: Float[np.ndarray, "..."],
) -> Float[np.ndarray, "n_states n_joints 2 *lanes"]:
    """Return the force in the joint at the head end of every body but the last: along that body, to its left [N].

    Args:
        bodies: The bodies.
        force: Whole force on every body, world axes [N].
        masses: Masses of the bodies, in a shape that broadcasts to that of a row [kg].
        first_moments: Masses times the distance of their center from the tail end of the body, likewise [kg m].
    """
    c = bodies[rows.COS]
    s = bodies[rows.SIN]
    across = first_moments * bodies[rows.LINK_ACCELERATION]
    along = first_moments * bodies[rows.LINK_RATE] ** 2
    # Mass times acceleration of each body's center of mass.
    needed_x = masses * bodies[rows.QX] - across * s - along * c
    needed_y = masses * bodies[rows.QY] + across * c - along * s
    needed = np.stack((needed_x, needed_y), axis=2)
    on_head_side = np.cumsum(force - needed, axis=1)
    in_axes = in_axes_of_bodies(bodies, on_head_side)
    return in_axes[:, :-1]


def in_axes_of_bodies(
    bodies: Bodies, vectors: Float[np.ndarray, "n_states n_bodies 2 *lanes"]
) -> Float[np.ndarray, "n_states n_bodies 2 *lanes"]:
    """Return vectors along bodies and to their left.

    Args:
        bodies: The bodies.
        vectors: The vectors, world axes.
    """
    x = vectors[:, :, 0]
    y = vectors[:, :, 1]
    return np.stack((along_bodies(bodies, x, y), left_of_bodies(bodies, x, y)), axis=2)


def along_bodies(bodies: Bodies, x: Numbers, y: Numbers) -> Numbers:
    """Return the components of vectors along bodies.

    Args:
        bodies: The bodies.
        x: The vectors' components in world axes.
        y: The same.
    """
    return bodies[rows.COS] * x + bodies[rows.SIN] * y


def left_of_bodies(bodies: Bodies, x: Numbers, y: Numbers) -> Numbers:
    """Return the components of vectors to the left of bodies.

    Args:
        bodies: The bodies.
        x: The vectors' components in world axes.
        y: The same.
    """
    return bodies[rows.COS] * y - bodies[rows.SIN] * x


def joint_moments(bodies: Bodies) -> Float[np.ndarray, "n_states n_joints *lanes"]:
    """Return the moment about the vertical in the joint at the tail end of every body but the first [N m].

    Args:
        bodies: The bodies.
    """
    moment = bodies[rows.A00] * bodies[rows.LINK_ACCELERATION] + bodies[rows.P0]
    moment += bodies[rows.A01] * bodies[rows.QX]
    moment += bodies[rows.A02] * bodies[rows.QY]
    return moment[:, 1:]
