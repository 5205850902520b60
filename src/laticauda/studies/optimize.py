"""Optimization: the gait, fin or number of links with the best speed, power or cost, or the front between two."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path

import numpy as np

from laticauda.errors import BadArgument, instance, whole
from laticauda.studies.checkpoint import CHECKPOINT, JOB, Checkpoint
from laticauda.studies.folder import as_stored, owned
from laticauda.studies.front import Front, unbeaten
from laticauda.studies.optimization import VIOLATION, Optimization, evaluate, losses
from laticauda.studies.progress import Progress, silent
from laticauda.studies.search import LEAST_POPULATION, POPULATION, Search, versions
from laticauda.studies.trials import Column, Table

BUDGET = 4000


def optimize(
    optimization: Optimization,
    folder: str | Path | None = None,
    *,
    budget: int = BUDGET,
    population: int | None = None,
    seed: int = 0,
    progress: Progress | None = None,
    threads: int | None = None,
) -> Front:
    """Search for the best points: by NSGA-II for two objectives, by differential evolution for one.

    Every generation is a batch of `swim_many`. With a folder, every generation is stored there; an optimization that
    was stopped or killed goes on from there, and ends with the same bits as one that was not. So does one that is
    called again with a greater budget.

    Args:
        optimization: What may change, and what is to be great or small.
        folder: Where the checkpoint goes; made if need be. It must be empty, or hold this very optimization. None
            keeps nothing.
        budget: How many points to try.
        population: Points in a generation; None takes 100 for two objectives, 40 for one.
        seed: Of everything random; another one takes another way.
        progress: Called at the start and after every generation with the number of points tried, and of all.
        threads: See `laticauda.simulate.swim_many`; the result does not depend on it.

    Returns:
        The points that no other one beats, of all that were tried.

    Raises:
        ValueError: If an argument is out of its range, or the folder holds something else, or another optimization: the
            message names what differs.
        StorageFailed: If the checkpoint cannot be written. Nothing that was stored is lost.
        MissingExtra: If pymoo is not installed.
    """
    instance("optimization", optimization, Optimization)
    population = whole(
        "population", POPULATION[len(optimization.objectives)] if population is None else population, LEAST_POPULATION
    )
    whole("budget", budget, population)
    whole("seed", seed, 0)
    if threads is not None:
        whole("threads", threads, 1)
    low, high = optimization.box()
    search = Search(low, high, n_objectives=len(optimization.objectives), population=population, seed=seed)
    path = None if folder is None else Path(folder)
    definition = as_stored({**optimization.definition(), "population": population, "seed": seed, **versions()})
    memory = Checkpoint(definition=definition, n_names=len(optimization.names), folder=path)
    with nullcontext() if path is None else owned(path, JOB, CHECKPOINT):
        memory.load()
        _search(optimization, search, memory, budget, progress or silent, threads)
    sought, found = memory.first(budget)
    return _front(optimization, optimization.points(sought), found, seed)


def _search(
    optimization: Optimization, search: Search, memory: Checkpoint, budget: int, progress: Progress, threads: int | None
) -> None:
    """Let the search try points until the budget is spent; those that are remembered do not swim again."""
    remembered, figures_before = memory.points, memory.found
    n_done = 0
    progress(min(len(remembered), budget), budget)
    while n_done < budget:
        generation = search.ask()
        n_points = min(len(generation), budget - n_done)
        if n_points == 0:
            return
        stop = n_done + len(generation)
        known, figures = remembered[n_done:stop], {name: column[n_done:stop] for name, column in figures_before.items()}
        if not np.array_equal(known, generation[: len(known)]):
            raise BadArgument(
                "folder",
                f"must hold a `{CHECKPOINT}` that this computer can repeat, got {memory.folder}, where the "
                f"search went another way after {n_done} trials; it may be from another kind of computer",
            )
        new = generation[len(known) : n_points]
        if len(new):
            fresh = evaluate(optimization, optimization.points(new), threads)
            memory.add(new, fresh)
            figures = {name: np.concatenate((column, fresh[name])) for name, column in figures.items()}
            progress(len(memory.points), budget)
        n_done += n_points
        if n_done < budget:
            search.tell(losses(optimization.objectives, figures), figures[VIOLATION])


def _front(optimization: Optimization, table: Table, found: dict[str, Column], seed: int) -> Front:
    feasible = found[VIOLATION] == 0.0
    values = losses(optimization.objectives, found)
    best = np.flatnonzero(feasible)[unbeaten(values[feasible])]
    best = best[np.argsort(found[optimization.objectives[-1]][best], kind="stable")]
    return Front(
        optimization=optimization,
        values=table[best],
        figures={name: column[best] for name, column in found.items() if name != VIOLATION},
        n_trials=len(table),
        n_infeasible=int(np.sum(~feasible)),
        seed=seed,
    )
