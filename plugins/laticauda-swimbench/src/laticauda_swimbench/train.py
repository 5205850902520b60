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
    shares = [
        StableBaselines(SwimmingVectorEnv(n // len(tasks), task=task, autoreset_mode="SameStep"))
        for task in tasks
    ]
    return shares[0] if len(shares) == 1 else _side_by_side(shares)


def _side_by_side(shares: Sequence[Any]) -> Any:
    """Combine several vector environments into one."""
    from stable_baselines3.common.vec_env.base_vec_env import VecEnv

    class SideBySide(VecEnv):
        """All shares, one after the other."""

        def __init__(self) -> None:
            self.ends = np.cumsum([one.num_envs for one in shares])[:-1]
            n = sum(one.num_envs for one in shares)
            self.render_mode = None
            super().__init__(n, shares[0].observation_space, shares[0].action_space)

        def seed(self, seed: int | None = None) -> list[int | None]:
            found: list[int | None] = []
            for one in shares:
                found += one.seed(None if seed is None else seed + len(found))
            return found

        def reset(self) -> np.ndarray:
            return np.concatenate([one.reset() for one in shares])

        def step_async(self, actions: np.ndarray) -> None:
            for one, mine in zip(shares, np.split(actions, self.ends), strict=True):
                one.step_async(mine)

        def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict[str, Any]]]:
            seen, rewards, done, infos = zip(*[one.step_wait() for one in shares], strict=True)
            return (
                np.concatenate(seen),
                np.concatenate(rewards),
                np.concatenate(done),
                [i for one in infos for i in one],
            )

        def close(self) -> None:
            for one in shares:
                one.close()

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
    kind: Any = getattr(library, learner.upper())
    base = folder / f"{learner}-{name}-{seed}"
    notes, model_file, scale_file = (base.with_suffix(end) for end in (".json", ".zip", ".pkl"))
    said: dict[str, float] = (
        json.loads(notes.read_text()) if notes.exists() else {"steps": 0, "seconds": 0.0}
    )
    if said["steps"] >= steps:
        return said
    envs = lanes(name, LANES[learner])
    if said["steps"]:
        scaled = VecNormalize.load(str(scale_file), envs)
        model = kind.load(model_file, env=scaled, device="cpu")
    else:
        scaled = VecNormalize(envs, norm_obs=False, gamma=0.99)  # rewards only
        model = kind("MlpPolicy", scaled, seed=seed, device="cpu", **SETTINGS[learner])
    # Each run draws its own episodes, and one that is continued others than at its start. It comes
    # last because stable-baselines3 seeds the robots with `seed` alone when it makes or loads a
    # model.
    envs.seed(1_000_000 * (1 + seed) // 10 + int(said["steps"]) // CHUNK * 100)
    while said["steps"] < steps:
        begun = time.perf_counter()
        model.learn(min(CHUNK, steps - int(said["steps"])), reset_num_timesteps=False)
        said = {
            "steps": int(model.num_timesteps),
            "seconds": said["seconds"] + time.perf_counter() - begun,
        }
        model.save(model_file)
        scaled.save(str(scale_file))
        notes.write_text(json.dumps(said))
        tell(f"{base.name}: {said['steps']} steps in {said['seconds']:.0f} s")
    envs.close()
    return said


def weights(model_file: Path, learner: str) -> networks.Layers:
    """Return the layers of a trained policy, as arrays.

    Args:
        model_file: Path of the model, as saved by `train`.
        learner: ppo or sac.
    """
    library = needed("Training", "stable-baselines3", "stable_baselines3")
    policy: Any = getattr(library, learner.upper()).load(model_file, device="cpu").policy
    parts = (
        [*policy.mlp_extractor.policy_net, policy.action_net]
        if learner == "ppo"
        else [*policy.actor.latent_pi, policy.actor.mu]
    )
    linear = [part for part in parts if hasattr(part, "weight")]
    return [(part.weight.detach().numpy(), part.bias.detach().numpy()) for part in linear]


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
    if runs:
        networks.save(output, runs, "tanh" if learner == "ppo" else "relu", squash=learner == "sac")
    return len(runs)
