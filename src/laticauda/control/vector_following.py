"""Path following of many robots at once: `laticauda.control.path_following`, written for arrays."""

from collections.abc import Sequence

import numpy as np

from laticauda.control.path_following import SLOWEST, PathFollowing
from laticauda.control.vector_current import CurrentObservers
from laticauda.control.vector_guidance import (
    HeadingControllers,
    HeadingEstimates,
    vectorize_guidance,
)
from laticauda.control.vector_paths import vectorize_paths
from laticauda.scenarios import Observations, VectorController
from laticauda.values import wrap_to_pi


class VectorFollowing(VectorController):
    """Makes many robots follow a path each.

    Args:
        controllers: Controllers, one for each robot, whose paths are of one class, and whose guidance
            laws are of one class. If they observe the current, then all with the same model.
    """

    def __init__(self, controllers: Sequence[PathFollowing]) -> None:
        self._paths = vectorize_paths([controller.path for controller in controllers])
        self._guidance = vectorize_guidance([controller.guidance for controller in controllers])
        self._heading = HeadingControllers([controller.heading for controller in controllers])
        self._estimates = HeadingEstimates(
            np.array([controller.estimate.window for controller in controllers])
        )
        self._observers = _observers_of(controllers)
        self._max_crab_angle = np.array([controller.max_crab_angle for controller in controllers])
        self._own_offset = np.array([controller.gait.offset for controller in controllers])
        self._offset = np.zeros(len(controllers))
        """Offset that was commanded last [rad]."""
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
        current_signals: dict[str, np.ndarray] = {}
        if self._observers is not None:
            held_offset = self._own_offset + self._offset
            self._observers.step(observations, held_offset, _dt_of_swimmers(observations, dt))
            crab = self._observers.crab(heading_ref, self._max_crab_angle, SLOWEST)
            heading_ref = heading + wrap_to_pi(heading_ref - crab.angle - heading)
            current_signals = self._observers.signals | {
                "crab_angle": crab.angle,
                "is_crab_limited": crab.is_limited.astype(float),
            }
        offset, is_saturated = self._heading.offset(heading_ref=heading_ref, heading=heading)
        self._offset = offset
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
            **current_signals,
        }
        return {"offset": offset}


def _observers_of(controllers: Sequence[PathFollowing]) -> CurrentObservers | None:
    """Return the observers of the current; None if there are none."""
    observers = [controller.observer for controller in controllers if controller.observer]
    if not observers:
        return None
    frequency = np.array([controller.gait.frequency for controller in controllers])
    return CurrentObservers(observers, frequency)


def _dt_of_swimmers(observations: Observations, dt: np.ndarray) -> float:
    """Return the time since the last instant, which is the same for all robots that still swim [s]."""
    swimmers = np.flatnonzero(observations.is_well)
    if swimmers.size == 0:
        return 0.0
    return float(dt[swimmers[0]])
