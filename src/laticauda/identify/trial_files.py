"""Trials in files as measurements: which file, and what counts of it."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

import numpy as np

from laticauda.errors import BadArgument, one_of, shown
from laticauda.identify.measurements import SERIES, Measurement, from_trial
from laticauda.identify.unknowns import Unknown
from laticauda.logs import load_trial
from laticauda.quantities import option, quantity, value
from laticauda.simulate.sensitivities import UNITS
from laticauda.trial import Trial

PATH = {"center_of_mass": 0.005}
"""What counts of a trial unless one says otherwise: the path, as a camera sees it [m]."""
STARTS = ("start.x", "start.y", "start.heading")


def _sigmas(name: str, given: Any) -> dict[str, float]:
    sigmas = cast("Mapping[str, Any]", given if isinstance(given, Mapping) else {"": given})
    if not isinstance(given, Mapping) or not all(isinstance(sigma, int | float) for sigma in sigmas.values()):
        raise BadArgument(name, f"must be a table of name = standard deviation, got {shown(cast(object, given))}")
    return {what: float(sigma) for what, sigma in sigmas.items()}


@value
class TrialFile:
    """A file with a trial, and what counts of it."""

    file: str = option("Where it is")
    columns: str | None = option("What its columns are, a TOML file, if another program wrote it", default=None)
    name: str = option("What tables call it; empty: as the file", default="")
    group: str = option("Which measurements it belongs with, see `Measurement`", default="")
    figures: Mapping[str, float] = option(
        "Figures that count, and the standard deviation of each one's noise",
        default_factory=dict[str, float],
        check=_sigmas,
    )
    series: Mapping[str, float] = option(
        "Series that count, likewise; neither figures nor series: `PATH`",
        default_factory=dict[str, float],
        check=_sigmas,
    )
    interval: float = quantity(
        "s",
        "Between the samples of a series that count: the noise of closer ones is hardly new",
        default=0.5,
        gt=0.0,
    )
    free_start: bool = option(
        "Whether place and heading at the begin are identified too where the path counts: the first sample has noise "
        "as all others have, and would push them all",
        default=True,
    )

    @property
    def label(self) -> str:
        """What tables call it."""
        return self.name or Path(self.file).stem

    @property
    def counted_series(self) -> Mapping[str, float]:
        """Series that count, the path if nothing else was asked for."""
        return self.series if self.series or self.figures else PATH

    @property
    def starts(self) -> tuple[Unknown, ...]:
        """What is identified of the begin."""
        if not self.free_start or "center_of_mass" not in self.counted_series:
            return ()
        return tuple(Unknown(name=f"{self.label}.{name}") for name in STARTS)

    @property
    def sources(self) -> tuple[Path, ...]:
        """The files that it is read from."""
        return tuple(Path(name) for name in (self.file, self.columns) if name is not None)

    def measurement(self) -> Measurement:
        """The trial as a measurement.

        Raises:
            TrialFileError: If it cannot be read.
            ValueError: If it has no gait, or lacks what is to count.
        """
        trial = load_trial(self.file, self.columns)
        _check_there(self.label, trial, [*self.figures, *self.counted_series])
        step = float(np.median(np.diff(trial.time))) if trial.time.size > 1 else self.interval
        try:
            return from_trial(
                trial,
                name=self.label,
                figures=self.figures,
                series=self.counted_series,
                every=max(1, round(self.interval / step)),
                group=self.group,
            )
        except ValueError as error:
            raise ValueError(f"{self.file}: {error}") from error


def _check_there(name: str, trial: Trial, wanted: list[str]) -> None:
    for what in wanted:
        one_of(f"measured` of `{name}", what, (*UNITS, *SERIES))
        if what in trial.not_measured:
            raise BadArgument(what, f"of `{name}` must have been measured to count; the file does not have it")
