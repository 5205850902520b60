"""Optimization: the gait, fin or number of links with the best speed, power or cost, or the front between two.

A search is determined by its bounds, its seed and the figures returned to it, and a trial by its
point. Therefore only the points and their figures are stored, in one file, and none of the search's
state: a search that was stopped is replayed with the figures in the file and then continues as if
it had not been stopped, bit for bit. Nothing in the file is executed. It is written under another
name and then moved into place, so it always holds whole generations.

Two objectives: NSGA-II (Deb et al., IEEE Trans. Evol. Comput. 6, 2002), whose generations spread
over the whole front at once. One objective: differential evolution, DE/rand/1/bin (Storn and Price,
J. Global Optim. 11, 1997): it needs no derivatives and no scaling of the parameters, respects the
bounds, and its generations are batches for the kernel. Its control parameters are fixed, because
pymoo's adaptation draws from a generator that cannot be seeded.
"""

import io
import json
from collections.abc import Mapping
from contextlib import nullcontext
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from jaxtyping import Float

from laticauda import files
from laticauda.errors import BadArgument, check_whole_number, optional_import
from laticauda.simulate.runner import silent
from laticauda.studies.folder import as_stored, check_same, owned, readable, storage
from laticauda.studies.optimization import (
    VIOLATION,
    Front,
    Optimization,
    compute_losses,
    evaluate,
    pareto_front,
)
from laticauda.studies.sweep import QUANTITIES, Progress, Table

CHECKPOINT, JOB = "checkpoint.npz", "optimization"
DEFINITION, POINTS = "definition", "points"
COLUMNS = (*QUANTITIES, VIOLATION)
Columns: TypeAlias = dict[str, Any]


def _joined(before: Columns, after: Columns) -> Columns:
    return {name: np.concatenate((column, after[name])) for name, column in before.items()}


class Checkpoint:
    """All points tried so far, in the order of the search; in a folder, or in memory only.

    Args:
        definition: Everything that the points depend on.
        n_names: Number of parameters.
        folder: Folder of the file; None stores nothing.
    """

    def __init__(self, definition: Mapping[str, Any], n_names: int, folder: Path | None) -> None:
        self.definition, self.folder = definition, folder
        self.tried: Columns = {POINTS: np.empty((0, n_names))}
        """The points as requested by the search, one per row, and their results, by name."""
        self.tried |= {
            name: np.empty(0, dtype=bool if name == "succeeded" else float) for name in COLUMNS
        }

    def load(self) -> None:
        """Load the stored points, if any.

        Raises:
            ValueError: If the folder holds something else or another optimization; the message
                names the differences.
        """
        if self.folder is None or not (self.folder / CHECKPOINT).exists():
            return
        with readable(self.folder, CHECKPOINT):
            content = io.BytesIO((self.folder / CHECKPOINT).read_bytes())
            with np.load(content, allow_pickle=False) as file:
                stored: dict[str, Any] = dict(json.loads(str(file[DEFINITION])))
                tried = {name: file[name] for name in (POINTS, *COLUMNS)}
        check_same(self.folder, JOB, stored, self.definition)
        of_kind = all(
            (one.dtype, one.shape[1:], one.ndim) == (mine.dtype, mine.shape[1:], mine.ndim)
            for one, mine in zip(tried.values(), self.tried.values(), strict=True)
        )
        if not of_kind or len({len(column) for column in tried.values()}) > 1:
            raise BadArgument("folder", f"must hold an intact `{CHECKPOINT}`, got {self.folder}")
        self.tried = tried

    def add(self, fresh: Columns) -> None:
        """Add a generation, and store it.

        Args:
            fresh: Its points and their results.

        Raises:
            StorageFailed: If the file cannot be written; the previous one is kept.
        """
        before = len(self.tried[POINTS])
        self.tried = _joined(self.tried, fresh)
        if self.folder is None:
            return
        arrays: Any = {DEFINITION: np.array(json.dumps(self.definition)), **self.tried}
        with storage(self.folder, f"{before} trials are stored"):
            files.write(
                self.folder / CHECKPOINT, lambda path: np.savez(path, allow_pickle=False, **arrays)
            )


POPULATION = {1: 40, 2: 100}
"""Points in a generation, by number of objectives."""
LEAST_POPULATION = 4  # differential evolution combines four of them


