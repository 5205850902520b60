"""Bad arguments of public calls, and numbers at the ends of what a declared quantity may be."""

import dataclasses
import json
import math
import random
import re
import types
import typing
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

import laticauda as lc
from bad_inputs import odd, pantry, surface
from bad_inputs.attempt import ACCEPTED, REFUSED, Answer, Case, fault, judge_call
from laticauda.values import LaticaudaError, codec
from laticauda.values.quantities import hints_of, quantities_of

# ---- calls ---------------------------------------------------------------------------------------


def users_values() -> dict[str, Any]:
    """Return values that users hold, by the name of their class."""
    trial = pantry.swim_trial(0.5)
    scenario = trial.scenario
    plant = lc.build_plant(scenario)
    command = lc.Command(gait=pantry.GAIT)
    following = lc.PathFollowing(
        gait=pantry.GAIT,
        path=lc.StraightLine(),
        guidance=lc.LineOfSight(look_ahead_distance=1.0),
        heading=lc.HeadingController(gain=0.5, max_offset=0.5),
    )
    values = (
        trial,
        scenario,
        scenario.robot,
        scenario.environment,
        pantry.GAIT,
        plant,
        command,
        lc.Start(),
        lc.OpenLoop(command=command),
        following,
        following.path,
    )
    return {type(value).__name__: value for value in values}


