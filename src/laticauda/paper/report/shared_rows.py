"""Rows of tables that both studies have: errors of all predictors, and changes due to the fin."""

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from laticauda.paper.efficiency import EfficiencyStudy
from laticauda.paper.fin_effect import FinGain
from laticauda.paper.measured import MeasuredRow, PrintedChange
from laticauda.paper.path_following import PathFollowingStudy
from laticauda.paper.scores import score_study
from laticauda.show.reports import Row


def build_error_rows(
    study: EfficiencyStudy | PathFollowingStudy, fitted: str, titles: Mapping[str, str]
) -> list[Row]:
    """Return the errors of all predictors of a table, those without physics included.

    Args:
        study: Study of that table.
        fitted: Title of the column with the number of fitted values.
        titles: Titles of rows that replace the predictor's name.
    """
    rows: list[Row] = []
    for score in score_study(study):
        row: Row = {
            "predictor of v": titles.get(score.title, score.title),
            fitted: score.n_fitted or 0,
        }
        for group, error in zip(study.settings.groups, score.by_group, strict=True):
            row[f"{group.name} [%]"] = error
        row["all rows [%]"] = score.overall
        if isinstance(study, EfficiencyStudy):
            row["leaving one row out [%]"] = score.leave_one_out
            row["leaving one group out [%]"] = score.leave_one_group_out
        rows.append(row)
    return rows


def build_fin_row(change: PrintedChange, *, setting: Row, velocity: Row, power: Row) -> Row:
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


class MisprintedChange(NamedTuple):
    """A change due to the fin that does not follow from the table."""

    row: MeasuredRow
    """The row with the fin."""
    quantity: str
    """What changes: velocity or power."""
    printed: float
    """Change as printed [%]."""
    recomputed: float
    """Change from the two rows [%]."""


def list_misprinted_changes(gains: Iterable[FinGain[Any]]) -> list[MisprintedChange]:
    """Return all misprinted changes of a table.

    Args:
        gains: All changes of the table.
    """
    misprinted: list[MisprintedChange] = []
    for gain in gains:
        for quantity, values in gain.measured.misprints.items():
            change = MisprintedChange(
                row=gain.measured.with_fin,
                quantity=quantity,
                printed=values.printed,
                recomputed=values.recomputed,
            )
            misprinted.append(change)
    return misprinted
