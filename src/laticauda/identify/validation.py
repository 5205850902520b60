"""Can the model predict what it was not fitted to? Refits without one measurement or one group, beside null models."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from jaxtyping import Float

from laticauda.errors import BadArgument, one_of
from laticauda.gaits import GAIT_WORDS
from laticauda.identify import fitting, model, result, tasks, uncertainty
from laticauda.simulate.runner import Progress, silent
from laticauda.trial.null_models import NullModel, Row, compared

BY = ("measurement", "group")


@dataclass(frozen=True, kw_only=True, eq=False)
class LeftOut:
    """Every measurement as a fit predicts it that did not see it."""

    by: str
    """What was left out together: one `measurement` at a time, or one `group`."""
    fit: result.Fit
    """The fit to all."""
    predictions: Float[np.ndarray, " n_data"]
    """As `Fit.predictions`; nan where the others do not say what the prediction needs."""
    values: Float[np.ndarray, "n_left_out n_unknowns"]
    """What was identified each time."""

    def percentage_error(self, figure: str = "forward_velocity") -> float:
        """Mean of |predicted - measured| / measured over the measurements of a figure; nan if one cannot be predicted.

        Args:
            figure: Its name.
        """
        return self.fit.percentage_error(figure, self.predictions)


def leave_out(found: result.Fit, by: str = "measurement", *, progress: Progress = silent) -> LeftOut:
    """Refit without each measurement, or without each group, and predict what was left out.

    Where it began is what the fit to all says: nothing else can.

    Args:
        found: The fit to all; each refit begins at its values.
        by: measurement or group.
        progress: Called with the share that is finished.

    Raises:
        ValueError: If there is nothing left to fit to.
    """
    problem = found.problem
    names = [m.name for m in problem.measurements] if one_of("by", by, BY) == "measurement" else list(problem.groups)
    different = list(dict.fromkeys(names))
    if len(different) < 2:
        raise BadArgument("by", f"must leave something to fit to, got `{by}`: all measurements are of `{names[0]}`")
    predictions = np.full(problem.observed.size, np.nan)
    values: list[np.ndarray] = []
    without_prior = np.array([unknown.prior is None for unknown in problem.unknowns])
    for number, name in enumerate(different):
        out = [i for i, other in enumerate(names) if other == name]
        rest = problem.part([i for i in range(len(names)) if i not in out])
        began = problem.moves[out].any(axis=0) & ~np.isin(np.arange(len(problem.unknowns)), problem.of_interest)
        refit = fitting.solve(rest, replace(found.method, n_starts=1), start=found.best)
        values.append(np.where(began & ~rest.moves.any(axis=0), found.best, refit.best))
        if not np.any(problem.moves[out].any(axis=0) & ~(rest.moves | began).any(axis=0) & without_prior):
            predictions[np.isin(problem.owner, out)] = model.predict(problem.part(out), values[-1]).values
        progress((number + 1) / len(different))
    return LeftOut(by=by, fit=found, predictions=predictions, values=np.array(values))


def linear_leave_one_out(found: result.Fit) -> Float[np.ndarray, " n_data"]:
    """Predictions of every single number by the others, as the linearized model has them, without any refit.

    With the leverage h, the diagonal of H = J (J^T J)^-1 J^T, a residual r of a number that takes part in the fit is
    r / (1 - h) if it does not.

    Args:
        found: The fit.
    """
    problem = found.problem
    basis, strength, _ = np.linalg.svd(model.scaled_jacobian(problem, found.best), full_matrices=False)
    leverage = np.sum(basis[:, strength > 1e-7 * strength[0]] ** 2, axis=1)
    return problem.observed + (found.predictions - problem.observed) / (1.0 - leverage)


def compared_with_null_models(found: result.Fit) -> tuple[NullModel, ...]:
    """Null models fitted to the same speeds; none for gaits that they do not know, or without speeds.

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
    """A fit, and how it does on what it was not fitted to."""

    task: tasks.Task
    """What was asked for."""
    found: result.Fit
    """What was found."""
    left_out: Float[np.ndarray, " n_data"]
    """Every number as the others predict it."""
    is_linearized: bool
    """Whether that is by the linearized model, without refits."""
    by_group: LeftOut | None
    """The same by groups, always with refits; None if the others do not suffice, or it was not asked for."""
    null_models: tuple[NullModel, ...]
    """Models without physics on the same speeds."""
    profiles: Mapping[str, uncertainty.Ends]
    """By name of the unknown, intervals from the likelihood itself, if asked for."""

    @property
    def errors(self) -> dict[str, float | None]:
        """Mean errors of the forward velocity, by their names in `NullModel` [%]; None where there is none."""
        groups = np.full_like(self.left_out, np.nan) if self.by_group is None else self.by_group.predictions
        every = {"fitted": self.found.predictions, "left_out": self.left_out, "group_left_out": groups}
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
    """How a fit does on what it was not fitted to; Ctrl-C ends it with what is known until then.

    Args:
        task: What was asked for.
        found: What was found.
        exact: Whether every measurement is left out by a refit, instead of by the linearized model.
        by_group: Whether groups are left out, if there are several.
        profiles: Whether intervals are computed from the likelihood too.
        progress: Called now and then with what is going on, and the share of it that is finished.
    """
    single, is_linearized, groups, kept = linear_leave_one_out(found), True, None, dict[str, uncertainty.Ends]()
    is_whole = fitting.INTERRUPTED not in found.warnings
    shown = found.problem.of_interest if profiles and is_whole else []
    try:
        if exact and is_whole and _suffices(found, [m.name for m in found.problem.measurements]):
            single = leave_out(found, progress=partial(progress, "measurements left out")).predictions
            is_linearized = False
        if by_group and is_whole and _suffices(found, found.problem.groups):
            groups = leave_out(found, "group", progress=partial(progress, "groups left out"))
        for done, k in enumerate(shown):
            name = found.estimates[k].name
            kept[name] = uncertainty.profile(found, name)
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
    """Whether something is left to fit to, and enough of it, if what goes by any one of these names is left out."""
    problem = found.problem
    n_free = sum(unknown.prior is None for unknown in problem.unknowns) + (found.method.noise == "estimated")
    sizes = np.bincount(problem.owner, minlength=len(names))
    most = max(sum(size for size, other in zip(sizes, names, strict=True) if other == name) for name in names)
    return len(set(names)) > 1 and problem.observed.size - int(most) >= n_free
