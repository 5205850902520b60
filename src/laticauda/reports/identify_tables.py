"""Tables of an identification's report."""

import math

import numpy as np

from laticauda.identify.validation import Validation
from laticauda.reports.tables import Cell, Column, Table, in_digits

_PART = 0.3  # of a direction that is in the parameters, and not in where trials began


def tables_of(done: Validation) -> dict[str, Table]:
    """All of them by name.

    Args:
        done: What was found.
    """
    tables = [parameters_table(done), directions_table(done), groups_table(done), residuals_table(done)]
    tables += [starts_table(done), correlations_table(done)]
    if len(done.found.problem.of_interest) < len(done.found.estimates):
        tables.append(began_table(done))
    if done.error(done.found.predictions) is not None:
        tables.append(errors_table(done))
    return {table.name: table for table in tables}


def parameters_table(done: Validation) -> Table:
    """Values, uncertainties and what is to be known about them."""
    found = done.found
    profiles = {one.name: one for one in done.profiles}
    percent = f"{100 * found.confidence:g} %"
    columns = [
        Column(name="parameter"),
        Column(name="value", form=".4g"),
        Column(name="unit"),
        Column(name="standard deviation", form=".2g"),
        Column(name=f"{percent} interval, low", form=".4g"),
        Column(name="high", form=".4g"),
    ]
    if profiles:
        columns += [Column(name="profile, low", form=".4g"), Column(name="profile, high", form=".4g")]
    columns += [Column(name="prior"), Column(name="range"), Column(name="note", wraps=True)]
    rows: list[tuple[Cell, ...]] = []
    for k in found.problem.of_interest:
        unknown, estimate = found.problem.unknowns[k], found.estimates[k]
        low, high = estimate.interval or (None, None)
        value = estimate.value if estimate.is_identified else None
        row: list[Cell] = [estimate.name, value, estimate.unit or "-", estimate.sigma, low, high]
        if profiles:
            row += [profiles[estimate.name].low, profiles[estimate.name].high]
        prior = "none" if unknown.prior is None else f"{unknown.prior[0]:.4g} ± {unknown.prior[1]:.2g}"
        note = estimate.note.replace("`", "")
        if unknown.tied:
            tied = ", ".join(f"{name}^{power:g}" for name, power in unknown.tied.items())
            note = "; ".join(part for part in (note, f"with it change: {tied}") if part)
        rows.append((*row, prior, f"{_end(unknown.lower)} to {_end(unknown.upper)}", note or "-"))
    return Table(
        name="parameters",
        caption="What was identified; NA: not identified. Standard deviations and intervals are from the covariance, "
        "on a log scale for numbers that are greater than 0.",
        columns=tuple(columns),
        rows=tuple(rows),
    )


def began_table(done: Validation) -> Table:
    """Where single trials began, as far as it was identified."""
    found = done.found
    shown = [k for k in range(len(found.estimates)) if k not in found.problem.of_interest]
    return Table(
        name="began",
        caption="Where the trials began, to be added to what their files say: identified because a first sample has "
        "noise as all others have.",
        columns=(
            Column(name="parameter"),
            Column(name="value", form=".2g"),
            Column(name="unit"),
            Column(name="standard deviation", form=".2g"),
        ),
        rows=tuple(
            (one.name, one.value if one.is_identified else None, one.unit, one.sigma)
            for one in (found.estimates[k] for k in shown)
        ),
    )


def _end(value: float) -> str:
    return in_digits(value, ".4g") if math.isfinite(value) else "any"


def directions_table(done: Validation) -> Table:
    """What the measurements see of combinations."""
    shown = done.found.problem.of_interest
    directions = [
        one for one in done.found.identifiability.directions if np.max(np.abs(one.weights[shown]), initial=0.0) > _PART
    ]
    return Table(
        name="directions",
        caption="Standard deviation of a combination as a share of itself, by the measurements alone, without priors.",
        columns=(
            Column(name="combination", wraps=True),
            Column(name="standard deviation [-]", form=".2g"),
            Column(name="seen"),
        ),
        rows=tuple(
            (one.name.replace("`", ""), one.sigma if math.isfinite(one.sigma) else None, one.is_seen)
            for one in directions
        ),
    )


