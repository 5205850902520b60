"""How does the cost grow with the number of links?

Question: 10 s with prescribed joints, 5 to 160 links, alone and in a batch, at one step: is the
recursion linear? Printed: time of one core per trial and per link, and the ratio of the latter to
that of 10 links.
"""

import time
from functools import partial

from _timing import fastest, of_links, print_load, random_gaits

import laticauda as lc

LINKS = (5, 10, 20, 40, 80, 160)
DURATION, STEP = 10.0, 0.05
TRIALS = 64


def main() -> None:
    """Print the table."""
    gaits = random_gaits(TRIALS)
    settings = {"duration": DURATION, "dt": STEP, "sample_interval": 0.5}
    times_of_links: dict[int, tuple[float, float]] = {}
    for n in LINKS:
        robot = of_links(n)
        swim_alone = partial(lc.swim, robot, gaits[0], **settings)
        swim_batch = partial(lc.swim_many, robot, gaits, threads=1, **settings)
        alone = fastest(time.process_time, swim_alone, 20)
        in_batch = fastest(time.process_time, swim_batch) / TRIALS
        times_of_links[n] = alone, in_batch
    print(
        f"{'links':>6}{'alone [us]':>12}{'per link':>10}{'ratio':>7}{'batch [us]':>12}{'per link':>10}{'ratio':>7}"
    )
    for n, times in times_of_links.items():
        line = f"{n:>6}"
        for seconds, seconds_of_ten in zip(times, times_of_links[10], strict=True):
            ratio = (seconds / n) / (seconds_of_ten / 10)
            line += f"{1e6 * seconds:>12.0f}{1e6 * seconds / n:>10.1f}{ratio:>7.2f}"
        print(line)
    print_load()


if __name__ == "__main__":
    main()
