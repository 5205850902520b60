"""Averaged model: the motion of a swimming snake from gait cycle to gait cycle, in six states.

    x' = u cos(psi) - w sin(psi)        psi' = r = turning(frequency, b)        heading = psi + bend b
    y' = u sin(psi) + w cos(psi)        b' = (offset - b) / bend_lag
    u' = (speed(frequency, offset) - u) / speed_lag                w' = (sway turning(frequency, offset) - w) / sway_lag

When a robot bends, its links turn at once, by `bend` per offset, but its direction of motion turns
slowly; psi is therefore not the heading (6). The model contains neither links nor water. Its
parameters are fitted to simulated or measured trials (`fit_averaged`); it is meant for planning in
guidance and is not a model of the body.

What the model needs but is not measured is estimated by a filter built on it
(`laticauda.control.current`).

The model is fitted by least squares over whole gait cycles. The fit compares differences over one
period, (q(t + T) - q(t)) / T: the mean rate of q over that cycle, free of the gait's ripple and
exact, without numerical differentiation. All but four parameters enter linearly; those four, three
time constants and an exponent, are each found by a line search with the others solved for.
`OffsetSteps` is a maneuver that identifies them: one gait, with offsets held one after the other.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np

from laticauda.motion.gaits import Gait
from laticauda.robot import Robot, Water
from laticauda.scenarios import Command, Controller, Observation
from laticauda.trials import Trial, metrics
from laticauda.values import BadArgument, option, quantity, value_class

State: TypeAlias = tuple[Any, Any, Any, Any, Any, Any]


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
        """Return the steady turning rate at an offset [rad/s]; `frequency` in rad/s, `offset` in rad, here and below.

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
    ) -> State:
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


# ---- fit to trials -------------------------------------------------------------------------------

Array = np.ndarray
LAGS = (0.05, 20.0)  # search range of the time constants [s]
EXPONENTS = (1.0, 4.0)
_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


class _Cycles:
    """Averages of one trial over whole cycles whose starts are a tenth of a period apart."""

    def __init__(self, trial: Trial) -> None:
        assert trial.gait is not None
        self.time, self.offset, self.frequency = (
            trial.time - trial.time[0],
            _offset(trial),
            trial.gait.frequency,
        )
        self.period = 2.0 * math.pi / self.frequency
        self.begin = np.arange(0.0, self.time[-1] - self.period + 1e-9, 0.1 * self.period)
        current = trial.environment.uniform if isinstance(trial.environment, Water) else (0.0, 0.0)
        self.velocity = [self.change(trial.center_of_mass[:, i]) - current[i] for i in range(2)]
        turned = metrics.cumulative_integral(self.time, trial.heading)
        self.heading, self.turning = self.change(turned), self.change(trial.heading)
        self.power = self.change(
            trial.work[:, 0] if trial.electrical_work is None else trial.electrical_work
        )

    def change(self, values: Array) -> Array:
        """Return the mean rate of a sampled signal over each cycle, (q(t + T) - q(t)) / T."""
        before, after = (
            np.interp(at, self.time, values) for at in (self.begin, self.begin + self.period)
        )
        return (after - before) / self.period

    def mean(self, values: Array) -> Array:
        """Return the mean over each cycle of a sampled signal that is held from sample to sample."""
        return self.change(np.append(0.0, np.cumsum(values[:-1] * np.diff(self.time))))

    def late(self, lag: float, power: int = 1) -> Array:
        """Apply a first-order lag to the offset, or a power of it, held from sample to sample; initially 0."""
        late, now = np.empty_like(self.offset), 0.0
        keeps = np.exp(-np.diff(self.time, append=self.time[-1]) / lag)
        for k, (held, keep) in enumerate(zip(self.offset**power, keeps, strict=True)):
            late[k] = now
            now = held + (now - held) * keep
        return late

    def motion(self, bend: float, lag: float) -> tuple[Array, Array]:
        """Return the mean velocity over each cycle, along psi and to its left [m/s]."""
        psi = self.heading - bend * self.mean(self.late(lag))
        (vx, vy), c, s = self.velocity, np.cos(psi), np.sin(psi)
        return vx * c + vy * s, vy * c - vx * s


