"""`laticauda identify`: physical parameters with their uncertainty from measured trials."""

import json
import shlex
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

import tyro

from laticauda.cli.flags import File, Number, Preset, Switch, Text, Whole, choice, default
from laticauda.cli.flags import Words as ListOfWords
from laticauda.cli.messages import flag, given
from laticauda.cli.tables import MISSING, aligned, number

if TYPE_CHECKING:
    from laticauda.identify.tasks import Task
    from laticauda.identify.unknowns import Unknown
    from laticauda.identify.validation import Validation

FOLDER = "identification"
FORM = "NAME, NAME=LOW:HIGH or NAME=MEAN+-SD, as water.normal_drag=0.5:4"
_FORMAT = "{desc} {percentage:3.0f} % |{bar}| {remaining} left"


@dataclass(frozen=True, kw_only=True)
class WhatFlags:
    """What is identified, from what."""

    parameters: Annotated[
        ListOfWords, tyro.conf.arg(metavar="NAME[=LOW:HIGH|=MEAN+-SD] ..."), default("the file's")
    ] = ()
    """Numbers of robot and water, with dots as in a sweep, each with its range or with what is known of it before; for
    one gait only: eel_like.water.tangential_friction."""
    measured: Annotated[ListOfWords, tyro.conf.arg(metavar="NAME=SIGMA ..."), default("center_of_mass=0.005")] = ()
    """What counts of the trials, with the standard deviation of its noise in SI units: figures, as forward_velocity or
    mean_power, and series, as center_of_mass, heading, joint_angle, joint_torque."""
    interval: Annotated[Number, default("0.5")] = None
    """Between the samples of series that count [s]."""
    columns: File = None
    """What the columns are of files that laticauda did not write: a TOML file."""
    table1: Switch = False
    """The paper's Table 1 instead of files."""


@dataclass(frozen=True, kw_only=True)
class ModelFlags:
    """What stays as it is."""

    robot: Annotated[Preset, default("the trials'")] = None
    """What has to have swum: a preset or a TOML file; trials of another one are refused."""
    base: Annotated[Preset, default("what the trials say")] = None
    """A parameter file with the numbers that are not identified, and a joint law."""
    joints: Annotated[str | None, choice("prescribed", "pd", "servo"), default("the base's, or prescribed")] = None
    """How the joints follow the gait."""
    model: Annotated[str | None, choice("planar", "spatial"), default("planar")] = None
    """The model of the body; the one in MuJoCo takes long."""


@dataclass(frozen=True, kw_only=True)
class MethodFlags:
    """How."""

    noise: Annotated[str | None, choice("known", "estimated"), default("estimated")] = None
    """Whether the noise is as stated, or that times a factor that the residuals say."""
    starts: Annotated[Whole, default("4")] = None
    """How many starts the search has."""
    seed: Annotated[Whole, default("0")] = None
    """Of the further starts."""
    profiles: Switch = False
    """Intervals from the likelihood itself too."""
    exact: Switch = False
    """Leave out every measurement by a refit, not by the linearized model."""
    quick: Switch = False
    """Leave out no groups."""
    threads: Annotated[Whole, default("one per core")] = None
    """How many trials run at once."""


@dataclass(frozen=True, kw_only=True)
class ResultFlags:
    """What becomes of it."""

    name: Annotated[Text, default("the file's, or identified")] = None
    """Of the parameter file."""
    output: Annotated[Text, tyro.conf.arg(metavar="DIR"), default(FOLDER)] = None
    """The folder; made if need be, files of the same names are replaced."""
    json: Switch = False
    """Print one JSON object in SI units instead of the tables."""