def residuals_table(done: Validation) -> Table:
    """Every measurement beside its prediction."""
    left_out = _left_out(done)
    return Table(
        name="residuals",
        grouped=True,
        caption="Predicted less measured: of a figure, in its unit and in standard deviations of the noise as stated; "
        "of a series, the root mean square.",
        columns=(
            Column(name="group"),
            Column(name="measurement"),
            Column(name="what"),
            Column(name="unit"),
            Column(name="measured", form=".4g"),
            Column(name="predicted", form=".4g"),
            Column(name="left out", form=".4g"),
            Column(name="off", form="+.3g"),
            Column(name="off [%]", form="+.1f"),
            Column(name="in standard deviations [-]", form="+.2f"),
        ),
        rows=tuple(
            (
                one.group,
                one.measurement,
                one.what.replace("_", " "),
                one.unit or "-",
                one.measured,
                one.predicted,
                left_out.get((one.measurement, one.what)),
                one.deviation,
                100.0 * one.deviation / one.measured if one.measured else None,
                one.in_sigmas,
            )
            for one in sorted(done.found.residuals, key=lambda one: done.found.problem.groups.index(one.group))
        ),
    )


def _left_out(done: Validation) -> dict[tuple[str, str], float | None]:
    """Figures as the others predict them."""
    found: dict[tuple[str, str], float | None] = {}
    at = 0
    for measurement in done.found.problem.measurements:
        for name in measurement.figures:
            value = float(done.left_out[at])
            found[measurement.name, name] = value if math.isfinite(value) else None
            at += 1
        at += sum(values.size for values, _ in measurement.series.values())
    return found


def groups_table(done: Validation) -> Table:
    """Errors by group."""
    rows: list[tuple[Cell, ...]] = []
    residuals = done.found.residuals
    for group in dict.fromkeys(done.found.problem.groups):
        for what in dict.fromkeys(one.what for one in residuals if one.group == group):
            mine = [one for one in residuals if one.group == group and one.what == what]
            shares = [one.deviation / one.measured for one in mine if one.measured]
            rows.append(
                (
                    group,
                    what.replace("_", " "),
                    len(mine),
                    100.0 * float(np.mean(np.abs(shares))) if shares else None,
                    100.0 * float(np.mean(shares)) if shares else None,
                    float(np.sqrt(np.mean([one.in_sigmas**2 for one in mine]))),
                )
            )
    return Table(
        name="groups",
        caption="By group: mean of the relative errors of a figure, with and without their signs, and root mean square "
        "in standard deviations of the noise as stated.",
        columns=(
            Column(name="group"),
            Column(name="what"),
            Column(name="measurements"),
            Column(name="mean error [%]", form=".1f"),
            Column(name="mean with sign [%]", form="+.1f"),
            Column(name="in standard deviations [-]", form=".2f"),
        ),
        rows=tuple(rows),
    )


def errors_table(done: Validation) -> Table:
    """Mean errors of the speeds, fitted and left out, beside null models."""
    n, by_group = len(done.found.estimates), done.by_group
    rows: list[tuple[Cell, ...]] = [
        (
            "this fit",
            n,
            done.error(done.found.predictions),
            done.error(done.left_out),
            done.error(None if by_group is None else by_group.predictions),
        )
    ]
    for null in done.null_models:
        left = [value if math.isfinite(value) else None for value in (null.left_out, null.group_left_out)]
        rows.append((f"null model: {null.name}", null.n_parameters, null.fitted, *left))
    return Table(
        name="errors",
        caption="Mean error of the forward velocity [%]: of what was fitted, with each measurement left out, and with "
        "each group left out.",
        columns=(
            Column(name="model"),
            Column(name="numbers fitted"),
            Column(name="fitted [%]", form=".1f"),
            Column(name="measurement left out [%]", form=".1f"),
            Column(name="group left out [%]", form=".1f"),
        ),
        rows=tuple(rows),
    )


def starts_table(done: Validation) -> Table:
    """Where every search began and ended."""
    every = done.found.problem.names
    names = [every[k] for k in done.found.problem.of_interest]
    columns = [Column(name="start"), Column(name="sum of squares", form=".5g"), Column(name="ended by itself")]
    columns += [Column(name=f"{name}, {word}", form=".4g") for name in names for word in ("from", "to")]
    return Table(
        name="starts",
        caption="Every start of the search, the best first.",
        columns=tuple(columns),
        rows=tuple(
            (
                i + 1,
                one.cost,
                one.converged,
                *(value for name in names for value in (one.start[name], one.end[name])),
            )
            for i, one in enumerate(done.found.searches)
        ),
    )


def correlations_table(done: Validation) -> Table:
    """The matrix."""
    names = done.found.problem.names
    return Table(
        name="correlations",
        caption="Correlations of the parameters.",
        columns=(Column(name="parameter"), *(Column(name=name, form=".2f") for name in names)),
        rows=tuple(
            (name, *(value if math.isfinite(value) else None for value in row))
            for name, row in zip(names, done.found.correlations.tolist(), strict=True)
        ),
    )
