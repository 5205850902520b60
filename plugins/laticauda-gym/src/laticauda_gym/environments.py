"""Environments that Gymnasium makes: one with a single robot, one with many in lanes. Both use `Episodes`."""

# pyright: reportMissingTypeArgument=false, reportUnknownMemberType=false, reportUnknownVariableType=false
# pyright: reportIncompatibleMethodOverride=false, reportUnknownParameterType=false, reportUnknownArgumentType=false

from collections.abc import Mapping, Sequence
from typing import Any, TypeVar, get_type_hints

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.utils.seeding import np_random
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from laticauda import scenarios
from laticauda.values import BadArgument, check_choice, check_whole_number, codec
from laticauda_gym.episodes import BOUND, Episodes
from laticauda_gym.swimming import Swimming, swimmer
from laticauda_gym.tasks import Efficiency, PathFollowing, StationKeeping

TASKS: dict[str, type[Swimming]] = {
    task.__name__: task for task in (PathFollowing, Efficiency, StationKeeping)
}
TaskType = TypeVar("TaskType", bound=Swimming)
OF_SCENARIO = ("robot", "gait", "duration", *get_type_hints(scenarios.Changes))
"""Names of the scenario's arguments that may be given."""
NOT_BEGUN = "`reset` must be called before the first `step`."


def task_of(task: str | Swimming, settings: Mapping[str, Any]) -> Swimming:
    """Return a task from its name and its fields, or as it is.

    Args:
        task: The name, or the task itself.
        settings: Fields of the task; or, in place of its scenario, the arguments from which
            `swimmer` makes one.

    Raises:
        ValueError: If there is no such task or field, or a field is out of its range.
    """
    if isinstance(task, Swimming):
        if settings:
            raise BadArgument(
                "task", f"must be a name if its fields are given, got {task} and {set(settings)}"
            )
        return task
    return decoded(TASKS[check_choice("task", task, tuple(TASKS))], settings)


def decoded(kind: type[TaskType], settings: Mapping[str, Any]) -> TaskType:
    """Return a task from its fields.

    Args:
        kind: Class of the task.
        settings: As for `task_of`.

    Raises:
        ValueError: If there is no such field, or one is out of its range.
    """
    fields = {name: one for name, one in settings.items() if name not in OF_SCENARIO}
    if len(fields) < len(settings):
        if "scenario" in fields:
            raise BadArgument(
                "scenario", f"must not be given with {set(settings) & set(OF_SCENARIO)}"
            )
        fields["scenario"] = swimmer(
            **{name: one for name, one in settings.items() if name in OF_SCENARIO}
        )
    return codec.decode(kind, fields)


def spaces(task: Swimming) -> tuple[gymnasium.spaces.Box, gymnasium.spaces.Box]:
    """Return the spaces of the observations and of the actions of one robot.

    Args:
        task: Task of the robot.
    """
    n_numbers = len(task.sights) + len(task.reading_names)
    sees = gymnasium.spaces.Box(-BOUND, BOUND, (n_numbers,), np.float64)
    return sees, gymnasium.spaces.Box(-1.0, 1.0, (len(task.actions),), np.float64)


def checked(actions: object, shape: tuple[int, ...]) -> np.ndarray:
    """Return actions as an array.

    Args:
        actions: Actions as given.
        shape: Shape that they must have.

    Raises:
        ValueError: If they have another shape or are not finite.
    """
    try:
        numbers = np.asarray(actions, dtype=float)
    except (TypeError, ValueError):
        numbers = np.array(np.nan)
    if numbers.shape != shape or not np.isfinite(numbers).all():
        wrong = "one that is not finite" if numbers.shape == shape else f"shape {np.shape(numbers)}"
        raise BadArgument("action", f"must be finite numbers of shape {shape}, got {wrong}")
    return numbers


class _Tasked:
    """Episodes of a task, and pictures of the robots if the `render_mode` is rgb_array.

    Raises:
        ValueError: If the `render_mode` is another one.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"]}  # noqa: RUF012 - as Gymnasium expects
    render_mode: str | None
    _studio: Any = None

    def _set_up(
        self, task: Swimming, n: int, render_mode: str | None, threads: int | None = None
    ) -> None:
        if render_mode is not None:
            check_choice("render_mode", render_mode, self.metadata["render_modes"])
        self.task, self.episodes, self.render_mode = (
            task,
            Episodes(task, n, threads=threads),
            render_mode,
        )
        self.metadata = {**self.metadata, "render_fps": 1.0 / task.interval}

    def _picture(self, lane: int) -> np.ndarray | None:
        if self.render_mode is None:
            return None
        from laticauda.show.pictures import Studio, read_posture

        school = self.episodes.school
        self._studio = self._studio or Studio.of(school.plant)
        return self._studio.picture(read_posture(school.plant, school.state(lane)))

    def close_extras(self, **kwargs: Any) -> None:
        """Release the threads and the resources of the pictures; Gymnasium's `kwargs` have no effect here."""
        self.episodes.school.close()
        if self._studio is not None:
            self._studio.close()
            self._studio = None


