"""Search for the best points: which ones to try next, by pymoo; all use of pymoo is in this module.

Two objectives: NSGA-II (Deb et al., IEEE Trans. Evol. Comput. 6, 2002), whose generations spread
over the whole front at once. One objective: differential evolution, DE/rand/1/bin (Storn and Price,
J. Global Optim. 11, 1997): it needs no derivatives and no scaling of the parameters, respects the
bounds, and its generations are batches for the kernel. Its control parameters are fixed, because
pymoo's adaptation draws from a generator that cannot be seeded.
"""

from typing import Any

import numpy as np
from jaxtyping import Float

from laticauda.studies.point_search import Losses, PointSearch, Violation
from laticauda.studies.sampling import Table
from laticauda.values import optional_import

DIFFERENTIAL_WEIGHT = 0.6
"""F of differential evolution: factor of the difference of two points [-]."""
CROSSOVER_RATE = 0.9
"""CR of differential evolution: probability that a number comes from the mutated point [-]."""


class Search(PointSearch):
    """A seeded evolution.

    Args:
        low: Smallest value of every parameter.
        high: Largest value of every parameter.
        n_objectives: 1 or 2.
        population: Points in a generation.
        seed: Seed of all random numbers.

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
        problem_module = _import_pymoo("core.problem")
        self._problem = problem_module.Problem(
            n_var=low.size, n_obj=n_objectives, n_ieq_constr=1, xl=low, xu=high
        )
        self._algorithm = _build_algorithm(n_objectives, population)
        never = _import_pymoo("core.termination").NoTermination()
        self._algorithm.setup(self._problem, termination=never, seed=seed, verbose=False)
        self._generation: Any = None

    def ask(self) -> Table:
        """Return the next generation."""
        self._generation = self._algorithm.ask()
        if self._generation is None or len(self._generation) == 0:
            return np.empty((0, self._problem.n_var))
        return np.array(self._generation.get("X"), dtype=float)

    def _learn(self, losses: Losses, violation: Violation) -> None:
        self._generation.set("F", losses)
        self._generation.set("G", violation[:, np.newaxis])
        for individual in self._generation:
            individual.evaluated.update(("F", "G"))
        self._algorithm.tell(infills=self._generation)

    def insert(self, point: Float[np.ndarray, " n_names"], loss: float) -> None:
        """Put a feasible point into the population of a search for one objective, in place of the worst.

        Args:
            point: The point.
            loss: Its loss.
        """
        individual_module = _import_pymoo("core.individual")
        individual = individual_module.Individual(
            X=point,
            F=np.array([loss]),
            G=np.zeros(1),
        )
        individual.evaluated.update(("F", "G"))
        population = self._algorithm.pop
        losses = population.get("F")[:, 0]
        violations = population.get("CV")[:, 0]
        order = np.lexsort((losses, violations))
        worst = order[-1]
        population[worst] = individual


def package_versions() -> dict[str, str]:
    """Return the versions of the packages on which the search's numbers depend, besides its arguments.

    Raises:
        MissingExtra: If pymoo is not installed.
    """
    pymoo_version = _import_pymoo("version").__version__
    return {
        "numpy": np.__version__,
        "pymoo": str(pymoo_version),
    }


def _build_algorithm(n_objectives: int, population: int) -> Any:
    if n_objectives > 1:
        return _import_pymoo("algorithms.moo.nsga2").NSGA2(pop_size=population)
    differential_evolution = _import_pymoo("algorithms.soo.nonconvex.de").DE
    return differential_evolution(
        pop_size=population,
        variant="DE/rand/1/bin",
        F=DIFFERENTIAL_WEIGHT,
        CR=CROSSOVER_RATE,
        control=_import_pymoo("operators.control").NoParameterControl,
    )


def _import_pymoo(module: str) -> Any:
    return optional_import("An optimization", "pymoo", "scale", f"pymoo.{module}")
