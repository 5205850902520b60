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
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from laticauda.errors import BadArgument, TrialFileError, nearest
from laticauda.files import read_text
from laticauda.gaits import Gait, envelope_of
from laticauda.operate.files import SeriesFile, load_operation
from laticauda.operate.series import mean_and_deviation
from laticauda.paper.measured import KINDS
from laticauda.quantities import option, quantity, value
from laticauda.trial.null_models import Row

TABLE2 = Path(__file__).parent / "data" / "table2_series.toml"
"""Table 2 as a series file of `laticauda operate`: twelve settings, three runs each."""


@value
class _Cells:
    """A row of the file."""

    gait: Literal["LU", "EEL"] = option("Kind of the gait")
    config: Literal["nofin", "fin"] = option("Configuration of the robot")
    alpha_deg: float = quantity("deg", "Amplitude", ge=0.0)
    omega_deg_s: float = quantity("deg/s", "Frequency", ge=0.0)
    delta_deg: float = quantity("deg", "Phase shift")
    v_m_s: float = quantity("m/s", "Forward velocity", gt=0.0)
    P_avg_W: float | None = quantity("W", "Electrical power above idle", gt=0.0, default=None)


COLUMNS = tuple(_Cells.__dataclass_fields__)


@dataclass(frozen=True, kw_only=True)
class Repeat(Row):
    """All trials of one setting."""

    forward_velocity: tuple[float, ...]
    """Equation (5), trial by trial [m/s]."""
    mean_power: tuple[float | None, ...]
    """Electrical power above idle, trial by trial; None where it is missing [W]."""

    @property
    def velocity(self) -> tuple[float, float | None]:
        """Mean and standard deviation of the forward velocity; one trial has no deviation [m/s]."""
        return mean_and_deviation(self.forward_velocity)

    @property
    def power(self) -> tuple[float, float | None] | None:
        """The same for the power; None if no trial has one [W]."""
        known = [value for value in self.mean_power if value is not None]
        return mean_and_deviation(known) if known else None


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
    _check_columns([*(rows.fieldnames or ())])
    trials: dict[tuple[Gait, bool], list[_Cells]] = {}
    for row in rows:
        try:
            if "" in row or None in row.values():
                raise ValueError("it must have a cell per column.")
            cells = _Cells(**{name: _cell(name, text.strip()) for name, text in row.items()})
            alpha, omega, delta = map(math.radians, (cells.alpha_deg, cells.omega_deg_s, cells.delta_deg))
            envelope = envelope_of(KINDS[cells.gait])
            gait = Gait(envelope=envelope, amplitude=alpha, frequency=omega, phase_shift=delta)
        except ValueError as error:
            raise ValueError(f"row {rows.line_num}: {error}") from None
        trials.setdefault((gait, cells.config == "fin"), []).append(cells)
    if not trials:
        raise ValueError("it has no trials.")
    return tuple(
        Repeat(
            gait=gait,
            has_fin=has_fin,
            forward_velocity=tuple(one.v_m_s for one in found),
            mean_power=tuple(one.P_avg_W for one in found),
        )
        for (gait, has_fin), found in trials.items()
    )


def _check_columns(given: list[str]) -> None:
    for name in given:
        if name not in COLUMNS:
            hint = nearest(name, COLUMNS) or f"; the columns are {', '.join(COLUMNS)}"
            raise ValueError(f"row 1: column `{name}` is not known{hint}")
        if given.count(name) > 1:
            raise ValueError(f"row 1: column `{name}` must not be given twice.")
    for name in COLUMNS[:-1]:
        if name not in given:
            raise ValueError(f"row 1: column `{name}` is missing.")


def _cell(name: str, text: str) -> Any:
    """A text, a number, or None for a power that is missing."""
    if name in ("gait", "config") or not text:
        return text or None
    try:
        return float(text)
    except ValueError:
        raise BadArgument(name, f"must be a number, got {text!r}") from None
