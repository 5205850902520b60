"""Commands about many trials of one scenario: names of numbers as in the options, their values, and the results.

`amplitude-deg=10:50:100` is 100 values from 10 to 50 deg, both included; `normal-drag=1,1.5,2` is
three values.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from laticauda import studies
from laticauda.cli import command, scene
from laticauda.cli.tables import MISSING, aligned, format_table, parse_numbers, read_in
from laticauda.models.simulate.numbers import Parameter, list_parameters, suggest_names
from laticauda.scenarios import Scenario
from laticauda.studies.point_trials import LABELS, attributes_of
from laticauda.values import files
from laticauda.values.display_units import display_unit
from laticauda.values.errors import BadArgument
from laticauda.values.quantities import option, quantity, value_class

# Fields of these are named by their last word alone, like the options.
SHORT = ("gait", "water", "ground")
FORM = "NAME=LOW:HIGH:COUNT or NAME=VALUE,VALUE,... with the unit in the name, such as amplitude-deg=10:50:100"
RANGE_FORM = "NAME=LOW:HIGH, such as amplitude-deg=10:50"
SAMPLES_FORM = "NAME=LOW:HIGH with --samples, such as amplitude-deg=10:50"
MOST_COUNT = 10_000_000

Known = Mapping[str, Parameter]


@value_class
class Study(scene.OfScenario):
    """A command that runs a scenario with many values of its numbers."""

    names: bool = option(
        "Print the names of all parameters that can be varied, and exit", default=False
    )
    threads: int | None = quantity(
        "", "Trials to run in parallel here; one per core if omitted", ge=1, default=None
    )

    def run(self) -> command.Outcome:
        """Do the work, or list what can be varied."""
        known = list_parameters(self.chosen)
        if not self.names:
            return self.studied(self.chosen, known)
        lines = [
            (spell_parameter(one), read_in(0.0, one.unit)[1] or MISSING, one.title)
            for one in known.values()
        ]
        facts = {name: {"unit": one.unit, "title": one.title} for name, one in known.items()}
        return command.Outcome(facts=facts, text=aligned([("name", "unit", ""), *lines]))

    def studied(self, scenario: Scenario, known: Known) -> command.Outcome:
        """Do the work.

        Args:
            scenario: Scenario that all trials share.
            known: Numbers of it that can be varied.
        """
        raise NotImplementedError


def spell_parameter(parameter: Parameter) -> str:
    """Return the name of a parameter as it is typed."""
    root, *rest = parameter.name.split(".")
    short = (root in SHORT and len(rest) == 1) or rest == ["n_links"]
    return (
        (".".join(rest) if short else parameter.name) + display_unit(parameter.unit).ending
    ).replace("_", "-")


def parse_grid(words: Sequence[str], known: Known) -> studies.Grid:
    """Return every combination of the values.

    Args:
        words: Words of the form NAME=VALUES.
        known: Numbers that can be varied.

    Raises:
        ValueError: If a word cannot be read.
    """
    found: dict[str, list[float]] = {}
    for word in words:
        name, sign, values = parse_numbers("vary", word, FORM, ":", ",")
        parameter, factor = _meant(name, known, found)
        if sign == ":":
            if len(values) != 3:
                raise BadArgument("vary", f"must be {FORM}, got {word!r}")
            low, high, count = values
            if not (count.is_integer() and 1 <= count <= MOST_COUNT):
                raise BadArgument(
                    "vary", f"must have a whole COUNT between 1 and {MOST_COUNT}, got {word!r}"
                )
            values = np.linspace(low, high, int(count)).tolist()
        found[parameter.name] = [factor * one for one in values]
    return studies.Grid(values=found)


def parse_ranges(words: Sequence[str], known: Known, form: str) -> dict[str, tuple[float, float]]:
    """Return the lowest and highest values by parameter.

    Args:
        words: Words of the form NAME=LOW:HIGH.
        known: Numbers that can be varied.
        form: Expected form of a word, for messages.

    Raises:
        ValueError: If a word cannot be read.
    """
    found: dict[str, tuple[float, float]] = {}
    for word in words:
        name, _, ends = parse_numbers("vary", word, form, ":")
        parameter, factor = _meant(name, known, found)
        if len(ends) != 2:
            raise BadArgument("vary", f"must be {form}, got {word!r}")
        if not ends[0] < ends[1]:
            raise BadArgument("vary", f"must have low < high, got {word!r}")
        found[parameter.name] = (factor * ends[0], factor * ends[1])
    return found


def read_rows(path: str, known: Known) -> studies.Rows:
    """Return the points of a CSV file: names in the first line, one point in each further line.

    Args:
        path: Path of the file.
        known: Numbers that can be varied.

    Raises:
        ValueError: If the file is not such a table.
        OSError: If the file cannot be read at all.
    """
    names, lines = files.read_rows(path)
    if not names:
        raise BadArgument(
            "list", f"must be a CSV file with the names of parameters in its first line, got {path}"
        )
    columns: dict[str, list[float]] = {}
    for name in names:
        parameter, factor = _meant(name, known, columns)
        columns[parameter.name] = [
            factor * _number(row[name], f"{path}, line {line}") for line, row in lines
        ]
    return studies.Rows(values=columns)


def _number(text: str, where: str) -> float:
    try:
        found = float(text)
    except ValueError:
        found = math.nan
    if not math.isfinite(found):
        raise BadArgument("list", f"must be a table of numbers, got {f'{text} in {where}'!r}")
    return found


def _meant(name: str, known: Known, before: Mapping[str, object]) -> tuple[Parameter, float]:
    """Return a parameter and the factor for its values; reject a parameter that was named before."""
    plain = name.replace("_", "-")
    for parameter in known.values():
        full, suffix = (
            parameter.name.replace("_", "-"),
            display_unit(parameter.unit).ending.replace("_", "-"),
        )
        if plain in (spell_parameter(parameter), full + suffix, full):
            if parameter.name in before:
                raise BadArgument("vary", f"must name each parameter only once, got {name!r} again")
            # With dots and no unit, a name is in SI units, as in Python.
            return parameter, math.radians(1.0) if suffix and plain != full else 1.0
    hint = suggest_names(plain, [spell_parameter(parameter) for parameter in known.values()])
    raise BadArgument(
        "vary",
        f"must name a parameter of robot, gait or water, got {name!r}{hint} (--names lists all)",
    )


def points_table(
    scenario: Scenario, names: Sequence[str], figures: Sequence[str], points: Sequence[Any]
) -> str:
    """Return some points as a table.

    Args:
        scenario: Scenario that all trials share.
        names: Names of the parameters.
        figures: Names of the resulting figures.
        points: Mappings with both.
    """
    known = list_parameters(scenario)
    rows = [
        {
            spell_parameter(known[name]): display_unit(known[name].unit).from_si(point[name])
            for name in names
        }
        | {LABELS[name]: point[name] for name in figures}
        for point in points
    ]
    return format_table(rows)


def shared_facts(scenario: Scenario) -> dict[str, Any]:
    """Return what all trials share, for JSON."""
    found = attributes_of(scenario)
    return {**found, "version": found.pop("laticauda")}
