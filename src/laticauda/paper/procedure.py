"""The paper's own procedure, as a method: fit one gait without the fin, predict everything else."""

from collections.abc import Mapping, Sequence
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
from laticauda.paper.settings import efficiency_settings
from laticauda.robot.parameters import GAITS
from laticauda.trial.null_models import mape

SPEED = "forward_velocity"
COEFFICIENTS = ("water.tangential_friction", "water.normal_drag", "water.added_mass")
"""What the paper identifies."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PaperResult:
    """What the procedure gave."""

    fit: Fit
    """The coefficients, from one gait without fin."""
    errors: Mapping[str, float]
    """By group, the mean of |predicted - measured| / measured; those of `fit.problem.groups` were fitted [%]."""
    error_of_the_rest: float
    """The same over everything that was not fitted [%]."""


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
        model: Which drag: linear and quadratic, as in the paper's closed form (analytical-set), or quadratic only, as
            in its Vortex model (vortex-set).
        parameters: What is fitted.
        **options: As for `fit`.

    Raises:
        ValueError: If there is no such gait without fin, or nothing else to predict.
    """
    models = {one.name: one for one in efficiency_settings().models}
    water = models[one_of("model", model, tuple(models))].water(one_of("gait_kind", gait_kind, GAITS))
    speeds = [
        replace(
            m, scenario=replace(m.scenario, environment=water), figures={SPEED: m.figures[SPEED]}, time=None, series={}
        )
        for m in measurements
        if SPEED in m.figures
    ]
    own = [m for m in speeds if m.scenario.gait.kind == gait_kind and m.scenario.robot.caudal_fin is None]
    if not 0 < len(own) < len(speeds):
        raise BadArgument(
            "measurements",
            f"must hold speeds of gait `{gait_kind}` without fin, and others to predict, got "
            f"{len(own)} of {len(speeds)}",
        )
    found = fit(own, parameters=parameters, **options)
    whole = make_problem(speeds, parameters, model=found.problem.model)
    predicted, groups = predict(whole, found.best).values, np.array(whole.groups)

    def error(shown: Any) -> float:
        return mape(whole.observed[shown], predicted[shown])

    return PaperResult(
        fit=found,
        errors={name: error(groups == name) for name in dict.fromkeys(whole.groups)},
        error_of_the_rest=error(np.array([m not in own for m in speeds])),
    )
