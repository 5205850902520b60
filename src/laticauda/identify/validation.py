"""Prediction of data not used in the fit: refits without a measurement or a group, compared with null models."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from jaxtyping import Float

from laticauda.identify import fitting, model, result, tasks, uncertainty
from laticauda.models.simulate.runner import Progress, silent
from laticauda.motion.gaits import GAIT_WORDS
from laticauda.trials.null_models import NullModel, Row, compared
from laticauda.values.checks import check_choice
from laticauda.values.errors import BadArgument

BY = ("measurement", "group")


@dataclass(frozen=True, kw_only=True, eq=False)
class LeftOut:
    """Predictions of every measurement by a fit that did not see it."""

    by: str
    """What was left out at a time: one `measurement` or one `group`."""
    fit: result.Fit
    """The fit to all measurements."""
    predictions: Float[np.ndarray, " n_data"]
    """Predictions in the order of `Fit.predictions`; nan where the others do not determine what they need."""
    values: Float[np.ndarray, "n_left_out n_unknowns"]
    """Identified values of each refit."""

    def percentage_error(self, figure: str = "forward_velocity") -> float:
        """Return the mean of |predicted - measured| / measured for a figure; nan if one value cannot be predicted.

        Args:
            figure: Name of the figure.
        """
        return self.fit.percentage_error(figure, self.predictions)


def leave_out(
    found: result.Fit, by: str = "measurement", *, progress: Progress = silent
) -> LeftOut:
    """Refit without each measurement, or without each group, and predict what was left out.

    The start state of a trial left out is taken from the fit to all, the only source for it.

    Args:
        found: The fit to all; each refit starts from its values.
        by: measurement or group.
        progress: Called with the finished fraction.

    Raises:
        ValueError: If there is nothing left to fit to.
    """
    problem = found.problem
    names = (
        [m.name for m in problem.measurements]
        if check_choice("by", by, BY) == "measurement"
        else list(problem.groups)
    )
    different = list(dict.fromkeys(names))
    if len(different) < 2:
        raise BadArgument(
            "by",
            f"must leave something to fit to, got `{by}`: all measurements are of `{names[0]}`",
        )
    predictions = np.full(problem.observed.size, np.nan)
    values: list[np.ndarray] = []
    without_prior = np.array([unknown.prior is None for unknown in problem.unknowns])
    for number, name in enumerate(different):
        out = [i for i, other in enumerate(names) if other == name]
        rest = problem.part([i for i in range(len(names)) if i not in out])
        began = problem.moves[out].any(axis=0) & ~np.isin(
            np.arange(len(problem.unknowns)), problem.of_interest
        )
        refit = fitting.solve(rest, replace(found.method, n_starts=1), start=found.best)
        values.append(np.where(began & ~rest.moves.any(axis=0), found.best, refit.best))
        if not np.any(
            problem.moves[out].any(axis=0) & ~(rest.moves | began).any(axis=0) & without_prior
        ):
            predictions[np.isin(problem.owner, out)] = model.predict(
                problem.part(out), values[-1]
            ).values
        progress((number + 1) / len(different))
    return LeftOut(by=by, fit=found, predictions=predictions, values=np.array(values))


def linear_leave_one_out(found: result.Fit) -> Float[np.ndarray, " n_data"]:
    """Predict every single number from the others with the linearized model, without any refit.

    With the leverage h, the diagonal of H = J (J^T J)^-1 J^T, the residual r of a number used in
    the fit becomes r / (1 - h) if that number is left out.

    Args:
        found: The fit.
    """
    problem = found.problem
    basis, strength, _ = np.linalg.svd(
        model.scaled_jacobian(problem, found.best), full_matrices=False
    )
    leverage = np.sum(basis[:, strength > 1e-7 * strength[0]] ** 2, axis=1)
    return problem.observed + (found.predictions - problem.observed) / (1.0 - leverage)


def compared_with_null_models(found: result.Fit) -> tuple[NullModel, ...]:
    """Fit null models to the same speeds; return none for gaits that they do not know, or without speeds.

    Args:
        found: The fit.
    """
    problem = found.problem
    if not any("forward_velocity" in measurement.figures for measurement in problem.measurements):
        return ()
    at = found.places_of("forward_velocity")
    scenarios = [problem.scenarios[int(i)] for i in problem.owner[at]]
    if any(one.gait.kind not in GAIT_WORDS for one in scenarios):
        return ()
    rows = [Row(gait=one.gait, has_fin=one.robot.caudal_fin is not None) for one in scenarios]
    return compared(rows, problem.observed[at])


@dataclass(frozen=True, kw_only=True, eq=False)
class Validation:
    """A fit, and its performance on data that it was not fitted to."""

    task: tasks.Task
    """The task."""
    found: result.Fit
    """The fit."""
    left_out: Float[np.ndarray, " n_data"]
    """Prediction of every number from the others."""
    is_linearized: bool
    """Whether these predictions come from the linearized model, without refits."""
    by_group: LeftOut | None
    """Predictions by group, always with refits; None if the other groups do not suffice, or if not requested."""
    null_models: tuple[NullModel, ...]
    """Models without physics for the same speeds."""
    profiles: Mapping[str, uncertainty.Ends]
    """Intervals from the likelihood itself by name of the unknown, if requested."""

    @property
    def errors(self) -> dict[str, float | None]:
        """Mean errors of the forward velocity by their names in `NullModel` [%]; None if there are none."""
        groups = (
            np.full_like(self.left_out, np.nan)
            if self.by_group is None
            else self.by_group.predictions
        )
        every = {
            "fitted": self.found.predictions,
            "left_out": self.left_out,
            "group_left_out": groups,
        }
        if not any("forward_velocity" in one.figures for one in self.found.problem.measurements):
            return dict.fromkeys(every)
        errors = {name: self.found.percentage_error(predictions=one) for name, one in every.items()}
        return {name: error if math.isfinite(error) else None for name, error in errors.items()}


def validate(
    task: tasks.Task,
    found: result.Fit,
    *,
    exact: bool = False,
    by_group: bool = True,
    profiles: bool = False,
    progress: Callable[[str, float], None] = silent,
) -> Validation:
    """Test a fit on data that it was not fitted to; Ctrl-C ends this with the results so far.

    Args:
        task: The task.
        found: The fit.
        exact: Whether every measurement is left out in a refit, instead of with the linearized
            model.
        by_group: Whether groups are left out, if there are several.
        profiles: Whether intervals are also computed from the likelihood.
        progress: Called periodically with the current step and its finished fraction.
    """
    single, is_linearized, groups, kept = (
        linear_leave_one_out(found),
        True,
        None,
        dict[str, uncertainty.Ends](),
    )
    is_whole = fitting.INTERRUPTED not in found.warnings
    shown = found.problem.of_interest if profiles and is_whole else []
    try:
        if exact and is_whole and _suffices(found, [m.name for m in found.problem.measurements]):
            single = leave_out(
                found, progress=partial(progress, "measurements left out")
            ).predictions
            is_linearized = False
        if by_group and is_whole and _suffices(found, found.problem.groups):
            groups = leave_out(found, "group", progress=partial(progress, "groups left out"))
        for done, k in enumerate(shown):
            name = found.estimates[k].name
            kept[name] = uncertainty.profile_interval(found, name)
            progress("profiles", (done + 1) / len(shown))
    except KeyboardInterrupt:
        found, kept = replace(found, warnings=(fitting.INTERRUPTED, *found.warnings)), {}
    return Validation(
        task=task,
        found=found,
        left_out=single,
        is_linearized=is_linearized,
        by_group=groups,
        null_models=compared_with_null_models(found),
        profiles=kept,
    )


def _suffices(found: result.Fit, names: Sequence[str]) -> bool:
    """Check that enough data remain for a fit when the measurements of any one of these names are left out."""
    problem = found.problem
    n_free = sum(unknown.prior is None for unknown in problem.unknowns) + (
        found.method.noise == "estimated"
    )
    sizes = np.bincount(problem.owner, minlength=len(names))
    most = max(
        sum(size for size, other in zip(sizes, names, strict=True) if other == name)
        for name in names
    )
    return len(set(names)) > 1 and problem.observed.size - int(most) >= n_free
