"""How many steps per second do the environments make in lanes, against one process per environment?

Question: what does a learner gain from the batch kernel, or in space from threads in one process?
Path following: steps of 0.2 s of Mamba with its fin, random actions, whole calls through
Gymnasium's own `make_vec`, on this machine. All ways take turns in every round, and the best round
of each counts. Other work on the machine takes from all of them, but not the same share: so the
second table has the steps per second of processor time, of all processes together. It needs
`plugins/laticauda-gym`.

    python benchmarks/environments.py [spatial]
"""

import multiprocessing
import os
import sys
import time
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import gymnasium
from _timing import print_load

import laticauda_gym

NAME = laticauda_gym.IDS[0]
MODEL = "".join(sys.argv[1:]) or "planar"
COUNTS = (2, 8, 64, 1024) if MODEL == "planar" else (2, 8, 64)
MOST_PROCESSES = 64
ROUNDS = 5
SECONDS = 0.4
"""Duration of each way in each round, at least [s]."""
WAYS: dict[str, dict[str, Any]] = {
    "in lanes": {"vectorization_mode": "vector_entry_point", "threads": 1},
    "in lanes, all cores": {"vectorization_mode": "vector_entry_point", "threads": os.cpu_count()},
    "one by one": {"vectorization_mode": "sync"},
    "a process each": {"vectorization_mode": "async"},
}


class Rate(NamedTuple):
    """Steps per second of all environments together."""

    by_clock: float
    by_processor: float


Rates = dict[tuple[str, int], Rate]
"""Rates by way and number of environments."""


def processor_time() -> float:
    """Of this process and of those that it started and that still run [s]; nan where the system does not say."""
    spent = time.process_time()
    for child in multiprocessing.active_children():
        try:
            spent += int(Path(f"/proc/{child.pid}/schedstat").read_text().split()[0]) * 1e-9
        except OSError:
            return float("nan")
    return spent


def steps_per_second(envs: Any, actions: list[Any]) -> Rate:
    """Step environments for a while, and return how fast they were."""
    start = time.perf_counter()
    processor_start = processor_time()
    n_steps = 0
    while time.perf_counter() - start < SECONDS:
        for action in actions:
            envs.step(action)
        n_steps += len(actions) * envs.num_envs
    return Rate(
        by_clock=n_steps / (time.perf_counter() - start),
        by_processor=n_steps / (processor_time() - processor_start),
    )


def rates(n: int) -> Rates:
    """The best round of every way with this many environments."""
    best: Rates = {}
    for _ in range(ROUNDS):
        for way, settings in WAYS.items():
            if way == "a process each" and n > MOST_PROCESSES:
                continue
            envs = gymnasium.make_vec(NAME, num_envs=n, model=MODEL, **settings)
            envs.reset(seed=1)
            envs.action_space.seed(1)
            actions = [envs.action_space.sample() for _ in range(8)]
            envs.step(actions[0])
            rate = steps_per_second(envs, actions)
            best_rate = best.get((way, n), Rate(0.0, 0.0))
            best[way, n] = Rate(*map(max, rate, best_rate))
            envs.close()
    return best


def print_table(rates: dict[tuple[str, int], float], title: str) -> None:
    print(f"\n{title:<34}" + "".join(f"{n:>10}" for n in COUNTS) + "  environments")
    fastest_of_way: dict[str, float] = {}
    for way in WAYS:
        rates_of_way = [rates[way, n] for n in COUNTS if (way, n) in rates]
        fastest_of_way[way] = max(rates_of_way)
        print(f"{way:<34}" + "".join(f"{rate:>10.0f}" for rate in rates_of_way))
    for way in ("in lanes", "in lanes, all cores"):
        as_many = rates[way, MOST_PROCESSES] / rates["a process each", MOST_PROCESSES]
        at_best = fastest_of_way[way] / fastest_of_way["a process each"]
        print(f"{MOST_PROCESSES} {way}, of a process each: {as_many:.3g} times; ", end="")
        print(f"the most, of the most in processes: {at_best:.3g} times")


def main() -> None:
    """Print the tables."""
    warnings.simplefilter("ignore")  # Gymnasium's own about forks
    print_load()
    best: Rates = {}
    for n in COUNTS:
        best |= rates(n)
    by_clock = {key: rate.by_clock for key, rate in best.items()}
    by_processor = {key: rate.by_processor for key, rate in best.items()}
    print_table(by_clock, "steps per second")
    print_table(by_processor, "steps per second of processor")


if __name__ == "__main__":
    main()
