"""Parameters that can be swept: every number in robot, gait, environment and joint law, by a dotted name.

A name is the path to the field: `gait.amplitude`, `water.normal_drag`, `robot.caudal_fin.length`.
The singular of a plural field addresses all of its items alike: `robot.module.mass`,
`robot.joint.actuator.servo_gain`. Brackets select some of them, counted from 0 at the tail, in
ranges as in Python: `robot.module[3].mass`, `robot.module[:5].mass`, `robot.joint[::2].stiffness`,
and `gait.amplitude[4]`, `gait.phase[2]` of the joints in a gait (`joint_motion`). All modules
together have tapers: `robot.taper.mass.tail`, `.head` and `.bulge` (`tapers`).
A pair of numbers is two parameters: `water.current_x`, `water.current_y`; a flow has each of its
numbers: `water.current.height`, and a sum of flows those of each flow:
`water.current.flow[0].height`. `robot.n_links` is the number of links; `joints` has the numbers of
a custom joint law, and `controller` those of a controller, apart from its gait:
`controller.guidance.look_ahead_distance`. Units are those of the fields: SI and radians.
"""

import difflib
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, cast

import numpy as np

from laticauda.models.simulate import joint_motion, tapers
from laticauda.models.simulate.parameter_paths import (
    AXIS_ENDINGS,
    COUNT_TYPES,
    PLURALS,
    SINGULARS,
    SINGULARS_OF_SEPARATE,
    Changes,
    apply_changes,
    describe_step,
    find_objects,
    find_part,
    have_common_items,
    items_of,
    nest_by_step,
    strip_items,
)
from laticauda.models.simulate.run_figures import (  # where they were found so far
    UNITS as UNITS,
    described as described,
    of_figure as of_figure,
)
from laticauda.motion.gaits import Gait
from laticauda.robot import Current, Environment, Robot, Water
from laticauda.scenarios import Motion, OpenLoop, Scenario
from laticauda.values import BadArgument, hints_of, quantities_of, texts_of
from laticauda.values.packaging import renamed_names

NUMBER_TYPES = (float, float | None)
"""Types of the fields that hold a number other than a count."""
VECTOR_TYPES = (
    tuple[float, float],
    tuple[float, float] | None,
    tuple[float, float, float],
    Current,
)
"""Types of the fields that hold one number per axis."""


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """A number that can be swept."""

    name: str
    """Dotted path to the field."""
    unit: str
    """Its unit; "" for a pure number."""
    title: str
    """Title, in a few words."""
    is_whole: bool = False
    """Whether it is a count, and must be a whole number."""

    @property
    def phrase(self) -> str:
        """Name in words, as on a plot axis: height of the caudal fin."""
        root, *owners, last = self.name.split(".")
        if root == "gait" and joint_motion.is_of_joints(last):
            joints = last.replace(strip_items(last), "joint")
            return f"{strip_items(last)} of {describe_step(joints)}"
        axis = ""
        if last.endswith(AXIS_ENDINGS):
            axis = f", {last[-1]}"
            last = last[:-2]
        number = last.replace("_", " ")
        if last.startswith("n_"):
            number = f"number of {number[2:]}"
        if (root, last) == ("gait", "frequency"):
            number = f"angular {number}"
        return " of ".join([number, *map(describe_step, reversed(owners))]) + axis


