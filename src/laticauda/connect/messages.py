"""Co-simulation messages: one JSON object per line, and the conversion of request fields to values."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NoReturn, TypeAlias, cast

from laticauda import robot, scenarios
from laticauda.motion import gaits
from laticauda.motion.gaits.gait import FIRST_GAIT, Wave
from laticauda.robot import TEXTBOOK, Current, Robot, Water, load_robot
from laticauda.scenarios import interfaces
from laticauda.values import codec
from laticauda.values.checks import check_choice, check_within
from laticauda.values.errors import BadArgument
from laticauda.values.quantities import option, quantity, value_class

PROTOCOL_VERSION = 1
"""Increases when the answer to an accepted message changes; new fields do not count."""
MESSAGE_BYTES = 1 << 20
"""Maximum length of a request in bytes, including its line ending."""

Message: TypeAlias = Mapping[str, Any]


def read_message(line: bytes) -> dict[str, Any]:
    """Parse the request in a line.

    Args:
        line: The line, without its line ending.

    Raises:
        ValueError: If the line is not a JSON object, or contains a number that is not finite.
    """
    try:
        found = json.loads(line.decode("utf-8"), parse_constant=_refuse, parse_float=_finite)
    except UnicodeDecodeError:
        raise ValueError(
            "A message must be one line of JSON in UTF-8, got bytes that are not text."
        ) from None
    except RecursionError:
        raise ValueError(
            "A message must be one line of JSON, got brackets that are nested too deeply."
        ) from None
    except json.JSONDecodeError as error:
        raise ValueError(f"A message must be one line of JSON; it is not: {error}.") from None
    if not isinstance(found, dict):
        raise ValueError(
            f"A message must be a JSON object with the field `do`, got {type(found).__name__}."
        )
    return cast("dict[str, Any]", found)


def write_message(message: Message) -> bytes:
    """Encode an answer as one line, including the line ending."""
    return (
        json.dumps(message, default=_plain, allow_nan=False, separators=(",", ":")).encode() + b"\n"
    )


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"A message must hold finite numbers only, got {constant}.")


def _finite(digits: str) -> float:
    number = float(digits)
    return number if math.isfinite(number) else _refuse(digits)


def _plain(value: Any) -> Any:
    if hasattr(value, "tolist"):  # numpy's arrays and numbers
        return value.tolist()
    raise TypeError(f"{type(value).__name__} cannot be written as JSON")


MOST_LINKS = 200
LISTS = ("references", "enabled", "thrusts", "deflections")
HELD = ("gait", "offset", "pitch_offset", *LISTS, "current")
"""Fields that `step` and `set` change."""
NAMES = tuple(scenarios.Choice.__dataclass_fields__)
MODEL = ("joints", "dt", "ramp", "offset_bandwidth", "root")
START = ("center_of_mass", "heading", "depth", "pitch", "roll")
MADE_FROM = (*dict.fromkeys((*NAMES, *MODEL, *START)), "sample_interval", "coefficients", *HELD)
"""Fields of a message from which a world is created."""
COMMON = ("do", "id", "protocol", "token")
REQUESTS: Mapping[str, tuple[str, ...]] = {
    "reset": MADE_FROM,
    "step": ("duration", *HELD),
    "set": HELD,
    "get": ("series", "since"),
    "run": ("duration", "series", *MADE_FROM),
}
"""Fields of each kind of request, in addition to those that all requests have, `COMMON`."""
LOADS = ("joint_angle_ref", "joint_torque", "work", "electrical_work")
"""Quantities of the last sample that an answer contains in addition to the observation."""


@value_class
class InitialMessageState:
    """Position, command (except for the gait) and current in a message."""

    center_of_mass: tuple[float, float] = quantity("m", "Initial position", default=(0.0, 0.0))
    offset: float = quantity(
        "rad", "Offset of all yaw joints, added to the gait's", ge=-1e3, le=1e3, default=0.0
    )
    pitch_offset: float = quantity(
        "rad", "Offset of all pitch joints", ge=-1e3, le=1e3, default=0.0
    )
    references: tuple[float, ...] | None = quantity(
        "rad", "References of the joints, not the gait's", default=None
    )
    enabled: tuple[bool, ...] | None = option("Whether each joint's motor is on", default=None)
    thrusts: tuple[float, ...] | None = quantity(
        "N", "Thrust of every driven thruster", default=None
    )
    deflections: tuple[float, ...] | None = quantity(
        "rad", "Deflection of every driven pectoral fin", default=None
    )
    current: Current = quantity(
        "m/s", "Velocity of the water, or a flow", ge=-100.0, le=100.0, default=(0.0, 0.0)
    )


def read_scenario(
    message: Message, own_robots: Mapping[str, Robot], duration: float = 30.0
) -> scenarios.Scenario:
    """Build the scenario that a message requests; omitted fields take their defaults.

    Robots, waters and so on are given by name, and never read from a client's path.

    Args:
        message: The request.
        own_robots: The server's own robots, by name.
        duration: Duration, if the request is a run [s].

    Raises:
        BadKey: If a field is unknown or out of range.
        ValueError: If fields are incompatible.
    """
    command = read_command(message, interfaces.Command(gait=FIRST_GAIT))
    names, model = _given(message, NAMES), _given(message, MODEL)
    if isinstance(model.get("joints"), Mapping):
        del names["joints"]  # an object with a law's parameters, not a name
    else:
        model.pop("joints", None)
    start, choice = _given(message, START), codec.decode(scenarios.Choice, names)
    waters, parameters = (*robot.water_names(), TEXTBOOK), robot.parameter_names()
    presets = {"water": waters, "ground": robot.ground_names(), "parameters": parameters}
    for name, there in {"robot": (*robot.robot_names(), *own_robots), **presets}.items():
        if getattr(choice, name) is not None:
            check_choice(name, getattr(choice, name), there)
    chosen = choice.resolved(
        command.gait, lambda name, n_links: _robot(own_robots.get(name), name, n_links)
    )
    water = codec.table_of(message.get("coefficients") or {}, "coefficients") | _given(
        message, ("current",)
    )
    if water and not isinstance(chosen.environment, Water):
        raise BadArgument("ground", "must not be given with `coefficients` or `current`")
    return scenarios.Scenario(
        robot=chosen.robot,
        motion=interfaces.OpenLoop(command=command),
        environment=codec.updated(chosen.environment, water | _held(water, "current")),
        model=codec.updated(chosen.model, model),
        start=codec.decode(interfaces.Start, start | _held(start, "center_of_mass")),
        duration=duration,
        **_given(message, ("sample_interval",)),
    )


def commanded(scenario: scenarios.Scenario, message: Message) -> scenarios.Scenario:
    """Return a world's scenario with another command or current.

    Args:
        scenario: Scenario whose motion is a held command.
        message: Message with any of the fields in `HELD`.

    Raises:
        BadKey: If a field is unknown or out of range.
        ValueError: If the robot is on the ground, where there is no current.
    """
    motion, water = cast(interfaces.OpenLoop, scenario.motion), scenario.environment
    if message.get("current") is not None:
        if not isinstance(water, Water):
            raise BadArgument("current", f"must be null on the ground, got {message['current']}")
        flow = replace(water, **_held(message, "current"))
        water = water if flow == water else flow
    command = read_command(message, motion.command)
    return replace(scenario, motion=replace(motion, command=command), environment=water)


def read_command(message: Message, held: interfaces.Command) -> interfaces.Command:
    """Return the held command, updated with the fields of a message; omitted fields keep their values.

    Args:
        message: The request.
        held: The command in force until now.

    Raises:
        BadKey: If a field is unknown or out of range.
    """
    changes = _held(_given(message, ("offset", "pitch_offset")), "offset", "pitch_offset")
    # Octave and MATLAB write an array of one number as a scalar, and null as an empty array.
    said = {name: message[name] for name in LISTS if name in message}
    lists = {
        name: None if one == [] else [one] if isinstance(one, bool | int | float) else one
        for name, one in said.items()
    }
    changes |= _held(lists, *said)
    if message.get("gait") is not None:
        changes["gait"] = _gait(codec.table_of(message["gait"], "gait"), held.gait)
    return replace(held, **changes)


def _given(message: Message, names: Sequence[str]) -> dict[str, Any]:
    """Return the named fields that are present and not null."""
    return {name: message[name] for name in names if message.get(name) is not None}


def _held(said: Message, *names: str) -> dict[str, Any]:
    """Return the named fields that are present, decoded and checked."""
    mine = {name: said[name] for name in names if name in said}
    if '"source":' in json.dumps(mine.get("current"), default=str):
        raise BadArgument(
            "current", "must not name a file: the server reads no files for its clients"
        )
    if isinstance(name := mine.get("current"), str):
        mine["current"] = robot.load_current(check_choice("current", name, robot.current_names()))
    checked = codec.decode(InitialMessageState, mine)
    return {name: getattr(checked, name) for name in mine}


def _robot(own: Robot | None, name: str, n_links: int | None) -> Robot:
    found = load_robot(name) if own is None else own
    return (
        found
        if n_links is None
        else found.with_links(int(check_within("n_links", n_links, 1, MOST_LINKS)))
    )


def _gait(table: dict[str, Any], held: gaits.Gait) -> gaits.Gait:
    if not table.get("envelope", True):
        del table["envelope"]
    for name in {"pitch", "fin"} & table.keys():
        wave, at = table[name], f"gait.{name}"
        usual = {"amplitude": 0.0, "frequency": table.get("frequency", held.frequency)}
        table[name] = (
            None
            if wave is None or wave == []
            else codec.decode(Wave, usual | codec.table_of(wave, at), at)
        )
    return codec.updated(held, table, "gait")
