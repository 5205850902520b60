"""What the links and joints of all robots of a fleet bear at one instant, computed when it is first asked for."""

# The fields of a frozen class, computed on first access:
# pyright: reportIncompatibleVariableOverride=false

from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np
from jaxtyping import Float

from laticauda.models.dynamics.sampled_loads import FORCES
from laticauda.models.planar import rows, sample_format
from laticauda.models.planar.batch import WIDTH, Run, aligned
from laticauda.models.planar.internal_loads import (
    MOMENT_UP,
    READ,
    Bodies,
    Numbers,
    along_bodies,
    joint_forces,
    joint_moments,
    left_of_bodies,
)
from laticauda.sensing import BodyLoads
from laticauda.trials import side_areas
from laticauda.values import DIRECTIONS

DRAG = FORCES.index("drag")
ADDED_MASS = FORCES.index("added_mass")
MASS_ROWS = (rows.MASS_SHARE, rows.FIRST_MOMENT_SHARE)
"""Rows of a body that hold its share of the mass, and of the first moment."""
Component = Callable[[Bodies, Numbers, Numbers], Numbers]
"""Gives a component in the axes of bodies from those in world axes."""


class LoadsOfLanes:
    """Evaluates loads in the lanes of a fleet; what its robots do next is the same with it and without.

    Args:
        runs: The run in each lane, of one kind.
        lanes: Numbers of all runs.
    """

    def __init__(
        self, runs: Sequence[Run], lanes: Float[np.ndarray, "n_blocks n_rows n_lanes"]
    ) -> None:
        self._lanes = lanes
        self._plant = runs[0].plant
        self._n = len(runs)
        self.layout = self._plant.layout
        by_plant = {id(run.plant): run.plant for run in runs}
        areas = {key: side_areas(plant.robot) for key, plant in by_plant.items()}
        masses = {key: plant.robot.mass for key, plant in by_plant.items()}
        self.side_areas = np.stack([areas[id(run.plant)] for run in runs])
        """Area of a side of every link, one row per robot [m^2]."""
        self._masses = np.array([[masses[id(run.plant)]] for run in runs])
        self._bodies = _BodiesInLanes(lanes, self.layout.n_bodies)
        self.is_wanted = False
        """Whether anybody has asked for forces: whoever does will ask again."""
        self.is_current = False
        """Whether the forces are those of the robots now."""
        n_bodies = self.layout.n_bodies
        self._link_forces = self._plant.kernels_of(WIDTH).link_forces
        self._chain = self.layout.chain
        self._no_log = aligned((0, self.layout.state_size, WIDTH), float)
        self._force = aligned((len(lanes), len(FORCES), n_bodies, 2, WIDTH), float)

    def evaluate_forces(self, block: int) -> None:
        """Compute the force on every body and all accelerations.

        Args:
            block: The block of lanes of which they are needed.
        """
        force = self._force[block : block + 1]
        self._link_forces(self._lanes[block], *self._chain, self._no_log, force)

    def evaluate_torques(self, blocks: Sequence[int]) -> Float[np.ndarray, "n n_joints"]:
        """Return the torque of every drive [N m].

        Args:
            blocks: The blocks of lanes of which they are needed; 0 in others.
        """
        run = self._plant.kernels_of(WIDTH).run
        n_joints = self.layout.n_joints
        torques = np.zeros((len(self._lanes), n_joints, WIDTH))
        sample = aligned((1, self.layout.sample_size, WIDTH), float)
        n_steps = 0  # only the sample at the start
        samples_every = 1
        for block in blocks:
            lanes = self._lanes[block].copy()
            is_implicit = self._plant.is_implicit
            run(
                lanes,
                *self.layout.chain,
                is_implicit,
                n_steps,
                self._plant.dt,
                samples_every,
                sample,
            )
            of_joints = sample_format.view_joints(sample, n_joints)
            torques[block] = of_joints[0, sample_format.place_of(rows.TORQUE)]
        return self._by_robot(torques)[:, self.layout.tail_link :]

    def water_force(self, component: "Component") -> Float[np.ndarray, "n n_links"]:
        """Return a component of the force of the water on every link [N].

        Args:
            component: Function that gives it from the force in world axes.
        """
        tail = self.layout.tail_link
        force = self._force[:, DRAG] + self._force[:, ADDED_MASS]
        if tail > 0:  # Fin bodies belong to the tail link.
            force[:, tail] += force[:, :tail].sum(axis=1)
        numbers = component(self._bodies, force[:, :, 0], force[:, :, 1])
        return self._by_robot(numbers)[:, tail:]

    def force_at_head_ends(self) -> Float[np.ndarray, "n n_joints 2"]:
        """Return the force in the joint at the head end of every body but the last [N]."""
        bodies = {row: self._by_robot(self._bodies[row]) for row in (*READ, *MASS_ROWS)}
        whole = self._force.sum(axis=1)
        force = np.stack([self._by_robot(whole[:, :, axis]) for axis in range(2)], axis=2)
        return joint_forces(
            bodies,
            force,
            masses=self._masses * bodies[rows.MASS_SHARE],
            first_moments=self._masses * bodies[rows.FIRST_MOMENT_SHARE],
        )

    def joint_moment(self) -> Float[np.ndarray, "n n_joints"]:
        """Return the moment about the vertical in every joint of the body [N m]."""
        bodies = {row: self._by_robot(self._bodies[row]) for row in READ}
        return joint_moments(bodies)[:, self.layout.tail_link :]

    def _by_robot(self, numbers: Float[np.ndarray, "n_blocks n_numbers n_lanes"]) -> np.ndarray:
        """Return numbers in lanes with one row per robot."""
        return numbers.transpose(0, 2, 1).reshape(-1, numbers.shape[1])[: self._n]