class ScenarioParameters(Mapping[str, Parameter]):
    """Parameters of a scenario by name; names of single parts and of ranges are found without being listed.

    Those of robot, gait and so on are listed when one of them is asked for.
    """

    def __init__(
        self, scenario: Scenario, *, lists_parts: bool = False, further: Mapping[str, Parameter]
    ) -> None:
        self._scenario = scenario
        self._lists_parts = lists_parts
        """Whether the numbers of every single module and joint are listed."""
        self._further = further
        """Parameters besides those of the scenario."""
        self._listed: dict[str, dict[str, Parameter]] = {}
        """Listed parameters by the first word of their names."""
        self._found: dict[str, Parameter] = {}
        """Parameters of single parts and of ranges that were asked for."""

    def __getitem__(self, name: str) -> Parameter:
        """Return the parameter of a name."""
        listed = self._find_listed(name)
        if listed is not None:
            return listed
        if name not in self._found:
            parameter = _find_of_parts(self._scenario, name)
            if parameter is None:
                raise KeyError(name)
            self._found[name] = parameter
        return self._found[name]

    def __iter__(self) -> Iterator[str]:
        """Yield the names that are listed."""
        names: dict[str, None] = {}
        for root in _roots_of(self._scenario):
            names |= dict.fromkeys(self._list_of_root(root))
        return iter(names | dict.fromkeys(self._further))

    def __len__(self) -> int:
        """Return the number of names that are listed."""
        return len(list(iter(self)))

    def __or__(self, further: Mapping[str, Parameter]) -> "ScenarioParameters":
        """Return these and further ones."""
        all_further = {**self._further, **further}
        return ScenarioParameters(
            self._scenario, lists_parts=self._lists_parts, further=all_further
        )

    def _find_listed(self, name: object) -> Parameter | None:
        """Return a parameter that is listed; None if it is not."""
        if not isinstance(name, str):
            return None
        if name in self._further:
            return self._further[name]
        root = name.partition(".")[0]
        return self._list_of_root(root).get(name)

    def _list_of_root(self, root: str) -> dict[str, Parameter]:
        """Return the listed parameters whose names begin with a word."""
        if root not in self._listed:
            parameters = _numbers_of_root(self._scenario, root, lists_parts=self._lists_parts)
            self._listed[root] = {parameter.name: parameter for parameter in parameters}
        return self._listed[root]

    def explain_items(self, name: str) -> str:
        """Return the end of a message about a name whose brackets select nothing; "" for other names.

        Args:
            name: Name that is not known.
        """
        if name.startswith(f"robot.{tapers.TAPER}."):
            quantities = " or ".join(tapers.list_quantities(self._scenario.robot))
            numbers = " or ".join(tapers.TITLES)
            return f"; a taper is `robot.taper.`, then {quantities}, then .{numbers}"
        plain = strip_items(name)
        if plain == name:
            return ""
        prefix, _, last_step = name.rpartition(".")
        if prefix == "gait" and strip_items(last_step) in joint_motion.TITLES:
            return _explain_count(plain, joint_motion.count_joints(self._scenario.robot))
        if self._find_listed(plain) is None:
            return ""
        return _explain_brackets(self._scenario, name)


def list_parameters(scenario: Scenario, *, each: bool = False) -> ScenarioParameters:
    """Return the parameters that can be swept, by name.

    Names of single parts and of ranges, such as `robot.module[3].mass` and `robot.module[:5].mass`,
    can be looked up in any case.

    Fins, thrusters and tether drag can be swept if the robot has them; coefficients that are still
    None can be swept.

    Args:
        scenario: The scenario; names of its environment's parameters begin with `water` or
            `ground`.
        each: Whether to list the numbers of every single module and joint as well.

    Example:
        >>> import laticauda as lc
        >>> gait = lc.eel_like(amplitude=0.5, frequency=2.0, phase_shift=0.7)
        >>> known = list_parameters(lc.build_scenario("mamba", gait))
        >>> "robot.module[3].mass" in known, "robot.module[30].mass" in known
        (True, False)
    """
    return ScenarioParameters(scenario, lists_parts=each, further={})


def _roots_of(scenario: Scenario) -> Sequence[str]:
    """Return the first words of the names of a scenario's parameters."""
    return ("gait", environment_prefix(scenario.environment), "joints", "controller", "robot")


def _numbers_of_root(scenario: Scenario, root: str, *, lists_parts: bool) -> Iterator[Parameter]:
    """Yield the numbers of a scenario whose names begin with a word."""
    if root == "controller":
        yield from _numbers_of_controller(scenario.motion)
    elif root == "robot":
        yield from _numbers_of_robot(scenario.robot, lists_parts=lists_parts)
    elif root in _roots_of(scenario):
        yield from _numbers_in(_root_object(scenario, root), root)


