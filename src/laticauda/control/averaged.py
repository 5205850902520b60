"""The averaged model: how a swimming snake moves from gait cycle to gait cycle, in six states.

    x' = u cos(psi) - w sin(psi)        psi' = r = turning(frequency, b)        heading = psi + bend b
    y' = u sin(psi) + w cos(psi)        b' = (offset - b) / bend_lag
    u' = (speed(frequency, offset) - u) / speed_lag                w' = (sway turning(frequency, offset) - w) / sway_lag

A robot that bends turns its links at once, by `bend` per offset, and its direction of motion slowly: so psi is not the
heading (6). The model knows neither links nor water. Its numbers come out of trials (`fit_averaged`), simulated or
measured; it is for guidance to plan with, and no model of the body.

What it needs to know and nobody measures, the direction of motion, the speed and the drift, an extended Kalman filter
around it tells. The gait's ripple of the heading is a state of its own, an oscillation at the gait's frequency: so the
mean heading comes without the half period that a mean over a cycle is late. Whatever moves the robot beside the model
is the drift, and what a steady one learns is the current.
"""

import math
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from laticauda.interfaces import Observation
from laticauda.quantities import quantity, value

State: TypeAlias = tuple[Any, Any, Any, Any, Any, Any]


@value
class AveragedModel:
    """One gait with one robot, at any frequency and offset within what it was fitted to.

    Raises:
        ValueError: If a field is out of its range.

    Example:
        >>> model = AveragedModel(
        ...     turn_0=0.2, turn_1=0.4, bend=1.4, bend_lag=0.2, speed_0=0.0, speed_1=0.08, speed_offset=0.0,
        ...     speed_lag=2.0, sway=0.25, sway_lag=1.0, power_0=0.0, power_1=4.0, power_exponent=2.2, power_offset=0.0,
        ... )
        >>> model.speed(1.5, 0.0)
        0.12
    """

    turn_0: float = quantity("1/s", "Turning rate per offset, at frequency 0")
    turn_1: float = quantity("", "What it gains with the frequency")
    bend: float = quantity("", "What an offset adds to the mean link angle at once, before the robot turns")
    bend_lag: float = quantity("s", "Time constant with which the joints take the offset on", gt=0.0)
    speed_0: float = quantity("m/s", "Speed along the heading, at frequency 0")
    speed_1: float = quantity("m", "What it gains with the frequency")
    speed_offset: float = quantity(
        "m", "What it gains with the frequency and the square of the offset; negative, for a bent robot is slower"
    )
    speed_lag: float = quantity("s", "Time constant of the speed", gt=0.0)
    sway: float = quantity("m", "Speed to the left of psi per turning rate")
    sway_lag: float = quantity("s", "Time constant of that speed", gt=0.0)
    power_0: float = quantity("W", "Power at frequency 0")
    power_1: float = quantity("W (s/rad)^k", "What it gains with the frequency to the power of k", ge=0.0)
    power_exponent: float = quantity("", "k", gt=0.0)
    power_offset: float = quantity("W (s/rad)^k", "What it gains with that and the square of the offset")

    # The arguments are numbers, arrays or CasADi's symbols: one text serves the fit, the observer and the plan.

    def turning(self, frequency: Any, offset: Any) -> Any:
        """Turning rate that an offset comes to [rad/s]; `frequency` in rad/s, `offset` in rad, here and below."""
        return (self.turn_0 + self.turn_1 * frequency) * offset

    def speed(self, frequency: Any, offset: Any) -> Any:
        """Speed along the heading that a gait comes to, through the water [m/s].

        Args:
            frequency: omega [rad/s].
            offset: phi_0 [rad].
        """
        return self.speed_0 + frequency * (self.speed_1 + self.speed_offset * offset**2)

    def power(self, frequency: Any, offset: Any) -> Any:
        """Mean power over a cycle [W].

        Args:
            frequency: omega [rad/s].
            offset: phi_0 [rad].
        """
        return self.power_0 + frequency**self.power_exponent * (self.power_1 + self.power_offset * offset**2)

    def after(
        self, state: State, frequency: Any, offset: Any, dt: float, sin: Any = math.sin, cos: Any = math.cos
    ) -> State:
        """The state after a time in which one command was held, in still water.

        The lags and psi are exact; the way is an integral over three points of them (Simpson).

        Args:
            state: x and y [m], psi and b [rad], u and w [m/s].
            frequency: Of the gait [rad/s].
            offset: Of all joints [rad].
            dt: That time [s].
            sin: The sine of whatever kind the arguments are.
            cos: Their cosine.
        """
        x, y, psi, bent, speed, sway = state
        steady, aside = self.speed(frequency, offset), self.sway * self.turning(frequency, offset)
        rate = self.turn_0 + self.turn_1 * frequency
        dx: Any = 0.0
        dy: Any = 0.0
        angle, b, u, w = psi, bent, speed, sway
        for t, weight in ((0.0, dt / 6.0), (0.5 * dt, dt * 2.0 / 3.0), (dt, dt / 6.0)):
            left = math.exp(-t / self.bend_lag)
            b = offset + (bent - offset) * left
            u = steady + (speed - steady) * math.exp(-t / self.speed_lag)
            angle = psi + rate * (offset * t + (bent - offset) * (self.bend_lag * (1.0 - left)))
            w = aside + (sway - aside) * math.exp(-t / self.sway_lag)
            dx = dx + weight * (u * cos(angle) - w * sin(angle))
            dy = dy + weight * (u * sin(angle) + w * cos(angle))
        return x + dx, y + dy, angle, b, u, w


Array = np.ndarray
X, Y, PSI, BEND, SPEED, SWAY, DRIFT_X, DRIFT_Y, RIPPLE, QUADRATURE = range(10)
N_MOTION = 6  # states of the averaged model, the first ones
_N = 10
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
    def drift(self) -> tuple[float, float]:
        """Velocity with which it is carried, world axes [m/s]."""
        return float(self.mean[DRIFT_X]), float(self.mean[DRIFT_Y])


@dataclass(frozen=True, kw_only=True)
class AveragedObserver:
    """The filter; its state is a value."""

    model: AveragedModel
    """What the robot is expected to do."""

    def init(self, observation: Observation) -> ObserverState:
        """What one `observation` tells: a place and about a heading, at rest, no drift."""
        mean = np.zeros(_N)
        mean[[X, Y]], mean[PSI] = observation.center_of_mass[:2], observation.heading
        return ObserverState(time=observation.time, mean=mean, covariance=np.diag(_START**2))

    def step(self, state: ObserverState, frequency: float, offset: float, observation: Observation) -> ObserverState:
        """Go on to the next observation.

        Args:
            state: As the last call returned it, or `init`.
            frequency: Of the gait that was held since then [rad/s].
            offset: Of the joints that was held since then [rad].
            observation: Of now.
        """
        dt = observation.time - state.time
        if dt <= 0.0:
            return state
        steps = np.eye(_N) * (1j * _COMPLEX_STEP)  # one column per derivative: exact, and no formula to keep in step
        moved = self._after(state.mean[:, np.newaxis] + steps, frequency, offset, dt)
        slope, mean = np.imag(moved) / _COMPLEX_STEP, np.real(moved[:, 0])
        covariance = slope @ state.covariance @ slope.T + np.diag(_NOISE**2 * dt)
        return _corrected(observation, mean, covariance, self.model.bend)

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