class SwimmingEnv(_Tasked, gymnasium.Env):
    """One robot that performs a task.

    Args:
        task: `PathFollowing`, `Efficiency` or `StationKeeping`, or a task of your own.
        render_mode: rgb_array, or None for no pictures.
        settings: Fields of the task; or, in place of its scenario, the arguments from which
            `swimmer` makes one.

    Raises:
        ValueError: If an argument is out of its range.
    """

    def __init__(
        self,
        task: str | Swimming = "PathFollowing",
        *,
        render_mode: str | None = None,
        **settings: Any,
    ) -> None:
        self._set_up(task_of(task, settings), 1, render_mode)
        self.observation_space, self.action_space = spaces(self.task)
        self._has_begun = False

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin an episode.

        Args:
            seed: Seed of all draws from this episode on; None: continue the random sequence.
            options: Values of quantities that are not to be drawn, by their names in the task's
                `draws` [SI].

        Returns:
            The observation, and where the robot is, in SI units.

        Raises:
            ValueError: If an option is unknown or not a finite number.
        """
        super().reset(seed=seed)
        self.episodes.begin(np.array([True]), [self.np_random], options)
        self._has_begun = True
        return self.episodes.seen[0], self._info(0.0)

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Simulate one interval.

        Args:
            action: Action from -1 to 1 [-].

        Returns:
            Observation, reward, whether the motion has diverged, whether the time is up, and where
            the robot is.

        Raises:
            ValueError: If the action has another shape or is not finite.
        """
        if not self._has_begun:
            raise ResetNeeded(NOT_BEGUN)
        done = self.episodes.step(checked(action, self.action_space.shape or ())[np.newaxis])
        info = self._info(done.power.item())
        return (
            done.observation[0],
            done.reward.item(),
            done.terminated.item(),
            done.truncated.item(),
            info,
        )

    def render(self) -> np.ndarray | None:
        """Return a picture of the robot from the side: red, green and blue per pixel; None without a `render_mode`."""
        return self._picture(0)

    def close(self) -> None:
        """Release the resources of the pictures."""
        self.close_extras()

    def _info(self, power: float) -> dict[str, Any]:
        motion = self.episodes.motion
        return {
            "x": motion.x.item(),
            "y": motion.y.item(),
            "heading": motion.heading.item(),
            "power": power,
        }


