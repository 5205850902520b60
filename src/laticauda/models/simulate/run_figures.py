"""The figures that every batch of runs computes: the one list of their names, with units and titles.

A new figure of a batch is a field of `RunFigures`, a property of `Trial` with the same name, and a
formula in `laticauda.models.simulate.batch_figures.compute_figures`; the type checker asks for it.
"""

from dataclasses import dataclass, fields

import numpy as np
from jaxtyping import Inexact

from laticauda.trials import Trial
from laticauda.values import SERIES

Figure = Inexact[np.ndarray, " n_trials"]
"""One value per trial; complex only in batches that carry derivatives."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RunFigures:
    """Figures of many runs, each defined as that of the same name in a `Trial`; nan where a run has none."""

    forward_velocity: Figure
    """Straight-line displacement / time over the whole run (5) [m/s]."""
    steady_velocity: Figure
    """Displacement / time over whole gait cycles after the first third of the run and 10 s [m/s]."""
    speed_through_water: Figure
    """`forward_velocity` relative to the water where the robot was [m/s]; nan on ground."""
    steady_speed_through_water: Figure
    """`steady_velocity` relative to the water where the robot was [m/s]; nan on ground."""
    mechanical_power: Figure
    """Mean of sum |u phi'| [W]."""
    net_power: Figure
    """Mean of sum u phi' [W]."""
    positive_power: Figure
    """Mean of sum max(u phi', 0) [W]."""
    mean_power: Figure
    """Electrical power with servo joints or a `Robot.active_power`, otherwise mechanical power [W]."""
    cost_of_transport: Figure
    """`mean_power` / (weight of the displaced water x `speed_through_water`) [-]; on ground, the robot's own weight and
    `forward_velocity`."""


FIGURES_OF_TRIAL = tuple(field.name for field in fields(RunFigures))
"""Names of the figures that a single `Trial` has as properties."""
FINAL_VALUES = {"x": "m", "y": "m", "heading": "rad"}
"""Units of the further figures: where a run ended."""
UNITS = {name: getattr(Trial, name).unit for name in FIGURES_OF_TRIAL} | FINAL_VALUES
"""Figures of a trial that depend on its parameters, with their units."""


def described(title: str, unit: str) -> dict[str, str]:
    """Return the attributes of a Dataset variable, from which xarray's plots take their axis labels.

    Args:
        title: Title, a phrase.
        unit: Unit; "" for a pure number.
    """
    return {"long_name": title, "units": unit or "1"}


def of_figure(name: str) -> dict[str, str]:
    """Return the attributes for a figure of a trial, for the final value of a series, or for `succeeded`.

    Args:
        name: Name of the figure or the series.
    """
    if name == "succeeded":
        return {"long_name": "whether the run reached its end"}
    if name in SERIES:
        series = SERIES[name]
        return described(f"{series.text}, at the end", series.units)
    figure = getattr(Trial, name)
    return described(figure.title, figure.unit)
