"""An identification as a task: measurements, unknowns and method together, from a TOML file or from a few trials.

    kind = "identification"
    format = 2                             # of the file; left out: the present one
    name = "tank-2026"                     # of the parameter file that it makes
    title = "identified in the tank"
    robot = "mamba"                        # a preset or a file; left out: the trials say it
    joints = "servo"                       # prescribed, pd, servo or speed-servo
    noise = "estimated"                    # or known
    starts = 4
    seed = 0
    parameters = [
        "water.normal_drag",
        {name = "water.tangential_friction", start = 0.15, lower = 0.01, upper = 1.0, prior = [0.2, 0.1]},
    ]

    [fixed.water]                          # tables of a parameter file: what is not identified
    normal_drag = 1.75

    [[trials]]
    file = "run-1.nc"                      # beside this file; .csv, .c3d and .tsv need columns = "map.toml"
    figures = {forward_velocity = 0.005}   # name = standard deviation of its noise
    series = {center_of_mass = 0.003}
    interval = 0.5                         # between the samples of series that count [s]
    free_start = true                      # identify where it began too, if the path counts

    [table]                                # speeds, one row a trial: a CSV file, see `laticauda.trial.measured`
    file = "speeds.csv"
    sigma = 0.05                           # of rows that do not say their own, as a share

    [table1]                               # the paper's Table 1 too
    sigma = 0.05

It is read strictly: what is unknown, missing or out of range is refused with its key.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

import laticauda as lc
from laticauda import codec, scenarios
from laticauda.errors import BadArgument, RobotFileError, label, one_of
from laticauda.identify.fitting import Keep, fit
from laticauda.identify.measurements import SERIES, Measurement, from_trial
from laticauda.identify.result import Fit, Method
from laticauda.identify.tables import FIGURES, TABLE_SIGMA, from_table, from_table1
from laticauda.identify.unknowns import Unknown, as_unknowns, numbers_by_name
from laticauda.quantities import one_among, option, quantity, value
from laticauda.robot.files import read_table
from laticauda.robot.parameters import NAMES, adjusted, read_adjustments
from laticauda.simulate.numbers import UNITS
from laticauda.simulate.runner import Progress, silent

KIND = "identification"
_METHOD = ("model", "joints", "noise", "loss", "n_starts", "seed", "confidence")
OPTIONS = {name.removeprefix("n_"): name for name in _METHOD}
"""Keys of the method, and the arguments of `fit` that they are."""
Table = Mapping[str, Any]

_NOISES: Any = {"default_factory": dict[str, float], "check": numbers_by_name("standard deviation")}
PATH = {"center_of_mass": 0.005}
"""What counts of a trial unless one says otherwise: the path, as a camera sees it [m]."""


@value
class TrialFile:
    """A file with a trial, and what counts of it."""

    file: str = option("Where it is")
    columns: str | None = option("What its columns are, a TOML file, if another program wrote it", default=None)
    name: str = option("What tables call it; empty: as the file", default="")
    group: str = option("Which measurements it belongs with, see `Measurement`", default="")
    figures: Mapping[str, float] = option("That count, with their noise", **_NOISES)
    series: Mapping[str, float] = option("Series that count; if none: `PATH`", **_NOISES)
    interval: float = quantity("s", "Between samples that count; closer ones' noise is hardly new", default=0.5, gt=0.0)
    free_start: bool = option("Identify place and heading at the begin too, if either counts", default=True)

    @property
    def label(self) -> str:
        """What tables call it."""
        return self.name or Path(self.file).stem

    @property
    def counted_series(self) -> Mapping[str, float]:
        """Series that count, the path if nothing else was asked for."""
        return self.series if self.series or self.figures else PATH

    @property
    def sources(self) -> tuple[Path, ...]:
        """The files that it is read from."""
        return tuple(Path(name) for name in (self.file, self.columns) if name is not None)

    def beside(self, folder: Path) -> "TrialFile":
        """The same, its paths relative to a `folder`.

        Args:
            folder: What its paths are to begin with.
        """
        columns = None if self.columns is None else str(folder / self.columns)
        return replace(self, file=str(folder / self.file), columns=columns)

    def measurement(self) -> Measurement:
        """The trial as a measurement.

        Raises:
            TrialFileError: If it cannot be read.
            ValueError: If it has no gait, or lacks what is to count.
        """
        trial = lc.load_trial(self.file, self.columns)
        _check_there(self.label, trial, [*self.figures, *self.counted_series])
        step = float(np.median(np.diff(trial.time))) if trial.time.size > 1 else self.interval
        try:
            return from_trial(
                trial,
                name=self.label,
                figures=self.figures,
                series=self.counted_series,
                every=max(1, round(self.interval / step)),
                group=self.group,
                free_start=self.free_start,
            )
        except ValueError as error:
            raise ValueError(f"{self.file}: {error}") from error


@value
class TableFile:
    """A file with one row a trial."""

    file: str = option("Where it is; `laticauda.trial.measured` says its columns")
    figure: str = option("forward_velocity or mean_power", default=FIGURES[0], check=one_among(*FIGURES))
    sigma: float = quantity("", "Noise of rows that do not say their own, as a share", default=TABLE_SIGMA, gt=0.0)


@value
class _TaskFile:
    """What a task's file says besides the method."""

    name: str = option("Name of the parameter file that it makes", check=label)
    title: str = option("What a legend says", check=label)
    robot: str | None = option("What has to have swum, a preset or a file; None: the trials say it", default=None)
    links: int | None = quantity("", "Links that every robot has instead of its own", ge=1, default=None)
    parameters: tuple[Unknown, ...] = option("What is looked for", default=())
    base: str | None = option("A parameter file, a preset or a path: what is fixed", default=None)
    fixed: Mapping[str, Any] | None = option("Tables of a parameter file: what is fixed", default=None)
    trials: tuple[TrialFile, ...] = option("Files of trials, beside this file", default=())
    table: TableFile | None = option("Speeds, a CSV file beside this one", default=None)
    table1: Mapping[str, Any] | bool | None = option("Arguments of `from_table1`, or true", default=None)


