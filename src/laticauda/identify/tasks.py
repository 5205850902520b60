"""Identification task: measurements, unknowns and method together, from a TOML file or not.

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
        {name = "water.tangential_friction", start = 0.15, lower = 0.01, prior = [0.2, 0.1]},
    ]

    [fixed.water]                          # tables of a parameter file: fixed values
    normal_drag = 1.75

    [[trials]]
    file = "run-1.nc"                      # relative to this file; .csv needs columns = "map.toml"
    figures = {forward_velocity = 0.005}   # name = standard deviation of its noise
    series = {center_of_mass = 0.003}
    interval = 0.5                         # between the samples of series that are used [s]
    free_start = true                      # also identify where it began, if the path is used

    [table]                                # a CSV file of speeds, see `laticauda.trials.measured`
    file = "speeds.csv"
    sigma = 0.05                           # of rows that do not state their own, as a fraction

    [table1]                               # also the paper's Table 1
    sigma = 0.05

The file is read strictly: anything unknown, missing or out of range is rejected with its key.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, cast

import laticauda as lc
from laticauda import scenarios
from laticauda.identify.exporting import as_parameters
from laticauda.identify.fitting import Keep, fit
from laticauda.identify.measurements import Measurement
from laticauda.identify.method import Method
from laticauda.identify.result import Fit
from laticauda.identify.tables import from_table, from_table1
from laticauda.identify.trial_files import TableFile, TrialFile
from laticauda.identify.unknowns import Unknown, as_unknowns
from laticauda.models.simulate import Progress, silent
from laticauda.robot import NAMES, adjust, read_adjustments, read_table
from laticauda.values import (
    BadArgument,
    RobotFileError,
    check_label,
    codec,
    option,
    quantity,
    value_class,
)

KIND = "identification"
"""Kind of a task's file."""
OPTIONS = {
    "model": "model",
    "joints": "joints",
    "noise": "noise",
    "loss": "loss",
    "starts": "n_starts",
    "seed": "seed",
    "confidence": "confidence",
}
"""Keys of the method, and the corresponding arguments of `fit`."""
_SHORT_FORMS = {"parameters": "name", "trials": "file"}
"""Keys whose entries may be a text instead of a table, and the key that it stands for."""
_PRESET_WATER = "paper-lateral"
"""Water whose numbers `fixed.water` changes if there is no parameter file."""
_TABLE_ROBOT = "mamba"
"""Robot of a table whose task and rows name none."""
Table = Mapping[str, Any]


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
    file: Path | None = None
    """Its own file, which errors name; None: it has none."""

    def run(
        self,
        *,
        threads: int | None = None,
        progress: Progress = silent,
        keep: Keep = silent,
        client: Any = None,
    ) -> Fit:
        """Run the identification.

        Args:
            threads: Number of threads; None uses all cores available to this process.
            progress: Called periodically with the finished fraction, from 0 to 1.
            keep: Called with the best values by name and their sum of squares, whenever they
                improve.
            client: A `dask.distributed.Client` whose cluster simulates; None: this process does.

        Raises:
            ValueError: If there are too few measurements for the unknowns, or an argument is out of
                its range.
            RobotFileError: If the error is in the task's file.
        """
        arguments: dict[str, Any] = {
            **self.options,
            "threads": threads,
            "progress": progress,
            "keep": keep,
            "client": client,
        }
        try:
            return fit(self.measurements, self.robot, parameters=self.unknowns, **arguments)
        except BadArgument as error:
            if self.file is None or error.name == "threads":
                raise
            raise RobotFileError(f"{self.file}: key `{error.name}`: {error.rule}") from None

    def without_rivals(self) -> "Task":
        """Return the task for a fit whose doubt nobody reads: no other laws are tried."""
        return replace(self, options={**self.options, "rivals": False})

    def with_law(self, law: lc.Parameters) -> "Task":
        """Return the task with all values of a parameter file that the task does not set itself.

        Args:
            law: The parameter file; the task has none of its own.
        """
        options = dict(self.options)
        if law.joints is not None:
            options.setdefault("joints", law.joints)
        options["rivals"] = False  # the laws to compare are given
        measurements = [
            apply_fixed_values(measurement, links=None, base=law)
            for measurement in self.measurements
        ]
        return replace(
            self,
            name=f"{self.name}-{law.name}",
            title=f"{self.title}, {law.title}",
            measurements=tuple(measurements),
            base=law,
            options=options,
        )

    def parameters(self, fit: Fit) -> lc.Parameters:
        """Return the identified and the fixed values as one parameter file, as far as it can hold them.

        `Fit.beyond_parameter_file` names those that are left out.

        Args:
            fit: Fit from `run`.
        """
        identified = as_parameters(fit.problem, fit.values, self.name, self.title)
        if self.base is None:
            return identified
        return replace(
            identified,
            changes=codec.merge_tables(dict(self.base.changes), dict(identified.changes)),
            own_changes=codec.merge_tables(
                dict(self.base.own_changes), dict(identified.own_changes)
            ),
        )


