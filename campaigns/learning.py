"""A learner against line of sight: path following in a current, three seeds, a stated budget.

Question: does PPO of stable-baselines3 follow a line better than the paper's line of sight, than
the best of a grid of that law and of the integral law? All of them steer the same robot through the
same environment, every 0.2 s, in the same 256 episodes, which neither the learner nor the grid has
seen. The return is what counts; what it is made of stands beside it, of the last 20 s of each
episode.

    pip install . "./plugins/laticauda-gym[sb3]"
    python campaigns/learning.py --budget 1000000

PPO's settings are the defaults of stable-baselines3 but for those in `SETTINGS`, which are the best
of three that were tried with 300 000 steps of seed 0, a seed that the comparison does not use.
"""

import argparse
import importlib.util
import itertools
import math
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import laticauda as lc
from laticauda_gym import Pilots, SwimmingVectorEnv

LANES = 64
EPISODES = 256
UNSEEN = 3_000_000  # seed of the first episode of the comparison
TUNING = 2_000_000  # of those that the grid is searched with
DISTANCES, GAINS = (0.09, 0.18, 0.36, 0.72, 1.62), (0.25, 0.4, 0.6, 0.9, 1.4)  # m, -
INTEGRAL_GAINS = (0.01, 0.02, 0.04, 0.12)  # m/s
# Steps per lane and update, and a smaller spread at first: offsets that jump by all they can every
# 0.2 s turn nothing.
SETTINGS = {
    "n_steps": 128,
    "batch_size": 512,
    "learning_rate": 1e-3,
    "policy_kwargs": {"log_std_init": -1.0},
}
Act = Callable[[np.ndarray], np.ndarray]


def steers(envs: SwimmingVectorEnv, guidance: Any, gain: float) -> Act:
    """A law at the helm of every lane."""
    task: Any = envs.task
    heading = lc.HeadingController(gain=gain, max_offset=task.max_offset)
    line = lc.StraightLine()
    law = lc.PathFollowing(
        gait=task.gait, path=line, guidance=guidance, heading=heading, interval=task.interval
    )
    pilots = Pilots(law, envs.episodes)
    return lambda _: pilots.actions()


def evaluated(make: Callable[[SwimmingVectorEnv], Act], seed: int, n: int) -> dict[str, np.ndarray]:
    """Whole episodes, one per lane: return, and figures of the last third."""
    envs = SwimmingVectorEnv(n, task="PathFollowing")
    act = make(envs)
    observation, _ = envs.reset(seed=seed)
    count = envs.task.n_steps
    rewards, error, power, place = (np.empty((count, n)) for _ in range(4))
    for i in range(count):
        observation, rewards[i], _, _, info = envs.step(act(observation))
        error[i], power[i], place[i] = info["y"], info["power"], info["x"]
    late = slice(2 * count // 3, None)
    seconds = envs.task.interval * (count - 2 * count // 3 - 1)
    return {
        "return": rewards.sum(axis=0),
        "error": np.sqrt((error[late] ** 2).mean(axis=0)),
        "speed": (place[-1] - place[late][0]) / seconds,
        "power": power[late].mean(axis=0),
    }


def learned(seed: int, budget: int) -> tuple[Any, float]:
    """A policy of PPO, and how long it took [s]."""
    from stable_baselines3 import PPO
    from stable_baselines3.common.vec_env import VecNormalize

    from laticauda_gym import StableBaselines

    envs = SwimmingVectorEnv(LANES, task="PathFollowing", autoreset_mode="SameStep")
    scaled = VecNormalize(StableBaselines(envs), norm_obs=False)  # rewards only
    model = PPO("MlpPolicy", scaled, seed=seed, device="cpu", **SETTINGS)
    begun = time.perf_counter()
    model.learn(budget)
    return model, time.perf_counter() - begun


def row(name: str, figures: dict[str, np.ndarray], best: np.ndarray) -> str:
    """One line of the table: means over the episodes, the error as their root mean square.

    The episodes are the same for all, so the difference to the best law says more than the two
    returns.
    """
    returns = figures["return"]
    error = 1e3 * math.sqrt(np.mean(figures["error"] ** 2))
    words = f"| {name} | {mean(returns)} | {mean(returns - best)} | {error:.0f} "
    return f"{words}| {figures['speed'].mean():.3f} | {figures['power'].mean():.1f} |"


def mean(values: np.ndarray) -> str:
    """Of the episodes, and its standard error."""
    return f"{values.mean():.1f} ± {values.std() / math.sqrt(EPISODES):.1f}"


def best_of(laws: list[tuple[Any, float]]) -> tuple[Any, float]:
    """The guidance and the gain of the highest return, in other episodes than those of the comparison."""

    def worth(law: tuple[Any, float]) -> float:
        return float(evaluated(lambda envs: steers(envs, *law), TUNING, LANES)["return"].mean())

    return max(laws, key=worth)


def print_laws() -> np.ndarray:
    """The rows of those that do not learn; the returns of the best."""
    sight = [
        (lc.LineOfSight(look_ahead_distance=d), k) for d, k in itertools.product(DISTANCES, GAINS)
    ]
    learns = [
        (lc.IntegralLineOfSight(look_ahead_distance=d, integral_gain=s), k)
        for d, s, k in itertools.product(DISTANCES, INTEGRAL_GAINS, GAINS)
    ]
    near, far = best_of(sight), best_of(learns)
    distance = f"{near[0].look_ahead_distance} m, gain {near[1]}"
    integral = f"{far[0].look_ahead_distance} m, {far[0].integral_gain} m/s, gain {far[1]}"
    laws = {
        "nobody": None,
        "LOS, 0.18 m, gain 0.4": sight[DISTANCES.index(0.18) * len(GAINS) + GAINS.index(0.4)],
        f"LOS, {distance}, best of {len(sight)}": near,
        f"ILOS, {integral}, best of {len(learns)}": far,
    }
    figures: dict[str, dict[str, np.ndarray]] = {}
    for name, law in laws.items():
        make: Any = (lambda envs: lambda _: np.zeros((EPISODES, 1))) if law is None else None
        figures[name] = evaluated(
            make or (lambda envs, law=law: steers(envs, *law)), UNSEEN, EPISODES
        )
    best = max((each["return"] for each in figures.values()), key=np.mean)
    for name, each in figures.items():
        print(row(name, each, best), flush=True)
    return best


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument(
        "--budget", type=int, default=1_000_000, help="steps of 0.2 s that each learner may take"
    )
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3], help="of the learners")
    args = parser.parse_args()
    if importlib.util.find_spec("stable_baselines3") is None:
        print("This needs stable-baselines3; run `pip install stable-baselines3`.", file=sys.stderr)
        return
    print(
        "| who steers | return | less the best law's | rms error [mm] | along [m/s] | power [W] |"
    )
    print("|---|---|---|---|---|---|")
    best = print_laws()
    for seed in args.seeds:
        model, seconds = learned(seed, args.budget)
        act: Act = lambda seen, model=model: model.predict(seen, deterministic=True)[0]  # noqa: E731
        figures = evaluated(lambda envs, act=act: act, UNSEEN, EPISODES)
        print(
            row(f"PPO, {args.budget} steps, seed {seed}", figures, best),
            f"learned in {seconds:.0f} s",
            flush=True,
        )


if __name__ == "__main__":
    main()
