"""Several trials at once, of models that do not vectorize: each alone on a thread, or all robots in one scene.

`swim_each` runs independent trials side by side; `swim_together` puts their robots into one scene,
where they meet.
"""

import math
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from threading import Event, local
from typing import Any, Generic, TypeVar, cast

from laticauda.models.dynamics.plant import Plant
from laticauda.models.dynamics.school import usable_cores
from laticauda.models.simulate import plants, runner
from laticauda.models.simulate.runner import Progress, silent
from laticauda.scenarios import Scenario, Spatial
from laticauda.trials import Trial
from laticauda.values import BadArgument, check_instance

Result = TypeVar("Result")

SAME_IN_ONE_SCENE = ("environment", "duration", "sample_interval", "scene", "gravity", "root")
"""Fields of scenarios and their models that robots in one scene share."""


class _Abandoned(Exception):
    """Raised in a trial whose result is no longer needed."""


def swim_each(
    scenarios: Sequence[Scenario],
    use: Callable[[Trial], Result],
    *,
    link_forces: bool = False,
    threads: int | None = None,
    progress: Progress = silent,
) -> list[Result]:
    """Run every scenario, several at a time; the results are those of `swim`, whatever the number of threads.

    Args:
        scenarios: Scenarios of any model; those with the same robot, environment and model should
            be adjacent, because a thread keeps the last plant that it made.
        use: Called with every trial, in the thread that ran it; only its return value is kept.
        link_forces: Whether the trials have the force on every link, and what every joint carries.
        threads: Number of threads; None uses all cores that this process may use.
        progress: Called after every trial with the completed share, from 0 to 1.

    Returns:
        Return values of `use`, in the order of the scenarios.

    Raises:
        BadArgument: If a scenario cannot be run; the argument's name gives its index, and the
            others are abandoned.
    """
    results: list[Result] = []
    runs = _ParallelRuns(scenarios, use, link_forces=link_forces)
    with ThreadPoolExecutor(threads or usable_cores()) as pool:
        try:
            for result in pool.map(runs.run, range(len(scenarios))):
                results.append(result)
                progress(len(results) / len(scenarios))
        finally:
            runs.is_over.set()
    return results


class _ParallelRuns(Generic[Result]):
    """Scenarios that threads run, each with the last plant it made.

    Args:
        scenarios: The scenarios.
        use: Called with every trial.
        link_forces: Whether the trials have loads.
    """

    def __init__(
        self, scenarios: Sequence[Scenario], use: Callable[[Trial], Result], *, link_forces: bool
    ) -> None:
        self.scenarios = scenarios
        self.use = use
        self.link_forces = link_forces
        self.is_over = Event()
        """Set when no more results are needed."""
        self._of_thread = local()

    def run(self, i: int) -> Result:
        """Run scenario `i`, and return what `use` makes of its trial."""
        scenario = self.scenarios[i]
        try:
            check_instance("", scenario, Scenario)
            plant = self._plant_of(scenario)
            trial = runner.run_scenario(
                scenario, plant, link_forces=self.link_forces, progress=self._stop_if_over
            )
            return self.use(trial)
        except BadArgument as error:
            name = f"scenarios[{i}].{error.name}".rstrip(".")
            raise BadArgument(name, error.rule) from error
        except Exception as error:
            error.add_note(f"This happened in scenarios[{i}].")
            raise

    def _plant_of(self, scenario: Scenario) -> Plant[Any]:
        """Return the plant of this thread's last scenario if that had the same objects, else a new one."""
        last: Scenario | None = getattr(self._of_thread, "scenario", None)
        is_same = (
            last is not None
            and scenario.robot is last.robot
            and scenario.environment is last.environment
            and scenario.model is last.model
        )
        if not is_same:
            self._of_thread.plant = plants.plant_of_scenario(scenario)
            self._of_thread.scenario = scenario
        return self._of_thread.plant

    def _stop_if_over(self, _: float) -> None:
        if self.is_over.is_set():
            raise _Abandoned


def swim_together(
    scenarios: Sequence[Scenario], *, link_forces: bool = False, progress: Progress = silent
) -> list[Trial]:
    """Run several robots in one scene.

    All scenarios share one environment, one scene (`open` contains nothing else), one duration and
    one sample interval; robots, gaits, controllers, joint laws and starts may differ. The names of
    the second robot's bodies are prefixed with `robot_1_`, and so on, so that all robots may be the
    same.

    Args:
        scenarios: One for each robot, with the spatial model.
        link_forces: Whether to log the force on every link, and what every joint carries, as well.
        progress: Called repeatedly with the time reached [s].

    Returns:
        A trial for each robot; contacts with other robots are among its contact forces. Rays do not
        see other robots.

    Raises:
        ValueError: If the robots cannot share one scene, or overlap at the start.

    Example:
        >>> import laticauda as lc
        >>> gait = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
        >>> def one(y):
        ...     start = lc.Start(center_of_mass=(0.0, y))
        ...     return lc.build_scenario("mamba", gait, 1.0, model="spatial", scene="open", start=start)
        >>> [len(trial.time) for trial in lc.swim_together([one(0.0), one(0.5)])]
        [21, 21]
    """
    from laticauda.models.spatial.school import Together

    check_instance("scenarios", scenarios, Sequence)
    for i, scenario in enumerate(scenarios):
        check_instance(f"scenarios[{i}].model", scenario.model, Spatial)
        if cast(Spatial, scenario.model).scene is None:
            raise BadArgument(f"scenarios[{i}].model", "must have a `scene`, such as `open`")
    bodies = [cast(Any, plants.build_plant(scenario)) for scenario in scenarios]
    _check_same_scene(scenarios, bodies)
    together = Together(bodies)
    march = partial(together.march, link_forces=link_forces)
    return runner.run_all(scenarios, bodies, march, check=together.check, progress=progress)


def _check_same_scene(scenarios: Sequence[Scenario], bodies: Sequence[Plant[Any]]) -> None:
    """Reject robots that cannot share one scene."""
    for name in SAME_IN_ONE_SCENE:
        values: set[str] = set()
        for scenario, body in zip(scenarios, bodies, strict=True):
            setting = getattr(body.settings, name, 0)
            values.add(repr(getattr(scenario, name, setting)))
        if len(values) != 1:
            raise BadArgument(name, "must be the same for all robots in one scene")
    intervals = {scenario.controller.interval for scenario in scenarios} - {math.inf}
    if len(intervals) > 1:
        raise BadArgument("scenarios", "must have controllers of the same `interval` in one scene")
