"""`laticauda identify`: physical parameters with their uncertainty from measured trials."""

import json
import shlex
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, Literal

from laticauda.cli.command import SHARE, Command, Outcome, show_progress
from laticauda.cli.flags import (
    BadFlag,
    File,
    Files,
    Folder,
    Inputs,
    Options,
    Words,
    options_of,
    spell_flag,
    was_typed,
)
from laticauda.cli.tables import format_table, parse_numbers
from laticauda.identify import fitting, measurements, result, tasks, validation
from laticauda.models.simulate.numbers import UNITS
from laticauda.robot import load_parameters
from laticauda.show.reports.chapter import load_templates, writable_folder
from laticauda.show.reports.identify import (
    as_dict,
    errors_of,
    identification_tables,
    write_identification,
)
from laticauda.values.checks import check_choice
from laticauda.values.codec import keys_of
from laticauda.values.errors import BadArgument
from laticauda.values.files import write
from laticauda.values.quantities import option, quantity, value_class

FORM = "NAME, NAME=LOW:HIGH or NAME=MEAN+-SD, such as water.normal_drag=0.5:4"


@value_class
class IdentificationTarget(Options):
    """What is identified, and from which measurements."""

    heading: ClassVar[str] = "what"

    parameters: Words = option(
        "NAME, NAME=LOW:HIGH or NAME=MEAN+-SD: parameters of robot and water, dotted as in a sweep, with a range "
        "or with prior knowledge; for one gait only: eel_like.water.tangential_friction",
        default=(),
    )
    measured: Words = option(
        "NAME=SIGMA: what is fitted, with the standard deviation of its noise in SI units: figures, such as "
        "forward_velocity or mean_power, and series, such as center_of_mass, heading, joint_angle, joint_torque",
        default=("center_of_mass=0.005",),
    )
    interval: float = quantity(
        "s", "Time between the fitted samples of a series", gt=0.0, default=0.5
    )
    columns: File = option("TOML file that describes the columns of a foreign log", default=None)
    table: File = option(
        "CSV file of speeds, a row per trial, with the columns of `reproduce --repeats`",
        default=None,
    )
    table1: bool = option("The paper's Table 1, alone or beside files", default=False)
    free_start: bool = option(
        "Also identify where the trials began, if path or heading is fitted", default=True
    )


@value_class
class Fixed(Options):
    """What is held fixed."""

    robot: str | None = option(
        "Robot, a preset or a TOML file; trials of another one are refused", default=None
    )
    base: str | None = option(
        "Parameter file for all else, with a joint law; else as in the trials", default=None
    )
    joints: str | None = option(
        "How joints follow the gait; if omitted, the base's law or prescribed", default=None
    )
    model: Literal["planar", "spatial"] = option(
        "Model of the body; spatial (MuJoCo) is slow", default="planar"
    )


@value_class
class Method(Options):
    """How parameters are fitted."""

    noise: Literal["known", "estimated"] = option(
        "As stated, or times an estimated factor", default="estimated"
    )
    starts: int = quantity("", "Number of starting points of the search", ge=1, default=4)
    seed: int = quantity("", "Seed of the random starts", ge=0, default=0)
    profiles: bool = option("Also compute intervals from profile likelihoods", default=False)
    exact: bool = option(
        "Leave out each measurement by refitting, not by linearization", default=False
    )
    quick: bool = option("Skip the refits that leave out one group at a time", default=False)
    threads: int | None = quantity(
        "", "Trials to run in parallel; one per core if omitted", ge=1, default=None
    )


