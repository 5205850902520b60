"""The averaged model: how a swimming snake moves from gait cycle to gait cycle, in six states.

    x' = u cos(psi) - w sin(psi)        psi' = r = turning(frequency, b)        heading = psi + bend b
    y' = u sin(psi) + w cos(psi)        b' = (offset - b) / bend_lag
    u' = (speed(frequency, offset) - u) / speed_lag                w' = (sway turning(frequency, offset) - w) / sway_lag

A robot that bends turns its links at once, by `bend` per offset, and its direction of motion slowly: so psi is not the
heading (6). The model knows neither links nor water. Its numbers come out of trials (`fit_averaged`), simulated or
measured; it is for guidance to plan with, and no model of the body.

What it needs to know and nobody measures, a filter around it tells (`laticauda.control.current`).

Out of trials it comes by least squares over whole gait cycles. What is compared are differences over one period,
(q(t + T) - q(t)) / T: the mean rate of q over that cycle, free of the gait's ripple and exact, with nothing
differentiated. All but four numbers enter linearly; those four, three time constants and an exponent, are each searched
along a line with the others solved for. `OffsetSteps` is a maneuver that tells them: one gait, and offsets that are
held one after the other.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np

from laticauda.errors import BadArgument
from laticauda.gaits import Gait
from laticauda.interfaces import Command, Controller, Observation
from laticauda.quantities import option, quantity, value
from laticauda.robot import Robot, Water
from laticauda.trial import Trial, metrics

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
        """Turning rate that an offset comes to [rad/s]; `frequency` in rad/s, `offset` in rad, here and below.

        Args:
            frequency: Of the gait [rad/s].
            offset: Of the joints [rad].
        """
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


# ---- out of trials ---------------------------------------------------------------------------------------------------

Array = np.ndarray
LAGS = (0.05, 20.0)  # where a time constant is searched [s]
EXPONENTS = (1.0, 4.0)
_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


class _Cycles:
    """One trial, at the begin of every whole cycle in it, a tenth of a period apart."""

    def __init__(self, trial: Trial) -> None:
        assert trial.gait is not None
        self.time, self.offset, self.frequency = trial.time - trial.time[0], _offset(trial), trial.gait.frequency
        self.period = 2.0 * math.pi / self.frequency
        self.begin = np.arange(0.0, self.time[-1] - self.period + 1e-9, 0.1 * self.period)
        current = trial.environment.uniform if isinstance(trial.environment, Water) else (0.0, 0.0)
        self.velocity = [self.change(trial.center_of_mass[:, i]) - current[i] for i in range(2)]
        turned = metrics.integral(self.time, trial.heading)
        self.heading, self.turning = self.change(turned), self.change(trial.heading)
        self.power = self.change(trial.work[:, 0] if trial.electrical_work is None else trial.electrical_work)

    def change(self, values: Array) -> Array:
        """Mean rate over each cycle of a signal at the samples, (q(t + T) - q(t)) / T."""
        before, after = (np.interp(at, self.time, values) for at in (self.begin, self.begin + self.period))
        return (after - before) / self.period

    def mean(self, values: Array) -> Array:
        """Mean over each cycle of a signal that is given at the samples, held until the next."""
        return self.change(np.append(0.0, np.cumsum(values[:-1] * np.diff(self.time))))

    def late(self, lag: float, power: int = 1) -> Array:
        """What a first-order lag makes of the offset, or of a power of it, held from sample to sample; 0 at first."""
        late, now = np.empty_like(self.offset), 0.0
        keeps = np.exp(-np.diff(self.time, append=self.time[-1]) / lag)
        for k, (held, keep) in enumerate(zip(self.offset**power, keeps, strict=True)):
            late[k] = now
            now = held + (now - held) * keep
        return late

    def motion(self, bend: float, lag: float) -> tuple[Array, Array]:
        """Mean velocity over each cycle, along psi and to its left [m/s]."""
        psi = self.heading - bend * self.mean(self.late(lag))
        (vx, vy), c, s = self.velocity, np.cos(psi), np.sin(psi)
        return vx * c + vy * s, vy * c - vx * s


def fit_averaged(trials: Sequence[Trial]) -> AveragedModel:
    """Fit the averaged model to trials of one gait at several frequencies, with offsets that turn the robot.

    A trial tells its offset by the signal ``offset``, as every steered run has it, or by its gait. `OffsetSteps` makes
    trials that will do. A current is taken from the trial's water.

    Args:
        trials: At least three frequencies, each held all along.

    Returns:
        The model with the least sum of squares, of turning rate, speeds and power each on their own.

    Raises:
        ValueError: If the trials do not tell: too few frequencies, no turn, no whole cycle, another shape of gait.
    """
    _check(trials)
    cycles = [*map(_Cycles, trials)]
    every = np.concatenate
    f = every([np.full(part.begin.size, part.frequency) for part in cycles])

    def turn_basis(lag: float) -> Array:
        bent = [part.late(lag) for part in cycles]
        mean = every([part.mean(values) for part, values in zip(cycles, bent, strict=True)])
        jump = every([part.change(values) for part, values in zip(cycles, bent, strict=True)])
        return np.stack([mean, f * mean, jump], axis=1)

    bend_lag, (turn_0, turn_1, bend) = _searched(turn_basis, every([part.turning for part in cycles]), LAGS)
    motion = [part.motion(bend, bend_lag) for part in cycles]
    surge, aside = (every([pair[i] for pair in motion]) for i in range(2))

    def sway_basis(lag: float) -> Array:
        late = [part.mean(part.late(lag)) * (turn_0 + turn_1 * part.frequency) for part in cycles]
        return every(late)[:, np.newaxis]

    def speed_basis(lag: float) -> Array:
        late = [[part.mean(part.late(lag, n)) for part in cycles] for n in (0, 2)]
        one, square = every(late[0]), every(late[1])
        return np.stack([one, f * one, f * square], axis=1)

    def power_basis(exponent: float) -> Array:
        square = every([part.mean(part.offset**2) for part in cycles])
        # Bending takes work too, which a plan that limits the offset's rate can leave out: solved for, and let go.
        bending = every([part.mean((part.offset - part.late(bend_lag)) ** 2) for part in cycles])
        return np.stack([np.ones_like(f), f**exponent, f**exponent * square, bending], axis=1)

    speed_lag, speed = _searched(speed_basis, surge, LAGS)
    sway_lag, (sway,) = _searched(sway_basis, aside, LAGS)
    exponent, power = _searched(power_basis, every([part.power for part in cycles]), EXPONENTS)
    return AveragedModel(
        turn_0=turn_0,
        turn_1=turn_1,
        bend=bend,
        bend_lag=bend_lag,
        speed_0=speed[0],
        speed_1=speed[1],
        speed_offset=speed[2],
        speed_lag=speed_lag,
        sway=sway,
        sway_lag=sway_lag,
        power_0=power[0],
        power_1=max(power[1], 0.0),
        power_exponent=exponent,
        power_offset=power[2],
    )


def _check(trials: Sequence[Trial]) -> None:
    shapes: set[tuple[object, ...]] = set()
    frequencies: set[float] = set()
    for i, trial in enumerate(trials):
        trial.need("an averaged model", "heading", "work")
        gait = trial.gait
        if gait is None or gait.frequency <= 0.0:
            raise BadArgument(f"trials[{i}]", f"must have a gait that moves, got {gait}")
        least = 2.0 * (2.0 * math.pi / gait.frequency)
        if trial.duration < least:
            rule = f"must last at least two gait cycles, {least:.4g} s, got {trial.duration:.4g} s"
            raise BadArgument(f"trials[{i}]", rule)
        shapes.add((gait.amplitude, gait.phase_shift, gait.envelope))
        frequencies.add(round(gait.frequency, 6))
    if len(frequencies) < 3:
        raise BadArgument("trials", f"must have at least 3 different frequencies, got {len(frequencies)}")
    if len(shapes) > 1:
        raise BadArgument("trials", f"must be of one gait but for its frequency and offset, got {len(shapes)} gaits")
    if not any(np.ptp(_offset(trial)) > 0.0 or _offset(trial)[0] != 0.0 for trial in trials):
        raise BadArgument("trials", "must have an offset that turns the robot in at least one of them, got none")


def _offset(trial: Trial) -> Array:
    """phi_0 at the samples [rad]."""
    assert trial.gait is not None
    return trial.signals.get("offset", np.zeros_like(trial.time)) + trial.gait.offset


def _searched(basis: Callable[[float], Array], data: Array, ends: tuple[float, float]) -> tuple[float, list[float]]:
    """The nonlinear number and the linear ones with the least sum of squares."""

    def misfit(at: float) -> float:
        matrix = basis(math.exp(at))
        return float(np.sum((data - matrix @ np.linalg.lstsq(matrix, data, rcond=None)[0]) ** 2))

    grid = np.linspace(math.log(ends[0]), math.log(ends[1]), 25)
    best = int(np.argmin([misfit(float(at)) for at in grid]))
    low, high = float(grid[max(best - 1, 0)]), float(grid[min(best + 1, grid.size - 1)])
    while high - low > 1e-5:  # the golden section
        left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        low, high = (low, right) if misfit(left) < misfit(right) else (left, high)
    found = math.exp(0.5 * (low + high))
    return found, [float(value) for value in np.linalg.lstsq(basis(found), data, rcond=None)[0]]


# To both sides, small and large; ends without, so that the turn can be seen to end.
OFFSETS = tuple(math.radians(degrees) for degrees in (0.0, 5.0, -10.0, 15.0, -5.0, 0.0))


@value
class OffsetSteps(Controller[int]):
    """A controller that looks at nothing and steers by a list; the trial keeps the offset among its signals.

    Raises:
        ValueError: If a field is out of its range.
    """

    gait: Gait = option("What swims")
    offsets: tuple[float, ...] = quantity("rad", "One after the other, the last one from then on", default=OFFSETS)
    interval: float = quantity("s", "How long each is held", default=12.0, gt=0.0)

    def __post_init__(self) -> None:
        """Check every field once."""
        if not self.offsets:
            raise BadArgument("offsets", "must hold at least one offset in rad, got none")

    @property
    def duration(self) -> float:
        """Of the whole list [s]."""
        return self.interval * len(self.offsets)

    def init(self) -> int:
        """How many offsets were asked for: none."""
        return 0

    def step(self, state: int, observation: Observation) -> tuple[int, Command]:
        """The next offset, whatever the `observation` is; `state` counts them.

        Args:
            state: How many offsets were commanded.
            observation: Not looked at.
        """
        offset = self.offsets[min(state, len(self.offsets) - 1)]
        return state + 1, Command(gait=self.gait, offset=offset)

    def signals(self, state: int) -> Mapping[str, float]:
        """The offset that is held in `state`, for the log.

        Args:
            state: How many offsets were commanded.
        """
        return {"offset": self.offsets[min(state, len(self.offsets)) - 1]}

    def check(self, robot: Robot) -> None:
        """Every `robot` will do: a joint beyond its limit ends the run.

        Args:
            robot: Any.
        """
