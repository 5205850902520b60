"""Is the search for the Pareto front of speed against power worth more than ten times as many random points?

Question: does `optimize` find the fronts of both of the paper's gaits in under 2 minutes on 2 cores, and is their
hypervolume at least that of random search with ten times the budget, for 5 seeds? Amplitude, frequency and phase shift
are free within 10 to 50 deg, 50 to 150 deg/s and 10 to 60 deg. The hypervolume is the area that a front beats between
standstill and the greatest power on any of a gait's fronts; all points that were tried count, on both sides.

    python benchmarks/pareto.py

Last answer:
"""

import argparse
import time
from math import radians

import numpy as np

import laticauda as lc
from laticauda.studies import Problem, hypervolume, optimize
from laticauda.studies.problem import evaluate, losses

SEEDS = range(1, 6)
TIMES = 10
BOUNDS = {
    "gait.amplitude": (radians(10), radians(50)),
    "gait.frequency": (radians(50), radians(150)),
    "gait.phase_shift": (radians(10), radians(60)),
}


def random_search(problem: Problem, budget: int, seed: int) -> np.ndarray:
    """Losses of points that are even in the box."""
    low, high = problem.box()
    table = problem.points(np.random.default_rng(seed).uniform(low, high, (budget, low.size)))
    return losses(problem.objectives, evaluate(problem, table))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--budget", type=int, default=4000)
    budget = parser.parse_args().budget
    robot = lc.load_robot("mamba")
    print(f"{'gait':<20}{'seed':>5}{'NSGA-II':>10}{'random':>10}{f'{TIMES} x':>10}{'ratio':>9}{'time [s]':>10}{'':>10}")
    print(f"{'':<20}{'':>5}{'':>10}{'equal':>10}{'random':>10}{'':>9}{'NSGA-II':>10}{'random':>10}")
    ratios, taken = [], {}
    for kind in ("lateral_undulation", "eel_like"):
        gait = lc.Gait(kind=kind, amplitude=0.5, frequency=2.0, phase_shift=0.7)
        problem = Problem(robot=robot, gait=gait, bounds=BOUNDS)
        evaluate(problem, np.array([[0.5, 2.0, 0.7]]))  # warm
        runs = []
        for seed in SEEDS:
            start = time.perf_counter()
            front = optimize(problem, budget=budget, seed=seed)
            middle = time.perf_counter()
            by_chance = random_search(problem, TIMES * budget, seed)
            end = time.perf_counter()
            runs.append((seed, losses(problem.objectives, front.figures), by_chance, middle - start, end - middle))
        reference = (0.0, max(float(found[:, 1].max()) for _, found, *_ in runs))
        for seed, found, by_chance, *times in runs:
            sought, equal, many = (hypervolume(x, reference) for x in (found, by_chance[:budget], by_chance))
            ratios.append(sought / many)
            taken[kind] = max(taken.get(kind, 0.0), times[0])
            print(
                f"{kind:<20}{seed:>5}{sought:>10.4f}{equal:>10.4f}{many:>10.4f}{sought / many:>9.4f}"
                f"{times[0]:>10.1f}{times[1]:>10.1f}"
            )
    print(f"both fronts in {sum(taken.values()):.1f} s; least ratio {min(ratios):.4f}, mean {np.mean(ratios):.4f}")


if __name__ == "__main__":
    main()
