"""What does moving water cost in a batch, against still water?

Question: 30 s of a robot of ten links, random gaits, prescribed joints, everything that `swim_many`
does included, one process per version of the package, in turns. Printed: time of one core per
trial, and the ratio to still water, of the version whose sources are given by `--against`, else of
this one.
"""

import argparse
import os
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from _timing import of_links, print_load, random_gaits

import laticauda as lc

TRIALS, ROUNDS = 256, 5


def currents() -> dict[str, Any]:
    """What is in the table besides still water."""
    from laticauda.water.fluid.gridded import Gridded, to_dataset
    from laticauda.water.fluid.waves import Sea

    sea = Sea(significant_height=0.02, peak_period=1.5, spread=0.3)
    axes = {
        "time": np.linspace(0.0, 31.0, 63),
        "y": np.linspace(-10.0, 10.0, 41),
        "x": np.linspace(-10.0, 10.0, 41),
    }
    levels = {**axes, "z": np.linspace(-2.0, 0.0, 9)}
    return {
        "uniform": (0.05, 0.02),
        "1 wave": replace(sea, components=1),
        "8 waves": replace(sea, components=8),
        "16 waves": replace(sea, components=16),
        "grid t, y, x": Gridded(source=to_dataset(sea, **axes)),
        "grid t, z, y, x": Gridded(source=to_dataset(sea, **levels)),
    }


def least(currents: Mapping[str, Any]) -> dict[str, float]:
    """Least time of one core per trial of a few rounds, by current [s]."""
    robot = of_links(10)
    gaits = random_gaits(TRIALS)
    water = lc.load_water("paper-lateral")
    best = dict.fromkeys(currents, float("inf"))
    for repeat in range(1 + ROUNDS):
        for name, current in currents.items():
            waters = [replace(water, current=current)] * TRIALS
            start = time.process_time()
            lc.swim_many(robot, gaits, environments=waters, threads=1)
            seconds = (time.process_time() - start) / TRIALS
            if repeat:  # the first compiles
                best[name] = min(best[name], seconds)
    return best


def still_of(sources: Path) -> float:
    """The same of still water, with the package in another folder of sources."""
    command = [sys.executable, __file__, "--still"]
    environment = {**os.environ, "PYTHONPATH": str(sources)}
    process = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return float(process.stdout)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--against", type=Path, help="folder `src` of another version, for still water"
    )
    parser.add_argument("--still", action="store_true", help="print the time of still water alone")
    options = parser.parse_args()
    if options.still:
        print(least({"still": (0.0, 0.0)})["still"])
        return
    best: dict[str, float] = {}
    reference = float("inf")
    for _ in range(2):  # in turns
        for name, seconds in least({"still": (0.0, 0.0), **currents()}).items():
            best[name] = min(best.get(name, float("inf")), seconds)
        still = best["still"]
        if options.against:
            still = still_of(options.against)
        reference = min(reference, still)
    print(f"still water of {options.against or 'this version'}: {1e3 * reference:.3f} ms")
    for name, seconds in best.items():
        print(f"{name:<16}{1e3 * seconds:>10.3f} ms{seconds / reference:>8.2f}")
    print_load()


if __name__ == "__main__":
    main()
