"""Interface to stable-baselines3: many robots in lanes, as the vector environment that its learners expect."""

# pyright: reportMissingImports=false, reportUnknownVariableType=false, reportUnknownMemberType=false
# pyright: reportUntypedBaseClass=false, reportUnknownArgumentType=false

from typing import Any

import numpy as np

from laticauda.values import BadArgument, check_instance
from laticauda_gym.environments import SwimmingVectorEnv
from laticauda_gym.packages import needed

needed("Learning with stable-baselines3", "stable-baselines3", "stable_baselines3")

from stable_baselines3.common.vec_env.base_vec_env import VecEnv  # noqa: E402 - report a missing package first


class StableBaselines(VecEnv):
    """An environment with many lanes, as stable-baselines3 sees it.

    Args:
        envs: Environment made with ``autoreset_mode="SameStep"``, the way in which
            stable-baselines3 goes from one episode to the next.

    Raises:
        ValueError: If it was made otherwise.
        NotInstalled: When this module is imported without stable-baselines3.

    Example:
        ``PPO("MlpPolicy", StableBaselines(SwimmingVectorEnv(64, autoreset_mode="SameStep")),
        seed=0)``
    """

    def __init__(self, envs: SwimmingVectorEnv) -> None:
        check_instance("envs", envs, SwimmingVectorEnv)
        if envs.autoreset_mode.value != "SameStep":
            advice = 'as in `SwimmingVectorEnv(64, autoreset_mode="SameStep")`'
            got = envs.autoreset_mode.value
            raise BadArgument("envs.autoreset_mode", f"must be `SameStep`, {advice}, got {got!r}")
        self.envs = envs
        self.render_mode = envs.render_mode
        super().__init__(envs.num_envs, envs.single_observation_space, envs.single_action_space)

    def reset(self) -> np.ndarray:
        """Begin an episode in every lane, with the seeds that `seed` has set."""
        observation, _ = self.envs.reset(seed=self._seeds)
        self._reset_seeds()
        return observation

    def step_async(self, actions: np.ndarray) -> None:
        """Take the `actions`, one row per lane."""
        self._actions = actions

    def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        """Simulate one interval; return observations, rewards, whether episodes are over, infos of those that are."""
        observation, reward, terminated, truncated, info = self.envs.step(self._actions)
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for lane in np.flatnonzero(terminated | truncated):
            infos[lane]["terminal_observation"] = info["final_obs"][lane]
            infos[lane]["TimeLimit.truncated"] = bool(truncated[lane])
        return observation, reward, terminated | truncated, infos

    def get_images(self) -> list[Any]:
        """Return a picture of every lane."""
        return list(self.envs.render())

    def close(self) -> None:
        """Release the threads."""
        self.envs.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute of the environment, which all lanes share. Arguments as for `VecEnv`."""
        return [getattr(self.envs, attr_name) for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Refused: lanes have no attributes of their own. Arguments as for `VecEnv`.

        Raises:
            ValueError: Always.
        """
        raise BadArgument(attr_name, "must be set when the environment is made: all lanes share it")

    def env_method(
        self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any
    ) -> list[Any]:
        """Refused, for the same reason. Arguments as for `VecEnv`.

        Raises:
            ValueError: Always.
        """
        raise BadArgument(
            method_name, "must be called on `envs`: its lanes are not separate environments"
        )

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """No lane is ever wrapped. Arguments as for `VecEnv`."""
        return [False for _ in self._get_indices(indices)]
