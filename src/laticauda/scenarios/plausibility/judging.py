"""Everything that is odd about a scenario; what was judged once is not judged again."""

import weakref
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar
from typing import Any, Generic, TypeVar

from laticauda.motion.gaits import Gait, JointAngles, was_doubted
from laticauda.robot import Environment, Robot
from laticauda.scenarios.interfaces import Start
from laticauda.scenarios.plausibility.bodies import judge_body
from laticauda.scenarios.plausibility.doubts import Doubt
from laticauda.scenarios.plausibility.motions import judge_gait, judge_gait_of_robot
from laticauda.scenarios.plausibility.motors import judge_mounted
from laticauda.scenarios.plausibility.recordings import judge_angles, judge_times
from laticauda.scenarios.plausibility.runs import judge_model, judge_start
from laticauda.scenarios.plausibility.telling import warn_of_doubt
from laticauda.scenarios.plausibility.waters import judge_environment, judge_own_coefficients
from laticauda.scenarios.scenario import Scenario

Judged = TypeVar("Judged")

_IS_LIMIT_CASE: ContextVar[bool] = ContextVar("is_limit_case", default=False)


def limit_case() -> AbstractContextManager[None]:
    """Judge nothing in this block: for what cannot be and is wanted nevertheless, such as a run in a vacuum.

    Example:
        >>> import laticauda as lc
        >>> with limit_case():
        ...     thin = lc.Water(density=1e-6, tangential_friction=0.0, normal_drag=0.0, added_mass=0.0)
        ...     plant = lc.build_plant("mamba", thin)
    """
    return _judging_nothing()


@contextmanager
def _judging_nothing() -> Generator[None]:
    token = _IS_LIMIT_CASE.set(True)
    try:
        yield
    finally:
        _IS_LIMIT_CASE.reset(token)


class _Memory(Generic[Judged]):
    """Doubts about objects by their identity: values never change, and comparing them would take longer.

    Args:
        judge: Yields the doubts about an object.
    """

    def __init__(self, judge: Callable[[Judged], Iterable[Doubt]]) -> None:
        self._judge = judge
        self._doubts: dict[int, tuple[weakref.ref[Any], tuple[Doubt, ...]]] = {}

    def doubts_of(self, judged: Judged) -> tuple[Doubt, ...]:
        """Return the doubts about an object.

        Args:
            judged: The object.
        """
        key = id(judged)
        entry = self._doubts.get(key)
        if entry is not None and entry[0]() is judged:
            return entry[1]
        doubts = tuple(self._judge(judged))
        forget = self._doubts.pop
        self._doubts[key] = (weakref.ref(judged, lambda _: forget(key, None)), doubts)
        return doubts


def _judge_robot(robot: Robot) -> Iterator[Doubt]:
    yield from judge_body(robot)
    yield from judge_mounted(robot)
    yield from judge_own_coefficients(robot)


_ROBOTS = _Memory[Robot](_judge_robot)
_ENVIRONMENTS = _Memory[Environment](judge_environment)
_GAITS = _Memory[Gait](judge_gait)
_RECORDINGS = _Memory[JointAngles](judge_angles)


def judge_described(robot: Robot, environment: Environment | None = None) -> Iterator[Doubt]:
    """Yield what is odd about a robot, and about what it swims in.

    Args:
        robot: The robot.
        environment: Water or ground; None: not known.
    """
    yield from _ROBOTS.doubts_of(robot)
    if environment is not None:
        yield from _ENVIRONMENTS.doubts_of(environment)


def judge_scenario(scenario: Scenario) -> Iterator[Doubt]:
    """Yield everything that is odd about a scenario.

    Args:
        scenario: The scenario.
    """
    robot = scenario.robot
    gait = scenario.gait
    yield from judge_described(robot, scenario.environment)
    if not was_doubted(gait):
        yield from _GAITS.doubts_of(gait)
    yield from judge_gait_of_robot(robot, gait)
    if gait.recorded is not None:
        yield from judge_times(gait.recorded, scenario.duration)
        yield from _RECORDINGS.doubts_of(gait.recorded)
    if isinstance(scenario.start, Start):
        yield from judge_start(robot, scenario.start)
    yield from judge_model(robot, scenario.model)