@dataclass(frozen=True, kw_only=True)
class Identify:
    """Identify physical parameters with their uncertainty from measured trials.

    For example: laticauda identify run-1.nc run-2.nc --parameters water.tangential_friction water.normal_drag=0.5:4
    --robot mamba --output tank

    The same from one file that holds everything: laticauda identify tank.toml. Writes parameters.toml, for the option
    --parameters of other commands, the report identify.html, fit.json, figures and tables.
    """

    files: Annotated[
        tuple[str, ...], tyro.conf.Positional, tyro.conf.arg(metavar="FILE ...", help_behavior_hint="(default: none)")
    ] = ()
    """One TOML file that says everything, or trials: netCDF, MCAP, and with --columns CSV, C3D, TSV and more."""
    what: WhatFlags = field(default_factory=WhatFlags)
    fixed: ModelFlags = field(default_factory=ModelFlags)
    method: MethodFlags = field(default_factory=MethodFlags)
    result: ResultFlags = field(default_factory=ResultFlags)

    def __call__(self) -> int:
        """Identify, write, print, and return the exit status."""
        from laticauda.errors import SimulationFailed
        from laticauda.identify.validation import validate
        from laticauda.reports.chapter import writable_folder
        from laticauda.reports.identify import as_dict, write_identification

        task = self._task()
        folder = Path(FOLDER if self.result.output is None else self.result.output)
        command, show = self._command(), _progress()
        try:
            writable_folder(folder)
        except ValueError as error:
            raise ValueError(str(error).replace("`folder`", "--output")) from error
        try:
            found = task.run(threads=self.method.threads, progress=lambda share: show("search", share))
            done = validate(
                task,
                found,
                exact=self.method.exact,
                by_group=not self.method.quick,
                profiles=self.method.profiles,
                progress=show,
            )
        except SimulationFailed as error:
            print(f"laticauda: {error}", file=sys.stderr)
            return 1
        files = write_identification(done, folder, command=command)
        if self.result.json:
            listed = as_dict(done, command) | {"output": str(folder), "files": files}
            print(json.dumps(listed, indent=2, allow_nan=False))
        else:
            print(as_text(done, folder))
        return 0 if found.searches[0].converged else 1

    def _task(self) -> "Task":
        """What is asked for."""
        from laticauda.identify.tasks import load_task

        if len(self.files) == 1 and self.files[0].lower().endswith(".toml"):
            self._refuse_beside_a_file()
            task = load_task(self.files[0])
            more = {"n_starts": self.method.starts, "seed": self.method.seed, "noise": self.method.noise}
            options = {**task.options, **{name: value for name, value in more.items() if value is not None}}
            return replace(task, options=options, name=self.result.name or task.name)
        return self._task_of_flags()

    def _refuse_beside_a_file(self) -> None:
        for group in (self.what, self.fixed):
            for name, value in given(group).items():
                if value:
                    raise ValueError(
                        f"{flag(name)} must not be given beside a file that says everything, got {value!r}."
                    )

    def _task_of_flags(self) -> "Task":
        from laticauda.identify.measurements import from_table1
        from laticauda.identify.tasks import fixed, task_of_files
        from laticauda.identify.trial_files import TrialFile
        from laticauda.robot import load_parameters, load_robot

        if not self.files and not self.what.table1:
            raise ValueError("FILE must be a TOML file that says everything, or at least one trial, got none.")
        if not self.what.parameters:
            raise ValueError("--parameters must name at least one number to identify, as water.normal_drag, got none.")
        figures, series = _measured(self.what.measured)
        more: dict[str, Any] = {} if self.what.interval is None else {"interval": self.what.interval}
        names = _names(self.files)
        trials = [
            TrialFile(
                file=file,
                columns=None if Path(file).suffix.lower() in (".nc", ".mcap") else self.what.columns,
                name=name,
                figures=figures,
                series=series,
                **more,
            )
            for file, name in zip(self.files, names, strict=True)
        ]
        base = None if self.fixed.base is None else load_parameters(self.fixed.base)
        joints = self.fixed.joints or (base.joints if base is not None else None) or "prescribed"
        options: dict[str, Any] = {
            "joints": joints,
            "model": self.fixed.model or "planar",
            "noise": self.method.noise or "estimated",
            "n_starts": 4 if self.method.starts is None else self.method.starts,
            "seed": self.method.seed or 0,
        }
        name = self.result.name or "identified"
        task = task_of_files(
            trials,
            [_unknown(word) for word in self.what.parameters],
            name=name,
            title=name,
            robot=None if self.fixed.robot is None else load_robot(self.fixed.robot),
            base=base,
            options=options,
        )
        if not self.what.table1:
            return task
        table = [fixed(measurement, None, base) for measurement in from_table1()]
        return replace(task, measurements=(*task.measurements, *table))

    def _command(self) -> str:
        """The command, as it was typed but for the order of its options."""
        words = ["laticauda", "identify", *self.files]
        for name, value in given(self).items():
            if name in ("files", "json") or value == ():
                continue
            words.append("--output" if name == "output" else flag(name))
            if isinstance(value, tuple):
                words += map(str, cast("tuple[object, ...]", value))
            elif value is not True:
                words.append(str(value))
        return shlex.join(words)


