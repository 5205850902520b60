"""From the fields of a request to values: scenarios and commands.

Robots, waters and so on are given by name, and never read from a client's path.
"""

import functools
import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, cast

from laticauda import robot, scenarios
from laticauda.connect.messages import (
    CHOICE_FIELDS,
    LIST_FIELDS,
    MODEL_FIELDS,
    START_FIELDS,
    Message,
)
from laticauda.motion import gaits
from laticauda.motion.gaits import FIRST_GAIT, Wave
from laticauda.robot import TEXTBOOK, Current, Robot, Water
from laticauda.scenarios import interfaces
from laticauda.values import (
    BadArgument,
    check_choice,
    check_within,
    codec,
    option,
    quantity,
    value_class,
)

MOST_LINKS = 200
"""Links of a robot at most that a client may ask for [-]."""
WAVE_FIELDS = ("pitch", "fin")
"""Fields of a gait that are waves, and may be missing."""


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

    Args:
        message: The request.
        own_robots: The server's own robots, by name.
        duration: Duration, if the request is a run [s].

    Raises:
        BadKey: If a field is unknown or out of range.
        ValueError: If fields are incompatible.
    """
    command = read_command(message, interfaces.Command(gait=FIRST_GAIT))
    choice_fields = _select_present(message, CHOICE_FIELDS)
    model_fields = _select_present(message, MODEL_FIELDS)
    if isinstance(model_fields.get("joints"), Mapping):
        del choice_fields["joints"]  # an object with a law's parameters, not a name
    else:
        model_fields.pop("joints", None)
    start_fields = _select_present(message, START_FIELDS)
    choice = codec.decode(scenarios.Choice, choice_fields)
    _check_names(choice, own_robots)
    resolved = choice.resolved(command.gait, functools.partial(_load_robot, own_robots))

    water_fields = codec.table_of(message.get("coefficients") or {}, "coefficients")
    water_fields |= _select_present(message, ("current",))
    if water_fields and not isinstance(resolved.environment, Water):
        raise BadArgument("ground", "must not be given with `coefficients` or `current`")
    water_fields |= _decode_present(water_fields, ("current",))
    environment = codec.updated(resolved.environment, water_fields)
    model = codec.updated(resolved.model, model_fields)
    start_fields |= _decode_present(start_fields, ("center_of_mass",))
    return scenarios.Scenario(
        robot=resolved.robot,
        motion=interfaces.OpenLoop(command=command),
        environment=environment,
        model=model,
        start=codec.decode(interfaces.Start, start_fields),
        duration=duration,
        **_select_present(message, ("sample_interval",)),
    )


def _check_names(choice: scenarios.Choice, own_robots: Mapping[str, Robot]) -> None:
    """Reject what is not the name of a preset or of one of the server's own robots."""
    names_of_presets = {
        "robot": (*robot.robot_names(), *own_robots),
        "water": (*robot.water_names(), TEXTBOOK),
        "ground": robot.ground_names(),
        "parameters": robot.parameter_names(),
    }
    for field, names in names_of_presets.items():
        name = getattr(choice, field)
        if name is not None:
            check_choice(field, name, names)


def _load_robot(own_robots: Mapping[str, Robot], name: str, n_links: int | None) -> Robot:
    loaded_robot = own_robots.get(name)
    if loaded_robot is None:
        loaded_robot = robot.load_robot(name)
    if n_links is None:
        return loaded_robot
    return loaded_robot.with_links(int(check_within("n_links", n_links, 1, MOST_LINKS)))


def change_scenario(scenario: scenarios.Scenario, message: Message) -> scenarios.Scenario:
    """Return a world's scenario with another command or current.

    Args:
        scenario: Scenario whose motion is a held command.
        message: Message with any of the fields in `COMMAND_FIELDS`.

    Raises:
        BadKey: If a field is unknown or out of range.
        ValueError: If the robot is on the ground, where there is no current.
    """
    environment = scenario.environment
    if message.get("current") is not None:
        if not isinstance(environment, Water):
            raise BadArgument("current", f"must be null on the ground, got {message['current']}")
        changed_water = replace(environment, **_decode_present(message, ("current",)))
        if changed_water != environment:
            environment = changed_water
    motion = cast(interfaces.OpenLoop, scenario.motion)
    command = read_command(message, motion.command)
    return replace(scenario, motion=replace(motion, command=command), environment=environment)


def read_command(message: Message, command: interfaces.Command) -> interfaces.Command:
    """Return the held command, updated with the fields of a message; omitted fields keep their values.

    Args:
        message: The request.
        command: The command in force until now.

    Raises:
        BadKey: If a field is unknown or out of range.
    """
    offsets = _select_present(message, ("offset", "pitch_offset"))
    changes = _decode_present(offsets, ("offset", "pitch_offset"))
    lists = {field: _read_list(message[field]) for field in LIST_FIELDS if field in message}
    changes |= _decode_present(lists, LIST_FIELDS)
    if message.get("gait") is not None:
        gait_fields = codec.table_of(message["gait"], "gait")
        changes["gait"] = _read_gait(gait_fields, command.gait)
    return replace(command, **changes)


def _read_list(value: Any) -> Any:
    """Return a list: Octave and MATLAB write an array of one number as a scalar, and null as an empty array."""
    if value == []:
        return None
    if isinstance(value, bool | int | float):
        return [value]
    return value


def _read_gait(fields: dict[str, Any], gait: gaits.Gait) -> gaits.Gait:
    if not fields.get("envelope", True):
        del fields["envelope"]
    frequency = fields.get("frequency", gait.frequency)
    for name in WAVE_FIELDS:
        if name in fields:
            fields[name] = _read_wave(fields[name], f"gait.{name}", frequency)
    return codec.updated(gait, fields, "gait")


def _read_wave(value: Any, path: str, frequency: Any) -> Wave | None:
    """Return a wave that has the gait's frequency unless it states its own."""
    if value is None or value == []:
        return None
    defaults = {"amplitude": 0.0, "frequency": frequency}
    return codec.decode(Wave, defaults | codec.table_of(value, path), path)


def _select_present(message: Message, names: Sequence[str]) -> dict[str, Any]:
    """Return the named fields that are present and not null."""
    return {name: message[name] for name in names if message.get(name) is not None}


def _decode_present(message: Message, names: Sequence[str]) -> dict[str, Any]:
    """Return the named fields of `InitialMessageState` that are present, decoded and checked."""
    fields = {name: message[name] for name in names if name in message}
    if "current" in fields:
        fields["current"] = _load_current(fields["current"])
    state = codec.decode(InitialMessageState, fields)
    return {name: getattr(state, name) for name in fields}


def _load_current(value: Any) -> Any:
    """Return a current, of which presets are given by name; files are rejected."""
    if '"source":' in json.dumps(value, default=str):
        raise BadArgument(
            "current", "must not name a file: the server reads no files for its clients"
        )
    if isinstance(value, str):
        return robot.load_current(check_choice("current", value, robot.current_names()))
    return value
