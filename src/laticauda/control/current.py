"""Observer of the current: it compares the robot's motion with that expected from its gait.

An extended Kalman filter built on the averaged model estimates what the model needs but is not
measured: the direction of motion, the speed and the drift. The gait's ripple in the heading is a
separate state, an oscillation at the gait's frequency; the mean heading therefore lacks the
half-period delay of a mean over one cycle. Any motion of the robot that the model does not explain
is drift, and a steady drift is learned as the current.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from laticauda.control.averaged import AveragedModel
from laticauda.scenarios import Observation
from laticauda.values import option, quantity, value_class

Array = np.ndarray

# Indices of the observer's states; the first `N_MOTION` are those of the averaged model.
X = 0
"""Position along the world x axis [m]."""
Y = 1
"""Position along the world y axis [m]."""
PSI = 2
"""Direction of motion through the water [rad]."""
BEND = 3
"""Offset that the joints have adopted, b of the model [rad]."""
SPEED = 4
"""Speed along psi, u of the model [m/s]."""
SWAY = 5
"""Speed to the left of psi, w of the model [m/s]."""
DRIFT_X = 6
"""Drift along the world x axis [m/s]."""
DRIFT_Y = 7
"""Drift along the world y axis [m/s]."""
RIPPLE = 8
"""Ripple of the heading [rad]."""
QUADRATURE = 9
"""The same oscillation, a quarter of a period later [rad]."""
N_STATES = 10
N_MOTION = 6
_DRIFT = slice(DRIFT_X, DRIFT_Y + 1)

NOISE = np.array([3e-3, 3e-3, 0.03, 1e-3, 2e-3, 2e-3, 2e-3, 2e-3, 0.02, 0.02])
"""Square roots of the spectral densities of the process noise, in units of the states per sqrt(s).

They are of the same order for any snake that swims a few cm/s with cycles of seconds.
"""
INITIAL_STD = np.array([0.02, 0.02, 0.2, 0.01, 0.02, 0.02, 0.05, 0.05, 0.2, 0.2])
"""Standard deviations of the states after the first observation, in their units."""
MEASUREMENT_STD = np.array([0.05, 0.05, 0.03])
"""Swing of the center of mass with the gait, x and y [m], and ripple left in the heading [rad]."""
COMPLEX_STEP = 1e-30
"""Imaginary step whose effect, per step, is an exact derivative: no difference is formed [-]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ObserverState:
    """Estimate of the observer and its uncertainty."""

    time: float
    """Time of the last observation [s]."""
    mean: Array
    """x, y [m], psi, b [rad], u, w [m/s], drift x, y [m/s], ripple and its quadrature [rad]."""
    covariance: Array
    """Covariance of these states."""

    @property
    def drift(self) -> Array:
        """Drift velocity, world axes [m/s]."""
        return self.mean[_DRIFT]


