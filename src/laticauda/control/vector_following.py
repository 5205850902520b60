"""Path following of many robots at once: `laticauda.control.path_following`, written for arrays."""

from collections.abc import Sequence

import numpy as np

from laticauda.control.path_following import PathFollowing
from laticauda.control.vector_guidance import (
    HeadingControllers,
    HeadingEstimates,
    vectorize_guidance,
)
from laticauda.control.vector_paths import vectorize_paths
from laticauda.scenarios import Observations, VectorController


class VectorFollowing(VectorController):
    """Makes many robots follow a path each.

    Args:
        controllers: Controllers without an observer of the current, one for each robot, whose paths
            are of one class, and whose guidance laws are of one class.
    """

    def __init__(self, controllers: Sequence[PathFollowing]) -> None:
        self._paths = vectorize_paths([controller.path for controller in controllers])
        self._guidance = vectorize_guidance([controller.guidance for controller in controllers])
        self._heading = HeadingControllers([controller.heading for controller in controllers])
        self._estimates = HeadingEstimates(
            np.array([controller.estimate.window for controller in controllers])
        )
        self._time: np.ndarray | None = None
        """Time of the last control instant; None before the first [s]."""
        self._is_saturated = np.zeros(len(controllers), dtype=bool)

    def step(self, observations: Observations) -> dict[str, np.ndarray]:
        """Return the offset of every robot [rad].

        Args:
            observations: Current observations of the robots.
        """
        time = observations.time
        dt = np.zeros(time.size)
        if self._time is not None:
            dt = time - self._time
        heading = self._estimates.step(time, observations.heading)
        frames = self._paths.locate(observations.center_of_mass)
        heading_ref = self._guidance.step(frames, heading, dt, self._is_saturated)
        offset, is_saturated = self._heading.offset(heading_ref=heading_ref, heading=heading)
        self._time = time
        self._is_saturated = is_saturated
        self.signals = {
            "heading_ref": heading_ref,
            "heading_used": heading,
            "cross_track_error": frames.cross_track_error,
            "along_track_distance": frames.along_track_distance,
            "path_tangential_angle": frames.path_tangential_angle,
            "offset": offset,
            "is_saturated": is_saturated.astype(float),
        }
        return {"offset": offset}
