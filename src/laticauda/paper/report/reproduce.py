"""The paper in one call: run its studies, and write everything into one folder."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, Unpack

from laticauda import robot, scenarios
from laticauda.models.simulate import silent
from laticauda.paper import runs, settings, side_trials
from laticauda.paper.claims import Claim, load_claims
from laticauda.paper.efficiency import run_efficiency
from laticauda.paper.path_following import run_path_following
from laticauda.paper.repeats import Repeat
from laticauda.paper.report import efficiency, path_following
from laticauda.paper.report.chapter import load_paper_templates
from laticauda.paper.report.overview import (
    build_claims_chapter,
    build_summary_chapter,
    build_trust_chapter,
    judge_with_own_models,
)
from laticauda.paper.report.workers import Progress, run_studies
from laticauda.show.reports import Chapter, make_writable_folder, write_chapter
from laticauda.values import check_choice, check_whole_number, packaging, write

RUNS: Mapping[str, Callable[..., Any]] = {
    "path_following": run_path_following,
    "efficiency": run_efficiency,
    "side": side_trials.run_side_trials,
}
"""Functions that run the studies, by name in `Experiments`.

The longest is first, which fills workers best.
"""
HALVES: Mapping[str, tuple[str, ...]] = {
    "efficiency": ("efficiency", "side"),
    "path-following": ("path_following",),
}
"""The studies that belong to each half of the paper."""
TITLE = (
    "Underwater snake robots with and without a caudal fin: the paper's experiments in simulation"
)


class StudyChapter(NamedTuple):
    """A study's own part of the report."""

    title: str
    """Title on the page."""
    build: Callable[..., Chapter]
    """Function that returns the chapter from the results of the study."""
    shows_repeats: bool = False
    """Whether `build` also takes repeated measurements."""


CHAPTERS: Mapping[str, StudyChapter] = {
    "efficiency": StudyChapter(
        title="Locomotion efficiency",
        build=efficiency.build_efficiency_chapter,
        shows_repeats=True,
    ),
    "path_following": StudyChapter(
        title="Path following",
        build=path_following.build_path_following_chapter,
    ),
}
"""Studies that have their own part of the report, in its order."""


@dataclass(frozen=True, kw_only=True)
class Experiments:
    """Settings of every study; by default the paper's where it has any."""

    efficiency: settings.EfficiencySettings = field(
        default_factory=settings.load_efficiency_settings
    )
    """Figs. 4 to 11 and Table 1."""
    side: side_trials.SideSettings = field(default_factory=side_trials.SideSettings)
    """Individual facts on which claims of the paper are based."""
    path_following: settings.PathFollowingSettings = field(
        default_factory=settings.load_path_following_settings
    )
    """Figs. 12 to 23 and Table 2."""


