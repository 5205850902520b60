"""Fit of the averaged model to trials, by least squares over whole gait cycles.

The fit compares differences over one period, (q(t + T) - q(t)) / T: the mean rate of q over that
cycle, free of the gait's ripple and exact, without numerical differentiation. All but four
parameters of `AveragedModel` enter linearly; those four, three time constants and an exponent, are
each found by a line search with the others solved for.
"""

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from laticauda.control.averaged import AveragedModel
from laticauda.robot import Water
from laticauda.trials import Trial, metrics
from laticauda.values import BadArgument

Array = np.ndarray


class Range(NamedTuple):
    """Range in which a parameter is searched."""

    low: float
    high: float


LAGS = Range(0.05, 20.0)
"""Time constants [s]."""
EXPONENTS = Range(1.0, 4.0)
"""Exponents of the frequency in the power [-]."""
N_GRID = 25
"""Points of the grid that brackets the minimum [-]."""
TOLERANCE = 1e-5
"""Relative uncertainty of a parameter at which a search ends [-]."""
_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
_SPACING = 0.1
"""Time between the starts of two cycles, per period [-]."""
_ROUNDING = 1e-9
"""Smaller than the time between any two samples [s]."""


class _Cycles:
    """Averages of one trial over whole cycles whose starts are a tenth of a period apart."""

    def __init__(self, trial: Trial) -> None:
        assert trial.gait is not None
        self.time = trial.time - trial.time[0]
        self.offset = _offset_of(trial)
        self.frequency = trial.gait.frequency
        self.period = 2.0 * math.pi / self.frequency
        last_begin = self.time[-1] - self.period + _ROUNDING
        self.begin = np.arange(0.0, last_begin, _SPACING * self.period)
        current_x, current_y = _current_of(trial)
        self.velocity_x = self.change(trial.center_of_mass[:, 0]) - current_x
        self.velocity_y = self.change(trial.center_of_mass[:, 1]) - current_y
        self.heading = self.change(metrics.cumulative_integral(self.time, trial.heading))
        self.turning = self.change(trial.heading)
        work = trial.electrical_work
        if work is None:
            work = trial.work[:, 0]
        self.power = self.change(work)

    def change(self, values: Array) -> Array:
        """Return the mean rate of a sampled signal over each cycle, (q(t + T) - q(t)) / T."""
        before = np.interp(self.begin, self.time, values)
        after = np.interp(self.begin + self.period, self.time, values)
        return (after - before) / self.period

    def mean(self, values: Array) -> Array:
        """Return the mean over each cycle of a sampled signal that is held between samples."""
        steps = values[:-1] * np.diff(self.time)
        return self.change(np.append(0.0, np.cumsum(steps)))

    def lag_offset(self, lag: float, power: int = 1) -> Array:
        """Apply a first-order lag to the offset, or a power of it, held between samples.

        The result is 0 at the beginning.
        """
        lagged = np.empty_like(self.offset)
        value = 0.0
        decays = np.exp(-np.diff(self.time, append=self.time[-1]) / lag)
        for k, (target, decay) in enumerate(zip(self.offset**power, decays, strict=True)):
            lagged[k] = value
            value = target + (value - target) * decay
        return lagged

    def velocity_in_body_axes(self, bend: float, lag: float) -> tuple[Array, Array]:
        """Return the mean velocity over each cycle, along psi and to its left [m/s]."""
        psi = self.heading - bend * self.mean(self.lag_offset(lag))
        c = np.cos(psi)
        s = np.sin(psi)
        along = self.velocity_x * c + self.velocity_y * s
        left = self.velocity_y * c - self.velocity_x * s
        return along, left


class _Fit(NamedTuple):
    """Parameters that minimize a sum of squares."""

    parameter: float
    """The parameter that enters nonlinearly."""
    coefficients: list[float]
    """The parameters that enter linearly, in the order of the basis."""


