"""Observers of the current for many robots at once: `laticauda.control.current`, written for arrays."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from laticauda.control.current import (
    BEND,
    COMPLEX_STEP,
    DRIFT_X,
    DRIFT_Y,
    INITIAL_STD,
    MEASUREMENT_STD,
    N_STATES,
    NOISE,
    PSI,
    RIPPLE,
    SPEED,
    CurrentObserver,
    X,
    Y,
)
from laticauda.control.vector_guidance import apply
from laticauda.scenarios import Observations

Numbers = Float[np.ndarray, " n"]


class Crabs(NamedTuple):
    """How robots point into the current, so that their courses over ground are the desired ones."""

    angle: Numbers
    """Angles upstream of the course, positive to the right [rad]."""
    is_limited: Bool[np.ndarray, " n"]
    """Whether the current is too strong for the course."""


class CurrentObservers:
    """Extended Kalman filters of many robots. It is made for one run.

    Args:
        observers: One for each robot, all with the same model.
        frequency: Frequencies of the robots' gaits [rad/s].
    """

    def __init__(self, observers: Sequence[CurrentObserver], frequency: Numbers) -> None:
        self._observer = observers[0]
        self._frequency = frequency
        self._speed_std = np.array([observer.speed_std for observer in observers])
        self._usual_speed = self._observer.model.speed(frequency, 0.0)
        self._sensitivity = np.zeros((3, N_STATES))
        self._sensitivity[0, X] = 1.0
        self._sensitivity[1, Y] = 1.0
        self._sensitivity[2, [PSI, BEND, RIPPLE]] = 1.0, self._observer.model.bend, 1.0
        self._mean: np.ndarray | None = None
        """One column per robot; None before the first observation."""
        self._covariance = np.empty((0, N_STATES, N_STATES))

    @property
    def mean(self) -> Float[np.ndarray, "n_states n"]:
        """Estimated states, one column per robot, after the first observation."""
        assert self._mean is not None
        return self._mean

    def step(self, observations: Observations, offset: Numbers, dt: float) -> None:
        """Advance to the next observation.

        Args:
            observations: Latest observations.
            offset: Offsets of the joints held since the last ones [rad].
            dt: Time since then; not used at the first [s].
        """
        if self._mean is None:
            self._begin(observations)
        else:
            with np.errstate(all="ignore"):  # of robots that no longer swim
                self._advance(self._mean, offset, dt)
                self._correct(observations)

    def _begin(self, observations: Observations) -> None:
        """Begin with the first positions and headings, at rest."""
        n = len(observations)
        mean = np.zeros((N_STATES, n))
        mean[[X, Y]] = observations.center_of_mass[:, :2].T
        mean[PSI] = observations.heading
        self._mean = mean
        self._covariance = np.repeat(np.diag(INITIAL_STD**2)[np.newaxis], n, axis=0)

    def _advance(self, mean: np.ndarray, offset: Numbers, dt: float) -> None:
        """Predict mean and covariance after a time `dt` with one command."""
        turn = self._frequency * dt
        steps = np.eye(N_STATES) * (1j * COMPLEX_STEP)
        # By state, step and robot.
        columns = mean[:, np.newaxis] + steps[:, :, np.newaxis]
        columns_after = self._observer.advance_mean(
            columns,
            self._frequency,
            offset,
            dt,
            cos_of_ripple=apply(math.cos, turn),
            sin_of_ripple=apply(math.sin, turn),
        )
        by_robot = np.moveaxis(np.imag(columns_after) / COMPLEX_STEP, 2, 0)
        transition = np.ascontiguousarray(by_robot)
        self._mean = np.real(columns_after[:, 0])
        self._covariance = transition @ self._covariance @ transition.swapaxes(1, 2)
        self._covariance += np.diag(NOISE**2 * dt)

    def _correct(self, observations: Observations) -> None:
        """Correct the predicted mean and covariance by the observed positions and headings."""
        sensitivity = self._sensitivity
        x, y = observations.center_of_mass[:, :2].T
        observed = np.stack([x, y, observations.heading])
        residual = observed - sensitivity @ self.mean
        seen = sensitivity @ self._covariance
        spread = seen @ sensitivity.T + np.diag(MEASUREMENT_STD**2)
        gain = np.linalg.solve(spread, seen).swapaxes(1, 2)
        # Joseph form: stays symmetric and positive.
        remainder = np.eye(N_STATES) - gain @ sensitivity
        of_prediction = remainder @ self._covariance @ remainder.swapaxes(1, 2)
        of_measurement = (gain * MEASUREMENT_STD**2) @ gain.swapaxes(1, 2)
        change = gain @ residual.T[:, :, np.newaxis]
        self._mean = self.mean + change[:, :, 0].T
        self._covariance = of_prediction + of_measurement

    def crab(self, course: Numbers, max_angle: Numbers, slowest: float) -> Crabs:
        """Return how the robots must point into the observed current.

        Args:
            course: Desired courses over ground [rad].
            max_angle: Largest angles, used if the current is too strong [rad].
            slowest: Lower bound of the speeds, as a fraction of those of the gaits [-].
        """
        speed = np.maximum(self.mean[SPEED], slowest * self._usual_speed)
        drift_x, drift_y = self.mean[DRIFT_X], self.mean[DRIFT_Y]
        c = apply(math.cos, course)
        s = apply(math.sin, course)
        along = drift_x * c + drift_y * s
        across = drift_y * c - drift_x * s
        sine = np.clip(across / speed, -1.0, 1.0)
        angle = np.clip(apply(math.asin, sine), -max_angle, max_angle)
        is_across_too_strong = np.abs(across) > speed * apply(math.sin, max_angle)
        is_stopped = along + speed * apply(math.cos, angle) <= 0.0
        return Crabs(angle=angle, is_limited=is_across_too_strong | is_stopped)

    @property
    def signals(self) -> dict[str, np.ndarray]:
        """Estimated currents and their standard deviations along x and y, for a log."""
        psi = self.mean[PSI]
        variance_of_speed = self._speed_std**2
        c = apply(math.cos, psi)
        s = apply(math.sin, psi)
        variance_x = self._covariance[:, DRIFT_X, DRIFT_X] + variance_of_speed * (c * c)
        variance_y = self._covariance[:, DRIFT_Y, DRIFT_Y] + variance_of_speed * (s * s)
        return {
            "drift_x": self.mean[DRIFT_X],
            "drift_y": self.mean[DRIFT_Y],
            "drift_x_std": np.sqrt(variance_x),
            "drift_y_std": np.sqrt(variance_y),
        }