@dataclass(frozen=True, kw_only=True, eq=False)
class Task:
    """What is to be identified, from what, and how."""

    name: str
    """Name of the parameter file that it makes."""
    title: str
    """What a legend says."""
    measurements: tuple[Measurement, ...]
    """With robot and water, all that is fixed applied."""
    unknowns: tuple[Unknown, ...]
    """What is looked for."""
    robot: lc.Robot | None = None
    """What has to have swum; None: whatever the trials say."""
    base: lc.Parameters | None = None
    """What is fixed."""
    options: Mapping[str, Any] = field(default_factory=dict[str, Any])
    """Arguments of `fit`."""
    sources: tuple[Path, ...] = ()
    """The files that it was read from."""

    def run(self, *, threads: int | None = None, progress: Progress = silent, keep: Keep = silent) -> Fit:
        """Identify.

        Args:
            threads: How many to compute with; None takes all cores that this process may use.
            progress: Called now and then with the share that is finished, from 0 to 1.
            keep: Called with the best values by name and their sum of squares, whenever there are better ones.

        Raises:
            ValueError: If there are too few measurements for the unknowns, or an argument is out of its range.
            RobotFileError: If what will not do stands in the task's file.
        """
        how: Any = {**self.options, "threads": threads, "progress": progress, "keep": keep}
        try:
            return fit(self.measurements, self.robot, parameters=self.unknowns, **how)
        except BadArgument as error:
            if error.name == "threads" or not self.sources:  # all else stands in the file
                raise
            raise RobotFileError(f"{self.sources[0]}: key `{error.name}`: {error.rule}") from None

    def with_law(self, law: lc.Parameters) -> "Task":
        """The same with the water, the joints and all else of a parameter file, as far as the task does not say them.

        Args:
            law: The parameter file; the task has none of its own.
        """
        joints = {} if law.joints is None else {"joints": law.joints}
        return replace(
            self,
            name=f"{self.name}-{law.name}",
            title=f"{self.title}, {law.title}",
            measurements=tuple(fixed(one, None, law) for one in self.measurements),
            base=law,
            options={**joints, **self.options},
        )

    def parameters(self, found: Fit) -> lc.Parameters:
        """What was identified and what was fixed, as one parameter file.

        Args:
            found: From `run`.
        """
        kept, base = found.parameters(self.name, self.title), self.base
        if base is None:
            return kept
        changes = codec.merged(dict(base.changes), dict(kept.changes))
        return replace(kept, changes=changes, own_changes=codec.merged(dict(base.own_changes), dict(kept.own_changes)))


def compare_laws(
    measurements: Sequence[Measurement],
    laws: Sequence[str | Path | lc.Parameters],
    *,
    parameters: Sequence[str | Unknown],
    **how: Any,
) -> dict[str, Fit]:
    """Fit the same unknowns with one law after the other; null models stand beside any of them.

    Args:
        measurements: What was measured.
        laws: Parameter files, presets or paths: what is not fitted of water, joints and robot.
        parameters: Names of what is identified, or `Unknown`s with ranges and priors.
        how: Further arguments of `fit`.

    Returns:
        The fits by name of the parameter file; errors as for `fit`.

    Example:
        >>> from laticauda.identify import compare_laws, from_table1
        >>> names = ["water.tangential_friction"]
        >>> found = compare_laws(from_table1()[::4], ["paper", "mamba-identified"], parameters=names, n_starts=1)
        >>> list(found)
        ['paper', 'mamba-identified']
    """
    every = as_unknowns(parameters)
    task = Task(name="laws", title="laws", measurements=tuple(measurements), unknowns=every, options=how)
    bases = [law if isinstance(law, lc.Parameters) else lc.load_parameters(law) for law in laws]
    return {base.name: task.with_law(base).run() for base in bases}


