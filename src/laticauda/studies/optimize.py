"""Optimization: the gait, fin or number of links with the best speed, power or cost, or the front between two.

`search` says which points to try, `optimization` evaluates them, `checkpoint` remembers them, and
`front` holds the best of them.
"""

from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.models.simulate import silent
from laticauda.studies.checkpoint import (
    CHECKPOINT,
    JOB,
    POINTS,
    Checkpoint,
    Columns,
    join_columns,
)
from laticauda.studies.choosing import Method, choose_search
from laticauda.studies.folder import as_stored, owned
from laticauda.studies.front import Front, pareto_front
from laticauda.studies.optimization import VIOLATION, Optimization, compute_losses, evaluate
from laticauda.studies.point_search import PointSearch
from laticauda.studies.point_trials import Progress
from laticauda.studies.refusals import count_refusals
from laticauda.values import BadArgument, check_whole_number


def optimize(
    optimization: Optimization,
    folder: str | Path | None = None,
    *,
    budget: int = 4000,
    population: int | None = None,
    method: Method = "auto",
    seed: int = 0,
    progress: Progress = silent,
    client: Any = None,
    threads: int | None = None,
) -> Front:
    """Search for the best points: by NSGA-II for two objectives, by differential evolution for one.

    For one objective and more than ten numbers, with prescribed joints, the search also follows the
    objective's slopes from the best point, see `laticauda.studies.slope_search`; otherwise so many
    numbers are searched by CMA-ES. With limits of a design (`DesignLimits`) it begins at the
    scenario's own numbers and follows the slopes of objective and limits, see
    `laticauda.studies.limited_search`, or CMA-ES where joints are not prescribed or what they carry is
    limited.

    Every generation is one batch of `swim_many`. With a folder, every generation is stored there;
    an optimization that was stopped or killed continues from there, and ends bit-for-bit the same
    as one that was not. So does one that is called again with a larger budget.

    Args:
        optimization: What may change, and which figures are maximized or minimized.
        folder: Folder for the checkpoint; created if needed. It must be empty or hold this same
            optimization. None stores nothing.
        budget: Number of points to try; with limits of a design, trials for slopes count, too.
        population: Points in a generation; None takes 100 for two objectives, 40 for one, and 4 + 3
            ln n for n numbers by CMA-ES.
        method: `evolution`, `cma-es`, `slopes`, or `auto`: slopes where there are some.
        seed: Seed of all random numbers; another seed takes another path.
        progress: Called at the start and after every generation with the number of points tried and
            the total.
        client: A `dask.distributed.Client`: the trials run on its cluster, to the same bits (on
            processors of one kind). None runs them in this process.
        threads: Number of threads in this process; None uses all cores available to it. A cluster
            uses every thread of a worker. The result does not depend on either.

    Returns:
        The nondominated points of all that were tried.

    Raises:
        ValueError: If an argument is out of its range, or the folder holds something else or
            another optimization; the message names the differences.
        StorageFailed: If the checkpoint cannot be written. Nothing that was stored is lost.
        ClusterFailed: If the cluster's scheduler goes away, or workers die repeatedly. Nothing that
            was stored is lost.
        MissingExtra: If pymoo is not installed.
    """
    check_whole_number("seed", seed, 0)
    if threads is not None:
        check_whole_number("threads", threads, 1)
    choice = choose_search(optimization, method, population=population, seed=seed, threads=threads)
    check_whole_number("budget", budget, choice.least_budget)
    search = choice.search
    path = None if folder is None else Path(folder)
    definition = as_stored({**optimization.definition(), **choice.settings})
    checkpoint = Checkpoint(
        definition, len(optimization.names), path, quantities=optimization.quantities
    )
    with nullcontext() if path is None else owned(path, JOB, CHECKPOINT):
        checkpoint.load()
        _search(optimization, search, checkpoint, budget, progress, threads, client)
    tried = {name: column[:budget] for name, column in checkpoint.tried.items()}
    return _front_of(optimization, tried, seed, search.n_slope_trials)


def _search(
    optimization: Optimization,
    search: PointSearch,
    checkpoint: Checkpoint,
    budget: int,
    progress: Progress,
    threads: int | None,
    client: Any,
) -> None:
    """Let the search try points until the budget is spent; remembered points are not simulated again."""
    remembered = checkpoint.tried
    n_done = 0
    progress(min(len(remembered[POINTS]), budget), budget)
    while n_done < budget:
        generation = search.ask()
        n_points = min(len(generation), budget - n_done - search.n_slope_trials)
        if n_points <= 0:
            return
        end = n_done + len(generation)
        results = {name: column[n_done:end] for name, column in remembered.items()}
        n_remembered = len(results[POINTS])
        if not np.array_equal(results[POINTS], generation[:n_remembered]):
            raise BadArgument(
                "folder",
                f"must hold a `{CHECKPOINT}` that this computer can reproduce, got "
                f"{checkpoint.folder}, from which the search differs after {n_done} trials; "
                "it may be from another kind of computer",
            )
        new_points = generation[n_remembered:n_points]
        if len(new_points):
            figures = evaluate(optimization, optimization.points(new_points), threads, client)
            new_results = {POINTS: new_points, **figures}
            checkpoint.add(new_results)
            results = join_columns(results, new_results)
            progress(len(checkpoint.tried[POINTS]), budget)
        n_done += n_points
        if n_points < len(generation):
            return
        if n_done < budget:
            losses = compute_losses(optimization.objectives, results)
            search.tell(losses, results[VIOLATION])


def _front_of(optimization: Optimization, tried: Columns, seed: int, n_slope_trials: int) -> Front:
    """Return the nondominated points of all that were tried, by the last objective."""
    feasible = tried[VIOLATION] == 0.0
    losses = compute_losses(optimization.objectives, tried)
    best = np.flatnonzero(feasible)[pareto_front(losses[feasible])]
    order = np.argsort(tried[optimization.objectives[-1]][best], kind="stable")
    best = best[order]
    return Front(
        optimization=optimization,
        values=optimization.points(tried[POINTS])[best],
        figures={name: tried[name][best] for name in optimization.quantities},
        n_trials=len(feasible),
        n_infeasible=int(np.sum(~feasible)),
        seed=seed,
        refusals=count_refusals(optimization, optimization.points(tried[POINTS]), tried),
        n_slope_trials=n_slope_trials,
    )
