"""Train the learners: PPO and SAC of stable-baselines3, in episodes that are not scored. It needs stable-baselines3.

Every run is kept in a folder as it goes on, with the steps that it has had: the same command again goes on where it
stopped, and more steps go on from there. SAC does not keep its replay buffer, and fills a new one then.
"""

# pyright: reportMissingImports=false, reportUnknownVariableType=false, reportUnknownMemberType=false
# pyright: reportUnknownArgumentType=false, reportUntypedBaseClass=false, reportUnknownParameterType=false

import json
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from laticauda.errors import one_of
from laticauda_gym import SwimmingVectorEnv
from laticauda_gym.packages import needed
from laticauda_swimbench import networks
from laticauda_swimbench.challenges import challenge

SETTINGS: dict[str, dict[str, Any]] = {
    # Steps per robot and update, and a smaller spread at first, as in the comparison of path following.
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
"""Of stable-baselines3, where they are not its defaults; the same in all scenarios, and not tuned to any."""
LANES = {"ppo": 64, "sac": 32}
CHUNK = 51_200
"""Steps after which a run is kept."""


def lanes(name: str, n: int) -> Any:
    """The robots of a scenario side by side, as stable-baselines3 wants them.

    Args:
        name: Of the scenario.
        n: How many; shared out among its tasks.
    """
    needed("Training", "stable-baselines3", "stable_baselines3")
    from laticauda_gym import StableBaselines

    tasks = challenge(name).tasks
    shares = [
        StableBaselines(SwimmingVectorEnv(n // len(tasks), task=task, autoreset_mode="SameStep")) for task in tasks
    ]
    return shares[0] if len(shares) == 1 else _side_by_side(shares)


def _side_by_side(shares: Sequence[Any]) -> Any:
    """Several vector environments as one."""
    from stable_baselines3.common.vec_env.base_vec_env import VecEnv

    class SideBySide(VecEnv):
        """What each share does, one after the other."""

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

        def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> list[Any]:
            raise NotImplementedError

        def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
            return [False for _ in self._get_indices(indices)]

    return SideBySide()


def train(
    learner: str, name: str, seed: int, steps: int, folder: Path, tell: Callable[[str], None]
) -> dict[str, float]:
    """One run, from where it stopped.

    Args:
        learner: ppo or sac.
        name: Of the scenario.
        seed: Of the run.
        steps: In all [-].
        folder: Where the run is kept.
        tell: Called with a line now and then.

    Returns:
        Its `steps` and the `seconds` that they took.

    Raises:
        NotInstalled: If stable-baselines3 is not installed.
    """
    one_of("learner", learner, tuple(SETTINGS))
    library = needed("Training", "stable-baselines3", "stable_baselines3")
    import torch
    from stable_baselines3.common.vec_env import VecNormalize

    torch.set_num_threads(1)
    kind: Any = getattr(library, learner.upper())
    base = folder / f"{learner}-{name}-{seed}"
    notes, model_file, scale_file = (base.with_suffix(end) for end in (".json", ".zip", ".pkl"))
    said: dict[str, float] = json.loads(notes.read_text()) if notes.exists() else {"steps": 0, "seconds": 0.0}
    if said["steps"] >= steps:
        return said
    envs = lanes(name, LANES[learner])
    # A run that goes on draws other episodes than it began with.
    envs.seed(1_000_000 * (1 + seed) // 10 + int(said["steps"]) // CHUNK * 100)
    if said["steps"]:
        scaled = VecNormalize.load(str(scale_file), envs)
        model = kind.load(model_file, env=scaled, device="cpu")
    else:
        scaled = VecNormalize(envs, norm_obs=False, gamma=0.99)  # rewards only
        model = kind("MlpPolicy", scaled, seed=seed, device="cpu", **SETTINGS[learner])
    while said["steps"] < steps:
        begun = time.perf_counter()
        model.learn(min(CHUNK, steps - int(said["steps"])), reset_num_timesteps=False)
        said = {"steps": int(model.num_timesteps), "seconds": said["seconds"] + time.perf_counter() - begun}
        model.save(model_file)
        scaled.save(str(scale_file))
        notes.write_text(json.dumps(said))
        tell(f"{base.name}: {said['steps']} steps in {said['seconds']:.0f} s")
    envs.close()
    return said


def weights(model_file: Path, learner: str) -> networks.Layers:
    """The layers of a trained policy, as arrays.

    Args:
        model_file: As `train` keeps it.
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
    """Write the policies of all runs that are kept, for scoring without torch; how many there are.

    Args:
        learner: ppo or sac.
        name: Of the scenario.
        folder: Where the runs are kept.
        output: The .npz file.
    """
    files = sorted(folder.glob(f"{learner}-{name}-*.zip"))
    runs = [weights(file, learner) for file in files]
    if runs:
        networks.save(output, runs, "tanh" if learner == "ppo" else "relu", squash=learner == "sac")
    return len(runs)
