"""Several trials side by side, with their differences to the first."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from laticauda.angles import wrap_to_pi
from laticauda.errors import BadArgument
from laticauda.trial.figures import Figure
from laticauda.trial.trial import FIGURES, Trial

_OF_MEAN_POWER = ("mean_power", "cost_of_transport", "joules_per_meter")

ROUNDING = 1e-6
"""A figure below this, in its SI unit, is nothing but rounding: no other is a share of it."""
LARGEST_PERCENT = 1000.0
"""A difference of more is no longer read as a share: the first is next to nothing beside the other."""


@dataclass(frozen=True, kw_only=True)
class ComparedFigure:
    """One figure of several trials, side by side."""

    figure: Any
    """Which one, a `Figure`; as the type of a field that would be read as a property."""
    values: tuple[float | None, ...]
    """One value per trial, in the figure's unit; None where it has no meaning."""
    differences: tuple[float | None, ...]
    """Each value minus the first trial's, in the figure's unit, an angle's in [-pi, pi); None where either is None."""
    differences_percent: tuple[float | None, ...]
    """The same in percent of the first; None where that says nothing: either is None, the first is next to nothing
    (`ROUNDING`, `LARGEST_PERCENT`), or the figure is an angle."""


def compare(trials: Sequence[Trial]) -> list[ComparedFigure]:
    """The figures of several trials side by side, with their differences to the first.

    Args:
        trials: At least two, the one to compare with first.

    Returns:
        One row per figure that has a meaning for any of them, in the order of `FIGURES`. Where some trials have a
        power model and some have none, the figures made of `mean_power` are left out.

    Raises:
        ValueError: If there are fewer than two trials.
    """
    if len(trials) < 2:
        raise BadArgument("trials", f"must hold at least 2 trials to compare, got {len(trials)}")
    columns = [trial.figures()[0] for trial in trials]
    # A mechanical and an electrical power differ by a factor of ten: side by side they would mislead.
    mixed = len({trial.mean_power_kind for trial in trials}) > 1
    rows: list[ComparedFigure] = []
    for figure in FIGURES:
        values = tuple(column[figure.name] for column in columns)
        if (mixed and figure.name in _OF_MEAN_POWER) or all(value is None for value in values):
            continue
        rows.append(_compared(figure, values))
    return rows


def _compared(figure: Figure, values: tuple[float | None, ...]) -> ComparedFigure:
    first, is_angle = values[0], figure.unit == "rad"
    differences = tuple(None if value is None or first is None else value - first for value in values)
    shares = tuple(None if is_angle else _percent(difference, first) for difference in differences)
    if is_angle:
        differences = tuple(None if one is None else wrap_to_pi(one) for one in differences)
    return ComparedFigure(figure=figure, values=values, differences=differences, differences_percent=shares)


def _percent(difference: float | None, reference: float | None) -> float | None:
    if difference is None or reference is None or abs(reference) < ROUNDING:
        return None
    share = 100.0 * difference / abs(reference)
    return share if abs(share) <= LARGEST_PERCENT else None
