"""Results of an identification: identify.html, the parameter file, figures, tables and fit.json in one folder."""

import functools
import hashlib
from pathlib import Path
from typing import Any

from laticauda import scenarios
from laticauda.identify import (
    KEY_OF_BASIS,
    SCENARIO_FILE,
    Fit,
    Task,
    Validation,
    basis_of,
    first_scenario,
    list_assumptions,
    with_checksum,
)
from laticauda.robot import to_toml
from laticauda.show.reports.chapter import Chapter, make_writable_folder, write_chapter
from laticauda.show.reports.identify_tables import list_identification_tables
from laticauda.values import BadArgument, extensions, packaging, to_json, to_plain, write

ROBOT_FILE = "robot.toml"
"""Name of the robot's file, where a parameter file does not do."""
DIGEST_DIGITS = 16
"""Hexadecimal digits of a file's SHA-256 that are shown [-]."""


def write_identification(
    validated: Validation, folder: str | Path, *, command: str = ""
) -> list[str]:
    """Write parameters.toml, scenario.toml, fit.json, tables, figures and identify.html.

    If the robot has identified numbers that a parameter file cannot hold, its file is written, too.

    Args:
        validated: Validated result of the identification.
        folder: Output folder, created if it does not exist; files of the same names are replaced.
        command: Command that made it, for the report; "" if it was not a command.

    Returns:
        Names of the files, the report first.

    Raises:
        ValueError: If the folder cannot be written.
        MissingExtra: If Jinja2 is not installed.
    """
    output_folder = make_writable_folder(folder)
    parameters = validated.task.parameters(validated.fit)
    parameters.save(output_folder / "parameters.toml")
    fit = validated.fit
    first_trial = first_scenario(fit)
    scenarios.save_scenario(first_trial, output_folder / SCENARIO_FILE)
    further_files: list[str] = []
    if any(name.startswith("robot.") for name in fit.beyond_parameter_file):
        write(output_folder / ROBOT_FILE, to_toml(first_trial.robot))
        further_files.append(ROBOT_FILE)
    results = describe_identification(validated, command)
    results[KEY_OF_BASIS] = _describe_basis(validated)
    write(output_folder / "fit.json", to_json(with_checksum(results)) + "\n")
    chapter = build_identification_chapter(validated, command)
    file_names, html = write_chapter(chapter, output_folder)
    write(output_folder / "identify.html", html)
    return [
        "identify.html",
        "parameters.toml",
        "fit.json",
        SCENARIO_FILE,
        *further_files,
        *file_names,
    ]


def build_identification_chapter(validated: Validation, command: str = "") -> Chapter:
    """Return the whole page, with its tables and figures.

    Args:
        validated: Validated result of the identification.
        command: Command that made it; "" if it was not a command.
    """
    from laticauda.show.reports.identify_figures import draw_identification_figures

    return Chapter(
        name="identify",
        values={"validated": validated, **describe_identification(validated, command)},
        tables=list_identification_tables(validated),
        figures=functools.partial(draw_identification_figures, validated),
    )


def describe_identification(validated: Validation, command: str = "") -> dict[str, Any]:
    """Return all results in the form of JSON, in SI units.

    Args:
        validated: Validated result of the identification.
        command: Command that made it.
    """
    fit = validated.fit
    model = fit.problem.model
    results: dict[str, Any] = {
        "status": fit.status,
        "parameters": _describe_parameters(fit),
        "profiles": dict(validated.profiles),
        "correlations": {"names": fit.problem.names, "matrix": fit.correlations.tolist()},
        "directions": _describe_directions(fit),
        "chi2": fit.chi2,
        "noise_factor": fit.noise_factor,
        "noise": fit.method.noise,
        "confidence": fit.method.confidence,
        "errors_percent": _describe_errors(validated),
        "starts": _describe_searches(fit),
        "model_in_doubt": fit.is_model_doubted,
        "other_laws": _describe_rivals(fit),
        "warnings": list(fit.warnings),
        "assumed": list(list_assumptions(fit.problem)),
        "joints": extensions.name_of(type(model.joints)),
        "model": extensions.name_of(type(model)),
        "sources": digest_sources(validated.task),
        "command": command,
        "version": packaging.__version__,
    }
    return to_plain(results)


def _describe_basis(validated: Validation) -> dict[str, Any] | None:
    """Return what predictions need; None if the fitted numbers do not hold for other trials."""
    try:
        return basis_of(validated.fit, validated.by_group).to_table()
    except BadArgument:
        return None


def _describe_parameters(fit: Fit) -> list[dict[str, Any]]:
    values = fit.values
    rows: list[dict[str, Any]] = []
    for row in fit.table():
        best_value = {"best": values[row["name"]]}
        rows.append(row | best_value)
    return rows


def _describe_directions(fit: Fit) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = []
    for direction in fit.identifiability.directions:
        row = {"name": direction.name, "sigma": direction.deviation, "is_seen": direction.is_seen}
        rows.append(row)
    return rows


def _describe_errors(validated: Validation) -> dict[str, Any]:
    """Return the errors of the fit and of the null models [%]."""
    errors = validated.errors
    null_models: list[dict[str, Any]] = []
    for null_model in validated.null_models:
        row: dict[str, Any] = {
            "name": null_model.name,
            "n_parameters": null_model.n_parameters,
        }
        for name in errors:
            row[name] = getattr(null_model, name)
        null_models.append(row)
    return {
        **errors,
        "left_out_is_linearized": validated.is_linearized,
        "null_models": null_models,
    }


def _describe_rivals(fit: Fit) -> dict[str, float]:
    """Return what other laws leave of the residuals, in units of the stated noise."""
    if fit.doubt is None:
        return {}
    return dict(fit.doubt.rivals)


def _describe_searches(fit: Fit) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = []
    for search in fit.searches:
        row = {
            "start": fit.problem.values_by_name(search.start),
            "end": fit.problem.values_by_name(search.end),
            "cost": search.cost,
            "converged": search.converged,
        }
        rows.append(row)
    return rows


def digest_sources(task: Task) -> dict[str, str]:
    """Return the files from which a task was read, each with the beginning of its SHA-256.

    Args:
        task: Task of the identification.
    """
    digests: dict[str, str] = {}
    for path in task.sources:
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        digests[path.name] = digest[:DIGEST_DIGITS]
    return digests