class _BodiesInLanes:
    """Rows of all bodies in all lanes.

    Args:
        lanes: Numbers of all runs.
        n_bodies: Number of bodies of each.
    """

    def __init__(self, lanes: Float[np.ndarray, "n_blocks n_rows n_lanes"], n_bodies: int) -> None:
        end = rows.HEADER_ROWS + n_bodies * rows.BODY_ROWS
        records = lanes[:, rows.HEADER_ROWS : end]
        self._records = records.reshape(len(lanes), n_bodies, rows.BODY_ROWS, -1)

    def __getitem__(self, row: int) -> Float[np.ndarray, "n_blocks n_bodies n_lanes"]:
        """Return a row of every body in every lane."""
        return self._records[:, :, row]


class FleetLoads(BodyLoads):
    """Loads of all robots at one instant: the fields of `BodyLoads`, one row per robot.

    Args:
        lanes: Evaluates them.
        blocks: Blocks of lanes in which any robot still swims; what is told of others means nothing.
    """

    _lanes: LoadsOfLanes
    _blocks: Sequence[int]

    def __init__(self, lanes: LoadsOfLanes, blocks: Sequence[int]) -> None:
        vars(self).update(_lanes=lanes, _blocks=blocks)

    @cached_property
    def joint_torque(self) -> np.ndarray:
        """Torque of every joint's drive [N m]."""
        return self._lanes.evaluate_torques(self._blocks)

    @cached_property
    def joint_force(self) -> np.ndarray:
        """Force in every joint [N]."""
        return _in_space(self._force_at_head_ends[:, self._tail :])

    @cached_property
    def joint_moment(self) -> np.ndarray:
        """Moment in every joint, about the joint [N m]."""
        moment = self._evaluated.joint_moment()
        in_space = np.zeros((*moment.shape, len(DIRECTIONS)))
        in_space[:, :, MOMENT_UP] = moment
        return in_space

    @cached_property
    def water_force(self) -> np.ndarray:
        """Force of the water on every link, drag and added mass [N]."""
        components = [self._evaluated.water_force(along_bodies), self._water_force_to_left]
        return _in_space(np.stack(components, axis=2))

    @cached_property
    def fin_force(self) -> np.ndarray:
        """Force of a driven fin on the tail link in its joint [N]."""
        if self._tail == 0:
            return np.zeros((len(self._lanes.side_areas), len(DIRECTIONS)))
        return _in_space(self._force_at_head_ends[:, self._tail - 1 : self._tail])[:, 0]

    @cached_property
    def pressure_difference(self) -> np.ndarray:
        """Mean pressure on the right side of every link less that on its left, in water [Pa]."""
        return self._water_force_to_left / self._lanes.side_areas

    @cached_property
    def _water_force_to_left(self) -> np.ndarray:
        """Force of the water on every link, to its left [N]."""
        return self._evaluated.water_force(left_of_bodies)

    @cached_property
    def _evaluated(self) -> LoadsOfLanes:
        """The lanes once forces and accelerations are computed."""
        if not self._lanes.is_current:
            for block in self._blocks:
                self._lanes.evaluate_forces(block)
        self._lanes.is_wanted = True
        self._lanes.is_current = True
        return self._lanes

    @cached_property
    def _force_at_head_ends(self) -> np.ndarray:
        """Force in the joint at the head end of every body but the last [N]."""
        return self._evaluated.force_at_head_ends()

    @property
    def _tail(self) -> int:
        """Index of the body that is the tail link."""
        return self._lanes.layout.tail_link


def _in_space(force: Float[np.ndarray, "n n_bodies 2"]) -> Float[np.ndarray, "n n_bodies 3"]:
    """Return forces in the plane with their component upward, which is none."""
    return np.concatenate((force, np.zeros((*force.shape[:2], 1))), axis=2)