class SwimmingVectorEnv(_Tasked, VectorEnv):
    """Many robots at the same task, side by side in one process.

    Lane i is seeded with seed + i, as in Gymnasium's own vector environments, and does what a
    single environment with that seed does, to the last bit.

    Args:
        num_envs: Number of robots.
        task: `PathFollowing`, `Efficiency` or `StationKeeping`, or a task of your own.
        autoreset_mode: When the next episode replaces one that is over: `NextStep`, `SameStep` or
            `Disabled`.
        threads: Number of threads that simulate them; None: one for planar robots, one per core for
            spatial ones.
        render_mode: rgb_array, or None for no pictures.
        settings: Fields of the task; or, in place of its scenario, the arguments from which
            `swimmer` makes one.

    Raises:
        ValueError: If an argument is out of its range.
    """

    def __init__(
        self,
        num_envs: int = 1,
        *,
        task: str | Swimming = "PathFollowing",
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int | None = None,
        render_mode: str | None = None,
        **settings: Any,
    ) -> None:
        mode = autoreset_mode.value if isinstance(autoreset_mode, AutoresetMode) else autoreset_mode
        self.autoreset_mode = AutoresetMode(
            check_choice("autoreset_mode", mode, [each.value for each in AutoresetMode])
        )
        self.num_envs = check_whole_number("num_envs", num_envs, 1)
        self._set_up(task_of(task, settings), self.num_envs, render_mode, threads)
        self.metadata["autoreset_mode"] = self.autoreset_mode
        self.single_observation_space, self.single_action_space = spaces(self.task)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._generators: list[np.random.Generator] = []
        self._observation: np.ndarray = np.zeros(0)
        self._is_over = np.full(self.num_envs, False)

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin an episode in every lane, or in those that ``options["reset_mask"]`` selects.

        Args:
            seed: One seed, to which lane i adds i, or one seed per lane; None: continue the random
                sequences.
            options: Values of quantities that are not to be drawn, by their names in the task's
                `draws` [SI], each one number or one per lane; and `reset_mask`, one boolean per
                lane.

        Returns:
            The observations, and where the robots are, in SI units.

        Raises:
            ValueError: If an argument is invalid.
        """
        given = dict(options or {})
        which = self._mask(given.pop("reset_mask", np.full(self.num_envs, True)))
        if not self._generators:
            if not which.all():
                raise ResetNeeded(NOT_BEGUN)
            self._generators = [np_random(None)[0] for _ in range(self.num_envs)]
        for lane, one in enumerate(self._seeds(seed)):
            if one is not None and which[lane]:
                self._generators[lane] = np_random(one)[0]
        self._begin(which, given)
        return self._observation.copy(), self._infos(np.zeros(self.num_envs))

    def step(
        self, actions: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Simulate one interval in every lane.

        Args:
            actions: Actions from -1 to 1, one row per lane [-].

        Returns:
            As for `SwimmingEnv`, with one row or entry per lane.

        Raises:
            ValueError: If the actions have another shape or are not finite, or an episode is over
                and the next one has not been started.
        """
        if not self._generators:
            raise ResetNeeded(NOT_BEGUN)
        waiting = self._is_over
        if self.autoreset_mode is AutoresetMode.DISABLED and waiting.any():
            lanes = np.flatnonzero(waiting).tolist()
            raise BadArgument(
                "reset", f"must be called with a `reset_mask` for the lanes that are over, {lanes}"
            )
        done = self.episodes.step(checked(actions, self.action_space.shape or ()))
        self._observation, infos = done.observation, {}
        reward, terminated, truncated = done.reward, done.terminated, done.truncated
        if self.autoreset_mode is AutoresetMode.SAME_STEP:
            self._is_over = terminated | truncated
            if self._is_over.any():
                infos = self._finals(done.power)
                self._begin(self._is_over, {})
        else:
            # In lanes whose episode was already over, the step does not count: it is their reset.
            reward, terminated, truncated = (
                np.where(waiting, 0, each) for each in (reward, terminated, truncated)
            )
            terminated, truncated = terminated.astype(bool), truncated.astype(bool)
            self._begin(waiting, {})
            self._is_over = terminated | truncated
        power = np.where(waiting, 0.0, done.power)
        return self._observation.copy(), reward, terminated, truncated, self._infos(power) | infos

    def render(self) -> tuple[np.ndarray | None, ...]:
        """Return a picture of every robot, as for `SwimmingEnv`."""
        return tuple(self._picture(lane) for lane in range(self.num_envs))

    def _begin(self, which: np.ndarray, given: Mapping[str, Any]) -> None:
        if which.any() or given:
            self.episodes.begin(which, self._generators, given)
            whole_school = which.all()
            seen = self.episodes.seen
            self._observation = (
                seen if whole_school else np.where(which[:, np.newaxis], seen, self._observation)
            )
            self._is_over = self._is_over & ~which

    def _finals(self, power: np.ndarray) -> dict[str, Any]:
        """Return what Gymnasium expects about episodes whose end is not in the observations."""
        over = self._is_over
        finals = np.full(self.num_envs, None, dtype=object)
        for lane in np.flatnonzero(over):
            finals[lane] = self._observation[lane].copy()
        return {
            "final_obs": finals,
            "_final_obs": over.copy(),
            "final_info": self._infos(power, over),
            "_final_info": over.copy(),
        }

    def _infos(self, power: np.ndarray, which: np.ndarray | None = None) -> dict[str, Any]:
        motion = self.episodes.motion
        infos: dict[str, Any] = {}
        for name, values in (
            ("x", motion.x),
            ("y", motion.y),
            ("heading", motion.heading),
            ("power", power),
        ):
            infos[name] = values.copy()
            infos[f"_{name}"] = np.full(self.num_envs, True) if which is None else which.copy()
        return infos

    def _mask(self, given: object) -> np.ndarray:
        if (
            not isinstance(given, np.ndarray)
            or given.dtype != bool
            or given.shape != (self.num_envs,)
        ):
            raise BadArgument(
                "reset_mask", f"must be an array of {self.num_envs} booleans, got {given!r}"
            )
        return given

    def _seeds(self, seed: int | Sequence[int | None] | None) -> Sequence[int | None]:
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, int | np.integer):
            return [int(seed) + lane for lane in range(self.num_envs)]
        if len(seed) != self.num_envs:
            raise BadArgument(
                "seed", f"must be one number, or one per lane ({self.num_envs}), got {len(seed)}"
            )
        return seed
