"""An identification for readers: identify.html, the parameter file, figures, tables and fit.json in one folder."""

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.extensions import name_of
from laticauda.files import write
from laticauda.identify.tasks import Task
from laticauda.identify.validation import Validation
from laticauda.packaging import __version__
from laticauda.reports.chapter import Chapter, Pictures, writable_folder, write_chapter
from laticauda.reports.identify_figures import figures_of
from laticauda.reports.identify_tables import tables_of
from laticauda.reports.page import Heading, Paragraph, Part, Picture, Points, Section, page
from laticauda.reports.tables import Table


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
    """
    place = writable_folder(folder)
    done.task.parameters(done.found).save(place / "parameters.toml")
    text = json.dumps(as_dict(done, command), indent=2, allow_nan=False)
    write(place / "fit.json", text + "\n")
    tables = tables_of(done)
    chapter = Chapter(
        section=lambda pictures: Section(name="all", title="", parts=()),
        tables=tuple(tables.values()),
        figures=lambda: figures_of(done),
    )
    pictures: dict[str, tuple[str, bytes]] = {}
    files, _ = write_chapter(_keeping(chapter, pictures), place, lambda n: None)
    text = page(f"Identification: {done.task.title}", _introduction(done, command), _sections(done, tables, pictures))
    write(place / "identify.html", text)
    return ["identify.html", "parameters.toml", "fit.json", *files]


def _keeping(chapter: Chapter, kept: dict[str, tuple[str, bytes]]) -> Chapter:
    """The chapter, its pictures kept for a page of several sections."""

    def section(pictures: Pictures) -> Section:
        kept.update(pictures)
        return chapter.section(pictures)

    return Chapter(section=section, tables=chapter.tables, figures=chapter.figures)


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
            "matrix": [[_finite(value) for value in row] for row in found.correlations.tolist()],
        },
        "directions": [
            {"name": one.name, "sigma": _finite(one.sigma), "is_seen": one.is_seen}
            for one in found.identifiability.directions
        ],
        "chi2": found.chi2,
        "noise_factor": _finite(found.noise_factor),
        "noise": found.noise,
        "confidence": found.confidence,
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
                    "left_out": _finite(null.left_out),
                    "group_left_out": _finite(null.group_left_out),
                }
                for null in done.null_models
            ],
        },
        "starts": [
            {"start": dict(s.start), "end": dict(s.end), "cost": _finite(s.cost), "converged": s.converged}
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


def _plain(text: str) -> str:
    """A sentence without the marks around names."""
    return text.replace("`", "")


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _introduction(done: Validation, command: str) -> list[Part]:
    found, put = done.found, done.found.problem
    parts: list[Part] = [
        Paragraph(text=found.status),
        Paragraph(
            text=f"By the {name_of(type(put.model))} model with {name_of(type(put.model.joints))} joints; the noise is "
            + (
                "taken as stated."
                if found.noise == "known"
                else f"estimated from the residuals, {found.noise_factor:.2g} times what the measurements state."
            )
        ),
    ]
    if found.warnings:
        parts.append(Points(texts=tuple(_plain(text) for text in found.warnings)))
    made = [f"Made with laticauda {__version__}."]
    if command:
        made.insert(0, f"Command: {command}")
    made += [f"{name}, SHA-256 {digest}..." for name, digest in sources_of(done.task).items()]
    parts.append(Points(texts=tuple(made)))
    return parts


def _sections(done: Validation, tables: dict[str, Table], pictures: Pictures) -> list[Section]:
    found = done.found
    identified: list[Part] = [
        Paragraph(
            text="parameters.toml beside this page holds these values and all that was fixed; swim, follow, sweep, "
            "optimize and reproduce take it with --parameters. Where a parameter is not identified, it holds one of "
            "the many values that describe the measurements as well."
        ),
        tables["parameters"],
        *_shown(pictures, "intervals"),
        *_shown(pictures, "correlations"),
    ]
    seen: list[Part] = [
        Paragraph(
            text="Combinations of the parameters from the one that the measurements see best to the one that they see "
            "worst: products of powers, each known to a share of itself. "
            + (_plain(" ".join(found.identifiability.words)) or "The measurements see all of them.")
        ),
        tables["directions"],
    ]
    fits: list[Part] = [*_shown(pictures, "parity"), *_shown(pictures, "residuals"), tables["groups"]]
    fits += [Heading(text="Every measurement"), tables["residuals"]]
    sections = [
        Section(name="parameters", title="Parameters", parts=tuple(identified)),
        Section(name="seen", title="What the measurements see", parts=tuple(seen)),
        Section(name="fit", title="How well they are described", parts=tuple(fits)),
    ]
    if "errors" in tables:
        sections.append(Section(name="left-out", title="What was left out", parts=(_left_out(done), tables["errors"])))
    search: tuple[Part, ...] = (
        Paragraph(
            text=f"{found.n_agreeing} of {len(found.searches)} starts came to the same sum of squares. Starts that end "
            "elsewhere are other minima, or ranges that stopped them."
        ),
        tables["starts"],
    )
    search += (tables["began"],) if "began" in tables else ()
    return [*sections, Section(name="starts", title="Where the search began and ended", parts=search)]


def _left_out(done: Validation) -> Paragraph:
    how = "the linearized model, without refits" if done.is_linearized else "a refit to all others"
    words = "A model that interpolates is no model: each measurement predicted by " + how
    words += ", each group by a refit to the other groups" if done.by_group is not None else ""
    return Paragraph(
        text=words
        + "; beside it, models without any physics on the same speeds. What does not beat them when something "
        "is left out explains nothing."
    )


def _shown(pictures: Pictures, name: str) -> Sequence[Part]:
    if name not in pictures:
        return ()
    caption, png = pictures[name]
    return (Picture(png=png, caption=caption, description=caption),)