def plan_experiments(parameters: robot.Parameters | None = None) -> Experiments:
    """Return the settings of a complete reproduction.

    Args:
        parameters: Coefficients to use instead of the paper's, with their changes to the robots;
            the efficiency study also keeps the paper's, with unchanged robots. None uses the
            paper's.
    """
    experiments = Experiments()
    if parameters is None:
        return experiments
    coefficients = runs.Coefficients.of(parameters)
    models = [model for model in experiments.efficiency.models if model.name != coefficients.name]
    return Experiments(
        efficiency=replace(experiments.efficiency, models=(coefficients, *models)),
        side=replace(experiments.side, coefficients=coefficients),
        path_following=replace(experiments.path_following, coefficients=coefficients),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Reproduction:
    """What was run and written."""

    folder: Path
    """Folder that holds everything."""
    files: tuple[str, ...]
    """Names of the files in it."""
    results: Mapping[str, Any]
    """Results of the studies that were run, by their names in `Experiments`."""
    claims: tuple[Claim, ...]
    """The paper's claims, judged by these results."""
    own_claims: Mapping[str, tuple[Claim, ...]] = field(
        default_factory=dict[str, tuple[Claim, ...]]
    )
    """The same, judged with each of the project's own models."""


def reproduce(
    folder: str | Path,
    settings: Experiments | None = None,
    *,
    only: str | None = None,
    model: scenarios.Model | str = "planar",
    repeats: Sequence[Repeat] = (),
    workers: int = 1,
    progress: Progress = silent,
    **changes: Unpack[scenarios.ModelChanges],
) -> Reproduction:
    """Run the paper's studies and write everything into a folder.

    Args:
        folder: Output folder, created if it does not exist; files of the same names are replaced,
            others left alone.
        settings: Settings of all studies; None uses the paper's. For other coefficients, see
            `plan_experiments`.
        only: One of `HALVES`; None runs all studies.
        model: Model, or its name.
        repeats: Repeated measurements, shown on the figures of the efficiency study
            (`load_repeats`).
        workers: Number of processes among which the studies are divided. More than 1 requires a
            script whose main part is under ``if __name__ == "__main__":``, as do all of Python's
            process pools.
        progress: Called from time to time with the current activity, the amount done and the total.
        changes: Differences from the model's defaults.

    Returns:
        What was run and written.

    Raises:
        ValueError: If an argument is out of its range, or the folder cannot be written; nothing is
            run in that case.
        MissingExtra: If Jinja2 is not installed; nothing is run in that case.
        SimulationFailed: If a trial blows up.
    """
    if only is not None:
        check_choice("only", only, tuple(HALVES))
    check_whole_number("workers", workers, 1)
    folder = make_writable_folder(folder)
    load_paper_templates()  # raises an error before anything is run if Jinja2 is missing
    settings = settings or Experiments()
    chosen_model = scenarios.model_of(model, **changes)

    names = [name for name in RUNS if only is None or name in HALVES[only]]
    run_study = partial(_run_study, settings, chosen_model, folder, repeats)
    outcomes = run_studies(run_study, names, workers, progress)

    results = {name: outcome.study for name, outcome in outcomes.items()}
    claims = load_claims(*results.values())
    own_claims = judge_with_own_models(results)
    files = _write_report(
        folder,
        coefficients=settings.efficiency.models[0],
        model=chosen_model,
        outcomes=outcomes,
        claims=claims,
        own_claims=own_claims,
    )
    return Reproduction(
        folder=folder, files=files, results=results, claims=claims, own_claims=own_claims
    )


class _Outcome(NamedTuple):
    """Outcome of a study."""

    study: Any
    """Results of the study."""
    files: list[str]
    """Names of the files of its chapter."""
    html: str
    """Text of its chapter; empty if it has none."""


def _run_study(
    settings: Experiments,
    model: scenarios.Model,
    folder: Path,
    repeats: Sequence[Repeat],
    name: str,
    progress: Progress,
) -> _Outcome:
    """Run one study and write its part of the folder."""
    activity = name.replace("_", " ")
    run = RUNS[name]
    study = run(getattr(settings, name), model, progress=partial(progress, activity))
    if name not in CHAPTERS:
        return _Outcome(study, files=[], html="")
    study_chapter = CHAPTERS[name]
    if study_chapter.shows_repeats:
        chapter = study_chapter.build(study, repeats=repeats)
    else:
        chapter = study_chapter.build(study)
    files, html = write_chapter(
        chapter,
        folder,
        lambda n_drawn: progress(f"{activity}: figures", n_drawn, chapter.n_figures),
    )
    return _Outcome(study, files=files, html=html)


def _write_report(
    folder: Path,
    *,
    coefficients: runs.Coefficients,
    model: scenarios.Model,
    outcomes: Mapping[str, _Outcome],
    claims: Sequence[Claim],
    own_claims: Mapping[str, Sequence[Claim]],
) -> tuple[str, ...]:
    """Write the chapters about all studies and the page; return the names of all files."""
    results = {name: outcome.study for name, outcome in outcomes.items()}
    summary_files, summary = write_chapter(
        build_summary_chapter(results, claims, own_claims), folder
    )
    _, trust = write_chapter(build_trust_chapter(results), folder)
    claims_files, claims_html = write_chapter(build_claims_chapter(claims, own_claims), folder)
    chapters = [("claims", "The paper's claims", claims_html)]
    files = [*summary_files, *claims_files]
    for outcome in outcomes.values():
        files += outcome.files
    for name, chapter in CHAPTERS.items():
        if name in outcomes:
            chapters.append((name.replace("_", "-"), chapter.title, outcomes[name].html))
    model_settings = scenarios.settings_of(model)
    page = load_paper_templates().get_template("report.html")
    text = page.render(
        title=TITLE,
        coefficients=coefficients.title,
        version=packaging.__version__,
        model=model_settings["model"],
        joints=model_settings["joints"],
        summary=summary,
        trust=trust,
        chapters=chapters,
    )
    write(folder / "report.html", text)
    return (*sorted(files), "report.html")
