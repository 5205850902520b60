"""Search by CMA-ES, for one objective without slopes; all use of cma is in this module.

The covariance matrix adaptation evolution strategy (Hansen, The CMA Evolution Strategy: A Tutorial,
arXiv:1604.00772), as implemented in its author's package, which pymoo brings along. It learns which
numbers have to change together. It only compares points: of two that are not feasible, the one nearer to
being so is better, and any feasible one is better than both.
"""

from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.studies.point_search import Losses, PointSearch, Violation
from laticauda.studies.sampling import Table
from laticauda.values import optional_import

FIRST_DEVIATION = 0.1
"""Standard deviation of the first generation, as a share of every number's range [-]."""


class CmaSearch(PointSearch):
    """A seeded search for one objective.

    Args:
        start: Point around which it begins.
        low: Smallest value of every parameter.
        high: Largest value of every parameter.
        population: Points in a generation; None takes 4 + 3 ln n for n numbers.
        deviation: Standard deviation of the first generation, as a share of every number's range.
        seed: Seed of all random numbers.

    Raises:
        MissingExtra: If cma is not installed.
    """

    def __init__(
        self,
        start: Float[np.ndarray, " n_names"],
        low: Float[np.ndarray, " n_names"],
        high: Float[np.ndarray, " n_names"],
        *,
        population: int | None = None,
        deviation: float = FIRST_DEVIATION,
        seed: int,
    ) -> None:
        cma = import_cma()
        self._low = low
        self._range = high - low
        generator = np.random.default_rng(seed)

        def draw(n_points: int, n_names: int) -> np.ndarray:
            return generator.standard_normal((n_points, n_names))

        settings: dict[str, Any] = {
            "bounds": [0.0, 1.0],
            "seed": np.nan,  # its own generator would be that of the whole process
            "randn": draw,
            "verbose": -9,
            "verb_log": 0,
            "tolfun": 0.0,
            "tolfunhist": 0.0,
            "tolx": 0.0,
            "tolstagnation": 10**9,
            "maxiter": np.inf,
        }
        if population is not None:
            settings["popsize"] = population
        shares = np.clip((start - low) / self._range, 0.0, 1.0)
        self._strategy: Any = cma.CMAEvolutionStrategy(shares, deviation, settings)
        self._asked: list[Any] = []

    @property
    def population(self) -> int:
        """Points in a generation."""
        return int(self._strategy.popsize)

    def ask(self) -> Table:
        """Return the next generation."""
        self._asked = self._strategy.ask()
        return self._low + self._range * np.array(self._asked)

    def _learn(self, losses: Losses, violation: Violation) -> None:
        is_feasible = violation == 0.0
        feasible_losses = losses[is_feasible, 0]
        worst = float(np.max(feasible_losses, initial=0.0))
        ranks = np.where(is_feasible, losses[:, 0], worst + 1.0 + violation)
        self._strategy.tell(self._asked, ranks.tolist())


def import_cma() -> Any:
    """Return the package."""
    return optional_import("An optimization", "cma", "scale")
