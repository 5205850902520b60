"""Identification task: measurements, unknowns and method together, from a TOML file or from a few trials.

    kind = "identification"
    format = 2                             # of the file; default: the current one
    name = "tank-2026"                     # of the resulting parameter file
    title = "identified in the tank"
    robot = "mamba"                        # a preset or a file; default: that of the trials
    joints = "servo"                       # prescribed, pd, servo or speed-servo
    noise = "estimated"                    # or known
    starts = 4
    seed = 0
    parameters = [
        "water.normal_drag",
        {name = "water.tangential_friction", start = 0.15, lower = 0.01, upper = 1.0, prior = [0.2, 0.1]},
    ]

    [fixed.water]                          # tables of a parameter file: values that are not identified
    normal_drag = 1.75

    [[trials]]
    file = "run-1.nc"                      # relative to this file; .csv, .c3d and .tsv need columns = "map.toml"
    figures = {forward_velocity = 0.005}   # name = standard deviation of its noise
    series = {center_of_mass = 0.003}
    interval = 0.5                         # between the samples of series that are used [s]
    free_start = true                      # also identify where it began, if the path is used

    [table]                                # speeds, one row per trial: a CSV file, see `laticauda.trials.measured`
    file = "speeds.csv"
    sigma = 0.05                           # of rows that do not state their own, as a fraction

    [table1]                               # also the paper's Table 1
    sigma = 0.05

The file is read strictly: anything unknown, missing or out of range is rejected with its key.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

import laticauda as lc
from laticauda import scenarios
from laticauda.identify.fitting import Keep, fit
from laticauda.identify.measurements import SERIES, Measurement, from_trial
from laticauda.identify.result import Fit, Method
from laticauda.identify.tables import FIGURES, TABLE_SIGMA, from_table, from_table1
from laticauda.identify.unknowns import Unknown, as_unknowns, numbers_by_name
from laticauda.models.simulate.numbers import UNITS
from laticauda.models.simulate.runner import Progress, silent
from laticauda.robot.files import read_table
from laticauda.robot.parameters import NAMES, adjust, read_adjustments
from laticauda.values import codec
from laticauda.values.checks import check_choice, check_label
from laticauda.values.errors import BadArgument, RobotFileError
from laticauda.values.quantities import check_one_among, option, quantity, value_class

KIND = "identification"
_METHOD = ("model", "joints", "noise", "loss", "n_starts", "seed", "confidence")
OPTIONS = {name.removeprefix("n_"): name for name in _METHOD}
"""Keys of the method, and the corresponding arguments of `fit`."""
Table = Mapping[str, Any]

_NOISES: Any = {"default_factory": dict[str, float], "check": numbers_by_name("standard deviation")}
PATH = {"center_of_mass": 0.005}
"""Series of a trial used by default: the path as seen by a camera, with its noise [m]."""


@value_class
class TrialFile:
    """A file with a trial, and the parts of it that are used."""

    file: str = option("Path of the trial file")
    columns: str | None = option(
        "Column map (TOML), if another program wrote the file", default=None
    )
    name: str = option("Name in tables; empty: that of the file", default="")
    group: str = option("Group of measurements it belongs to, see `Measurement`", default="")
    figures: Mapping[str, float] = option("Figures to fit, with their noise", **_NOISES)
    series: Mapping[str, float] = option(
        "Series to fit, with their noise; if none: `PATH`", **_NOISES
    )
    interval: float = quantity(
        "s", "Between samples used; the noise of closer ones is hardly new", default=0.5, gt=0.0
    )
    free_start: bool = option(
        "Also identify the initial position and heading, if either is used", default=True
    )

    @property
    def label(self) -> str:
        """Name in tables."""
        return self.name or Path(self.file).stem

    @property
    def counted_series(self) -> Mapping[str, float]:
        """Series that are used; the path if nothing else was requested."""
        return self.series if self.series or self.figures else PATH

    @property
    def sources(self) -> tuple[Path, ...]:
        """Files that it is read from."""
        return tuple(Path(name) for name in (self.file, self.columns) if name is not None)

    def beside(self, folder: Path) -> "TrialFile":
        """Return the same with its paths relative to a folder.

        Args:
            folder: Folder to prepend to its paths.
        """
        columns = None if self.columns is None else str(folder / self.columns)
        return replace(self, file=str(folder / self.file), columns=columns)

    def measurement(self) -> Measurement:
        """Return the trial as a measurement.

        Raises:
            TrialFileError: If it cannot be read.
            ValueError: If it has no gait, or lacks a figure or series to be used.
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


@value_class
class TableFile:
    """A file with one row per trial."""

    file: str = option("Path of the table; for its columns see `laticauda.trials.measured`")
    figure: str = option(
        "forward_velocity or mean_power", default=FIGURES[0], check=check_one_among(*FIGURES)
    )
    sigma: float = quantity(
        "", "Relative noise of rows that do not state their own", default=TABLE_SIGMA, gt=0.0
    )


