"""Commands about many trials of one scenario: names of numbers as in the options, their values, and the results.

`amplitude-deg=10:50:100` is 100 values from 10 to 50 deg, both included; `normal-drag=1,1.5,2` is
three values.
"""

import math
from collections.abc import Container, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from laticauda import studies
from laticauda.cli import command, scene
from laticauda.cli.shared_options import threads_option
from laticauda.cli.tables import MISSING, align_columns, format_table, parse_numbers
from laticauda.models.simulate import Parameter, joint_motion, suggest_names, tapers
from laticauda.models.simulate.numbers import ScenarioParameters, list_parameters
from laticauda.models.simulate.parameter_paths import list_brackets, strip_items
from laticauda.scenarios import Scenario
from laticauda.studies import LABELS, attributes_of
from laticauda.values import (
    BadArgument,
    display_unit,
    option,
    read_rows as read_table_rows,
    value_class,
)

ROOTS_LEFT_OUT = ("gait", "water", "ground")
"""Fields of these are named by their last word alone, like the options."""
N_LINKS = "robot.n_links"
"""The only number of a robot that is an option, and thus is named like one."""
FORM = "NAME=LOW:HIGH:COUNT or NAME=VALUE,VALUE,... with the unit in the name, such as amplitude-deg=10:50:100"
RANGE_FORM = "NAME=LOW:HIGH, such as amplitude-deg=10:50"
SAMPLES_FORM = "NAME=LOW:HIGH with --samples, such as amplitude-deg=10:50"
RADIANS_PER_CYCLE = 2.0 * math.pi
MOST_COUNT = 10_000_000
"""Largest number of values of one parameter."""

Parameters = Mapping[str, Parameter]
"""Numbers that can be varied, by name."""
NUMBERS_OF_JOINTS = {
    f"gait.{step}": Parameter(name=f"gait.{step}", unit="rad", title=title)
    for step, title in joint_motion.TITLES.items()
}
"""Numbers of a gait that have brackets: which joints they are of."""


class TypedParameter(NamedTuple):
    """A parameter as it was named, and what its values mean under this name."""

    parameter: Parameter
    factor: float
    """What 1 under this name is in the SI unit."""


@value_class
class Study(scene.OfScenario):
    """A command that runs a scenario with many values of its numbers."""

    names: bool = option(
        "Print the names of all parameters that can be varied, and exit", default=False
    )
    threads: int | None = threads_option("Trials to run in parallel here")

    def run(self) -> command.Outcome:
        """Do the work, or list what can be varied."""
        parameters = list_parameters(self.scenario_to_run)
        if self.names:
            return _list_names(parameters)
        return self.run_study(self.scenario_to_run, parameters)

    def run_study(self, scenario: Scenario, parameters: Parameters) -> command.Outcome:
        """Do the work.

        Args:
            scenario: Scenario that all trials share.
            parameters: Numbers of it that can be varied.
        """
        raise NotImplementedError


def _list_names(parameters: Parameters) -> command.Outcome:
    rows = [("name", "unit", "")]
    for parameter in parameters.values():
        unit = display_unit(parameter.unit).name or MISSING
        rows.append((spell_parameter(parameter), unit, parameter.title))
    facts = {
        name: {"unit": parameter.unit, "title": parameter.title}
        for name, parameter in parameters.items()
    }
    return command.Outcome(facts=facts, text=align_columns(rows))


def spell_parameter(parameter: Parameter) -> str:
    """Return the name of a parameter as it is typed."""
    root, *steps = parameter.name.split(".")
    is_option = parameter.name == N_LINKS or (root in ROOTS_LEFT_OUT and len(steps) == 1)
    name = parameter.name
    if is_option:
        name = steps[0]
    ending = display_unit(parameter.unit).ending
    return (name + ending).replace("_", "-")


