"""Common parts of the chapters of the paper's report: templates, and references to figures."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, partial, reduce
from itertools import groupby
from pathlib import Path
from typing import Any, cast

from laticauda.motion.gaits import GAIT_WORDS
from laticauda.paper.efficiency import EfficiencyStudy
from laticauda.paper.measured import MeasuredRow, PrintedChange
from laticauda.paper.path_following import PathFollowingStudy
from laticauda.paper.scores import FinGain, score_study
from laticauda.show.reports.chapter import Chapter, Row, load_templates
from laticauda.values.files import read_toml


@cache
def paper_templates() -> Any:
    """Return the Jinja2 environment that renders the paper's templates.

    Raises:
        MissingExtra: If Jinja2 is not installed.
    """
    made = load_templates("laticauda.paper.report")
    made.filters |= {"cm": _centimeters, "figs": figure_numbers}
    made.globals["words"] = GAIT_WORDS
    return made


paper_chapter = partial(Chapter, templates=paper_templates)
"""A chapter of the paper's report."""


def figure_numbers(numbers: Sequence[int]) -> str:
    """Format numbers of figures, consecutive ones as a range: "Figs. 12, 14 to 16 and 18".

    Args:
        numbers: At least one number, in ascending order.
    """
    in_a_row = groupby(
        enumerate(numbers), lambda pair: pair[1] - pair[0]
    )  # they increase as their indices do
    rows = [[number for _, number in row] for _, row in in_a_row]
    parts = [f"{row[0]}" if len(row) == 1 else f"{row[0]} to {row[-1]}" for row in rows]
    listed = " and ".join((", ".join(parts[:-1]), parts[-1])) if len(parts) > 1 else parts[0]
    return f"{'Fig.' if len(numbers) == 1 else 'Figs.'} {listed}"


def convert_to_degrees(angle: float) -> float:
    """Convert an angle or a rate to degrees for display; a billionth of a degree is rounding noise.

    Args:
        angle: Angle or rate [rad, or rad/s].

    Returns:
        Angle or rate [deg, or deg/s].
    """
    return round(math.degrees(angle), 9)


def build_row(table: str, thing: object) -> Row:
    """Return the columns of `columns.toml` for one row, or a part of it.

    Args:
        table: Name of the table there.
        thing: Object that the row describes; a mapping is read by its keys.
    """
    found: Row = {}
    for title, way in _columns()[table].items():
        path, _, unit = way.partition(" ")
        value: Any = reduce(_inside, path.split("."), thing)
        found[title] = None if value is None and unit != "words" else _SHOWN[unit](value)
    return found


@cache
def _columns() -> Mapping[str, Mapping[str, str]]:
    return read_toml(Path(__file__).with_name("columns.toml"))


def _inside(thing: Any, name: str) -> Any:
    """Return an attribute of `thing`, or an item of a mapping or a sequence; None if `thing` is None."""
    if thing is None or name.isdecimal():
        return thing and thing[int(name)]
    return cast("Any", thing)[name] if isinstance(thing, Mapping) else getattr(thing, name)


_SHOWN: Mapping[str, Callable[[Any], Any]] = {
    "": lambda value: value,
    "deg": lambda angle: convert_to_degrees(angle),
    "%": lambda share: 100.0 * share,
    "words": lambda name: (name or "").replace("_", " "),
    "count": len,
}


def error_rows(
    study: EfficiencyStudy | PathFollowingStudy, fitted: str, titles: Mapping[str, str]
) -> list[Row]:
    """Return the errors of all predictors of a table, together with those of models without physics.

    Args:
        study: Study of that table.
        fitted: Title of the column with the number of fitted values.
        titles: Titles of rows that replace the predictor's name.
    """
    groups, rows = [f"{group.name} [%]" for group in study.settings.groups], list[Row]()
    for score in score_study(study):
        row: Row = {
            "predictor of v": titles.get(score.title, score.title),
            fitted: score.n_fitted or 0,
        }
        row |= {**dict(zip(groups, score.by_group, strict=True)), "all rows [%]": score.overall}
        if isinstance(study, EfficiencyStudy):
            row["leaving one row out [%]"] = score.leave_one_out
            row["leaving one group out [%]"] = score.leave_one_group_out
        rows.append(row)
    return rows


def fin_row(change: PrintedChange, setting: Row, velocity: Row, power: Row) -> Row:
    """Return the changes due to the fin between two rows: measured, simulated and printed.

    Args:
        change: Change as printed, and from the table's own numbers.
        setting: Cells that distinguish the row from others.
        velocity: Simulated changes of the forward velocity, by column [%].
        power: Simulated changes of the power, by column [%].
    """
    row = change.with_fin
    return {
        "gait": row.group.split(",")[0],
        "case": row.case,
        **setting,
        "measured: v [%]": change.velocity,
        **velocity,
        "printed: v [%]": row.printed_velocity,
        "measured: electrical power [%]": change.power,
        **power,
        "printed: electrical power [%]": row.printed_power,
        "misprint": ", ".join(change.misprints),
    }


def misprinted(gains: Iterable[FinGain[Any]]) -> list[tuple[MeasuredRow, str, float, float]]:
    """Return for every misprinted change the row with the fin, the quantity, and the printed and recomputed change [%].

    Args:
        gains: All changes of a table.
    """
    return [
        (gain.measured.with_fin, what, *pair)
        for gain in gains
        for what, pair in gain.measured.misprints.items()
    ]


def _centimeters(length: float | None) -> str:
    return "unknown" if length is None else f"{100.0 * length:.2g} cm"
