"""What there is to attack, as the package itself tells it: whatever is added there is attacked without a line here.

- `find_options`: the options of every command, from the records that the program reads its flags from;
- `find_fields`: the fields of every request to `laticauda serve`, from the schema of its messages;
- `find_calls`: every public function and class of every package. Methods are not among them: what has
  the wrong type for one is said by Python.

What is left out stands in `LEFT_OUT_OPTIONS` and `LEFT_OUT_CALLS`, with the reason; tests ask whether
anything else is missing.
"""

import contextlib
import importlib
import inspect
import io
import pkgutil
import types
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, dataclass, field
from enum import Enum
from typing import Any

import laticauda as lc
from laticauda.cli import app, flags, scene
from laticauda.cli.flag_names import FLAG_NAMES, is_internal
from laticauda.cli.wave_flags import wave_flags
from laticauda.connect import message_schema, messages
from laticauda.values import Field, LaticaudaError, fields_of

# ---- options -------------------------------------------------------------------------------------

GAIT = "--amplitude-deg 30 --frequency-deg-s 130 --phase-shift-deg 40"
RUNS: Mapping[str, tuple[str, ...]] = {
    "swim": (
        "swim --duration 0.1",
        "swim --duration 0.1 --robot mamba-fin",
        "swim --duration 0.1 --model spatial",
        "swim --duration 0.1 --joints servo",
        "swim --duration 0.1 --joints speed-servo",
        "swim --duration 0.1 --ground viscous",
        "swim --duration 0.1 --gait custom --envelope 1 1 1 1 1 1 1 1",
        "swim scenario.toml --duration 0.1",
        "swim --resume trial.nc --duration 0.1",
    ),
    "follow": (
        "follow --duration 0.1",
        "follow --duration 0.1 --path 0 0 1 0",
        "follow --duration 0.1 --robot mamba-fin --joints servo",
    ),
    "reproduce": ("reproduce --only efficiency --workers 1 --output out",),
    "sweep": (
        "sweep --duration 0.1 --vary amplitude-deg=10,20 --output out",
        "sweep --duration 0.1 --list points.csv --output out",
    ),
    "optimize": (
        "optimize --duration 0.5 --vary amplitude-deg=10:20 --budget 4 --population 4 --output out",
    ),
    "identify": (
        "identify trial.nc --parameters water.normal_drag --robot mamba --starts 1 --threads 1 --output out",
        "identify task.toml --quick --output out",
    ),
    "mission": ("mission net-inspection --duration 2 --save new.nc",),
    "predict": ("predict fit",),
    "design-experiment": (
        "design-experiment --parameters water.normal_drag --sensors speed --trials 1 --output plan.png",
    ),
    "view": ("view trial.nc --still new.png --size 64 64",),
    "export mjcf": ("export mjcf --output new.xml",),
    "export urdf": ("export urdf --output new.urdf",),
    "export fmu": ("export fmu --output new.fmu",),
    "export c": ("export c --output new.h",),
    "export web": ("export web --output page",),
    "import farms": (
        "import farms animat.yaml --output new.toml",
        "import farms test_eel.sdf --head skull",
    ),
    "tags": ("tags --robot mamba --output new.pdf",),
    "lens": ("lens glide.mp4 --columns 9 --rows 6 --square 0.025 --output new.toml",),
    "camera": ("camera glide.mp4 --tags tags.toml --height 0.1 --output new.toml",),
    "track": ("track glide.mp4 --tags tags.toml --height 0.1 --straight --save new.nc",),
    "inverse": ("inverse lamprey.csv --robot eel --length 0.157 --draws 10",),
    "lab": ("lab --duration 0.3 --port 0",),
    "operate": ("operate operation.toml --check", "operate --check operation.toml --speed 1"),
    "drivers": ("drivers",),
    "replay": ("replay recording.mcap",),
    "cockpit": ("cockpit --port 0",),
    "serve": ("serve --port 0",),
    "robots": ("robots", "robots mamba"),
    "trial show": ("trial show trial.nc", "trial show log.csv --columns map.toml"),
    "trial compare": ("trial compare trial.nc trial.csv",),
    "trial plot": ("trial plot trial.nc --output new.svg",),
    "trial convert": ("trial convert trial.nc new.csv",),
}
"""Runs that work, by command, in a folder with the files of `pantry`: an odd word is added to one of them."""
SERVERS = ("cockpit", "serve", "lab")
"""Commands that serve until Ctrl-C."""
LEFT_OUT_OPTIONS: Mapping[str, str] = {
    "--help": "prints the help, and reads nothing",
    "-h": "is --help",
}
"""Flags in the help of commands that are not attacked, and why."""


