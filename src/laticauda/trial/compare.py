"""Several trials side by side, with their differences to the first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from laticauda.trial.summary import FIGURES, Figure, figures

if TYPE_CHECKING:
    from laticauda.trial.trial import Trial

_OF_MEAN_POWER = ("mean_power", "cost_of_transport", "joules_per_meter")


@dataclass(frozen=True, kw_only=True)
class ComparedFigure:
    """One figure of several trials, side by side."""

    figure: Figure
    """Which one."""
    values: tuple[float | None, ...]
    """One value per trial, in the figure's unit; None where it has no meaning."""
    differences_percent: tuple[float | None, ...]
    """Each value against the first trial's, in percent of the first; None where either is None, the first is 0, or
    the figure is an angle."""


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
        raise ValueError(f"`trials` must hold at least 2 trials to compare, got {len(trials)}.")
    columns = [figures(trial)[0] for trial in trials]
    # A mechanical and an electrical power differ by a factor of ten: side by side they would mislead.
    mixed = len({trial.mean_power_kind for trial in trials}) > 1
    rows: list[ComparedFigure] = []
    for figure in FIGURES:
        values = tuple(column[figure.name] for column in columns)
        if (mixed and figure.name in _OF_MEAN_POWER) or all(value is None for value in values):
            continue
        reference = None if figure.unit == "rad" else values[0]
        differences = tuple(_percent(value, reference) for value in values)
        rows.append(ComparedFigure(figure=figure, values=values, differences_percent=differences))
    return rows


def _percent(value: float | None, reference: float | None) -> float | None:
    if value is None or reference is None or reference == 0.0:
        return None
    return 100.0 * (value - reference) / abs(reference)
