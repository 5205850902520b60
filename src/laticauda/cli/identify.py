"""`laticauda identify`: physical parameters with their uncertainty from measured trials."""

import json
import shlex
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from laticauda.cli.flags import (
    BadFlag,
    File,
    Folder,
    Inputs,
    Maybe,
    MaybeName,
    Words,
    flag,
    options_of,
    read,
)
from laticauda.cli.scene import was_typed
from laticauda.cli.tables import MISSING, aligned, number
from laticauda.errors import BadArgument
from laticauda.quantities import option, quantity, value

if TYPE_CHECKING:
    from laticauda.identify.tasks import Task
    from laticauda.identify.unknowns import Unknown
    from laticauda.identify.validation import Validation

FORM = "NAME, NAME=LOW:HIGH or NAME=MEAN+-SD, as water.normal_drag=0.5:4"
_FORMAT = "{desc} {percentage:3.0f} % |{bar}| {remaining} left"


@value
class What:
    """What is identified, from what."""

    parameters: Words = option(
        "NAME, NAME=LOW:HIGH or NAME=MEAN+-SD: numbers of robot and water, with dots as in a sweep, each with its "
        "range or with what is known of it before; for one gait only: eel_like.water.tangential_friction",
        default=(),
    )
    measured: Words = option(
        "NAME=SIGMA: what counts of the trials, with the standard deviation of its noise in SI units: figures, as "
        "forward_velocity or mean_power, and series, as center_of_mass, heading, joint_angle, joint_torque",
        default=("center_of_mass=0.005",),
    )
    interval: float = quantity("s", "Between the samples of series that count", gt=0.0, default=0.5)
    columns: File = option("What the columns are of files that laticauda did not write: a TOML file", default=None)
    table1: bool = option("The paper's Table 1 instead of files", default=False)


@value
class Fixed:
    """What stays as it is."""

    robot: MaybeName = option(
        "What has to have swum, a preset or a TOML file: trials of another one are refused", default=None
    )
    base: MaybeName = option(
        "A parameter file with the numbers that are not identified, and a joint law; what the trials say if left out",
        default=None,
    )
    joints: Maybe = option("How the joints follow the gait; the base's law, or prescribed, if left out", default=None)
    model: Literal["planar", "spatial"] = option(
        "The model of the body; the one in MuJoCo takes long", default="planar"
    )


@value
class Method:
    """How."""

    noise: Literal["known", "estimated"] = option(
        "Whether the noise is as stated, or that times a factor that the residuals say", default="estimated"
    )
    starts: int = quantity("", "How many starts the search has", ge=1, default=4)
    seed: int = quantity("", "Of the further starts", ge=0, default=0)
    profiles: bool = option("Intervals from the likelihood itself too", default=False)
    exact: bool = option("Leave out every measurement by a refit, not by the linearized model", default=False)
    quick: bool = option("Leave out no groups", default=False)
    threads: int | None = quantity("", "How many trials run at once; one per core if left out", ge=1, default=None)


@value
class Results:
    """What becomes of it."""

    name: Maybe = option("Of the parameter file; the task file's, or identified, if left out", default=None)
    output: Folder = option(
        "The folder; made if need be, files of the same names are replaced", default="identification"
    )
    json: bool = option("Print one JSON object in SI units instead of the tables", default=False)


@value
class Identify:
    """Identify physical parameters with their uncertainty from measured trials.

    For example: laticauda identify run-1.nc run-2.nc --parameters water.tangential_friction water.normal_drag=0.5:4
    --robot mamba --output tank

    The same from one file that holds everything: laticauda identify tank.toml. Writes parameters.toml, for the option
    --parameters of other commands, the report identify.html, fit.json, figures and tables.
    """

    files: Inputs = option(
        "One TOML file that says everything, or trials: netCDF, MCAP, and with --columns CSV, C3D, TSV and more",
        default=(),
    )
    what: What = option("What is identified, from what", default=What())
    fixed: Fixed = option("What stays as it is", default=Fixed())
    method: Method = option("How", default=Method())
    result: Results = option("What becomes of it", default=Results())
    words: Any = option("What was typed, for the report", default=())

    @classmethod
    def read(cls, words: Sequence[str], prog: str) -> "Identify":
        """The command that was typed.

        Args:
            words: Behind its name.
            prog: What the help calls it.
        """
        return replace(read(cls, words, prog), words=tuple(words))

    def __call__(self) -> int:
        """Identify, write, print, and return the exit status."""
        from laticauda.errors import SimulationFailed
        from laticauda.identify.validation import validate
        from laticauda.reports.chapter import templates, writable_folder
        from laticauda.reports.identify import as_dict, write_identification

        task = self._task()
        folder = Path(self.result.output)
        command, show = (
            shlex.join(["laticauda", "identify", *(word for word in self.words if word != "--json")]),
            _progress(),
        )
        writable_folder(folder)
        templates()  # what the report needs is asked for before the search
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
            names = {"starts": "n_starts", "seed": "seed", "noise": "noise"}
            typed = {names[name]: getattr(self.method, name) for name in names if was_typed(name, self.words)}
            options = {**task.options, **typed}
            return replace(task, options=options, name=self.result.name or task.name)
        return self._task_of_flags()

    def _refuse_beside_a_file(self) -> None:
        for name, given in (options_of(self.what) | options_of(self.fixed)).items():
            if was_typed(name, self.words):
                raise BadFlag(f"{flag(name)} must not be given beside a file that says everything, got {given!r}.")

    def _task_of_flags(self) -> "Task":
        from laticauda.identify.measurements import from_table1
        from laticauda.identify.tasks import fixed, task_of_files
        from laticauda.identify.trial_files import TrialFile
        from laticauda.robot import load_parameters, load_robot

        if not self.files and not self.what.table1:
            raise BadFlag("FILE must be a TOML file that says everything, or at least one trial, got none.")
        if not self.what.parameters:
            raise BadFlag("--parameters must name at least one number to identify, as water.normal_drag, got none.")
        figures, series = _measured(self.what.measured)
        names = _names(self.files)
        trials = [
            TrialFile(
                file=file,
                columns=None if Path(file).suffix.lower() in (".nc", ".mcap") else self.what.columns,
                name=name,
                figures=figures,
                series=series,
                interval=self.what.interval,
            )
            for file, name in zip(self.files, names, strict=True)
        ]
        base = None if self.fixed.base is None else load_parameters(self.fixed.base)
        joints = self.fixed.joints or (base.joints if base is not None else None) or "prescribed"
        options: dict[str, Any] = {
            "joints": joints,
            "model": self.fixed.model,
            "noise": self.method.noise,
            "n_starts": self.method.starts,
            "seed": self.method.seed,
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
            rule = f"must be NAME=SIGMA with SIGMA > 0, as forward_velocity=0.01, got {word!r}"
            raise BadArgument("measured", rule)
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
    raise BadArgument("parameters", f"must be {FORM}, got {word!r}")


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
