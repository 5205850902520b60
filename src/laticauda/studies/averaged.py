"""Averaged model of a gait with one robot, from trials made for it; model-predictive guidance plans with it."""

from dataclasses import replace
from typing import Any

import laticauda as lc
from laticauda import control
from laticauda.models import simulate
from laticauda.models.simulate import Progress, silent
from laticauda.motion import gaits
from laticauda.values import BadArgument, check_whole_number

N_TRIALS = 4
"""Number of trials, unless it is stated."""
DEFAULT_SPREAD = 1.0 / 3.0
"""Relative distance of the trials' extreme frequencies from the gait's, if no limits are given [-]."""


def averaged_model(
    plant: lc.Plant[Any],
    gait: gaits.Gait,
    frequency_limits: tuple[float, float] | None = None,
    *,
    n_trials: int = N_TRIALS,
    progress: Progress = silent,
) -> control.AveragedModel:
    """Learn how a gait moves a robot, from trials at several frequencies whose offset rises and falls in steps.

    Args:
        plant: The robot in its water; a flow that is not uniform and constant is replaced by still
            water.
        gait: Gait of the trials.
        frequency_limits: Lowest and highest frequency of the trials; None: a third below and above
            the gait's [rad/s].
        n_trials: Number of trials.
        progress: Called periodically with the finished fraction.

    Raises:
        ValueError: If an argument is out of its range, or the trials do not determine the model.

    Example:
        >>> import laticauda as lc
        >>> gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
        >>> plant = lc.build_plant(lc.load_robot("mamba"), lc.load_water("paper-lateral"))
        >>> model = averaged_model(plant, gait)
        >>> round(model.speed(2.0, 0.0), 2)
        0.13
    """
    check_whole_number("n_trials", n_trials, 3)
    if frequency_limits is None:
        lowest = (1.0 - DEFAULT_SPREAD) * gait.frequency
        highest = (1.0 + DEFAULT_SPREAD) * gait.frequency
    else:
        lowest, highest = frequency_limits
    if not 0.0 < lowest < highest:
        raise BadArgument(
            "frequency_limits",
            f"must be 0 < smallest < largest in rad/s, got {lowest:g} and {highest:g}",
        )
    water = plant.environment
    if isinstance(water, lc.Water) and water.flow is not None:
        plant = replace(plant, environment=water.still)
    trials: list[lc.Trial] = []
    for k in range(n_trials):
        frequency = lowest + (highest - lowest) * k / (n_trials - 1)
        offset_steps = control.OffsetSteps(gait=replace(gait, frequency=frequency))
        trials.append(simulate.run(plant, offset_steps, offset_steps.duration))
        progress((k + 1) / n_trials)
    return control.fit_averaged(trials)
