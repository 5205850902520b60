"""What swims, how and where: names are read first, and further flags change what they stand for.

The flags of a command depend on what the names stand for: each number of that robot's gait, water
and model is one. So a command about a scenario is read twice: first its `Names` alone, and then, on
the scenario that they stand for, everything.
"""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple, Self, cast

import laticauda as lc
from laticauda import robot
from laticauda.cli.command import Command
from laticauda.cli.flags import (
    ColumnNames,
    File,
    Internal,
    Options,
    ScenarioArgument,
    options_of,
    parse_command,
    was_typed,
)
from laticauda.cli.laws import find_member, import_law
from laticauda.cli.shared_options import column_option, read_columns
from laticauda.cli.short_forms import write_out
from laticauda.models import simulate
from laticauda.motion.gaits import FIRST_GAIT
from laticauda.scenarios import (
    Choice,
    Model,
    Scenario,
    Spatial,
    load_scenario,
    model_of,
    named_after,
    preset_water,
    take_identified_parameters,
)
from laticauda.values import BadArgument, fields_of, name_of, option, quantity, value_class

NO_COEFFICIENTS = ("name", "density", "current", "depth")
"""Options of a water that say where and in what the robot swims, not how it is loaded."""
IMPORTED_NAMES = ("gait", "law", "joints", "scene")
"""Names that may be MODULE:CLASS, of a class of the user's own, which is imported."""
TABLE_ENDINGS = (".tsv", ".txt", ".xlsx")
"""Endings of tables other than .csv, which presets have, too."""
COMPILING_TIME = 10
"""Typical time to compile the kernels of the planar model [s]."""
COMPILING_TIME_IN_SPACE = 25
"""Typical time to compile those of the spatial model [s]."""


class NamedScenario(NamedTuple):
    """What names stand for."""

    scenario: Scenario
    origin: str
    """Source of the environment, in words."""
    basis: str = ""
    """What its numbers rest on, in sentences; "" if that is not known."""


@value_class
class Names(Choice, Options):
    """What swims, how and where, by name. The other flags change individual numbers."""

    # `Choice` has robot, ground, parameters, model, scene and joints.
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
    column: ColumnNames = column_option("--joint-angles")
    law: str | None = option(
        "Drag law by name, or MODULE:CLASS of your own, which is imported", default=None
    )

    @classmethod
    def read(cls, arguments: Sequence[str], prog: str) -> Self:
        """Return the names among the arguments; the others are left to be read later.

        Args:
            arguments: What was typed.
            prog: Name of the command in the help.
        """
        return parse_command(cls, arguments, prog, known_only=True)

    def choose_gait(self) -> lc.Gait:
        """Return the gait of Mamba's first trial in the paper with the requested envelope, or a recorded gait."""
        columns = read_columns(self.column, self.joint_angles, "joint-angles")
        if self.joint_angles is None:
            return replace(FIRST_GAIT, envelope=self.choose_envelope())
        angles = _load_joint_angles(self.joint_angles, columns)
        return lc.recorded_gait(angles, envelope=self.choose_envelope())

    def choose_envelope(self) -> lc.Envelope:
        """Return the envelope of the gait that was named."""
        is_custom = self.gait == "custom"
        if is_custom != (self.envelope is not None):
            rule = f"must be given for the gait custom, and only for it; --gait is {self.gait}"
            raise BadArgument("envelope", f"{rule}, got {self.envelope}")
        if self.envelope is not None:
            return lc.Custom(values=self.envelope)
        return find_member(lc.Envelope, self.gait.replace("_", "-"), "gait")

    def resolve_scenario(
        self, arguments: Sequence[str], *, accepts_file: bool = True
    ) -> NamedScenario:
        """Return the scenario that the names stand for.

        Args:
            arguments: What was typed.
            accepts_file: Whether a file may come first; the names that were typed then change its
                scenario.
        """
        if accepts_file and arguments and not arguments[0].startswith("-"):
            return self._scenario_of_file(arguments)
        gait = self.choose_gait()
        names = self.with_imports()
        # Whoever says nothing of the water or the joints gets what was identified on the robot.
        if not self._say_coefficients(arguments):
            names = take_identified_parameters(names)
        choice = names.resolved(gait)
        scenario = Scenario(
            robot=choice.robot,
            motion=gait,
            environment=self.with_law(choice.environment),
            model=choice.model,
        )
        return NamedScenario(scenario, choice.origin, choice.basis)

    def _say_coefficients(self, arguments: Sequence[str]) -> bool:
        """Return whether something is typed whose base are the paper's coefficients, with prescribed joints.

        That is a law, joint angles over time, or a coefficient of the paper's water.
        """
        if self.law is not None or self.joint_angles is not None:
            return True
        return says_coefficients(arguments)

    def _scenario_of_file(self, arguments: Sequence[str]) -> NamedScenario:
        """Return the scenario of a file, changed by the names that were typed."""
        for field_name in IMPORTED_NAMES:  # a file imports nothing: its classes must be typed, too
            import_law(getattr(self, field_name) or "", field_name)
        path = arguments[0]
        typed_names = frozenset(
            field.name for field in fields_of(Names).values() if was_typed(field, arguments)
        )
        change = _ScenarioChange(names=self, typed_names=typed_names)
        scenario = change.apply(load_scenario(path))
        return NamedScenario(scenario, f"as {path} says")

    def with_imports(self) -> Self:
        """Return these names; a joint law or a scene that is given as MODULE:CLASS is imported."""
        names = self
        if self.joints is not None:
            names = replace(names, joints=import_law(self.joints, "joints"))
        if self.scene is not None:
            names = replace(names, scene=import_law(self.scene, "scene"))
        return names

    def with_law(self, environment: robot.Environment) -> robot.Environment:
        """Return an environment with the requested law; one that has it already keeps its numbers.

        Args:
            environment: Water or ground.
        """
        if self.law is None:
            return environment
        law = find_member(lc.DragLaw, self.law, "law")
        field_name = "friction"
        if isinstance(environment, lc.Water):
            field_name = "drag"
        if type(law) is type(getattr(environment, field_name)):
            return environment
        name = f"{environment.name} with {name_of(type(law))}"
        changes: Any = {field_name: law, "name": name}
        return replace(environment, **changes)


