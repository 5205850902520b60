"""Repeated trials of a user's own robot, from a CSV file.

They show the scatter of measurements of the same setting. The file is a table of speeds
(`laticauda.trials.measured`), intended to have several rows per setting.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from laticauda.motion import gaits
from laticauda.tank.operate import mean_and_deviation
from laticauda.trials import measured, null_models

TABLE2 = Path(__file__).parent / "data" / "table2_series.toml"
"""Table 2 as a series file of `laticauda operate`: twelve settings, three runs each."""


class MeanAndDeviation(NamedTuple):
    """Mean of the trials of a setting, and how much they scatter."""

    mean: float
    """Mean over the trials."""
    deviation: float | None
    """Standard deviation, in the same unit; None for a single trial."""


@dataclass(frozen=True, kw_only=True)
class Repeat(null_models.Row):
    """All trials of one setting."""

    forward_velocity: tuple[float, ...]
    """Forward velocity by equation (5), trial by trial [m/s]."""
    mean_power: tuple[float | None, ...]
    """Electrical power above idle, trial by trial; None if missing [W]."""

    @property
    def velocity(self) -> MeanAndDeviation:
        """Mean and standard deviation of the forward velocity [m/s]."""
        return MeanAndDeviation(*mean_and_deviation(self.forward_velocity))

    @property
    def power(self) -> MeanAndDeviation | None:
        """Mean and standard deviation of the power; None if no trial has a power [W]."""
        powers = [power for power in self.mean_power if power is not None]
        if not powers:
            return None
        return MeanAndDeviation(*mean_and_deviation(powers))


class _Setting(NamedTuple):
    """What the trials of one repeat have in common."""

    gait: gaits.Gait
    has_fin: bool


def load_repeats(path: str | Path, columns: Mapping[str, str] | None = None) -> tuple[Repeat, ...]:
    """Load repeated trials from a CSV file.

    Args:
        path: Path of the file.
        columns: Names in the file by ours, for columns that it calls otherwise.

    Returns:
        One entry per setting, in the order in which they first appear.

    Raises:
        TrialFileError: If `load_speeds` cannot read the file.
    """
    rows_by_setting: dict[_Setting, list[tuple[float, float | None]]] = {}
    for row in measured.load_speeds(path, columns):
        if row.v_m_s is not None:
            setting = _Setting(gait=row.motion, has_fin=row.config == "fin")
            rows_by_setting.setdefault(setting, []).append((row.v_m_s, row.P_avg_W))
    repeats: list[Repeat] = []
    for setting, rows in rows_by_setting.items():
        repeat = Repeat(
            gait=setting.gait,
            has_fin=setting.has_fin,
            forward_velocity=tuple(velocity for velocity, _ in rows),
            mean_power=tuple(power for _, power in rows),
        )
        repeats.append(repeat)
    return tuple(repeats)
