"""Trials in files as measurements: which file, and what counts of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

import numpy as np

from laticauda.codec import BadKey
from laticauda.errors import nearest, one_of, positive
from laticauda.identify.measurements import SERIES, Measurement, from_trial
from laticauda.identify.unknowns import Unknown
from laticauda.logs import load_trial
from laticauda.simulate.sensitivities import UNITS
from laticauda.trial import Trial

INTERVAL = 0.5
"""Between the samples of a series that count: the noise of closer ones is hardly new [s]."""
PATH = {"center_of_mass": 0.005}
"""What counts unless one says otherwise: the path, as a camera sees it [m]."""
KEYS = ("file", "columns", "name", "group", "figures", "series", "interval", "free_start")
STARTS = ("start.x", "start.y", "start.heading")


@dataclass(frozen=True, kw_only=True)
class TrialFile:
    """A file with a trial, and what counts of it."""

    file: Path
    """Where it is."""
    columns: Path | None = None
    """What its columns are, a TOML file, if another program wrote it."""
    name: str = ""
    """What tables call it; "": as the file."""
    group: str | None = None
    """See `Measurement`."""
    figures: Mapping[str, float] = field(default_factory=dict[str, float])
    """Figures that count, and the standard deviation of each one's noise."""
    series: Mapping[str, float] = field(default_factory=dict[str, float])
    """Series that count, likewise; neither figures nor series: `PATH`."""
    interval: float = INTERVAL
    """Between the samples of series that count [s]."""
    is_start_free: bool = True
    """Whether place and heading at the begin are identified too where the path counts: the first sample has noise as
    all others have, and would push them all."""

    @property
    def label(self) -> str:
        """What tables call it."""
        return self.name or self.file.stem

    @property
    def counted_series(self) -> Mapping[str, float]:
        """Series that count, the path if nothing else was asked for."""
        return self.series if self.series or self.figures else PATH

    @property
    def starts(self) -> tuple[Unknown, ...]:
        """What is identified of the begin."""
        if not self.is_start_free or "center_of_mass" not in self.counted_series:
            return ()
        return tuple(Unknown(name=f"{self.label}.{name}") for name in STARTS)


def as_measurement(given: TrialFile) -> Measurement:
    """The trial as a measurement.

    Args:
        given: Where it is, and what counts.

    Raises:
        TrialFileError: If it cannot be read.
        ValueError: If it has no gait, or lacks what is to count.
    """
    trial = load_trial(given.file, given.columns)
    name, series = given.label, given.counted_series
    _check_there(name, trial, [*given.figures, *series])
    positive("interval", given.interval, "s")
    step = float(np.median(np.diff(trial.time))) if trial.time.size > 1 else given.interval
    try:
        return from_trial(
            trial,
            name=name,
            figures=given.figures,
            series=series,
            every=max(1, round(given.interval / step)),
            group=given.group,
        )
    except ValueError as error:
        raise ValueError(f"{given.file}: {error}") from error


def _check_there(name: str, trial: Trial, wanted: list[str]) -> None:
    for what in wanted:
        one_of(f"measured` of `{name}", what, (*UNITS, *SERIES))
        if what in trial.not_measured:
            raise ValueError(f"`{what}` of `{name}` must have been measured to count; the file does not have it.")


def read_trial_file(entry: object, folder: Path, where: str) -> TrialFile:
    """An entry of a task's list of trials.

    Args:
        entry: As TOML gives it.
        folder: Where files without a folder lie.
        where: What messages call the entry.

    Raises:
        BadKey: If a key is unknown or wrong.
    """
    if isinstance(entry, str):
        entry = {"file": entry}
    if not isinstance(entry, dict):
        raise BadKey(where, f"must be a file's name or a table, got {entry!r}")
    table = cast("dict[str, Any]", entry)
    for key in table:
        if key not in KEYS:
            hint = nearest(key, KEYS) or f"; the keys here are {', '.join(KEYS)}"
            raise BadKey(f"{where}.{key}", f"is not known{hint}")
    if not isinstance(table.get("free_start", True), bool):
        raise BadKey(f"{where}.free_start", f"must be true or false, got {table['free_start']!r}")
    for key in ("file", "columns", "name", "group"):
        if key in table and not isinstance(table[key], str):
            raise BadKey(f"{where}.{key}", f"must be a text, got {table[key]!r}")
    if "file" not in table:
        raise BadKey(f"{where}.file", "is missing")
    return TrialFile(
        file=folder / table["file"],
        columns=folder / table["columns"] if "columns" in table else None,
        name=table.get("name", ""),
        group=table.get("group"),
        figures=_sigmas(table, "figures", where),
        series=_sigmas(table, "series", where),
        interval=table.get("interval", INTERVAL),
        is_start_free=table.get("free_start", True),
    )


def _sigmas(table: Mapping[str, Any], key: str, where: str) -> dict[str, float]:
    value: Any = table.get(key, {})
    if not isinstance(value, dict) or not all(
        isinstance(s, int | float) for s in cast("dict[Any, Any]", value).values()
    ):
        raise BadKey(f"{where}.{key}", f"must be a table of name = standard deviation, got {value!r}")
    return {str(name): float(sigma) for name, sigma in cast("dict[Any, Any]", value).items()}
