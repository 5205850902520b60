"""Trials as measurements: simulated or recorded ones, those in files, and those of the paper's table."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.errors import BadArgument, instance, one_of, positive, whole
from laticauda.identify.measurements import SERIES, Measurement
from laticauda.identify.unknowns import Unknown, numbers_by_name
from laticauda.interfaces import Start
from laticauda.logs import load_trial
from laticauda.quantities import option, quantity, value
from laticauda.robot import load_robot
from laticauda.scenarios import Scenario, scenario
from laticauda.simulate.numbers import UNITS
from laticauda.trial import MeasuredTrials, Trial
from laticauda.trial.null_models import group_name

TABLE_SIGMA = 0.05
"""Noise of the paper's Table 1 as a share of each value, unless one says otherwise; the paper states none [-]."""
TABLE_SELECTED_FROM = 3
"""Of how many settings as good as it a starred row of Table 1 is taken for the best [-]."""

PATH = {"center_of_mass": 0.005}
"""What counts of a trial unless one says otherwise: the path, as a camera sees it [m]."""
STARTS = ("start.x", "start.y", "start.heading")


def from_trial(
    trial: Trial,
    *,
    name: str,
    figures: Mapping[str, float] | None = None,
    series: Mapping[str, float] | None = None,
    every: int = 1,
    group: str = "",
) -> Measurement:
    """A trial, simulated or recorded, as a measurement. It must begin straight and at rest.

    Args:
        trial: With a gait.
        name: What tables and messages call it.
        figures: Names of figures, and the standard deviation of each one's noise in its own unit.
        series: The same for series; of a path in space its x and y.
        every: Which samples of the series count: every so many. Samples so close that their noise is the same
            noise say nothing new, and a fit that counts them all is too sure of itself.
        group: See `Measurement`.

    Raises:
        ValueError: If the trial has no gait, or an argument is out of its range.
    """
    instance("trial", trial, Trial)
    if trial.gait is None:
        raise BadArgument("trial", "must have a gait to be identified from, got one without")
    step = whole("every", every, 1)
    time = trial.time[::step] - trial.time[0]
    at_end = {"x": trial.center_of_mass[-1, 0], "y": trial.center_of_mass[-1, 1], "heading": trial.heading[-1]}
    chosen: dict[str, Any] = {
        one_of("figures", figure, tuple(UNITS)): (at_end.get(figure, getattr(trial, figure, None)), sigma)
        for figure, sigma in (figures or {}).items()
    }
    columns: dict[str, Any] = {}
    for known, sigma in (series or {}).items():
        values = getattr(trial, one_of("series", known, tuple(SERIES)))[::step]
        columns[known] = (values[:, :2] if known == "center_of_mass" else values, sigma)
    x, y = trial.center_of_mass[0, :2]
    return Measurement(
        name=name,
        scenario=Scenario(
            robot=trial.robot,
            motion=trial.gait,
            environment=trial.environment,
            start=Start(center_of_mass=(float(x), float(y)), heading=float(trial.heading[0])),
            duration=trial.duration,
        ),
        group=group,
        figures=chosen,
        time=time if columns else None,
        series=columns,
    )


def from_table1(
    figure: str = "forward_velocity", *, sigma: float = TABLE_SIGMA, selected_from: int = TABLE_SELECTED_FROM
) -> tuple[Measurement, ...]:
    """The rows of the paper's Table 1: Mamba, with and without its fin, 30 s from standstill.

    The paper states no noise: each row has the same share of its value, which is best taken for a guess and estimated
    from the residuals (`noise="estimated"`). Rows with a star are the maxima of sweeps.

    Args:
        figure: forward_velocity, or mean_power.
        sigma: Standard deviation of the noise as a share of the value [-].
        selected_from: See `Measurement`, of the rows with a star.

    Raises:
        ValueError: If an argument is out of its range.
    """
    one_of("figure", figure, ("forward_velocity", "mean_power"))
    positive("sigma", sigma)
    robots = cache(load_robot)
    found: list[Measurement] = []
    for trial in MeasuredTrials.named("table1")().trials():
        value = trial.forward_velocity if figure == "forward_velocity" else trial.mean_power
        if value is None:
            continue
        setting = "/".join(
            f"{np.degrees(number):.0f}"
            for number in (trial.gait.amplitude, trial.gait.frequency, trial.gait.phase_shift)
        )
        found.append(
            Measurement(
                name=f"{group_name(trial.gait.kind, trial.has_fin)}, {setting}",
                scenario=scenario(robots(trial.robot), trial.gait),
                figures={figure: (value, sigma * value)},
                selected_from=selected_from if trial.is_maximum else 1,
            )
        )
    return tuple(found)


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
        check=numbers_by_name("standard deviation"),
    )
    series: Mapping[str, float] = option(
        "Series that count, likewise; neither figures nor series: `PATH`",
        default_factory=dict[str, float],
        check=numbers_by_name("standard deviation"),
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

    def beside(self, folder: Path) -> "TrialFile":
        """The same, its paths relative to a `folder`."""
        columns = None if self.columns is None else str(folder / self.columns)
        return replace(self, file=str(folder / self.file), columns=columns)

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
