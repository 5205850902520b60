"""How does a batch scale with threads?

Question: 30 s of a robot of ten links, random gaits; wall time with one thread over that with more,
up to all cores. Printed: the gain; it needs a quiet machine.
"""

import time
from functools import partial

from _timing import fastest, of_links, print_load, random_gaits

import laticauda as lc
from laticauda.models.dynamics.school import usable_cores

TRIALS = {"prescribed": 3200, "pd": 320}


def main() -> None:
    """Print the table."""
    robot = of_links(10)
    cores = usable_cores()
    powers_of_two = {count for count in (4, 8, 16, 32, 64, 128) if count <= cores}
    counts = sorted({1, 2, cores} | powers_of_two)
    print(f"{'joints':<12}" + "".join(f"{n:>4} threads" for n in counts))
    for joints, n in TRIALS.items():
        gaits = random_gaits(n)
        walls: list[float] = []
        for n_threads in counts:
            swim = partial(lc.swim_many, robot, gaits, joints=joints, threads=n_threads)
            walls.append(fastest(time.perf_counter, swim, 12))
        print(f"{joints:<12}" + "".join(f"{walls[0] / wall:>12.2f}" for wall in walls))
    print_load()


if __name__ == "__main__":
    main()
