"""Episodes of one task in any number of lanes, and controllers that steer them; independent of Gymnasium.

Every lane has its own random number generator, so what happens in it depends only on its seed and
its actions: the n-th of many lanes does what a single lane with the same seed does.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from laticauda import robot
from laticauda.models.dynamics import Motion, School
from laticauda.models.simulate import school_of
from laticauda.scenarios import interfaces
from laticauda.values import BadArgument, check_choice, check_finite
from laticauda_gym.senses import SensesOfLanes, units_of_readings
from laticauda_gym.swimming import FLOW, Step, Swimming

BOUND = 10.0
"""Numbers of an observation are clipped at plus and minus this value; what a sensor does not tell is this value [-]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Outcome:
    """Result of a step, one entry per lane."""

    observation: Float[np.ndarray, "n n_observed"]
    """The task's `sights`, then what its sensors tell, in their units, clipped at `BOUND` [-]."""
    reward: Float[np.ndarray, " n"]
    """Rewards [-]."""
    terminated: Bool[np.ndarray, " n"]
    """Whether the motion has diverged."""
    truncated: Bool[np.ndarray, " n"]
    """Whether the episode's time is up."""
    power: Float[np.ndarray, " n"]
    """Mean power over the interval [W]."""


class Episodes:
    """Robots that perform a task, each in its own episode.

    Args:
        task: Task of the robots.
        n: Number of robots.
        threads: Number of threads that simulate them; None: one for planar robots, one per core for
            spatial ones.
        school: Kind of school that they form; None: each is in its own water.

    Raises:
        ValueError: If an argument is out of its range.
    """

    def __init__(
        self,
        task: Swimming,
        n: int,
        *,
        threads: int | None = None,
        school: type[School[Any]] | None = None,
    ) -> None:
        self.task = task
        make = school or school_of
        self.school = make(
            task.plant, interfaces.Command(gait=task.gait), n, task.interval, threads=threads
        )
        """The robots; its `plant` is the plant of each."""
        self.n = self.school.n
        """Number of lanes."""
        self._n_steps = np.zeros(n, dtype=int)
        self._drawn = {draw.name: np.zeros(n) for draw in task.draws}
        self._names_of_actions = [action.name for action in task.actions]
        self._sights = task.sights
        self._units = np.array([sight.unit for sight in self._sights])
        sensors = task.scenario.model.sensors
        self._units_of_readings = units_of_readings(sensors, task.reading_units)
        self._senses = SensesOfLanes(task.scenario, n)
        self.middle = np.array([0.5 * (action.low + action.high) for action in task.actions])
        """What actions of 0 command; steering adds to the gait's own offset."""
        self.middle += [
            task.gait.offset if action.name == "offset" else 0.0 for action in task.actions
        ]
        self.half = np.array([0.5 * (action.high - action.low) for action in task.actions])
        """What actions of 1 add."""

    @property
    def motion(self) -> Motion:
        """Motion of the robots now."""
        return self.school.motion

    @property
    def drawn(self) -> dict[str, Float[np.ndarray, " n"]]:
        """Quantities that the episodes have drawn, by name [SI]."""
        return {name: values.copy() for name, values in self._drawn.items()}

    @property
    def seen(self) -> Float[np.ndarray, "n n_observed"]:
        """Observations before anything has happened, for lanes whose episodes have just begun."""
        return self._observed(self._step(self.motion))

    def begin(
        self,
        which: Bool[np.ndarray, " n"],
        generators: Sequence[np.random.Generator],
        given: Mapping[str, Any] | None = None,
    ) -> None:
        """Begin another episode in some lanes.

        Args:
            which: Whether each lane begins one.
            generators: Random number generators, one per lane.
            given: Values of quantities that are not to be drawn, by name: one number, or one per
                lane [SI].

        Raises:
            ValueError: If the task draws no quantity of such a name, or a value is not a finite
                number.
        """
        fixed = self._fixed(given or {})
        lanes = np.flatnonzero(which)
        if lanes.size == 0:
            return
        draws = self.task.draws
        share = np.array([generators[lane].random(len(draws)) for lane in lanes.tolist()])
        for i, draw in enumerate(draws):
            if draw.name in fixed:
                values = fixed[draw.name][lanes]
            else:
                values = draw.at(share[:, i])
            self._drawn[draw.name][lanes] = values
        start = np.stack((self._drawn_in(lanes, "x"), self._drawn_in(lanes, "y")), axis=1)
        self.school.place(
            lanes,
            center_of_mass=self.task.origins(self.n)[lanes] + start,
            heading=self._drawn_in(lanes, "heading"),
            current=self._currents(lanes),
        )
        self._n_steps[lanes] = 0
        for lane in lanes.tolist():
            self._senses.begin(lane, self._water(lane), generators[lane])

    def _drawn_in(self, lanes: np.ndarray, name: str) -> np.ndarray:
        """Return what the episodes of some lanes have drawn; 0 for what they do not draw."""
        if name not in self._drawn:
            return np.zeros(lanes.size)
        return self._drawn[name][lanes]

    def _currents(self, lanes: np.ndarray) -> np.ndarray | list[robot.Current]:
        """Return the currents in some lanes: velocities in rows, or flows [m/s]."""
        if self.task.flow is not None:
            return [self._flow(lane) for lane in lanes.tolist()]
        speed = self._drawn_in(lanes, "current_speed")
        direction = self._drawn_in(lanes, "current_direction")
        return np.stack((speed * np.cos(direction), speed * np.sin(direction)), axis=1)

    def _water(self, lane: int) -> robot.Environment:
        """Return the water in a lane, with the current of its episode."""
        environment = self.task.scenario.environment
        if not isinstance(environment, robot.Water):
            return environment
        if self.task.flow is not None:
            return replace(environment, current=self._flow(lane))
        if "current_speed" not in self._drawn:
            return environment
        speed = self._drawn["current_speed"][lane].item()
        direction = self._drawn["current_direction"][lane].item()
        current = speed * math.cos(direction), speed * math.sin(direction)
        return replace(environment, current=current)

    def _flow(self, lane: int) -> robot.Current:
        """Return the current of the water in a lane."""
        numbers = {
            name: values[lane].item()
            for name, values in self._drawn.items()
            if name.startswith(FLOW)
        }
        return self.task.current(numbers)

    def step(self, actions: Float[np.ndarray, "n n_actions"]) -> Outcome:
        """Simulate one interval.

        Args:
            actions: Actions from -1 to 1; values outside are clipped [-].
        """
        commands = self.middle + self.half * np.clip(actions, -1.0, 1.0)
        self.school.tell(dict(zip(self._names_of_actions, commands.T, strict=True)))
        before = self.motion
        self.school.march()
        self._n_steps += 1
        step = self._step(before)
        failed = ~self.school.is_well
        return Outcome(
            observation=self._observed(step),
            reward=np.where(failed, self.task.failure_reward, self.task.reward(step)),
            terminated=failed,
            truncated=~failed & (self._n_steps >= self.task.n_steps),
            power=step.power,
        )

    def _step(self, before: Motion) -> Step:
        return Step(
            drawn=self._drawn, before=before, after=self.motion, interval=self.task.interval
        )

    def _observed(self, step: Step) -> np.ndarray:
        numbers = np.stack([sight.of(step) for sight in self._sights], axis=1) / self._units
        if self.task.reading_names:
            for lane in np.flatnonzero(self.school.is_well).tolist():
                self._senses.look(lane, self.school.observe(lane))
            readings = self._senses.values / self._units_of_readings
            readings = np.where(np.isnan(readings), BOUND, readings)
            numbers = np.concatenate((numbers, readings), axis=1)
        return np.clip(numbers, -BOUND, BOUND)

    def _fixed(self, given: Mapping[str, Any]) -> dict[str, np.ndarray]:
        fixed: dict[str, np.ndarray] = {}
        for name, value in given.items():
            check_choice("options", name, tuple(self._drawn))
            if np.shape(value) == (self.n,):
                numbers = [
                    check_finite(f"{name}[{lane}]", number) for lane, number in enumerate(value)
                ]
                fixed[name] = np.array(numbers)
            else:
                fixed[name] = np.full(self.n, check_finite(name, value))
        return fixed


