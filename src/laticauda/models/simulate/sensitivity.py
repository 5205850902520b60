"""`compute_sensitivities`: the figures of trials with their derivatives with respect to parameters."""

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Unpack

import numpy as np
from jaxtyping import Bool, Float

from laticauda import robot
from laticauda.models.dynamics.school import GAIT_PARAMETERS
from laticauda.models.planar import batch
from laticauda.models.simulate import batch_scenarios, gradients
from laticauda.models.simulate.derivatives import Number, compute_slopes
from laticauda.models.simulate.numbers import (
    Parameter,
    change_parameters,
    list_parameters,
    look_up,
    value_of,
)
from laticauda.models.simulate.run_figures import UNITS
from laticauda.models.simulate.runner import Progress, silent
from laticauda.motion.gaits import Gait
from laticauda.scenarios import ModelChanges, Scenario, interfaces
from laticauda.trials import REACHED_END
from laticauda.values import BadArgument, check_choice


@dataclass(frozen=True, kw_only=True, eq=False)
class Sensitivities:
    """Figures of trials and their derivatives with respect to parameters.

    They are nan where a trial lacks a figure (see `Swims`).
    """

    figures: tuple[str, ...]
    """Names of the figures, as in `Swims`; x, y: final position of the center of mass."""
    parameters: tuple[Parameter, ...]
    """Parameters of the differentiation: name, unit and title."""
    point: Float[np.ndarray, "n_trials n_parameters"]
    """Values of the parameters, in their units."""
    values: Float[np.ndarray, "n_trials n_figures"]
    """Values of the figures, in the units of `UNITS`."""
    jacobian: Float[np.ndarray, "n_trials n_figures n_parameters"]
    """Derivative of each figure with respect to each parameter, in the figure's unit per the parameter's."""
    succeeded: Bool[np.ndarray, " n_trials"]
    """Whether the trial reached its end."""
    status: tuple[str, ...]
    """How each trial ended."""

    def of(self, figure: str, parameter: str) -> Float[np.ndarray, " n_trials"]:
        """Return the derivative of one figure with respect to one parameter, for every trial.

        Args:
            figure: Name of the figure.
            parameter: Dotted name of the parameter.

        Raises:
            ValueError: If this object has no such figure or parameter.
        """
        names = tuple(parameter.name for parameter in self.parameters)
        row = self.figures.index(check_choice("figure", figure, self.figures))
        column = names.index(check_choice("parameter", parameter, names))
        return self.jacobian[:, row, column]

    @property
    def elasticity(self) -> Float[np.ndarray, "n_trials n_figures n_parameters"]:
        """Percent by which a figure grows when a parameter grows by one percent: (df/dq) q/f [-].

        It is nan where f is 0.
        """
        with np.errstate(all="ignore"):
            share = self.jacobian * self.point[:, np.newaxis, :] / self.values[:, :, np.newaxis]
        return np.where(np.isfinite(share), share, np.nan)


