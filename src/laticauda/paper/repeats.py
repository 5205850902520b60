"""Repeated trials of one's own, from a CSV file: how far measurements of the same setting scatter.

The first row has the columns' names, in any order; every other row is one trial, and several rows per setting are what
it is for:

    gait,config,alpha_deg,omega_deg_s,delta_deg,v_m_s,P_avg_W
    LU,nofin,30,130,40,0.1514,106.63
    LU,nofin,30,130,40,0.1498,105.10

`gait` is LU (lateral undulation) or EEL (eel-like), `config` nofin or fin, v_m_s the forward velocity (5). The
electrical power above idle, P_avg_W, may be missing, as a column or in single rows.
"""

import csv
import math
import statistics
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from laticauda.errors import BadArgument, TrialFileError, finite, nearest, not_negative, one_of, positive
from laticauda.files import read_text
from laticauda.gaits import Gait, envelope_of
from laticauda.operate.files import SeriesFile, load_operation

TABLE2 = Path(__file__).parent / "data" / "table2_series.toml"
"""Table 2 as a series file of `laticauda operate`: twelve settings, three runs each."""
KINDS = {"LU": "lateral_undulation", "EEL": "eel_like"}
CONFIGURATIONS = ("nofin", "fin")
COLUMNS = ("gait", "config", "alpha_deg", "omega_deg_s", "delta_deg", "v_m_s")
POWER = "P_avg_W"


@dataclass(frozen=True, kw_only=True)
class Repeat:
    """All trials of one setting."""

    gait: Gait
    """What the joints were asked for."""
    has_fin: bool
    """Whether the robot wore the caudal fin."""
    forward_velocity: tuple[float, ...]
    """Equation (5), trial by trial [m/s]."""
    mean_power: tuple[float | None, ...]
    """Electrical power above idle, trial by trial; None where it is missing [W]."""

    @property
    def velocity(self) -> tuple[float, float | None]:
        """Mean and standard deviation of the forward velocity; one trial has no deviation [m/s]."""
        return _mean_and_deviation(self.forward_velocity)

    @property
    def power(self) -> tuple[float, float | None] | None:
        """The same for the power; None if no trial has one [W]."""
        known = [value for value in self.mean_power if value is not None]
        return _mean_and_deviation(known) if known else None


def table2_series() -> SeriesFile:
    """Table 2 as a series to operate."""
    series = load_operation(TABLE2)
    assert isinstance(series, SeriesFile)  # it is ours
    return series


def load_repeats(path: str | Path) -> tuple[Repeat, ...]:
    """Load repeated trials from a CSV file.

    Args:
        path: Of the file; its columns are those of this module's description.

    Returns:
        One entry per setting, in the order in which they first appear.

    Raises:
        TrialFileError: If it cannot be read, or anything in it is wrong; the message has the row, counted as a
            spreadsheet does, with the head as row 1.
    """
    lines = read_text(path, TrialFileError).splitlines()
    try:
        return _grouped(csv.DictReader(lines, restkey="", strict=True))
    except (ValueError, csv.Error) as error:
        raise TrialFileError(f"Cannot read {path}: {error}") from None


def _grouped(rows: "csv.DictReader[str]") -> tuple[Repeat, ...]:
    _check_columns(rows.fieldnames or ())
    trials: dict[tuple[Gait, bool], list[tuple[float, float | None]]] = {}
    for row in rows:
        try:
            gait, has_fin = _setting(row)
            figures = positive("v_m_s", _number(row, "v_m_s"), "m/s"), _power(row)
        except ValueError as error:
            raise ValueError(f"row {rows.line_num}: {error}") from None
        trials.setdefault((gait, has_fin), []).append(figures)
    if not trials:
        raise ValueError("it has no trials.")
    found: list[Repeat] = []
    for (gait, has_fin), figures in trials.items():
        velocity, power = zip(*figures, strict=True)
        found.append(Repeat(gait=gait, has_fin=has_fin, forward_velocity=velocity, mean_power=power))
    return tuple(found)


def _check_columns(names: Iterable[str]) -> None:
    given = list(names)
    known = (*COLUMNS, POWER)
    for name in given:
        if name not in known:
            hint = nearest(name, known) or f"; the columns are {', '.join(known)}"
            raise ValueError(f"row 1: column `{name}` is not known{hint}")
        if given.count(name) > 1:
            raise ValueError(f"row 1: column `{name}` must not be given twice.")
    for name in COLUMNS:
        if name not in given:
            raise ValueError(f"row 1: column `{name}` is missing.")


def _setting(row: Mapping[str, str]) -> tuple[Gait, bool]:
    if "" in row or None in row.values():
        raise ValueError("it must have a cell per column.")
    kind = KINDS[one_of("gait", row["gait"].strip(), tuple(KINDS))]
    has_fin = one_of("config", row["config"].strip(), CONFIGURATIONS) == "fin"
    alpha, omega, delta = (
        math.radians(check(name, _number(row, name), unit))
        for name, check, unit in (
            ("alpha_deg", not_negative, "deg"),
            ("omega_deg_s", not_negative, "deg/s"),
            ("delta_deg", finite, "deg"),
        )
    )
    return Gait(envelope=envelope_of(kind), amplitude=alpha, frequency=omega, phase_shift=delta), has_fin


def _power(row: Mapping[str, str]) -> float | None:
    return positive(POWER, _number(row, POWER), "W") if row.get(POWER, "").strip() else None


def _number(row: Mapping[str, str], name: str) -> float:
    try:
        return float(row[name])
    except ValueError:
        raise BadArgument(name, f"must be a number, got {row[name]!r}") from None


def _mean_and_deviation(values: Iterable[float]) -> tuple[float, float | None]:
    known = [*values]
    return statistics.fmean(known), statistics.stdev(known) if len(known) > 1 else None