class Search:
    """A seeded search with an ask-and-tell interface.

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
        core = _pymoo("core.problem")
        self._problem = core.Problem(
            n_var=low.size, n_obj=n_objectives, n_ieq_constr=1, xl=low, xu=high
        )
        self._algorithm = _algorithm(n_objectives, population)
        forever = _pymoo("core.termination").NoTermination()
        self._algorithm.setup(self._problem, termination=forever, seed=seed, verbose=False)
        self._generation: Any = None

    def ask(self) -> Table:
        """Return the next generation; no rows if the search has no new points to try."""
        self._generation = self._algorithm.ask()
        if self._generation is None or len(self._generation) == 0:
            return np.empty((0, self._problem.n_var))
        return np.array(self._generation.get("X"), dtype=float)

    def tell(
        self, losses: Float[np.ndarray, "n n_objectives"], violation: Float[np.ndarray, " n"]
    ) -> None:
        """Report the results of the points of the last generation.

        Args:
            losses: Losses (smaller is better); any finite number for infeasible points.
            violation: 0 for feasible points, otherwise how far they are from being feasible.
        """
        self._generation.set("F", losses)
        self._generation.set("G", violation[:, np.newaxis])
        for individual in self._generation:
            individual.evaluated.update(("F", "G"))
        self._algorithm.tell(infills=self._generation)


def package_versions() -> dict[str, str]:
    """Return the versions of the packages on which the search's numbers depend, besides its arguments.

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


def optimize(
    optimization: Optimization,
    folder: str | Path | None = None,
    *,
    budget: int = 4000,
    population: int | None = None,
    seed: int = 0,
    progress: Progress = silent,
    threads: int | None = None,
) -> Front:
    """Search for the best points: by NSGA-II for two objectives, by differential evolution for one.

    Every generation is one batch of `swim_many`. With a folder, every generation is stored there;
    an optimization that was stopped or killed continues from there, and ends bit-for-bit the same
    as one that was not. So does one that is called again with a larger budget.

    Args:
        optimization: What may change, and which figures are maximized or minimized.
        folder: Folder for the checkpoint; created if needed. It must be empty or hold this same
            optimization. None stores nothing.
        budget: Number of points to try.
        population: Points in a generation; None takes 100 for two objectives, 40 for one.
        seed: Seed of all random numbers; another seed takes another path.
        progress: Called at the start and after every generation with the number of points tried and
            the total.
        threads: Number of threads; None uses all cores available to this process. The result does
            not depend on it.

    Returns:
        The nondominated points of all that were tried.

    Raises:
        ValueError: If an argument is out of its range, or the folder holds something else or
            another optimization; the message names the differences.
        StorageFailed: If the checkpoint cannot be written. Nothing that was stored is lost.
        MissingExtra: If pymoo is not installed.
    """
    usual = POPULATION[len(optimization.objectives)]
    population = check_whole_number(
        "population", usual if population is None else population, LEAST_POPULATION
    )
    check_whole_number("budget", budget, population)
    check_whole_number("seed", seed, 0)
    if threads is not None:
        check_whole_number("threads", threads, 1)
    low, high = optimization.box()
    search = Search(
        low, high, n_objectives=len(optimization.objectives), population=population, seed=seed
    )
    path = None if folder is None else Path(folder)
    definition = as_stored(
        {**optimization.definition(), "population": population, "seed": seed, **package_versions()}
    )
    memory = Checkpoint(definition, len(optimization.names), path)
    with nullcontext() if path is None else owned(path, JOB, CHECKPOINT):
        memory.load()
        _search(optimization, search, memory, budget, progress, threads)
    return _front(
        optimization, {name: column[:budget] for name, column in memory.tried.items()}, seed
    )


def _search(
    optimization: Optimization,
    search: Search,
    memory: Checkpoint,
    budget: int,
    progress: Progress,
    threads: int | None,
) -> None:
    """Let the search try points until the budget is spent; remembered points are not simulated again."""
    remembered, n_done = memory.tried, 0
    progress(min(len(remembered[POINTS]), budget), budget)
    while n_done < budget:
        generation = search.ask()
        n_points = min(len(generation), budget - n_done)
        if n_points == 0:
            return
        known = {
            name: column[n_done : n_done + len(generation)] for name, column in remembered.items()
        }
        n_known = len(known[POINTS])
        if not np.array_equal(known[POINTS], generation[:n_known]):
            raise BadArgument(
                "folder",
                f"must hold a `{CHECKPOINT}` that this computer can reproduce, got {memory.folder}, from "
                f"which the search differs after {n_done} trials; it may be from another kind of computer",
            )
        new = generation[n_known:n_points]
        if len(new):
            fresh = {POINTS: new, **evaluate(optimization, optimization.points(new), threads)}
            memory.add(fresh)
            known = _joined(known, fresh)
            progress(len(memory.tried[POINTS]), budget)
        n_done += n_points
        if n_done < budget:
            search.tell(compute_losses(optimization.objectives, known), known[VIOLATION])


def _front(optimization: Optimization, tried: Columns, seed: int) -> Front:
    feasible = tried[VIOLATION] == 0.0
    values = compute_losses(optimization.objectives, tried)
    best = np.flatnonzero(feasible)[pareto_front(values[feasible])]
    best = best[np.argsort(tried[optimization.objectives[-1]][best], kind="stable")]
    return Front(
        optimization=optimization,
        values=optimization.points(tried[POINTS])[best],
        figures={name: tried[name][best] for name in QUANTITIES},
        n_trials=len(feasible),
        n_infeasible=int(np.sum(~feasible)),
        seed=seed,
    )
