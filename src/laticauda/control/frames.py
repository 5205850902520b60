"""Where a robot is with respect to a path: the one answer that every path gives, and all that guidance sees of it."""

from typing import Generic, NamedTuple, TypeAlias, TypeVar

import numpy as np
from jaxtyping import Float

from laticauda.extensions import Extensible

State = TypeVar("State")
# The modules of the paths take these from here, and check their fields themselves: no hook of the tests does before.
Position: TypeAlias = Float[np.ndarray, " n_axes"]
Distances: TypeAlias = Float[np.ndarray, " n_points"]
Points: TypeAlias = Float[np.ndarray, "n_points 2"]


class PathFrame(NamedTuple):
    """A position seen from the path: from the nearest point of it, in axes along and across."""

    along_track_distance: float
    """Length of the path up to the nearest point; negative before its begin, beyond its length after its end [m]."""
    cross_track_error: float
    """Distance from the path, positive to the left of it (p_y of the paper) [m]."""
    path_tangential_angle: float
    """Direction of the path there, to the world x axis, in [-pi, pi) [rad]."""
    curvature: float
    """Of the path there, positive where it turns left [1/m]."""
    remaining: float
    """Length of the path ahead; 0 after its end, infinite for a line that has none [m]."""

    @property
    def signals(self) -> dict[str, float]:
        """What logs have of it."""
        names = "cross_track_error", "along_track_distance", "path_tangential_angle"
        return {name: float(getattr(self, name)) for name in names}


class Path(Extensible, Generic[State], group="paths"):
    """What a robot can follow. How far it has come is a value, like every state.

    One's own is a class below this one; as a value it is stored with its trials.
    """

    def init(self) -> State:
        """The progress before the first position is known."""
        raise NotImplementedError

    def locate(self, progress: State, position: Position) -> tuple[State, PathFrame]:
        """Find a position on the path.

        Args:
            progress: As the last call returned it, or `init`.
            position: p [m], world axes; the first two count.

        Returns:
            The progress now, and the position seen from the path.
        """
        raise NotImplementedError

    def points(self, along_track_distance: Distances) -> Points:
        """Points of the path, for a drawing or a test.

        Args:
            along_track_distance: How far along [m].

        Returns:
            One row x, y per distance [m], world axes; beyond its ends the path goes straight on.
        """
        raise NotImplementedError
