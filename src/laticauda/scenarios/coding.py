"""Scenarios and experiments as TOML, with every number: what trials keep and what people write.

What a text names and nobody here defines, a law or a controller, is kept as a stand-in: the trial of it loads, and only
running it again is refused. Nothing that a text names is imported.
"""

import warnings
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any, cast

from laticauda import extensions, files, gaits, robot
from laticauda.codec import BadKey, Table, arguments_of, check_keys, decode, encode, keeping_unknown, stamped, take_kind
from laticauda.errors import RobotFileError
from laticauda.fluid.grids import Grid
from laticauda.interfaces import Controller
from laticauda.quantities import hints_of
from laticauda.scenarios.scenario import Experiment, Scenario

KINDS: dict[str, type[Scenario] | type[Experiment]] = {"scenario": Scenario, "experiment": Experiment}


def run_to_toml(run: Scenario | Experiment) -> str:
    """A scenario or experiment as a text, from which `run_from_toml` makes an equal one.

    A function in it, a law that is no class for instance, cannot be stored: its name is, and a warning says so.

    Args:
        run: The scenario or experiment.
    """
    import tomli_w

    table = stamped(extensions.name_of(type(run)), {})
    for field in fields(run):
        value, hint = getattr(run, field.name), hints_of(type(run))[field.name]
        if isinstance(value, robot.Robot | robot.Water | robot.Ground):
            table[field.name] = stamped(extensions.name_of(type(value)), encode(value))
        elif field.name == "motion" and isinstance(value, Controller):
            table["controller"] = _stored(cast("Controller[Any]", value))
        elif value is not None:
            table["gait" if field.name == "motion" else field.name] = encode(value, hint)
    return tomli_w.dumps(_without_functions(table, ""))


def run_from_toml(text: str) -> Scenario | Experiment:
    """The scenario or experiment that `run_to_toml` made a text of.

    Args:
        text: The TOML text.

    Raises:
        BadKey: If a key is unknown, missing or out of range.
        RobotFileError: If robot or environment is wrong, or it is no TOML, or nested too deeply.
    """
    return run_from_table(files.parse_toml(text, "scenario", RobotFileError))


def run_from_table(table: Table) -> Scenario | Experiment:
    """The same from what the text holds.

    Args:
        table: As a TOML reader gives it.
    """
    table = dict(table)
    kind = KINDS[take_kind(table, *KINDS)]
    hints = hints_of(kind)
    motion = {"gait", "controller"} if kind is Scenario else set[str]()
    check_keys(table, [*(name for name in hints if name != "motion"), *motion])
    for name in ("robot", "environment"):
        if name not in table:
            raise BadKey(name, f"is missing; every {kind.__name__} needs it")
    with keeping_unknown(), arguments_of(""):
        values: Table = {"motion": motion_of(table)} if motion else {}
        for name, given in table.items():
            if name in ("robot", "environment"):
                values[name] = described(given)
            elif name not in motion:
                values[name] = decode(hints[name], given, name, kind.__dataclass_fields__[name].default)
        return kind(**values)


def unknown_in(run: Scenario) -> Iterator[extensions.Unknown]:
    """What a scenario names and nobody here defines.

    Args:
        run: The scenario.
    """
    yield from _unknown((run.motion, run.environment, run.model))


def _unknown(values: tuple[Any, ...]) -> Iterator[extensions.Unknown]:
    for value in values:
        if isinstance(value, extensions.Unknown):
            yield value
        elif is_dataclass(value):
            yield from _unknown(tuple(vars(value).values()))


def _stored(controller: Controller[Any]) -> Any:
    if is_dataclass(controller) or isinstance(controller, extensions.Unknown):
        return encode(controller, Controller)
    return {"kind": extensions.name_of(type(controller)), "gait": encode(cast(Any, controller).gait)}


def motion_of(table: Mapping[str, Any]) -> gaits.Gait | Controller[Any]:
    """The gait or the controller that a table says; a controller that nobody here defines is kept with its gait.

    Args:
        table: Of a scenario.

    Raises:
        BadKey: If there is none, or it is wrong.
    """
    if ("gait" in table) == ("controller" in table):
        raise BadKey("gait", "must be given, or `controller`, and not both")
    if "gait" in table:
        return decode(gaits.Gait, table["gait"], "gait")
    with keeping_unknown():
        controller: Any = decode(cast(Any, Controller), table["controller"], "controller")
    if isinstance(controller, extensions.Unknown):
        vars(controller)["gait"] = decode(gaits.Gait, controller.table.get("gait"), "controller.gait")
    return cast("Controller[Any]", controller)


def described(given: Any) -> Any:
    """The robot, water or ground that a table says; anything else as it is.

    Args:
        given: The table, with its kind.

    Raises:
        ValueError: If anything in it is wrong.
    """
    import tomli_w

    if is_dataclass(given):
        return given
    try:
        return robot.from_toml(tomli_w.dumps(given))
    except RobotFileError as error:
        raise ValueError(str(error).removeprefix("<text>: ")) from error


def _without_functions(table: Mapping[str, Any], at: str) -> Table:
    """The table with names in the place of functions, and kinds that nobody has where one stood."""
    found: Table = {}
    for name, value in table.items():
        if isinstance(value, Mapping):
            found[name] = _without_functions(cast("Mapping[str, Any]", value), f"{at}{name}.")
        elif callable(value) or isinstance(value, Grid):
            called = f"function {getattr(value, '__name__', value)}" if callable(value) else "Dataset in memory"
            text = f"`{at}{name}` is a {called}, which cannot be stored, nor the run done again."
            warnings.warn(f"{text} A law that is a class can, and a file.", stacklevel=2)
            return {"kind": called}
        elif value is not None:
            found[name] = value
    return found
