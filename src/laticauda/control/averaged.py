"""The averaged model: how a swimming snake moves from gait cycle to gait cycle, in six states.

    x' = u cos(psi) - w sin(psi)        psi' = r = turning(frequency, b)        heading = psi + bend b
    y' = u sin(psi) + w cos(psi)        b' = (offset - b) / bend_lag
    u' = (speed(frequency, offset) - u) / speed_lag                w' = (sway turning(frequency, offset) - w) / sway_lag

A robot that bends turns its links at once, by `bend` per offset, and its direction of motion slowly: so psi is not the
heading (6). The model knows neither links nor water. Its numbers come out of trials (`fit_averaged`), simulated or
measured; it is for guidance to plan with, and no model of the body.

What it needs to know and nobody measures, a filter around it tells (`laticauda.control.current`).
"""

import math
from typing import Any, TypeAlias

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
    speed_offset: float = quantity("m", "What it gains with frequency and offset^2; negative: a bent robot is slower")
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
