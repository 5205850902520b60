"""The paper by one call: run its studies, and write figures, tables, data and a report into one folder."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, field
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from threading import Thread
from typing import Any

from laticauda.errors import one_of, whole
from laticauda.files import write
from laticauda.packaging import __version__
from laticauda.paper.repeats import Repeat
from laticauda.paper.report.beyond import beyond_chapter
from laticauda.paper.report.chapter import paper_templates
from laticauda.paper.report.claims import claims_chapter
from laticauda.paper.report.efficiency import efficiency_chapter
from laticauda.paper.report.experiments import HALVES, RUNS, Experiments, Results
from laticauda.paper.report.parity import parity_chapter
from laticauda.paper.report.path_following import path_following_chapter
from laticauda.paper.report.stability import stability_chapter
from laticauda.reports.chapter import Chapter, writable_folder, write_chapter

STUDIES = tuple(HALVES)
"""The halves of the paper."""
TITLE = "Underwater snake robots with and without a caudal fin: the paper's experiments in simulation"
CHAPTERS: Mapping[str, tuple[str, Callable[..., Chapter]]] = {
    "efficiency": ("Locomotion efficiency", efficiency_chapter),
    "path_following": ("Path following", path_following_chapter),
    "stability": ("Stability of path following", stability_chapter),
    "beyond": ("Beyond the paper (simulation only)", beyond_chapter),
    "parity": ("Planar against spatial model", parity_chapter),
}
"""The studies that have a part of the report of their own, in its order."""

Progress = Callable[[str, int, int], None]


@dataclass(frozen=True, kw_only=True, eq=False)
class Reproduction:
    """What was run and written."""

    folder: Path
    """Where everything is."""
    files: tuple[str, ...]
    """Names of the files in it."""
    results: Results
    """What the studies found."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Job:
    """One study to run and write down; it can be sent to another process."""

    name: str
    settings: object
    model: str
    joints: str
    folder: Path
    repeats: Sequence[Repeat]


@dataclass(frozen=True, kw_only=True, eq=False)
class _Done:
    """What came of a job."""

    study: Any
    files: list[str] = field(default_factory=list[str])
    html: str = ""


def reproduce(
    folder: str | Path,
    settings: Experiments | None = None,
    *,
    only: str | None = None,
    model: str = "planar",
    joints: str = "prescribed",
    repeats: Sequence[Repeat] = (),
    workers: int = 1,
    progress: Progress | None = None,
) -> Reproduction:
    """Run the paper's studies and write everything into a folder.

    Args:
        folder: Made if it does not exist; files of the same names are replaced, others are left alone.
        settings: Of all studies; None takes the paper's. `paper_experiments` makes those for other coefficients.
        only: One of `STUDIES`; None runs all there are.
        model: See `laticauda.simulate.plant`.
        joints: See `laticauda.simulate.plant`.
        repeats: Repeated measurements, shown on the figures of the efficiency study (`load_repeats`).
        workers: Processes to spread the studies over. More than 1 needs a script whose main part stands under
            ``if __name__ == "__main__":``, as all of Python's process pools do.
        progress: Called now and then with what is going on, how much of it is done, and how much there is.

    Returns:
        What was run and written.

    Raises:
        ValueError: If an argument is out of its range, or the folder cannot be written; nothing has been run then.
        MissingExtra: If Jinja2 is not installed; nothing has been run then.
        SimulationFailed: If a trial blows up.
    """
    if only is not None:
        one_of("only", only, STUDIES)
    whole("workers", workers, 1)
    folder = writable_folder(folder)
    report = paper_templates().get_template("report.html")
    settings = settings or Experiments()
    jobs = [
        _Job(name=name, settings=getattr(settings, name), model=model, joints=joints, folder=folder, repeats=repeats)
        for name in RUNS
        if (only is None or name in HALVES[only]) and (name != "parity" or model == "spatial")
    ]
    done = _run(jobs, min(workers, len(jobs)), progress or (lambda what, done, total: None))
    results = Results(**{name: part.study for name, part in done.items()})
    files, judged = write_chapter(claims_chapter(results.claims), folder, lambda n: None)
    found = [(name.replace("_", "-"), title, done[name].html) for name, (title, _) in CHAPTERS.items() if name in done]
    text = report.render(
        title=TITLE,
        coefficients=settings.efficiency.models[0].title,
        version=__version__,
        model=model,
        joints=joints,
        chapters=[("claims", "The paper's claims", judged), *found],
    )
    write(folder / "report.html", text)
    written = [file for part in done.values() for file in part.files]
    return Reproduction(folder=folder, files=(*sorted([*written, *files]), "report.html"), results=results)


# ---- the studies, one after the other or side by side --------------------------------------------------------------


def _run(jobs: Sequence[_Job], workers: int, progress: Progress) -> dict[str, _Done]:
    """Do all jobs; the first error ends them."""
    if workers == 1:
        return {job.name: _do(job, progress) for job in jobs}
    context = get_context("spawn")  # the only way to start a process that is safe everywhere
    told = context.SimpleQueue()
    listener = Thread(target=_listen, args=(told, progress), daemon=True)
    listener.start()
    with ProcessPoolExecutor(workers, mp_context=context, initializer=_remember, initargs=(told,)) as pool:
        names = {pool.submit(_do_there, job): job.name for job in jobs}
        try:
            return {names[future]: future.result() for future in as_completed(names)}
        finally:
            pool.shutdown(cancel_futures=True)
            told.put(None)
            listener.join()


def _do(job: _Job, progress: Progress) -> _Done:
    """Run one study and write its part of the folder."""
    what = job.name.replace("_", " ")
    study = RUNS[job.name](job.settings, model=job.model, joints=job.joints, progress=partial(progress, what))
    if job.name not in CHAPTERS:
        return _Done(study=study)
    more = {"repeats": job.repeats} if job.name == "efficiency" else {}
    chapter = CHAPTERS[job.name][1](study, **more)
    files, html = write_chapter(chapter, job.folder, lambda n: progress(f"{what}: figures", n, chapter.n_figures))
    return _Done(study=study, files=files, html=html)


# ---- in a worker ---------------------------------------------------------------------------------------------------

_told: Any = None
"""Where a worker tells how far it is."""


def _remember(told: Any) -> None:
    global _told
    _told = told


def _do_there(job: _Job) -> _Done:
    return _do(job, lambda what, done, total: _told.put((what, done, total)))


def _listen(told: Any, progress: Progress) -> None:
    """Pass on what workers tell, until there is no more to come."""
    while (message := told.get()) is not None:
        progress(*message)
