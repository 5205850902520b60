"""How a fit is made."""

from typing import Literal

from laticauda.identify.identifiability import LIMIT
from laticauda.quantities import option, quantity, value


@value
class Method:
    """How a fit is made.

    Raises:
        ValueError: If a field is out of its range.
    """

    noise: Literal["known", "estimated"] = option(
        "known: as the measurements state it; estimated: that times a common factor, which the residuals say",
        default="known",
    )
    loss: Literal["linear", "soft_l1", "huber", "cauchy", "arctan"] = option(
        "How residuals count: all but linear give outliers less weight", default="linear"
    )
    n_starts: int = quantity("", "How many starts", default=4, ge=1)
    seed: int = quantity("", "Of the further starts", default=0, ge=0)
    confidence: float = quantity("", "Of the intervals", default=0.95, ge=0.5, le=0.9999)
    limit: float = quantity(
        "", "From which relative standard deviation on an unknown counts as not identified", default=LIMIT, gt=0.0
    )
