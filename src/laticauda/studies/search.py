"""The search for better points, generation by generation, and the one door to pymoo.

Two objectives: NSGA-II (Deb et al., IEEE Trans. Evol. Comput. 6, 2002), whose generations spread over the whole front
at once. One objective: differential evolution, DE/rand/1/bin (Storn and Price, J. Global Optim. 11, 1997): it needs no
derivatives and no scale for the parameters, keeps to the bounds, and its generations are batches for the kernel. Its
numbers do not adapt: pymoo's adaptation draws from a generator that cannot be seeded.

A search is determined by its bounds, its seed and the answers that it is given: so one that was stopped is brought back
by asking it the same again, and giving it the answers that it had before. Nothing of its state is stored.
"""

from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.extras import optional_import

Table = Float[np.ndarray, "n_points n_names"]
Losses = Float[np.ndarray, "n_points n_objectives"]

POPULATION = {1: 40, 2: 100}
"""Points in a generation, by number of objectives."""
LEAST_POPULATION = 4  # differential evolution combines four of them


class Search:
    """A seeded search, between its questions and the answers to them.

    Args:
        low: Least value of every parameter.
        high: Greatest value of every parameter.
        n_objectives: 1 or 2.
        population: Points in a generation.
        seed: Of everything random.

    Raises:
        MissingExtra: If pymoo is not installed.
    """

    def __init__(
        self,
        low: Float[np.ndarray, " n_names"],
        high: Float[np.ndarray, " n_names"],
        *,
        n_objectives: int,
        population: int,
        seed: int,
    ) -> None:
        core = _pymoo("core.problem")
        self._problem = core.Problem(n_var=low.size, n_obj=n_objectives, n_ieq_constr=1, xl=low, xu=high)
        self._algorithm = _algorithm(n_objectives, population)
        forever = _pymoo("core.termination").NoTermination()
        self._algorithm.setup(self._problem, termination=forever, seed=seed, verbose=False)
        self._generation: Any = None

    def ask(self) -> Table:
        """The next generation; no rows if the search has no new points to try."""
        self._generation = self._algorithm.ask()
        if self._generation is None or len(self._generation) == 0:
            return np.empty((0, self._problem.n_var))
        return np.array(self._generation.get("X"), dtype=float)

    def tell(
        self, losses: Float[np.ndarray, "n_points n_objectives"], violation: Float[np.ndarray, " n_points"]
    ) -> None:
        """What the points of the last generation came to.

        Args:
            losses: Smaller is better; of points that are not feasible any finite number.
            violation: 0 for points that are feasible, else how far they are from that.
        """
        self._generation.set("F", losses)
        self._generation.set("G", violation[:, np.newaxis])
        for individual in self._generation:
            individual.evaluated.update(("F", "G"))
        self._algorithm.tell(infills=self._generation)


def versions() -> dict[str, str]:
    """Of what the search's numbers depend on besides its arguments.

    Raises:
        MissingExtra: If pymoo is not installed.
    """
    return {"numpy": np.__version__, "pymoo": str(_pymoo("version").__version__)}


def _algorithm(n_objectives: int, population: int) -> Any:
    if n_objectives > 1:
        return _pymoo("algorithms.moo.nsga2").NSGA2(pop_size=population)
    control = _pymoo("operators.control").NoParameterControl
    de = _pymoo("algorithms.soo.nonconvex.de").DE
    return de(pop_size=population, variant="DE/rand/1/bin", F=0.6, CR=0.9, control=control)


def _pymoo(module: str) -> Any:
    return optional_import("An optimization", "pymoo", "scale", f"pymoo.{module}")
