"""Measurements to compare with runs: published trials, and tables of speeds.

Published trials are found by the setting of a run. To add measurements, add a class: an installed
package provides its trials through an entry point of the group ``laticauda.measured_trials``.

A table of measured speeds, the most common data of a swimming lab, is a CSV file with one row per
trial. The first row has the column names, in any order:

    gait,config,alpha_deg,omega_deg_s,delta_deg,v_m_s,P_avg_W
    LU,nofin,30,130,40,0.1514,106.63
    LU,nofin,30,130,40,0.1498,105.10

`gait` is LU (lateral undulation) or EEL (eel-like), `config` nofin or fin, v_m_s the forward
velocity (5). A speed may be missing; the column P_avg_W, the electrical power above idle, may be
missing too, and so may every column for which `SpeedTrial` has a default. Column names state the
unit; numbers that can only be in another unit are rejected. Columns that the file calls otherwise
are given by name (`laticauda.values.tables.renaming`).
"""

import math
import re
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from laticauda.motion import gaits
from laticauda.robot import Environment, Robot
from laticauda.scenarios import Controller
from laticauda.trials.trial import Trial
from laticauda.values import (
    BadArgument,
    TrialFileError,
    extensions,
    option,
    quantity,
    read_rows,
    suggest_nearest,
    value_class,
)
from laticauda.values.tables import parse_float, spell_columns, split_unit


@dataclass(frozen=True, kw_only=True)
class MeasuredTrial:
    """One measured setting, without steering."""

    gait: gaits.Gait
    """The commanded gait."""
    robot: str
    """The robot's name (`laticauda.load_robot`)."""
    has_fin: bool
    """Whether the robot wore the caudal fin."""
    forward_velocity: float | None
    """Equation (5); None if not available [m/s]."""
    mean_power: float | None
    """Electrical power above idle (4), not comparable with a mechanical power; None if not available [W]."""
    is_maximum: bool = False
    """Whether it was published as the fastest of a sweep, so that its speed is biased upward by selection."""
    duration: float
    """Duration of the trial, from rest [s]."""
    source: str
    """Where it was published, in a word or two."""
    about: str
    """What swam where, and what one needs to know about the numbers, in a sentence without its final period."""


class MeasuredTrials(extensions.Extensible, group="measured_trials"):
    """Base of published measurements."""

    @abstractmethod
    def trials(self) -> Sequence[MeasuredTrial]:
        """Return all measured settings, including those published without a number."""

    @abstractmethod
    def counterpart(
        self, robot: Robot, gait: gaits.Gait, environment: Environment
    ) -> MeasuredTrial | None:
        """Return the measurement in exactly this setting, or None.

        Args:
            robot: The robot that swims.
            gait: Its gait, without steering.
            environment: The environment in which it swims.
        """


def all_measured() -> list[MeasuredTrials]:
    """Return all installed collections of published measurements."""
    return [MeasuredTrials.named(name)() for name in MeasuredTrials.names()]


def measured_setting(
    robot: Robot, gait: gaits.Gait | None, environment: Environment
) -> MeasuredTrial | None:
    """Return the measurement in a given setting, or None.

    Args:
        robot: The robot that swims.
        gait: Its gait, without steering; None has no counterpart.
        environment: The environment in which it swims.
    """
    if gait is None:
        return None
    for measurements in all_measured():
        trial = measurements.counterpart(robot, gait, environment)
        if trial is not None:
            return trial
    return None


def measured_counterpart(trial: Trial) -> MeasuredTrial | None:
    """Return the measurement in the setting of a run, or None.

    Args:
        trial: A run; one that is steered or starts with a speed has no counterpart, as all were
            measured straight ahead and from rest.
    """
    if _is_steered(trial):
        return None
    if getattr(getattr(trial.scenario, "start", None), "velocity", 0.0) != 0.0:
        return None
    return measured_setting(trial.robot, trial.gait, trial.environment)


def _is_steered(trial: Trial) -> bool:
    """Return whether more than a gait moved the robot: a path, a mission, neurons."""
    if "cross_track_error" in trial.signals:
        return True
    return isinstance(getattr(trial.scenario, "motion", None), Controller)


# ---- tables of speeds ----------------------------------------------------------------------------

KINDS = {"LU": "lateral_undulation", "EEL": "eel_like"}
"""Gait abbreviations used in tables."""
_RADIANS = 3.2
"""If no angle [deg] exceeds this, the angles can only be radians."""


@value_class
class SpeedTrial:
    """A row of a table of speeds."""

    gait: Literal["LU", "EEL"] = option("Kind of the gait")
    config: Literal["nofin", "fin"] | None = option(
        "With or without caudal fin; as the robot if omitted", default=None
    )
    alpha_deg: float = quantity("deg", "Amplitude", ge=0.0)
    omega_deg_s: float = quantity("deg/s", "Frequency", gt=0.0)
    delta_deg: float = quantity("deg", "Phase shift")
    v_m_s: float | None = quantity(
        "m/s", "Forward velocity; empty: not available", gt=0.0, default=None
    )
    P_avg_W: float | None = quantity("W", "Electrical power above idle", gt=0.0, default=None)
    robot: str | None = option("Robot that swam, a preset or a TOML file", default=None)
    duration_s: float = quantity("s", "Duration of the trial, from rest", gt=0.0, default=30.0)
    v_sigma_m_s: float | None = quantity(
        "m/s", "Standard deviation of the speed's noise", gt=0.0, default=None
    )
    P_sigma_W: float | None = quantity("W", "The same for the power", gt=0.0, default=None)
    selected_from: int = quantity(
        "", "Number of about equally good settings of which it is the best", ge=1, default=1
    )

    def __post_init__(self) -> None:
        """Reject values that do not form a valid gait."""
        _ = self.motion

    @property
    def motion(self) -> gaits.Gait:
        """The commanded gait."""
        return gait_in_table(self.gait, self.alpha_deg, self.omega_deg_s, self.delta_deg)


