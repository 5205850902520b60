"""Train the learners: PPO and SAC of stable-baselines3, in episodes that are not scored. It needs stable-baselines3.

Every run is saved in a folder as it proceeds, with the number of its steps: the same command
continues where it stopped, and a larger number of steps continues from there. SAC does not save its
replay buffer, so it then fills a new one.
"""

# pyright: reportMissingImports=false, reportUnknownVariableType=false, reportUnknownMemberType=false
# pyright: reportUnknownArgumentType=false, reportUntypedBaseClass=false, reportUnknownParameterType=false

import json
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.values import check_choice
from laticauda_gym import SwimmingVectorEnv
from laticauda_gym.packages import needed
from laticauda_swimbench import networks
from laticauda_swimbench.challenges import challenge

SETTINGS: dict[str, dict[str, Any]] = {
    # Steps per robot and update, and a smaller initial spread, as in the comparison for path
    # following.
    "ppo": {
        "n_steps": 50,
        "batch_size": 400,
        "n_epochs": 8,
        "learning_rate": 1e-3,
        "policy_kwargs": {"log_std_init": -1.0, "net_arch": [64, 64]},
    },
    # Few updates per step: the robots are cheap, the updates are not.
    "sac": {
        "train_freq": 1,
        "gradient_steps": 4,
        "batch_size": 256,
        "learning_rate": 1e-3,
        "learning_starts": 3200,
        "buffer_size": 200_000,
        "policy_kwargs": {"net_arch": [64, 64]},
    },
}
"""Settings of stable-baselines3; the same in all scenarios, and not tuned to any."""
LANES = {"ppo": 64, "sac": 32}
"""Number of robots side by side."""
CHUNK = 51_200
"""Number of steps after which a run is saved."""


def lanes(name: str, n: int) -> Any:
    """Return the robots of a scenario side by side, as stable-baselines3 expects them.

    Args:
        name: Name of the scenario.
        n: Number of robots, divided among the scenario's tasks.
    """
    needed("Training", "stable-baselines3", "stable_baselines3")
    from laticauda_gym import StableBaselines

    tasks = challenge(name).tasks
    n_each = n // len(tasks)
    envs: list[Any] = []
    for task in tasks:
        vector_env = SwimmingVectorEnv(n_each, task=task, autoreset_mode="SameStep")
        envs.append(StableBaselines(vector_env))
    if len(envs) == 1:
        return envs[0]
    return _side_by_side(envs)


def _side_by_side(envs: Sequence[Any]) -> Any:
    """Combine several vector environments into one."""
    from stable_baselines3.common.vec_env.base_vec_env import VecEnv

    class SideBySide(VecEnv):
        """All environments, one after the other."""

        def __init__(self) -> None:
            sizes = [env.num_envs for env in envs]
            self.ends = np.cumsum(sizes)[:-1]
            self.render_mode = None
            super().__init__(sum(sizes), envs[0].observation_space, envs[0].action_space)

        def seed(self, seed: int | None = None) -> list[int | None]:
            seeds: list[int | None] = []
            for env in envs:
                first = None
                if seed is not None:
                    first = seed + len(seeds)
                seeds += env.seed(first)
            return seeds

        def reset(self) -> np.ndarray:
            return np.concatenate([env.reset() for env in envs])

        def step_async(self, actions: np.ndarray) -> None:
            for env, actions_of_env in zip(envs, np.split(actions, self.ends), strict=True):
                env.step_async(actions_of_env)

        def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict[str, Any]]]:
            observations: list[np.ndarray] = []
            rewards: list[np.ndarray] = []
            done: list[np.ndarray] = []
            infos: list[dict[str, Any]] = []
            for env in envs:
                observation, reward, is_over, infos_of_env = env.step_wait()
                observations.append(observation)
                rewards.append(reward)
                done.append(is_over)
                infos += infos_of_env
            return (
                np.concatenate(observations),
                np.concatenate(rewards),
                np.concatenate(done),
                infos,
            )

        def close(self) -> None:
            for env in envs:
                env.close()

        def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
            return [getattr(self, attr_name) for _ in self._get_indices(indices)]

        def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
            raise NotImplementedError

        def env_method(
            self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any
        ) -> list[Any]:
            raise NotImplementedError

        def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
            return [False for _ in self._get_indices(indices)]

    return SideBySide()


