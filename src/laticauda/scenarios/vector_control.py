"""Controllers of many robots at once, written for arrays: what they see, and what they command.

A controller written for one robot can steer many, too: each robot is then asked for in turn
(`OneByOne`). One that is written for arrays is many times as fast. Its class says so by
`Controller.vectorize`, which returns a `VectorController`.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from jaxtyping import Bool, Float

from laticauda.scenarios.interfaces import Command, Controller, Observation, decide
from laticauda.sensing import BodyLoads
from laticauda.values import BadArgument, check_choice, check_instance

Decisions: TypeAlias = Mapping[str, Float[np.ndarray, "n ..."]] | Sequence[Command | None]
"""What many robots are to do: numbers by name of `STEERED`, `REFERENCES`, or a command each; None: as before."""

STEERED = ("amplitude", "frequency", "phase_shift", "offset")
"""What arrays may command: gait parameters; the offset is that which steering adds to the gait's own."""
REFERENCES = "references"
"""Name of what arrays may command instead: an angle for every joint, one row per robot."""


class Observations:
    """What controllers of many robots see at one instant: the fields of `Observation`, one row per robot.

    Valid until the robots move on; copy what is needed later.

    Args:
        time: Time of every robot [s].
        center_of_mass: Position of the center of mass [m].
        center_of_mass_velocity: Velocity of the center of mass [m/s].
        heading: Mean link angle (6), unwrapped [rad].
        heading_rate: Rate of the heading [rad/s].
        is_well: Whether each robot still swims; all else of one that does not is the last that was
            finite, and nothing is commanded to it.
        observe: Returns the observation of one robot.
    """

    def __init__(
        self,
        *,
        time: Float[np.ndarray, " n"],
        center_of_mass: Float[np.ndarray, "n n_axes"],
        center_of_mass_velocity: Float[np.ndarray, "n n_axes"],
        heading: Float[np.ndarray, " n"],
        heading_rate: Float[np.ndarray, " n"],
        is_well: Bool[np.ndarray, " n"],
        observe: Callable[[int], Observation],
    ) -> None:
        self.time = time
        self.center_of_mass = center_of_mass
        self.center_of_mass_velocity = center_of_mass_velocity
        self.heading = heading
        self.heading_rate = heading_rate
        self.is_well = is_well
        self.of_robot = observe

    def __len__(self) -> int:
        """Return the number of robots."""
        return self.time.size

    @cached_property
    def joint_angle(self) -> Float[np.ndarray, "n n_joints"]:
        """phi [rad]."""
        return self.collect("joint_angle")

    @cached_property
    def joint_rate(self) -> Float[np.ndarray, "n n_joints"]:
        """phi' [rad/s]."""
        return self.collect("joint_rate")

    @cached_property
    def link_angle(self) -> Float[np.ndarray, "n n_links"]:
        """theta [rad]."""
        return self.collect("link_angle")

    @cached_property
    def loads(self) -> BodyLoads:
        """What links and joints bear, see `Observation.loads`: its fields with one row per robot."""
        loads_of_robots = [self.of_robot(i).loads for i in range(len(self))]
        columns: dict[str, np.ndarray] = {}
        for quantity in fields(BodyLoads):
            rows = [getattr(loads, quantity.name) for loads in loads_of_robots]
            columns[quantity.name] = np.stack(rows)
        return BodyLoads(**columns)

    def collect(self, name: str) -> np.ndarray:
        """Return a field of all observations, one row per robot.

        Args:
            name: Its name.
        """
        return np.stack([getattr(self.of_robot(i), name) for i in range(len(self))])


class VectorController(ABC):
    """Steers many robots, each by a controller of its own. It is made for one run, and may keep what it needs."""

    signals: Mapping[str, Float[np.ndarray, " n"]] = {}
    """Quantities of the last control instant, as `Controller.signals` returns them, one number per robot."""

    @abstractmethod
    def step(self, observations: Observations) -> Mapping[str, Float[np.ndarray, "n ..."]]:
        """Return what every robot is to do until the next control instant.

        Args:
            observations: Current observations of the robots.

        Returns:
            By name, one number per robot of any of amplitude [rad], frequency [rad/s], phase_shift
            [rad] and offset [rad], which is added to that of the gait. What is left out stays as
            it is. Or references alone: one row per robot with the angle of every joint [rad], as
            `Command.references`.
        """