def gait_in_table(kind: str, alpha_deg: float, omega_deg_s: float, delta_deg: float) -> gaits.Gait:
    """Return the gait described by a row of a table.

    Args:
        kind: One of `KINDS`.
        alpha_deg: Amplitude [deg].
        omega_deg_s: Frequency [deg/s].
        delta_deg: Phase shift [deg].
    """
    return gaits.Gait(
        envelope=gaits.envelope_of(KINDS[kind]),
        amplitude=math.radians(alpha_deg),
        frequency=math.radians(omega_deg_s),
        phase_shift=math.radians(delta_deg),
    )


MEANT_COLUMNS = {
    "alpha": "alpha_deg",
    "amplitude": "alpha_deg",
    "amplitude_deg": "alpha_deg",
    "delta": "delta_deg",
    "fin": "config",
    "forward_velocity": "v_m_s",
    "frequency": "omega_deg_s",
    "frequency_deg_s": "omega_deg_s",
    "frequency_hz": "omega_deg_s",
    "kind": "gait",
    "omega": "omega_deg_s",
    "p": "P_avg_W",
    "phase": "delta_deg",
    "phase_shift": "delta_deg",
    "phase_shift_deg": "delta_deg",
    "power": "P_avg_W",
    "speed": "v_m_s",
    "v": "v_m_s",
    "velocity": "v_m_s",
}
"""Columns by headings that people write."""
_COLUMNS = tuple(SpeedTrial.__dataclass_fields__)
_NEVER_EMPTY = ("gait", "alpha_deg", "omega_deg_s", "delta_deg")
_NEEDED = (*_NEVER_EMPTY, "v_m_s")


def load_speeds(
    path: str | Path, columns: Mapping[str, str] | None = None
) -> tuple[SpeedTrial, ...]:
    """Load a table of speeds from a CSV file.

    Args:
        path: Path of the file; its columns are those described at the top of this module.
        columns: Names in the file by ours, for columns that it calls otherwise.

    Raises:
        TrialFileError: If the file cannot be read, or anything in it is wrong; the message gives
            the row, counted as in a spreadsheet, with the header as row 1.
    """
    return tuple(load_numbered_speeds(path, columns).values())


def load_numbered_speeds(
    path: str | Path, columns: Mapping[str, str] | None = None
) -> dict[int, SpeedTrial]:
    """Load a table of speeds by the numbers of its rows; see `load_speeds`.

    Args:
        path: Path of the file.
        columns: Names in the file by ours, for columns that it calls otherwise.
    """
    names, rows = read_rows(path, TrialFileError, columns)
    _check_columns(path, names)
    trials: dict[int, SpeedTrial] = {}
    for number, row in rows:
        try:
            cells = {
                name: _parse_cell(name, text)
                for name, text in row.items()
                if text or name in _NEVER_EMPTY
            }
            trials[number] = SpeedTrial(**cells)
        except ValueError as error:
            raise TrialFileError(f"{path}: row {number}: {error}") from None
    if not trials:
        raise TrialFileError(f"{path}: the table has no rows.")
    for name in ("alpha_deg", "delta_deg"):
        largest = max(abs(getattr(trial, name)) for trial in trials.values())
        if 0.0 < largest < _RADIANS:
            reason = f"only reaches {largest:g}, too little for deg; is it in rad?"
            raise TrialFileError(f"{path}: column `{name}` {reason}")
    return trials


def _check_columns(path: str | Path, names: list[str]) -> None:
    """Reject a table with doubled, unknown or missing columns; all unknown ones are reported."""
    for name in reversed(names):
        if names.count(name) > 1:
            raise TrialFileError(f"{path}: row 1: column `{name}` must not be given twice.")
    unknown = [name for name in names if name not in _COLUMNS]
    if unknown:
        raise TrialFileError(f"{path}: row 1: {_describe_unknown_columns(unknown)}")
    for name in _NEEDED:
        if name not in names:
            raise TrialFileError(f"{path}: row 1: column `{name}` is missing.")


def _describe_unknown_columns(names: Sequence[str]) -> str:
    """Return which columns are not known, each with the one that is probably meant."""
    descriptions: list[str] = []
    meant_columns: dict[str, str] = {}
    for name in names:
        meant = _guess_column(name)
        hint = ""
        if meant is not None:
            hint = f"; did you mean `{meant}`?"
            meant_columns.setdefault(meant, name)
        descriptions.append(f"column `{name}` is not known{hint}")
    sentence = " ".join(descriptions)
    if not meant_columns:
        return f"{sentence}; they are {', '.join(_COLUMNS)}"
    advice = f"If so, say --column {spell_columns(meant_columns)}"
    if sentence.endswith("?"):
        return f"{sentence} {advice}"
    return f"{sentence}; they are {', '.join(_COLUMNS)}. {advice}"


def _guess_column(name: str) -> str | None:
    """Return the column that a heading probably means, if any."""
    heading = split_unit(name)[0]
    meant = MEANT_COLUMNS.get("_".join(heading.casefold().split()))
    if meant is not None:
        return meant
    for words in (name, heading):
        match = re.search("`(.*)`", suggest_nearest(words, _COLUMNS))
        if match is not None:
            return match[1]
    return None


def _parse_cell(name: str, text: str) -> Any:
    """Convert a cell to a number, or keep it as text."""
    if name in ("gait", "config", "robot"):
        return text
    try:
        if name == "selected_from":
            return int(text)
        return parse_float(text)
    except ValueError:
        raise BadArgument(name, f"must be a number, got {text!r}") from None