class Pilots:
    """One controller per lane, each called at every step as `laticauda.run` would call it.

    Args:
        controller: Controller of every lane; the lanes do not share its state.
        episodes: Episodes of an environment, `env.unwrapped.episodes`; its robots are observed as
            in `laticauda.run`.

    Raises:
        ValueError: If the interval of the controller is not that of the task.
    """

    def __init__(self, controller: interfaces.Controller[Any], episodes: Episodes) -> None:
        interval = episodes.task.interval
        if abs(controller.interval - interval) > 1e-9:
            raise BadArgument(
                "controller.interval",
                f"must be the task's, {interval} s, got {controller.interval}",
            )
        self._controller = controller
        self._episodes = episodes
        self._states = [controller.init() for _ in range(episodes.n)]

    def actions(self) -> np.ndarray:
        """Return their next actions, one row per lane; in an episode that has just begun, the pilot's state is new."""
        episodes = self._episodes
        names = [action.name for action in episodes.task.actions]
        has_just_begun = episodes.motion.time == 0.0
        commands = np.zeros((episodes.n, len(names)))
        for lane in range(episodes.n):
            state = self._states[lane]
            if has_just_begun[lane]:
                state = self._controller.init()
            observation = episodes.school.observe(lane)
            self._states[lane], command = self._controller.step(state, observation)
            commands[lane] = [getattr(command.steered, name) for name in names]
        return (commands - episodes.middle) / episodes.half
