"""Null models: speeds that are predicted without physics, from the gait's name and frequency and the fin alone.

Each is fitted to measured speeds by least squares of the logarithm.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from laticauda.errors import BadArgument
from laticauda.gaits import GAIT_WORDS, Gait

Values = Float[np.ndarray, " n_rows"]
Design = Float[np.ndarray, "n_rows n_parameters"]


@dataclass(frozen=True, kw_only=True)
class Row:
    """What a null model knows of a row of a table of speeds."""

    gait: Gait
    """What the joints were asked for."""
    has_fin: bool
    """Whether the robot wore the caudal fin."""

    @property
    def group(self) -> str:
        """Name of the part of the table that it is in."""
        return group_name(self.gait.kind, self.has_fin)


def group_name(gait: str, has_fin: bool) -> str:
    """What tables and files call one gait with one configuration of the robot.

    Args:
        gait: The gait's kind.
        has_fin: Whether the robot wears the caudal fin.
    """
    return f"{GAIT_WORDS[gait]}, {'with' if has_fin else 'without'} fin"


Columns = Callable[[Sequence[Row], Sequence[str]], tuple[Design, Values]]
"""Rows and the names of all groups to the columns that are fitted to log v, and what is added to them."""


def _constant_per_group(rows: Sequence[Row], groups: Sequence[str]) -> tuple[Design, Values]:
    columns = [[float(row.group == name) for name in groups] for row in rows]
    return np.array(columns), np.zeros(len(rows))


def _constant_fin_eel(rows: Sequence[Row], groups: Sequence[str]) -> tuple[Design, Values]:
    columns = [(1.0, float(row.has_fin), float(row.gait.kind == "eel_like")) for row in rows]
    return np.array(columns), np.zeros(len(rows))


def _stride(build: Columns) -> Columns:
    """The same model of the distance per cycle: v proportional to the frequency."""

    def divided(rows: Sequence[Row], groups: Sequence[str]) -> tuple[Design, Values]:
        return build(rows, groups)[0], np.log([row.gait.frequency for row in rows])

    return divided


NULL_MODELS: dict[str, Columns] = {
    "constant per group": _constant_per_group,
    "constant + fin + eel": _constant_fin_eel,
    "constant stride per group": _stride(_constant_per_group),
    "constant stride + fin + eel": _stride(_constant_fin_eel),
}
"""Speeds without physics: a number per group, or a number and two factors; and the same for the distance per cycle."""
MEAN_STRIDE = "mean stride per group"
PREDICTORS = (*NULL_MODELS, MEAN_STRIDE)
"""The same, and the constant stride with the arithmetic mean of each group's strides instead of the geometric one."""


def fit(columns: Design, target: Values) -> Float[np.ndarray, " n_parameters"]:
    """The numbers of a null model by least squares.

    Args:
        columns: What one of `NULL_MODELS` gave.
        target: log v less what is added to them.
    """
    return np.linalg.lstsq(columns, target)[0]


def left_out(columns: Design, target: Values, by: Int[np.ndarray, " n_rows"]) -> Values:
    """Each row's log v as a null model says that is fitted to the rows with another number in `by`.

    Args:
        columns: What one of `NULL_MODELS` gave.
        target: log v less what is added to them.
        by: A number per row: rows of equal number are left out together.

    Returns:
        Values like `target`, nan where the other rows do not suffice.
    """
    found = np.full(target.size, np.nan)
    for number in np.unique(by):
        out = by == number
        if np.linalg.matrix_rank(columns[~out]) == columns.shape[1]:
            found[out] = columns[out] @ fit(columns[~out], target[~out])
    return found


@dataclass(frozen=True, kw_only=True, eq=False)
class NullModel:
    """How well speeds are predicted without physics."""

    name: str
    """Which of `NULL_MODELS`."""
    n_parameters: int
    """How many numbers are fitted."""
    speeds: Values
    """What it says of the speeds that it is fitted to [m/s]."""
    fitted: float
    """Mean error over them [%]."""
    left_out: float
    """The same with each one predicted by the others; nan if they do not suffice [%]."""
    group_left_out: float
    """The same with each group predicted by the others [%]."""


def compared(rows: Sequence[Row], measured: Values) -> tuple[NullModel, ...]:
    """Every null model fitted to the same speeds, and how it does on those that were left out of the fit.

    Args:
        rows: What they are fitted to.
        measured: Their speeds [m/s].
    """
    groups = sorted({row.group for row in rows})
    apart = np.arange(len(rows)), np.array([groups.index(row.group) for row in rows])
    found: list[NullModel] = []
    for name, columns_of in NULL_MODELS.items():
        columns, known = columns_of(rows, groups)
        target = np.log(measured) - known
        speeds = np.exp(columns @ fit(columns, target) + known)
        others = [np.exp(left_out(columns, target, by) + known) for by in apart]
        errors = [np.nan if np.any(np.isnan(values)) else mape(measured, values) for values in others]
        n_parameters = int(np.linalg.matrix_rank(columns))
        how: Any = {"fitted": mape(measured, speeds), "left_out": errors[0], "group_left_out": errors[1]}
        found.append(NullModel(name=name, n_parameters=n_parameters, speeds=speeds, **how))
    return tuple(found)


def predict(
    name: str, rows: Sequence[Row], measured: Values, others: Sequence[Row]
) -> tuple[Float[np.ndarray, " n_others"], int]:
    """Speeds of other rows than those that a null model is fitted to.

    Args:
        name: One of `PREDICTORS`.
        rows: What it is fitted to; must hold every group of the others.
        measured: Their speeds [m/s].
        others: What it predicts.

    Returns:
        Their speeds [m/s], and how many numbers are fitted.

    Raises:
        ValueError: If the others hold a group that the rows do not hold.
    """
    groups = sorted({row.group for row in rows})
    unknown = sorted({row.group for row in others} - set(groups))
    if unknown:
        raise BadArgument("rows", f"must hold every group of `others`, got none of {', '.join(unknown)}")
    if name == MEAN_STRIDE:
        stride = measured / np.array([row.gait.frequency for row in rows])
        means = {group: np.mean(stride[[row.group == group for row in rows]]) for group in groups}
        return np.array([means[row.group] * row.gait.frequency for row in others]), len(groups)
    columns, known = NULL_MODELS[name](rows, groups)
    numbers = fit(columns, np.log(measured) - known)
    columns, known = NULL_MODELS[name](others, groups)
    return np.exp(columns @ numbers + known), numbers.size


def mape(measured: Float[np.ndarray, " _"], predicted: Float[np.ndarray, " _"]) -> float:
    """Mean absolute percentage error, 100 mean |predicted - measured| / measured [%].

    Args:
        measured: All > 0.
        predicted: In the same unit.

    Raises:
        ValueError: If there is no value, the numbers of values differ, or a measured one is not > 0.
    """
    if measured.size == 0 or measured.shape != predicted.shape:
        raise BadArgument("predicted", f"must have {measured.size} values, at least 1, got {predicted.size}")
    if not np.all(measured > 0.0):
        raise BadArgument("measured", f"must be > 0, got {np.min(measured)}")
    return 100.0 * float(np.mean(np.abs(predicted - measured) / measured))