@dataclass(frozen=True, kw_only=True)
class OptionTarget:
    """An option of a command."""

    command: str
    run: tuple[str, ...]
    """Words of a run of it that works."""
    flag: str
    """The flag, or the word of the help for a file without one, such as FILE."""

    @property
    def is_server(self) -> bool:
        """Whether the command serves until Ctrl-C."""
        return self.command in SERVERS


def find_options() -> list[OptionTarget]:
    """Return every option of every command, in a folder with the files of `pantry`, once for each of `RUNS`."""
    targets: list[OptionTarget] = []
    for command in app.COMMANDS:
        for line in RUNS.get(command, (command,)):
            words = tuple(line.split())
            for flag in flags_of_run(command, words):
                targets.append(OptionTarget(command=command, run=words, flag=flag))
    return targets


def flags_of_run(command: str, run: tuple[str, ...]) -> list[str]:
    """Return the options that a command has beside these words, as they are typed.

    Args:
        command: Its name.
        run: Words of a run that works.
    """
    arguments = run[len(command.split()) :]
    command_class: Any = app._import_command(command)
    with contextlib.redirect_stderr(io.StringIO()):
        try:
            value = command_class.read(arguments, f"{app.PROGRAM} {command}")
        except (SystemExit, ValueError, flags.BadFlag, LaticaudaError):
            value = _unread_command(command_class)
    found: list[str] = []
    for part in flags.parts_of(value):
        for option in fields_of(type(part)).values():
            found += _flags_of_field(option, part)
    return list(dict.fromkeys(found))


def _unread_command(command_class: Any) -> Any:
    """Return a command of which no run is known whose files are there: with its defaults, and texts for the rest."""
    values: dict[str, Any] = {}
    for option in fields_of(command_class).values():
        if option.make_default() is MISSING:
            values[option.name] = "missing"
    if issubclass(command_class, scene.OfScenario):
        names = scene.Names()
        values["scenario"] = names.resolve_scenario((), accepts_file=False).scenario
    return command_class(**values)


def _flags_of_field(option: Field, part: Any) -> list[str]:
    """Return how an option of a command, or of a part of one, is typed: no flag, one, or one for each number."""
    if is_internal(option) or FLAG_NAMES.is_hidden(option):
        return []
    if FLAG_NAMES.is_optional_wave(option):
        return [flags.spell_flag(wave.spec.name) for wave in wave_flags(option, part)]
    if flags.is_declared(getattr(part, option.name)):
        return []
    flag = flags.spell_option(option)
    if option.hint is bool and getattr(part, option.name) is True:
        return [flag, flag.replace("--", "--no-", 1)]
    return [flag]


# ---- fields of messages --------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class FieldTarget:
    """A field of a request."""

    request: str
    path: tuple[str, ...]
    """Its name; behind that of another field, if it is a field of that one's object."""
    schema: Mapping[str, Any] = field(repr=False)
    """What the schema says of it."""


def find_fields() -> list[FieldTarget]:
    """Return every field of every request that the schema of messages knows."""
    definitions = message_schema()["$defs"]
    targets: list[FieldTarget] = []
    for request in messages.REQUEST_FIELDS:
        for path, schema in _fields_in(definitions[request]):
            targets.append(FieldTarget(request=request, path=path, schema=schema))
    return targets