def train(
    learner: str, name: str, seed: int, steps: int, folder: Path, tell: Callable[[str], None]
) -> dict[str, float]:
    """Train one run, from where it stopped.

    Args:
        learner: ppo or sac.
        name: Name of the scenario.
        seed: Seed of the run.
        steps: Total number of steps [-].
        folder: Folder in which the run is saved.
        tell: Called now and then with a line of text.

    Returns:
        Its `steps` and the `seconds` that they took.

    Raises:
        NotInstalled: If stable-baselines3 is not installed.
    """
    check_choice("learner", learner, tuple(SETTINGS))
    library = needed("Training", "stable-baselines3", "stable_baselines3")
    import torch
    from stable_baselines3.common.vec_env import VecNormalize

    torch.set_num_threads(1)
    learner_class: Any = getattr(library, learner.upper())
    run = folder / f"{learner}-{name}-{seed}"
    notes_file = run.with_suffix(".json")
    model_file = run.with_suffix(".zip")
    scale_file = run.with_suffix(".pkl")
    progress: dict[str, float] = {"steps": 0, "seconds": 0.0}
    if notes_file.exists():
        progress = json.loads(notes_file.read_text())
    if progress["steps"] >= steps:
        return progress
    envs = lanes(name, LANES[learner])
    if progress["steps"]:
        scaled = VecNormalize.load(str(scale_file), envs)
        model = learner_class.load(model_file, env=scaled, device="cpu")
    else:
        scaled = VecNormalize(envs, norm_obs=False, gamma=0.99)  # rewards only
        model = learner_class("MlpPolicy", scaled, seed=seed, device="cpu", **SETTINGS[learner])
    # Each run draws its own episodes, and one that is continued others than at its start. It comes
    # last because stable-baselines3 seeds the robots with `seed` alone when it makes or loads a
    # model.
    n_chunks = int(progress["steps"]) // CHUNK
    envs.seed(1_000_000 * (1 + seed) // 10 + 100 * n_chunks)
    while progress["steps"] < steps:
        began = time.perf_counter()
        steps_left = steps - int(progress["steps"])
        model.learn(min(CHUNK, steps_left), reset_num_timesteps=False)
        seconds = progress["seconds"] + time.perf_counter() - began
        progress = {"steps": int(model.num_timesteps), "seconds": seconds}
        model.save(model_file)
        scaled.save(str(scale_file))
        notes_file.write_text(json.dumps(progress))
        tell(f"{run.name}: {progress['steps']} steps in {progress['seconds']:.0f} s")
    envs.close()
    return progress


def weights(model_file: Path, learner: str) -> networks.Layers:
    """Return the layers of a trained policy, as arrays.

    Args:
        model_file: Path of the model, as saved by `train`.
        learner: ppo or sac.
    """
    library = needed("Training", "stable-baselines3", "stable_baselines3")
    policy: Any = getattr(library, learner.upper()).load(model_file, device="cpu").policy
    if learner == "ppo":
        modules = [*policy.mlp_extractor.policy_net, policy.action_net]
    else:
        modules = [*policy.actor.latent_pi, policy.actor.mu]
    layers: list[networks.Layer] = []
    for module in modules:
        if hasattr(module, "weight"):  # activations have none
            layer = networks.Layer(module.weight.detach().numpy(), module.bias.detach().numpy())
            layers.append(layer)
    return layers


def collect(learner: str, name: str, folder: Path, output: Path) -> int:
    """Write the policies of all saved runs, for scoring without torch, and return their number.

    Args:
        learner: ppo or sac.
        name: Name of the scenario.
        folder: Folder in which the runs are saved.
        output: Path of the .npz file.
    """
    files = sorted(folder.glob(f"{learner}-{name}-*.zip"))
    runs = [weights(file, learner) for file in files]
    if runs and learner == "ppo":
        networks.save(output, runs, "tanh", squash=False)
    elif runs:
        networks.save(output, runs, "relu", squash=True)
    return len(runs)