def fit_averaged(trials: Sequence[Trial]) -> AveragedModel:
    """Fit the averaged model to trials of one gait at several frequencies, with turns.

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
    _check_trials(trials)
    cycles = [_Cycles(trial) for trial in trials]

    turning = np.concatenate([part.turning for part in cycles])
    turn = _search(partial(_turn_basis, cycles), turning, LAGS)
    turn_0, turn_1, bend = turn.coefficients
    bend_lag = turn.parameter

    velocities = [part.velocity_in_body_axes(bend, bend_lag) for part in cycles]
    along = np.concatenate([velocity[0] for velocity in velocities])
    left = np.concatenate([velocity[1] for velocity in velocities])
    speed = _search(partial(_speed_basis, cycles), along, LAGS)
    speed_0, speed_1, speed_offset = speed.coefficients
    sway = _search(partial(_sway_basis, cycles, turn_0, turn_1), left, LAGS)
    (sway_per_turning,) = sway.coefficients

    powers = np.concatenate([part.power for part in cycles])
    power = _search(partial(_power_basis, cycles, bend_lag), powers, EXPONENTS)
    # Bending also takes work, which a plan that limits the offset rate can neglect: fitted, then
    # discarded.
    power_0, power_1, power_offset, _ = power.coefficients
    return AveragedModel(
        turn_0=turn_0,
        turn_1=turn_1,
        bend=bend,
        bend_lag=bend_lag,
        speed_0=speed_0,
        speed_1=speed_1,
        speed_offset=speed_offset,
        speed_lag=speed.parameter,
        sway=sway_per_turning,
        sway_lag=sway.parameter,
        power_0=power_0,
        power_1=max(power_1, 0.0),
        power_exponent=power.parameter,
        power_offset=power_offset,
    )


def _check_trials(trials: Sequence[Trial]) -> None:
    """Reject trials that cannot determine the model."""
    shapes: set[tuple[object, ...]] = set()
    frequencies: set[float] = set()
    for i, trial in enumerate(trials):
        if not trial.succeeded:
            raise BadArgument(f"trials[{i}]", f"must not be of a run that failed: {trial.status}")
        trial.need("an averaged model", "heading", "work")
        gait = trial.gait
        if gait is None or gait.frequency <= 0.0:
            raise BadArgument(f"trials[{i}]", f"must have a gait that moves, got {gait}")
        two_cycles = 2.0 * (2.0 * math.pi / gait.frequency)
        if trial.duration < two_cycles:
            rule = f"must last at least two gait cycles, {two_cycles:.4g} s"
            raise BadArgument(f"trials[{i}]", f"{rule}, got {trial.duration:.4g} s")
        shapes.add((gait.amplitude, gait.phase_shift, gait.envelope, gait.phases))
        frequencies.add(round(gait.frequency, 6))
    if len(frequencies) < 3:
        raise BadArgument(
            "trials", f"must have at least 3 different frequencies, got {len(frequencies)}"
        )
    if len(shapes) > 1:
        raise BadArgument(
            "trials", f"must share a gait except for frequency and offset, got {len(shapes)} gaits"
        )
    if not any(_is_steered(trial) for trial in trials):
        raise BadArgument("trials", "must include at least one with a nonzero offset, got none")


def _is_steered(trial: Trial) -> bool:
    offset = _offset_of(trial)
    return bool(np.ptp(offset) > 0.0 or offset[0] != 0.0)


def _offset_of(trial: Trial) -> Array:
    """Return phi_0 at the samples [rad]."""
    assert trial.gait is not None
    steered = trial.signals.get("offset", np.zeros_like(trial.time))
    return steered + trial.gait.offset


def _current_of(trial: Trial) -> tuple[float, float]:
    """Return the velocity of the trial's water along x and y [m/s]."""
    if isinstance(trial.environment, Water):
        return trial.environment.uniform[0], trial.environment.uniform[1]
    return 0.0, 0.0


# ---- bases: a column for each parameter that enters linearly, a row for each cycle ---------------


def _frequencies_of(cycles: Sequence[_Cycles]) -> Array:
    """Return the frequency of every cycle [rad/s]."""
    return np.concatenate([np.full(part.begin.size, part.frequency) for part in cycles])


def _turn_basis(cycles: Sequence[_Cycles], lag: float) -> Array:
    """Return what the turning rate is linear in, if the joints adopt the offset with a lag."""
    f = _frequencies_of(cycles)
    means = list[Array]()
    changes = list[Array]()
    for part in cycles:
        b = part.lag_offset(lag)
        means.append(part.mean(b))
        changes.append(part.change(b))
    mean = np.concatenate(means)
    return np.stack([mean, f * mean, np.concatenate(changes)], axis=1)


def _sway_basis(cycles: Sequence[_Cycles], turn_0: float, turn_1: float, lag: float) -> Array:
    """Return what the speed to the left is linear in: the turning rate with a lag."""
    lagged_turning = [
        part.mean(part.lag_offset(lag)) * (turn_0 + turn_1 * part.frequency) for part in cycles
    ]
    return np.concatenate(lagged_turning)[:, np.newaxis]


def _speed_basis(cycles: Sequence[_Cycles], lag: float) -> Array:
    """Return what the speed is linear in, with a lag from rest."""
    f = _frequencies_of(cycles)
    constant = np.concatenate([part.mean(part.lag_offset(lag, 0)) for part in cycles])
    square = np.concatenate([part.mean(part.lag_offset(lag, 2)) for part in cycles])
    return np.stack([constant, f * constant, f * square], axis=1)


def _power_basis(cycles: Sequence[_Cycles], bend_lag: float, exponent: float) -> Array:
    """Return what the power is linear in; the last column is the work of bending."""
    f = _frequencies_of(cycles)
    square = np.concatenate([part.mean(part.offset**2) for part in cycles])
    bending = np.concatenate(
        [part.mean((part.offset - part.lag_offset(bend_lag)) ** 2) for part in cycles]
    )
    return np.stack([np.ones_like(f), f**exponent, f**exponent * square, bending], axis=1)


# ---- search --------------------------------------------------------------------------------------


def _search(basis: Callable[[float], Array], data: Array, bounds: Range) -> _Fit:
    """Find the nonlinear parameter and the linear ones that minimize the sum of squares.

    The logarithm of the nonlinear one is bracketed on a grid, then narrowed down by golden section.
    """
    misfit = partial(_sum_of_squares, basis, data)
    grid = np.linspace(math.log(bounds.low), math.log(bounds.high), N_GRID).tolist()
    best = int(np.argmin([misfit(logarithm) for logarithm in grid]))
    low = grid[max(best - 1, 0)]
    high = grid[min(best + 1, N_GRID - 1)]
    while high - low > TOLERANCE:
        left = high - _GOLDEN * (high - low)
        right = low + _GOLDEN * (high - low)
        if misfit(left) < misfit(right):
            high = right
        else:
            low = left
    parameter = math.exp(0.5 * (low + high))
    return _Fit(parameter, _solve(basis(parameter), data).tolist())


def _sum_of_squares(basis: Callable[[float], Array], data: Array, logarithm: float) -> float:
    """Return the sum of squares for a nonlinear parameter, with the linear ones solved for."""
    matrix = basis(math.exp(logarithm))
    return float(np.sum((data - matrix @ _solve(matrix, data)) ** 2))


def _solve(matrix: Array, data: Array) -> Any:
    coefficients, *_ = np.linalg.lstsq(matrix, data, rcond=None)
    return coefficients
