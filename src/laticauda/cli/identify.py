"""`laticauda identify`: physical parameters with their uncertainty from measured trials."""

import json
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar, Literal, NamedTuple

from laticauda.cli.command import Command, Outcome
from laticauda.cli.flags import (
    BadFlag,
    ColumnNames,
    File,
    FileArguments,
    Files,
    Folder,
    Internal,
    Options,
    Words,
    options_of,
    spell_option,
    was_typed,
)
from laticauda.cli.progress import SHARE, show_progress
from laticauda.cli.shared_options import (
    base_option,
    column_option,
    joint_law_option,
    read_columns,
    scheduler_option,
    threads_option,
)
from laticauda.cli.tables import format_table, parse_numbers, spell_with_underscores
from laticauda.identify import fitting, list_assumptions, measurements, result, tasks, validation
from laticauda.models.simulate import UNITS, connected
from laticauda.robot import load_parameters
from laticauda.show.reports import (
    describe_identification,
    list_errors,
    list_identification_tables,
    load_templates,
    make_writable_folder,
    write_identification,
)
from laticauda.values import (
    BadArgument,
    check_choice,
    fields_of,
    keys_of,
    option,
    quantity,
    value_class,
    write,
)

FORM = "NAME, NAME=LOW:HIGH or NAME=MEAN+-SD, such as water.normal_drag=0.5:4"
METHOD_OF_TASK = ("starts", "seed", "noise")
"""Options of the method that a task file has, too."""
SUFFIXES_WITHOUT_COLUMNS = (".nc", ".mcap")
"""Endings of files that describe themselves."""


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
    column: ColumnNames = column_option("--table")
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
    base: str | None = base_option("as in the trials")
    joints: str | None = joint_law_option()
    model: Literal["planar", "spatial"] = option(
        "Model of the body; spatial (MuJoCo) is slow", default="planar"
    )


@value_class
class Method(Options):
    """How parameters are fitted."""

    noise: Literal["known", "estimated"] = option(
        "As stated, or times an estimated factor", default="estimated"
    )
    starts: int = quantity("", "Largest number of starting points of the search", ge=1, default=8)
    seed: int = quantity("", "Seed of the random starts", ge=0, default=0)
    profiles: bool = option("Also compute intervals from profile likelihoods", default=False)
    exact: bool = option(
        "Leave out each measurement by refitting, not by linearization", default=False
    )
    quick: bool = option("Skip the refits that leave out one group at a time", default=False)
    threads: int | None = threads_option()
    scheduler: str | None = scheduler_option()


