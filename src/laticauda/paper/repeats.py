"""Repeated trials of one's own, from a CSV file: how far measurements of the same setting scatter.

It is a table of speeds (`laticauda.trial.speeds`); several rows per setting are what it is for.
"""

from dataclasses import dataclass
from pathlib import Path

from laticauda.gaits import Gait
from laticauda.operate.series import mean_and_deviation
from laticauda.trial import null_models, speeds

TABLE2 = Path(__file__).parent / "data" / "table2_series.toml"
"""Table 2 as a series file of `laticauda operate`: twelve settings, three runs each."""


@dataclass(frozen=True, kw_only=True)
class Repeat(null_models.Row):
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


def load_repeats(path: str | Path) -> tuple[Repeat, ...]:
    """Load repeated trials from a CSV file.

    Args:
        path: Of the file.

    Returns:
        One entry per setting, in the order in which they first appear.

    Raises:
        TrialFileError: As `load_speeds`.
    """
    trials: dict[tuple[Gait, bool], list[tuple[float, float | None]]] = {}
    for one in speeds.load_speeds(path):
        if one.v_m_s is not None:
            trials.setdefault((one.motion, one.config == "fin"), []).append((one.v_m_s, one.P_avg_W))
    return tuple(
        Repeat(
            gait=gait,
            has_fin=has_fin,
            forward_velocity=tuple(speed for speed, _ in found),
            mean_power=tuple(power for _, power in found),
        )
        for (gait, has_fin), found in trials.items()
    )
