"""An identification for readers: identify.html, the parameter file, figures, tables and fit.json in one folder."""

import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda import __version__
from laticauda.identify import Fit, compared_with_null_models, leave_out, linear_leave_one_out, profile
from laticauda.identify.tasks import Task
from laticauda.identify.uncertainty import Profile
from laticauda.identify.validation import LeftOut, NullModel, figure_places
from laticauda.reports.chapter import Chapter, Pictures, write_chapter
from laticauda.reports.identify_figures import figures_of, of_interest
from laticauda.reports.identify_tables import tables_of
from laticauda.reports.page import Heading, Paragraph, Part, Picture, Points, Section, page
from laticauda.reports.reproduce import writable_folder
from laticauda.reports.tables import Table
from laticauda.trial.null_models import mape

SPEED = "forward_velocity"


@dataclass(frozen=True, kw_only=True, eq=False)
class Checked:
    """A fit, and how it does on what it was not fitted to."""

    task: Task
    """What was asked for."""
    found: Fit
    """What was found."""
    left_out: Float[np.ndarray, " n_data"]
    """Every number as the others predict it."""
    is_linearized: bool
    """Whether that is by the linearized model, without refits."""
    by_group: LeftOut | None
    """The same by groups, always with refits; None if the others do not suffice, or it was not asked for."""
    null_models: tuple[NullModel, ...]
    """Models without physics on the same speeds."""
    profiles: tuple[Profile, ...]
    """Intervals from the likelihood itself, if asked for."""

    def error(self, predictions: Float[np.ndarray, " n_data"] | None, figure: str = SPEED) -> float | None:
        """Mean error of a figure, in percent; None without such measurements or predictions."""
        measured = {name for m in self.found.problem.measurements for name in m.figures}
        if predictions is None or figure not in measured:
            return None
        at = figure_places(self.found, figure)
        observed = self.found.problem.observed[at]
        if np.any(np.isnan(predictions[at])) or np.any(observed == 0.0):
            return None
        return mape(observed, predictions[at])


def checked(
    task: Task,
    found: Fit,
    *,
    exact: bool = False,
    by_group: bool = True,
    profiles: bool = False,
    progress: Callable[[str, float], None] | None = None,
) -> Checked:
    """How a fit does on what it was not fitted to.

    Args:
        task: What was asked for.
        found: What was found.
        exact: Whether every measurement is left out by a refit, instead of by the linearized model.
        by_group: Whether groups are left out, if there are several.
        profiles: Whether intervals are computed from the likelihood too.
        progress: Called now and then with what is going on, and the share of it that is finished.
    """

    def told(what: str) -> Callable[[float], None]:
        return lambda share: None if progress is None else progress(what, share)

    exact = exact and _suffices(found, [m.name for m in found.problem.measurements])
    single = (
        leave_out(found, progress=told("measurements left out")).predictions if exact else linear_leave_one_out(found)
    )
    groups = (
        leave_out(found, "group", progress=told("groups left out"))
        if by_group and _suffices(found, found.problem.groups)
        else None
    )
    kept: list[Profile] = []
    shown = of_interest(found) if profiles else []
    for done, k in enumerate(shown):
        kept.append(profile(found, found.estimates[k].name))
        if progress is not None:
            progress("profiles", (done + 1) / len(shown))
    return Checked(
        task=task,
        found=found,
        left_out=single,
        is_linearized=not exact,
        by_group=groups,
        null_models=compared_with_null_models(found),
        profiles=tuple(kept),
    )


def _suffices(found: Fit, names: Sequence[str]) -> bool:
    """Whether something is left to fit to, and enough of it, if what goes by any one of these names is left out."""
    put = found.problem
    n_free = sum(unknown.prior is None for unknown in put.unknowns) + (found.noise == "estimated")
    sizes = np.bincount(put.owner, minlength=len(names))
    most = max(sum(size for size, other in zip(sizes, names, strict=True) if other == name) for name in names)
    return len(set(names)) > 1 and put.observed.size - int(most) >= n_free


def write_identification(done: Checked, folder: str | Path, *, command: str = "") -> list[str]:
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
    (place / "fit.json").write_text(text + "\n", encoding="utf-8")
    tables = tables_of(done)
    chapter = Chapter(
        section=lambda pictures: Section(name="all", title="", parts=()),
        tables=tuple(tables.values()),
        figures=lambda: figures_of(done),
    )
    pictures: dict[str, tuple[str, bytes]] = {}
    files, _ = write_chapter(_keeping(chapter, pictures), place, lambda n: None)
    text = page(f"Identification: {done.task.title}", _introduction(done, command), _sections(done, tables, pictures))
    (place / "identify.html").write_text(text, encoding="utf-8")
    return ["identify.html", "parameters.toml", "fit.json", *files]


def _keeping(chapter: Chapter, kept: dict[str, tuple[str, bytes]]) -> Chapter:
    """The chapter, its pictures kept for a page of several sections."""

    def section(pictures: Pictures) -> Section:
        kept.update(pictures)
        return chapter.section(pictures)

    return Chapter(section=section, tables=chapter.tables, figures=chapter.figures)


def as_dict(done: Checked, command: str = "") -> dict[str, Any]:
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
        "joints": found.problem.options["joints"],
        "model": found.problem.model,
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


def _introduction(done: Checked, command: str) -> list[Part]:
    found, put = done.found, done.found.problem
    parts: list[Part] = [
        Paragraph(text=found.status),
        Paragraph(
            text=f"By the {put.model} model with {put.options['joints']} joints; the noise is "
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


def _sections(done: Checked, tables: dict[str, Table], pictures: Pictures) -> list[Section]:
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


def _left_out(done: Checked) -> Paragraph:
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
