"""Observer of the current: it compares the robot's actual motion with the motion expected from its gait.

An extended Kalman filter built on the averaged model estimates what the model needs but is not
measured: the direction of motion, the speed and the drift. The gait's ripple in the heading is a
separate state, an oscillation at the gait's frequency; the mean heading therefore lacks the
half-period delay of a mean over one cycle. Any motion of the robot that the model does not explain
is drift, and a steady drift is learned as the current.
"""

import math
from dataclasses import dataclass

import numpy as np

from laticauda.control.averaged import AveragedModel
from laticauda.scenarios.interfaces import Observation
from laticauda.values.quantities import option, quantity, value_class

Array = np.ndarray
X, Y, PSI, BEND, SPEED, SWAY, DRIFT_X, DRIFT_Y, RIPPLE, QUADRATURE = range(10)
N_MOTION = 6  # states of the averaged model, the first ones
_N = 10
_DRIFT = slice(DRIFT_X, DRIFT_Y + 1)
# Square roots of the spectral densities, of the same order for any snake that swims a few cm/s with
# cycles of seconds.
_NOISE = np.array([3e-3, 3e-3, 0.03, 1e-3, 2e-3, 2e-3, 2e-3, 2e-3, 0.02, 0.02])
_START = np.array([0.02, 0.02, 0.2, 0.01, 0.02, 0.02, 0.05, 0.05, 0.2, 0.2])
_SEEN = np.array([0.05, 0.05, 0.03])  # swing of the center of mass [m], residual ripple [rad]
_COMPLEX_STEP = 1e-30


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
        """Return the state after one `observation`: a position and an approximate heading, at rest, without drift.

        Args:
            observation: First observation.
        """
        mean = np.zeros(_N)
        mean[[X, Y]], mean[PSI] = observation.center_of_mass[:2], observation.heading
        return ObserverState(time=observation.time, mean=mean, covariance=np.diag(_START**2))

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
        steps = np.eye(_N) * (
            1j * _COMPLEX_STEP
        )  # one column per derivative: exact, no formula to maintain
        moved = self._after(state.mean[:, np.newaxis] + steps, frequency, offset, dt)
        slope, mean = np.imag(moved) / _COMPLEX_STEP, np.real(moved[:, 0])
        covariance = slope @ state.covariance @ slope.T + np.diag(_NOISE**2 * dt)
        return _corrected(observation, mean, covariance, self.model.bend)

    def signals(self, state: ObserverState) -> dict[str, float]:
        """Return the current at the robot estimated in `state`, and its standard deviations along x and y, for a log.

        Args:
            state: State of the observer.
        """
        ahead = np.array([math.cos(state.mean[PSI]), math.sin(state.mean[PSI])])
        covariance = state.covariance[_DRIFT, _DRIFT] + self.speed_std**2 * np.outer(ahead, ahead)
        names = ("drift_x", "drift_y", "drift_x_std", "drift_y_std")
        return dict(
            zip(names, (*state.drift.tolist(), *np.sqrt(np.diag(covariance)).tolist()), strict=True)
        )

    def _after(self, mean: Array, frequency: float, offset: float, dt: float) -> Array:
        moved = self.model.after(tuple(mean[:N_MOTION]), frequency, offset, dt, np.sin, np.cos)
        drift, c, s = mean[[DRIFT_X, DRIFT_Y]], math.cos(frequency * dt), math.sin(frequency * dt)
        ripple, quadrature = mean[RIPPLE], mean[QUADRATURE]
        turned = [c * ripple - s * quadrature, s * ripple + c * quadrature]
        return np.array(
            [moved[0] + drift[0] * dt, moved[1] + drift[1] * dt, *moved[2:], *drift, *turned]
        )


def _corrected(
    observation: Observation, mean: Array, covariance: Array, bend: float
) -> ObserverState:
    sees = np.zeros((3, _N))
    sees[0, X] = sees[1, Y] = 1.0
    sees[2, [PSI, BEND, RIPPLE]] = 1.0, bend, 1.0
    x, y = observation.center_of_mass[:2]
    surprise = np.array([x, y, observation.heading]) - sees @ mean
    spread = sees @ covariance @ sees.T + np.diag(_SEEN**2)
    gain = np.linalg.solve(spread, sees @ covariance).T
    left = np.eye(_N) - gain @ sees
    kept = (
        left @ covariance @ left.T + (gain * _SEEN**2) @ gain.T
    )  # Joseph form: stays symmetric and positive
    return ObserverState(time=observation.time, mean=mean + gain @ surprise, covariance=kept)


def crab_angle(course: float, velocity: Array, speed: float, most: float) -> tuple[float, bool]:
    """Return the angle by which a robot must point upstream of its course: asin of the cross current over the speed.

    Args:
        course: Desired course over ground [rad].
        velocity: Velocity of the water, x and y, world axes [m/s].
        speed: Speed of the robot through the water, positive [m/s].
        most: Largest angle, used if the current is too strong [rad].

    Returns:
        The angle, positive to the right [rad], and whether the current is too strong: it would
        require a larger angle or prevents forward motion.
    """
    c, s = math.cos(course), math.sin(course)
    along, across = (float(one) for one in velocity @ np.array([[c, -s], [s, c]]))
    asked = math.asin(min(max(across / speed, -1.0), 1.0))
    angle = min(max(asked, -most), most)
    return angle, abs(across) > speed * math.sin(most) or along + speed * math.cos(angle) <= 0.0
