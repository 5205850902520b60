"""An identification for readers: identify.html, the parameter file, figures, tables and fit.json in one folder."""

import hashlib
import json
from pathlib import Path
from typing import Any

from laticauda.extensions import name_of
from laticauda.files import write
from laticauda.identify.tasks import Task
from laticauda.identify.validation import Validation
from laticauda.packaging import __version__
from laticauda.reports.chapter import Chapter, writable_folder, write_chapter
from laticauda.reports.identify_figures import figures_of
from laticauda.reports.identify_tables import finite, identification_tables


def write_identification(done: Validation, folder: str | Path, *, command: str = "") -> list[str]:
    """Write parameters.toml, fit.json, tables, figures and identify.html.

    Args:
        done: What was found.
        folder: Made if it does not exist; files of the same names are replaced.
        command: What made it, for the report; "" if it was no command.

    Returns:
        Names of the files, the report first.

    Raises:
        ValueError: If the folder cannot be written.
        MissingExtra: If Jinja2 is not installed.
    """
    place = writable_folder(folder)
    done.task.parameters(done.found).save(place / "parameters.toml")
    write(place / "fit.json", json.dumps(as_dict(done, command), indent=2, allow_nan=False) + "\n")
    files, html = write_chapter(identification_chapter(done, command), place)
    write(place / "identify.html", html)
    return ["identify.html", "parameters.toml", "fit.json", *files]


def identification_chapter(done: Validation, command: str = "") -> Chapter:
    """The whole page, with its tables and figures.

    Args:
        done: What was found.
        command: What made it; "" if it was no command.
    """
    found = done.found
    values = {
        "task": done.task,
        "found": found,
        "model": name_of(type(found.problem.model)),
        "joints": name_of(type(found.problem.model.joints)),
        "is_linearized": done.is_linearized,
        "by_group": done.by_group is not None,
        "command": command,
        "version": __version__,
        "sources": sources_of(done.task),
    }
    tables = identification_tables(done)
    return Chapter(name="identify", values=values, tables=tables, figures=lambda: figures_of(done))


def as_dict(done: Validation, command: str = "") -> dict[str, Any]:
    """Everything that was found, as JSON has it, in SI units.

    Args:
        done: What was found.
        command: What made it.
    """
    found = done.found
    profiles = {one.name: [one.low, one.high] for one in done.profiles}
    return {
        "status": found.status,
        "parameters": [row | {"best": found.values[row["name"]]} for row in found.table()],
        "profiles": profiles,
        "correlations": {
            "names": list(found.problem.names),
            "matrix": [[finite(value) for value in row] for row in found.correlations.tolist()],
        },
        "directions": [
            {"name": one.name, "sigma": finite(one.sigma), "is_seen": one.is_seen}
            for one in found.identifiability.directions
        ],
        "chi2": found.chi2,
        "noise_factor": finite(found.noise_factor),
        "noise": found.method.noise,
        "confidence": found.method.confidence,
        "errors_percent": {
            "fitted": done.error(found.predictions),
            "left_out": done.error(done.left_out),
            "left_out_is_linearized": done.is_linearized,
            "group_left_out": done.error(None if done.by_group is None else done.by_group.predictions),
            "null_models": [
                {
                    "name": null.name,
                    "n_parameters": null.n_parameters,
                    "fitted": null.fitted,
                    "left_out": finite(null.left_out),
                    "group_left_out": finite(null.group_left_out),
                }
                for null in done.null_models
            ],
        },
        "starts": [
            {"start": dict(s.start), "end": dict(s.end), "cost": finite(s.cost), "converged": s.converged}
            for s in found.searches
        ],
        "warnings": list(found.warnings),
        "joints": name_of(type(found.problem.model.joints)),
        "model": name_of(type(found.problem.model)),
        "sources": sources_of(done.task),
        "command": command,
        "version": __version__,
    }


def sources_of(task: Task) -> dict[str, str]:
    """The files that a task was read from, each with the begin of its SHA-256.

    Args:
        task: What was asked for.
    """
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest()[:16] for path in task.sources}