def fit_averaged(trials: Sequence[Trial]) -> AveragedModel:
    """Fit the averaged model to trials of one gait at several frequencies, with offsets that turn the robot.

    The offset of a trial is that of its gait plus its signal ``offset``, which every steered run
    has. `OffsetSteps` produces suitable trials. A current is taken from the trial's water.

    Args:
        trials: Trials at three or more frequencies, each constant throughout its trial.

    Returns:
        The model with the least sum of squares, minimized separately for turning rate, speeds and
        power.

    Raises:
        ValueError: If the trials are insufficient: too few frequencies, no turn, too few cycles,
            unlike gait shapes.
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

    bend_lag, (turn_0, turn_1, bend) = _searched(
        turn_basis, every([part.turning for part in cycles]), LAGS
    )
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
        # Bending also takes work, which a plan that limits the offset rate can neglect: fitted,
        # then discarded.
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
        raise BadArgument(
            "trials", f"must have at least 3 different frequencies, got {len(frequencies)}"
        )
    if len(shapes) > 1:
        raise BadArgument(
            "trials", f"must share a gait except for frequency and offset, got {len(shapes)} gaits"
        )
    if not any(np.ptp(_offset(trial)) > 0.0 or _offset(trial)[0] != 0.0 for trial in trials):
        raise BadArgument("trials", "must include at least one with a nonzero offset, got none")


def _offset(trial: Trial) -> Array:
    """Return phi_0 at the samples [rad]."""
    assert trial.gait is not None
    return trial.signals.get("offset", np.zeros_like(trial.time)) + trial.gait.offset


def _searched(
    basis: Callable[[float], Array], data: Array, ends: tuple[float, float]
) -> tuple[float, list[float]]:
    """Find the nonlinear parameter and the linear ones that minimize the sum of squares."""

    def misfit(at: float) -> float:
        matrix = basis(math.exp(at))
        return float(np.sum((data - matrix @ np.linalg.lstsq(matrix, data, rcond=None)[0]) ** 2))

    grid = np.linspace(math.log(ends[0]), math.log(ends[1]), 25)
    best = int(np.argmin([misfit(float(at)) for at in grid]))
    low, high = float(grid[max(best - 1, 0)]), float(grid[min(best + 1, grid.size - 1)])
    while high - low > 1e-5:  # golden-section search
        left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        low, high = (low, right) if misfit(left) < misfit(right) else (left, high)
    found = math.exp(0.5 * (low + high))
    return found, [float(value) for value in np.linalg.lstsq(basis(found), data, rcond=None)[0]]


# To both sides, small and large; the last one is zero, so that the end of the turn is visible.
OFFSETS = tuple(math.radians(degrees) for degrees in (0.0, 5.0, -10.0, 15.0, -5.0, 0.0))


@value_class
class OffsetSteps(Controller[int]):
    """Open-loop controller that steers by a list of offsets; the trial logs the offset among its signals.

    Raises:
        ValueError: If a field is out of its range.
    """

    gait: Gait = option("Gait that is steered")
    offsets: tuple[float, ...] = quantity(
        "rad", "Offsets in order; the last one is kept", default=OFFSETS
    )
    interval: float = quantity("s", "Time for which each is held", default=12.0, gt=0.0)

    def __post_init__(self) -> None:
        """Check every field once."""
        if not self.offsets:
            raise BadArgument("offsets", "must hold at least one offset in rad, got none")

    @property
    def duration(self) -> float:
        """Duration of the whole list [s]."""
        return self.interval * len(self.offsets)

    def init(self) -> int:
        """Return the number of offsets commanded so far: none."""
        return 0

    def step(self, state: int, observation: Observation) -> tuple[int, Command]:
        """Command the next offset, regardless of the `observation`; `state` counts the offsets.

        Args:
            state: Number of offsets commanded so far.
            observation: Ignored.
        """
        offset = self.offsets[min(state, len(self.offsets) - 1)]
        return state + 1, Command(gait=self.gait, offset=offset)

    def signals(self, state: int) -> Mapping[str, float]:
        """Return the offset held in `state`, for the log.

        Args:
            state: Number of offsets commanded so far.
        """
        return {"offset": self.offsets[min(state, len(self.offsets)) - 1]}

    def check(self, robot: Robot) -> None:
        """Accept every `robot`: a joint beyond its limit ends the run.

        Args:
            robot: Any robot.
        """
