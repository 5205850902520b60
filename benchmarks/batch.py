"""What does a trial cost in a batch, against the same trial alone?

Question: 30 s of a robot of ten links, random gaits, default steps, everything that `swim_many`
does included. Printed: time of one core per trial, and the ratio to `swim`.
"""

import time

from _timing import fastest, of_links, print_load, random_gaits

import laticauda as lc

TRIALS = {"prescribed": 1600, "pd": 160, "servo": 160}


def main() -> None:
    """Print the table."""
    robot = of_links(10)
    print(f"{'joints':<12}{'swim [ms]':>10}{'batch [ms]':>12}{'ratio':>7}")
    for joints, n in TRIALS.items():
        gaits = random_gaits(n)
        single = fastest(
            time.process_time, lambda g=gaits[0], j=joints: lc.swim(robot, g, joints=j), 10
        )
        each = (
            fastest(
                time.process_time,
                lambda g=gaits, j=joints: lc.swim_many(robot, g, joints=j, threads=1),
            )
            / n
        )
        print(f"{joints:<12}{1e3 * single:>10.2f}{1e3 * each:>12.3f}{single / each:>7.1f}")
    print_load()


if __name__ == "__main__":
    main()
