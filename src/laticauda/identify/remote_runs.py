"""Runs of measurements on the workers of a Dask cluster, piece by piece, to the bits of this process."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import chain
from typing import NamedTuple

import numpy as np

from laticauda.identify import planar_runs, spatial_runs
from laticauda.identify.planar_runs import Pair
from laticauda.identify.problem import Problem
from laticauda.identify.runs import Point, SimulatedRuns, swimming
from laticauda.models.simulate import cluster
from laticauda.scenarios import Planar

N_LANES = 8
"""Runs that the planar model computes in about the time of one."""
HINT = "An identification cannot be resumed: run the same again, with or without a cluster."
"""What is left of an identification when its cluster fails."""


class _Piece(NamedTuple):
    """Some measurements at one point of the search."""

    point: int
    """Index of the point."""
    members: list[int]
    """Indices of the measurements."""


def simulate(points: Sequence[Point], runs_of_points: Sequence[SimulatedRuns]) -> None:
    """Simulate every measurement in which the robot swam, at several points at once.

    Args:
        points: The points.
        runs_of_points: Results of each point to fill in.
    """
    pieces: list[_Piece] = []
    for index, point in enumerate(points):
        for members in _split_measurements(point.problem):
            pieces.append(_Piece(point=index, members=members))
    calls = [(_part_of(points[piece.point], piece.members),) for piece in pieces]
    client = points[0].problem.client
    runs_of_pieces = cluster.map_on(client, simulate_part, calls, HINT)
    for piece, runs_of_piece in zip(pieces, runs_of_pieces, strict=True):
        runs = runs_of_points[piece.point]
        runs.failures.update(runs_of_piece.failures)
        for i, results in zip(piece.members, runs_of_piece.results, strict=True):
            runs.results[i] = results


def differentiate_runs(point: Point, jacobian: np.ndarray) -> None:
    """Fill in the derivatives of the planar model's runs (see `planar_runs.differentiate_runs`).

    Args:
        point: Measurements, unknowns, and the values of these.
        jacobian: Jacobian to fill in.
    """
    problem = point.problem
    pairs = planar_runs.pairs_to_differentiate(problem)
    pairs.sort(key=lambda pair: _duration(problem, pair.measurement))
    calls: list[tuple[Point, list[Pair]]] = []
    for indices in _split_into_lanes(range(len(pairs)), problem):
        pairs_of_piece = [pairs[index] for index in indices]
        members = sorted({pair.measurement for pair in pairs_of_piece})
        renumbered = [
            Pair(measurement=members.index(pair.measurement), unknown=pair.unknown)
            for pair in pairs_of_piece
        ]
        calls.append((_part_of(point, members), renumbered))
    slopes_of_pieces = cluster.map_on(problem.client, differentiate_part, calls, HINT)
    slopes = list(chain.from_iterable(slopes_of_pieces))
    planar_runs.fill_in_slopes(problem, pairs, slopes, jacobian)


def simulate_part(part: Point) -> SimulatedRuns:
    """Simulate measurements; called on a worker.

    Args:
        part: The measurements, in all of which the robot swam, and the values of the unknowns.
    """
    runs = SimulatedRuns.of_problem(part.problem)
    if isinstance(part.problem.model, Planar):
        planar_runs.simulate(part.problem, part.scenarios, runs)
    else:
        spatial_runs.simulate(part.problem, part.scenarios, runs)
    return runs


def differentiate_part(part: Point, pairs: Sequence[Pair]) -> list[np.ndarray]:
    """Differentiate runs of the planar model; called on a worker.

    Args:
        part: Measurements, unknowns, and the values of these.
        pairs: Which runs, with respect to what.
    """
    return planar_runs.differentiate_pairs(part.problem, part.scenarios, part.values, pairs)


def _part_of(point: Point, members: Sequence[int]) -> Point:
    """Return some measurements for a worker, which runs as many tasks as it has threads."""
    part = replace(point.problem.part(members), client=None, threads=1)
    return Point(problem=part, values=point.values)


def _split_measurements(problem: Problem) -> list[list[int]]:
    """Return the measurements of each piece: one alone for the 3D twin, else those of full lanes."""
    members = swimming(problem)
    if not isinstance(problem.model, Planar):
        return [[i] for i in members]
    members.sort(key=lambda i: _duration(problem, i))
    return _split_into_lanes(members, problem)


def _split_into_lanes(members: Sequence[int], problem: Problem) -> list[list[int]]:
    """Split runs into a piece for each thread of the cluster, none smaller than the lanes."""
    n_threads = cluster.count_threads(problem.client, HINT)
    n_pieces = min(n_threads, -(-len(members) // N_LANES))
    pieces = np.array_split(np.array(members, dtype=int), max(n_pieces, 1))
    return [piece.tolist() for piece in pieces if piece.size]


def _duration(problem: Problem, i: int) -> float:
    return problem.scenarios[i].duration