@value_class
class _TaskFile:
    """Contents of a task's file apart from the method."""

    name: str = option("Name of the resulting parameter file", check=check_label)
    title: str = option("Text for legends", check=check_label)
    robot: str | None = option(
        "Robot that must have swum, a preset or a file; None: as in the trials", default=None
    )
    links: int | None = quantity(
        "", "Number of links of every robot, instead of its own", ge=1, default=None
    )
    parameters: tuple[Unknown, ...] = option("Numbers to identify", default=())
    base: str | None = option(
        "Parameter file (a preset or a path) with the fixed values", default=None
    )
    fixed: Mapping[str, Any] | None = option(
        "Tables of a parameter file with the fixed values", default=None
    )
    trials: tuple[TrialFile, ...] = option(
        "Trial files, with paths relative to this file", default=()
    )
    table: TableFile | None = option(
        "Measured speeds, a CSV file with a path relative to this file", default=None
    )
    table1: Mapping[str, Any] | bool | None = option(
        "Arguments of `from_table1`, or true", default=None
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Task:
    """What is to be identified, from which measurements, and how."""

    name: str
    """Name of the resulting parameter file."""
    title: str
    """Text for legends."""
    measurements: tuple[Measurement, ...]
    """Measurements, with all fixed values applied to their robots and waters."""
    unknowns: tuple[Unknown, ...]
    """Unknowns to be identified."""
    robot: lc.Robot | None = None
    """Robot that must have swum; None: that of the trials."""
    base: lc.Parameters | None = None
    """Fixed values."""
    options: Mapping[str, Any] = field(default_factory=dict[str, Any])
    """Arguments of `fit`."""
    sources: tuple[Path, ...] = ()
    """Files that it was read from."""

    def run(
        self, *, threads: int | None = None, progress: Progress = silent, keep: Keep = silent
    ) -> Fit:
        """Run the identification.

        Args:
            threads: Number of threads; None uses all cores available to this process.
            progress: Called periodically with the finished fraction, from 0 to 1.
            keep: Called with the best values by name and their sum of squares, whenever they
                improve.

        Raises:
            ValueError: If there are too few measurements for the unknowns, or an argument is out of
                its range.
            RobotFileError: If the error is in the task's file.
        """
        how: Any = {**self.options, "threads": threads, "progress": progress, "keep": keep}
        try:
            return fit(self.measurements, self.robot, parameters=self.unknowns, **how)
        except BadArgument as error:
            if error.name == "threads" or not self.sources:  # all else comes from the file
                raise
            raise RobotFileError(f"{self.sources[0]}: key `{error.name}`: {error.rule}") from None

    def with_law(self, law: lc.Parameters) -> "Task":
        """Return the task with water, joints and all else of a parameter file, where the task does not set them.

        Args:
            law: The parameter file; the task has none of its own.
        """
        joints = {} if law.joints is None else {"joints": law.joints}
        return replace(
            self,
            name=f"{self.name}-{law.name}",
            title=f"{self.title}, {law.title}",
            measurements=tuple(apply_fixed_values(one, None, law) for one in self.measurements),
            base=law,
            options={**joints, **self.options},
        )

    def parameters(self, found: Fit) -> lc.Parameters:
        """Return the identified and the fixed values as one parameter file.

        Args:
            found: Fit from `run`.
        """
        kept, base = found.parameters(self.name, self.title), self.base
        if base is None:
            return kept
        changes = codec.merge_tables(dict(base.changes), dict(kept.changes))
        return replace(
            kept,
            changes=changes,
            own_changes=codec.merge_tables(dict(base.own_changes), dict(kept.own_changes)),
        )


def compare_laws(
    measurements: Sequence[Measurement],
    laws: Sequence[str | Path | lc.Parameters],
    *,
    parameters: Sequence[str | Unknown],
    **how: Any,
) -> dict[str, Fit]:
    """Fit the same unknowns with each of several laws; null models can be compared with any of them.

    Args:
        measurements: The measurements.
        laws: Parameter files, presets or paths: the values of water, joints and robot that are not
            fitted.
        parameters: Names of the numbers to identify, or `Unknown`s with ranges and priors.
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
    task = Task(
        name="laws", title="laws", measurements=tuple(measurements), unknowns=every, options=how
    )
    bases = [law if isinstance(law, lc.Parameters) else lc.load_parameters(law) for law in laws]
    return {base.name: task.with_law(base).run() for base in bases}


def load_task(path: str | Path) -> Task:
    """Read a task from its TOML file.

    Args:
        path: Path of the file; the trials and tables that it names are relative to its folder.

    Raises:
        RobotFileError: If it does not exist, or anything in it is invalid; the message has file,
            key and rule.
        TrialFileError: If a trial in it cannot be read.
    """
    file = Path(path)
    table = read_table(file)
    with codec.keys_of(file, RobotFileError):
        task = task_from_table(table, file.stem, file.parent)
        try:
            Method(
                **{
                    name: given
                    for name, given in task.options.items()
                    if name in Method.__dataclass_fields__
                }
            )
            scenarios.model_of(
                task.options.get("model", "planar"), joints=task.options.get("joints", "prescribed")
            )
        except BadArgument as error:
            raise codec.BadKey(error.name.removeprefix("n_"), error.rule) from None
    return replace(task, sources=(file, *task.sources))


def task_from_table(table: Table, name: str, folder: Path) -> Task:
    """Build the task that a table, as read from a file, defines.

    Args:
        table: Table as returned by a TOML reader.
        name: Name of the parameter file, if the table has none.
        folder: Folder of the trials and tables that it names.

    Raises:
        BadKey: If anything in it is invalid.
        RobotFileError: If a robot or parameter file is invalid.
        TrialFileError: If a trial in it cannot be read.
    """
    table = {"name": name, **table}
    codec.take_kind(table, KIND)
    codec.check_keys(table, (*_TaskFile.__dataclass_fields__, *OPTIONS))
    options = {OPTIONS[key]: table.pop(key) for key in OPTIONS if key in table}
    for key, only in (("parameters", "name"), ("trials", "file")):  # a string in place of a table
        if isinstance(table.get(key), list):
            table[key] = [
                {only: entry} if isinstance(entry, str) else entry for entry in table[key]
            ]
    said = codec.decode(_TaskFile, {"title": table["name"], **table})
    if not said.parameters:
        raise codec.BadKey("parameters", "must name at least one number to identify")
    if not said.trials and said.table is None and said.table1 is None:
        raise codec.BadKey(
            "trials", "is missing; the task needs trials, [table] or [table1] to identify from"
        )
    base = _base(said)
    if base is not None and base.joints is not None:
        options.setdefault("joints", base.joints)
    robot = None if said.robot is None else lc.load_robot(said.robot, said.links)
    trials = [one.beside(folder) for one in said.trials]
    measured = [apply_fixed_values(trial.measurement(), None, base) for trial in trials]
    rows, files = _tables(said, folder)
    measured += [apply_fixed_values(measurement, said.links, base) for measurement in rows]
    return Task(
        name=said.name,
        title=said.title,
        measurements=tuple(measured),
        unknowns=said.parameters,
        robot=None if robot is None else adjust(robot, base.changes if base else {}),
        base=base,
        options=options,
        sources=(*(path for trial in trials for path in trial.sources), *files),
    )


def apply_fixed_values(
    measurement: Measurement, links: int | None, base: lc.Parameters | None
) -> Measurement:
    """Return a measurement with the fixed values of robot and water applied.

    Args:
        measurement: Measurement as read.
        links: Number of links that replaces that of its robot; None: its own.
        base: Fixed values; None: those of the measurement.
    """
    scenario = measurement.scenario
    robot, kind = (
        scenario.robot if links is None else scenario.robot.with_links(links),
        scenario.gait.kind,
    )
    if base is not None:
        scenario = replace(scenario, robot=base.robot(robot, kind), environment=base.water(kind))
    elif robot is not scenario.robot:
        scenario = replace(scenario, robot=robot)
    return replace(measurement, scenario=scenario)


def _base(said: _TaskFile) -> lc.Parameters | None:
    """Return the fixed values: from a parameter file, from its tables in the task, or from both."""
    base = None if said.base is None else lc.load_parameters(said.base)
    if said.fixed is None:
        return base
    codec.check_keys(said.fixed, ("water", *NAMES), "fixed")
    usual = scenarios.preset_water("paper-lateral") if base is None else base.every_gait
    water = codec.updated(usual, said.fixed.get("water", {}), "fixed.water")
    changes = read_adjustments(
        {key: said.fixed[key] for key in NAMES if key in said.fixed}, "fixed"
    )
    if base is None:
        return lc.Parameters(name=said.name, title=said.name, every_gait=water, changes=changes)
    return replace(base, every_gait=water, changes=codec.merge_tables(dict(base.changes), changes))


def _tables(said: _TaskFile, folder: Path) -> tuple[list[Measurement], list[Path]]:
    """Return the table rows to identify from, the task's own and the paper's, and the files that hold them."""
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
        check_choice(f"measured` of `{name}", what, (*UNITS, *SERIES))
        if what in trial.not_measured:
            raise BadArgument(
                what, f"of `{name}` must have been measured to be fitted; the file does not have it"
            )