def parse_grid(typed: Sequence[str], parameters: Parameters) -> studies.Grid:
    """Return every combination of the values.

    Args:
        typed: Texts of the form NAME=VALUES.
        parameters: Numbers that can be varied.

    Raises:
        ValueError: If a text cannot be read.
    """
    values_by_name: dict[str, list[float]] = {}
    for text in typed:
        name, sign, numbers = parse_numbers("vary", text, FORM, ":", ",")
        parameter, factor = _find_parameter(name, parameters, values_by_name)
        if sign == ":":
            numbers = _spread_numbers(numbers, text)
        values_by_name[parameter.name] = [factor * number for number in numbers]
    return studies.Grid(values=values_by_name)


def _spread_numbers(numbers: Sequence[float], text: str) -> list[float]:
    """Return evenly spaced numbers from their ends and their count."""
    if len(numbers) != 3:
        raise BadArgument("vary", f"must be {FORM}, got {text!r}")
    low, high, count = numbers
    if not count.is_integer() or not 1 <= count <= MOST_COUNT:
        rule = f"must have a whole COUNT between 1 and {MOST_COUNT}"
        raise BadArgument("vary", f"{rule}, got {text!r}")
    return np.linspace(low, high, int(count)).tolist()


def parse_ranges(
    typed: Sequence[str], parameters: Parameters, form: str
) -> dict[str, tuple[float, float]]:
    """Return the lowest and highest values by parameter.

    Args:
        typed: Texts of the form NAME=LOW:HIGH.
        parameters: Numbers that can be varied.
        form: Expected form of a text, for messages.

    Raises:
        ValueError: If a text cannot be read.
    """
    ranges: dict[str, tuple[float, float]] = {}
    for text in typed:
        name, _, ends = parse_numbers("vary", text, form, ":")
        parameter, factor = _find_parameter(name, parameters, ranges)
        if len(ends) != 2:
            raise BadArgument("vary", f"must be {form}, got {text!r}")
        low, high = ends
        if not low < high:
            raise BadArgument("vary", f"must have low < high, got {text!r}")
        ranges[parameter.name] = (factor * low, factor * high)
    return ranges


def read_rows(path: str, parameters: Parameters) -> studies.Rows:
    """Return the points of a CSV file: names in the first line, one point in each further line.

    Args:
        path: Path of the file.
        parameters: Numbers that can be varied.

    Raises:
        ValueError: If the file is not such a table.
        OSError: If the file cannot be read at all.
    """
    names, lines = read_table_rows(path)
    columns: dict[str, list[float]] = {}
    for name in names:
        parameter, factor = _find_parameter(name, parameters, columns)
        columns[parameter.name] = [
            factor * _parse_cell(row[name], f"{path}, line {line}") for line, row in lines
        ]
    return studies.Rows(values=columns)


