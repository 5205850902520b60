"""What all searches have in common: they are asked for points, and told what came of them."""

from abc import ABC, abstractmethod

import numpy as np
from jaxtyping import Float

from laticauda.studies.sampling import Table

Losses = Float[np.ndarray, "n_points n_objectives"]
Violation = Float[np.ndarray, " n_points"]


class PointSearch(ABC):
    """A search that is asked for points and told their results, in turn."""

    n_slope_trials: int = 0
    """Trials that slopes cost so far, besides the points that were asked."""

    @abstractmethod
    def ask(self) -> Table:
        """Return the next points to try, one in each row; no rows if there are none that are new."""

    def tell(self, losses: Losses, violation: Violation) -> None:
        """Report the results of all points that were asked last, in their order.

        Args:
            losses: Loss of every point for every objective, smaller is better; any finite number for
                points that are not feasible.
            violation: 0 for every feasible point, otherwise how far it is from being feasible.
        """
        self._learn(losses, violation)

    @abstractmethod
    def _learn(self, losses: Losses, violation: Violation) -> None:
        """Learn from the results of the points that were asked last."""