@value_class
class Identify(Command):
    """Identify physical parameters with their uncertainty from measured trials.

    For example: laticauda identify run-1.nc run-2.nc --parameters water.tangential_friction
    water.normal_drag=0.5:4 --robot mamba --output tank

    The same from one file that holds everything: laticauda identify tank.toml. Writes
    parameters.toml (for the option --parameters of other commands), the report identify.html,
    fit.json, figures and tables.
    """

    files: Inputs = option(
        "One TOML task file, or trials: netCDF, MCAP, or other logs with --columns", default=()
    )
    what: IdentificationTarget = option(
        "What is identified, from which data", default=IdentificationTarget()
    )
    fixed: Fixed = option("What is held fixed", default=Fixed())
    method: Method = option("How it is fitted", default=Method())
    laws: Files = option(
        "Parameter files as for --base, each fitted and compared with null models", default=()
    )
    name: str | None = option(
        "Name of the parameter file; if omitted, the task's or identified", default=None
    )
    output: Folder = option(
        "Folder, made if missing; files of the same names are replaced", default="identification"
    )
    words: Any = option("What was typed, for the report", default=())

    @classmethod
    def read(cls, words: Sequence[str], prog: str) -> "Identify":
        """Return the command that was typed; see `Command.read`."""
        return replace(super().read(words, prog), words=tuple(words))

    def run(self) -> Outcome:
        """Identify, and write the results."""
        task, folder = self._task(), Path(self.output)
        writable_folder(folder)
        load_templates()  # check for the report's requirements before the search
        if not self.laws:
            done, files = self._identified(task, folder)
            facts = as_dict(done, self._command) | {"output": str(folder), "files": files}
            return Outcome(facts=facts, text=_text(done, folder), succeeded=_is_whole(done.found))
        if task.base is not None:
            raise BadFlag(
                f"--laws must not be given together with a task's parameter file, got `{task.base.name}`."
            )
        bases = [load_parameters(law) for law in self.laws]
        every = {
            base.name: self._identified(task.with_law(base), folder / base.name)[0]
            for base in bases
        }
        statuses = [f"{name}: {done.found.status}" for name, done in every.items()]
        return Outcome(
            facts={
                "laws": {name: as_dict(done, self._command) for name, done in every.items()},
                "output": str(folder),
            },
            text="\n\n".join([*statuses, format_table(errors_of(every)), str(folder)]),
            succeeded=all(_is_whole(done.found) for done in every.values()),
        )

    @property
    def _command(self) -> str:
        return shlex.join(
            ["laticauda", "identify", *(word for word in self.words if word != "--json")]
        )

    def _identified(
        self, task: tasks.Task, folder: Path
    ) -> tuple[validation.Validation, list[str]]:
        """Run a task; return its results and the names of the files written."""
        best, bar = writable_folder(folder) / "best.json", show_progress(SHARE)
        found = task.run(
            threads=self.method.threads,
            progress=lambda share: bar(share, what="search"),
            keep=lambda values, cost: write(
                best, json.dumps({"sum_of_squares": cost, "values": values})
            ),
        )
        done = validation.validate(
            task,
            found,
            exact=self.method.exact,
            by_group=not self.method.quick,
            profiles=self.method.profiles,
            progress=lambda what, share: bar(share, what=what),
        )
        files = write_identification(done, folder, command=self._command)
        best.unlink(missing_ok=True)
        return done, files

    def _task(self) -> tasks.Task:
        """Return the requested task."""
        if len(self.files) != 1 or not self.files[0].lower().endswith(".toml"):
            with keys_of("identify", BadFlag):
                task = tasks.task_from_table(self._table(), self.name or "identified", Path())
            return (
                task
                if self.laws
                else replace(task, options={"joints": "prescribed", **task.options})
            )
        for name, given in (options_of(self.what) | options_of(self.fixed)).items():
            if was_typed(name, self.words):
                raise BadFlag(
                    f"{spell_flag(name)} must not be given with {self.files[0]}, which defines all, got {given!r}."
                )
        task = tasks.load_task(self.files[0])
        names = [name for name in ("starts", "seed", "noise") if was_typed(name, self.words)]
        typed = {tasks.OPTIONS[name]: getattr(self.method, name) for name in names}
        return replace(task, options={**task.options, **typed}, name=self.name or task.name)

    def _table(self) -> dict[str, Any]:
        """Return the flags in the form of a task file."""
        if not (self.files or self.what.table or self.what.table1):
            raise BadFlag("FILE must be one TOML task file, or at least one trial, got none.")
        if not self.what.parameters:
            raise BadFlag(
                "--parameters must name at least one parameter, such as water.normal_drag, got none."
            )
        counted: dict[str, Any] = {**_measured(self.what.measured), "interval": self.what.interval}
        counted["free_start"] = self.what.free_start
        short = [Path(file).stem for file in self.files]
        trials: list[dict[str, Any]] = []
        for file, stem in zip(self.files, short, strict=True):
            name = stem if short.count(stem) == 1 else file  # with its folder if two are alike
            columns = (
                {}
                if Path(file).suffix.lower() in (".nc", ".mcap")
                else {"columns": self.what.columns}
            )
            trials.append({"file": file, "name": name, **columns, **counted})
        given: dict[str, Any] = {
            **{name: getattr(self.fixed, name) for name in ("robot", "base", "joints", "model")},
            **{name: getattr(self.method, name) for name in ("noise", "starts", "seed")},
            "parameters": [_unknown(word) for word in self.what.parameters],
            "trials": trials,
            "table": {"file": self.what.table} if self.what.table else None,
            "table1": self.what.table1 or None,
        }
        return {
            "kind": "identification",
            **{name: one for name, one in given.items() if one is not None},
        }


def _is_whole(found: result.Fit) -> bool:
    return found.searches[0].converged and fitting.INTERRUPTED not in found.warnings


def _measured(words: Sequence[str]) -> dict[str, dict[str, float]]:
    """Return the figures and series that are fitted, with their standard deviations."""
    found: dict[str, dict[str, float]] = {"figures": {}, "series": {}}
    form = "NAME=SIGMA with SIGMA > 0, such as forward_velocity=0.01"
    for word in words:
        name, _, (sigma,) = parse_numbers("measured", word, form)
        if sigma <= 0.0:
            raise BadArgument("measured", f"must be {form}, got {word!r}")
        check_choice("measured", name, list(dict.fromkeys((*UNITS, *measurements.SERIES))))
        found["series" if name in measurements.SERIES else "figures"][name] = sigma
    return found


def _unknown(word: str) -> dict[str, Any]:
    """Return one of `parameters` in the form of a task file."""
    if "=" not in word:
        return {"name": word}
    name, sign, ends = parse_numbers("parameters", word, FORM, "+-", ":")
    if len(ends) != 2:
        raise BadArgument("parameters", f"must be {FORM}, got {word!r}")
    return {"name": name} | (
        {"prior": ends} if sign == "+-" else {"lower": ends[0], "upper": ends[1]}
    )


def _text(done: validation.Validation, folder: Path) -> str:
    """Return the parameters, what the data do not determine, the errors, and the location of the files as text."""
    found, tables = done.found, identification_tables(done)
    rows = [
        {name: one for name, one in row.items() if name not in ("prior", "range")}
        for row in tables["parameters"]
    ]
    parts = [found.status, format_table(rows)]
    if "began" in tables:
        parts[-1] += f"\nand {len(tables['began'])} numbers for where the trials began."
    if found.warnings:
        parts.append("\n".join(found.warnings))
    if "errors" in tables:
        parts.append("Mean error of the forward velocity:\n" + format_table(tables["errors"]))
    parts.append(f"{folder / 'identify.html'}\n{folder / 'parameters.toml'}: for --parameters")
    return "\n\n".join(parts)
