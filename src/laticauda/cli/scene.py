"""What swims, how and where: names are read first, and further flags change what they stand for."""

import sys
from collections.abc import Sequence
from dataclasses import fields, replace
from importlib import import_module
from pathlib import Path
from typing import Any, Self, TypeVar, cast

import laticauda as lc
from laticauda import robot
from laticauda.cli.command import Command
from laticauda.cli.flags import BadFlag, File, Options, accept_objects, parse_command, was_typed
from laticauda.cli.tables import parse_numbers
from laticauda.models import simulate
from laticauda.motion.gaits.gait import FIRST_GAIT
from laticauda.scenarios import (
    Choice,
    Model,
    Scenario,
    Spatial,
    load_scenario,
    model_of,
    named_after,
)
from laticauda.values import codec
from laticauda.values.errors import BadArgument, LaticaudaError
from laticauda.values.extensions import Extensible, name_of
from laticauda.values.quantities import option, quantity, value_class
from laticauda.water.fluid.flow import Flow

Kind = TypeVar("Kind", bound=Extensible)


@value_class
class Names(Choice, Options):
    """What swims, how and where, by name. The other flags change individual numbers."""

    water: str | None = option(
        "A preset, a file or textbook; none: textbook, for Mamba the paper's", default=None
    )
    gait: str = option(
        "The envelope g of alpha g(i, n) sin(omega t + (i-1) delta) + phi_0, i = 1 at the tail: lateral-undulation "
        "(1), eel-like ((n-i)/(n+1)), anguilliform ((n-i)/(n-1)), custom, or MODULE:CLASS of your own",
        default="lateral-undulation",
    )
    envelope: tuple[float, ...] | None = quantity(
        "", "g of every joint for the gait custom, tail first", default=None
    )
    joint_angles: File = option(
        "Joint angles over time instead of a gait: a preset, a CSV file (time_s, joint_1_deg at the tail, ...) or a "
        "trial; a wave given by --amplitude-deg is added to them",
        default=None,
    )
    law: str | None = option(
        "Drag law by name, or MODULE:CLASS of your own, which is imported", default=None
    )

    @classmethod
    def read(cls, words: Sequence[str], prog: str) -> Self:
        """Return the names among the words; the other words are left to be read later.

        Args:
            words: Words that were typed.
            prog: Name of the command in the help.
        """
        return parse_command(cls, words, prog, known_only=True)

    def motion(self) -> lc.Gait:
        """Return the gait of Mamba's first trial in the paper with the requested envelope, or a recorded gait."""
        if self.joint_angles is not None:
            return lc.recorded_gait(_recorded(self.joint_angles), envelope=self._envelope())
        return replace(FIRST_GAIT, envelope=self._envelope())

    def _envelope(self) -> lc.Envelope:
        if (self.envelope is None) == (self.gait == "custom"):
            rule = f"must be given for the gait custom, and only for it; --gait is {self.gait}, got {self.envelope}"
            raise BadArgument("envelope", rule)
        if self.envelope is not None:
            return lc.Custom(values=self.envelope)
        return find_member(lc.Envelope, self.gait.replace("_", "-"), "gait")

    def scenario(self, words: Sequence[str]) -> tuple[Scenario, str]:
        """Return the scenario that the names stand for, and the source of the environment in words.

        Args:
            words: Words that were typed. A file may come first; the names that were typed change
                its scenario.
        """
        if words and not words[0].startswith("-"):
            for option in (
                "gait",
                "law",
                "joints",
                "scene",
            ):  # a file imports nothing: what it names must be typed too
                import_law(getattr(self, option) or "", option)
            return self._changed(load_scenario(words[0]), words), f"as {words[0]} says"
        gait = self.motion()
        chosen = self._known().resolved(gait)
        environment = self._with_law(chosen.environment)
        found = Scenario(
            robot=chosen.robot, motion=gait, environment=environment, model=chosen.model
        )
        return found, chosen.origin

    def _changed(self, found: Scenario, words: Sequence[str]) -> Scenario:
        """Return a file's scenario, changed by the names that were typed."""
        typed = {name for name in NAMES if was_typed(name, words)}
        envelope = self._envelope() if typed & {"gait", "envelope"} else found.gait.envelope
        is_kept = "envelope" not in typed and type(envelope) is type(
            found.gait.envelope
        )  # with the file's numbers
        gait = found.gait if is_kept else replace(found.gait, envelope=envelope)
        gait = self.motion() if "joint_angles" in typed else gait

        def find_robot(name: str, n_links: int | None) -> lc.Robot:
            if "robot" in typed:
                return lc.load_robot(name, n_links)
            return found.robot if n_links is None else found.robot.with_links(n_links)

        chosen = self._known().resolved(gait, find_robot)
        where = (
            chosen.environment if typed & {"water", "ground", "parameters"} else found.environment
        )
        model = chosen.model if "model" in typed else found.model
        joints = self._known().joints if "joints" in typed else None
        if "scene" in typed:
            model = model_of(model, scene=self._known().scene)
        return replace(
            found,
            robot=chosen.robot,
            motion=gait
            if isinstance(found.motion, lc.Gait)
            else replace(cast("Any", found.motion), gait=gait),
            environment=self._with_law(where),
            model=model_of(model, joints=joints)
            if joints not in (None, name_of(type(model.joints)))
            else model,
        )

    def _known(self) -> Self:
        """Return these names; a joint law or a scene that is given as MODULE:CLASS is imported."""
        given = {
            name: import_law(one, name)
            for name in ("joints", "scene")
            if (one := getattr(self, name)) is not None
        }
        return replace(self, **given)

    def _with_law(self, environment: robot.Environment) -> robot.Environment:
        if self.law is None:
            return environment
        law, field = (
            find_member(lc.DragLaw, self.law, "law"),
            "drag" if isinstance(environment, lc.Water) else "friction",
        )
        is_kept = type(law) is type(
            getattr(environment, field)
        )  # with the numbers of the environment's law
        changes: Any = {field: law, "name": f"{environment.name} with {name_of(type(law))}"}
        return environment if is_kept else replace(environment, **changes)


