"""What is true of a robot at one moment, as sensors see it, and what they tell."""

from collections.abc import Callable
from functools import cached_property
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.sensing.body_loads import BodyLoads

EVALUATE_LOADS = "_evaluate_loads"
"""Attribute by which a plant gives an observation what computes its loads (`Observation.give_loads`)."""


class Reading(NamedTuple):
    """What a sensor last told."""

    time: float
    """When it was measured; -inf before the first measurement has arrived [s]."""
    values: Float[np.ndarray, " n_columns"]
    """Its values, nan where there is none."""
    is_new: bool
    """Whether it arrived at this instant."""


class HeadMotion(NamedTuple):
    """Where the tip of the head is and how it moves, world axes, z up."""

    position: Float[np.ndarray, " 3"]
    """Position of the tip [m]."""
    axes: Float[np.ndarray, "3 3"]
    """Columns: forward, left and up of the head [-]."""
    velocity: Float[np.ndarray, " 3"]
    """Velocity of the tip [m/s]."""
    turn_rate: Float[np.ndarray, " 3"]
    """Angular velocity of the head [rad/s]."""


class Observed:
    """What sensors see of a robot: base of what plants observe (`laticauda.scenarios.Observation`)."""

    time: float
    """Time [s]."""
    contact_force: Float[np.ndarray, "n_links 3"] | None
    """Total contact force on every link; None where nothing touches [N]."""
    energy: float
    """Electrical energy since the start, or the joints' work if the robot has no power model [J]."""

    @property
    def head(self) -> HeadMotion:
        """Where the head is and how it moves.

        Raises:
            NotImplementedError: If no plant made this observation.
        """
        raise NotImplementedError

    @cached_property
    def loads(self) -> BodyLoads:
        """What links and joints bear at this instant, under the command that acted until now.

        Computed when it is first asked for; what does not ask pays nothing.

        Raises:
            ValueError: If the observation is not that of a model.
        """
        evaluate: Callable[[], BodyLoads] | None = vars(self).get(EVALUATE_LOADS)
        if evaluate is None:
            raise ValueError("`loads` are known to models only: this observation is not of one.")
        return evaluate()
