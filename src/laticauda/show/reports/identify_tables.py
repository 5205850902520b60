"""Tables of the report on an identification."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from laticauda.identify import ParameterEstimate, ResolvedUnknown, Validation
from laticauda.show.reports.cells import Row, format_number

LEAST_WEIGHT = 0.3
"""Least weight of the parameters, as opposed to initial conditions, in a direction that is listed [-]."""

ERROR_COLUMNS = {
    "fitted": "fitted [%]",
    "left_out": "measurement left out [%]",
    "group_left_out": "group left out [%]",
}
"""Columns of errors, by their names in `Validation.errors`."""
RESIDUAL = "in standard deviations [-]"
"""Column of a residual divided by the stated noise."""


def list_identification_tables(validated: Validation) -> dict[str, list[Row]]:
    """Return all tables by name, without empty ones.

    Args:
        validated: Validated result of the identification.
    """
    errors: list[Row] = []
    if validated.errors["fitted"] is not None:
        errors = list_errors({"this fit": validated})
    tables = {
        "parameters": _list_parameters(validated),
        "directions": _list_directions(validated),
        "groups": _list_groups(validated),
        "residuals": _list_residuals(validated),
        "starts": _list_searches(validated),
        "correlations": _list_correlations(validated),
        "began": _list_initial_conditions(validated),
        "errors": errors,
    }
    return {name: rows for name, rows in tables.items() if rows}


def _list_parameters(validated: Validation) -> list[Row]:
    """Return the values of parameters, their uncertainties, and notes on them."""
    fit = validated.fit
    confidence = f"{100 * fit.method.confidence:g} %"
    rows: list[Row] = []
    for index in fit.problem.of_interest:
        unknown = fit.problem.unknowns[index]
        estimate = fit.estimates[index]
        row = _estimate_row(estimate)
        low, high = estimate.interval or (None, None)
        row[f"{confidence} interval, low"] = low
        row["high"] = high
        if validated.profiles:
            profile_low, profile_high = validated.profiles[estimate.name]
            row["profile, low"] = profile_low
            row["profile, high"] = profile_high
        row["prior"] = _format_prior(unknown)
        row["range"] = f"{_format_bound(unknown.lower)} to {_format_bound(unknown.upper)}"
        row["note"] = _format_notes(unknown, estimate)
        rows.append(row)
    return rows


def _estimate_row(estimate: ParameterEstimate) -> Row:
    value: float | None = None
    if estimate.is_identified:
        value = estimate.value
    return {
        "parameter": estimate.name,
        "value": value,
        "unit": estimate.unit or "-",
        "standard deviation": estimate.sigma,
    }


def _format_prior(unknown: ResolvedUnknown) -> str:
    if unknown.prior is None:
        return "none"
    mean, sigma = unknown.prior
    return f"{mean:.4g} ± {sigma:.2g}"


def _format_bound(value: float) -> str:
    if not math.isfinite(value):
        return "any"
    return format_number(value, ".4g")


def _format_notes(unknown: ResolvedUnknown, estimate: ParameterEstimate) -> str:
    notes: list[str] = []
    if estimate.note:
        notes.append(estimate.note.replace("`", ""))
    if unknown.tied:
        powers = [f"{name}^{power:g}" for name, power in unknown.tied.items()]
        notes.append(f"changes with it: {', '.join(powers)}")
    return "; ".join(notes) or "-"


def _list_initial_conditions(validated: Validation) -> list[Row]:
    """Return the initial conditions of individual trials that were identified."""
    parameters = validated.fit.problem.of_interest
    rows: list[Row] = []
    for index, estimate in enumerate(validated.fit.estimates):
        if index not in parameters:
            rows.append(_estimate_row(estimate))
    return rows


def _list_directions(validated: Validation) -> list[Row]:
    """Return how well the measurements determine combinations of parameters."""
    parameters = validated.fit.problem.of_interest
    rows: list[Row] = []
    for direction in validated.fit.identifiability.directions:
        weights = np.abs(direction.weights[parameters])
        if np.max(weights, initial=0.0) <= LEAST_WEIGHT:
            continue
        row = {
            "combination": direction.name.replace("`", ""),
            "standard deviation [-]": direction.deviation,
            "seen": direction.is_seen,
        }
        rows.append(row)
    return rows


def _list_residuals(validated: Validation) -> list[Row]:
    """Return every measurement with its prediction by this fit, and by the other measurements."""
    problem = validated.fit.problem
    first_columns = ("group", "measurement", "what", "unit", "measured", "predicted")
    rows: list[Row] = []
    for residual, block in zip(validated.fit.residuals, problem.data_blocks, strict=True):
        prediction: float | None = None
        if not block.is_series:
            prediction = float(validated.left_out[block.numbers.start])
        row = {column: residual[column] for column in first_columns}
        row["left out"] = prediction
        rows.append(row | residual)
    return sort_by_group(rows, problem.groups)


def sort_by_group(rows: Sequence[Row], groups: Sequence[str]) -> list[Row]:
    """Return rows in the order of their groups.

    Args:
        rows: Rows with a column "group".
        groups: All groups in their order; they may repeat.
    """
    return sorted(rows, key=lambda row: groups.index(row["group"]))


def _list_groups(validated: Validation) -> list[Row]:
    """Return the errors by group."""
    residuals = validated.fit.residuals
    quantities = dict.fromkeys(residual["what"] for residual in residuals)
    rows: list[Row] = []
    for group in dict.fromkeys(validated.fit.problem.groups):
        for quantity in quantities:
            key = (group, quantity)
            members = [
                residual for residual in residuals if (residual["group"], residual["what"]) == key
            ]
            if members:
                rows.append(_group_row(group, quantity, members))
    return rows


def _group_row(group: str, quantity: str, residuals: Sequence[Row]) -> Row:
    """Return the errors of a group's measurements of one quantity."""
    mean_error: float | None = None
    signed_error: float | None = None
    errors = [residual["off [%]"] for residual in residuals if residual["measured"]]
    if errors:
        mean_error = float(np.mean(np.abs(errors)))
        signed_error = float(np.mean(errors))
    deviations = np.array([residual[RESIDUAL] for residual in residuals])
    return {
        "group": group,
        "what": quantity,
        "measurements": len(residuals),
        "mean error [%]": mean_error,
        "mean with sign [%]": signed_error,
        RESIDUAL: float(np.sqrt(np.mean(deviations**2))),
    }


