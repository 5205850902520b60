"""How a fit does on what it was not fitted to."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.identify.result import Fit
from laticauda.identify.tasks import Task
from laticauda.identify.uncertainty import Profile, profile
from laticauda.identify.validation import (
    LeftOut,
    NullModel,
    compared_with_null_models,
    figure_places,
    leave_out,
    linear_leave_one_out,
)
from laticauda.trial.null_models import mape

SPEED = "forward_velocity"


@dataclass(frozen=True, kw_only=True, eq=False)
class Checked:
    """A fit, and how it does on what it was not fitted to."""

    task: Task
    """What was asked for."""
    found: Fit
    """What was found."""
    left_out: Float[np.ndarray, " n_data"]
    """Every number as the others predict it."""
    is_linearized: bool
    """Whether that is by the linearized model, without refits."""
    by_group: LeftOut | None
    """The same by groups, always with refits; None if the others do not suffice, or it was not asked for."""
    null_models: tuple[NullModel, ...]
    """Models without physics on the same speeds."""
    profiles: tuple[Profile, ...]
    """Intervals from the likelihood itself, if asked for."""

    def error(self, predictions: Float[np.ndarray, " n_data"] | None, figure: str = SPEED) -> float | None:
        """Mean error of a figure, in percent; None without such measurements or predictions."""
        measured = {name for m in self.found.problem.measurements for name in m.figures}
        if predictions is None or figure not in measured:
            return None
        at = figure_places(self.found, figure)
        observed = self.found.problem.observed[at]
        if np.any(np.isnan(predictions[at])) or np.any(observed == 0.0):
            return None
        return mape(observed, predictions[at])


def checked(
    task: Task,
    found: Fit,
    *,
    exact: bool = False,
    by_group: bool = True,
    profiles: bool = False,
    progress: Callable[[str, float], None] | None = None,
) -> Checked:
    """How a fit does on what it was not fitted to.

    Args:
        task: What was asked for.
        found: What was found.
        exact: Whether every measurement is left out by a refit, instead of by the linearized model.
        by_group: Whether groups are left out, if there are several.
        profiles: Whether intervals are computed from the likelihood too.
        progress: Called now and then with what is going on, and the share of it that is finished.
    """

    def told(what: str) -> Callable[[float], None]:
        return lambda share: None if progress is None else progress(what, share)

    exact = exact and _suffices(found, [m.name for m in found.problem.measurements])
    single = (
        leave_out(found, progress=told("measurements left out")).predictions if exact else linear_leave_one_out(found)
    )
    groups = (
        leave_out(found, "group", progress=told("groups left out"))
        if by_group and _suffices(found, found.problem.groups)
        else None
    )
    kept: list[Profile] = []
    shown = of_interest(found) if profiles else []
    for done, k in enumerate(shown):
        kept.append(profile(found, found.estimates[k].name))
        if progress is not None:
            progress("profiles", (done + 1) / len(shown))
    return Checked(
        task=task,
        found=found,
        left_out=single,
        is_linearized=not exact,
        by_group=groups,
        null_models=compared_with_null_models(found),
        profiles=tuple(kept),
    )


def _suffices(found: Fit, names: Sequence[str]) -> bool:
    """Whether something is left to fit to, and enough of it, if what goes by any one of these names is left out."""
    put = found.problem
    n_free = sum(unknown.prior is None for unknown in put.unknowns) + (found.noise == "estimated")
    sizes = np.bincount(put.owner, minlength=len(names))
    most = max(sum(size for size, other in zip(sizes, names, strict=True) if other == name) for name in names)
    return len(set(names)) > 1 and put.observed.size - int(most) >= n_free


def of_interest(found: Fit) -> list[int]:
    """Numbers of the unknowns that figures show: all but where single trials began.

    Args:
        found: The fit.
    """
    unknowns = found.problem.unknowns
    return [k for k, unknown in enumerate(unknowns) if not unknown.parameter.name.startswith("start.")]
