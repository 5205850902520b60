"""What commands write of a trial: files, pictures, films, and the figures that are printed."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import laticauda as lc
from laticauda.cli import report
from laticauda.cli.command import Command, Outcome
from laticauda.cli.first_screen import first_screen
from laticauda.cli.flag_types import BadFlag, PictureOutput, TrialOutput, VideoOutput
from laticauda.cli.output_files import TABLE_ENDING, list_whole_endings
from laticauda.cli.progress import film_bar
from laticauda.show import figures
from laticauda.show.pictures import Film
from laticauda.values import option, value_class


@value_class
class Filming(Command):
    """A command that has a trial and can film it."""

    video: VideoOutput = option("Write a 3D film of the run (.mp4)", default=None)
    film: Film = option("Content and size of the film", default=Film())

    def draws_robot(self) -> bool:
        """Return whether anything is written for which size, times and camera of a film count."""
        return self.video is not None

    def check_film_options(self) -> None:
        """Reject options of a film that would do nothing."""
        if self.film != Film() and not self.draws_robot():
            raise BadFlag(
                "--size, --fps, --from, --to and --camera must be given together with --video."
            )

    def write_film(
        self, trial: lc.Trial, speed: float = 1.0, beside: Sequence[lc.Trial] = ()
    ) -> None:
        """Write the film of a trial if requested.

        Args:
            trial: Any trial.
            speed: Playback speed relative to real time [-].
            beside: Trials of other robots in the same scene.
        """
        self.check_film_options()
        if self.video is None:
            return
        from laticauda.show.pictures import render_film

        begin, end = self.film.span(trial)
        render_film(
            trial,
            self.video,
            self.film,
            speed=speed,
            beside=beside,
            progress=film_bar(end - begin),
        )


@value_class
class Recording(Filming):
    """A command that makes a trial, with the options for its output."""

    save: TrialOutput = option(
        f"Write the trial: {list_whole_endings()} (all of it) or {TABLE_ENDING} (a table)",
        default=None,
    )
    plot: PictureOutput = option(
        "Plot path, speed, joint angles and torques to this file (.png, .pdf or .svg)", default=None
    )
    all: bool = option("Print every figure of the run, not only the first few", default=False)

    def write_and_report(
        self,
        trial: lc.Trial,
        origin: str = "",
        *,
        further_text: str = "",
        further_facts: Mapping[str, Any] | None = None,
        neighbors: Sequence[lc.Trial] = (),
        basis: str = "",
    ) -> Outcome:
        """Write the requested files, and report the figures.

        Args:
            trial: Trial of the run.
            origin: Source of its coefficients, in words.
            further_text: Text printed below the table.
            further_facts: Additional facts, for JSON.
            neighbors: Trials of other robots in the same scene.
            basis: What its coefficients rest on, in sentences.
        """
        if self.save is not None:
            _save_trials(Path(self.save), trial, neighbors)
        if self.plot is not None:
            figures.save_figure(trial.plot(), self.plot)
        self.write_film(trial, beside=neighbors)
        problem = ""
        if not trial.succeeded:
            problem = trial.status
        return Outcome(
            facts={**report.facts_of_trial(trial), **(further_facts or {})},
            text=self.describe(trial, origin, basis) + further_text,
            problem=problem,
            succeeded=trial.succeeded,
        )

    def describe(self, trial: lc.Trial, origin: str = "", basis: str = "") -> str:
        """Return what is printed of a trial: the first screen, or every figure.

        Args:
            trial: Trial of the run.
            origin: Source of its coefficients, in words.
            basis: What they rest on, in sentences.
        """
        if self.all:
            return report.describe_trial(trial, origin)
        return first_screen(trial, basis)


def _save_trials(path: Path, trial: lc.Trial, neighbors: Sequence[lc.Trial]) -> None:
    """Save a trial, and those of its neighbors under the same name with a number."""
    trial.save(path)
    for number, neighbor in enumerate(neighbors, start=1):
        neighbor.save(path.with_stem(f"{path.stem}-{number}"))
