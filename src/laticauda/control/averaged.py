"""Averaged model: the motion of a swimming snake from gait cycle to gait cycle, in six states.

    x' = u cos(psi) - w sin(psi)        psi' = r = turning(frequency, b)        heading = psi + bend b
    y' = u sin(psi) + w cos(psi)        b' = (offset - b) / bend_lag
    u' = (speed(frequency, offset) - u) / speed_lag
    w' = (sway turning(frequency, offset) - w) / sway_lag

When a robot bends, its links turn at once, by `bend` per offset, but its direction of motion turns
slowly; psi is therefore not the heading (6). The model contains neither links nor water. Its
parameters are fitted to simulated or measured trials (`laticauda.control.averaged_fit`); it is
meant for planning in guidance and is not a model of the body.

What the model needs but is not measured is estimated by a filter built on it
(`laticauda.control.current`).
"""

import math
from typing import Any, NamedTuple, TypeAlias

from laticauda.values import quantity, value_class

State: TypeAlias = tuple[Any, Any, Any, Any, Any, Any]
"""State of the model, in the order of `MotionState`: numbers, arrays or CasADi symbols."""


class MotionState(NamedTuple):
    """State of the model."""

    x: Any
    """Position along the world x axis [m]."""
    y: Any
    """Position along the world y axis [m]."""
    psi: Any
    """Direction of motion through the water [rad]."""
    b: Any
    """Offset that the joints have adopted [rad]."""
    u: Any
    """Speed along psi [m/s]."""
    w: Any
    """Speed to the left of psi [m/s]."""


@value_class
class AveragedModel:
    """One gait of one robot, at any frequency and offset within the range of the fit.

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
    turn_1: float = quantity("", "Its increase with the frequency")
    bend: float = quantity(
        "", "Immediate effect of an offset on the mean link angle, before the robot turns"
    )
    bend_lag: float = quantity("s", "Time constant with which the joints adopt the offset", gt=0.0)
    speed_0: float = quantity("m/s", "Speed along the heading, at frequency 0")
    speed_1: float = quantity("m", "Its increase with the frequency")
    speed_offset: float = quantity(
        "m", "Its increase with frequency and offset^2; negative: a bent robot is slower"
    )
    speed_lag: float = quantity("s", "Time constant of the speed", gt=0.0)
    sway: float = quantity("m", "Speed to the left of psi per turning rate")
    sway_lag: float = quantity("s", "Time constant of that speed", gt=0.0)
    power_0: float = quantity("W", "Power at frequency 0")
    power_1: float = quantity(
        "W (s/rad)^k", "Its increase with the frequency to the power of k", ge=0.0
    )
    power_exponent: float = quantity("", "k", gt=0.0)
    power_offset: float = quantity(
        "W (s/rad)^k", "Its increase with that times the square of the offset"
    )

    # The arguments are numbers, arrays or CasADi symbols: the same code serves the fit, the
    # observer and the plan.

    def turning(self, frequency: Any, offset: Any) -> Any:
        """Return the steady turning rate at an offset [rad/s].

        Args:
            frequency: Frequency of the gait [rad/s].
            offset: Offset of the joints [rad].
        """
        return (self.turn_0 + self.turn_1 * frequency) * offset

    def speed(self, frequency: Any, offset: Any) -> Any:
        """Return the steady speed of a gait along the heading, through the water [m/s].

        Args:
            frequency: omega [rad/s].
            offset: phi_0 [rad].
        """
        return self.speed_0 + frequency * (self.speed_1 + self.speed_offset * offset**2)

    def power(self, frequency: Any, offset: Any) -> Any:
        """Return the mean power over a cycle [W].

        Args:
            frequency: omega [rad/s].
            offset: phi_0 [rad].
        """
        return self.power_0 + frequency**self.power_exponent * (
            self.power_1 + self.power_offset * offset**2
        )

    def after(
        self,
        state: State,
        frequency: Any,
        offset: Any,
        dt: float,
        sin: Any = math.sin,
        cos: Any = math.cos,
    ) -> MotionState:
        """Return the state after holding one command for a time `dt`, in still water.

        The lags and psi are exact; the displacement is integrated from them at three points
        (Simpson's rule).

        Args:
            state: x and y [m], psi and b [rad], u and w [m/s].
            frequency: Frequency of the gait [rad/s].
            offset: Offset of all joints [rad].
            dt: Duration of the command [s].
            sin: Sine function for the type of the arguments.
            cos: Cosine function for the type of the arguments.
        """
        x, y, psi, b_0, u_0, w_0 = state
        steady_u = self.speed(frequency, offset)
        steady_w = self.sway * self.turning(frequency, offset)
        turning_per_offset = self.turn_0 + self.turn_1 * frequency
        dx: Any = 0.0
        dy: Any = 0.0
        angle, b, u, w = psi, b_0, u_0, w_0
        # Simpson's rule: times within the step, and their weights.
        for t, weight in ((0.0, dt / 6.0), (0.5 * dt, dt * 2.0 / 3.0), (dt, dt / 6.0)):
            decay = math.exp(-t / self.bend_lag)
            b = offset + (b_0 - offset) * decay
            u = steady_u + (u_0 - steady_u) * math.exp(-t / self.speed_lag)
            integral_of_b = offset * t + (b_0 - offset) * (self.bend_lag * (1.0 - decay))
            angle = psi + turning_per_offset * integral_of_b
            w = steady_w + (w_0 - steady_w) * math.exp(-t / self.sway_lag)
            dx = dx + weight * (u * cos(angle) - w * sin(angle))
            dy = dy + weight * (u * sin(angle) + w * cos(angle))
        return MotionState(x + dx, y + dy, angle, b, u, w)