def _numbers_of_robot(robot: Robot, *, lists_parts: bool) -> Iterator[Parameter]:
    """Yield the numbers of a robot, and if asked for those of every single module and joint."""
    yield Parameter(name="robot.n_links", unit="", title="Number of links", is_whole=True)
    yield from _numbers_in(robot, "robot")
    if lists_parts:
        for field, step in SINGULARS.items():
            for i, item in enumerate(getattr(robot, field)):
                yield from _numbers_in(item, f"robot.{step}[{i}]")


def _explain_brackets(scenario: Scenario, name: str) -> str:
    """Return the end of a message about the first brackets in a name that select nothing.

    Args:
        scenario: The scenario.
        name: Name that would be that of a number without its brackets.
    """
    root, *steps = name.split(".")
    plain_path = strip_items(root)
    if plain_path != root:
        return _explain_count(plain_path, 0)
    owner = _root_object(scenario, root)
    for step in steps:
        plain_step = strip_items(step)
        plain_path += f".{plain_step}"
        field = PLURALS.get(plain_step, "")
        items: Sequence[Any] = getattr(owner, field, ())
        selected = items_of(step)
        selects_nothing = selected is None or not items[selected]
        if step != plain_step and selects_nothing:
            return _explain_count(plain_path, len(items))
        owner = find_objects(owner, plain_step)[0]
    return ""


def _explain_count(name: str, n_items: int) -> str:
    """Return the end of a message about brackets after a name that select nothing.

    Args:
        name: Name before the brackets.
        n_items: Number of items that it has; 0: it has none.
    """
    if not n_items:
        return f"; `{name}` has no brackets"
    return f"; `{name}` counts from [0] at the tail to [{n_items - 1}], or in ranges such as [:{n_items}]"


def _find_of_parts(scenario: Scenario, name: object) -> Parameter | None:
    """Return the parameter of a taper or of a name with brackets; None if there is none."""
    if not isinstance(name, str):
        return None
    prefix, _, last = name.rpartition(".")
    root, *steps = prefix.split(".")
    taper = tapers.find_taper(name)
    if taper is not None:
        return _find_taper(scenario.robot, name, taper)
    if "[" not in name:
        return None
    if prefix == "gait" and joint_motion.is_of_joints(last):
        return _find_of_joints(scenario, last)
    owners: list[Any] = [_root_object(scenario, root)]
    for step in steps:
        if any(not _can_lead_on(owner, step) for owner in owners):
            return None
        owners = _objects_after(owners, step)
    found: list[Parameter] = []
    for owner in owners:
        if not is_dataclass(owner):
            return None
        numbers = {parameter.name: parameter for parameter in _numbers_in(owner, prefix)}
        if name not in numbers:
            return None
        found.append(numbers[name])
    return found[0] if found else None


def _find_taper(robot: Robot, name: str, taper: tapers.TaperNumber) -> Parameter | None:
    """Return the parameter of a taper; None if the robot has none."""
    if taper.quantity not in tapers.list_quantities(robot):
        return None
    if len(robot.modules) < tapers.LEAST_MODULES[taper.number]:
        return None
    for parameter in _numbers_in(robot.modules[0], "robot.module"):
        if parameter.name == f"robot.module.{taper.quantity}":
            title = f"{parameter.title}, {tapers.TITLES[taper.number]}"
            return replace(parameter, name=name, title=title)
    return None


def _find_of_joints(scenario: Scenario, step: str) -> Parameter | None:
    """Return the parameter of single joints in the gait; None if the robot has no such joint."""
    if not joint_motion.list_values(scenario.gait, step, scenario.robot):
        return None
    title = joint_motion.TITLES[strip_items(step)]
    return Parameter(name=f"gait.{step}", unit="rad", title=title)


