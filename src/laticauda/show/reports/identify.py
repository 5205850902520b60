"""Results of an identification: identify.html, the parameter file, figures, tables and fit.json in one folder."""

import hashlib
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.identify import ParameterEstimate, Task, Validation
from laticauda.show.reports import chapter
from laticauda.show.reports.chapter import Row
from laticauda.values import extensions, packaging, to_json, to_plain, write

_PART = 0.3  # least weight of the parameters, as opposed to initial conditions, in a direction that is listed


def write_identification(done: Validation, folder: str | Path, *, command: str = "") -> list[str]:
    """Write parameters.toml, fit.json, tables, figures and identify.html.

    Args:
        done: Validated result of the identification.
        folder: Output folder, created if it does not exist; files of the same names are replaced.
        command: Command that made it, for the report; "" if it was not a command.

    Returns:
        Names of the files, the report first.

    Raises:
        ValueError: If the folder cannot be written.
        MissingExtra: If Jinja2 is not installed.
    """
    place = chapter.writable_folder(folder)
    done.task.parameters(done.fit).save(place / "parameters.toml")
    write(place / "fit.json", to_json(as_dict(done, command)) + "\n")
    files, html = chapter.write_chapter(identification_chapter(done, command), place)
    write(place / "identify.html", html)
    return ["identify.html", "parameters.toml", "fit.json", *files]


def identification_chapter(done: Validation, command: str = "") -> chapter.Chapter:
    """Return the whole page, with its tables and figures.

    Args:
        done: Validated result of the identification.
        command: Command that made it; "" if it was not a command.
    """
    from laticauda.show.reports.identify_figures import figures_of

    values, tables = {"done": done, **as_dict(done, command)}, identification_tables(done)
    return chapter.Chapter(
        name="identify", values=values, tables=tables, figures=lambda: figures_of(done)
    )


def as_dict(done: Validation, command: str = "") -> dict[str, Any]:
    """Return all results in the form of JSON, in SI units.

    Args:
        done: Validated result of the identification.
        command: Command that made it.
    """
    found = done.fit
    facts: dict[str, Any] = {
        "status": found.status,
        "parameters": [row | {"best": found.values[row["name"]]} for row in found.table()],
        "profiles": {**done.profiles},
        "correlations": {"names": found.problem.names, "matrix": found.correlations.tolist()},
        "directions": [
            {"name": one.name, "sigma": one.sigma, "is_seen": one.is_seen}
            for one in found.identifiability.directions
        ],
        "chi2": found.chi2,
        "noise_factor": found.noise_factor,
        "noise": found.method.noise,
        "confidence": found.method.confidence,
        "errors_percent": {
            **done.errors,
            "left_out_is_linearized": done.is_linearized,
            "null_models": [
                {"name": null.name, "n_parameters": null.n_parameters}
                | {name: getattr(null, name) for name in done.errors}
                for null in done.null_models
            ],
        },
        "starts": [
            {
                "start": found.problem.values_by_name(one.start),
                "end": found.problem.values_by_name(one.end),
                "cost": one.cost,
                "converged": one.converged,
            }
            for one in found.searches
        ],
        "warnings": list(found.warnings),
        "joints": extensions.name_of(type(found.problem.model.joints)),
        "model": extensions.name_of(type(found.problem.model)),
        "sources": sources_of(done.task),
        "command": command,
        "version": packaging.__version__,
    }
    return to_plain(facts)


def sources_of(task: Task) -> dict[str, str]:
    """Return the files from which a task was read, each with the beginning of its SHA-256.

    Args:
        task: Task of the identification.
    """
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest()[:16] for path in task.sources}


# ---- tables --------------------------------------------------------------------------------------


def identification_tables(done: Validation) -> dict[str, list[Row]]:
    """Return all tables by name, without empty ones.

    Args:
        done: Validated result of the identification.
    """
    rows = {
        "parameters": _parameters(done),
        "directions": _directions(done),
        "groups": _groups(done),
        "residuals": _residuals(done),
        "starts": _starts(done),
        "correlations": _correlations(done),
        "began": _began(done),
        "errors": [] if done.errors["fitted"] is None else errors_of({"this fit": done}),
    }
    return {name: found for name, found in rows.items() if found}