def _names(files: Sequence[str]) -> list[str]:
    """Short names of trials: the files' own, with their folder where two are alike."""
    short = [Path(file).stem for file in files]
    return [one if short.count(one) == 1 else file for one, file in zip(short, files, strict=True)]


def _measured(words: Sequence[str]) -> tuple[dict[str, float], dict[str, float]]:
    """Figures and series that count."""
    from laticauda.errors import one_of
    from laticauda.identify.measurements import SERIES
    from laticauda.simulate.sensitivities import UNITS

    figures: dict[str, float] = {}
    series: dict[str, float] = {}
    for word in words:
        name, equals, text = word.partition("=")
        try:
            sigma = float(text)
        except ValueError:
            equals, sigma = "", 0.0
        if not equals or sigma <= 0.0:
            raise ValueError(f"`measured` must be NAME=SIGMA with SIGMA > 0, as forward_velocity=0.01, got {word!r}.")
        one_of("measured", name, (*UNITS, *SERIES))
        (series if name in SERIES else figures)[name] = sigma
    return figures, series


def _unknown(word: str) -> "Unknown":
    """One of `parameters`."""
    from laticauda.identify.unknowns import Unknown

    name, equals, text = word.rpartition("=")
    if not equals:
        return Unknown(name=word)
    for sign in (":", "+-"):
        low, found, high = text.partition(sign)
        if found:
            try:
                first, second = float(low), float(high)
            except ValueError:
                break
            if sign == ":":
                return Unknown(name=name, lower=first, upper=second)
            return Unknown(name=name, prior=(first, second))
    raise ValueError(f"`parameters` must be {FORM}, got {word!r}.")


def as_text(done: "Validation", folder: Path) -> str:
    """The parameters, what the data do not see, the errors, and where everything is.

    Args:
        done: What was found.
        folder: Where it was written.
    """
    found = done.found
    rows = [["parameter", "value", "", "+-", f"{100 * found.confidence:g} % interval", "", ""]]
    shown = found.problem.of_interest
    for estimate in (found.estimates[k] for k in shown):
        if estimate.interval is None:
            cells = [MISSING, estimate.unit, MISSING, MISSING]
        else:
            low, high = map(number, estimate.interval)
            cells = [number(estimate.value), estimate.unit, number(estimate.sigma or 0.0), f"{low} to {high}"]
        rows.append([estimate.name, *cells, "", estimate.note])
    parts = [found.status, aligned(rows, right=(1, 3))]
    if len(shown) < len(found.estimates):
        parts[-1] += f"\nand {len(found.estimates) - len(shown)} numbers of where the trials began."
    if found.warnings:
        parts.append("\n".join(found.warnings))
    if done.error(found.predictions) is not None:
        parts.append(_errors(done))
    parts.append(f"{folder / 'identify.html'}\n{folder / 'parameters.toml'}: for --parameters")
    return "\n\n".join(parts)


def _errors(done: "Validation") -> str:
    def shown(value: float | None) -> str:
        return MISSING if value is None or value != value else f"{value:.1f} %"

    by_group = None if done.by_group is None else done.by_group.predictions
    mine = (done.error(done.found.predictions), done.error(done.left_out), done.error(by_group))
    rows = [["mean error of forward velocity", "fitted", "left out", "group left out"], ["this fit", *map(shown, mine)]]
    for null in done.null_models:
        rows.append([f"null model: {null.name}", *map(shown, (null.fitted, null.left_out, null.group_left_out))])
    return aligned(rows, right=(1, 2, 3))


def _progress() -> Callable[[str, float], None]:
    """A bar on standard error for each part of the work, if that is a terminal."""
    bars: dict[str, Any] = {}

    def show(what: str, share: float) -> None:
        if not sys.stderr.isatty():
            return
        if what not in bars:
            from tqdm import tqdm

            bars[what] = tqdm(total=1.0, desc=what, bar_format=_FORMAT, leave=False, file=sys.stderr)
        bars[what].n = share
        bars[what].refresh()
        if share >= 1.0:
            bars[what].close()

    return show
