"""Wrong but plausible: inputs that look right, each with the right verdict; and true robots, of which nothing is said.

The list of mistakes stands in tests/scenarios/test_plausibility.py, once: there each is given to the
Python API. Here it comes through other doors: in a scenario file, typed with `laticauda swim`, and in
a batch.
"""

import importlib.util
import random
import re
import sys
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import laticauda as lc
from bad_inputs import odd
from bad_inputs.attempt import ACCEPTED, REFUSED, Answer, Case, fault, type_command
from laticauda.robot import robot_names
from laticauda.robot.files import to_toml

TESTS = Path(__file__).parents[2] / "tests"
"""Where the tests find the modules that they share."""
LIST = TESTS / "scenarios" / "test_plausibility.py"
"""Where the mistakes are listed, with their verdicts."""
DOORS = ("file", "batch")
TRUE_SPREAD = 0.1
"""How far the numbers of a true robot are changed: its masses, lengths and servos together stay plausible."""
GAIT = "--amplitude-deg 30 --frequency-deg-s 130 --phase-shift-deg 40"


@cache
def listed_mistakes() -> dict[str, Any]:
    """Return the mistakes in the list: how each is made, its verdict, and words of the answer."""
    spec = importlib.util.spec_from_file_location("listed_plausibility", LIST)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    if str(TESTS) not in sys.path:
        sys.path.append(str(TESTS))
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module.WRONG


def plausible(rng: random.Random, folder: Path) -> Iterator[Case]:
    """Listed mistakes through other doors, and in turn robots that are true."""
    names = list(listed_mistakes())
    robots = list(robot_names())
    for name, robot in zip(
        odd.draw_in_turn(rng, names), odd.draw_in_turn(rng, robots), strict=False
    ):
        door = rng.choice(DOORS)
        yield Case("plausible", f"{name}, {door}", Mistake(name=name, door=door))
        true_text = _with_changed_numbers(rng, to_toml(lc.load_robot(robot)))
        yield Case("plausible", f"true: {true_text[:150]!r}", TrueRobot(text=true_text))


@dataclass(frozen=True, kw_only=True)
class Mistake:
    """A listed mistake at a door of the package."""

    name: str
    door: str

    def __call__(self) -> Answer:
        """Make it: what the list says is said at this door, too."""
        make, verdict, words = listed_mistakes()[self.name]
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                scenario = make()
        except ValueError:  # a class refuses its own number: there is nothing to bring to a door
            return REFUSED
        if scenario.gait.recorded is None:  # a recording has to cover its run
            scenario = replace(scenario, duration=0.1)
        said, is_refused = self._answer_to(scenario)
        if words not in said:
            return fault(f"must be {verdict} with {words!r}, said {said[-300:]!r}")
        if is_refused != (verdict == "refused"):
            return fault(f"must be {verdict}, said {said[-300:]!r}")
        return REFUSED

    def _answer_to(self, scenario: lc.Scenario) -> tuple[str, bool]:
        """Return what is said at the door, and whether the scenario is refused."""
        if self.door == "file":
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                lc.save_scenario(scenario, "mistake.toml")
            said = type_command("swim", "mistake.toml")
            return said.err, said.status == 2
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            try:
                lc.swim_many([scenario, scenario])
            except ValueError as error:
                return str(error), True
        return " ".join(str(warning.message) for warning in caught), False


@dataclass(frozen=True, kw_only=True)
class TrueRobot:
    """A robot like one of the presets: nothing is said of it."""

    text: str

    def __call__(self) -> Answer:
        """Swim it."""
        Path("true.toml").write_text(self.text)
        said = type_command("swim", "--robot", "true.toml", "--duration", "0.1", *GAIT.split())
        if said.status != 0 or "did you mean" in said.err:
            return fault(f"is doubted: {said.err[-300:]}")
        return ACCEPTED


def _with_changed_numbers(rng: random.Random, text: str) -> str:
    """Return a robot's file in which every number with a point differs a little."""

    def change(found: re.Match[str]) -> str:
        factor = 1.0 + rng.uniform(-TRUE_SPREAD, TRUE_SPREAD)
        return f"{found[1]} = {float(found[2]) * factor!r}"

    return re.sub(
        r"(?m)\b(length|mass|half_height|half_width|height|stall_torque) = (\d+\.\d+)", change, text
    )