def check_plausible(scenario: Scenario, before: Scenario | None = None) -> None:
    """Refuse a scenario with something in it that cannot be, and warn of what hardly is.

    Args:
        scenario: The scenario.
        before: The scenario that it was changed from: what hardly was in it is not said again.

    Raises:
        ValueError: If something cannot be.
    """
    doubts = list(judge_scenario(scenario))
    if doubts and before is not None:
        names_before = {doubt.name for doubt in judge_scenario(before)}
        doubts = [doubt for doubt in doubts if doubt.refuses or doubt.name not in names_before]
    _settle(doubts)


def check_many(scenarios: Sequence[Scenario]) -> None:
    """Do the same for many scenarios: every robot, water and recording, and the extremes of gaits and starts.

    Args:
        scenarios: The scenarios.

    Raises:
        ValueError: If something cannot be.
    """
    doubts: dict[str, Doubt] = {}
    for scenario in _extremes(scenarios):
        for doubt in judge_scenario(scenario):
            if doubt.refuses or doubt.name not in doubts:
                doubts[doubt.name] = doubt
    _settle(doubts.values())


EXTREMES_OF_GAITS: tuple[Callable[[Gait], float], ...] = (
    lambda gait: gait.amplitude,
    lambda gait: gait.frequency,
    lambda gait: abs(gait.phase_shift),
)
"""Numbers whose largest is judged; batches may begin at little."""
EXTREMES_OF_STARTS: tuple[Callable[[object], float], ...] = (
    lambda start: abs(getattr(start, "heading", 0.0)),
    lambda start: abs(getattr(start, "velocity", 0.0)),
)
"""The same of starts, which most batches have in common."""


def _extremes(scenarios: Sequence[Scenario]) -> Iterable[Scenario]:
    """Return scenarios that have everything between them that could be odd."""
    gaits = [scenario.gait for scenario in scenarios]
    starts = [scenario.start for scenario in scenarios]
    chosen = {
        *_first_of_each([scenario.robot for scenario in scenarios]),
        *_first_of_each([scenario.environment for scenario in scenarios]),
        *_first_of_each([scenario.model for scenario in scenarios]),
        *_first_of_each([gait.recorded for gait in gaits]),
    }
    for number in EXTREMES_OF_GAITS:
        chosen.add(_place_of_largest([number(gait) for gait in gaits]))
    if len(_first_of_each(starts)) > 1:
        for number in EXTREMES_OF_STARTS:
            chosen.add(_place_of_largest([number(start) for start in starts]))
    return [scenarios[place] for place in sorted(chosen)]


def _first_of_each(parts: Sequence[object]) -> list[int]:
    """Return where each object is first."""
    # Backward, so that the first place of each is the one that stays.
    places = {id(parts[place]): place for place in range(len(parts) - 1, -1, -1)}
    return list(places.values())


def _place_of_largest(values: Sequence[float]) -> int:
    return values.index(max(values))


def check_described(robot: Robot, environment: Environment | None = None) -> None:
    """Do the same for a robot, and for what it swims in.

    Args:
        robot: The robot.
        environment: Water or ground; None: not known.

    Raises:
        ValueError: If something cannot be.
    """
    _settle(judge_described(robot, environment))


def _settle(doubts: Iterable[Doubt]) -> None:
    if _IS_LIMIT_CASE.get():
        return
    all_doubts = list(doubts)
    for doubt in all_doubts:
        if doubt.refuses:
            raise doubt.error
    for doubt in all_doubts:
        warn_of_doubt(str(doubt.error))
