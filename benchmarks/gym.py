"""How many steps per second do the environments make in lanes, against one process per environment?

Question: what does a learner gain from the batch kernel? Steps of 0.2 s of Mamba with its fin, random actions, wall
time; all ways run one after the other in this call, on the same machine, through Gymnasium's own `make_vec`. It needs
the extra `learn`.

    python benchmarks/gym.py
"""

import time
import warnings

import gymnasium
import numpy as np
from _timing import print_load

from laticauda.cosim.gym import IDS

COUNTS = (8, 64, 1024)
SECONDS = 1.5  # of each measurement, at least
REPEATS = 3
MOST_PROCESSES = 64


def steps_per_second(envs: gymnasium.vector.VectorEnv) -> float:
    """The most of a few repetitions, episodes' ends included; other work on the machine only ever takes some away."""
    envs.reset(seed=1)
    envs.action_space.seed(1)
    actions = [envs.action_space.sample() for _ in range(16)]
    rates: list[float] = []
    for _ in range(REPEATS + 1):  # the first warms up
        begun, count = time.perf_counter(), 0
        while time.perf_counter() - begun < SECONDS / REPEATS:
            for action in actions:
                envs.step(action)
            count += len(actions)
        rates.append(count * envs.num_envs / (time.perf_counter() - begun))
    return max(rates[1:])


def measured(name: str, n: int, mode: str, **settings: object) -> float:
    envs = gymnasium.make_vec(name, num_envs=n, vectorization_mode=mode, **settings)
    try:
        return steps_per_second(envs)
    finally:
        envs.close()


def main() -> None:
    """Print the table."""
    warnings.simplefilter("ignore")
    print_load()
    ways = (("in lanes", "vector_entry_point", {}), ("in lanes, 2 threads", "vector_entry_point", {"threads": 2}))
    ways += (("one by one", "sync", {}), ("a process each", "async", {}))
    for name in IDS:
        print(name)
        print(f"{'':<22}" + "".join(f"{n:>12}" for n in COUNTS) + "   environments")
        table = {}
        for way, mode, settings in ways:
            counts = [n for n in COUNTS if mode != "async" or n <= MOST_PROCESSES]
            table[way] = [measured(name, n, mode, **settings) for n in counts]
            print(f"{way:<22}" + "".join(f"{rate:>12.0f}" for rate in table[way]) + "   steps/s")
        best = max(table["a process each"])
        print(f"{'best lanes / best processes':<28}{max(table['in lanes']) / best:.0f} times on one core, ", end="")
        print(f"{max(np.max(table['in lanes, 2 threads']), max(table['in lanes'])) / best:.0f} times at most\n")


if __name__ == "__main__":
    main()
