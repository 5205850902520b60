"""An identification as a task: measurements, unknowns and method together, from a TOML file or from a few trials.

    kind = "identification"
    name = "tank-2026"                     # of the parameter file that it makes
    title = "identified in the tank"
    robot = "mamba"                        # a preset or a file; left out: the trials say it
    joints = "servo"                       # prescribed, pd or servo
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

    [table1]                               # the paper's Table 1 too
    sigma = 0.05

It is read strictly: what is unknown, missing or out of range is refused with its key.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, cast

from laticauda.codec import BadKey, check_keys, decode, encode, keys_of, table_of
from laticauda.errors import RobotFileError
from laticauda.identify.fitting import fit
from laticauda.identify.measurements import Measurement, from_table1
from laticauda.identify.result import Fit
from laticauda.identify.trial_files import TrialFile
from laticauda.identify.unknowns import Unknown
from laticauda.robot import Parameters, Robot, Water, load_parameters, load_robot
from laticauda.robot.adjustments import NAMES, adjusted, read_adjustments
from laticauda.robot.files import read_table
from laticauda.scenarios import preset_water
from laticauda.simulate.runner import Progress

KIND = "identification"
KEYS = (
    *("kind", "name", "title", "robot", "links", "parameters", "base", "fixed", "trials", "table1"),
    *("model", "joints", "noise", "loss", "starts", "seed", "confidence"),
)
OPTIONS = {
    "model": "model",
    "joints": "joints",
    "noise": "noise",
    "loss": "loss",
    "starts": "n_starts",
    "seed": "seed",
    "confidence": "confidence",
}
"""Keys of the method, and the arguments of `fit` that they are."""
Table = Mapping[str, Any]


@dataclass(frozen=True, kw_only=True, eq=False)
class Task:
    """What is to be identified, from what, and how."""

    name: str
    """Of the parameter file that it makes."""
    title: str
    """What a legend says."""
    measurements: tuple[Measurement, ...]
    """With robot and water, all that is fixed applied."""
    unknowns: tuple[Unknown, ...]
    """What is looked for."""
    robot: Robot | None = None
    """What has to have swum; None: whatever the trials say."""
    base: Parameters | None = None
    """What is fixed."""
    options: Mapping[str, Any] = field(default_factory=dict[str, Any])
    """Arguments of `fit`."""
    sources: tuple[Path, ...] = ()
    """The files that it was read from."""

    def run(self, *, threads: int | None = None, progress: Progress | None = None) -> Fit:
        """Identify; errors as for `fit`.

        Args:
            threads: See `fit`.
            progress: See `fit`.
        """
        return fit(
            self.measurements,
            self.robot,
            parameters=self.unknowns,
            **self.options,
            threads=threads,
            progress=progress,
        )

    def parameters(self, found: Fit) -> Parameters:
        """What was identified and what was fixed, as one parameter file.

        Args:
            found: From `run`.
        """
        kept = found.parameters(self.name, self.title)
        if self.base is None:
            return kept
        tables = {name: dict(values) for name, values in self.base.changes.items()}
        for name, values in kept.changes.items():
            tables[name] = tables.get(name, {}) | dict(values)
        own: dict[str, dict[str, dict[str, Any]]] = {}
        for kind in {*self.base.own_changes, *kept.own_changes}:
            mine = {name: dict(values) for name, values in self.base.own_changes.get(kind, {}).items()}
            for name, values in kept.own_changes.get(kind, {}).items():
                mine[name] = mine.get(name, {}) | dict(values)
            own[kind] = mine
        return replace(kept, changes=tables, own_changes=own)


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
    with keys_of(file, RobotFileError):
        task = task_from_table(table, file.stem, file.parent)
    return replace(task, sources=(file, *task.sources))


def task_from_table(table: Table, name: str, folder: Path) -> Task:
    """The task that a table says, as a file holds it.

    Args:
        table: As a TOML reader gives it.
        name: Of the parameter file, if the table says none.
        folder: Where the files lie that it names.

    Raises:
        BadKey: If anything in it is wrong.
        RobotFileError: If a robot or parameter file is wrong.
        TrialFileError: If a trial in it cannot be read.
    """
    check_keys(table, KEYS)
    if table.get("kind") != KIND:
        raise BadKey("kind", f'must be "{KIND}" here, got {table.get("kind")!r}')
    name = _text(table, "name", name)
    if not table.get("trials") and "table1" not in table:
        raise BadKey("trials", "is missing; trials or [table1] are what is identified from")
    robot = load_robot(_text(table, "robot", "")) if "robot" in table else None
    links = table.get("links")
    if robot is not None and links is not None:
        robot = robot.with_links(links)
    base = _base(table, name)
    options: dict[str, Any] = {OPTIONS[key]: table[key] for key in OPTIONS if key in table}
    if base is not None and base.joints is not None:
        options.setdefault("joints", base.joints)
    trials = [_trial_file(entry, folder, f"trials[{i}]") for i, entry in enumerate(_list(table, "trials"))]
    measured = [*(fixed(trial.measurement(), None, base) for trial in trials)]
    measured += [fixed(measurement, links, base) for measurement in _table1(table)]
    return Task(
        name=name,
        title=_text(table, "title", name),
        measurements=tuple(measured),
        unknowns=(*_unknowns(table), *(start for trial in trials for start in trial.starts)),
        robot=None if robot is None else adjusted(robot, base.changes if base else {}),
        base=base,
        options=options,
        sources=tuple(path for trial in trials for path in trial.sources),
    )


def fixed(measurement: Measurement, links: int | None, base: Parameters | None) -> Measurement:
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


def _trial_file(entry: object, folder: Path, at: str) -> TrialFile:
    """An entry of a task's list of trials; its files lie beside the task's."""
    table = {"file": entry} if isinstance(entry, str) else table_of(entry, at)
    found = decode(TrialFile, table, at)
    columns = None if found.columns is None else str(folder / found.columns)
    return replace(found, file=str(folder / found.file), columns=columns)


def _base(table: Table, name: str) -> Parameters | None:
    """What is fixed: a parameter file, its tables here, or both."""
    base = load_parameters(_text(table, "base", "")) if "base" in table else None
    if "fixed" not in table:
        return base
    given = table_of(table["fixed"], "fixed")
    check_keys(given, ("water", *NAMES), "fixed")
    usual = preset_water("paper-lateral") if base is None else base.every_gait
    own = table_of(given.get("water", {}), "fixed.water")
    water = decode(Water, {**encode(usual), **own, "name": usual.name}, "fixed.water")
    changes = read_adjustments({key: given[key] for key in NAMES if key in given}, "fixed")
    if base is None:
        return Parameters(name=name, title=name, every_gait=water, changes=changes)
    merged = {key: {**base.changes.get(key, {}), **changes.get(key, {})} for key in {*base.changes, *changes}}
    return replace(base, every_gait=water, changes=merged)


def _unknowns(table: Table) -> list[Unknown]:
    found = [
        decode(Unknown, {"name": entry} if isinstance(entry, str) else entry, f"parameters[{i}]")
        for i, entry in enumerate(_list(table, "parameters"))
    ]
    if not found:
        raise BadKey("parameters", "must name at least one number to identify")
    return found


def _table1(table: Table) -> tuple[Measurement, ...]:
    if "table1" not in table:
        return ()
    asked = {} if table["table1"] is True else table_of(table["table1"], "table1")
    check_keys(asked, ("figure", "sigma", "selected_from"), "table1")
    try:
        return from_table1(**asked)
    except ValueError as error:
        raise BadKey("table1", str(error)) from None


def _text(table: Table, key: str, otherwise: str) -> str:
    value = table.get(key, otherwise)
    if not isinstance(value, str) or not value.strip():
        raise BadKey(key, f"must be a text that is not empty, got {value!r}")
    return value


def _list(table: Table, key: str) -> list[Any]:
    value = table.get(key, [])
    if not isinstance(value, list):
        raise BadKey(key, f"must be a list, got {value!r}")
    return cast("list[Any]", value)