def _recorded(name: str) -> lc.JointAngles:
    """Return the joint angles of a preset, a table, or a trial in any of its formats."""
    if Path(name).suffix in ("", ".csv"):
        return lc.load_joint_angles(name)
    from laticauda.trials.logs import load_trial

    return lc.JointAngles.of(load_trial(name))


def import_law(name: str, option: str) -> str:
    """Return the name of a law or an envelope; only MODULE:CLASS is ever imported.

    Args:
        name: Name that was typed.
        option: Field of the option, for messages.

    Raises:
        ValueError: If there is no such class.
    """
    module, colon, word = name.partition(":")
    if not colon:
        return name
    if "" not in sys.path:  # as for `python -m`: users' own files are in the current folder
        sys.path.insert(0, "")
    try:
        return name_of(getattr(import_module(module), word))
    except (ImportError, AttributeError) as error:
        raise BadArgument(option, f"must be a name or MODULE:CLASS, got {name}: {error}") from None


def find_member(base: type[Kind], name: str, option: str) -> Kind:
    """Return an instance of a subclass of `base`, given by name or as MODULE:CLASS, with its default values.

    Args:
        base: Base class of drag laws, envelopes or the like.
        name: Name that was typed.
        option: Field of the option, for messages.

    Raises:
        ValueError: If there is no such member.
    """
    try:
        return base.named(import_law(name, option))()
    except TypeError:
        raise BadArgument(
            option, f"must be one whose numbers all have defaults, got {name}"
        ) from None
    except BadArgument as error:
        raise BadArgument(option, error.rule) from None


def parse_current(words: Sequence[str]) -> Flow:
    """Return the flow that was typed: a preset, a file or MODULE:CLASS, then NAME=VALUE for its other numbers.

    Args:
        words: Words that were typed; an angle under its name with ``-deg``.

    Raises:
        BadFlag: If there is no such flow, or it has no such number.
    """
    name, *changes = words
    try:
        flow = find_member(Flow, name, "current") if ":" in name else robot.load_current(name)
        pairs = [parse_numbers("current", word, CHANGES) for word in changes]
        return codec.updated(
            flow, {key.replace("-", "_"): int(x) if x.is_integer() else x for key, _, (x,) in pairs}
        )
    except codec.BadKey as bad:
        raise BadFlag(f"--current {name}: {bad}") from None
    except BadArgument as error:
        raise BadFlag(f"--current {error.rule}.") from None
    except LaticaudaError as error:
        raise BadFlag(f"--current: {error}.") from None


CHANGES = "a preset or a file and NAME=NUMBER ..., such as swell height=0.2"
accept_objects(Flow, "NAME|PATH [NAME=NUMBER ...]", parse_current)


def warn_of_compiling(environment: robot.Environment, model: Model | str = "planar") -> None:
    """Print a notice if kernels will be compiled.

    Args:
        environment: Environment of the run.
        model: Model of the run.
    """
    if simulate.needs_compiling(environment, model):
        seconds = 25 if model == "spatial" or isinstance(model, Spatial) else 10
        print(
            f"compiling the kernels for this machine (once, about {seconds} s) ...",
            file=sys.stderr,
            flush=True,
        )


NAMES = tuple(field.name for field in fields(Names))


@value_class
class OfScenario(Command):
    """A command about one scenario: names select it, and each of its numbers is a flag."""

    choice: Names = option("Robot, gait and water, by name", default=Names())
    scenario: Scenario = option("Scenario that the names select; every number can be changed")
    before: Any = option(
        "What the names stand for, before single numbers were changed", default=None
    )
    origin: Any = option("Where the environment is from, in words", default="")

    @classmethod
    def read(cls, words: Sequence[str], prog: str) -> Any:
        """Return the command that was typed, reading its names first; see `Command.read`."""
        names = Names.read(words, prog)
        scenario, origin = names.scenario(words if "file" in cls.__dataclass_fields__ else ())
        return cls.about(scenario, words, prog, choice=names, origin=origin)

    @classmethod
    def about(cls, scenario: Scenario, words: Sequence[str], prog: str, **parts: Any) -> Self:
        """Return the command whose scenario is known except for individual numbers.

        Args:
            scenario: Scenario that the names stand for.
            words: Words that were typed.
            prog: Name of the command in the help.
            parts: Other fields that are known.
        """
        return parse_command(cls, words, prog, cls(scenario=scenario, before=scenario, **parts))

    @property
    def chosen(self) -> Scenario:
        """Scenario with the numbers that were typed; the name of its water states how it differs."""
        water, old = self.scenario.environment, self.before.environment
        if not isinstance(water, lc.Water) or not isinstance(old, lc.Water):
            return self.scenario
        return replace(self.scenario, environment=named_after(water, old))