def _can_lead_on(owner: Any, step: str) -> bool:
    """Return whether a step leads from an object to others."""
    if "[" not in step:
        return hasattr(owner, find_part(owner, step).name)
    field = PLURALS.get(strip_items(step), "")
    return items_of(step) is not None and isinstance(getattr(owner, field, None), tuple)


def check_disjoint(names: Collection[str], argument: str = "points") -> None:
    """Reject names of which several are about the same number.

    Args:
        names: Names of parameters.
        argument: Argument that holds the names, for messages.

    Raises:
        ValueError: If two of them are, such as `robot.module.mass` and `robot.module[3].mass`.
    """
    by_plain_name: dict[str, list[str]] = {}
    for name in names:
        names_of_parts = by_plain_name.setdefault(_plain_name(name), [])
        for earlier_name in names_of_parts:
            if _are_of_common_numbers(name, earlier_name):
                rule = "must name each number once"
                raise BadArgument(argument, f"{rule}, got `{earlier_name}` and `{name}`")
        names_of_parts.append(name)


def _plain_name(name: str) -> str:
    """Return the name of the same number of all parts: that of all modules for a taper."""
    taper = tapers.find_taper(name)
    if taper is not None:
        return f"robot.module.{taper.quantity}"
    return strip_items(name)


def _are_of_common_numbers(first: str, second: str) -> bool:
    """Return whether two names of one number of parts are partly about the same parts."""
    are_tapers = [tapers.find_taper(parameter) is not None for parameter in (first, second)]
    if all(are_tapers):
        return first == second
    return any(are_tapers) or have_common_items(first, second)


def _numbers_of_controller(motion: Motion) -> Iterator[Parameter]:
    """Yield the numbers of a controller that is a value, apart from those of its gait."""
    if isinstance(motion, Gait) or not is_dataclass(motion):
        return
    for parameter in _numbers_in(motion, "controller"):
        if not parameter.name.startswith("controller.gait."):
            yield parameter


def environment_prefix(environment: Environment) -> str:
    """Return the prefix of the names of an environment's parameters."""
    if isinstance(environment, Water):
        return "water"
    return "ground"


def _numbers_in(owner: Any, prefix: str) -> Iterator[Parameter]:
    """Yield the numbers in a dataclass and in its parts."""
    kind = cast("type[object]", type(owner))
    hints = hints_of(kind)
    titles = texts_of(kind)
    quantities = quantities_of(kind)
    for field in fields(owner):
        value = getattr(owner, field.name)
        hint = hints[field.name]
        name = f"{prefix}.{field.name}"
        title = titles.get(field.name, field.name)
        unit = quantities[field.name].unit if field.name in quantities else ""
        if hint in COUNT_TYPES:
            yield Parameter(name=name, unit=unit, title=title, is_whole=True)
        elif hint in NUMBER_TYPES:
            yield Parameter(name=name, unit=unit, title=title)
        elif is_dataclass(value):
            yield from _numbers_in(value, name)
        elif hint in VECTOR_TYPES:
            n_axes = len(value or "xy")  # a current that is still None is a pair
            for ending in AXIS_ENDINGS[:n_axes]:
                yield Parameter(name=name + ending, unit=unit, title=f"{title}: {ending[1]}")
        elif field.name in SINGULARS_OF_SEPARATE:
            for i, item in enumerate(value):
                yield from _numbers_in(item, f"{prefix}.{SINGULARS_OF_SEPARATE[field.name]}[{i}]")
        elif field.name in SINGULARS and value:
            yield from _numbers_in(value[0], f"{prefix}.{SINGULARS[field.name]}")


