"""A fit and its performance on data that it was not fitted to, beside null models."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.identify.fitting import INTERRUPTED
from laticauda.identify.leaving_out import (
    LeftOut,
    leave_out,
    linear_leave_one_out,
    names_to_leave_out,
)
from laticauda.identify.profiles import Ends, profile_interval
from laticauda.identify.result import Fit
from laticauda.identify.tasks import Task
from laticauda.models.simulate import silent
from laticauda.motion.gaits import GAIT_WORDS
from laticauda.trials import NullModel, Row, compared

_VELOCITY = "forward_velocity"
"""The figure that null models predict."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Validation:
    """A fit, and its performance on data that it was not fitted to."""

    task: Task
    """The task."""
    fit: Fit
    """The fit."""
    left_out: Float[np.ndarray, " n_data"]
    """Prediction of every number from the others."""
    is_linearized: bool
    """Whether these predictions come from the linearized model, without refits."""
    by_group: LeftOut | None
    """Predictions by group, always with refits.

    None if the other groups do not suffice, or if not requested.
    """
    null_models: tuple[NullModel, ...]
    """Models without physics for the same speeds."""
    profiles: Mapping[str, Ends]
    """Intervals from the likelihood itself by name of the unknown, if requested."""

    @property
    def errors(self) -> dict[str, float | None]:
        """Mean errors of the forward velocity by their names in `NullModel` [%]; or None."""
        errors: dict[str, float | None] = dict.fromkeys(("fitted", "left_out", "group_left_out"))
        if not _has_velocity(self.fit):
            return errors
        predictions = {"fitted": self.fit.predictions, "left_out": self.left_out}
        if self.by_group is not None:
            predictions["group_left_out"] = self.by_group.predictions
        for name, predicted in predictions.items():
            error = self.fit.percentage_error(predictions=predicted)
            if math.isfinite(error):
                errors[name] = error
        return errors


def _has_velocity(fit: Fit) -> bool:
    return any(_VELOCITY in measurement.figures for measurement in fit.problem.measurements)


def compared_with_null_models(fit: Fit) -> tuple[NullModel, ...]:
    """Fit null models to the same speeds; return none without speeds or for gaits unknown to them.

    Args:
        fit: The fit.
    """
    problem = fit.problem
    if not _has_velocity(fit):
        return ()
    positions = fit.places_of(_VELOCITY)
    scenarios = [problem.scenarios[int(i)] for i in problem.owner[positions]]
    if any(scenario.gait.kind not in GAIT_WORDS for scenario in scenarios):
        return ()
    rows = [
        Row(gait=scenario.gait, has_fin=scenario.robot.caudal_fin is not None)
        for scenario in scenarios
    ]
    return compared(rows, problem.observed[positions])


def validate(
    task: Task,
    fit: Fit,
    *,
    exact: bool = False,
    by_group: bool = True,
    profiles: bool = False,
    progress: Callable[[str, float], None] = silent,
    client: Any = None,
) -> Validation:
    """Test a fit on data that it was not fitted to; Ctrl-C ends this with the results so far.

    Args:
        task: The task.
        fit: The fit.
        exact: Whether every measurement is left out in a refit, instead of with the linearized
            model.
        by_group: Whether groups are left out, if there are several.
        profiles: Whether intervals are also computed from the likelihood.
        progress: Called periodically with the current step and its finished fraction.
        client: A `dask.distributed.Client` whose cluster simulates; None: this process does.
    """
    remote_fit = fit.simulated_on(client)
    validation = Validation(
        task=task,
        fit=fit,
        left_out=linear_leave_one_out(remote_fit),
        is_linearized=True,
        by_group=None,
        null_models=(),
        profiles={},
    )
    is_whole = INTERRUPTED not in fit.warnings
    try:
        if exact and is_whole and _suffices_without(fit, "measurement"):
            singly = leave_out(remote_fit, progress=partial(progress, "measurements left out"))
            validation = replace(validation, left_out=singly.predictions, is_linearized=False)
        if by_group and is_whole and _suffices_without(fit, "group"):
            groupwise = leave_out(
                remote_fit, "group", progress=partial(progress, "groups left out")
            )
            validation = replace(validation, by_group=replace(groupwise, fit=fit))
        if profiles and is_whole:
            validation = replace(validation, profiles=_profile_all(remote_fit, progress))
    except KeyboardInterrupt:
        interrupted = replace(fit, warnings=(INTERRUPTED, *fit.warnings))
        validation = replace(validation, fit=interrupted)
    return replace(validation, null_models=compared_with_null_models(fit))


def _profile_all(fit: Fit, progress: Callable[[str, float], None]) -> dict[str, Ends]:
    """Return the intervals from the likelihood of all unknowns but the starts of single trials."""
    intervals: dict[str, Ends] = {}
    shown = fit.problem.of_interest
    for n_done, k in enumerate(shown, start=1):
        name = fit.estimates[k].name
        intervals[name] = profile_interval(fit, name)
        progress("profiles", n_done / len(shown))
    return intervals


def _suffices_without(fit: Fit, by: str) -> bool:
    """Check that enough data remain for a fit when any one measurement, or group, is left out."""
    problem = fit.problem
    names = names_to_leave_out(problem, by)
    n_data_of_name = dict.fromkeys(names, 0)
    for i in problem.owner:
        n_data_of_name[names[i]] += 1
    n_free = len(problem.unknowns) - problem.n_priors
    if fit.method.estimates_noise:
        n_free += 1
    n_remaining = problem.observed.size - max(n_data_of_name.values())
    return len(n_data_of_name) > 1 and n_remaining >= n_free
