"""Loads of robots side by side, at the samples of their log."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from laticauda.models.dynamics.sampled_loads import SampledLoads
from laticauda.models.planar.internal_loads import compute_loads_of_lanes
from laticauda.models.planar.model import PlanarPlant


class LoadLog:
    """Loads of the robots in the lanes of a block, evaluated piece by piece while their log is written.

    Args:
        plants: Plants of the robots, of one kind; lanes that are left do as the last one.
        n_lanes: Number of lanes.
        n_samples: Number of samples of the log.
    """

    def __init__(self, plants: Sequence[PlanarPlant], n_lanes: int, n_samples: int) -> None:
        plant = plants[0]
        self._layout = plant.layout
        self._link_forces = plant.kernels_of(n_lanes).link_forces
        masses = [plant.robot.mass for plant in plants]
        self._masses = np.array(masses + masses[-1:] * (n_lanes - len(masses)))
        self._n_robots = len(plants)
        n_links = self._layout.n_bodies - self._layout.tail_link
        self._loads = SampledLoads.zeros(
            n_samples=n_samples, n_links=n_links, n_axes=2, lanes=(n_lanes,)
        )

    def add(
        self,
        lanes: Float[np.ndarray, "n_rows n_lanes"],
        samples: Float[np.ndarray, "n_samples n_numbers n_lanes"],
        first: int,
    ) -> None:
        """Evaluate the loads at some samples.

        Args:
            lanes: All rows under the command that acted then; they are left as they are.
            samples: The samples, complete ones.
            first: Index in the log of the first of them.
        """
        if not len(samples):
            return
        loads = compute_loads_of_lanes(
            self._link_forces, self._layout, lanes, samples, self._masses
        )
        added = slice(first, first + len(samples))
        for values, new_values in zip(self._loads.at(added), loads, strict=True):
            values[:] = new_values

    def loads(self) -> tuple[SampledLoads, ...]:
        """Return the loads of every robot; they mean nothing from where it diverged."""
        return tuple(self._loads.of_lane(lane) for lane in range(self._n_robots))
