"""What a sweep of short trials costs beside the kernels.

Question: 5 s of Mamba with random amplitudes and frequencies: how many times the processor time of the
kernel alone do the figures of a sweep take, and `swim_many` with an object for every trial?

Method: the kernel alone is called on the same rows, with the same log, and nothing is done with the
results. Least processor time of a few rounds, in turns in one process, on one thread, so that only
ratios matter. With `--sweep N`, a whole sweep of N trials is run in a folder, too, and its memory is
printed; with `--threads N`, trials of 30 s are timed by the clock on one thread and on N.

    python benchmarks/columns.py [--sweep 100000] [--threads 2]
"""

import argparse
import resource
import tempfile
import time

import numpy as np
from _timing import fastest, random_gaits

import laticauda as lc
from laticauda.models.planar import COMMAND, FILTERED_COMMAND, WIDTH, aligned
from laticauda.models.simulate import make_run_table
from laticauda.studies import Grid, Sweep, run_sweep
from laticauda.studies.point_trials import swim_points

N_TRIALS = 6400
ROUNDS = 4
SAMPLES = 100
NAMES = ("gait.amplitude", "gait.frequency")
GAITS = random_gaits(N_TRIALS)
POINTS = np.array([[gait.amplitude, gait.frequency] for gait in GAITS])


def main() -> None:
    """Print the ratios."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--sweep", type=int, default=0, help="trials of a whole sweep")
    parser.add_argument("--threads", type=int, default=0, help="threads to compare with one")
    settings = parser.parse_args()
    scenario = lc.build_scenario("mamba", GAITS[0], 5.0)
    kernel_time = compare_with_kernel(scenario)
    if settings.threads:
        compare_threads(settings.threads)
    if settings.sweep:
        run_whole_sweep(scenario, settings.sweep, kernel_time)


def compare_with_kernel(scenario: lc.Scenario) -> float:
    """Print what trials cost beside the kernel, and return the kernel's own time for all of them [s]."""
    table = make_run_table(scenario, dict(zip(NAMES, POINTS.T, strict=True)))
    plant = table.bases[0].plant
    march = plant.kernels_of(WIDTH).run
    rows_of_base = np.repeat(table.bases[0].rows[:, np.newaxis], WIDTH, axis=1)
    lanes = aligned(rows_of_base.shape, float)
    log = aligned((1 + SAMPLES, plant.layout.sample_size, WIDTH), float)

    def call_kernel() -> None:
        for first in range(0, N_TRIALS, WIDTH):
            waves = table.waves[:, first : first + WIDTH]
            lanes[:] = rows_of_base
            lanes[COMMAND] = waves
            lanes[FILTERED_COMMAND] = waves[: len(FILTERED_COMMAND)]
            march(lanes, *plant.layout.chain, plant.is_implicit, SAMPLES, 0.05, 1, log)

    works = {
        "kernel alone": call_kernel,
        "figures of a sweep": lambda: swim_points(scenario, NAMES, POINTS, 1),
        "swim_many with objects": lambda: lc.swim_many("mamba", GAITS, 5.0, threads=1),
    }
    times = {name: fastest(time.process_time, work, ROUNDS) for name, work in works.items()}
    kernel_time = times["kernel alone"]
    for name, seconds in times.items():
        print(describe(name, seconds, N_TRIALS, kernel_time))
    return kernel_time


def describe(name: str, seconds: float, n_trials: int, kernel_time: float) -> str:
    """Return what trials cost, beside the kernel's time for `N_TRIALS` of them [s]."""
    per_trial = seconds / n_trials
    ratio = per_trial / (kernel_time / N_TRIALS)
    return f"{name:24} {1e6 * per_trial:7.1f} us a trial, {ratio:.2f} times the kernel"


def compare_threads(n_threads: int) -> None:
    """Print how much sooner, by the clock, several threads are done with trials of 30 s; needs an idle machine."""
    scenario = lc.build_scenario("mamba", GAITS[0], 30.0)
    works = {
        "figures of a sweep": lambda threads: swim_points(scenario, NAMES, POINTS, threads),
        "swim_many with objects": lambda threads: lc.swim_many(
            "mamba", GAITS, 30.0, threads=threads
        ),
    }
    for name, work in works.items():
        alone = fastest(time.perf_counter, lambda work=work: work(1), ROUNDS)
        together = fastest(time.perf_counter, lambda work=work: work(n_threads), ROUNDS)
        print(f"{name:24} {alone / together:.2f} times as fast on {n_threads} threads")


def run_whole_sweep(scenario: lc.Scenario, n_swept: int, kernel_time: float) -> None:
    """Print what a whole sweep costs, and how much memory it takes."""
    side = round(n_swept**0.5)
    grid = {
        "gait.amplitude": np.linspace(0.2, 0.7, side),
        "gait.frequency": np.linspace(1.0, 3.0, side),
    }
    sweep = Sweep(scenario=scenario, points=Grid(values=grid))
    few = Sweep(
        scenario=scenario,
        points=Grid(values={name: values[:4] for name, values in grid.items()}),
    )
    with tempfile.TemporaryDirectory() as folder:
        run_sweep(few, folder, threads=1)  # imports what stores results
    memory_before = peak_memory()
    with tempfile.TemporaryDirectory() as folder:
        start = time.process_time()
        run_sweep(sweep, folder, threads=1)
        seconds = time.process_time() - start
    print(describe(f"sweep of {sweep.n_trials}", seconds, sweep.n_trials, kernel_time))
    print(f"peak {peak_memory():.0f} MB, {memory_before:.0f} MB before it")


def peak_memory() -> float:
    """Return the most memory that this process has had [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


if __name__ == "__main__":
    main()