def says_coefficients(arguments: Sequence[str]) -> bool:
    """Return whether a coefficient of the water is typed, whose base are the paper's coefficients.

    Args:
        arguments: What was typed: a coefficient as an option, or as one of several numbers that a
            command varies (`normal-drag=1:2:10`).
    """
    words = [argument for argument in arguments if not argument.startswith("-")]
    as_options = [f"--{word}" for word in words]  # normal-drag=1:2:10 like --normal-drag=...
    coefficients = [
        field
        for field in options_of(preset_water("paper-lateral"))
        if field.name not in NO_COEFFICIENTS
    ]
    return any(was_typed(field, [*arguments, *as_options]) for field in coefficients)


@dataclass(frozen=True)
class _ScenarioChange:
    """Changes the scenario of a file by the names that were typed; everything else stays as in the file.

    Names that were not typed have defaults, which must not replace what the file says: so each
    method asks first whether its name was typed.
    """

    names: Names
    typed_names: frozenset[str]
    """Those that were typed; all others have their defaults."""

    def apply(self, scenario: Scenario) -> Scenario:
        gait = self._change_gait(scenario.gait)

        def find_robot(name: str, n_links: int | None) -> lc.Robot:
            return self._change_robot(scenario.robot, name, n_links)

        choice = self.names.with_imports().resolved(gait, find_robot)
        environment = scenario.environment
        if self._are_typed("water", "ground", "parameters"):
            environment = choice.environment
        model = scenario.model
        if self._are_typed("model"):
            model = choice.model
        model = self._with_scene(model)
        return replace(
            scenario,
            robot=choice.robot,
            motion=_motion_with_gait(scenario, gait),
            environment=self.names.with_law(environment),
            model=self._with_joints(model),
        )

    def _are_typed(self, *names: str) -> bool:
        """Return whether at least one of these was typed."""
        return not self.typed_names.isdisjoint(names)

    def _change_gait(self, gait: lc.Gait) -> lc.Gait:
        if self._are_typed("joint_angles", "column"):
            return self.names.choose_gait()
        if self._are_typed("gait", "envelope"):
            envelope = self.names.choose_envelope()
            is_same_kind = type(envelope) is type(gait.envelope)
            if self._are_typed("envelope") or not is_same_kind:  # else it keeps the file's numbers
                return replace(gait, envelope=envelope)
        return gait

    def _change_robot(self, robot_of_file: lc.Robot, name: str, n_links: int | None) -> lc.Robot:
        if self._are_typed("robot"):
            return lc.load_robot(name, n_links)
        if n_links is None:
            return robot_of_file
        return robot_of_file.with_links(n_links)

    def _with_scene(self, model: Model) -> Model:
        if not self._are_typed("scene"):
            return model
        return model_of(model, scene=self.names.with_imports().scene)

    def _with_joints(self, model: Model) -> Model:
        if not self._are_typed("joints"):
            return model
        joints = self.names.with_imports().joints
        if joints is None or joints == name_of(type(model.joints)):
            return model
        return model_of(model, joints=joints)


