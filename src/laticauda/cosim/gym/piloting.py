"""Controllers as policies: line of sight, or any other `Controller` that steers, at the helm of every lane."""

from typing import Any

import numpy as np

from laticauda.cosim.gym.episodes import Episodes
from laticauda.errors import BadArgument
from laticauda.interfaces import Command, Controller


class Pilots:
    """One controller per lane, each asked at every step, as `laticauda.run` would ask it.

    Args:
        controller: What decides; the lanes do not share its state.
        episodes: Of an environment, `env.unwrapped.episodes`; its robots are looked at as `laticauda.run` does.

    Raises:
        ValueError: If its control interval is not that of the task.
    """

    def __init__(self, controller: Controller[Any], episodes: Episodes) -> None:
        interval = episodes.task.interval
        if abs(controller.interval - interval) > 1e-9:
            raise BadArgument("controller.interval", f"must be the task's, {interval} s, got {controller.interval}")
        self._controller, self._episodes = controller, episodes
        self._thoughts = [controller.init() for _ in range(episodes.n)]

    def actions(self) -> np.ndarray:
        """What they ask for now, one row per lane; in an episode that has just begun the pilot knows nothing yet."""
        time = self._episodes.motion.time
        asked = np.zeros((self._episodes.n, len(self._episodes.task.actions)))
        for lane in range(self._episodes.n):
            thought = self._controller.init() if time[lane] == 0.0 else self._thoughts[lane]
            self._thoughts[lane], command = self._controller.step(thought, self._episodes.observe(lane))
            asked[lane] = self._action(command)
        return asked

    def _action(self, command: Command) -> list[float]:
        """A command as an action, which cannot ask for more than the task lets it."""
        action: list[float] = []
        task = self._episodes.task
        for each in task.actions:
            value = (
                command.offset + command.gait.offset - task.gait.offset
                if each.name == "offset"
                else getattr(command.gait, each.name)
            )
            action.append((value - 0.5 * (each.low + each.high)) / (0.5 * (each.high - each.low)))
        return action
