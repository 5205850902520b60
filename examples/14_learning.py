"""A learner against line of sight: both follow a line in a current that neither of
them observes.

The learner is an evolution strategy (CMA-ES) for a policy with ten parameters. In
the 64 lanes of one environment, 16 candidates swim four episodes each, so a
generation is 19 200 steps of 0.2 s and takes a fraction of a second. There are
three seeds; the episodes at the end are new to all of them.
`campaigns/learning.py` uses PPO from stable-baselines3 instead.

    pip install . ./plugins/laticauda-gym cma
    python examples/14_learning.py
"""

import cma
import gymnasium
import numpy as np

import laticauda as lc
from laticauda.show.figures import new_panels, save_figure, style
from laticauda_gym import Pilots

GENERATIONS, CANDIDATES, EPISODES = 20, 16, 4
envs = gymnasium.make_vec(
    "laticauda/PathFollowing-v0", num_envs=CANDIDATES * EPISODES
)
task = envs.unwrapped.task


def returns(act, seed):
    """Of one episode in every lane."""
    observation, _ = envs.reset(seed=seed)
    total = np.zeros(envs.num_envs)
    for _ in range(task.n_steps):
        observation, reward, *_ = envs.step(act(observation))
        total += reward
    return total


def linear(weights):
    """Offsets from weighted sums of what is seen, a row of weights a lane."""
    return lambda seen: np.tanh(
        (seen * weights[:, :-1]).sum(axis=1, keepdims=True) + weights[:, -1:]
    )


def learned(seed):
    """The weights that an evolution of so many generations ends with."""
    search = cma.CMAEvolutionStrategy(
        [0.0] * 10, 0.2, {"popsize": CANDIDATES, "seed": seed + 1, "verbose": -9}
    )
    for generation in range(GENERATIONS):
        asked = search.ask()
        worth = returns(
            linear(np.repeat(asked, EPISODES, axis=0)),
            seed=1000 * (seed + 1) + generation,
        )
        search.tell(asked, -worth.reshape(CANDIDATES, EPISODES).mean(axis=1))
    return search.result.xfavorite


heading = lc.HeadingController(gain=0.4, max_offset=task.max_offset)
sight = lc.LineOfSight(look_ahead_distance=0.18)
law = lc.PathFollowing(
    gait=task.gait,
    path=lc.StraightLine(),
    guidance=sight,
    heading=heading,
    interval=task.interval,
)
pilots = Pilots(law, envs.unwrapped.episodes)
found = {"line of sight": returns(lambda _: pilots.actions(), seed=0)}
print(f"line of sight: return {found['line of sight'].mean():.1f}")
steps = GENERATIONS * envs.num_envs * task.n_steps
for seed in range(3):
    weights = np.tile(learned(seed), (envs.num_envs, 1))
    found[f"learner {seed}"] = returns(linear(weights), seed=0)
    worth = found[f"learner {seed}"].mean()
    print(f"learner, seed {seed}, {steps} steps: return {worth:.1f}")

figure, (ax,) = new_panels(width=5.0)
median = {"color": style.ORANGE, "linewidth": style.LINE}
ax.boxplot(list(found.values()), tick_labels=list(found), medianprops=median)
style.style_axes(ax, xlabel="", ylabel="return of an episode [-]")
save_figure(figure, "returns.png")