def _motion_with_gait(scenario: Scenario, gait: lc.Gait) -> Any:
    if isinstance(scenario.motion, lc.Gait):
        return gait
    return replace(cast("Any", scenario.motion), gait=gait)


def _load_joint_angles(name: str, columns: Mapping[str, str]) -> lc.JointAngles:
    """Return the joint angles of a preset, a table, or a trial in any of its formats."""
    ending = Path(name).suffix.lower()
    if ending in ("", ".csv"):
        return lc.load_joint_angles(name, columns=columns)
    if ending in TABLE_ENDINGS:
        return lc.load_joint_angles(Path(name), columns=columns)
    if columns:
        raise BadArgument("column", f"must be given with a table, but {name} is a trial")
    from laticauda.trials.logs import load_trial

    return lc.JointAngles.of(load_trial(name))


def warn_of_compiling(
    environment: robot.Environment,
    model: Model | str = "planar",
    swimmer: robot.Robot | None = None,
) -> None:
    """Print a notice if kernels will be compiled.

    Args:
        environment: Environment of the run.
        model: Model of the run.
        swimmer: Robot of the run; None: one without a fin.
    """
    if not simulate.needs_compiling(environment, model, swimmer):
        return
    seconds = COMPILING_TIME
    if model == "spatial" or isinstance(model, Spatial):
        seconds = COMPILING_TIME_IN_SPACE
    notice = f"compiling the kernels for this machine (once, about {seconds} s) ..."
    print(notice, file=sys.stderr, flush=True)


@value_class
class OfScenario(Command):
    """A command about one scenario: names select it, and each of its numbers is a flag.

    A command runs `scenario_to_run`; `scenario` and `scenario_as_named` are what it is made of.
    """

    choice: Names = option("Robot, gait and water, by name", default=Names())
    scenario: Scenario = option("Scenario that the names select; every number can be changed")
    scenario_as_named: Internal = option(
        "What the names stand for, before single numbers were changed", default=None
    )
    origin: Internal = option("Where the environment is from, in words", default="")
    basis: Internal = option("What its numbers rest on, in sentences", default="")

    @classmethod
    def read(cls, arguments: Sequence[str], prog: str) -> Any:
        """Return the command that was typed, reading its names first; see `Command.read`."""
        accepts_file = issubclass(cls, OfScenarioOrFile)
        arguments = write_out(arguments, accepts_file=accepts_file)
        names = Names.read(arguments, prog)
        named = names.resolve_scenario(arguments, accepts_file=accepts_file)
        return cls.read_numbers(
            named.scenario,
            arguments,
            prog,
            choice=names,
            origin=named.origin,
            basis=named.basis,
        )

    @classmethod
    def read_numbers(
        cls, scenario: Scenario, arguments: Sequence[str], prog: str, **known_fields: Any
    ) -> Self:
        """Return the command that was typed, whose scenario is known except for individual numbers.

        The second of the two readings: every number of the scenario is a flag now.

        Args:
            scenario: Scenario that the names stand for.
            arguments: What was typed.
            prog: Name of the command in the help.
            known_fields: Other fields, read before.
        """
        default = cls(scenario=scenario, scenario_as_named=scenario, **known_fields)
        return parse_command(cls, arguments, prog, default)

    @property
    def scenario_to_run(self) -> Scenario:
        """Scenario with the numbers that were typed; the name of its water states how it differs."""
        environment = self.scenario.environment
        named_environment = self.scenario_as_named.environment
        if not isinstance(environment, lc.Water) or not isinstance(named_environment, lc.Water):
            return self.scenario
        water = named_after(environment, named_environment)
        return replace(self.scenario, environment=water)


@value_class
class OfScenarioOrFile(OfScenario):
    """A command about one scenario, which may come from a file."""

    file: ScenarioArgument = option(
        "Scenario file (.toml) that the options modify; must come first", default=None
    )
