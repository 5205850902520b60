"""How does the cost grow with the number of links?

Question: 10 s with prescribed joints, 5 to 160 links, alone and in a batch, at one step: is the
recursion linear? Printed: time of one core per trial and per link, and the ratio of the latter to
that of 10 links.
"""

import time

from _timing import fastest, of_links, print_load, random_gaits

import laticauda as lc

LINKS = (5, 10, 20, 40, 80, 160)
DURATION, STEP = 10.0, 0.05
TRIALS = 64


def main() -> None:
    """Print the table."""
    gaits = random_gaits(TRIALS)
    found: dict[int, tuple[float, float]] = {}
    for n in LINKS:
        robot = of_links(n)
        alone = fastest(
            time.process_time,
            lambda r=robot: lc.swim(r, gaits[0], DURATION, dt=STEP, sample_interval=0.5),
            20,
        )
        batch = fastest(
            time.process_time,
            lambda r=robot: lc.swim_many(
                r, gaits, DURATION, dt=STEP, sample_interval=0.5, threads=1
            ),
        )
        found[n] = alone, batch / TRIALS
    print(
        f"{'links':>6}{'alone [us]':>12}{'per link':>10}{'ratio':>7}{'batch [us]':>12}{'per link':>10}{'ratio':>7}"
    )
    for n, times in found.items():
        line = f"{n:>6}"
        for each, reference in zip(times, found[10], strict=True):
            line += f"{1e6 * each:>12.0f}{1e6 * each / n:>10.1f}{each / n / (reference / 10):>7.2f}"
        print(line)
    print_load()


if __name__ == "__main__":
    main()
