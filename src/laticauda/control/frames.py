"""Position of a robot relative to a path: what paths return, and all that guidance sees of it.

`Path` is the interface that guidance needs of a path; `laticauda.control.paths` has the usual ones.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, Generic, NamedTuple, TypeAlias, TypeVar

import numpy as np
from jaxtyping import Float

from laticauda.values import Extensible

State = TypeVar("State")
# The path modules import these from here, so that no import hook of the tests checks their fields
# before they do.
Position: TypeAlias = Float[np.ndarray, " n_axes"]
Distances: TypeAlias = Float[np.ndarray, " n_points"]
Points: TypeAlias = Float[np.ndarray, "n_points 2"]


class PathFrame(NamedTuple):
    """Position relative to the nearest point of the path, along and across the path."""

    along_track_distance: float
    """Path length up to the nearest point; negative before the start, beyond the length after the
    end [m]."""
    cross_track_error: float
    """Distance from the path, positive to the left of it (p_y of the paper) [m]."""
    path_tangential_angle: float
    """Direction of the path at the nearest point, from the world x axis, in [-pi, pi) [rad]."""
    curvature: float
    """Curvature of the path at the nearest point, positive where it turns left [1/m]."""
    remaining: float
    """Length of the path ahead; 0 after its end, infinite for a line without end [m]."""

    @property
    def signals(self) -> dict[str, float]:
        """Signals for the log."""
        return {
            "cross_track_error": float(self.cross_track_error),
            "along_track_distance": float(self.along_track_distance),
            "path_tangential_angle": float(self.path_tangential_angle),
        }


class Path(Extensible, Generic[State], group="paths"):
    """Path that a robot can follow. The progress along it is a value, like every state.

    Custom paths subclass this class; as values they are stored with their trials.
    """

    def init(self) -> State:
        """Return the progress before the first position is known."""
        raise NotImplementedError

    def locate(self, progress: State, position: Position) -> tuple[State, PathFrame]:
        """Locate a position relative to the path.

        Args:
            progress: Progress returned by the last call or by `init`.
            position: p [m], world axes; only the first two components are used.

        Returns:
            The new progress, and the position relative to the path.
        """
        raise NotImplementedError

    @classmethod
    def vectorize(cls, paths: Sequence[Any]) -> "VectorPath | None":
        """Return one object that locates a robot on each of many paths; None: they are asked one by one.

        It stands for `init` and `locate`; a subclass that changes these is not asked.

        Args:
            paths: Paths of this class, one for each robot.
        """
        del paths
        return None

    def points(self, along_track_distance: Distances) -> Points:
        """Return points of the path, for plots and tests.

        Args:
            along_track_distance: Distances along the path [m].

        Returns:
            One row x, y per distance [m], world axes; beyond its ends the path continues straight.
        """
        raise NotImplementedError


class PathFrames(NamedTuple):
    """Positions of many robots relative to the nearest points of their paths: a `PathFrame` of arrays."""

    along_track_distance: Float[np.ndarray, " n"]
    """Path length up to the nearest point [m]."""
    cross_track_error: Float[np.ndarray, " n"]
    """Distance from the path, positive to the left of it [m]."""
    path_tangential_angle: Float[np.ndarray, " n"]
    """Direction of the path at the nearest point, in [-pi, pi) [rad]."""
    curvature: Float[np.ndarray, " n"]
    """Curvature of the path at the nearest point, positive where it turns left [1/m]."""
    remaining: Float[np.ndarray, " n"]
    """Length of the path ahead [m]."""


class VectorPath(ABC):
    """Paths of many robots, with the progress of each. It is made for one run."""

    @abstractmethod
    def locate(self, position: Float[np.ndarray, "n n_axes"]) -> PathFrames:
        """Locate every robot relative to its path, after the last call.

        Args:
            position: p [m], one row per robot; only the first two components are used.
        """
