"""A motion of a chain over time: coordinates with their rates and accelerations, of one or of many draws."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.film.chain.geometry import N_ROOT


@dataclass(frozen=True, kw_only=True, eq=False)
class ChainMotion:
    """Coordinates of a chain over time; the axes before time are those of draws, if any."""

    time: Float[np.ndarray, " n_times"]
    """Times [s]."""
    coordinates: Float[np.ndarray, "*batch n_times n_coordinates"]
    """x and y of the center of mass [m], heading and joint angles, tail first [rad]."""
    rates: Float[np.ndarray, "*batch n_times n_coordinates"]
    """Their rates."""
    accelerations: Float[np.ndarray, "*batch n_times n_coordinates"]
    """Their accelerations."""

    @property
    def center_of_mass(self) -> Float[np.ndarray, "*batch n_times 2"]:
        """Position of the center of mass [m]."""
        return self.coordinates[..., :2]

    @property
    def heading(self) -> Float[np.ndarray, "*batch n_times"]:
        """Mean angle of the links [rad]."""
        return self.coordinates[..., 2]

    @property
    def joint_angle(self) -> Float[np.ndarray, "*batch n_times n_joints"]:
        """Joint angles, tail first [rad]."""
        return self.coordinates[..., N_ROOT:]

    def __getitem__(self, draw: int | slice) -> "ChainMotion":
        """Return one draw of many, or some of them."""
        return ChainMotion(
            time=self.time,
            coordinates=self.coordinates[draw],
            rates=self.rates[draw],
            accelerations=self.accelerations[draw],
        )
