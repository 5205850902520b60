"""What the chapters of the paper's report share: its templates, and how figures are called in them."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, partial, reduce
from itertools import groupby
from pathlib import Path
from typing import Any, cast

from laticauda.files import read_toml
from laticauda.gaits import GAIT_WORDS
from laticauda.paper.efficiency import EfficiencyStudy
from laticauda.paper.measured import MeasuredRow, PrintedChange
from laticauda.paper.path_following import PathFollowingStudy
from laticauda.paper.scores import FinGain, scores
from laticauda.reports.chapter import Chapter, Row, templates


@cache
def paper_templates() -> Any:
    """What renders the paper's templates (Jinja2's).

    Raises:
        MissingExtra: If Jinja2 is not installed.
    """
    made = templates("laticauda.paper.report")
    made.filters |= {"cm": _centimeters, "figs": figure_numbers}
    made.globals["words"] = GAIT_WORDS
    return made


paper_chapter = partial(Chapter, templates=paper_templates)
"""A chapter of the paper's report."""


def figure_numbers(numbers: Sequence[int]) -> str:
    """Numbers of figures, those in a row as from-to: "Figs. 12, 14 to 16 and 18".

    Args:
        numbers: At least one, rising.
    """
    in_a_row = groupby(enumerate(numbers), lambda pair: pair[1] - pair[0])  # they rise as their places do
    rows = [[number for _, number in row] for _, row in in_a_row]
    parts = [f"{row[0]}" if len(row) == 1 else f"{row[0]} to {row[-1]}" for row in rows]
    listed = " and ".join((", ".join(parts[:-1]), parts[-1])) if len(parts) > 1 else parts[0]
    return f"{'Fig.' if len(numbers) == 1 else 'Figs.'} {listed}"


def degrees(angle: float) -> float:
    """An angle or a rate to read; a billionth of a degree is rounding noise.

    Args:
        angle: [rad, or rad/s].

    Returns:
        [deg, or deg/s].
    """
    return round(math.degrees(angle), 9)


def row(table: str, thing: object) -> Row:
    """The columns of `columns.toml` for one row, or a part of it.

    Args:
        table: Its name there.
        thing: What the row is of; of a mapping, what it holds.
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
    """What a thing holds; of a mapping or a sequence by key or place, and None where there is no thing."""
    if thing is None or name.isdecimal():
        return thing and thing[int(name)]
    return cast("Any", thing)[name] if isinstance(thing, Mapping) else getattr(thing, name)


_SHOWN: Mapping[str, Callable[[Any], Any]] = {
    "": lambda value: value,
    "deg": lambda angle: degrees(angle),
    "%": lambda share: 100.0 * share,
    "words": lambda name: (name or "").replace("_", " "),
    "count": len,
}


def error_rows(study: EfficiencyStudy | PathFollowingStudy, fitted: str, titles: Mapping[str, str]) -> list[Row]:
    """The errors of all predictors of a table, beside models without physics.

    Args:
        study: Of that table.
        fitted: What the column with the numbers of fitted numbers is called.
        titles: What rows are called instead of by the predictor's name.
    """
    groups, rows = [f"{group.name} [%]" for group in study.settings.groups], list[Row]()
    for score in scores(study):
        row: Row = {"predictor of v": titles.get(score.title, score.title), fitted: score.n_fitted or 0}
        row |= {**dict(zip(groups, score.by_group, strict=True)), "all rows [%]": score.overall}
        if isinstance(study, EfficiencyStudy):
            row["leaving one row out [%]"] = score.leave_one_out
            row["leaving one group out [%]"] = score.leave_one_group_out
        rows.append(row)
    return rows


def fin_row(change: PrintedChange, setting: Row, velocity: Row, power: Row) -> Row:
    """What the fin changes from one row to another: measured, simulated and printed.

    Args:
        change: As printed, and by the table's own numbers.
        setting: What tells the row from others.
        velocity: Simulated changes of the forward velocity, by column [%].
        power: The same of the power [%].
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
    """Of every misprinted change the row with the fin, what it is of, the printed and the recomputed one [%].

    Args:
        gains: All of a table.
    """
    return [(gain.measured.with_fin, what, *pair) for gain in gains for what, pair in gain.measured.misprints.items()]


def _centimeters(length: float | None) -> str:
    return "unknown" if length is None else f"{100.0 * length:.2g} cm"
