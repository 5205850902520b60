"""Environments that Gymnasium makes: one with a single robot, one with many in lanes. Both use `Episodes`."""

# pyright: reportMissingTypeArgument=false, reportUnknownMemberType=false, reportUnknownVariableType=false
# pyright: reportIncompatibleMethodOverride=false, reportUnknownParameterType=false, reportUnknownArgumentType=false

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, TypeVar, get_type_hints

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
    task_class = TASKS[check_choice("task", task, tuple(TASKS))]
    return make_task(task_class, settings)


def make_task(kind: type[TaskType], settings: Mapping[str, Any]) -> TaskType:
    """Return a task from its fields.

    Args:
        kind: Class of the task.
        settings: As for `task_of`.

    Raises:
        ValueError: If there is no such field, or one is out of its range.
    """
    fields = {name: value for name, value in settings.items() if name not in OF_SCENARIO}
    of_scenario = {name: value for name, value in settings.items() if name in OF_SCENARIO}
    if of_scenario:
        if "scenario" in fields:
            raise BadArgument("scenario", f"must not be given with {set(of_scenario)}")
        fields["scenario"] = swimmer(**of_scenario)
    return codec.decode(kind, fields)


class Spaces(NamedTuple):
    """The spaces of one robot."""

    observations: gymnasium.spaces.Box
    """Observations, within `BOUND`."""
    actions: gymnasium.spaces.Box
    """Actions, from -1 to 1."""


def make_spaces(task: Swimming) -> Spaces:
    """Return the spaces of the observations and of the actions of one robot.

    Args:
        task: Task of the robot.
    """
    n_observed = len(task.sights) + len(task.reading_names)
    n_actions = len(task.actions)
    return Spaces(
        observations=gymnasium.spaces.Box(-BOUND, BOUND, (n_observed,), np.float64),
        actions=gymnasium.spaces.Box(-1.0, 1.0, (n_actions,), np.float64),
    )


def check_actions(actions: object, shape: tuple[int, ...]) -> np.ndarray:
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
    rule = f"must be finite numbers of shape {shape}"
    if numbers.shape != shape:
        raise BadArgument("action", f"{rule}, got shape {numbers.shape}")
    if not np.isfinite(numbers).all():
        raise BadArgument("action", f"{rule}, got one that is not finite")
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
        self.task = task
        self.episodes = Episodes(task, n, threads=threads)
        self.render_mode = render_mode
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
        spaces = make_spaces(self.task)
        self.observation_space = spaces.observations
        self.action_space = spaces.actions
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
        actions = check_actions(action, self.action_space.shape or ())[np.newaxis]
        outcome = self.episodes.step(actions)
        return (
            outcome.observation[0],
            outcome.reward.item(),
            outcome.terminated.item(),
            outcome.truncated.item(),
            self._info(outcome.power.item()),
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
        self.autoreset_mode = _check_mode(autoreset_mode)
        self.num_envs = check_whole_number("num_envs", num_envs, 1)
        self._set_up(task_of(task, settings), self.num_envs, render_mode, threads)
        self.metadata["autoreset_mode"] = self.autoreset_mode
        spaces = make_spaces(self.task)
        self.single_observation_space = spaces.observations
        self.single_action_space = spaces.actions
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
        fixed = dict(options or {})
        which = self._check_mask(fixed.pop("reset_mask", np.full(self.num_envs, True)))
        if not self._generators:
            if not which.all():
                raise ResetNeeded(NOT_BEGUN)
            self._generators = [np_random(None)[0] for _ in range(self.num_envs)]
        for lane, seed_of_lane in enumerate(self._seeds(seed)):
            if seed_of_lane is not None and which[lane]:
                self._generators[lane] = np_random(seed_of_lane)[0]
        self._begin(which, fixed)
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
        was_over = self._is_over
        if self.autoreset_mode is AutoresetMode.DISABLED and was_over.any():
            lanes = np.flatnonzero(was_over).tolist()
            raise BadArgument(
                "reset", f"must be called with a `reset_mask` for the lanes that are over, {lanes}"
            )
        outcome = self.episodes.step(check_actions(actions, self.action_space.shape or ()))
        self._observation = outcome.observation
        reward = outcome.reward
        terminated = outcome.terminated
        truncated = outcome.truncated
        finals: dict[str, Any] = {}
        if self.autoreset_mode is AutoresetMode.SAME_STEP:
            self._is_over = terminated | truncated
            if self._is_over.any():
                finals = self._finals(outcome.power)
                self._begin(self._is_over, {})
        else:
            # In lanes whose episode was already over, the step does not count: it is their reset.
            reward = np.where(was_over, 0, reward)
            terminated = terminated & ~was_over
            truncated = truncated & ~was_over
            self._begin(was_over, {})
            self._is_over = terminated | truncated
        power = np.where(was_over, 0.0, outcome.power)
        infos = self._infos(power) | finals
        return self._observation.copy(), reward, terminated, truncated, infos

    def render(self) -> tuple[np.ndarray | None, ...]:
        """Return a picture of every robot, as for `SwimmingEnv`."""
        return tuple(self._picture(lane) for lane in range(self.num_envs))

    def _begin(self, which: np.ndarray, fixed: Mapping[str, Any]) -> None:
        if not which.any() and not fixed:
            return
        self.episodes.begin(which, self._generators, fixed)
        observation = self.episodes.seen
        if not which.all():
            observation = np.where(which[:, np.newaxis], observation, self._observation)
        self._observation = observation
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
        if which is None:
            which = np.full(self.num_envs, True)
        motion = self.episodes.motion
        columns = {"x": motion.x, "y": motion.y, "heading": motion.heading, "power": power}
        infos: dict[str, Any] = {}
        for name, values in columns.items():
            infos[name] = values.copy()
            infos[f"_{name}"] = which.copy()
        return infos

    def _check_mask(self, mask: object) -> np.ndarray:
        is_array = isinstance(mask, np.ndarray)
        if is_array and mask.dtype == bool and mask.shape == (self.num_envs,):
            return mask
        rule = f"must be an array of {self.num_envs} booleans"
        raise BadArgument("reset_mask", f"{rule}, got {mask!r}")

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


def _check_mode(mode: AutoresetMode | str) -> AutoresetMode:
    if isinstance(mode, AutoresetMode):
        return mode
    names = [known_mode.value for known_mode in AutoresetMode]
    return AutoresetMode(check_choice("autoreset_mode", mode, names))
