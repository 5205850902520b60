"""How the figures of trials follow the numbers that went into them: derivatives, not differences."""

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Unpack

import numpy as np
from jaxtyping import Bool, Float

from laticauda.errors import BadArgument, one_of
from laticauda.gaits import Gait
from laticauda.interfaces import Start
from laticauda.robot import Environment, Robot
from laticauda.scenarios import ModelChanges, Scenario
from laticauda.simulate.numbers import Parameter, changed, look_up, parameters, value_of
from laticauda.simulate.runner import Progress

UNITS = {
    "forward_velocity": "m/s",
    "steady_velocity": "m/s",
    "mechanical_power": "W",
    "net_power": "W",
    "positive_power": "W",
    "mean_power": "W",
    "cost_of_transport": "",
    "x": "m",
    "y": "m",
    "heading": "rad",
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Sensitivities:
    """Figures of trials and their derivatives to parameters, nan where a trial has no such figure (see `Swims`)."""

    figures: tuple[str, ...]
    """Names of the figures, as in `Swims`; x, y: the center of mass at the end."""
    parameters: tuple[Parameter, ...]
    """What they are differentiated to: name, unit and title."""
    point: Float[np.ndarray, "n_trials n_parameters"]
    """Values of the parameters, in their units."""
    values: Float[np.ndarray, "n_trials n_figures"]
    """The figures, in the units of `UNITS`."""
    jacobian: Float[np.ndarray, "n_trials n_figures n_parameters"]
    """Derivative of each figure to each parameter, in the figure's unit per the parameter's."""
    succeeded: Bool[np.ndarray, " n_trials"]
    """Whether the trial reached its end."""
    status: tuple[str, ...]
    """How it ended."""

    def of(self, figure: str, parameter: str) -> Float[np.ndarray, " n_trials"]:
        """The derivative of one figure to one parameter, for every trial.

        Args:
            figure: Its name.
            parameter: Its name, with dots.

        Raises:
            ValueError: If there is no such figure or parameter here.
        """
        names = tuple(known.name for known in self.parameters)
        column = names.index(one_of("parameter", parameter, names))
        return self.jacobian[:, self.figures.index(one_of("figure", figure, self.figures)), column]

    @property
    def elasticity(self) -> Float[np.ndarray, "n_trials n_figures n_parameters"]:
        """By how many percent a figure grows when a parameter grows by one: (df/dq) q/f, nan where f is 0 [-]."""
        with np.errstate(all="ignore"):
            share = self.jacobian * self.point[:, np.newaxis, :] / self.values[:, :, np.newaxis]
        return np.where(np.isfinite(share), share, np.nan)


def sensitivities(
    robots: Sequence[Scenario] | Robot | Sequence[Robot],
    gaits: Gait | Sequence[Gait] | None = None,
    duration: float = 30.0,
    *,
    names: Sequence[str],
    environments: Environment | Sequence[Environment] | None = None,
    starts: Start | Sequence[Start] | None = None,
    sample_interval: float = 0.05,
    threads: int | None = None,
    progress: Progress | None = None,
    **changes: Unpack[ModelChanges],
) -> Sensitivities:
    """Derivatives of the figures of one or many trials to any numbers of robot, gait and environment.

    The derivatives are those of what the kernels compute, at the time step of the trial, exact to rounding: the kernels
    carry each number with its derivative (a complex step). Trials and parameters are computed side by side; each pair
    costs three to four trials of a batch. Where a figure has a kink (|u phi'| at u phi' = 0 in a power, saturation of a
    servo), it is differentiated on either side of it; over a trial that does not show.

    Args:
        robots: See `swim_many`; time steps do not change with a parameter.
        gaits: See `swim_many`.
        duration: See `swim_many` [s].
        names: Of the parameters, with dots: `gait.amplitude`, `water.normal_drag`, `robot.caudal_fin.length`,
            `robot.module.mass` (of all modules alike); see `laticauda.simulate.numbers`.
        environments: See `swim_many`.
        starts: See `swim_many`.
        sample_interval: See `swim_many` [s].
        threads: See `swim_many`.
        progress: See `swim_many`.
        changes: See `swim_many`; a fluid law that branches is differentiated on the branch that it takes.

    Returns:
        Figures and derivatives, as arrays.

    Raises:
        ValueError: If an argument is out of its range, or a parameter does not exist, counts something, or cannot
            change.

    Example:
        >>> import laticauda as lc
        >>> gait = lc.lateral_undulation(amplitude=0.52, frequency=2.27, phase_shift=0.70)
        >>> found = sensitivities(lc.load_robot("mamba"), gait, names=["gait.frequency", "water.normal_drag"])
        >>> found.of("forward_velocity", "gait.frequency").round(4)
        array([0.0486])
    """
    from laticauda.simulate.derivatives import Number, slopes
    from laticauda.simulate.many import batch_of, runs_of

    if isinstance(names, str) or not names:
        raise BadArgument("names", f"must hold at least one name of a parameter, got {names!r}")
    scenarios = batch_of(robots, gaits, environments, starts, duration, sample_interval, **changes)
    runs = runs_of(scenarios)
    duration, sample_interval = scenarios[0].duration, scenarios[0].sample_interval
    chosen = [_chosen(names, one) for one in scenarios]
    point = [[value_of(parameter.name, one) for parameter in chosen[0]] for one in scenarios]
    numbers = [
        Number(name=parameter.name, scenario=one, value=value, change=functools.partial(_moved, one, parameter.name))
        for one, known, values in zip(scenarios, chosen, point, strict=True)
        for parameter, value in zip(known, values, strict=True)
    ]
    pairs = [run for run in runs for _ in names]
    found = slopes(pairs, numbers, duration, sample_interval=sample_interval, threads=threads, progress=progress)
    shape = len(runs), len(names)
    value = np.stack([found.value[figure].reshape(shape)[:, 0] for figure in UNITS], axis=1)
    jacobian = np.stack([found.slope[figure].reshape(shape) for figure in UNITS], axis=1)
    return Sensitivities(
        figures=tuple(UNITS),
        parameters=chosen[0],
        point=np.array(point),
        values=value,
        jacobian=jacobian,
        succeeded=found.succeeded[:: len(names)],
        status=found.status[:: len(names)],
    )


def _chosen(names: Sequence[str], scenario: Scenario) -> tuple[Parameter, ...]:
    """The parameters of these names.

    Raises:
        ValueError: If there is none of that name, or it counts something.
    """
    known = parameters(scenario)
    try:
        found = tuple(look_up(name, known) for name in names)
    except ValueError as err:
        raise ValueError(str(err).replace("`points`", "`names`", 1)) from None
    for parameter in found:
        if parameter.is_whole:
            raise BadArgument("names", f"must be of numbers that may change a little, got `{parameter.name}`, a count")
    return found


def _moved(scenario: Scenario, name: str, value: float) -> Scenario:
    """The scenario with another value of one parameter."""
    return changed(scenario, {name: value})
