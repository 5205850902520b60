"""Does a sweep's memory grow with the number of its trials?

Question: how much memory do sweeps of 1e5 and 1e6 trials (and 1e7, if asked for) take at most, each
in a process of its own? The trials are short (0.2 s), so what is measured is everything around
them: making the points, storing, and finding the best.

    python campaigns/sweep_memory.py
    python campaigns/sweep_memory.py --most 10000000

Last answer (2 shared cores, 2026-11-21):
       100000 trials:   265 MB, 114.3 us per trial (the cores were busy with other work)
      1000000 trials:   265 MB, 109.6 us per trial
"""

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import laticauda as lc
from laticauda.models.simulate import swim_many
from laticauda.studies import Samples, Sweep, best_points, run_sweep

SIZES = (100_000, 1_000_000, 10_000_000)
DURATION = 0.2  # [s]


def child(n: int) -> None:
    """One sweep in this process."""
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
    ranges = {
        "gait.amplitude": (0.2, 0.9),
        "gait.frequency": (1.0, 3.0),
        "gait.phase_shift": (0.2, 1.0),
    }
    points = Samples(ranges=ranges, n_points=n)
    sweep = Sweep(scenario=lc.build_scenario("mamba", gait, DURATION), points=points)
    swim_many([sweep.scenario] * 16)  # compiled, if it was not
    with tempfile.TemporaryDirectory() as folder:
        begun = time.perf_counter()
        run_sweep(sweep, Path(folder, "a"))
        took = time.perf_counter() - begun
        best_points(Path(folder, "a"))
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    print(f"{n:9d} trials: {memory:5.0f} MB, {1e6 * took / n:5.1f} us per trial", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--child", type=int)
    parser.add_argument("--most", type=int, default=SIZES[1])
    options = parser.parse_args()
    if options.child:
        child(options.child)
        return
    for size in SIZES:
        if size <= options.most:
            subprocess.run([sys.executable, __file__, "--child", str(size)], check=True)


if __name__ == "__main__":
    main()