def good_arguments(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return what fits an argument of a name, where that is clear.

    Args:
        values: Those of `users_values`.
    """
    trial, robot, scenario = values["Trial"], values["Robot"], values["Scenario"]
    water = scenario.environment
    return {
        "robot": robot,
        "gait": pantry.GAIT,
        "motion": pantry.GAIT,
        "trial": trial,
        "scenario": scenario,
        "start": lc.Start(),
        "environment": water,
        "water": water,
        "plant": lc.build_plant(scenario),
        "body": lc.build_plant(scenario),
        "robots": [robot],
        "gaits": [pantry.GAIT],
        "scenarios": [scenario],
        "trials": [trial, trial],
        "name": "mamba",
        "first": trial,
        "second": trial,
        "controller": values["OpenLoop"],
        "command": values["Command"],
        "duration": 0.1,
        "sample_interval": 0.05,
        "dt": 0.05,
        "amplitude": 0.5,
        "frequency": 2.3,
        "phase_shift": 0.7,
        "time": trial.time,
        "center_of_mass": trial.center_of_mass,
    }


GOOD_BY_TYPE: Mapping[Any, Any] = {
    float: 0.5,
    int: 2,
    bool: True,
    str: "mamba",
    Path: Path("new.nc"),
}
"""What fits an argument of a type."""


class Arguments:
    """Arguments that are right, as far as they are known."""

    def __init__(self) -> None:
        self.values = users_values()
        self._by_name = good_arguments(self.values)

    def good(self, function: Callable[..., Any], rng: random.Random) -> dict[str, Any]:
        """Return values of all required arguments of a call; where none is known, an odd one.

        Args:
            function: What is called.
            rng: Source of the odd ones.
        """
        hints = _hints_of(function)
        arguments: dict[str, Any] = {}
        for parameter in surface.named_parameters(function):
            if parameter.default is not parameter.empty:
                continue
            if parameter.name in self._by_name:
                arguments[parameter.name] = self._by_name[parameter.name]
            else:
                arguments[parameter.name] = self._of_type(hints.get(parameter.name), rng)
        return arguments

    def _of_type(self, hint: Any, rng: random.Random) -> Any:
        """Return a value of a type; an odd one if none is known."""
        if typing.get_origin(hint) is typing.Annotated:
            hint = typing.get_args(hint)[0]
        choices = (hint,)
        if typing.get_origin(hint) in (typing.Union, types.UnionType):
            choices = typing.get_args(hint)
        for choice in choices:
            if choice in GOOD_BY_TYPE:
                return GOOD_BY_TYPE[choice]
            for value in self.values.values():
                if (
                    isinstance(choice, type)
                    and choice is not object
                    and _is_instance(value, choice)
                ):
                    return value
        return rng.choice(odd.VALUES)()


def _is_instance(value: object, kind: Any) -> bool:
    try:
        return isinstance(value, kind)
    except TypeError:  # a protocol that cannot be asked
        return False


def _hints_of(function: Callable[..., Any]) -> dict[str, Any]:
    try:
        return typing.get_type_hints(function)
    except (NameError, TypeError, AttributeError):  # types that exist for type checkers only
        return {}


def calls(rng: random.Random, folder: Path) -> Iterator[Case]:
    """Odd arguments of every public function and class; the others are right, where that is known."""
    arguments = Arguments()
    targets = surface.find_calls()
    for target in odd.draw_in_turn(rng, targets):
        yield attack_call(target, arguments, rng)


def attack_call(target: surface.CallTarget, arguments: Arguments, rng: random.Random) -> Case:
    """Return the input in which a parameter of a call gets an odd value.

    Args:
        target: The parameter.
        arguments: Right ones.
        rng: Source of the odd value.
    """
    make_value = rng.choice(odd.VALUES)
    seed = rng.random()
    shown = f"{target.name}({target.parameter}={make_value()!r:.60})"

    def attack() -> Answer:
        good = arguments.good(target.function, random.Random(seed))
        return judge_call(target.function, good | {target.parameter: make_value()})

    return Case("calls", shown, attack)


# ---- declared quantities -------------------------------------------------------------------------


def declared_classes() -> list[type[Any]]:
    """Return the public classes with declared quantities."""
    return [
        thing
        for thing in surface.public_things().values()
        if isinstance(thing, type) and dataclasses.is_dataclass(thing) and quantities_of(thing)
    ]


def values(rng: random.Random, folder: Path) -> Iterator[Case]:
    """Numbers at the ends of what a declared quantity may be, and beyond; a file keeps what is accepted."""
    targets = [(kind, name) for kind in declared_classes() for name in sorted(quantities_of(kind))]
    for kind, name in odd.draw_in_turn(rng, targets):
        number = _draw_number(rng, quantities_of(kind)[name])

        def attack(kind: Any = kind, name: str = name, number: Any = number) -> Answer:
            return judge_value(kind, name, number)

        yield Case("values", f"{kind.__name__}({name}={number!r:.40})", attack)


def _draw_number(rng: random.Random, quantity: Any) -> Any:
    """Return a number at an end of a quantity's range, beside it or far off, as it should be or of an odd type."""
    ends = list(quantity.ends)
    if math.isfinite(quantity.least):
        ends.append(quantity.least)
    end = rng.choice([*ends, 0.0])
    beside = (math.nextafter(end, math.inf), math.nextafter(end, -math.inf))
    number = rng.choice((end, *beside, 1e308, 5e-324, -end))
    if rng.random() < 0.25:
        return number
    odd_types = (math.nan, math.inf, 10**400, str(end), [end], np.float32(end), True)
    return rng.choice((number, *odd_types))


def judge_value(kind: Any, name: str, number: Any) -> Answer:
    """Make a value with this number; a file gives what is accepted as it was.

    Args:
        kind: Class of the value.
        name: Its field.
        number: What the field gets.
    """
    try:
        made = kind(**{name: number})
    except (ValueError, LaticaudaError) as error:
        if str(error).strip():
            return REFUSED
        return fault("refused without a word")
    except TypeError as error:
        if re.search(r"missing|also needs `", str(error)):  # by Python, or by us
            return REFUSED
        return fault(repr(error))
    if not hints_of(kind):
        return ACCEPTED
    text = json.dumps(codec.encode(made, kind))
    read_again = codec.decode(kind, json.loads(text))
    if read_again != made:
        return fault(f"a file gives {read_again}")
    return ACCEPTED