@value_class
class Identify(Command):
    """Identify physical parameters with their uncertainty from measured trials.

    For example: laticauda identify run-1.nc run-2.nc --parameters water.tangential_friction
    water.normal_drag=0.5:4 --output tank

    The same from one file that holds everything: laticauda identify tank.toml. Writes
    parameters.toml (for the option --parameters of other commands), the report identify.html,
    fit.json, figures and tables.
    """

    files: FileArguments = option(
        "One TOML task file, or trials: netCDF, MCAP, or other logs with --columns", default=()
    )
    target: IdentificationTarget = option(
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
    arguments: Internal = option("What was typed, for the report", default=())

    @classmethod
    def read(cls, arguments: Sequence[str], prog: str) -> "Identify":
        """Return the command that was typed; see `Command.read`."""
        return replace(super().read(arguments, prog), arguments=tuple(arguments))

    def run(self) -> Outcome:
        """Identify, and write the results."""
        task, folder = self._task(), Path(self.output)
        make_writable_folder(folder)
        load_templates()  # check for the report's requirements before the search
        with connected(self.method.scheduler) as client:
            if self.laws:
                return self._compare_laws(task, folder, client)
            identification = self._identify(task, folder, client)
        validated = identification.validated
        facts = describe_identification(validated, self._command)
        facts |= {"output": str(folder), "files": identification.files}
        return Outcome(
            facts=facts,
            text=_describe(validated, folder),
            succeeded=_is_complete(validated.fit),
        )

    def _compare_laws(self, task: tasks.Task, folder: Path, client: Any) -> Outcome:
        """Identify with every law, and compare the errors."""
        if task.base is not None:
            rule = "must not be given together with a task's parameter file"
            raise BadFlag(f"--laws {rule}, got `{task.base.name}`.")
        bases = [load_parameters(law) for law in self.laws]
        by_law: dict[str, validation.Validation] = {}
        for base in bases:
            identification = self._identify(task.with_law(base), folder / base.name, client)
            by_law[base.name] = identification.validated
        facts_by_law = {
            name: describe_identification(entry, self._command) for name, entry in by_law.items()
        }
        statuses = [f"{name}: {entry.fit.status}" for name, entry in by_law.items()]
        return Outcome(
            facts={"laws": facts_by_law, "output": str(folder)},
            text="\n\n".join([*statuses, format_table(list_errors(by_law)), str(folder)]),
            succeeded=all(_is_complete(entry.fit) for entry in by_law.values()),
        )

    @property
    def _command(self) -> str:
        arguments = [argument for argument in self.arguments if argument != "--json"]
        return shlex.join(["laticauda", "identify", *arguments])

    def _identify(self, task: tasks.Task, folder: Path, client: Any) -> "_Identification":
        """Run a task, and write the results; the best values so far are in a file meanwhile."""
        best = make_writable_folder(folder) / "best.json"
        bar = show_progress(SHARE)

        def keep_best(values: Any, cost: float) -> None:
            write(best, json.dumps({"sum_of_squares": cost, "values": values}))

        fit = task.run(
            threads=self.method.threads,
            progress=lambda share: bar(share, what="search"),
            keep=keep_best,
            client=client,
        )
        validated = validation.validate(
            task,
            fit,
            exact=self.method.exact,
            by_group=not self.method.quick,
            profiles=self.method.profiles,
            progress=lambda what, share: bar(share, what=what),
            client=client,
        )
        files = write_identification(validated, folder, command=self._command)
        best.unlink(missing_ok=True)
        return _Identification(validated, files)

    def _task(self) -> tasks.Task:
        """Return the requested task."""
        if self._is_task_file():
            return self._task_of_file(self.files[0])
        name = self.name or "identified"
        with keys_of("identify", BadFlag):  # an error about a key of the table becomes a `BadFlag`
            task = tasks.task_from_table(self._table(), name, Path())
        if self.laws:  # each of them may have a joint law, see `Task.with_law`
            return task
        options = {"joints": "prescribed", **task.options}
        return replace(task, options=options)

    def _is_task_file(self) -> bool:
        return len(self.files) == 1 and self.files[0].lower().endswith(".toml")

    def _task_of_file(self, file: str) -> tasks.Task:
        """Return the task of a file, with the method as typed."""
        for part in (self.target, self.fixed):
            for field in options_of(part):
                if was_typed(field, self.arguments):
                    rule = f"must not be given with {file}, which defines all"
                    value = getattr(part, field.name)
                    raise BadFlag(f"{spell_option(field)} {rule}, got {value!r}.")
        task = tasks.load_task(file)
        options = dict(task.options)
        for name in METHOD_OF_TASK:
            if was_typed(fields_of(Method)[name], self.arguments):
                options[tasks.OPTIONS[name]] = getattr(self.method, name)
        return replace(task, options=options, name=self.name or task.name)

    def _table(self) -> dict[str, Any]:
        """Return the flags in the form of a task file."""
        if not (self.files or self.target.table or self.target.table1):
            raise BadFlag("FILE must be one TOML task file, or at least one trial, got none.")
        if not self.target.parameters:
            raise BadFlag(
                "--parameters must name at least one parameter, such as water.normal_drag, got none."
            )
        table: dict[str, Any] = {"kind": "identification"}
        for name in ("robot", "base", "joints", "model"):
            value = getattr(self.fixed, name)
            if value is not None:
                table[name] = value
        for name in ("noise", "starts", "seed"):
            table[name] = getattr(self.method, name)
        measured = _parse_measured(self.target.measured)
        table["parameters"] = [_parse_unknown(text) for text in self.target.parameters]
        table["trials"] = self._tables_of_trials(measured)
        columns = read_columns(self.target.column, self.target.table, "table")
        if self.target.table:
            table["table"] = {"file": self.target.table, "columns": columns}
        if self.target.table1:
            table["table1"] = True
        return table

    def _tables_of_trials(self, measured: dict[str, dict[str, float]]) -> list[dict[str, Any]]:
        """Return the trials in the form of a task file."""
        stems = [Path(file).stem for file in self.files]
        tables: list[dict[str, Any]] = []
        for file, stem in zip(self.files, stems, strict=True):
            name = stem
            if stems.count(stem) > 1:  # two are alike but for their folders
                name = file
            table: dict[str, Any] = {"file": file, "name": name}
            if Path(file).suffix.lower() not in SUFFIXES_WITHOUT_COLUMNS:
                table["columns"] = self.target.columns
            table |= measured
            table["interval"] = self.target.interval
            table["free_start"] = self.target.free_start
            tables.append(table)
        return tables


class _Identification(NamedTuple):
    """What a task gave."""

    validated: validation.Validation
    files: list[str]
    """Names of the files written."""


def _is_complete(fit: result.Fit) -> bool:
    return fit.searches[0].converged and fitting.INTERRUPTED not in fit.warnings


def _parse_measured(typed: Sequence[str]) -> dict[str, dict[str, float]]:
    """Return the figures and series that are fitted, with their standard deviations."""
    form = "NAME=SIGMA with SIGMA > 0, such as forward_velocity=0.01"
    figures: dict[str, float] = {}
    series: dict[str, float] = {}
    names = list(dict.fromkeys((*UNITS, *measurements.SERIES)))
    for text in typed:
        name, _, (sigma,) = parse_numbers("measured", text, form)
        if sigma <= 0.0:
            raise BadArgument("measured", f"must be {form}, got {text!r}")
        check_choice("measured", name, names)
        if name in measurements.SERIES:
            series[name] = sigma
        else:
            figures[name] = sigma
    return {"figures": figures, "series": series}


def _parse_unknown(text: str) -> dict[str, Any]:
    """Return one of `parameters` in the form of a task file."""
    if "=" not in text:
        return {"name": spell_with_underscores(text)}
    typed_name, sign, ends = parse_numbers("parameters", text, FORM, "+-", ":")
    name = spell_with_underscores(typed_name)
    if len(ends) != 2:
        raise BadArgument("parameters", f"must be {FORM}, got {text!r}")
    if sign == "+-":
        return {"name": name, "prior": ends}
    lower, upper = ends
    return {"name": name, "lower": lower, "upper": upper}


def _describe(validated: validation.Validation, folder: Path) -> str:
    """Return the parameters, what the data do not determine, the errors, and the location of the files as text."""
    fit = validated.fit
    tables = list_identification_tables(validated)
    parts = [fit.status, format_table([_without_prior(row) for row in tables["parameters"]])]
    if "began" in tables:
        parts[-1] += f"\nand {len(tables['began'])} numbers for where the trials began."
    remarks = [*fit.warnings, *list_assumptions(fit.problem)]
    if remarks:
        parts.append("\n".join(remarks))
    if "errors" in tables:
        parts.append("Mean error of the forward velocity:\n" + format_table(tables["errors"]))
    parts.append("\n".join(_list_places(fit, folder)))
    return "\n\n".join(parts)


def _list_places(fit: result.Fit, folder: Path) -> list[str]:
    """Return where the results are, and what takes them."""
    lines = [f"{folder / 'identify.html'}", f"{folder / 'parameters.toml'}: for --parameters"]
    numbers_of_parts = fit.beyond_parameter_file
    if numbers_of_parts:
        lines[-1] += f", without {', '.join(numbers_of_parts)}, which it cannot hold"
        lines.append(f"{folder / 'scenario.toml'}: the first trial, with all values, for swim")
    if any(name.startswith("robot.") for name in numbers_of_parts):
        lines.append(f"{folder / 'robot.toml'}: the robot, with all values, for --robot")
    lines.append(
        f"Any other gait, with an interval: laticauda predict {folder} --amplitude-deg ..."
    )
    return lines


def _without_prior(row: Mapping[str, Any]) -> dict[str, Any]:
    """Return a row of the parameters without what was stated about it."""
    return {name: cell for name, cell in row.items() if name not in ("prior", "range")}
