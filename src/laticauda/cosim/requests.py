"""What a message says: names of presets, numbers that replace theirs, a gait, a start; as a scenario, or a command.

Each field of a message is a field of the class that it ends in, which knows its unit, range and default.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, cast

from laticauda.codec import check_keys, decode, table_of, updated
from laticauda.cosim.messages import Message
from laticauda.errors import BadArgument, one_of, within
from laticauda.gaits import Gait
from laticauda.gaits.gait import Wave
from laticauda.interfaces import Command, OpenLoop, Start
from laticauda.quantities import option, quantity, value
from laticauda.robot import Robot, Water, ground_names, load_robot, parameter_names, robot_names, water_names
from laticauda.scenarios import Choice, Scenario

# Mamba's first trial of the paper.
FIRST_GAIT = Gait(amplitude=math.radians(30.0), frequency=math.radians(130.0), phase_shift=math.radians(40.0))
MOST_LINKS = 200
HELD = ("gait", "offset", "pitch_offset", "references", "enabled", "current")
"""Fields that `step` and `set` change."""
NAMES = tuple(Choice.__dataclass_fields__)
MODEL = ("joints", "dt", "ramp", "offset_bandwidth")
START = ("center_of_mass", "heading")
MADE_FROM = (*dict.fromkeys((*NAMES, *MODEL, *START)), "sample_interval", "coefficients", *HELD)
"""Fields of a message that a world is made from."""


@value
class _Held:
    """What a message says of place, command and current, the gait aside."""

    center_of_mass: tuple[float, float] = quantity("m", "Where it starts", default=(0.0, 0.0))
    offset: float = quantity("rad", "Of all yaw joints, added to the gait's", ge=-1e3, le=1e3, default=0.0)
    pitch_offset: float = quantity("rad", "Of all pitch joints", ge=-1e3, le=1e3, default=0.0)
    references: tuple[float, ...] | None = quantity("rad", "Where joints go, not where the gait says", default=None)
    enabled: tuple[bool, ...] | None = option("Whether each joint's motor is on", default=None)
    current: tuple[float, float] = quantity("m/s", "Which the water moves to", ge=-100.0, le=100.0, default=(0.0, 0.0))


def read_scenario(message: Message, own_robots: Mapping[str, Robot], duration: float = 30.0) -> Scenario:
    """The world that a message asks for; fields that are left out have their defaults.

    Robots, waters and so on are named, and never read from a client's path.

    Args:
        message: The request.
        own_robots: Those of the server, by name.
        duration: Of the run, if it is to be one [s].

    Raises:
        BadKey: If a field is unknown or out of its range.
        ValueError: If fields do not go together.
    """
    command = read_command(message, Command(gait=FIRST_GAIT))
    names, model = _given(message, NAMES), _given(message, MODEL)
    if isinstance(model.get("joints"), Mapping):
        del names["joints"]  # a law with numbers, and no name
    else:
        model.pop("joints", None)
    start, choice = _given(message, START), decode(Choice, names)
    presets = {"water": water_names(), "ground": ground_names(), "parameters": parameter_names()}
    for name, there in {"robot": (*robot_names(), *own_robots), **presets}.items():
        if getattr(choice, name) is not None:
            one_of(name, getattr(choice, name), there)
    chosen = choice.resolved(command.gait, lambda name, n_links: _robot(own_robots.get(name), name, n_links))
    water = table_of(message.get("coefficients") or {}, "coefficients") | _given(message, ("current",))
    if water and not isinstance(chosen.environment, Water):
        raise BadArgument("ground", "must not be given with `coefficients` or `current`")
    return Scenario(
        robot=chosen.robot,
        motion=OpenLoop(command=command),
        environment=updated(chosen.environment, water | _held(water, "current")),
        model=updated(chosen.model, model),
        start=decode(Start, start | _held(start, "center_of_mass")),
        duration=duration,
        **_given(message, ("sample_interval",)),
    )


def commanded(scenario: Scenario, message: Message) -> Scenario:
    """A world's scenario with another command or current.

    Args:
        scenario: Whose motion is a command that is held.
        message: With any of `HELD`.

    Raises:
        BadKey: If a field is unknown or out of its range.
        ValueError: If the robot is on the ground, where there is no current.
    """
    motion, water = cast(OpenLoop, scenario.motion), scenario.environment
    if message.get("current") is not None:
        if not isinstance(water, Water):
            raise BadArgument("current", f"must be null on the ground, got {message['current']}")
        flow = replace(water, **_held(message, "current"))
        water = water if flow == water else flow
    command = read_command(message, motion.command)
    return replace(scenario, motion=replace(motion, command=command), environment=water)


def read_command(message: Message, held: Command) -> Command:
    """The command that a message leaves: its fields replace what is held, what it leaves out stays.

    Args:
        message: The request.
        held: The command until now.

    Raises:
        BadKey: If a field is unknown or out of its range.
    """
    changes = _held(_given(message, ("offset", "pitch_offset")), "offset", "pitch_offset")
    # Octave and MATLAB write arrays of one number as the number, and null as an empty array.
    said = {name: message[name] for name in ("references", "enabled") if name in message}
    lists = {
        name: None if one == [] else [one] if isinstance(one, bool | int | float) else one for name, one in said.items()
    }
    changes |= _held(lists, *said)
    if message.get("gait") is not None:
        changes["gait"] = _gait(table_of(message["gait"], "gait"), held.gait)
    return replace(held, **changes)


def _given(message: Message, names: Sequence[str]) -> dict[str, Any]:
    """Those of the fields that say something."""
    return {name: message[name] for name in names if message.get(name) is not None}


def _held(said: Message, *names: str) -> dict[str, Any]:
    """These fields, as far as they are said, checked."""
    mine = {name: said[name] for name in names if name in said}
    checked = decode(_Held, mine)
    return {name: getattr(checked, name) for name in mine}


def _robot(own: Robot | None, name: str, n_links: int | None) -> Robot:
    robot = load_robot(name) if own is None else own
    return robot if n_links is None else robot.with_links(int(within("n_links", n_links, 1, MOST_LINKS)))


def _gait(table: dict[str, Any], held: Gait) -> Gait:
    if not table.get("envelope", True):
        del table["envelope"]
    for name in {"pitch", "fin"} & table.keys():
        wave, at = table[name], f"gait.{name}"
        usual = {"amplitude": 0.0, "frequency": table.get("frequency", held.frequency)}
        table[name] = None if wave is None or wave == [] else decode(Wave, usual | table_of(wave, at), at)
    return updated(held, table, "gait")


def check_fields(message: Message, *names: str) -> None:
    """Refuse a message with other fields than these and those of every request.

    Args:
        message: The request.
        names: Of the fields.

    Raises:
        BadKey: If there is one.
    """
    check_keys(message, ("do", "id", "protocol", *names))