def _fields_in(schema: Mapping[str, Any]) -> Iterator[tuple[tuple[str, ...], Mapping[str, Any]]]:
    """Yield the fields of an object in a schema, and of the objects in it, by their paths."""
    for choice in (schema, *schema.get("anyOf", ())):
        for name, inner in choice.get("properties", {}).items():
            yield (name,), inner
            for path, innermost in _fields_in(inner):
                yield (name, *path), innermost


# ---- calls ---------------------------------------------------------------------------------------

MODULES = ("robot.hydrodynamics", "robot.kinematics", "scenarios.interfaces")
"""Modules that users import as they are."""
NO_CALLS = ("laticauda.cli",)
"""Packages whose names are attacked otherwise: the program is called with words."""
LEFT_OUT_CALLS: Mapping[str, str] = {
    "laticauda.motion.joints.motor_power": "is a formula on numbers, which kernels compile",
    "laticauda.motion.joints.servo": "is a formula on numbers, which kernels compile",
    "laticauda.motion.joints.speed_servo": "is a formula on numbers, which kernels compile",
    "laticauda.water.fluid.plate": "is a formula on numbers, which kernels compile",
    "laticauda.robot.kinematics.from_quaternion": "is a formula on numbers, called for every sample",
    "laticauda.scenarios.interfaces.fin_signals": "takes the arrays of a model, not of a user",
}
"""Public names that are not called, and why; exceptions, protocols and types of keywords need no line."""


@dataclass(frozen=True, kw_only=True)
class CallTarget:
    """A parameter of a public function or class."""

    name: str
    function: Callable[..., Any] = field(repr=False)
    parameter: str


def public_packages() -> list[str]:
    """Return the names of all packages with a list of public names, and of `MODULES`."""
    names = [lc.__name__]
    for module in pkgutil.walk_packages(lc.__path__, f"{lc.__name__}."):
        if module.ispkg and module.name not in NO_CALLS:
            names.append(module.name)
    return [*names, *(f"{lc.__name__}.{name}" for name in MODULES)]


def public_names(module: types.ModuleType) -> list[str]:
    """Return the public names of a package or module; without a list, those that it defines itself.

    Args:
        module: The package or module.
    """
    listed: list[str] | None = getattr(module, "__all__", None)
    if listed is not None:
        return listed
    if hasattr(module, "__path__"):
        return []
    return [
        name
        for name, content in vars(module).items()
        if not name.startswith("_") and getattr(content, "__module__", "") == module.__name__
    ]


def public_things() -> dict[str, Callable[..., Any]]:
    """Return every public function and class that can be called, by its name, each once."""
    found: dict[int, tuple[str, Callable[..., Any]]] = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        for package in public_packages():
            module = importlib.import_module(package)
            for name in public_names(module):
                thing = getattr(module, name)
                full_name = f"{package}.{name}"
                if full_name not in LEFT_OUT_CALLS and is_callable(thing):
                    found.setdefault(id(thing), (full_name, thing))
    return dict(sorted(found.values()))


def is_callable(thing: Any) -> bool:
    """Return whether this is a function or a class that users call: nothing abstract, no error or type of keywords.

    Args:
        thing: What has a public name.
    """
    if not callable(thing):
        return False
    try:
        inspect.signature(thing)
    except (TypeError, ValueError):  # a union of types, for instance, or an exception
        return False
    if not isinstance(thing, type):
        return True
    is_protocol = getattr(thing, "_is_protocol", False) or inspect.isabstract(thing)
    return not (issubclass(thing, (BaseException, Enum)) or is_protocol)


def find_calls() -> list[CallTarget]:
    """Return every parameter of every public call."""
    targets: list[CallTarget] = []
    for name, function in public_things().items():
        for parameter in named_parameters(function):
            targets.append(CallTarget(name=name, function=function, parameter=parameter.name))
    return targets


def named_parameters(function: Callable[..., Any]) -> list[inspect.Parameter]:
    """Return the parameters of a call that can be given by name.

    Args:
        function: A function or class.
    """
    parameters = inspect.signature(function).parameters.values()
    kinds = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    return [one for one in parameters if one.kind in kinds and one.name != "self"]
