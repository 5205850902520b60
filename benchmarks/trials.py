"""How does the cost of a batch grow with the number of trials?

Question: 30 s of a robot of ten links with prescribed joints, on all cores: from how many trials on
does a trial cost what it costs at last? Printed: wall time per trial, and the ratio to that of the
largest batch.
"""

import time
from functools import partial

from _timing import fastest, of_links, print_load, random_gaits

import laticauda as lc

TRIALS = (1, 8, 64, 512, 4096, 16384)


def main() -> None:
    """Print the table."""
    robot, gaits = of_links(10), random_gaits(TRIALS[-1])
    seconds_per_trial: dict[int, float] = {}
    for n in TRIALS:
        repeats = 20 if n < 1000 else 3
        swim_batch = partial(lc.swim_many, robot, gaits[:n])
        seconds_per_trial[n] = fastest(time.perf_counter, swim_batch, repeats) / n
    print(f"{'trials':>8}{'per trial [ms]':>16}{'ratio':>7}")
    seconds_at_last = seconds_per_trial[TRIALS[-1]]
    for n, seconds in seconds_per_trial.items():
        print(f"{n:>8}{1e3 * seconds:>16.3f}{seconds / seconds_at_last:>7.2f}")
    print_load()


if __name__ == "__main__":
    main()