def _parameters(done: Validation) -> list[Row]:
    """Return the values of parameters, their uncertainties, and notes on them."""
    found = done.fit
    rows: list[Row] = []
    for k in found.problem.of_interest:
        unknown, estimate = found.problem.unknowns[k], found.estimates[k]
        low, high = estimate.interval or (None, None)
        tied = ", ".join(f"{name}^{power:g}" for name, power in unknown.tied.items())
        notes = (estimate.note.replace("`", ""), f"changes with it: {tied}" if tied else "")
        row = _value_of(estimate) | {
            f"{100 * found.method.confidence:g} % interval, low": low,
            "high": high,
        }
        if done.profiles:
            row |= dict(
                zip(("profile, low", "profile, high"), done.profiles[estimate.name], strict=True)
            )
        row["prior"] = (
            "none" if unknown.prior is None else f"{unknown.prior[0]:.4g} ± {unknown.prior[1]:.2g}"
        )
        row["range"] = f"{_end(unknown.lower)} to {_end(unknown.upper)}"
        row["note"] = "; ".join(filter(None, notes)) or "-"
        rows.append(row)
    return rows


def _value_of(one: ParameterEstimate) -> Row:
    value = one.value if one.is_identified else None
    return {
        "parameter": one.name,
        "value": value,
        "unit": one.unit or "-",
        "standard deviation": one.sigma,
    }


def _end(value: float) -> str:
    return chapter.in_digits(value, ".4g") if math.isfinite(value) else "any"


def _began(done: Validation) -> list[Row]:
    """Return the initial conditions of individual trials that were identified."""
    shown = done.fit.problem.of_interest
    return [_value_of(one) for k, one in enumerate(done.fit.estimates) if k not in shown]


def _directions(done: Validation) -> list[Row]:
    """Return how well the measurements determine combinations of parameters."""
    shown = done.fit.problem.of_interest
    return [
        {
            "combination": one.name.replace("`", ""),
            "standard deviation [-]": one.sigma,
            "seen": one.is_seen,
        }
        for one in done.fit.identifiability.directions
        if np.max(np.abs(one.weights[shown]), initial=0.0) > _PART
    ]


def _residuals(done: Validation) -> list[Row]:
    """Return every measurement with its prediction by this fit, and by the other measurements."""
    problem, rows = done.fit.problem, list[Row]()
    for row, place in zip(done.fit.residuals, problem.data_blocks, strict=True):
        without = None if place.is_series else float(done.left_out[place.numbers.start])
        first = {
            name: row[name]
            for name in ("group", "measurement", "what", "unit", "measured", "predicted")
        }
        rows.append(first | {"left out": without} | row)
    return sorted(rows, key=lambda row: problem.groups.index(row["group"]))


def _groups(done: Validation) -> list[Row]:
    """Return the errors by group."""
    rows: list[Row] = []
    residuals = done.fit.residuals
    for group, what in dict.fromkeys(
        (group, row["what"]) for group in done.fit.problem.groups for row in residuals
    ):
        mine = [row for row in residuals if (row["group"], row["what"]) == (group, what)]
        shares = [row["off [%]"] for row in mine if row["measured"]]
        if mine:
            row: Row = {"group": group, "what": what, "measurements": len(mine)}
            row["mean error [%]"] = float(np.mean(np.abs(shares))) if shares else None
            row["mean with sign [%]"] = float(np.mean(shares)) if shares else None
            off = np.array([row["in standard deviations [-]"] for row in mine])
            rows.append(row | {"in standard deviations [-]": float(np.sqrt(np.mean(off**2)))})
    return rows


def errors_of(every: Mapping[str, Validation]) -> list[Row]:
    """Return mean errors of the speeds, fitted and left out, of fits to the same measurements and of null models.

    Args:
        every: At least one fit, by its name in the table.
    """
    models: list[tuple[Any, ...]] = []
    for name, done in every.items():
        models.append((name, len(done.fit.estimates), done.fit.chi2, *done.errors.values()))
    first = next(iter(every.values()))
    for null in first.null_models:
        errors = [getattr(null, name) for name in first.errors]
        models.append((f"null model: {null.name}", null.n_parameters, None, *errors))
    heads = (
        "model",
        "numbers fitted",
        "chi^2",
        "fitted [%]",
        "measurement left out [%]",
        "group left out [%]",
    )
    return [dict(zip(heads, model, strict=True)) for model in models]


def _starts(done: Validation) -> list[Row]:
    """Return where every search began and ended."""
    problem = done.fit.problem
    return [
        {"start": i + 1, "sum of squares": one.cost, "ended by itself": one.converged}
        | {
            f"{problem.names[k]}, {word} [{done.fit.estimates[k].unit or '-'}]": problem.values_of(
                x
            )[k]
            for k in problem.of_interest
            for word, x in (("from", one.start), ("to", one.end))
        }
        for i, one in enumerate(done.fit.searches)
    ]


def _correlations(done: Validation) -> list[Row]:
    """Return the correlation matrix."""
    names = done.fit.problem.names
    rows = zip(names, done.fit.correlations.tolist(), strict=True)
    return [{"parameter": name} | dict(zip(names, row, strict=True)) for name, row in rows]
