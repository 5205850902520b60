"""What a world is made of, as a message says it: names of presets, numbers that replace theirs, a gait, a start."""

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, cast

from laticauda.codec import BadKey, decode, encode
from laticauda.cosim.messages import Message, known, numbers, table
from laticauda.errors import one_of, positive, whole, within
from laticauda.gaits import Gait
from laticauda.gaits.gait import Wave
from laticauda.interfaces import Command, Plant, Start
from laticauda.robot import (
    Environment,
    Robot,
    Water,
    ground_names,
    load_ground,
    load_parameters,
    load_robot,
    load_water,
    parameter_names,
    robot_names,
    water_names,
)
from laticauda.scenarios import default_water
from laticauda.simulate import plant

# Mamba's first trial of the paper.
FIRST_GAIT = Gait(amplitude=math.radians(30.0), frequency=math.radians(130.0), phase_shift=math.radians(40.0))
MOST_LINKS = 200
HELD = ("gait", "offset", "pitch_offset", "references", "enabled", "current")
"""Fields that `step` and `set` change."""


@dataclass(frozen=True, kw_only=True)
class Setup:
    """What `reset` and `run` make a world from. Robots, waters and so on are named, never read from a client's path.

    Raises:
        ValueError: If a field is out of its range.
    """

    robot: str = "mamba"
    """A preset, or one of the server's own robots [-]."""
    n_links: int | None = None
    """Links to have instead of the robot's, for robots whose links are all alike [-]."""
    water: str | None = None
    """A preset; None: the paper's for the gait [-]."""
    ground: str | None = None
    """A preset: crawl on land instead [-]."""
    parameters: str | None = None
    """A preset: numbers for robot and water by gait, instead of a water [-]."""
    coefficients: Mapping[str, Any] = dataclasses.field(default_factory=dict[str, Any])
    """Fields of the water that are to be replaced, each in its unit."""
    model: str = "planar"
    """planar or spatial [-]."""
    joints: str | None = None
    """prescribed, pd or servo; None: that of the parameters, else prescribed [-]."""
    dt: float | None = None
    """Largest time step; None: a converged one [s]."""
    ramp: float | None = None
    """Duration of the smooth start; None: 1 s for prescribed joints, else none [s]."""
    offset_bandwidth: float = 10.0
    """Of the reference generator's filters [rad/s]."""
    center_of_mass: tuple[float, float] = (0.0, 0.0)
    """Where it starts, straight and at rest [m]."""
    heading: float = 0.0
    """The same [rad]."""
    sample_interval: float = 0.05
    """Between two samples of the log [s]."""
    command: Command = dataclasses.field(default_factory=lambda: Command(gait=FIRST_GAIT))
    """What is asked of it at first: in messages `gait`, `offset`, `pitch_offset`, `references`, `enabled`."""
    own_robots: Mapping[str, Robot] = dataclasses.field(default_factory=dict[str, Robot])
    """Robots that the server was started with, by name; no field of a message."""

    def __post_init__(self) -> None:
        """Check what nobody behind us does."""
        for name, names in (("water", water_names()), ("ground", ground_names()), ("parameters", parameter_names())):
            if getattr(self, name) is not None:
                one_of(name, getattr(self, name), names)
        one_of("robot", self.robot, (*robot_names(), *self.own_robots))
        if self.n_links is not None and whole("n_links", self.n_links, 1) > MOST_LINKS:
            raise ValueError(f"`n_links` must be <= {MOST_LINKS} on a server, got {self.n_links}.")
        if self.parameters is not None and (self.water is not None or self.ground is not None):
            raise ValueError("`parameters` must not be given with `water` or `ground`: they say what the water is.")
        if self.ground is not None and (self.water is not None or self.coefficients):
            raise ValueError("`ground` must not be given with `water`, `coefficients` or `current`.")
        positive("sample_interval", self.sample_interval, "s")
        positive("offset_bandwidth", self.offset_bandwidth, "rad/s")

    @property
    def start(self) -> Start:
        """Where it begins."""
        return Start(center_of_mass=self.center_of_mass, heading=self.heading)

    @property
    def environment(self) -> Environment:
        """Where it moves."""
        kind = self.command.gait.kind
        if self.ground is not None:
            return load_ground(self.ground)
        if self.parameters is not None:
            water = load_parameters(self.parameters).water(kind)
        else:
            water = load_water(self.water or default_water(self.command.gait))
        try:
            return decode(Water, {**encode(water), **self.coefficients})
        except BadKey as error:
            raise ValueError(f"`{error.key}` {error.rule}.") from None

    @cached_property
    def plant(self) -> Plant[Any]:
        """What can be stepped."""
        own = self.own_robots.get(self.robot)
        robot = load_robot(self.robot, self.n_links) if own is None else own
        if own is not None and self.n_links is not None:
            robot = own.with_links(self.n_links)
        joints = self.joints
        if self.parameters is not None:
            chosen = load_parameters(self.parameters)
            robot, joints = chosen.robot(robot, self.command.gait.kind), joints or chosen.joints
        return plant(
            robot,
            self.environment,
            model=self.model,
            joints=joints or "prescribed",
            dt=None if self.dt is None else positive("dt", self.dt, "s"),
            ramp=self.ramp,
            offset_bandwidth=self.offset_bandwidth,
        )


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
        raise ValueError(f"`enabled` must be an array of true and false, one per joint, or null, got {value!r}.")
    return tuple(switches)


def _read_gait(given: dict[str, Any], held: Gait) -> Gait:
    known("`gait`", given, [field.name for field in dataclasses.fields(Gait)])
    changes = dict(given)
    envelope = changes.get("envelope")
    if envelope is not None:
        changes["envelope"] = None if envelope == [] else numbers("gait.envelope", envelope)
    elif changes.get("kind", "custom") != "custom":
        changes["envelope"] = None  # a kind with a name has its own
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
