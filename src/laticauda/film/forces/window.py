"""Which part of a film the figures are of: whole cycles in its middle, where the fit is surest."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.film.chain import ChainFit
from laticauda.film.forces.arguments import check_span
from laticauda.values import BadArgument

END_CYCLES = 0.25
"""Part of a cycle at either end of a film that is left out: there the fit sees one side alone."""
END_SHARE = 0.05
"""Share of a film without cycles that is left out at either end."""
SAMPLES_PER_CYCLE = 48
"""Moments of a cycle at which forces are computed."""
SAMPLES_WITHOUT_CYCLE = 120
"""Moments of a film without cycles."""
MOST_CYCLES = 12
"""Cycles that are used, at most: those in the middle."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Window:
    """A span of a film with the moments at which forces are computed."""

    begin: float
    """Begin [s]."""
    end: float
    """End [s]."""
    n_cycles: int
    """Whole cycles in it; 0: the motion does not repeat."""

    @property
    def duration(self) -> float:
        """Length [s]."""
        return self.end - self.begin

    @property
    def time(self) -> Float[np.ndarray, " n_times"]:
        """Equally distant moments, both ends included [s]."""
        n_samples = SAMPLES_WITHOUT_CYCLE
        if self.n_cycles:
            n_samples = SAMPLES_PER_CYCLE * self.n_cycles
        return np.linspace(self.begin, self.end, n_samples + 1)

    def mean(self, series: Float[np.ndarray, "n_times ..."]) -> np.ndarray:
        """Return the mean over the span, by the trapezoidal rule.

        Args:
            series: Values at `time`, the first axis.
        """
        inside = np.sum(series[1:-1], axis=0) + 0.5 * (series[0] + series[-1])
        return inside / (len(series) - 1)

    def mean_cycle(self, series: Float[np.ndarray, "n_times ..."]) -> np.ndarray:
        """Return the mean over the cycles at `SAMPLES_PER_CYCLE` moments of a cycle.

        Args:
            series: Values at `time`, the first axis.
        """
        cycles = series[:-1].reshape(self.n_cycles, SAMPLES_PER_CYCLE, *series.shape[1:])
        return cycles.mean(axis=0)


def choose_window(fit: ChainFit, span: tuple[float, float] | None = None) -> Window:
    """Return the whole cycles in the middle of a film, or of a span of it.

    Args:
        fit: The fit.
        span: Begin and end that are asked for; None: the whole film [s].

    Raises:
        ValueError: If the span is not within the film.
    """
    first = float(fit.model.time[0])
    last = float(fit.model.time[-1])
    if span is not None:
        check_span(span, fit.model.time)
    begin, end = span or (first, last)
    if fit.frequency == 0.0:
        margin = END_SHARE * (last - first)
        return Window(begin=max(begin, first + margin), end=min(end, last - margin), n_cycles=0)
    margin = END_CYCLES / fit.frequency
    begin = max(begin, first + margin)
    end = min(end, last - margin)
    n_cycles = min(math.floor((end - begin) * fit.frequency + 1e-6), MOST_CYCLES)
    if n_cycles < 1:
        period = 1.0 / fit.frequency
        rule = (
            f"must hold a whole cycle of {period:.3g} s, and a quarter of one before and after it, "
            f"{(1.0 + 2.0 * END_CYCLES) * period:.3g} s of the film"
        )
        asked_begin, asked_end = span or (first, last)
        raise BadArgument("span", f"{rule}, got {asked_end - asked_begin:.3g} s; film longer")
    middle = 0.5 * (begin + end)
    half_span = 0.5 * n_cycles / fit.frequency
    return Window(begin=middle - half_span, end=middle + half_span, n_cycles=n_cycles)
