"""What a check is, and how its measurement is compared with its limit."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from laticauda.tank.operate.settings import Acceptance
from laticauda.tank.operate.verdict.recorded_run import RecordedRun
from laticauda.values import quantities_of, texts_of


@dataclass(frozen=True, kw_only=True)
class Measurement:
    """The quantity that a check looks at, as it became known in the course of a run."""

    times: Float[np.ndarray, " n_values"]
    """When each value was known [s]."""
    values: Float[np.ndarray, " n_values"]
    """The values, in the unit of the limit; nan where nothing is known.

    The larger, the worse: all limits are upper ones.
    """
    location: str = ""
    """Where the largest value was measured: `module 4`, for instance."""


@dataclass(frozen=True, kw_only=True)
class Check:
    """One check of a run."""

    name: str
    """Name of the check, and of the field of `Acceptance` that holds its limit."""
    measure: Callable[[RecordedRun], Measurement | None]
    """Measures the quantity in a run; None: this run does not allow it."""
    rejects: bool = True
    """Whether a run that exceeds the limit is rejected; otherwise this is only noted."""
    explains_others: bool = False
    """Whether a run that exceeds the limit may for this reason exceed other ones, too."""


class CheckResult(NamedTuple):
    """Result of one check."""

    name: str
    """Name of the field of `Acceptance` that holds its limit."""
    value: float | None
    """Worst value; None: it could not be checked."""
    limit: float
    """Limit beyond which it is wrong."""
    share: float | None
    """Share of the limit that was used [-]."""
    since: float | None
    """Time at which it was first known to exceed its limit [s since the run began]; None: never."""
    outcome: str
    """`ok`, `WRONG`, `noted` or `not checked`."""
    description: str
    """The result in one line: what was checked, how much of the limit was used, since when and
    where."""

    def summary(self) -> dict[str, Any]:
        """Return the result under the keys that recordings and `--json` have."""
        return {
            "name": self.name,
            "value": self.value,
            "limit": self.limit,
            "share": self.share,
            "since": self.since,
            "word": self.outcome,
            "says": self.description,
        }


def compare_with_limit(
    check: Check,
    measurement: Measurement | None,
    limits: Acceptance,
    begin: float,
) -> CheckResult:
    """Return the result of a check.

    Args:
        check: The check.
        measurement: What it measured; None: it could not.
        limits: Limits of all checks.
        begin: Time at which the run began [s].
    """
    limit = float(getattr(limits, check.name))
    subject = texts_of(Acceptance)[check.name]
    if measurement is None or not np.isfinite(measurement.values).any():
        return CheckResult(
            name=check.name,
            value=None,
            limit=limit,
            share=None,
            since=None,
            outcome="not checked",
            description=subject,
        )
    worst = float(np.nanmax(measurement.values))
    since = _first_excess(measurement, limit, begin)
    description = (
        f"{subject}: {_in_shown_unit(check.name, worst, limit)} ({100.0 * worst / limit:.0f} %)"
    )
    if since is not None:
        description += f", since {since:.1f} s"
    if measurement.location:
        description += f"; {measurement.location}"
    return CheckResult(
        name=check.name,
        value=worst,
        limit=limit,
        share=worst / limit,
        since=since,
        outcome=_outcome(check, since),
        description=description,
    )


def _first_excess(measurement: Measurement, limit: float, begin: float) -> float | None:
    """Return when the limit was first exceeded [s since the run began]; None: never."""
    excesses = np.flatnonzero(measurement.values > limit)
    if not excesses.size:
        return None
    return float(measurement.times[excesses[0]]) - begin


def _in_shown_unit(name: str, worst: float, limit: float) -> str:
    """Return `6 of 3 deg`: angles are shown in degrees, and numbers without a unit as such."""
    unit = quantities_of(Acceptance)[name].unit
    if unit == "rad":
        return f"{math.degrees(1.0) * worst:.3g} of {math.degrees(1.0) * limit:.3g} deg"
    return f"{worst:.3g} of {limit:.3g} {unit}".rstrip()


def _outcome(check: Check, since: float | None) -> str:
    if since is None:
        return "ok"
    if check.rejects:
        return "WRONG"
    return "noted"
