"""What does a trial cost in a batch, against the same trial alone, and how does the batch scale with threads?

Question: 30 s of a robot of ten links, random gaits, default steps, everything that `swim_many` does included. Printed:
time of one core per trial, the ratio to `swim`, and the gain of a second thread.

Last answer (2026-11-21, a processor with AVX-512):
    joints       swim [ms]  batch [ms]  ratio  two threads
    prescribed        1.47       0.277    5.3         1.86
    pd               12.79       2.446    5.2         1.96
    servo            17.98       2.892    6.2         1.89
"""

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

import laticauda as lc

TRIALS = {"prescribed": 1600, "pd": 160, "servo": 160}
REPEATS = 10


def fastest(clock: Callable[[], float], work: Callable[[], object]) -> float:
    """Least time of a few repetitions [s]."""
    times: list[float] = []
    for _ in range(REPEATS):
        start = clock()
        work()
        times.append(clock() - start)
    return min(times)


def main() -> None:
    """Print the table."""
    mamba = lc.load_robot("mamba")
    robot = replace(mamba, modules=mamba.modules[:1] * 10, joints=mamba.joints[:1] * 9)
    rng = np.random.default_rng(1)
    print(f"{'joints':<12}{'swim [ms]':>10}{'batch [ms]':>12}{'ratio':>7}{'two threads':>13}")
    for joints, n in TRIALS.items():
        gaits = [
            lc.lateral_undulation(
                amplitude=rng.uniform(0.2, 0.7), frequency=rng.uniform(1.0, 3.0), phase_shift=rng.uniform(0.3, 1.0)
            )
            for _ in range(n)
        ]

        def batch(threads: int, gaits: list[lc.Gait] = gaits, joints: str = joints) -> None:
            lc.swim_many(robot, gaits, joints=joints, threads=threads)

        def alone(gait: lc.Gait = gaits[0], joints: str = joints) -> None:
            lc.swim(robot, gait, joints=joints)

        batch(1)
        alone()
        single = fastest(time.process_time, alone)
        each = fastest(time.process_time, lambda: batch(1)) / n
        gain = fastest(time.perf_counter, lambda: batch(1)) / fastest(time.perf_counter, lambda: batch(2))
        print(f"{joints:<12}{1e3 * single:>10.2f}{1e3 * each:>12.3f}{single / each:>7.1f}{gain:>13.2f}")


if __name__ == "__main__":
    main()
