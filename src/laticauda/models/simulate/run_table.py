"""Many runs as columns: a scenario of which some numbers differ, without an object for every run.

What differs besides the waves of the gait needs a plant of its own; runs that share all of it share a
*base*, the run of which they are copies with other waves.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cache
from operator import attrgetter
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from laticauda.models.dynamics.school import GAIT_PARAMETERS
from laticauda.models.planar import Run
from laticauda.models.simulate.batch_figures import RunFacts
from laticauda.models.simulate.batch_scenarios import runs_of
from laticauda.models.simulate.numbers import (
    change_parameters,
    check_disjoint,
    check_whole,
    list_parameters,
    look_up,
)
from laticauda.motion.gaits import Gait
from laticauda.scenarios import Command, Scenario
from laticauda.values import BadArgument, check_instance, check_not_empty, show_value

Columns = Mapping[str, Any]
"""Values by the name of a parameter, one per run."""

PART_OF_ROOT = {
    "robot": "robot",
    "gait": "motion",
    "controller": "motion",
    "water": "environment",
    "ground": "environment",
    "joints": "model",
}
"""Field of a scenario that a parameter changes, by the first word of the parameter's name."""
WAVE_PARAMETERS = {f"gait.{name}": i for i, name in enumerate(GAIT_PARAMETERS)}
"""Rows of `RunTable.waves` by the name of the parameter."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RunTable:
    """Runs without controllers, each a base with waves of its own."""

    bases: Sequence[Run]
    """The bases, all with the same duration and sample interval."""
    base_of: Int[np.ndarray, " n_runs"]
    """Index of the base of every run."""
    waves: Float[np.ndarray, "4 n_runs"]
    """The gait's `GAIT_PARAMETERS` of every run."""

    def __len__(self) -> int:
        """Return the number of runs."""
        return self.base_of.size

    def base(self, i: int) -> Run:
        """Return the base of a run.

        Args:
            i: Its index.
        """
        return self.bases[int(self.base_of[i])]

    def run(self, i: int) -> Run:
        """Return one run.

        Args:
            i: Its index.
        """
        base = self.base(i)
        values = dict(zip(GAIT_PARAMETERS, self.waves[:, i].tolist(), strict=True))
        gait = replace(base.command.gait, **values)
        return replace(base, command=replace(base.command, gait=gait))

    def facts(self) -> RunFacts:
        """Return what the figures of the runs depend on besides the motion."""
        return RunFacts.of(self.bases).take(self.base_of)

    @property
    def frequency(self) -> Float[np.ndarray, " n_runs"]:
        """Frequencies of the gaits [rad/s]."""
        return self.waves[GAIT_PARAMETERS.index("frequency")]


def make_run_table(scenario: Scenario, columns: Columns) -> RunTable:
    """Return the runs of a scenario of which some numbers differ.

    Args:
        scenario: What all runs share. A controller is left out: its gait alone swims.
        columns: The numbers that differ, checked by `check_columns`.

    Raises:
        ValueError: If a value is out of its range.
    """
    n_runs = len(next(iter(columns.values())))
    gait = scenario.gait
    scenario = replace(scenario, motion=gait)
    waves = np.empty((len(GAIT_PARAMETERS), n_runs))
    for i, name in enumerate(GAIT_PARAMETERS):
        waves[i] = getattr(gait, name)
    for name in columns.keys() & WAVE_PARAMETERS.keys():
        waves[WAVE_PARAMETERS[name]] = columns[name]
    base_scenarios = [scenario]
    base_of = np.zeros(n_runs, dtype=int)
    others = {name: values for name, values in columns.items() if name not in WAVE_PARAMETERS}
    if others:
        table = np.stack(list(others.values()), axis=1)
        points, base_of = np.unique(table, axis=0, return_inverse=True)
        base_scenarios = scenarios_at(scenario, tuple(others), points)
    make_extreme_gaits(base_scenarios[0].gait, waves)
    return RunTable(bases=runs_of(base_scenarios), base_of=base_of.ravel(), waves=waves)


def table_of_runs(runs: Sequence[Run]) -> RunTable:
    """Return runs that gaits move as a table.

    Runs share a base if they hold the same objects in all but the numbers of their waves; equal
    objects are not looked for.

    Args:
        runs: Runs without controllers, references and slopes.
    """
    bases: list[Run] = []
    base_of_key: dict[tuple[int, ...], int] = {}
    base_of = np.empty(len(runs), dtype=int)
    waves: list[tuple[float, ...]] = []
    wave_of = attrgetter(*GAIT_PARAMETERS)
    for i, run in enumerate(runs):
        gait = run.command.gait
        shared_parts = (
            run.plant,
            run.start,
            *_fields_besides_gait(run.command),
            type(gait),
            *_getter_besides_wave(type(gait))(gait),
        )
        key = tuple(map(id, shared_parts))
        if key not in base_of_key:
            base_of_key[key] = len(bases)
            bases.append(run)
        base_of[i] = base_of_key[key]
        waves.append(wave_of(gait))
    return RunTable(bases=bases, base_of=base_of, waves=np.array(waves).T)


