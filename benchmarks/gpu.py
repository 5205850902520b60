"""How many trials a second does a GPU make, against all cores of the processor beside it?

Question: 30 s of Mamba with its fin, random gaits, default steps, everything that `swim_many` does
included, once compiled. Printed: trials per second of both, and by how much their figures differ at
most.

    python benchmarks/gpu.py [--trials 1000 10000 100000]

Last answer: see docs/how-to/gpu.md.
"""

import argparse
import time

import numpy as np
from _timing import print_load, random_gaits

import laticauda as lc

FIGURES = ("forward_velocity", "net_power", "mean_power", "heading", "center_of_mass")


def time_swim(gaits: list[lc.Gait], joints: str, device: str) -> tuple[lc.Swims, float]:
    """What comes out, and how long it took [s]."""
    start = time.perf_counter()
    swims = lc.swim_many("mamba-fin", gaits, joints=joints, device=device)
    return swims, time.perf_counter() - start


def difference(of_cores: lc.Swims, of_gpu: lc.Swims) -> float:
    """The largest of any figure of any trial that succeeded, over the largest value of that figure [-]."""
    largest = 0.0
    for name in FIGURES:
        values = getattr(of_cores, name)[of_cores.succeeded]
        other_values = getattr(of_gpu, name)[of_cores.succeeded]
        relative = np.abs(values - other_values).max() / np.abs(values).max()
        largest = max(largest, float(relative))
    return largest


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--trials", type=int, nargs="+", default=[1000, 10_000, 100_000])
    options = parser.parse_args()
    try:
        lc.swim_many("mamba-fin", random_gaits(1), 1.0, device="cuda")
    except ValueError as error:
        print(f"Nothing measured: {error}")
        return
    print(
        f"{'joints':<12}{'trials':>8}{'first call [s]':>16}{'GPU [1/s]':>12}{'cores [1/s]':>13}{'differ':>10}"
    )
    for joints in ("prescribed", "servo"):
        gaits = random_gaits(max(options.trials))
        _, seconds_of_first = time_swim(gaits[:64], joints, "cuda")
        time_swim(gaits[:64], joints, "cpu")
        for n in options.trials:
            on_gpu, gpu_seconds = time_swim(gaits[:n], joints, "cuda")
            on_cores, core_seconds = time_swim(gaits[:n], joints, "cpu")
            rates = f"{n / gpu_seconds:>12.0f}{n / core_seconds:>13.0f}"
            differ = f"{difference(on_cores, on_gpu):>10.1e}"
            print(f"{joints:<12}{n:>8}{seconds_of_first:>16.1f}{rates}{differ}", flush=True)
    print_load()


if __name__ == "__main__":
    main()
