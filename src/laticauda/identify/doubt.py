"""Doubt of the model: residuals that the stated noise does not leave, and laws that leave less.

If the noise is estimated, intervals grow with the residuals, whether these are noise or errors of
the model. The stated noise, however rough, tells them apart:

    1. Other laws of the water are fitted to the same data (`rival_laws`). The model is in doubt if
       one of them leaves a chi^2 that is smaller by `EVIDENCE`, even if its own residuals are no
       larger than the noise usually leaves: of many numbers, chi^2 alone scatters more than two laws
       differ. If the law is right, the difference to a rival has the mean -T and the standard
       deviation 2 sqrt(T), with T as in `discrimination`. It reaches 7 at best 2.6 standard
       deviations above its mean, in 1 of 245 cases; with four rivals, a right law is doubted in at
       most 1.7 % of all cases. A rival that fits a further number has to pay for it (`handicaps`).
    2. Without such a law, the model is in doubt if the residuals are `MARGIN` times as large as the
       stated noise leaves in all but 1 of 2000 cases: that noise was stated so much too small is
       less likely. Below, either may be wrong. Residuals of series that are independent from sample
       to sample are noise, however large: errors of a model are not independent.

Correlated residuals are those of correlated noise, or of a wrong model: chi^2 of a rival counts for
as many numbers as are independent in the rival's own residuals. If a rival itself leaves more than
the stated noise does, its residuals are taken for the noise.

A robust loss declares some numbers to be outliers. Residuals are then judged by their median.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float

from laticauda.identify.chi2 import UNUSUAL, chi2_at, independent_share, usual_chi2
from laticauda.identify.method import Method

MARGIN = 1.5
"""Factor by which noise may have been stated too small without a doubt of the model [-]."""
EVIDENCE = 7.0
"""Decrease of chi^2 by which another law casts doubt on that of a fit [-]."""
_MEDIAN_OF_NORMAL = 0.6745
"""Median of |r| for standard normal r [-]."""


@dataclass(frozen=True, kw_only=True)
class Doubt:
    """Residuals that the stated noise does not leave, and what other laws leave."""

    factor: float
    """Ratio of the residuals to the stated noise [-]."""
    usual_factor: float
    """The largest ratio that noise as stated leaves but for 1 of 2000 cases [-]."""
    degrees: float
    """Degrees of freedom [-]."""
    share: float
    """Share of independent numbers among all; less than 1 if noise is correlated in time [-].

    That of the fit itself, or of the best law that was tried.
    """
    is_white: bool = False
    """Whether they are those of series alone, and independent from sample to sample."""
    rivals: Mapping[str, float] = field(default_factory=dict[str, float])
    """Ratio that every other law that was tried leaves, by name, the best first [-].

    The searches of laws that are clearly not the best end early, so that these may leave less.
    """
    handicaps: Mapping[str, float] = field(default_factory=dict[str, float])
    """What laws have to pay in chi^2 for numbers that they fit in addition, by name [-]."""

    def after_trying(
        self, name: str, factor: float, share: float, handicap: float = 0.0
    ) -> "Doubt":
        """Return the doubt with one more law.

        What correlation of the noise there is, the law that describes the data best tells best.

        Args:
            name: Name of the law.
            factor: Ratio of the residuals that it leaves to the stated noise [-].
            share: Share of independent numbers among its residuals [-].
            handicap: What it has to pay in chi^2 for numbers that it fits in addition [-].
        """
        rivals = {**self.rivals, name: factor}
        handicaps = {**self.handicaps, name: handicap}
        judged = replace(self, rivals=rivals, handicaps=handicaps)
        ranked = dict(sorted(rivals.items(), key=lambda named: judged.judged_square(named[0])))
        is_best = next(iter(ranked)) == name
        return replace(judged, rivals=ranked, share=share if is_best else self.share)

    def judged_square(self, name: str) -> float:
        """Return the square of the ratio that a law leaves, with its handicap [-].

        Args:
            name: Name of a law that was tried.
        """
        return self.rivals[name] ** 2 + self.handicaps.get(name, 0.0) / self.degrees

    @property
    def chi2(self) -> float:
        """Sum of the squared residuals, of which the ratio is told [-]."""
        return self.factor**2 * self.degrees

    @property
    def is_far_above(self) -> bool:
        """Whether residuals are so far above the stated noise that they are no noise."""
        return self.factor > MARGIN * self.usual_factor and not self.is_white

    @property
    def better_laws(self) -> tuple[str, ...]:
        """Names of the laws that describe the data clearly better, the best first.

        Those that the best one is clearly better than in turn are not among them.
        """
        if not self.rivals:
            return ()
        best, *_ = self.rivals
        noise = 1.0
        if self.rivals[best] > self.usual_factor:
            noise = self.rivals[best]
        least = self.judged_square(best)
        squares_per_evidence = EVIDENCE * noise**2 / (self.degrees * self.share)
        if self.factor**2 - least <= squares_per_evidence:
            return ()
        names: list[str] = []
        for name in self.rivals:
            square = self.judged_square(name)
            is_better = self.factor**2 - square > squares_per_evidence
            if is_better and square - least <= squares_per_evidence:
                names.append(name)
        return tuple(names)

    @property
    def better_law(self) -> str | None:
        """Name of the law that describes the data best, if it does so clearly better."""
        return next(iter(self.better_laws), None)

    @property
    def is_of_model(self) -> bool:
        """Whether the model, and not the stated noise, is in doubt."""
        return self.is_far_above or self.better_law is not None

    @property
    def words(self) -> str:
        """The doubt in sentences; "" if no law is better and the stated noise may leave as much."""
        usual = f"noise as stated leaves up to {self.usual_factor:.2g} times"
        if not self.is_of_model and self.factor <= self.usual_factor:
            return ""
        if not self.is_of_model:
            cause = "it was stated too small, or the model is wrong"
            if self.is_white:
                cause = "it was stated too small, as neighboring residuals are independent"
            text = f"residuals beyond the stated noise: {self.factor:.2g} times, where {usual}: {cause}"
            return f"{text}; {self._words_of_rivals}." if self.rivals else f"{text}."
        if self.factor <= self.usual_factor:
            return (
                f"model in doubt: residuals are {self.factor:.2g} times the stated noise, which leaves "
                f"as much, but another law of the water describes the data clearly better (chi^2 less "
                f"by {self._decrease:.0f}): the intervals may not hold. {self._sentence_of_rivals}"
            )
        return (
            f"model in doubt: residuals are {self.factor:.2g} times the stated noise, where {usual} "
            f"(and noise {MARGIN:g} times as large {MARGIN * self.usual_factor:.2g}): the model, not "
            f"the noise, is in doubt, and the intervals do not hold. {self._sentence_of_rivals}"
        ).rstrip()

    @property
    def _decrease(self) -> float:
        """How much less chi^2 the best law leaves [-]."""
        best, *_ = self.rivals
        return self.chi2 - self.rivals[best] ** 2 * self.degrees

    @property
    def _sentence_of_rivals(self) -> str:
        if not self.rivals:
            return ""
        if self.better_law is None:
            text = self._words_of_rivals
            return f"{text[0].upper()}{text[1:]}."
        best, *others = self.better_laws
        beside = "".join(f", {name} {self.rivals[name]:.2g}" for name in others)
        return (
            f"{best} leaves {self.rivals[best]:.2g} times the stated noise{beside}, this one "
            f"{self.factor:.2g}."
        )

    @property
    def _words_of_rivals(self) -> str:
        name, least = next(iter(self.rivals.items()))
        return (
            f"no other law of {len(self.rivals)} tried is clearly better "
            f"(best: {name}, {least:.2g} times)"
        )


def doubt_of(
    method: Method,
    residuals: Float[np.ndarray, " n_data"],
    degrees: float,
    lags: Mapping[str, float],
    *,
    is_of_series: bool = False,
) -> Doubt | None:
    """Return the doubt that residuals cast; None if the stated noise usually leaves as much.

    Args:
        method: Loss of the fit.
        residuals: Residuals of the data in the stated noise.
        degrees: Degrees of freedom [-].
        lags: Sample-to-sample correlation of the noise, for series that show one [-].
        is_of_series: Whether all data are samples of series.
    """
    if degrees < 1.0:
        return None
    doubt = judge_residuals(method, residuals, degrees, lags, is_of_series=is_of_series)
    if not lags and is_usual(doubt):
        return None
    return doubt


def judge_residuals(
    method: Method,
    residuals: Float[np.ndarray, " n_data"],
    degrees: float,
    lags: Mapping[str, float],
    *,
    is_of_series: bool,
) -> Doubt:
    """Return how large residuals are, whether or not the stated noise usually leaves as much.

    Args:
        method: Loss of the fit.
        residuals: Residuals of the data in the stated noise.
        degrees: Degrees of freedom, at least 1 [-].
        lags: Sample-to-sample correlation of the noise, for series that show one [-].
        is_of_series: Whether all data are samples of series.
    """
    return Doubt(
        factor=residual_factor(method, residuals, degrees),
        usual_factor=float(np.sqrt(usual_chi2(degrees, lags).high / degrees)),
        degrees=degrees,
        share=independent_share(lags),
        is_white=is_of_series and not lags,
    )


def is_usual(doubt: Doubt) -> bool:
    """Return whether noise as stated usually leaves such residuals, if it is not correlated.

    Args:
        doubt: How large they are.
    """
    return doubt.chi2 <= chi2_at(1.0 - UNUSUAL, doubt.degrees, {})


def residual_factor(
    method: Method, residuals: Float[np.ndarray, " n_data"], degrees: float
) -> float:
    """Return the ratio of residuals to the stated noise, without outliers if the loss is robust.

    Args:
        method: Loss of the fit.
        residuals: Residuals of the data in the stated noise.
        degrees: Degrees of freedom, at least 1 [-].
    """
    if method.loss == "linear":
        return float(np.sqrt(np.sum(residuals**2) / degrees))
    typical = float(np.median(np.abs(residuals))) / _MEDIAN_OF_NORMAL
    return typical * float(np.sqrt(residuals.size / degrees))