def list_errors(fits: Mapping[str, Validation]) -> list[Row]:
    """Return mean errors of the speeds, fitted and left out, of fits to the same measurements and of null models.

    Args:
        fits: At least one fit, by its name in the table.
    """
    rows: list[Row] = []
    for name, validated in fits.items():
        row = _error_row(
            name,
            n_numbers=len(validated.fit.estimates),
            chi2=validated.fit.chi2,
            errors=validated.errors,
        )
        rows.append(row)
    first = next(iter(fits.values()))
    for null_model in first.null_models:
        errors = {name: getattr(null_model, name) for name in ERROR_COLUMNS}
        row = _error_row(
            f"null model: {null_model.name}",
            n_numbers=null_model.n_parameters,
            chi2=None,
            errors=errors,
        )
        rows.append(row)
    return rows


def _error_row(
    model: str, *, n_numbers: int, chi2: float | None, errors: Mapping[str, float | None]
) -> Row:
    row: Row = {"model": model, "numbers fitted": n_numbers, "chi^2": chi2}
    for name, column in ERROR_COLUMNS.items():
        row[column] = errors[name]
    return row


def _list_searches(validated: Validation) -> list[Row]:
    """Return where every search began and ended."""
    fit = validated.fit
    rows: list[Row] = []
    for number, search in enumerate(fit.searches, start=1):
        row: Row = {
            "start": number,
            "sum of squares": search.cost,
            "ended by itself": search.converged,
        }
        first_values = fit.problem.values_of(search.start)
        last_values = fit.problem.values_of(search.end)
        for index in fit.problem.of_interest:
            name = fit.problem.names[index]
            unit = fit.estimates[index].unit or "-"
            row[f"{name}, from [{unit}]"] = first_values[index]
            row[f"{name}, to [{unit}]"] = last_values[index]
        rows.append(row)
    return rows


def _list_correlations(validated: Validation) -> list[Row]:
    """Return the correlation matrix."""
    names = validated.fit.problem.names
    matrix: list[list[Any]] = validated.fit.correlations.tolist()
    rows: list[Row] = []
    for name, correlations in zip(names, matrix, strict=True):
        row: Row = {"parameter": name}
        row.update(zip(names, correlations, strict=True))
        rows.append(row)
    return rows