@value_class
class CurrentObserver:
    """Extended Kalman filter that estimates the current; its state is a value.

    Raises:
        ValueError: If a field is out of its range.
    """

    model: AveragedModel = option("Model of the gait in still water, from `fit_averaged`")
    speed_std: float = quantity(
        "m/s",
        "Uncertainty of the model's speed, indistinguishable from a steady current along the heading",
        ge=0.0,
        default=0.01,
    )

    def init(self, observation: Observation) -> ObserverState:
        """Return the state after one `observation`: its position and heading, at rest.

        Args:
            observation: First observation.
        """
        mean = np.zeros(N_STATES)
        mean[[X, Y]] = observation.center_of_mass[:2]
        mean[PSI] = observation.heading
        covariance = np.diag(INITIAL_STD**2)
        return ObserverState(time=observation.time, mean=mean, covariance=covariance)

    def step(
        self, state: ObserverState | None, frequency: float, offset: float, observation: Observation
    ) -> ObserverState:
        """Advance to the next observation.

        Args:
            state: State returned by the last call; None before the first.
            frequency: Frequency of the gait held since then [rad/s].
            offset: Offset of the joints held since then [rad].
            observation: Latest observation.
        """
        if state is None:
            return self.init(observation)
        dt = observation.time - state.time
        if dt <= 0.0:
            return state
        # One column per state, and each column with a step in that state: the imaginary parts of
        # the result are the columns of the derivative F.
        steps = np.eye(N_STATES) * (1j * COMPLEX_STEP)
        columns = state.mean[:, np.newaxis] + steps
        columns_after = self.advance_mean(
            columns,
            frequency,
            offset,
            dt,
            cos_of_ripple=math.cos(frequency * dt),
            sin_of_ripple=math.sin(frequency * dt),
        )
        transition = np.imag(columns_after) / COMPLEX_STEP
        mean = np.real(columns_after[:, 0])
        covariance = transition @ state.covariance @ transition.T + np.diag(NOISE**2 * dt)
        return _correct(observation, mean, covariance, self.model.bend)

    def signals(self, state: ObserverState) -> dict[str, float]:
        """Return the estimated current and its standard deviations along x and y, for a log.

        Args:
            state: State of the observer.
        """
        psi = state.mean[PSI]
        direction = np.array([math.cos(psi), math.sin(psi)])
        # An error of the model's speed looks like a current along the direction of motion.
        covariance = state.covariance[_DRIFT, _DRIFT] + self.speed_std**2 * np.outer(
            direction, direction
        )
        drift_x, drift_y = state.drift.tolist()
        x_std, y_std = np.sqrt(np.diag(covariance)).tolist()
        return {"drift_x": drift_x, "drift_y": drift_y, "drift_x_std": x_std, "drift_y_std": y_std}

    def advance_mean(
        self,
        mean: Array,
        frequency: Any,
        offset: Any,
        dt: float,
        *,
        cos_of_ripple: Any,
        sin_of_ripple: Any,
    ) -> Array:
        """Return the mean, or several in further axes, after a time with one command.

        Args:
            mean: States along the first axis.
            frequency: Frequency of the gait, or one for each entry of the last axis [rad/s].
            offset: Offset of the joints, in the same way [rad].
            dt: The time [s].
            cos_of_ripple: Cosine of how far the gait's phase advances.
            sin_of_ripple: Its sine.
        """
        motion = self.model.after(tuple(mean[:N_MOTION]), frequency, offset, dt, np.sin, np.cos)
        x, y, *velocities_and_angles = motion
        drift = mean[[DRIFT_X, DRIFT_Y]]
        ripple = cos_of_ripple * mean[RIPPLE] - sin_of_ripple * mean[QUADRATURE]
        quadrature = sin_of_ripple * mean[RIPPLE] + cos_of_ripple * mean[QUADRATURE]
        return np.array(
            [
                x + drift[0] * dt,
                y + drift[1] * dt,
                *velocities_and_angles,
                *drift,
                ripple,
                quadrature,
            ]
        )


def _correct(
    observation: Observation, mean: Array, covariance: Array, bend: float
) -> ObserverState:
    """Correct the predicted mean and covariance by an observed position and heading."""
    sensitivity = np.zeros((3, N_STATES))
    sensitivity[0, X] = 1.0
    sensitivity[1, Y] = 1.0
    sensitivity[2, [PSI, BEND, RIPPLE]] = 1.0, bend, 1.0
    x, y = observation.center_of_mass[:2]
    residual = np.array([x, y, observation.heading]) - sensitivity @ mean
    spread = sensitivity @ covariance @ sensitivity.T + np.diag(MEASUREMENT_STD**2)
    gain = np.linalg.solve(spread, sensitivity @ covariance).T
    # Joseph form: stays symmetric and positive.
    remainder = np.eye(N_STATES) - gain @ sensitivity
    of_prediction = remainder @ covariance @ remainder.T
    of_measurement = (gain * MEASUREMENT_STD**2) @ gain.T
    return ObserverState(
        time=observation.time,
        mean=mean + gain @ residual,
        covariance=of_prediction + of_measurement,
    )


def crab_angle(
    course: float, velocity: Array, speed: float, max_angle: float
) -> tuple[float, bool]:
    """Return the angle by which a robot must point upstream of its course.

    It is asin of the current across the course over the speed.

    Args:
        course: Desired course over ground [rad].
        velocity: Velocity of the water, x and y, world axes [m/s].
        speed: Speed of the robot through the water, positive [m/s].
        max_angle: Largest angle, used if the current is too strong [rad].

    Returns:
        The angle, positive to the right [rad], and whether the current is too strong: it would
        require a larger angle or prevents forward motion.
    """
    c = math.cos(course)
    s = math.sin(course)
    along, across = (velocity @ np.array([[c, -s], [s, c]])).tolist()
    sine = min(max(across / speed, -1.0), 1.0)
    angle = min(max(math.asin(sine), -max_angle), max_angle)
    is_across_too_strong = abs(across) > speed * math.sin(max_angle)
    is_stopped = along + speed * math.cos(angle) <= 0.0
    return angle, is_across_too_strong or is_stopped
