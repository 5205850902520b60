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
from typing import Any

import gymnasium
from _timing import print_load

import laticauda_gym

NAME = laticauda_gym.IDS[0]
MODEL = "".join(sys.argv[1:]) or "planar"
COUNTS = (2, 8, 64, 1024) if MODEL == "planar" else (2, 8, 64)
MOST_PROCESSES = 64
ROUNDS, SECONDS = 5, 0.4  # of each way in each round, at least
WAYS: dict[str, dict[str, Any]] = {
    "in lanes": {"vectorization_mode": "vector_entry_point", "threads": 1},
    "in lanes, all cores": {"vectorization_mode": "vector_entry_point", "threads": os.cpu_count()},
    "one by one": {"vectorization_mode": "sync"},
    "a process each": {"vectorization_mode": "async"},
}
Rates = dict[tuple[str, int], tuple[float, float]]


def processor_time() -> float:
    """Of this process and of those that it started and that still run [s]; nan where the system does not say."""
    spent = time.process_time()
    for child in multiprocessing.active_children():
        try:
            spent += int(Path(f"/proc/{child.pid}/schedstat").read_text().split()[0]) * 1e-9
        except OSError:
            return float("nan")
    return spent


def steps_per_second(envs: Any, actions: list[Any]) -> tuple[float, float]:
    """Of all environments together: by the clock, and by the processor."""
    begun, spent, count = time.perf_counter(), processor_time(), 0
    while time.perf_counter() - begun < SECONDS:
        for action in actions:
            envs.step(action)
        count += len(actions) * envs.num_envs
    return count / (time.perf_counter() - begun), count / (processor_time() - spent)


def rates(n: int) -> Rates:
    """The best round of every way with this many environments."""
    best: Rates = {}
    for _ in range(ROUNDS):
        for way, how in WAYS.items():
            if way == "a process each" and n > MOST_PROCESSES:
                continue
            envs = gymnasium.make_vec(NAME, num_envs=n, model=MODEL, **how)
            envs.reset(seed=1)
            envs.action_space.seed(1)
            actions = [envs.action_space.sample() for _ in range(8)]
            envs.step(actions[0])
            once, before = steps_per_second(envs, actions), best.get((way, n), (0.0, 0.0))
            best[way, n] = (max(once[0], before[0]), max(once[1], before[1]))
            envs.close()
    return best


def print_table(best: Rates, which: int, words: str) -> None:
    print(f"\n{words:<34}" + "".join(f"{n:>10}" for n in COUNTS) + "  environments")
    for way in WAYS:
        print(
            f"{way:<34}"
            + "".join(f"{best[way, n][which]:>10.0f}" for n in COUNTS if (way, n) in best)
        )
    most = {
        way: max(found[which] for (name, _), found in best.items() if name == way) for way in WAYS
    }
    processes = best["a process each", MOST_PROCESSES][which]
    for way in ("in lanes", "in lanes, all cores"):
        same = best[way, MOST_PROCESSES][which] / processes
        print(f"{MOST_PROCESSES} {way}, of a process each: {same:.3g} times; ", end="")
        print(f"the most, of the most in processes: {most[way] / most['a process each']:.3g} times")


def main() -> None:
    """Print the tables."""
    warnings.simplefilter("ignore")  # Gymnasium's own about forks
    print_load()
    best: Rates = {}
    for n in COUNTS:
        best |= rates(n)
    print_table(best, 0, "steps per second")
    print_table(best, 1, "steps per second of processor")


if __name__ == "__main__":
    main()