def compare_laws(
    measurements: Sequence[Measurement],
    laws: Sequence[str | Path | lc.Parameters],
    *,
    parameters: Sequence[str | Unknown],
    **options: Any,
) -> dict[str, Fit]:
    """Fit the same unknowns with each of several laws of the water.

    Args:
        measurements: The measurements.
        laws: Parameter files, presets or paths: the values of water, joints and robot that are not
            fitted.
        parameters: Names of the numbers to identify, or `Unknown`s with ranges and priors.
        options: Further arguments of `fit`.

    Returns:
        The fits by name of the parameter file; errors as for `fit`.

    Example:
        >>> from laticauda.identify import compare_laws, from_table1
        >>> laws = ["paper", "mamba-identified"]
        >>> names = ["water.tangential_friction"]
        >>> fits = compare_laws(from_table1()[::4], laws, parameters=names, n_starts=1)
        >>> list(fits)
        ['paper', 'mamba-identified']
    """
    task = Task(
        name="laws",
        title="laws",
        measurements=tuple(measurements),
        unknowns=as_unknowns(parameters),
        options=options,
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
        _check_options(task.options)
    return replace(task, file=file, sources=(file, *task.sources))


def _check_options(options: Mapping[str, Any]) -> None:
    """Reject options that a fit would reject, by their keys in the file."""
    of_method = {
        name: value for name, value in options.items() if name in Method.__dataclass_fields__
    }
    model = options.get("model", "planar")
    joints = options.get("joints", "prescribed")
    try:
        Method(**of_method)
        scenarios.model_of(model, joints=joints)
    except BadArgument as error:
        raise codec.BadKey(error.name.removeprefix("n_"), error.rule) from None


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
    _expand_short_forms(table)
    content = codec.decode(_TaskFile, {"title": table["name"], **table})
    _check_complete(content)
    base = _base_of(content)
    if base is not None and base.joints is not None:
        options.setdefault("joints", base.joints)
    robot = _robot_of(content, base)
    trials = [trial.beside(folder) for trial in content.trials]
    measurements = [
        apply_fixed_values(trial.measurement(), links=None, base=base) for trial in trials
    ]
    for row in _rows_of_tables(content, folder):
        measurements.append(apply_fixed_values(row, links=content.links, base=base))
    sources: list[Path] = []
    for trial in trials:
        sources += trial.sources
    if content.table is not None:
        sources.append(folder / content.table.file)
    return Task(
        name=content.name,
        title=content.title,
        measurements=tuple(measurements),
        unknowns=content.parameters,
        robot=robot,
        base=base,
        options=options,
        sources=tuple(sources),
    )


def _expand_short_forms(table: dict[str, Any]) -> None:
    """Replace texts that stand for tables with a single key."""
    for key, only_key in _SHORT_FORMS.items():
        entries = table.get(key)
        if isinstance(entries, list):
            table[key] = [_expanded(entry, only_key) for entry in cast("list[object]", entries)]


def _expanded(entry: object, only_key: str) -> object:
    if isinstance(entry, str):
        return {only_key: entry}
    return entry


def _check_complete(content: _TaskFile) -> None:
    """Reject a task without unknowns or without measurements."""
    if not content.parameters:
        raise codec.BadKey("parameters", "must name at least one number to identify")
    if not content.trials and content.table is None and content.table1 is None:
        rule = "is missing; the task needs trials, [table] or [table1] to identify from"
        raise codec.BadKey("trials", rule)


def _robot_of(content: _TaskFile, base: lc.Parameters | None) -> lc.Robot | None:
    """Return the robot that must have swum; None: that of the trials."""
    if content.robot is None:
        return None
    robot = lc.load_robot(content.robot, content.links)
    if base is None:
        return adjust(robot, {})
    return adjust(robot, base.changes)


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
    if links is not None:
        scenario = replace(scenario, robot=scenario.robot.with_links(links))
    if base is not None:
        kind = scenario.gait.kind
        robot = base.robot(scenario.robot, kind)
        scenario = replace(scenario, robot=robot, environment=base.water(kind))
    return replace(measurement, scenario=scenario)


def _base_of(content: _TaskFile) -> lc.Parameters | None:
    """Return the fixed values: from a parameter file, from its tables in the task, or from both."""
    base = None
    if content.base is not None:
        base = lc.load_parameters(content.base)
    if content.fixed is None:
        return base
    codec.check_keys(content.fixed, ("water", *NAMES), "fixed")
    if base is not None:
        usual_water = base.every_gait
    else:
        usual_water = scenarios.preset_water(_PRESET_WATER)
    water = codec.updated(usual_water, content.fixed.get("water", {}), "fixed.water")
    adjustments = {key: content.fixed[key] for key in NAMES if key in content.fixed}
    changes = read_adjustments(adjustments, "fixed")
    if base is None:
        return lc.Parameters(
            name=content.name, title=content.name, every_gait=water, changes=changes
        )
    merged_changes = codec.merge_tables(dict(base.changes), changes)
    return replace(base, every_gait=water, changes=merged_changes)


def _rows_of_tables(content: _TaskFile, folder: Path) -> list[Measurement]:
    """Return the table rows to identify from, the task's own and the paper's."""
    rows: list[Measurement] = []
    own = content.table
    if own is not None:
        robot = content.robot or _TABLE_ROBOT
        rows += from_table(
            folder / own.file, own.figure, sigma=own.sigma, robot=robot, columns=own.columns
        )
    if content.table1 is True:
        rows += from_table1()
    elif content.table1 is not None and content.table1 is not False:
        arguments = codec.table_of(content.table1, "table1")
        codec.check_keys(arguments, ("figure", "sigma", "selected_from"), "table1")
        with codec.arguments_of("table1"):
            rows += from_table1(**arguments)
    return rows
