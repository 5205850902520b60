"""Whole trials side by side on threads: for models whose marches let go of the interpreter, but take no lanes."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from threading import Event, local
from typing import TypeVar

from laticauda.dynamics.school import usable_cores
from laticauda.errors import BadArgument, instance
from laticauda.scenarios import Scenario
from laticauda.simulate.plants import plant
from laticauda.simulate.runner import Progress, run
from laticauda.trial import Trial

Result = TypeVar("Result")


class _Given(Exception):
    """Nobody waits for this trial any more."""


def swim_each(
    scenarios: Sequence[Scenario],
    use: Callable[[Trial], Result],
    *,
    threads: int | None = None,
    progress: Progress | None = None,
) -> list[Result]:
    """Run every scenario, several at a time; the numbers are those of `swim`, however many threads there are.

    Args:
        scenarios: Of any model; those of one robot, environment and model should follow each other, for a thread keeps
            the last plant that it made.
        use: Called with every trial, in the thread that ran it; only what it returns is kept.
        threads: How many; None takes all cores that this process may use.
        progress: Called after every trial with the share that is finished, from 0 to 1.

    Returns:
        What `use` returned, in the order of the scenarios.

    Raises:
        BadArgument: If a scenario cannot be run; its place is in the argument's name, and the others are given up.
    """
    own, is_over, results = local(), Event(), list[Result]()

    def watch(_: float) -> None:
        if is_over.is_set():
            raise _Given

    def swum(i: int) -> Result:
        one = scenarios[i]
        try:
            instance("", one, Scenario)
            parts = one.robot, one.environment, one.model
            if not all(part is kept for part, kept in zip(parts, getattr(own, "parts", [None] * 3), strict=True)):
                own.plant, own.parts = plant(one), parts
            begin, every = one.start, one.sample_interval
            return use(run(own.plant, one.controller, one.duration, start=begin, sample_interval=every, progress=watch))
        except BadArgument as bad:
            raise BadArgument(f"scenarios[{i}].{bad.name}".rstrip("."), bad.rule) from bad
        except Exception as error:
            error.add_note(f"This happened in scenarios[{i}].")
            raise

    with ThreadPoolExecutor(threads or usable_cores()) as pool:
        try:
            for result in pool.map(swum, range(len(scenarios))):
                results.append(result)
                if progress is not None:
                    progress(len(results) / len(scenarios))
        finally:
            is_over.set()
    return results
