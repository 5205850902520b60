"""The paper's misprints, and places where it contradicts itself.

Those in its numbers are recomputed from its tables; the others are texts in `claims.toml`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

from laticauda.paper.claims.printed_numbers import collect_robot_numbers, collect_table_numbers
from laticauda.paper.claims.sentences import fill_in, format_percent
from laticauda.paper.claims.table import read_claims_table
from laticauda.paper.measured import (
    MeasuredRow,
    PrintedAndRecomputed,
    PrintedChange,
    find_printed_changes,
    read_efficiency_trials,
    read_path_following_trials,
)


@dataclass(frozen=True, kw_only=True)
class Misprint:
    """One misprint, or one statement that the paper contradicts elsewhere."""

    section: str
    """Section, table or figure."""
    printed: str
    """What is printed."""
    instead: str
    """What it should be, or what it contradicts, and how that is known."""


def find_misprints() -> tuple[Misprint, ...]:
    """Return misprints and contradictions of the paper."""
    return (
        *_find_misprinted_changes(1, read_efficiency_trials()),
        *_find_misprinted_changes(2, read_path_following_trials()),
        *_find_equal_speeds(),
        *_read_misprints(),
    )


def _read_misprints() -> list[Misprint]:
    """Return the misprints that `claims.toml` describes."""
    numbers = {"tables": collect_table_numbers(), "robots": collect_robot_numbers()}
    return [
        Misprint(
            section=fill_in(entry["section"], numbers),
            printed=fill_in(entry["printed"], numbers),
            instead=fill_in(entry["instead"], numbers),
        )
        for entry in read_claims_table()["misprints"]
    ]


# ---- printed changes -----------------------------------------------------------------------------


class _Column(NamedTuple):
    """Column of Table 1 from which a change is recomputed."""

    field: str
    """Field of its rows."""
    unit: str
    """Unit of the values."""


_COLUMNS = {
    "power": _Column("mean_power", "W"),
    "velocity": _Column("forward_velocity", "m/s"),
}
"""Columns by the names of changes."""


def _find_misprinted_changes(table: int, rows: Sequence[MeasuredRow]) -> list[Misprint]:
    """Return printed changes due to the fin that do not follow from the rows of a table."""
    misprints: list[Misprint] = []
    for change in find_printed_changes(rows):
        for quantity, values in change.misprints.items():
            misprints.append(_describe_misprinted_change(table, change, quantity, values))
    return misprints


def _describe_misprinted_change(
    table: int, change: PrintedChange, quantity: str, values: PrintedAndRecomputed
) -> Misprint:
    row = change.with_fin
    origin = "from the numbers of"
    if table == 1:
        column = _COLUMNS[quantity]
        without_fin = getattr(change.without, column.field)
        with_fin = getattr(change.with_fin, column.field)
        origin = f"from {without_fin:g} to {with_fin:g} {column.unit} in"
    return Misprint(
        section=f"Table {table}, {row.group}, case {row.case}",
        printed=f"Change of {quantity}: {format_percent(values.printed, '+.2f')}.",
        instead=f"{format_percent(values.recomputed, '+.2f')}, {origin} the same table.",
    )


# ---- equal speeds --------------------------------------------------------------------------------


def _find_equal_speeds() -> list[Misprint]:
    """Return pairs of settings of one group with the same speed to four digits."""
    misprints: list[Misprint] = []
    rows = [row for row in read_efficiency_trials() if row.forward_velocity is not None]
    for first, second in combinations(rows, 2):
        if first.group != second.group or first.forward_velocity != second.forward_velocity:
            continue
        misprint = Misprint(
            section=f"Table 1, {first.group}",
            printed=f"{first.forward_velocity:.4f} m/s at two settings, "
            "of which each is a maximum of its sweep.",
            instead="One may have been copied from the other; nothing tells which.",
        )
        misprints.append(misprint)
    return misprints
