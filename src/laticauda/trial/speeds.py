"""A table of measured speeds, the commonest data of a swimming lab: a CSV file with one row a trial.

The first row has the columns' names, in any order:

    gait,config,alpha_deg,omega_deg_s,delta_deg,v_m_s,P_avg_W
    LU,nofin,30,130,40,0.1514,106.63
    LU,nofin,30,130,40,0.1498,105.10

`gait` is LU (lateral undulation) or EEL (eel-like), `config` nofin or fin, v_m_s the forward velocity (5). A speed
may be missing; the electrical power above idle, P_avg_W, may be missing as a column, too, and so may all else that
`SpeedTrial` has a default for. A column says its unit, and numbers that can only be in another one are refused.
"""

import math
from pathlib import Path
from typing import Any, Literal

from laticauda.errors import BadArgument, TrialFileError, nearest
from laticauda.files import read_rows
from laticauda.gaits import Gait, envelope_of
from laticauda.quantities import option, quantity, value

KINDS = {"LU": "lateral_undulation", "EEL": "eel_like"}
"""The gaits as tables call them."""
_RADIANS = 3.2  # angles [deg] none of which is greater can only be radians


@value
class SpeedTrial:
    """A row of the file."""

    gait: Literal["LU", "EEL"] = option("Kind of the gait")
    config: Literal["nofin", "fin"] | None = option("With caudal fin or without; left out: as the robot", default=None)
    alpha_deg: float = quantity("deg", "Amplitude", ge=0.0)
    omega_deg_s: float = quantity("deg/s", "Frequency", gt=0.0)
    delta_deg: float = quantity("deg", "Phase shift")
    v_m_s: float | None = quantity("m/s", "Forward velocity; empty: not available", gt=0.0, default=None)
    P_avg_W: float | None = quantity("W", "Electrical power above idle", gt=0.0, default=None)
    robot: str | None = option("What swam, a preset or a TOML file", default=None)
    duration_s: float = quantity("s", "Of the trial, from rest", gt=0.0, default=30.0)
    v_sigma_m_s: float | None = quantity("m/s", "Standard deviation of the speed's noise", gt=0.0, default=None)
    P_sigma_W: float | None = quantity("W", "The same of the power", gt=0.0, default=None)
    selected_from: int = quantity("", "Of how many settings about as good it is the best", ge=1, default=1)

    def __post_init__(self) -> None:
        """Refuse what is no gait."""
        _ = self.motion

    @property
    def motion(self) -> Gait:
        """What the joints were asked for."""
        alpha, omega, delta = map(math.radians, (self.alpha_deg, self.omega_deg_s, self.delta_deg))
        return Gait(envelope=envelope_of(KINDS[self.gait]), amplitude=alpha, frequency=omega, phase_shift=delta)


_COLUMNS = tuple(SpeedTrial.__dataclass_fields__)
_NEEDED = ("gait", "alpha_deg", "omega_deg_s", "delta_deg", "v_m_s")


def load_speeds(path: str | Path) -> tuple[SpeedTrial, ...]:
    """Load a table of speeds from a CSV file.

    Args:
        path: Of the file; its columns are those of this module's description.

    Raises:
        TrialFileError: If it cannot be read, or anything in it is wrong; the message has the row, counted as a
            spreadsheet does, with the head as row 1.
    """
    names, rows = read_rows(path, TrialFileError)
    _check_columns(path, names)
    found: list[SpeedTrial] = []
    for number, row in rows:
        try:
            cells = {name: _cell(name, text) for name, text in row.items() if text or name in _NEEDED[:-1]}
            found.append(SpeedTrial(**cells))
        except ValueError as error:
            raise TrialFileError(f"{path}: row {number}: {error}") from None
    if not found:
        raise TrialFileError(f"{path}: it has no trials.")
    for name in ("alpha_deg", "delta_deg"):
        most = max(abs(getattr(one, name)) for one in found)
        if 0.0 < most < _RADIANS:
            raise TrialFileError(f"{path}: column `{name}` goes to {most:g}, which can hardly be deg; is it in rad?")
    return tuple(found)


def _check_columns(path: str | Path, given: list[str]) -> None:
    rules = [f"`{name}` is missing." for name in _NEEDED if name not in given]
    for name in given:
        if name not in _COLUMNS:
            hint = nearest(name, _COLUMNS) or f"; they are {', '.join(_COLUMNS)}"
            rules.insert(0, f"`{name}` is not known{hint}")
        if given.count(name) > 1:
            rules.insert(0, f"`{name}` must not be given twice.")
    if rules:
        raise TrialFileError(f"{path}: row 1: column {rules[0]}")


def _cell(name: str, text: str) -> Any:
    """A text, or a number."""
    if name in ("gait", "config", "robot"):
        return text
    try:
        return int(text) if name == "selected_from" else float(text)
    except ValueError:
        raise BadArgument(name, f"must be a number, got {text!r}") from None