def compute_sensitivities(
    robots: Sequence[Scenario] | robot.Robot | Sequence[robot.Robot],
    gaits: Gait | Sequence[Gait] | None = None,
    duration: float = 30.0,
    *,
    names: Sequence[str],
    figures: Sequence[str] | None = None,
    environments: robot.Environment | Sequence[robot.Environment] | None = None,
    starts: interfaces.Start | Sequence[interfaces.Start] | None = None,
    sample_interval: float = 0.05,
    threads: int | None = None,
    progress: Progress = silent,
    **changes: Unpack[ModelChanges],
) -> Sensitivities:
    """Compute derivatives of the figures of trials with respect to numbers of robot, gait and environment.

    The derivatives are those of the kernels' results, at the time step of the trial, exact to
    rounding: the kernels carry each number with its derivative (a complex step). Trials and
    parameters are computed side by side; each pair costs little more than two trials of a batch. For more
    than ten parameters, if they are more than twice as many as the `figures` and joints are
    prescribed, the trials are differentiated backward in time: each figure then costs as much as five
    trials, however many parameters there are. The results are the same to rounding.
    Where a figure has a kink (|u phi'| at u phi' = 0 in a power, saturation of a servo), it is
    differentiated on either side; over a whole trial, this is not visible.

    Args:
        robots: The scenarios, all planar, with one duration and sample interval and without
            controllers; or the robots, together with their gaits. Time steps do not change with a
            parameter.
        gaits: The commanded gaits, one for all or one for each; omitted with scenarios.
        duration: Duration of every trial [s].
        names: Dotted names of the parameters: `gait.amplitude`, `water.normal_drag`,
            `robot.caudal_fin.length`, `robot.module.mass` (of all modules alike); see
            `laticauda.models.simulate.numbers`.
        figures: Names of the figures to differentiate; None: all that there are.
        environments: Waters or grounds, one for all or one for each; None uses `default_water` of
            each robot and gait.
        starts: Start of each trial; None: at the origin, along x.
        sample_interval: Sample interval of the logs used for the figures; the logs are not kept
            [s].
        threads: Number of threads; None uses all cores that this process may use.
        progress: Called repeatedly with the completed share, from 0 to 1.
        changes: Settings of the model: `joints` (prescribed, pd, servo, or a joint law), `dt` [s]
            and the other fields of `laticauda.scenarios.ModelChanges`. A fluid law that branches is
            differentiated on the branch taken.

    Returns:
        Figures and derivatives, as arrays.

    Raises:
        ValueError: If an argument is out of its range, or a parameter does not exist, is a count,
            or cannot change.

    Example:
        >>> import laticauda as lc
        >>> gait = lc.lateral_undulation(amplitude=0.52, frequency=2.27, phase_shift=0.70)
        >>> found = compute_sensitivities(lc.load_robot("mamba"), gait, names=["gait.frequency", "water.normal_drag"])
        >>> found.of("forward_velocity", "gait.frequency").round(4)
        array([0.0486])
    """
    if isinstance(names, str) or not names:
        raise BadArgument("names", f"must hold at least one name of a parameter, got {names!r}")
    figures = _check_figures(figures)
    scenarios = batch_scenarios.scenarios_of_batch(
        robots,
        gaits,
        environments=environments,
        starts=starts,
        duration=duration,
        sample_interval=sample_interval,
        **changes,
    )
    runs = batch_scenarios.runs_of(scenarios)
    directory = _NumbersByName(names)
    numbers_of_each = [directory.find_numbers(scenario) for scenario in scenarios]
    point = [[number.value for number in numbers] for numbers in numbers_of_each]
    plants = [run.plant for run in runs]
    if gradients.is_cheaper(plants, n_figures=len(figures), n_numbers=len(names)):
        compute = _differentiate_backward
    else:
        compute = _differentiate_forward
    derivatives = compute(
        runs, numbers_of_each, figures, scenarios[0], threads=threads, progress=progress
    )
    return Sensitivities(
        figures=tuple(figures),
        parameters=directory.find_parameters(scenarios[0]),
        point=np.array(point),
        values=derivatives.values,
        jacobian=derivatives.jacobian,
        succeeded=np.array([status == REACHED_END for status in derivatives.status]),
        status=derivatives.status,
    )


class _Derivatives(NamedTuple):
    """Figures of trials and their derivatives."""

    values: Float[np.ndarray, "n_trials n_figures"]
    """The figures."""
    jacobian: Float[np.ndarray, "n_trials n_figures n_parameters"]
    """Their derivatives."""
    status: tuple[str, ...]
    """How each trial ended."""


def _differentiate_forward(
    runs: Sequence[batch.Run],
    numbers: Sequence[Sequence[Number]],
    figures: Sequence[str],
    scenario: Scenario,
    *,
    threads: int | None,
    progress: Progress,
) -> _Derivatives:
    """Differentiate trials with one complex run for every number."""
    runs_of_numbers: list[batch.Run] = []
    all_numbers: list[Number] = []
    for run, numbers_of_run in zip(runs, numbers, strict=True):
        runs_of_numbers += [run] * len(numbers_of_run)
        all_numbers += numbers_of_run
    result = compute_slopes(
        runs_of_numbers,
        all_numbers,
        scenario.duration,
        sample_interval=scenario.sample_interval,
        threads=threads,
        progress=progress,
    )
    n_numbers = len(numbers[0])
    shape = len(runs), n_numbers
    complex_figures = np.stack([result.figures[name].reshape(shape) for name in figures], axis=1)
    return _Derivatives(
        values=np.real(complex_figures[:, :, 0]),
        jacobian=np.imag(complex_figures) / batch.STEP,
        status=result.status[::n_numbers],
    )