def look_up(name: object, known: Mapping[str, Parameter], argument: str = "points") -> Parameter:
    """Return the parameter of a given name.

    Args:
        name: Dotted name of the parameter.
        known: Parameters that can be swept.
        argument: Argument that holds the names, for error messages.

    Raises:
        ValueError: If there is none; the message gives the nearest names.
    """
    if isinstance(name, str) and name in known:
        return known[name]
    hint = ""
    if isinstance(name, str):
        hint = suggest_names(name, known)
        if isinstance(known, ScenarioParameters):
            hint = known.explain_items(name) or hint
    medium = "water"
    if any(known_name.startswith("ground.") for known_name in known):
        medium = "ground"
    rule = f"must name numbers of gait, {medium} or robot, such as `gait.amplitude`"
    raise BadArgument(argument, f"{rule}, got {name!r}{hint}")


def check_whole(parameter: Parameter, values: Any) -> None:
    """Reject fractions where only whole numbers are meaningful.

    Args:
        parameter: The parameter that is swept.
        values: Array of its values.

    Raises:
        ValueError: If a value is not a whole number.
    """
    fractions = values[values != np.rint(values)]
    if parameter.is_whole and fractions.size:
        raise ValueError(f"`{parameter.name}` must be a whole number, got {fractions[0]}.")


def change_parameters(scenario: Scenario, values: Mapping[str, float]) -> Scenario:
    """Return a scenario with other values of its parameters; unchanged parts remain the same objects.

    Args:
        scenario: The original scenario.
        values: New values by parameter name; all names must be known.

    Raises:
        ValueError: If a name is not known, a value is out of its range, or the values are incompatible.
    """
    changes = nest_by_step(values)
    if not changes:
        return scenario
    if not set(_roots_of(scenario)).issuperset(changes):
        _look_up_all(values, scenario, "values")
    try:
        return _change(scenario, changes)
    except MISSES:
        _look_up_all(values, scenario, "values")
        raise


MISSES = (AttributeError, IndexError, TypeError)
"""What a name that leads nowhere ends in; looking names up beforehand would take longer than the change."""


def _look_up_all(names: Iterable[str], scenario: Scenario, argument: str) -> None:
    """Reject the first name that is none of a parameter of the scenario, with similar ones."""
    known = list_parameters(scenario)
    for name in names:
        look_up(name, known, argument)


def _change(scenario: Scenario, changes: Changes) -> Scenario:
    """Return a scenario with changes of its parts."""
    robot = scenario.robot
    robot_changes = dict(changes.get("robot", {}))
    if "n_links" in robot_changes:
        robot = robot.with_links(int(robot_changes.pop("n_links")))
    if tapers.TAPER in robot_changes:
        robot = tapers.change_tapers(robot, robot_changes.pop(tapers.TAPER))
    motion = apply_changes(scenario.motion, changes.get("controller", {}))
    if "gait" in changes:
        motion = _with_gait(motion, _change_gait(scenario.gait, changes["gait"], robot))
    model = scenario.model
    if "joints" in changes:
        model = apply_changes(model, {"joints": changes["joints"]})
    environment = scenario.environment
    environment_changes = changes.get(environment_prefix(environment), {})
    return replace(
        scenario,
        robot=apply_changes(robot, robot_changes),
        motion=motion,
        environment=apply_changes(environment, environment_changes),
        model=model,
    )


def _change_gait(gait: Gait, changes: Changes, robot: Robot) -> Gait:
    """Return a gait with other numbers, some of them of single joints."""
    of_joints = {step: value for step, value in changes.items() if joint_motion.is_of_joints(step)}
    changes_of_whole = {step: value for step, value in changes.items() if step not in of_joints}
    gait = apply_changes(gait, changes_of_whole)
    if not of_joints:
        return gait
    return joint_motion.change_joints(gait, of_joints, robot)


def _with_gait(motion: Motion, gait: Gait) -> Motion:
    """Return a motion with another gait: that gait, or the controller that steers it."""
    if isinstance(motion, Gait):
        return gait
    if isinstance(motion, OpenLoop):
        return replace(motion, command=replace(motion.command, gait=gait))
    if not is_dataclass(motion):
        rule = "must be a dataclass, so that its gait can be changed"
        raise BadArgument("motion", f"{rule}, got {motion.__class__.__name__}")
    return replace(cast(Any, motion), gait=gait)


