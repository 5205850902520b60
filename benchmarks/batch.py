"""What does a trial cost in a batch, against the same trial alone?

Question: 30 s of a robot of ten links, random gaits, default steps, everything that `swim_many`
does included. Printed: time of one core per trial, and the ratio to `swim`.
"""

import time
from functools import partial

from _timing import fastest, of_links, print_load, random_gaits

import laticauda as lc

TRIALS = {"prescribed": 1600, "pd": 160, "servo": 160}


def main() -> None:
    """Print the table."""
    robot = of_links(10)
    print(f"{'joints':<12}{'swim [ms]':>10}{'batch [ms]':>12}{'ratio':>7}")
    for joints, n in TRIALS.items():
        gaits = random_gaits(n)
        swim_alone = partial(lc.swim, robot, gaits[0], joints=joints)
        swim_batch = partial(lc.swim_many, robot, gaits, joints=joints, threads=1)
        alone = fastest(time.process_time, swim_alone, 10)
        in_batch = fastest(time.process_time, swim_batch) / n
        print(f"{joints:<12}{1e3 * alone:>10.2f}{1e3 * in_batch:>12.3f}{alone / in_batch:>7.1f}")
    print_load()


if __name__ == "__main__":
    main()
