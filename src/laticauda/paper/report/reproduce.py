"""The paper in one call: run its studies, and write figures, tables, data and a report into one folder."""

import os
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, field, replace
from functools import partial
from multiprocessing import active_children, get_context, parent_process, resource_tracker
from pathlib import Path
from threading import Thread
from typing import Any, NamedTuple, Unpack

import numpy as np

from laticauda import robot, scenarios
from laticauda.models.simulate.runner import silent
from laticauda.paper import runs, settings, side_trials
from laticauda.paper.claims import Claim, load_claims, misprints
from laticauda.paper.efficiency import EfficiencyStudy, Repeat, run_efficiency
from laticauda.paper.path_following import PathFollowingStudy, run_path_following
from laticauda.paper.report import efficiency, path_following
from laticauda.paper.report.chapter import build_row, paper_chapter, paper_templates
from laticauda.paper.scores import score_study
from laticauda.show.reports.chapter import Chapter, writable_folder, write_chapter
from laticauda.values import packaging
from laticauda.values.checks import check_choice, check_whole_number
from laticauda.values.files import write
from laticauda.values.interrupts import defer_interrupts

RUNS: Mapping[str, Callable[..., Any]] = {
    "path_following": run_path_following,
    "efficiency": run_efficiency,
    "side": side_trials.run_side_trials,
}
"""Functions that run the studies, by name in `Experiments`; the longest is first, which fills workers best."""
HALVES: Mapping[str, tuple[str, ...]] = {
    "efficiency": ("efficiency", "side"),
    "path-following": ("path_following",),
}
"""The studies that belong to each half of the paper."""
TITLE = (
    "Underwater snake robots with and without a caudal fin: the paper's experiments in simulation"
)
CHAPTERS: Mapping[str, tuple[str, Callable[..., Chapter]]] = {
    "efficiency": ("Locomotion efficiency", efficiency.efficiency_chapter),
    "path_following": ("Path following", path_following.path_following_chapter),
}
"""Studies that have their own part of the report, in its order."""

VERDICTS = ("holds", "holds in part", "does not hold", "not tested here")
"""All verdicts, the best first."""

Progress = Callable[[str, int, int], None]


@dataclass(frozen=True, kw_only=True)
class Experiments:
    """Settings of every study; by default the paper's where it has any."""

    efficiency: settings.EfficiencySettings = field(default_factory=settings.efficiency_settings)
    """Figs. 4 to 11 and Table 1."""
    side: side_trials.SideSettings = field(default_factory=side_trials.SideSettings)
    """Individual facts on which claims of the paper are based."""
    path_following: settings.PathFollowingSettings = field(
        default_factory=settings.path_following_settings
    )
    """Figs. 12 to 23 and Table 2."""


