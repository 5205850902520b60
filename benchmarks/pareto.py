"""Is the search for the Pareto front of speed against power worth more than ten times as many random points?

Question: does `optimize` find the fronts of both of the paper's gaits in under 2 minutes on 2
cores, and is their hypervolume at least that of random search with ten times the budget, for 5
seeds? Amplitude, frequency and phase shift are free within 10 to 50 deg, 50 to 150 deg/s and 10 to
60 deg. The hypervolume is the area that a front beats between standstill and the greatest power on
any of a gait's fronts; all points that were tried count, on both sides.

    python benchmarks/pareto.py

Last answer (2 shared cores, AMD EPYC, 2026-11-21):
    gait                 seed   NSGA-II    random      10 x    ratio  time [s]
                                            equal    random            NSGA-II    random
    lateral_undulation      1    8.4485    8.2989    8.4087   1.0047       3.7      19.2
    lateral_undulation      2    8.4486    8.3368    8.4117   1.0044       3.0      22.8
    lateral_undulation      3    8.4488    8.3673    8.4189   1.0035       4.2      24.5
    lateral_undulation      4    8.4483    8.2846    8.4110   1.0044       2.9      19.1
    lateral_undulation      5    8.4472    8.2524    8.4088   1.0046       3.7      24.8
    eel_like                1    4.3418    4.1643    4.2873   1.0127       3.5      20.2
    eel_like                2    4.3414    4.2228    4.2937   1.0111       3.9      19.0
    eel_like                3    4.3419    4.1721    4.2905   1.0120       1.9      14.7
    eel_like                4    4.3413    4.1976    4.2960   1.0105       1.5      12.8
    eel_like                5    4.3405    4.2044    4.3032   1.0087       1.6       9.6
    both fronts in 8.0 s; least ratio 1.0035, mean 1.0077
"""

import argparse
import time
from dataclasses import dataclass
from math import radians

import numpy as np
from pymoo.indicators.hv import HV

import laticauda as lc
from laticauda.motion.gaits import envelope_of
from laticauda.studies import Optimization, optimize
from laticauda.studies.optimization import compute_losses, evaluate

SEEDS = range(1, 6)
TIMES = 10
BOUNDS = {
    "gait.amplitude": (radians(10), radians(50)),
    "gait.frequency": (radians(50), radians(150)),
    "gait.phase_shift": (radians(10), radians(60)),
}


def random_search(optimization: Optimization, budget: int, seed: int) -> np.ndarray:
    """Losses of points that are even in the box."""
    low, high = optimization.box()
    table = optimization.points(np.random.default_rng(seed).uniform(low, high, (budget, low.size)))
    return compute_losses(optimization.objectives, evaluate(optimization, table))


@dataclass(frozen=True, kw_only=True)
class Search:
    """What both kinds of search found with one seed."""

    seed: int
    losses: np.ndarray
    """Losses on the front of NSGA-II, one row per point."""
    seconds: float
    """Duration of NSGA-II [s]."""
    random_losses: np.ndarray
    """Losses of all points of random search."""
    random_seconds: float
    """Duration of random search [s]."""


def search_both_ways(optimization: Optimization, budget: int, seed: int) -> Search:
    start = time.perf_counter()
    front = optimize(optimization, budget=budget, seed=seed)
    middle = time.perf_counter()
    random_losses = random_search(optimization, TIMES * budget, seed)
    end = time.perf_counter()
    return Search(
        seed=seed,
        losses=compute_losses(optimization.objectives, front.figures),
        seconds=middle - start,
        random_losses=random_losses,
        random_seconds=end - middle,
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--budget", type=int, default=4000)
    budget = parser.parse_args().budget
    robot = lc.load_robot("mamba")
    print(
        f"{'gait':<20}{'seed':>5}{'NSGA-II':>10}{'random':>10}{f'{TIMES} x':>10}{'ratio':>9}{'time [s]':>10}{'':>10}"
    )
    print(f"{'':<20}{'':>5}{'':>10}{'equal':>10}{'random':>10}{'':>9}{'NSGA-II':>10}{'random':>10}")
    ratios: list[float] = []
    longest: dict[str, float] = {}
    for kind in ("lateral_undulation", "eel_like"):
        gait = lc.Gait(envelope=envelope_of(kind), amplitude=0.5, frequency=2.0, phase_shift=0.7)
        optimization = Optimization(scenario=lc.build_scenario(robot, gait), bounds=BOUNDS)
        evaluate(optimization, np.array([[0.5, 2.0, 0.7]]))  # warm
        searches = [search_both_ways(optimization, budget, seed) for seed in SEEDS]
        greatest_power = max(float(search.losses[:, 1].max()) for search in searches)
        area = HV(ref_point=np.array((0.0, greatest_power)))
        longest[kind] = max(search.seconds for search in searches)
        for search in searches:
            area_of_front = float(area(search.losses))
            area_of_as_many = float(area(search.random_losses[:budget]))
            area_of_random = float(area(search.random_losses))
            ratio = area_of_front / area_of_random
            ratios.append(ratio)
            print(
                f"{kind:<20}{search.seed:>5}{area_of_front:>10.4f}{area_of_as_many:>10.4f}"
                f"{area_of_random:>10.4f}{ratio:>9.4f}"
                f"{search.seconds:>10.1f}{search.random_seconds:>10.1f}"
            )
    print(
        f"both fronts in {sum(longest.values()):.1f} s; "
        f"least ratio {min(ratios):.4f}, mean {np.mean(ratios):.4f}"
    )


if __name__ == "__main__":
    main()
