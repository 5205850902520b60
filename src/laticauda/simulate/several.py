"""Several trials at once, of models that do not vectorize: in parallel on threads, or all robots in one scene."""

import math
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from threading import Event, local
from typing import Any, TypeVar, cast

from laticauda.dynamics.school import usable_cores
from laticauda.errors import BadArgument, check_instance
from laticauda.scenarios import Scenario, Spatial
from laticauda.simulate import plants, runner
from laticauda.simulate.runner import Progress, silent
from laticauda.trial import Trial

Result = TypeVar("Result")


class _Given(Exception):
    """Raised in a trial whose result is no longer needed."""


def swim_each(
    scenarios: Sequence[Scenario],
    use: Callable[[Trial], Result],
    *,
    threads: int | None = None,
    progress: Progress = silent,
) -> list[Result]:
    """Run every scenario, several at a time; the results are those of `swim`, whatever the number of threads.

    Args:
        scenarios: Scenarios of any model; those with the same robot, environment and model should
            be adjacent, because a thread keeps the last plant that it made.
        use: Called with every trial, in the thread that ran it; only its return value is kept.
        threads: Number of threads; None uses all cores that this process may use.
        progress: Called after every trial with the completed share, from 0 to 1.

    Returns:
        Return values of `use`, in the order of the scenarios.

    Raises:
        BadArgument: If a scenario cannot be run; the argument's name gives its index, and the
            others are abandoned.
    """
    own, is_over, results = local(), Event(), list[Result]()

    def watch(_: float) -> None:
        if is_over.is_set():
            raise _Given

    def swum(i: int) -> Result:
        one = scenarios[i]
        try:
            check_instance("", one, Scenario)
            parts = one.robot, one.environment, one.model
            if not all(
                part is kept
                for part, kept in zip(parts, getattr(own, "parts", [None] * 3), strict=True)
            ):
                own.plant, own.parts = plants.build_plant(one), parts
            return use(runner.run_scenario(one, own.plant, progress=watch))
        except BadArgument as bad:
            raise BadArgument(f"scenarios[{i}].{bad.name}".rstrip("."), bad.rule) from bad
        except Exception as error:
            error.add_note(f"This happened in scenarios[{i}].")
            raise

    with ThreadPoolExecutor(threads or usable_cores()) as pool:
        try:
            for result in pool.map(swum, range(len(scenarios))):
                results.append(result)
                progress(len(results) / len(scenarios))
        finally:
            is_over.set()
    return results


def swim_together(scenarios: Sequence[Scenario], *, progress: Progress = silent) -> list[Trial]:
    """Run several robots in one scene.

    All scenarios share one environment, one scene (`open` contains nothing else), one duration and
    one sample interval; robots, gaits, controllers, joint laws and starts may differ. The names of
    the second robot's bodies are prefixed with `robot_1_`, and so on, so that all robots may be the
    same.

    Args:
        scenarios: One for each robot, with the spatial model.
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
    from laticauda.spatial.school import Together

    check_instance("scenarios", scenarios, Sequence)
    for i, one in enumerate(scenarios):
        check_instance(f"scenarios[{i}].model", one.model, Spatial)
        if cast(Spatial, one.model).scene is None:
            raise BadArgument(f"scenarios[{i}].model", "must have a `scene`, such as `open`")
    bodies = [cast(Any, plants.build_plant(one)) for one in scenarios]
    for name in ("environment", "duration", "sample_interval", "scene", "gravity", "root"):
        of_all = zip(scenarios, bodies, strict=True)
        if (
            len({repr(getattr(one, name, getattr(body.settings, name, 0))) for one, body in of_all})
            != 1
        ):
            raise BadArgument(name, "must be the same for all robots in one scene")
    if len({one.controller.interval for one in scenarios} - {math.inf}) > 1:
        raise BadArgument("interval", "must be the same for all controllers in one scene")
    together = Together(bodies)
    return runner.run_all(
        scenarios, bodies, together.march, check=together.check, progress=progress
    )
