"""What a robot can know of the current: an observer that compares where it gets to with where its gait takes it.

An extended Kalman filter around the averaged model tells what that needs to know and nobody measures: the direction of
motion, the speed and the drift. The gait's ripple of the heading is a state of its own, an oscillation at the gait's
frequency: so the mean heading comes without the half period that a mean over a cycle is late. Whatever moves the robot
beside the model is the drift, and what a steady one learns is the current.
"""

import math
from dataclasses import dataclass

import numpy as np

from laticauda.control.averaged import AveragedModel
from laticauda.interfaces import Observation
from laticauda.quantities import option, quantity, value

Array = np.ndarray
X, Y, PSI, BEND, SPEED, SWAY, DRIFT_X, DRIFT_Y, RIPPLE, QUADRATURE = range(10)
N_MOTION = 6  # states of the averaged model, the first ones
_N = 10
_DRIFT = slice(DRIFT_X, DRIFT_Y + 1)
# Spectral densities' square roots, of the same order for any snake that swims some cm/s with cycles of seconds.
_NOISE = np.array([3e-3, 3e-3, 0.03, 1e-3, 2e-3, 2e-3, 2e-3, 2e-3, 0.02, 0.02])
_START = np.array([0.02, 0.02, 0.2, 0.01, 0.02, 0.02, 0.05, 0.05, 0.2, 0.2])
_SEEN = np.array([0.05, 0.05, 0.03])  # the swing of the center of mass [m], what is left of the ripple [rad]
_COMPLEX_STEP = 1e-30


@dataclass(frozen=True, kw_only=True, eq=False)
class ObserverState:
    """What is believed, and how firmly."""

    time: float
    """Of the last observation [s]."""
    mean: Array
    """x, y [m], psi, b [rad], u, w [m/s], drift x, y [m/s], ripple and its quadrature [rad]."""
    covariance: Array
    """Of these."""

    @property
    def drift(self) -> Array:
        """Velocity with which it is carried, world axes [m/s]."""
        return self.mean[_DRIFT]


@value
class CurrentObserver:
    """The filter; its state is a value.

    Raises:
        ValueError: If a field is out of its range.
    """

    model: AveragedModel = option("How the gait moves the robot in still water: `fit_averaged`")
    speed_std: float = quantity(
        "m/s",
        "How well the model knows the speed, which a steady current along the heading cannot be told from",
        ge=0.0,
        default=0.01,
    )

    def init(self, observation: Observation) -> ObserverState:
        """What one `observation` tells: a place and about a heading, at rest, no drift.

        Args:
            observation: The first one.
        """
        mean = np.zeros(_N)
        mean[[X, Y]], mean[PSI] = observation.center_of_mass[:2], observation.heading
        return ObserverState(time=observation.time, mean=mean, covariance=np.diag(_START**2))

    def step(
        self, state: ObserverState | None, frequency: float, offset: float, observation: Observation
    ) -> ObserverState:
        """Go on to the next observation.

        Args:
            state: As the last call returned it; None before the first.
            frequency: Of the gait that was held since then [rad/s].
            offset: Of the joints that was held since then [rad].
            observation: Of now.
        """
        if state is None:
            return self.init(observation)
        dt = observation.time - state.time
        if dt <= 0.0:
            return state
        steps = np.eye(_N) * (1j * _COMPLEX_STEP)  # one column per derivative: exact, and no formula to keep in step
        moved = self._after(state.mean[:, np.newaxis] + steps, frequency, offset, dt)
        slope, mean = np.imag(moved) / _COMPLEX_STEP, np.real(moved[:, 0])
        covariance = slope @ state.covariance @ slope.T + np.diag(_NOISE**2 * dt)
        return _corrected(observation, mean, covariance, self.model.bend)

    def signals(self, state: ObserverState) -> dict[str, float]:
        """The current where the robot is, as `state` has it, and its standard deviations along x and y, for a log.

        Args:
            state: What is known now.
        """
        ahead = np.array([math.cos(state.mean[PSI]), math.sin(state.mean[PSI])])
        covariance = state.covariance[_DRIFT, _DRIFT] + self.speed_std**2 * np.outer(ahead, ahead)
        names = ("drift_x", "drift_y", "drift_x_std", "drift_y_std")
        return dict(zip(names, (*state.drift.tolist(), *np.sqrt(np.diag(covariance)).tolist()), strict=True))

    def _after(self, mean: Array, frequency: float, offset: float, dt: float) -> Array:
        moved = self.model.after(tuple(mean[:N_MOTION]), frequency, offset, dt, np.sin, np.cos)
        drift, c, s = mean[[DRIFT_X, DRIFT_Y]], math.cos(frequency * dt), math.sin(frequency * dt)
        ripple, quadrature = mean[RIPPLE], mean[QUADRATURE]
        turned = [c * ripple - s * quadrature, s * ripple + c * quadrature]
        return np.array([moved[0] + drift[0] * dt, moved[1] + drift[1] * dt, *moved[2:], *drift, *turned])


def _corrected(observation: Observation, mean: Array, covariance: Array, bend: float) -> ObserverState:
    sees = np.zeros((3, _N))
    sees[0, X] = sees[1, Y] = 1.0
    sees[2, [PSI, BEND, RIPPLE]] = 1.0, bend, 1.0
    x, y = observation.center_of_mass[:2]
    surprise = np.array([x, y, observation.heading]) - sees @ mean
    spread = sees @ covariance @ sees.T + np.diag(_SEEN**2)
    gain = np.linalg.solve(spread, sees @ covariance).T
    left = np.eye(_N) - gain @ sees
    kept = left @ covariance @ left.T + (gain * _SEEN**2) @ gain.T  # this form stays symmetric and positive
    return ObserverState(time=observation.time, mean=mean + gain @ surprise, covariance=kept)


def crab_angle(course: float, velocity: Array, speed: float, most: float) -> tuple[float, bool]:
    """How far upstream of its course a robot has to point: asin of the current across over the speed.

    Args:
        course: Where it is to go over ground [rad].
        velocity: Of the water, x and y, world axes [m/s].
        speed: Of the robot through the water, positive [m/s].
        most: Largest angle, at which a current that is too strong is met [rad].

    Returns:
        The angle, positive to the right [rad], and whether the current is too strong: it would take a larger one, or
        leaves no way forward.
    """
    c, s = math.cos(course), math.sin(course)
    along, across = (float(one) for one in velocity @ np.array([[c, -s], [s, c]]))
    asked = math.asin(min(max(across / speed, -1.0), 1.0))
    angle = min(max(asked, -most), most)
    return angle, abs(across) > speed * math.sin(most) or along + speed * math.cos(angle) <= 0.0
