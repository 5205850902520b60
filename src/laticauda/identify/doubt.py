"""Doubt of the model: residuals that the stated noise does not leave, and laws that leave less.

If the noise is estimated, intervals grow with the residuals, whether these are noise or errors of
the model. The stated noise, however rough, tells them apart:

    1. If chi^2 in the stated noise is below the value that this noise exceeds in 30 % of all cases
       (`chi2`), and residuals are not correlated in time, nothing is doubted.
    2. Beyond it, other laws of the water are fitted to the same data (`rival_laws`). The model is in
       doubt if one of them leaves a chi^2 that is smaller by `EVIDENCE`. If the law is right, no
       rival does so in more than about 1 of 1000 cases: the difference of the two has the mean -T
       and the standard deviation 2 sqrt(T), with T as in `discrimination`, and reaches 10 at best
       3.2 standard deviations above its mean.
    3. Without such a law, the model is in doubt if the residuals are `MARGIN` times as large as the
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
EVIDENCE = 10.0
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
    """Ratio that every other law that was tried leaves, by name, least first [-]."""

    def after_trying(self, name: str, factor: float, share: float) -> "Doubt":
        """Return the doubt with one more law.

        What correlation of the noise there is, the law that leaves the least tells best.

        Args:
            name: Name of the law.
            factor: Ratio of the residuals that it leaves to the stated noise [-].
            share: Share of independent numbers among its residuals [-].
        """
        is_best = factor < min(self.rivals.values(), default=np.inf)
        factors = {**self.rivals, name: factor}
        return replace(
            self,
            rivals=dict(sorted(factors.items(), key=lambda named: named[1])),
            share=share if is_best else self.share,
        )

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
        least = min(self.rivals.values())
        noise = least if least > self.usual_factor else 1.0
        squares_per_evidence = EVIDENCE * noise**2 / (self.degrees * self.share)
        if self.factor**2 - least**2 <= squares_per_evidence:
            return ()
        return tuple(
            name
            for name, factor in self.rivals.items()
            if factor**2 - least**2 <= squares_per_evidence
            and self.factor**2 - factor**2 > squares_per_evidence
        )

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
        return (
            f"model in doubt: residuals are {self.factor:.2g} times the stated noise, where {usual} "
            f"(and noise {MARGIN:g} times as large {MARGIN * self.usual_factor:.2g}): the model, not "
            f"the noise, is in doubt, and the intervals do not hold. {self._sentence_of_rivals}"
        ).rstrip()

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
    factor = residual_factor(method, residuals, degrees)
    usual_factor = float(np.sqrt(usual_chi2(degrees, lags).high / degrees))
    is_usual = factor <= np.sqrt(chi2_at(1.0 - UNUSUAL, degrees, lags) / degrees)
    if is_usual and not lags:
        return None
    return Doubt(
        factor=factor,
        usual_factor=usual_factor,
        degrees=degrees,
        share=independent_share(lags),
        is_white=is_of_series and not lags,
    )


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
