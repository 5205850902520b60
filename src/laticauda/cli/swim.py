"""`laticauda swim`: one run of one robot, its figures, its file and its picture."""

import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from laticauda.cli.flags import BadFlag, File, Maybe, flag, options_of, read
from laticauda.cli.outputs import check_output
from laticauda.cli.scene import Names, announced, named, was_typed
from laticauda.cli.view import check_film, write_film
from laticauda.quantities import option, quantity, value
from laticauda.scenarios import Scenario

if TYPE_CHECKING:
    from laticauda.trial import Trial

PICTURES = (".png", ".pdf")


@value
class Outputs:
    """What becomes of it."""

    json: bool = option("Print one JSON object in SI units instead of the table", default=False)
    save: File = option("Write the trial to this netCDF file (.nc)", default=None)
    plot: File = option("Draw path, speed, joint angles and torques into this picture (.png or .pdf)", default=None)
    video: File = option("Show the run in 3D in this film (.mp4)", default=None)

    def check(self) -> None:
        """Refuse files that cannot be written, before the run."""
        check_output("save", self.save, (".nc",))
        check_output("plot", self.plot, PICTURES)
        check_film(self.video)

    def write(self, trial: "Trial", sheet: str) -> None:
        """Write what is asked for.

        Args:
            trial: The run.
            sheet: Name of its figure in `laticauda.figures`.
        """
        if self.save is not None:
            trial.save(self.save)
        if self.plot is not None:
            from laticauda import figures

            figures.save_figure(getattr(figures, sheet)(trial), self.plot)
        if self.video is not None:
            write_film(trial, self.video)


@value
class Swim:
    """Let a robot swim a gait, from straight and at rest, and print its speed and power.

    For example: laticauda swim --robot mamba --gait lateral-undulation --amplitude-deg 30 --frequency-deg-s 130
    --phase-shift-deg 40 --duration 30 --save run.nc --plot run.png
    """

    file: Annotated[Maybe, tyro.conf.Positional] = option(
        "A scenario file (.toml) that the flags change; it comes first", default=None
    )
    names: Names = option("What swims, how and where, by name", default=Names())
    scenario: Scenario = option("What the names stand for; every number can be changed")
    before: Any = option("What the names stand for, before single numbers were changed", default=None)
    origin: Any = option("Where the environment is from, in words", default="")
    link_forces: bool = option("Log the force on every link too", default=False)
    save_scenario: File = option("Write what runs to this scenario file (.toml)", default=None)
    resume: File = option("Go on from the end of this stored trial, with its robot, gait and water", default=None)
    output: Outputs = option("What becomes of it", default=Outputs())

    @classmethod
    def read(cls, words: Sequence[str], prog: str) -> Callable[[], int]:
        """The command that was typed.

        Args:
            words: Behind its name.
            prog: What the help calls it.
        """
        if was_typed("resume", words):
            return SwimOn.read(words, prog)
        names = Names.read(words, prog)
        found, origin = names.scenario(words)
        return read(cls, words, prog, cls(names=names, scenario=found, before=found, origin=origin))

    def __call__(self) -> int:
        """Run, write, print, and return the exit status."""
        return run_and_report(self, self.scenario, "swim_sheet")


def run_and_report(command: Any, scenario: Scenario, sheet: str, after: Callable[["Trial"], str] | None = None) -> int:
    """Run a scenario, write and print what is asked for, and return the exit status.

    Args:
        command: Its options, with `before`, `origin`, `link_forces`, `save_scenario` and `output`.
        scenario: With the numbers that were typed.
        sheet: Name of its figure in `laticauda.figures`.
        after: What is printed below the table.
    """
    from laticauda.simulate import swim

    output: Outputs = command.output
    output.check()
    check_output("save_scenario", command.save_scenario, (".toml",))
    scenario = named(scenario, command.before)
    if command.save_scenario is not None:
        from laticauda.scenarios import save_scenario

        save_scenario(scenario, command.save_scenario)
    trial = swim(scenario, link_forces=command.link_forces, progress=announced(scenario))
    output.write(trial, sheet)
    return print_trial(trial, command.origin, output.json, after)


def print_trial(trial: "Trial", origin: str, as_one_object: bool, after: Callable[["Trial"], str] | None = None) -> int:
    """Print a run, and return the exit status.

    Args:
        trial: The run.
        origin: Where its coefficients are from, in words.
        as_one_object: Whether as JSON.
        after: What is printed below the table.
    """
    from laticauda.cli.report import as_json, as_text

    text = as_json(trial) if as_one_object else as_text(trial, origin)
    print(text if after is None or as_one_object else f"{text}\n\n{after(trial)}")
    if not trial.succeeded:
        print(trial.status, file=sys.stderr)
    return 0 if trial.succeeded else 1


@value
class SwimOn:
    """Go on from the end of a stored trial, with its robot, gait and water; the result is the whole run."""

    resume: File = option("The stored trial")
    duration: float = quantity("s", "How much longer", gt=0.0, default=30.0)
    sample_interval: float = quantity("s", "Between two samples of the log", gt=0.0, default=0.05)
    output: Outputs = option("What becomes of it", default=Outputs())

    @classmethod
    def read(cls, words: Sequence[str], prog: str) -> "SwimOn":
        """The command that was typed; arguments as for `Swim.read`.

        Raises:
            BadFlag: If an option says what the stored trial says.
        """
        allowed = {flag(name) for name in options_of(cls(resume=None))} | {"--help", "-h"}
        for word in words:
            if word.startswith("--") and word.split("=")[0] not in allowed:
                raise BadFlag(f"{word.split('=')[0]} must not be given with --resume: the stored trial has its own.")
        return read(cls, words, prog)

    def __call__(self) -> int:
        """Run, write, print, and return the exit status."""
        from laticauda.logs import load_trial
        from laticauda.simulate import plant, resume
        from laticauda.trial import joined

        self.output.check()
        assert self.resume is not None
        first = load_trial(self.resume)
        if not isinstance(first.scenario, Scenario):
            raise BadFlag(f"--resume must be a simulated trial, got {self.resume}, which lacks {first.scenario.lacks}")
        scenario = replace(first.scenario, duration=self.duration)
        second = resume(
            plant(scenario),
            first,
            self.duration,
            sample_interval=self.sample_interval,
            link_forces=first.link_force is not None,
            progress=announced(scenario),
        )
        trial = joined(first, second)
        self.output.write(trial, "swim_sheet")
        return print_trial(trial, f"as stored in {self.resume}", self.output.json)
