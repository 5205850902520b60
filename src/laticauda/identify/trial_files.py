"""Files that hold measurements of a task: trials, and tables of speeds."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import laticauda as lc
from laticauda.identify.conversion import from_trial
from laticauda.identify.measurements import Measurement
from laticauda.identify.series import SERIES
from laticauda.identify.tables import FIGURES, TABLE_SIGMA
from laticauda.identify.unknowns import name_field, numbers_by_name
from laticauda.models.simulate import UNITS
from laticauda.values import (
    BadArgument,
    check_choice,
    check_one_among,
    option,
    quantity,
    value_class,
)
from laticauda.values.tables import check_columns

PATH = {"center_of_mass": 0.005}
"""Series of a trial used by default: the path as seen by a camera, with its noise [m]."""
_NOISES: Any = {"default_factory": dict[str, float], "check": numbers_by_name("standard deviation")}


@value_class
class TrialFile:
    """A file with a trial, and the parts of it that are used."""

    file: str = option("Path of the trial file")
    columns: str | None = option(
        "Column map (TOML), if another program wrote the file", default=None
    )
    name: str = option("Name in tables; empty: that of the file", default="")
    group: str = option("Group of measurements it belongs to, see `Measurement`", default="")
    figures: Mapping[str, float] = option("Figures to fit, with their noise", **_NOISES)
    series: Mapping[str, float] = option(
        "Series to fit, with their noise; if none: `PATH`", **_NOISES
    )
    interval: float = quantity(
        "s", "Between samples used; the noise of closer ones is hardly new", default=0.5, gt=0.0
    )
    free_start: bool = option(
        "Also identify the initial position and heading, if either is used", default=True
    )

    @property
    def label(self) -> str:
        """Name in tables."""
        return self.name or Path(self.file).stem

    @property
    def counted_series(self) -> Mapping[str, float]:
        """Series that are used; the path if nothing else was requested."""
        if self.series or self.figures:
            return self.series
        return PATH

    @property
    def sources(self) -> tuple[Path, ...]:
        """Files that it is read from."""
        return tuple(Path(name) for name in (self.file, self.columns) if name is not None)

    def beside(self, folder: Path) -> "TrialFile":
        """Return the same with its paths relative to a folder.

        Args:
            folder: Folder to prepend to its paths.
        """
        columns = self.columns
        if columns is not None:
            columns = str(folder / columns)
        return replace(self, file=str(folder / self.file), columns=columns)

    def measurement(self) -> Measurement:
        """Return the trial as a measurement.

        Raises:
            TrialFileError: If it cannot be read.
            ValueError: If it has no gait, or lacks a figure or series to be used.
        """
        trial = lc.load_trial(self.file, self.columns)
        _check_was_measured(self.label, trial, [*self.figures, *self.counted_series])
        sample_interval = self.interval
        if trial.time.size > 1:
            sample_interval = float(np.median(np.diff(trial.time)))
        try:
            return from_trial(
                trial,
                name=self.label,
                figures=self.figures,
                series=self.counted_series,
                every=max(1, round(self.interval / sample_interval)),
                group=self.group,
                free_start=self.free_start,
            )
        except ValueError as error:
            raise ValueError(f"{self.file}: {error}") from error


def _check_was_measured(label: str, trial: lc.Trial, names: Sequence[str]) -> None:
    for name in names:
        check_choice(name_field("measured", label), name, (*UNITS, *SERIES))
        if name in trial.not_measured:
            rule = f"of `{label}` must have been measured to be fitted; the file does not have it"
            raise BadArgument(name, rule)


@value_class
class TableFile:
    """A file with one row per trial."""

    file: str = option("Path of the table; for its columns see `laticauda.trials.measured`")
    figure: str = option(
        "forward_velocity or mean_power", default=FIGURES[0], check=check_one_among(*FIGURES)
    )
    sigma: float = quantity(
        "", "Relative noise of rows that do not state their own", default=TABLE_SIGMA, gt=0.0
    )
    columns: Mapping[str, str] = option(
        "Names in the file by ours, for columns that it calls otherwise",
        default_factory=dict[str, str],
        check=check_columns,
    )
