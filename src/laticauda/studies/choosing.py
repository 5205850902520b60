"""Which search tries the points of an optimization: an evolution, CMA-ES, or one that follows slopes."""

from collections.abc import Mapping
from functools import partial
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np

from laticauda.models.simulate import value_of
from laticauda.studies.cma_search import CmaSearch, import_cma
from laticauda.studies.limited_search import LimitedSearch
from laticauda.studies.local_model import DesignProblem
from laticauda.studies.optimization import (
    Optimization,
    can_have_slopes,
    compute_slope,
    has_slopes,
)
from laticauda.studies.point_search import PointSearch
from laticauda.studies.search import Search, package_versions
from laticauda.studies.slope_search import SlopeSearch
from laticauda.values import BadArgument, check_choice, check_whole_number

Method: TypeAlias = Literal["auto", "evolution", "cma-es", "slopes"]
"""How points are chosen; `auto` takes slopes where there are some."""
METHODS = ("auto", "evolution", "cma-es", "slopes")
POPULATION: Mapping[int, int] = {1: 40, 2: 100}
"""Points in a generation of an evolution, by number of objectives."""
LEAST_POPULATION = 4
"""Points in a generation at least: differential evolution combines four of them."""
LEAST_NUMBERS_OF_CMA = 2
"""Numbers that CMA-ES needs at least."""
MOST_NUMBERS = 10
"""Numbers up to which differential evolution is used where there are no slopes and no limits of a design."""


class ChosenSearch(NamedTuple):
    """A search, and what its numbers depend on."""

    search: PointSearch
    settings: dict[str, Any]
    """Its settings and the versions of packages, for a file."""
    least_budget: int
    """Points that it tries at least."""


def choose_search(
    optimization: Optimization,
    method: str,
    *,
    population: int | None,
    seed: int,
    threads: int | None,
) -> ChosenSearch:
    """Return the search for an optimization.

    Args:
        optimization: The optimization.
        method: One of `METHODS`.
        population: Points in a generation; None takes that of the method.
        seed: Seed of all random numbers.
        threads: Number of threads for slopes; None uses all cores.

    Raises:
        ValueError: If the optimization does not allow the method.
        MissingExtra: If a package is not installed.
    """
    check_choice("method", method, METHODS)
    if population is not None:
        check_whole_number("population", population, LEAST_POPULATION)
    if method == "auto":
        method = _find_method(optimization)
    _check_method(optimization, method)
    if method == "cma-es":
        return _choose_cma(optimization, population, seed)
    if method == "slopes" and optimization.limits_design:
        return _choose_limited_search(optimization, seed, threads)
    n_objectives = len(optimization.objectives)
    if population is None:
        population = POPULATION[n_objectives]
    settings: dict[str, Any] = {"population": population, "seed": seed, **package_versions()}
    low, high = optimization.box()
    evolution = Search(low, high, n_objectives=n_objectives, population=population, seed=seed)
    if method == "slopes":
        slope = partial(compute_slope, optimization, threads=threads)
        search = SlopeSearch(evolution, slope, low, high)
        return ChosenSearch(search, {**settings, "search": "slopes"}, population)
    return ChosenSearch(evolution, settings, population)


def _choose_cma(optimization: Optimization, population: int | None, seed: int) -> ChosenSearch:
    """Return the search by CMA-ES."""
    low, high = optimization.box()
    start = find_start(optimization)
    search = CmaSearch(start, low, high, population=population, seed=seed)
    settings = _settings_of_cma(search.population, seed, "cma-es")
    return ChosenSearch(search, settings, search.population)


def _choose_limited_search(
    optimization: Optimization, seed: int, threads: int | None
) -> ChosenSearch:
    """Return the search that knows the slopes of the limits of a design."""
    low, high = optimization.box()
    problem = DesignProblem(optimization, threads)
    search = LimitedSearch(find_start(optimization), problem, low, high, seed=seed)
    return ChosenSearch(search, _settings_of_cma(None, seed, "limits"), 1)


def _find_method(optimization: Optimization) -> str:
    """Return the method that suits an optimization."""
    if optimization.limits_design:
        if can_have_slopes(optimization):
            return "slopes"
    elif has_slopes(optimization):
        return "slopes"
    if len(optimization.objectives) > 1 or optimization.takes_whole_numbers:
        return "evolution"
    n_numbers = len(optimization.names)
    if n_numbers >= LEAST_NUMBERS_OF_CMA and optimization.limits_design:
        return "cma-es"
    if n_numbers > MOST_NUMBERS:
        return "cma-es"
    return "evolution"


def _check_method(optimization: Optimization, method: str) -> None:
    """Reject a method that an optimization does not allow."""
    if method == "evolution":
        return
    if len(optimization.objectives) > 1:
        rule = "must be auto or evolution for a front between two objectives"
        raise BadArgument("method", f"{rule}, got {method}")
    if optimization.takes_whole_numbers:
        rule = "must be auto or evolution where numbers are counts"
        raise BadArgument("method", f"{rule}, got {method}")
    if method == "cma-es" and len(optimization.names) < LEAST_NUMBERS_OF_CMA:
        raise BadArgument("method", "must be auto or evolution for a single number, got cma-es")
    if method == "slopes" and optimization.needs_loads:
        rule = "must be auto, evolution or cma-es for what joints carry, which has no slopes"
        raise BadArgument("method", f"{rule}, got slopes")
    if method == "slopes" and not can_have_slopes(optimization):
        rule = "must be auto, evolution or cma-es unless joints are prescribed and no controller steers"
        raise BadArgument("method", f"{rule}, got slopes")


def find_start(optimization: Optimization) -> np.ndarray:
    """Return the point with which a search begins: the numbers of the scenario, as far as ranges contain them.

    Args:
        optimization: The optimization.
    """
    low, high = optimization.box()
    start = 0.5 * (low + high)
    for i, name in enumerate(optimization.names):
        try:
            start[i] = value_of(name, optimization.scenario)
        except BadArgument:  # parts differ, or the number is None: the middle remains
            continue
    within = np.clip(start, low, high)
    return optimization.points(within[np.newaxis])[0]


def _settings_of_cma(population: int | None, seed: int, search: str) -> dict[str, Any]:
    return {
        "population": population,
        "seed": seed,
        "search": search,
        "numpy": np.__version__,
        "cma": str(import_cma().__version__),
    }
