"""The averaged model of a gait with one robot, from trials of its own: what model-predictive guidance plans with."""

from dataclasses import replace
from typing import Any

import laticauda as lc
from laticauda import control, gaits, simulate
from laticauda.errors import BadArgument, whole
from laticauda.simulate.runner import Progress, silent

N_TRIALS = 4
AROUND = 1.0 / 3.0
"""The trials' frequencies go so far below and above the gait's, where no limits are given [-]."""


def averaged_model(
    plant: lc.Plant[Any],
    gait: gaits.Gait,
    frequency_limits: tuple[float, float] | None = None,
    *,
    n_trials: int = N_TRIALS,
    progress: Progress = silent,
) -> control.AveragedModel:
    """Learn how a gait moves a robot, from trials at several frequencies whose offset goes up and down in steps.

    Args:
        plant: The robot in its water, which stands still for this where it moves otherwise than as one.
        gait: What swims.
        frequency_limits: Least and greatest frequency of the trials; None: a third below and above the gait's [rad/s].
        n_trials: How many trials.
        progress: Called now and then with the share that is done.

    Raises:
        ValueError: If an argument is out of its range, or the trials do not determine the model.

    Example:
        >>> import laticauda as lc
        >>> gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
        >>> model = averaged_model(lc.plant(lc.load_robot("mamba"), lc.load_water("paper-lateral")), gait)
        >>> round(model.speed(2.0, 0.0), 2)
        0.13
    """
    whole("n_trials", n_trials, 3)
    low, high = frequency_limits or ((1.0 - AROUND) * gait.frequency, (1.0 + AROUND) * gait.frequency)
    if not 0.0 < low < high:
        raise BadArgument("frequency_limits", f"must be 0 < least < greatest in rad/s, got {low:g} and {high:g}")
    frequencies = [low + (high - low) * k / (n_trials - 1) for k in range(n_trials)]
    turns = [control.OffsetSteps(gait=replace(gait, frequency=frequency)) for frequency in frequencies]
    water, trials = plant.environment, list[lc.Trial]()
    if isinstance(water, lc.Water) and water.flow is not None:
        plant = replace(plant, environment=water.still)
    for k, each in enumerate(turns):
        trials.append(simulate.run(plant, each, each.duration))
        progress((k + 1) / n_trials)
    return control.fit_averaged(trials)