def paper_experiments(parameters: robot.Parameters | None = None) -> Experiments:
    """Return the settings of a complete reproduction.

    Args:
        parameters: Coefficients to use instead of the paper's, with their changes to the robots;
            the efficiency study also keeps the paper's, with unchanged robots. None uses the
            paper's.
    """
    usual = Experiments()
    if parameters is None:
        return usual
    given = runs.Coefficients.of(parameters)
    others = [one for one in usual.efficiency.models if one.name != given.name]
    return Experiments(
        efficiency=replace(usual.efficiency, models=(given, *others)),
        side=replace(usual.side, coefficients=given),
        path_following=replace(usual.path_following, coefficients=given),
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


class _Done(NamedTuple):
    """Outcome of a study."""

    study: Any
    files: list[str]
    html: str


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
            `paper_experiments`.
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
    folder = writable_folder(folder)
    report = paper_templates().get_template("report.html")
    settings = settings or Experiments()
    by = scenarios.model_of(model, **changes)
    how = scenarios.settings_of(by)
    names = [name for name in RUNS if only is None or name in HALVES[only]]
    do = partial(_do, settings, by, folder, repeats)
    done = _run(do, names, workers, progress)
    results = {name: part.study for name, part in done.items()}
    judged = load_claims(*results.values())
    written, first = write_chapter(summary_chapter(results, judged), folder)
    files, listed = write_chapter(claims_chapter(judged, own_verdicts(results)), folder)
    found = [
        (name.replace("_", "-"), title, done[name].html)
        for name, (title, _) in CHAPTERS.items()
        if name in done
    ]
    text = report.render(
        title=TITLE,
        coefficients=settings.efficiency.models[0].title,
        version=packaging.__version__,
        model=how["model"],
        joints=how["joints"],
        summary=first,
        chapters=[("claims", "The paper's claims", listed), *found],
    )
    write(folder / "report.html", text)
    written += [file for part in done.values() for file in part.files]
    names = (*sorted([*written, *files]), "report.html")
    return Reproduction(folder=folder, files=names, results=results, claims=judged)


def summary_chapter(results: Mapping[str, Any], judged: Sequence[Claim]) -> Chapter:
    """Return the chapter on the first screen of the report.

    Args:
        results: Results of the studies, by their names in `Experiments`.
        judged: Claims judged by these results.
    """
    studies = {"Table 1": results.get("efficiency"), "Table 2": results.get("path_following")}
    predictors = {name: score_study(study) for name, study in studies.items() if study is not None}

    def figures() -> Iterator[tuple[str, str, Any]]:
        from laticauda.show.figures import style
        from laticauda.show.reports.identify_figures import parity

        shown = {
            f"{name}: {one.name.split(',')[0]}": np.array([one.measured, one.speeds])
            for name, (first, *others) in predictors.items()
            for one in (
                first,
                *[other for other in others if other.n_fitted and not other.is_null][:1],
            )
        }
        figure = style.new_figure(side := 0.55 * style.DOUBLE_COLUMN, side)
        ax = parity(shown, figure.subplots(), what="forward velocity [m/s]")
        ax.set(ylabel="simulated forward velocity [m/s]")
        style.add_legend(ax, loc="upper left")
        yield "speeds", "Simulated against measured speeds of the robot.", figure

    values = {"n_claims": len(judged), "counts": _counted(judged), "predictors": predictors}
    return paper_chapter(name="summary", values=values, n_figures=1, figures=figures)


def _counted(judged: Sequence[Claim]) -> dict[str, int]:
    """Return the number of claims with each verdict that occurs."""
    counts = Counter(claim.verdict for claim in judged)
    return {name: counts[name] for name in VERDICTS if counts[name]}


def own_verdicts(results: Mapping[str, Any]) -> dict[str, tuple[Claim, ...]]:
    """Judge the claims with each of the project's own models in place of the paper's coefficients.

    Args:
        results: Results of the studies, by their names in `Experiments`; the side trials are not
            run with these models.
    """
    studies: dict[str, list[Any]] = {}
    for study in results.values():
        if isinstance(study, EfficiencyStudy):
            models = [
                (i, one.name)
                for i, one in enumerate(study.settings.models)
                if one.n_fitted is not None
            ]
            studies |= {
                name: [replace(study, judged=i), *studies.get(name, [])] for i, name in models
            }
        for one in study.own if isinstance(study, PathFollowingStudy) else ():
            studies.setdefault(one.settings.coefficients.name, []).append(one)
    return {name: load_claims(*mine) for name, mine in studies.items()}


def claims_chapter(
    found: Sequence[Claim], own: Mapping[str, Sequence[Claim]] | None = None
) -> Chapter:
    """Return the claims' contribution to the folder and the report.

    Args:
        found: Result of `laticauda.paper.claims.load_claims`.
        own: Claims judged with other models, by name; their verdicts come before those of `found`.
            None: no others.
    """
    claims = [build_row("claims", claim) for claim in found]
    for name, others in (own or {}).items():
        for mine, other in zip(claims, others, strict=True):
            mine[f"with {name}"] = other.verdict
            mine["verdict"] = mine.pop("verdict")
    return paper_chapter(
        name="claims",
        values={"n_claims": len(found), "counts": _counted(found)},
        tables={
            "claims": claims,
            "misprints": [build_row("misprints", entry) for entry in misprints()],
        },
    )


# ---- the studies, sequentially or in parallel ----------------------------------------------------


def _run(
    do: Callable[[str, Progress], _Done], names: Sequence[str], workers: int, progress: Progress
) -> dict[str, _Done]:
    """Run all studies; the first error ends them."""
    if min(workers, len(names)) == 1:
        return {name: do(name, progress) for name in names}
    context = get_context("spawn")  # the only start method that is safe everywhere
    if os.name == "posix":
        _track()
    told = context.SimpleQueue()
    listener = Thread(target=_listen, args=(told, progress), daemon=True)
    listener.start()
    workers, others = min(workers, len(names)), set(active_children())
    with ProcessPoolExecutor(
        workers, mp_context=context, initializer=_remember, initargs=(told,)
    ) as pool:
        with defer_interrupts():  # this process ends them
            running = {pool.submit(do, name, _tell): name for name in names}
        try:
            done = {running[future]: future.result() for future in as_completed(running)}
        except BaseException:
            for worker in set(active_children()) - others:
                worker.terminate()  # its files are complete or not in place
            raise
        told.put(None)
        listener.join()
    return done


def _track() -> None:
    """Start the process that removes what workers share if this one is killed, without a warning to the user."""
    sys.warnoptions.append(
        "ignore::UserWarning:multiprocessing.resource_tracker"
    )  # passed on to the process
    try:
        resource_tracker.ensure_running()
    finally:
        sys.warnoptions.pop()


def _do(
    settings: Experiments,
    model: scenarios.Model,
    folder: Path,
    repeats: Sequence[Repeat],
    name: str,
    progress: Progress,
) -> _Done:
    """Run one study and write its part of the folder."""
    what = name.replace("_", " ")
    study = RUNS[name](getattr(settings, name), model, progress=partial(progress, what))
    if name not in CHAPTERS:
        return _Done(study, [], "")
    more = {"repeats": repeats} if name == "efficiency" else {}
    chapter = CHAPTERS[name][1](study, **more)
    files, html = write_chapter(
        chapter, folder, lambda n: progress(f"{what}: figures", n, chapter.n_figures)
    )
    return _Done(study, files, html)


# ---- in a worker ---------------------------------------------------------------------------------

_told: Any = None
"""Queue in which a worker reports its progress."""


def _remember(told: Any) -> None:
    global _told
    _told = told
    Thread(target=_end_with, args=(parent_process(),), daemon=True).start()


def _end_with(parent: Any) -> None:
    """Exit when the parent ends: nobody waits for the work of a program that was killed."""
    parent.join()
    os._exit(1)


def _tell(what: str, done: int, total: int) -> None:
    _told.put((what, done, total))


def _listen(told: Any, progress: Progress) -> None:
    """Pass on the progress that workers report, until the end is signaled."""
    while (message := told.get()) is not None:
        progress(*message)
