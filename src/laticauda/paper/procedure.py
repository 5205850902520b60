"""The paper's own procedure, as a method: fit one gait without the fin, predict everything else."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from laticauda.errors import BadArgument, one_of
from laticauda.identify.fitting import fit
from laticauda.identify.measurements import Measurement
from laticauda.identify.model import predict
from laticauda.identify.problem import make_problem
from laticauda.identify.result import Fit
from laticauda.identify.unknowns import Unknown
from laticauda.robot import load_water
from laticauda.robot.parameters import GAITS
from laticauda.trial.null_models import mape

MODELS = ("analytical-set", "vortex-set")
"""Linear and quadratic drag, as in the paper's closed form; quadratic drag only, as in its Vortex model."""
SPEED = "forward_velocity"
_PRESETS = {"lateral_undulation": "paper-lateral", "eel_like": "paper-eel"}
COEFFICIENTS = ("water.tangential_friction", "water.normal_drag", "water.added_mass")
"""What the paper identifies."""


@dataclass(frozen=True, kw_only=True)
class GroupError:
    """How well the speeds of one group are described."""

    group: str
    """Its name."""
    was_fitted: bool
    """Whether the coefficients were fitted to it."""
    n_measurements: int
    """How many speeds it has [-]."""
    error: float
    """Mean of |predicted - measured| / measured [%]."""


@dataclass(frozen=True, kw_only=True)
class PaperResult:
    """What the procedure gave."""

    model: str
    """One of `MODELS`."""
    fit: Fit
    """The coefficients, from one gait without fin."""
    groups: tuple[GroupError, ...]
    """Errors by group."""
    error_of_the_rest: float
    """Mean error over everything that was not fitted [%]."""


def paper_procedure(
    measurements: Sequence[Measurement],
    *,
    gait_kind: str = "lateral_undulation",
    model: str = "analytical-set",
    parameters: Sequence[str | Unknown] = COEFFICIENTS,
    **options: Any,
) -> PaperResult:
    """Identify the coefficients from one gait without fin, and predict the other gaits and the fin with them.

    Args:
        measurements: With and without fin; only their forward velocities count, and their waters become the model's.
        gait_kind: Which gait the coefficients are fitted to.
        model: Which drag.
        parameters: What is fitted.
        **options: As for `fit`.

    Raises:
        ValueError: If there is no such gait without fin, or nothing else to predict.
    """
    one_of("model", model, MODELS)
    water = load_water("paper-vortex" if model == "vortex-set" else _PRESETS[one_of("gait_kind", gait_kind, GAITS)])
    placed = [
        replace(
            m,
            scenario=replace(m.scenario, environment=water),
            figures={SPEED: m.figures[SPEED]},
            time=None,
            series={},
        )
        for m in measurements
        if SPEED in m.figures
    ]
    fitted = [m.scenario.gait.kind == gait_kind and m.scenario.robot.caudal_fin is None for m in placed]
    if not any(fitted) or all(fitted):
        raise BadArgument(
            "measurements",
            f"must hold speeds of gait `{gait_kind}` without fin, and others to predict, got "
            f"{sum(fitted)} of {len(fitted)}",
        )
    found = fit([m for m, mine in zip(placed, fitted, strict=True) if mine], parameters=parameters, **options)
    rest = make_problem(placed, parameters, model=found.problem.model)
    predicted = predict(rest, found.best).values
    members = {name: [i for i, other in enumerate(rest.groups) if other == name] for name in rest.groups}
    groups = [
        GroupError(
            group=name,
            was_fitted=fitted[at[0]],
            n_measurements=len(at),
            error=mape(rest.observed[at], predicted[at]),
        )
        for name, at in members.items()
    ]
    out = ~np.array(fitted)
    return PaperResult(
        model=model, fit=found, groups=tuple(groups), error_of_the_rest=mape(rest.observed[out], predicted[out])
    )