_fields_besides_gait: Callable[[Command], tuple[object, ...]] = attrgetter(
    *(field.name for field in fields(Command) if field.name != "gait")
)


@cache
def _getter_besides_wave(kind: type[Gait]) -> Callable[[Gait], tuple[object, ...]]:
    """Return the function that gets the fields of a gait of a class that are no numbers of its wave."""
    return attrgetter(*(field.name for field in fields(kind) if field.name not in GAIT_PARAMETERS))


def make_extreme_gaits(gait: Gait, waves: Float[np.ndarray, "4 n_runs"]) -> list[Gait]:
    """Return a gait with the smallest of all numbers, and one with the largest.

    Each of these numbers has bounds of its own, so that the two stand for all.

    Args:
        gait: The gait of which everything else is.
        waves: Values of its `GAIT_PARAMETERS`, one column per run.

    Raises:
        ValueError: If a value is out of its range.
    """
    gaits: list[Gait] = []
    for extremes in (waves.min(axis=1), waves.max(axis=1)):
        values = dict(zip(GAIT_PARAMETERS, extremes.tolist(), strict=True))
        gaits.append(replace(gait, **values))
    return gaits


def check_columns(scenario: Scenario, columns: Columns) -> dict[str, Float[np.ndarray, " n_runs"]]:
    """Return columns as arrays of equal length.

    Args:
        scenario: The scenario whose numbers they are.
        columns: Values by the name of a parameter, one per run.

    Raises:
        ValueError: If there is no such parameter, a count is not whole, or lengths differ.
    """
    check_instance("columns", columns, Mapping)
    check_not_empty("columns", columns, "parameter")
    parameters = list_parameters(scenario)
    arrays: dict[str, np.ndarray] = {}
    for name, values in columns.items():
        parameter = look_up(name, parameters, "columns")
        arrays[name] = _as_numbers(name, values)
        check_whole(parameter, arrays[name])
    check_disjoint(arrays, "columns")
    shapes = {name: values.shape for name, values in arrays.items()}
    if len(set(shapes.values())) > 1 or any(len(shape) != 1 for shape in shapes.values()):
        listed = ", ".join(f"{shape} of {name}" for name, shape in shapes.items())
        raise BadArgument("columns", f"must be flat lists of equal length, got the shapes {listed}")
    check_not_empty("columns", next(iter(arrays.values())), "value")
    return arrays


def _as_numbers(name: str, values: object) -> np.ndarray:
    """Return a column as an array of numbers."""
    try:
        return np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        rule = "must hold a list of numbers for every name"
        raise BadArgument("columns", f"{rule}, got {show_value(values)} for `{name}`") from None


def scenarios_of_extremes(
    scenario: Scenario, columns: Mapping[str, Float[np.ndarray, " n_runs"]]
) -> list[Scenario]:
    """Return the scenario with the smallest of all values, and that with the largest.

    Args:
        scenario: What all runs share.
        columns: The numbers that differ.

    Raises:
        ValueError: If a value is out of its range.
    """
    scenarios: list[Scenario] = []
    for find_extreme in (np.min, np.max):
        extremes = {name: float(find_extreme(values)) for name, values in columns.items()}
        scenarios.append(change_parameters(scenario, extremes))
    return scenarios


def scenarios_at(
    scenario: Scenario, names: tuple[str, ...], table: Float[np.ndarray, "n_points n_names"]
) -> list[Scenario]:
    """Return the scenario of every point; equal robots, gaits and environments are one object, created once.

    Args:
        scenario: What all trials share.
        names: Names of the parameters, one per column of the table.
        table: The points, one per row.
    """
    columns_of_field: dict[str, list[int]] = {}
    for column, name in enumerate(names):
        field = PART_OF_ROOT[name.split(".")[0]]
        columns_of_field.setdefault(field, []).append(column)
    parts: dict[tuple[str, tuple[float, ...]], Any] = {}

    def part_at(field: str, row: Sequence[float]) -> Any:
        columns = columns_of_field[field]
        values = tuple(row[column] for column in columns)
        if (field, values) not in parts:
            changes = {names[column]: row[column] for column in columns}
            changed_scenario = change_parameters(scenario, changes)
            parts[field, values] = getattr(changed_scenario, field)
        return parts[field, values]

    return [
        replace(scenario, **{field: part_at(field, row) for field in columns_of_field})
        for row in table.tolist()
    ]
