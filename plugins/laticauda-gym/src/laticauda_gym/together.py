"""Interface to PettingZoo: several robots in one scene, which see and touch one another, each a separate agent."""

# pyright: reportMissingImports=false, reportUnknownVariableType=false, reportUnknownMemberType=false
# pyright: reportUntypedBaseClass=false, reportUnknownArgumentType=false

import warnings
from typing import Any

import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.spaces import Box
from gymnasium.utils.seeding import np_random

from laticauda.values import BadArgument, check_whole_number
from laticauda_gym.abreast import OPEN, Abreast, OneScene
from laticauda_gym.environments import NOT_BEGUN, check_actions, make_spaces, make_task
from laticauda_gym.episodes import Episodes
from laticauda_gym.packages import needed

needed("Learning with PettingZoo", "pettingzoo")

from pettingzoo import ParallelEnv  # noqa: E402 - report a missing package first


class SwimmingParallelEnv(ParallelEnv):
    """Several robots that swim abreast in one scene; a PettingZoo parallel environment.

    Agents are `robot_0`, the rightmost one, `robot_1` and so on. They begin and end at the same
    time: if one of them diverges, the episode is over for all.

    Args:
        n_robots: Number of robots.
        task: Task of the robots; None: `Abreast` with the `settings`.
        settings: Fields of the task; or, in place of its scenario, the arguments from which
            `swimmer` makes one.

    Raises:
        ValueError: If an argument is out of its range.
    """

    metadata: dict[str, Any] = {"name": "laticauda_abreast_v0", "render_modes": []}  # noqa: RUF012 - for PettingZoo

    def __init__(self, n_robots: int = 3, *, task: Abreast | None = None, **settings: Any) -> None:
        n = check_whole_number("n_robots", n_robots, 2)
        if task is not None and settings:
            raise BadArgument(
                "task", f"must be None if its fields are given, got {task} and {set(settings)}"
            )
        if task is None:
            if "scenario" not in settings:
                settings = {"model": OPEN} | settings
            task = make_task(Abreast, settings)
        self.task = task
        self.episodes = Episodes(self.task, n, school=OneScene)
        self.possible_agents = [f"robot_{i}" for i in range(n)]
        self.agents: list[str] = []
        self.render_mode = None
        spaces = make_spaces(self.task)
        self.observation_spaces = dict.fromkeys(self.possible_agents, spaces.observations)
        self.action_spaces = dict.fromkeys(self.possible_agents, spaces.actions)
        self._generators: list[np.random.Generator] = []

    def observation_space(self, agent: str) -> Box:
        """Return the observation space of an `agent`, which is the same for all."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> Box:
        """Return the action space of an `agent`, which is the same for all."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, np.ndarray], dict[str, dict[str, Any]]]:
        """Begin an episode.

        Args:
            seed: Seed of all draws from this episode on; None: continue the random sequence.
            options: Values of quantities that are not to be drawn, by their names in the task's
                `draws`, one number or one per robot [SI]; others are ignored with a warning,
                because PettingZoo's own test passes some.

        Returns:
            Observations, and where the robots are, in SI units; by agent.

        Raises:
            ValueError: If an option is not a finite number, or robots would overlap at the start.
        """
        if seed is not None or not self._generators:
            self._generators = np_random(seed)[0].spawn(self.episodes.n)
        fixed = {
            draw.name: draw.at(self._generators[0].random(1)).item() for draw in self.task.shared
        }
        for name, option in (options or {}).items():
            if name in self.episodes.drawn:
                fixed[name] = option
            else:
                warnings.warn(
                    f"`options` has {name!r}, which no episode draws; it is ignored", stacklevel=2
                )
        self.episodes.begin(np.full(self.episodes.n, True), self._generators, fixed)
        self.agents = list(self.possible_agents)
        return self._by_agent(self.episodes.seen), self._infos(np.zeros(self.episodes.n))

    def step(self, actions: dict[str, np.ndarray]) -> tuple[dict[str, Any], ...]:
        """Simulate one interval.

        Args:
            actions: Actions from -1 to 1, by agent [-].

        Returns:
            Observations, rewards, whether the motion has diverged, whether the time is up, and
            where the robots are; by agent.

        Raises:
            ValueError: If an action is missing, has another shape, or is not finite.
        """
        if not self.agents:
            raise ResetNeeded(NOT_BEGUN)
        missing = [agent for agent in self.agents if agent not in actions]
        if missing:
            raise BadArgument(
                "actions", f"must have an action for each agent, got none for {missing}"
            )
        shape = self.action_spaces[self.agents[0]].shape
        rows = [check_actions(actions[agent], shape) for agent in self.agents]
        outcome = self.episodes.step(np.stack(rows))
        if outcome.terminated.any() or outcome.truncated.any():
            self.agents = []
        return (
            self._by_agent(outcome.observation),
            self._by_agent(outcome.reward.tolist()),
            self._by_agent(outcome.terminated.tolist()),
            self._by_agent(outcome.truncated.tolist()),
            self._infos(outcome.power),
        )

    def render(self) -> None:
        """Draw nothing."""

    def close(self) -> None:
        """Release the threads."""
        self.episodes.school.close()

    def _by_agent(self, values: Any) -> dict[str, Any]:
        return dict(zip(self.possible_agents, values, strict=True))

    def _infos(self, power: np.ndarray) -> dict[str, dict[str, Any]]:
        motion = self.episodes.motion
        infos: list[dict[str, Any]] = []
        for i in range(self.episodes.n):
            info = {
                "x": motion.x[i].item(),
                "y": motion.y[i].item(),
                "heading": motion.heading[i].item(),
                "power": power[i].item(),
            }
            infos.append(info)
        return self._by_agent(infos)


parallel_env = SwimmingParallelEnv
"""Name of the environment in any PettingZoo module."""