def load_task(path: str | Path) -> Task:
    """Read a task from its TOML file.

    Args:
        path: Of the file; the files that it names lie beside it.

    Raises:
        RobotFileError: If it does not exist, or anything in it is wrong; the message has file, key and rule.
        TrialFileError: If a trial in it cannot be read.
    """
    file = Path(path)
    table = read_table(file)
    with codec.keys_of(file, RobotFileError):
        task = task_from_table(table, file.stem, file.parent)
        try:
            Method(**{name: given for name, given in task.options.items() if name in Method.__dataclass_fields__})
            scenarios.model_of(task.options.get("model", "planar"), joints=task.options.get("joints", "prescribed"))
        except BadArgument as error:
            raise codec.BadKey(error.name.removeprefix("n_"), error.rule) from None
    return replace(task, sources=(file, *task.sources))


def task_from_table(table: Table, name: str, folder: Path) -> Task:
    """The task that a table says, as a file holds it.

    Args:
        table: As a TOML reader gives it.
        name: Name of the parameter file, if the table says none.
        folder: Where the files lie that it names.

    Raises:
        BadKey: If anything in it is wrong.
        RobotFileError: If a robot or parameter file is wrong.
        TrialFileError: If a trial in it cannot be read.
    """
    table = {"name": name, **table}
    codec.take_kind(table, KIND)
    codec.check_keys(table, (*_TaskFile.__dataclass_fields__, *OPTIONS))
    options = {OPTIONS[key]: table.pop(key) for key in OPTIONS if key in table}
    for key, only in (("parameters", "name"), ("trials", "file")):  # a text in the place of a table
        if isinstance(table.get(key), list):
            table[key] = [{only: entry} if isinstance(entry, str) else entry for entry in table[key]]
    said = codec.decode(_TaskFile, {"title": table["name"], **table})
    if not said.parameters:
        raise codec.BadKey("parameters", "must name at least one number to identify")
    if not said.trials and said.table is None and said.table1 is None:
        raise codec.BadKey("trials", "is missing; trials, [table] or [table1] are what is identified from")
    base = _base(said)
    if base is not None and base.joints is not None:
        options.setdefault("joints", base.joints)
    robot = None if said.robot is None else lc.load_robot(said.robot, said.links)
    trials = [one.beside(folder) for one in said.trials]
    measured = [fixed(trial.measurement(), None, base) for trial in trials]
    rows, files = _tables(said, folder)
    measured += [fixed(measurement, said.links, base) for measurement in rows]
    return Task(
        name=said.name,
        title=said.title,
        measurements=tuple(measured),
        unknowns=said.parameters,
        robot=None if robot is None else adjusted(robot, base.changes if base else {}),
        base=base,
        options=options,
        sources=(*(path for trial in trials for path in trial.sources), *files),
    )


def fixed(measurement: Measurement, links: int | None, base: lc.Parameters | None) -> Measurement:
    """A measurement with what is fixed about robot and water.

    Args:
        measurement: As it was read.
        links: How many its robot has instead of its own; None: its own.
        base: What is fixed; None: what the measurement says.
    """
    scenario = measurement.scenario
    robot, kind = scenario.robot if links is None else scenario.robot.with_links(links), scenario.gait.kind
    if base is not None:
        scenario = replace(scenario, robot=base.robot(robot, kind), environment=base.water(kind))
    elif robot is not scenario.robot:
        scenario = replace(scenario, robot=robot)
    return replace(measurement, scenario=scenario)


def _base(said: _TaskFile) -> lc.Parameters | None:
    """What is fixed: a parameter file, its tables here, or both."""
    base = None if said.base is None else lc.load_parameters(said.base)
    if said.fixed is None:
        return base
    codec.check_keys(said.fixed, ("water", *NAMES), "fixed")
    usual = scenarios.preset_water("paper-lateral") if base is None else base.every_gait
    water = codec.updated(usual, said.fixed.get("water", {}), "fixed.water")
    changes = read_adjustments({key: said.fixed[key] for key in NAMES if key in said.fixed}, "fixed")
    if base is None:
        return lc.Parameters(name=said.name, title=said.name, every_gait=water, changes=changes)
    return replace(base, every_gait=water, changes=codec.merged(dict(base.changes), changes))


def _tables(said: _TaskFile, folder: Path) -> tuple[list[Measurement], list[Path]]:
    """The rows of tables, one's own and the paper's, that are identified from, and the files that they are in."""
    rows, files, own = list[Measurement](), list[Path](), said.table
    if own is not None:
        files.append(folder / own.file)
        rows += from_table(files[0], own.figure, sigma=own.sigma, robot=said.robot or "mamba")
    if said.table1 is not None and said.table1 is not False:
        arguments = {} if said.table1 is True else codec.table_of(said.table1, "table1")
        codec.check_keys(arguments, ("figure", "sigma", "selected_from"), "table1")
        with codec.arguments_of("table1"):
            rows += from_table1(**arguments)
    return rows, files


def _check_there(name: str, trial: lc.Trial, wanted: list[str]) -> None:
    for what in wanted:
        one_of(f"measured` of `{name}", what, (*UNITS, *SERIES))
        if what in trial.not_measured:
            raise BadArgument(what, f"of `{name}` must have been measured to count; the file does not have it")
