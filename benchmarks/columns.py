"""What a sweep of short trials costs beside the kernels.

Question: 5 s of Mamba with random amplitudes and frequencies: how many times the processor time of the
kernel alone do the figures of a sweep take, and `swim_many` with an object for every trial?

Method: the kernel alone is called on the same rows, with the same log, and nothing is done with the
results. Least processor time of a few rounds, in turns in one process, on one thread, so that only
ratios matter. With `--sweep N`, a whole sweep of N trials is run in a folder, too, and its memory is
printed.

    python benchmarks/columns.py [--sweep 100000]
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


def main() -> None:
    """Print the ratios."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--sweep", type=int, default=0)
    n_swept = parser.parse_args().sweep
    gaits = random_gaits(N_TRIALS)
    scenario = lc.build_scenario("mamba", gaits[0], 5.0)
    points = np.array([[gait.amplitude, gait.frequency] for gait in gaits])
    table = make_run_table(scenario, dict(zip(NAMES, points.T, strict=True)))
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
        "figures of a sweep": lambda: swim_points(scenario, NAMES, points, 1),
        "swim_many with objects": lambda: lc.swim_many("mamba", gaits, 5.0, threads=1),
    }
    times = {name: fastest(time.process_time, work, ROUNDS) for name, work in works.items()}
    for name, seconds in times.items():
        ratio = seconds / times["kernel alone"]
        print(f"{name:24} {1e6 * seconds / N_TRIALS:7.1f} us a trial, {ratio:.2f} times the kernel")
    if n_swept:
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
        memory_before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        with tempfile.TemporaryDirectory() as folder:
            start = time.process_time()
            run_sweep(sweep, folder, threads=1)
            seconds = time.process_time() - start
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        per_trial = seconds / sweep.n_trials
        ratio = per_trial / (times["kernel alone"] / N_TRIALS)
        print(
            f"sweep of {sweep.n_trials} trials:   {1e6 * per_trial:7.1f} us a trial, {ratio:.2f} times the kernel; "
            f"peak {peak:.0f} MB, {memory_before:.0f} MB before it"
        )


if __name__ == "__main__":
    main()