def _parse_cell(text: str, position: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        cell = f"{text} in {position}"
        raise BadArgument("list", f"must be a table of numbers, got {cell!r}")
    return number


def _find_parameter(
    name: str, parameters: Parameters, named_before: Container[str]
) -> TypedParameter:
    """Return the parameter of a name; reject a parameter that was named before."""
    typed_name = name.replace("_", "-")
    of_parts = _read_name_of_parts(typed_name, parameters)
    typed = _match_name(typed_name, parameters) or _match_name(typed_name, _list_tapers(parameters))
    if typed is None and of_parts is not None and of_parts.name in parameters:
        typed = TypedParameter(parameters[of_parts.name], of_parts.factor)
    if typed is not None:
        if typed.parameter.name in named_before:
            raise BadArgument("vary", f"must name each parameter only once, got {name!r} again")
        return typed
    typed_names = [spell_parameter(parameter) for parameter in parameters.values()]
    hint = suggest_names(typed_name, typed_names)
    if isinstance(parameters, ScenarioParameters):
        name_in_si = of_parts.name if of_parts else name
        hint = parameters.explain_items(name_in_si) or hint
    rule = "must name a parameter of robot, gait or water"
    raise BadArgument("vary", f"{rule}, got {name!r}{hint} (--names lists all)")


def _match_name(typed_name: str, parameters: Parameters) -> TypedParameter | None:
    """Return the listed parameter that a name was typed for; None if there is none."""
    for parameter in parameters.values():
        factors = _accepted_names(parameter)
        if typed_name in factors:
            return TypedParameter(parameter, factors[typed_name])
    return None


class _NameOfParts(NamedTuple):
    """Name of a number of single parts or of a range, which the robot may not have."""

    name: str
    factor: float
    """What 1 under the typed name is in the SI unit."""


def _read_name_of_parts(typed_name: str, parameters: Parameters) -> _NameOfParts | None:
    """Return what a name with brackets means, robot.module[:5].mass-g; None if no part has such a number."""
    typed = _match_name(strip_items(typed_name), {**parameters, **NUMBERS_OF_JOINTS})
    if typed is None or "[" not in typed_name:
        return None
    typed_steps = typed_name.split(".")
    steps = typed.parameter.name.split(".")
    for i in range(1, min(len(typed_steps), len(steps)) + 1):
        steps[-i] += "".join(list_brackets(typed_steps[-i]))
    return _NameOfParts(".".join(steps), typed.factor)


def _list_tapers(parameters: Parameters) -> dict[str, Parameter]:
    """Return the numbers of all tapers along the body, which are not listed themselves."""
    numbers_of_tapers: dict[str, Parameter] = {}
    for parameter in parameters.values():
        quantity = parameter.name.removeprefix("robot.module.")
        for number in tapers.TITLES:
            name = f"robot.{tapers.TAPER}.{quantity}.{number}"
            if name in parameters:
                numbers_of_tapers[name] = parameters[name]
    return numbers_of_tapers


def _accepted_names(parameter: Parameter) -> dict[str, float]:
    """Return the names under which a parameter may be typed, with what 1 means under each in the SI unit.

    They are its name as an option (``amplitude-deg``), its full name in the unit that people type
    (``gait.amplitude-deg``), and its full name in SI units, as in Python (``gait.amplitude``). An
    angular frequency may also be typed in Hz (``frequency-hz``).
    """
    display = display_unit(parameter.unit)
    full_name = parameter.name.replace("_", "-")
    full_name_with_unit = full_name + display.ending.replace("_", "-")
    factors = {
        spell_parameter(parameter): display.in_si_unit,
        full_name_with_unit: display.in_si_unit,
    }
    factors[full_name] = 1.0
    if parameter.unit == "rad/s":
        factors[spell_parameter(parameter).removesuffix("-deg-s") + "-hz"] = RADIANS_PER_CYCLE
    return factors


def format_points(
    scenario: Scenario,
    names: Sequence[str],
    figures: Sequence[str],
    points: Sequence[Any],
    remarks: Mapping[str, Sequence[str]] | None = None,
) -> str:
    """Return some points as a table.

    Args:
        scenario: Scenario that all trials share.
        names: Names of the parameters.
        figures: Names of the resulting figures.
        points: Mappings with both.
        remarks: Further columns by their titles, with a text for every point.
    """
    parameters = list_parameters(scenario)
    rows: list[dict[str, Any]] = []
    for point in points:
        row: dict[str, Any] = {}
        for name in names:
            parameter = parameters[name]
            row[spell_parameter(parameter)] = display_unit(parameter.unit).from_si(point[name])
        for name in figures:
            row[LABELS[name]] = point[name]
        rows.append(row)
    for title, texts in (remarks or {}).items():
        for row, text in zip(rows, texts, strict=True):
            row[title] = text
    return format_table(rows)


def shared_facts(scenario: Scenario) -> dict[str, Any]:
    """Return what all trials share, for JSON."""
    facts = attributes_of(scenario)
    return {**facts, "version": facts["laticauda"]}
