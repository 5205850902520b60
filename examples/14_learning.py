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

GENERATIONS = 20
CANDIDATES = 16
EPISODES = 4  # of each candidate
envs = gymnasium.make_vec(
    "laticauda/PathFollowing-v0", num_envs=CANDIDATES * EPISODES
)
task = envs.unwrapped.task


def run_episodes(act, seed):
    """Return what one episode in every lane earns."""
    observation, _ = envs.reset(seed=seed)
    returns = np.zeros(envs.num_envs)
    for _ in range(task.n_steps):
        observation, reward, *_ = envs.step(act(observation))
        returns += reward
    return returns


def linear_policy(parameters):
    """Return a policy: a row of weights, with a bias at its end, for every lane."""
    weights = parameters[:, :-1]
    biases = parameters[:, -1:]

    def act(observation):
        sums = (observation * weights).sum(axis=1, keepdims=True)
        return np.tanh(sums + biases)

    return act


def learn(seed):
    """Return the parameters with which the evolution ends."""
    search = cma.CMAEvolutionStrategy(
        [0.0] * 10, 0.2, {"popsize": CANDIDATES, "seed": seed + 1, "verbose": -9}
    )
    for generation in range(GENERATIONS):
        candidates = search.ask()
        act = linear_policy(np.repeat(candidates, EPISODES, axis=0))
        returns = run_episodes(act, seed=1000 * (seed + 1) + generation)
        mean_returns = returns.reshape(CANDIDATES, EPISODES).mean(axis=1)
        search.tell(candidates, -mean_returns)
    return search.result.xfavorite


law = lc.PathFollowing(
    gait=task.gait,
    path=lc.StraightLine(),
    guidance=lc.LineOfSight(look_ahead_distance=0.18),
    heading=lc.HeadingController(gain=0.4, max_offset=task.max_offset),
    interval=task.interval,
)
pilots = Pilots(law, envs.unwrapped.episodes)
returns = {"line of sight": run_episodes(lambda _: pilots.actions(), seed=0)}
print(f"line of sight: return {returns['line of sight'].mean():.1f}")
steps = GENERATIONS * envs.num_envs * task.n_steps
for seed in range(3):
    act = linear_policy(np.tile(learn(seed), (envs.num_envs, 1)))
    returns[f"learner {seed}"] = run_episodes(act, seed=0)
    mean = returns[f"learner {seed}"].mean()
    print(f"learner, seed {seed}, {steps} steps: return {mean:.1f}")

figure, (ax,) = new_panels(width=5.0)
median = {"color": style.ORANGE, "linewidth": style.LINE}
ax.boxplot(list(returns.values()), tick_labels=list(returns), medianprops=median)
style.style_axes(ax, xlabel="", ylabel="return of an episode [-]")
save_figure(figure, "returns.png")
