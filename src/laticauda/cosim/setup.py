"""What a world is made of, as a message says it: names of presets, numbers that replace theirs, a gait, a start."""

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any, cast

from laticauda.codec import BadKey, decode, encode, merged, with_new_names
from laticauda.cosim.messages import Message, known, numbers, table
from laticauda.errors import BadArgument, one_of, within
from laticauda.gaits import Envelope, Gait, envelope_of
from laticauda.gaits.gait import Wave
from laticauda.interfaces import Command, Plant, Start
from laticauda.quantities import option, quantity, value
from laticauda.robot import (
    Environment,
    Robot,
    Water,
    ground_names,
    load_robot,
    parameter_names,
    robot_names,
    water_names,
)
from laticauda.scenarios import Choice
from laticauda.simulate import plant

# Mamba's first trial of the paper.
FIRST_GAIT = Gait(amplitude=math.radians(30.0), frequency=math.radians(130.0), phase_shift=math.radians(40.0))
MOST_LINKS = 200
HELD = ("gait", "offset", "pitch_offset", "references", "enabled", "current")
"""Fields that `step` and `set` change."""


@value
class Setup(Choice):
    """What `reset` and `run` make a world from. Robots, waters and so on are named, never read from a client's path.

    Raises:
        ValueError: If a field is out of its range.
    """

    n_links: int | None = quantity("", "Links to have instead, if all are alike", ge=1, le=MOST_LINKS, default=None)
    coefficients: Mapping[str, Any] = option("Fields of the water to replace", default_factory=dict[str, Any])
    dt: float | None = quantity("s", "Largest time step; None: a converged one", gt=0.0, default=None)
    ramp: float | None = quantity("s", "Of the start; None: 1 s for prescribed joints, else none", ge=0.0, default=None)
    offset_bandwidth: float = quantity("rad/s", "Of the reference generator's filters", gt=0.0, default=10.0)
    center_of_mass: tuple[float, float] = quantity("m", "Where it starts, straight and at rest", default=(0.0, 0.0))
    heading: float = quantity("rad", "The same", default=0.0)
    sample_interval: float = quantity("s", "Between two samples of the log", gt=0.0, default=0.05)
    command: Command = option("What is asked of it at first", default=Command(gait=FIRST_GAIT))
    own_robots: Mapping[str, Robot] = option("Robots of the server, by name", default_factory=dict[str, Robot])

    def __post_init__(self) -> None:
        """Refuse paths, and what does not go together."""
        super().__post_init__()
        for name, names in (("water", water_names()), ("ground", ground_names()), ("parameters", parameter_names())):
            if getattr(self, name) is not None:
                one_of(name, getattr(self, name), names)
        one_of("robot", self.robot, (*robot_names(), *self.own_robots))
        if self.ground is not None and self.coefficients:
            raise BadArgument("ground", "must not be given with `coefficients` or `current`")

    @property
    def start(self) -> Start:
        """Where it begins."""
        return Start(center_of_mass=self.center_of_mass, heading=self.heading)

    @cached_property
    def plant(self) -> Plant[Any]:
        """What can be stepped."""
        chosen = self.resolved(self.command.gait, self._robot)
        model = replace(chosen.model, dt=self.dt, ramp=self.ramp, offset_bandwidth=self.offset_bandwidth)
        return plant(chosen.robot, self._with_coefficients(chosen.environment), model)

    def _robot(self, name: str, n_links: int | None) -> Robot:
        robot = self.own_robots[name] if name in self.own_robots else load_robot(name)
        return robot if n_links is None else robot.with_links(n_links)

    def _with_coefficients(self, environment: Environment) -> Environment:
        if not self.coefficients:
            return environment
        changes = with_new_names(Water, dict(self.coefficients))
        try:
            return decode(Water, merged(encode(environment), changes, by_kind=True))
        except BadKey as error:
            raise BadArgument(error.key, error.rule) from None


_OWN = ("coefficients", "command", "own_robots")
FIELDS = tuple(field.name for field in dataclasses.fields(Setup) if field.name not in _OWN)
MADE_FROM = (*FIELDS, "coefficients", *HELD)
"""Fields of a message that a world is made from."""


def read_setup(message: Message, own_robots: Mapping[str, Robot]) -> Setup:
    """The world that a message asks for; fields that are left out have their defaults.

    Args:
        message: The request.
        own_robots: Those of the server.

    Raises:
        ValueError: If a field is out of its range.
    """
    given = {name: message[name] for name in FIELDS if message.get(name) is not None}
    if "center_of_mass" in given:
        given["center_of_mass"] = numbers("center_of_mass", given["center_of_mass"], 2)
    coefficients = dict(table("coefficients", message.get("coefficients") or {}))
    if message.get("current") is not None:
        coefficients["current"] = read_current(message["current"])
    elif "current" in coefficients:
        coefficients["current"] = read_current(coefficients["current"])
    command = read_command(message, Command(gait=FIRST_GAIT))
    return Setup(**given, coefficients=coefficients, command=command, own_robots=own_robots)


def read_current(value: object) -> tuple[float, float]:
    """V of the water [m/s]."""
    x, y = numbers("current", value, 2)
    return within("current[0]", x, -100.0, 100.0, "m/s"), within("current[1]", y, -100.0, 100.0, "m/s")


def read_command(message: Message, held: Command) -> Command:
    """The command that a message leaves: its fields replace what is held, what it leaves out stays.

    Args:
        message: The request.
        held: The command until now.

    Raises:
        ValueError: If a field is out of its range.
    """
    changes: dict[str, Any] = {}
    if message.get("gait") is not None:
        changes["gait"] = _read_gait(table("gait", message["gait"]), held.gait)
    for name in ("offset", "pitch_offset"):
        if message.get(name) is not None:
            changes[name] = within(name, message[name], -1e3, 1e3, "rad")
    if "references" in message:
        angles = message["references"]
        changes["references"] = None if angles is None or angles == [] else numbers("references", angles)
    if "enabled" in message:
        changes["enabled"] = _read_switches(message["enabled"])
    return replace(held, **changes)


def _read_switches(value: object) -> tuple[bool, ...] | None:
    if value is None or value == []:
        return None
    switches: list[Any] = cast("list[Any]", value) if isinstance(value, list) else [value]
    if not all(isinstance(one, bool) for one in switches):
        raise BadArgument("enabled", f"must be an array of true and false, one per joint, or null, got {value!r}")
    return tuple(switches)


def _read_gait(given: dict[str, Any], held: Gait) -> Gait:
    known("`gait`", given, ["kind", *(field.name for field in dataclasses.fields(Gait))])
    changes = dict(given)
    values, kind = changes.pop("envelope", None), changes.pop("kind", None)
    if isinstance(values, list) and values:
        changes["envelope"] = envelope_of(kind, numbers("gait.envelope", cast(object, values)))
    elif kind is not None:
        changes["envelope"] = held.envelope if kind == held.kind else envelope_of(kind)
    elif values:
        try:
            changes["envelope"] = decode(Envelope, cast(object, values), "gait.envelope")
        except BadKey as error:
            raise BadArgument(error.key, error.rule) from error
    for name in ("pitch", "fin"):
        wave = changes.get(name)
        if wave is not None and wave != []:
            entries = table(f"gait.{name}", wave)
            known(f"`gait.{name}`", entries, [field.name for field in dataclasses.fields(Wave)])
            need = {"amplitude": 0.0, "frequency": changes.get("frequency", held.frequency)}
            changes[name] = Wave(**{**need, **entries})
        elif name in changes:
            changes[name] = None
    return replace(held, **changes)