class OneByOne:
    """Controllers that were written for one robot, called one after the other.

    Args:
        controllers: One for each robot.
    """

    def __init__(self, controllers: Sequence[Controller[Any]]) -> None:
        self._controllers = controllers
        self._states = [controller.init() for controller in controllers]

    def step(self, observations: Observations) -> list[Command | None]:
        """Return the command of every robot; None for one that no longer swims.

        Args:
            observations: Current observations of the robots.
        """
        commands: list[Command | None] = []
        for i, controller in enumerate(self._controllers):
            if not observations.is_well[i]:
                commands.append(None)
                continue
            self._states[i], command = decide(controller, self._states[i], observations.of_robot(i))
            commands.append(command)
        return commands

    @property
    def signals(self) -> dict[str, np.ndarray]:
        """Signals of the last control instant, by name; nan where a controller has none of that name."""
        signals_of_robots = [
            controller.signals(state)
            for controller, state in zip(self._controllers, self._states, strict=True)
        ]
        columns: dict[str, np.ndarray] = {}
        for i, signals in enumerate(signals_of_robots):
            for name, value in signals.items():
                if name not in columns:
                    columns[name] = np.full(len(signals_of_robots), np.nan)
                columns[name][i] = value
        return columns


def vectorize(controllers: Sequence[Controller[Any]]) -> "VectorController | OneByOne":
    """Return what steers a robot for each of many controllers: by arrays if their class is written so.

    Args:
        controllers: Controllers of the same class, one for each robot.
    """
    vector_controller = vectorize_alike(controllers, "init", "step")
    if vector_controller is None:
        return OneByOne(controllers)
    return vector_controller


def vectorize_alike(parts: Sequence[Any], *methods: str) -> Any:
    """Return what computes many controllers, paths or guidance laws of one class by arrays; None if nothing does.

    Args:
        parts: They, one for each robot.
        methods: Names of the methods that `vectorize` stands for.
    """
    first: Any = parts[0]
    kind: type[Any] = first.__class__
    if not is_vectorized(kind, *methods):
        return None
    return kind.vectorize(parts)


def is_vectorized(kind: type, *methods: str) -> bool:
    """Return whether the `vectorize` of a class is meant for its methods, and not for those of a base.

    A subclass that changes what its base does, but not how many of it do it, is called one by one.

    Args:
        kind: The class.
        methods: Names of the methods that `vectorize` stands for.
    """
    place = _place_of_definition(kind, "vectorize")
    return all(place <= _place_of_definition(kind, method) for method in methods)


def _place_of_definition(kind: type, name: str) -> int:
    """Return how many classes before `kind` inherits a method from, itself being 0."""
    owners = [name in vars(owner) for owner in kind.__mro__]
    return owners.index(True)


def check_decisions(
    decisions: Mapping[str, Any], is_well: Bool[np.ndarray, " n"]
) -> dict[str, np.ndarray]:
    """Return the numbers that a `VectorController` commands, one per robot, or one row of references.

    Args:
        decisions: Numbers by name.
        is_well: Whether each robot still swims.

    Raises:
        ValueError: If a name is not one of `STEERED` or `REFERENCES`, or there is not one number, or
            one row of finite references, for each robot.
    """
    check_instance("decisions", decisions, Mapping)
    if REFERENCES in decisions:
        return {REFERENCES: _check_references(decisions, is_well)}
    n = is_well.size
    checked: dict[str, np.ndarray] = {}
    for name, values in decisions.items():
        check_choice("decisions", name, (*STEERED, REFERENCES))
        numbers = np.asarray(values, dtype=float)
        if numbers.shape not in ((), (n,)):
            rule = f"must hold one number for each of the {n} robots"
            raise BadArgument(f"decisions[{name!r}]", f"{rule}, got the shape {numbers.shape}")
        if not numbers.shape:
            numbers = np.full(n, numbers)
        checked[name] = numbers
    return checked


def _check_references(
    decisions: Mapping[str, Any], is_well: Bool[np.ndarray, " n"]
) -> Float[np.ndarray, "n n_driven"]:
    """Return the references among decisions; they must be alone."""
    if len(decisions) > 1:
        further_names = ", ".join(name for name in decisions if name != REFERENCES)
        raise BadArgument("decisions", f"must hold `references` alone, also got {further_names}")
    argument = f"decisions[{REFERENCES!r}]"
    references = np.asarray(decisions[REFERENCES], dtype=float)
    n = is_well.size
    if references.ndim != 2 or len(references) != n:
        rule = f"must hold a row of angles for each of the {n} robots"
        raise BadArgument(argument, f"{rule}, got the shape {references.shape}")
    is_finite = np.isfinite(references)
    if not (is_finite.all() or is_finite[is_well].all()):
        raise BadArgument(argument, "must be finite [rad]")
    return references


def kind_of_controller(controller: Controller[Any]) -> object:
    """Return what controllers have in common that are computed together: their class, and those of their parts.

    Args:
        controller: A controller.
    """
    names: Iterable[str] = getattr(controller, "__dataclass_fields__", ())
    return controller.__class__, tuple(getattr(controller, name).__class__ for name in names)