def _differentiate_backward(
    runs: Sequence[batch.Run],
    numbers: Sequence[Sequence[Number]],
    figures: Sequence[str],
    scenario: Scenario,
    *,
    threads: int | None,
    progress: Progress,
) -> _Derivatives:
    """Differentiate trials backward in time, with one sweep for every figure."""
    results = gradients.compute_jacobians(
        runs,
        numbers,
        [figures] * len(runs),
        scenario.duration,
        sample_interval=scenario.sample_interval,
        threads=threads,
        progress=progress,
    )
    return _Derivatives(
        values=np.array([result.values for result in results]),
        jacobian=np.array([result.jacobian for result in results]),
        status=tuple(result.status for result in results),
    )


def _check_figures(figures: Sequence[str] | None) -> Sequence[str]:
    """Return the figures to differentiate."""
    if figures is None:
        return tuple(UNITS)
    if isinstance(figures, str) or not figures:
        raise BadArgument("figures", f"must hold at least one name of a figure, got {figures!r}")
    return [check_choice("figures", figure, tuple(UNITS)) for figure in figures]


class _NumbersByName:
    """The numbers of scenarios that some names stand for.

    Those of robot, water and joints are looked up once for all scenarios that hold the same objects,
    as `runs_of` makes one plant for them.
    """

    def __init__(self, names: Sequence[str]) -> None:
        self._names = names
        self._names_of_motion = [name for name in names if name.startswith(ROOTS_OF_MOTION)]
        self._shared: dict[tuple[int, ...], dict[str, Number]] = {}
        """Numbers that do not belong to the motion, by the identity of the objects that hold them."""
        self._waves: dict[str, Parameter] = {}
        """Parameters of the gait's wave, which every gait has, by name."""

    def find_numbers(self, scenario: Scenario) -> list[Number]:
        """Return the numbers of a scenario.

        Raises:
            ValueError: If there is no parameter of a name, or it is a count.
        """
        parameters = list_parameters(scenario)
        holders = id(scenario.robot), id(scenario.environment), id(scenario.model)
        if holders not in self._shared:
            names = [name for name in self._names if name not in self._names_of_motion]
            self._shared[holders] = {
                name: _find_number(scenario, name, parameters) for name in names
            }
        numbers = self._shared[holders]
        if self._names_of_motion:
            numbers_of_motion = {
                name: self._find_in_motion(scenario, name, parameters)
                for name in self._names_of_motion
            }
            numbers = numbers | numbers_of_motion
        return [numbers[name] for name in self._names]

    def _find_in_motion(
        self, scenario: Scenario, name: str, parameters: Mapping[str, Parameter]
    ) -> Number:
        """Return a number that belongs to the motion of a scenario."""
        wave = self._waves.get(name)
        if wave is not None:
            return _number_of(scenario, wave, getattr(scenario.gait, _field_of(wave)))
        number = _find_number(scenario, name, parameters)
        if number.wave_parameter is not None:
            self._waves[name] = parameters[name]
        return number

    def find_parameters(self, scenario: Scenario) -> tuple[Parameter, ...]:
        """Return the parameters of a scenario, all of which it has."""
        parameters = list_parameters(scenario)
        return tuple(parameters[name] for name in self._names)


ROOTS_OF_MOTION = ("gait.", "controller.")
"""How names begin of numbers that belong to the motion of a scenario."""


def _find_number(scenario: Scenario, name: str, parameters: Mapping[str, Parameter]) -> Number:
    """Return the number of a scenario that a name stands for.

    Raises:
        ValueError: If there is no parameter of that name, or it is a count.
    """
    parameter = look_up(name, parameters, "names")
    if parameter.is_whole:
        rule = "must be of numbers that can vary slightly"
        raise BadArgument("names", f"{rule}, got `{parameter.name}`, a count")
    return _number_of(scenario, parameter, value_of(parameter.name, scenario))


def _number_of(scenario: Scenario, parameter: Parameter, value: float) -> Number:
    """Return a parameter of a scenario as a number with respect to which its run is differentiated."""
    root = parameter.name.partition(".")[0]
    field = _field_of(parameter)
    return Number(
        name=parameter.name,
        scenario=scenario,
        value=value,
        change=functools.partial(_with_value, scenario, parameter.name),
        wave_parameter=field if root == "gait" and field in GAIT_PARAMETERS else None,
    )


def _field_of(parameter: Parameter) -> str:
    """Return the name of a parameter without its root."""
    return parameter.name.partition(".")[2]


def _with_value(scenario: Scenario, name: str, value: float) -> Scenario:
    return change_parameters(scenario, {name: value})
