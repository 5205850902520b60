"""What the benchmarks share: the least time of a few repetitions, a robot of so many links, random gaits."""

import os
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

import laticauda as lc


def fastest(clock: Callable[[], float], work: Callable[[], object], repeats: int = 7) -> float:
    """Least time of a few repetitions, after one to warm up [s]; other work on the machine only ever adds to it."""
    work()
    times: list[float] = []
    for _ in range(repeats):
        start = clock()
        work()
        times.append(clock() - start)
    return min(times)


def of_links(n: int) -> lc.Robot:
    """Mamba's first module, n times."""
    mamba = lc.load_robot("mamba").planar()
    return replace(mamba, modules=mamba.modules[:1] * n, joints=mamba.joints[:1] * (n - 1))


def random_gaits(n: int) -> list[lc.Gait]:
    """Lateral undulation, always the same gaits."""
    rng = np.random.default_rng(1)
    ranges = {"amplitude": (0.2, 0.7), "frequency": (1.0, 3.0), "phase_shift": (0.3, 1.0)}
    gaits: list[lc.Gait] = []
    for _ in range(n):
        numbers = {name: float(rng.uniform(*ends)) for name, ends in ranges.items()}
        gaits.append(lc.lateral_undulation(**numbers))
    return gaits


def print_load() -> None:
    """How busy the machine is: times are worth what this says."""
    load = "unknown"
    if hasattr(os, "getloadavg"):
        load = f"{os.getloadavg()[0]:.1f}"
    print(f"({time.strftime('%Y-%m-%d')}, {os.cpu_count()} cores, load {load})")
