"""How does a batch scale with threads?

Question: 30 s of a robot of ten links, random gaits; wall time with one thread over that with more,
up to all cores. Printed: the gain; it needs a quiet machine.
"""

import time

from _timing import fastest, of_links, print_load, random_gaits

import laticauda as lc
from laticauda.models.dynamics.school import usable_cores

TRIALS = {"prescribed": 3200, "pd": 320}


def main() -> None:
    """Print the table."""
    robot, cores = of_links(10), usable_cores()
    counts = sorted({1, 2, *(2**k for k in range(2, 8) if 2**k <= cores), cores})
    print(f"{'joints':<12}" + "".join(f"{n:>4} threads" for n in counts))
    for joints, n in TRIALS.items():
        gaits = random_gaits(n)
        walls = [
            fastest(
                time.perf_counter,
                lambda g=gaits, j=joints, k=k: lc.swim_many(robot, g, joints=j, threads=k),
                12,
            )
            for k in counts
        ]
        print(f"{joints:<12}" + "".join(f"{walls[0] / wall:>12.2f}" for wall in walls))
    print_load()


if __name__ == "__main__":
    main()