def value_of(name: str, scenario: Scenario, argument: str = "names") -> float:
    """Return the value of a parameter in a scenario.

    Args:
        name: Dotted name of the parameter.
        scenario: The scenario that contains it.
        argument: Argument that holds the names, for error messages.

    Raises:
        ValueError: If it is not known, differs among the modules or joints that it stands for, or is None.
    """
    try:
        return _value_of(name, scenario, argument)
    except MISSES:
        _look_up_all([name], scenario, argument)
        raise


def _value_of(name: str, scenario: Scenario, argument: str) -> float:
    """Return the value of a parameter in a scenario."""
    root, *steps = name.split(".")
    environment = scenario.environment
    values: list[Any] = [_root_object(scenario, root)]
    if root == "gait" and joint_motion.is_of_joints(steps[-1]):
        values = joint_motion.list_values(scenario.gait, steps[-1], scenario.robot)
        steps = []
    taper = tapers.find_taper(name)
    if taper is not None:
        return tapers.value_of_taper(scenario.robot, taper)
    for step in steps:
        values = _objects_after(values, step)
    # A coefficient of a module or fin that is None takes the water's value.
    default = getattr(environment, name.rpartition(".")[2], None)
    values = [default if value is None else value for value in values]
    if len(set(values)) > 1:
        rule = "must be of numbers that are the same in all parts"
        raise BadArgument(argument, f"{rule}, got `{name}`, {sorted(set(values))}")
    if values[0] is None:
        rule = "must be of numbers that the trial has"
        raise BadArgument(argument, f"{rule}, got `{name}`, which is None")
    return float(values[0])


def _root_object(scenario: Scenario, root: str) -> Any:
    """Return the part of a scenario that the first word of a name leads to."""
    roots = {
        "robot": scenario.robot,
        "gait": scenario.gait,
        "joints": scenario.model.joints,
        "controller": scenario.motion,
        environment_prefix(scenario.environment): scenario.environment,
    }
    return roots.get(root)


def _objects_after(owners: Sequence[Any], step: str) -> list[Any]:
    """Return the objects or numbers to which a step leads from several objects."""
    objects: list[Any] = []
    for owner in owners:
        objects += find_objects(owner, step)
    return objects


MOST_SUGGESTIONS = 3
"""Largest number of names that an error message suggests."""
LEAST_SIMILARITY = 0.75
"""How similar the last step of a name must be for a suggestion; 1 is equal [-]."""


def suggest_names(name: str, known: Collection[str]) -> str:
    """Return the end of an error message about a mistyped name: up to three similar names or name ends, or "".

    Args:
        name: The name as typed.
        known: Valid names.
    """
    plain = name.casefold().replace("-", "_")
    similar = _names_with_similar_end(plain, known)
    similar += difflib.get_close_matches(plain, known, n=MOST_SUGGESTIONS)
    nearest = list(dict.fromkeys(similar))[:MOST_SUGGESTIONS]
    if not nearest:
        return ""
    return f"; the nearest are {', '.join(f'`{name}`' for name in nearest)}"


def _names_with_similar_end(plain: str, known: Collection[str]) -> list[str]:
    """Return the names whose last step is similar, most similar name first."""
    names_by_end: dict[str, list[str]] = {}
    for name in known:
        if "[" not in name:
            names_by_end.setdefault(_last_step(name), []).append(name)
    ends = difflib.get_close_matches(_last_step(plain), names_by_end, n=2, cutoff=LEAST_SIMILARITY)
    names: list[str] = []
    for end in ends:
        names += names_by_end[end]
    names.sort(key=lambda name: -difflib.SequenceMatcher(None, plain, name).ratio())
    return names


def _last_step(name: str) -> str:
    return name.rsplit(".", 1)[-1]


# Names of 0.2, for one release.
__getattr__ = renamed_names(
    __name__, {"changed": "change_parameters", "parameters": "list_parameters"}
)
