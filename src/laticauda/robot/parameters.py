"""Parameter files in TOML: custom parameters of water, joints, fin and electronics, for every gait or for one.

    kind = "parameters"
    name = "tank-2025"
    title = "our trials in the tank"
    basis = "C_f is fitted to five glides; all else is from tables."   # shown beside results
    fitted = ["water.normal_drag"]                              # what was identified, by its dotted name
    joints = "prescribed"      # the joint law that goes with them: prescribed, pd, servo, speed-servo

    [water]                    # for every gait: the fields of `Water` except its name
    tangential_friction = 0.3
    normal_drag = 1.75
    added_mass = 1.5

    [actuator]                 # of every joint; there are also [joint], [caudal_fin], [tether] and [robot]
    tracking = 0.92

    [eel_like.water]           # for this gait: replaces what differs; same for `lateral_undulation`
    tangential_friction = 0.17

Only `[water]` is required. Like robot files, parameter files are read strictly: unknown, missing or
out-of-range entries are rejected with their keys.
"""

from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any, TypeAlias, cast

from laticauda.motion.gaits.gait import list_kinds
from laticauda.motion.joints import JointLaw, Servo
from laticauda.robot.body import Actuator, Joint
from laticauda.robot.effectors import CaudalFin, Tether
from laticauda.robot.environment import Water
from laticauda.robot.files import find, preset_names, read_table
from laticauda.robot.robot import Robot
from laticauda.values import (
    BadArgument,
    RobotFileError,
    check_choice,
    check_instance,
    check_label,
    codec,
    files,
    hints_of,
    option,
    quantities_of,
    value_class,
)
from laticauda.water.fluid import DragLaw

Adjustments: TypeAlias = Mapping[str, Mapping[str, Any]]
"""Values that replace the robot's own, by table and field."""

SECTIONS: dict[str, type[Any]] = {
    "joint": Joint,
    "actuator": Actuator,
    "caudal_fin": CaudalFin,
    "tether": Tether,
}
"""Classes whose fields a file may change, by the name of the table."""
FIELDS_OF_ROBOT = ("active_power", "electronics_power")
"""Fields of the robot itself that a file may change, in the table `robot`."""
REFUSED_FIELDS_OF_JOINT = {
    "axis": "a parameter file cannot change the axes of joints",
    "actuator": "use the separate table `actuator`",
}
"""Fields of a joint that a file may not change, and why."""
NAMES = (*SECTIONS, "robot")
"""Names of the tables that change a robot."""


def read_adjustments(tables: Mapping[str, object], path: str = "") -> dict[str, dict[str, Any]]:
    """Check tables of a file.

    Args:
        tables: Tables by name, one of `NAMES`.
        path: Their position in the file, "" for the top.

    Returns:
        The same tables, with every value as stored by its class, angles in radians.

    Raises:
        BadKey: If a key is unknown, or its value is of the wrong type or out of range.
    """
    return {
        name: _read(name, table, f"{path}.{name}" if path else name)
        for name, table in tables.items()
    }


def adjust(robot: Robot, adjustments: Adjustments) -> Robot:
    """Return a robot with adjusted parameters; those of parts it lacks are ignored.

    Args:
        robot: The robot; if it has no caudal fin, the parameters of a fin are ignored.
        adjustments: Adjustments from `read_adjustments`.

    Raises:
        ValueError: If a parameter is inconsistent with the rest of the robot.
    """
    changes: dict[str, Any] = dict(adjustments.get("robot", {}))
    joint_changes = adjustments.get("joint", {})
    actuator_changes = dict(adjustments.get("actuator", {}))
    if actuator_changes:
        # Numbers of a motor make it the robot's own, unless the file says that they are assumed.
        actuator_changes.setdefault("stated", True)
    if joint_changes or actuator_changes:
        # Equal joints stay one object.
        changed_joints = {
            joint: replace(
                joint, actuator=replace(joint.actuator, **actuator_changes), **joint_changes
            )
            for joint in set(robot.joints)
        }
        changes["joints"] = tuple(changed_joints[joint] for joint in robot.joints)
    if adjustments.get("caudal_fin") and robot.caudal_fin is not None:
        changes["caudal_fin"] = replace(robot.caudal_fin, **adjustments["caudal_fin"])
    if adjustments.get("tether"):
        changes["tether"] = replace(robot.tether, **adjustments["tether"])
    if not changes:
        return robot
    return replace(robot, **changes)


def _read(name: str, table: object, path: str) -> dict[str, Any]:
    """Return the values of one table, by field, as its class stores them."""
    entries = codec.table_of(table, path)
    for key, value in entries.items():
        if value is None:
            raise codec.BadKey(
                f"{path}.{key}", "must be left out to keep the robot's own value, got None"
            )
    if name == "robot":
        return _read_fields_of_robot(entries, path)
    if name == "joint":
        for key in sorted(REFUSED_FIELDS_OF_JOINT.keys() & entries):
            reason = REFUSED_FIELDS_OF_JOINT[key]
            raise codec.BadKey(f"{path}.{key}", f"must not be given: {reason}")
    decoded = codec.decode(SECTIONS[name], entries, path)
    values: dict[str, Any] = {}
    for key in entries:
        field = key if hasattr(decoded, key) else key.removesuffix("_deg")
        values[field] = getattr(decoded, field)
    return values


def _read_fields_of_robot(entries: Mapping[str, Any], path: str) -> dict[str, Any]:
    codec.check_keys(entries, FIELDS_OF_ROBOT, path)
    quantities = quantities_of(Robot)
    with codec.arguments_of(path):
        return {key: quantities[key].checked(key, value) for key, value in entries.items()}


# ---- parameters and their file -------------------------------------------------------------------

KIND = "parameters"
GAITS = list_kinds()
"""Kinds of gait that may have their own parameters."""


def _check_changes(name: str, changes: Adjustments) -> dict[str, dict[str, Any]]:
    check_instance(name, changes, Mapping)
    for table in changes:
        check_choice(name, table, NAMES)
    try:
        adjustments = read_adjustments(changes, name)
    except codec.BadKey as error:
        raise BadArgument(error.name, error.rule) from None
    return {table: values for table, values in adjustments.items() if values}


def _check_changes_by_gait(
    name: str, changes: Mapping[str, Adjustments]
) -> dict[str, dict[str, dict[str, Any]]]:
    check_instance(name, changes, Mapping)
    checked: dict[str, dict[str, dict[str, Any]]] = {}
    for gait, tables in changes.items():
        check_choice(name, gait, GAITS)
        gait_changes = _check_changes(f"{name}.{gait}", tables)
        if gait_changes:
            checked[gait] = gait_changes
    return checked


@value_class
class Parameters:
    """Contents of a parameter file: the water, by gait where it differs, and changes to a robot.

    Raises:
        ValueError: If a parameter is unknown or out of range.
    """

    name: str = option(
        "Name used in files and stored trials; the waters are named after it", check=check_label
    )
    title: str = option("Label in legends", check=check_label)
    basis: str = option(
        "What the numbers rest on and how far to trust them, in sentences, shown beside results",
        default="",
    )
    fitted: tuple[str, ...] = option(
        "Numbers that were identified from measurements, by dotted name", default=()
    )
    joints: JointLaw | str | None = option(
        "Joint law they belong to, by name or with parameters", default=None
    )
    every_gait: Water = option("Water for the gaits without their own")
    own: Mapping[str, Water] = option("Water by kind of gait", default_factory=dict[str, Water])
    changes: Adjustments = option(
        "Robot changes, by table", default_factory=dict[str, dict[str, Any]], check=_check_changes
    )
    own_changes: Mapping[str, Adjustments] = option(
        "Further changes, by kind of gait",
        default_factory=dict[str, Adjustments],
        check=_check_changes_by_gait,
    )

    def __post_init__(self) -> None:
        if isinstance(self.joints, str):
            check_choice("joints", self.joints, JointLaw.names())
        check_instance("own", self.own, Mapping)
        for gait, water in self.own.items():
            check_choice("own", gait, GAITS)
            check_instance(f"own[{gait}]", water, Water)
        named = {
            gait: replace(water, name=f"{self.name}, {gait}") for gait, water in self.own.items()
        }
        object.__setattr__(self, "own", named)
        object.__setattr__(self, "every_gait", replace(self.every_gait, name=self.name))

    def water(self, gait_kind: str) -> Water:
        """Return the water for a kind of gait.

        Args:
            gait_kind: Its name, such as `eel_like`; a gait without its own water uses the water of
                every gait.
        """
        return self.own.get(gait_kind, self.every_gait)

    def robot(self, robot: Robot, gait_kind: str) -> Robot:
        """Return a robot with these parameters.

        Args:
            robot: Robot that swims; a table for a fin has no effect on a robot without one.
            gait_kind: Name of the kind of gait, such as `eel_like`.

        Raises:
            ValueError: If a parameter is inconsistent with the rest of the robot.
        """
        return adjust(adjust(robot, self.changes), self.own_changes.get(gait_kind, {}))

    @property
    def servos(self) -> Servo:
        """Joint law of a robot whose joints are servos, as those of modules are.

        It is the law that they belong to; if they belong to none, or to joints that are not servos,
        it is `Servo`.
        """
        if self.joints is not None:
            law = JointLaw.of(self.joints)
            if isinstance(law, Servo):
                return law
        return Servo()

    def to_toml(self) -> str:
        """Return the file's text, which `load_parameters` reads back to equal parameters.

        Raises:
            ValueError: If a gait's water has None where that of every gait has a number; TOML
                cannot express this.
        """
        import tomli_w

        table: codec.Table = codec.stamped(KIND, {"name": self.name, "title": self.title})
        if self.basis:
            table["basis"] = self.basis
        if self.fitted:
            table["fitted"] = list(self.fitted)
        if self.joints is not None:
            table["joints"] = codec.encode(self.joints, JointLaw)
        water = {
            key: value for key, value in codec.encode(self.every_gait).items() if key != "name"
        }
        table |= {"water": water, **codec.encode(self.changes)}
        for gait in GAITS:
            entries: codec.Table = codec.encode(self.own_changes.get(gait, {}))
            if gait in self.own:
                entries = {"water": _differences(self.own[gait], self.every_gait), **entries}
            if entries:
                table[gait] = entries
        return tomli_w.dumps(table)

    def save(self, path: str | Path) -> None:
        """Write the file.

        Args:
            path: Path of the TOML file; an existing file is replaced.

        Raises:
            StorageFailed: If the file cannot be written.
        """
        files.write(path, self.to_toml())


def parameter_names() -> tuple[str, ...]:
    """Return the sorted names of the parameter presets."""
    return preset_names("parameter")


def load_parameters(name_or_path: str | Path) -> Parameters:
    """Load parameters.

    Args:
        name_or_path: A preset's name (`parameter_names` lists them), or the path of a TOML file.

    Returns:
        The checked parameters.

    Raises:
        RobotFileError: If there is no such file (`RobotNotFound`), or its contents are invalid; the
            message names the file, the key, the rule and the value.

    Example:
        >>> load_parameters("paper").water("eel_like").tangential_friction
        0.17
    """
    path = find(name_or_path, "parameter")
    with codec.keys_of(path, RobotFileError):
        return _parameters(read_table(path))


def _parameters(table: codec.Table) -> Parameters:
    codec.take_kind(table, KIND)
    codec.check_keys(table, ("name", "title", "basis", "fitted", "joints", "water", *NAMES, *GAITS))
    for key in ("name", "title", "water"):
        if key not in table:
            raise codec.BadKey(key, "is missing; every parameter file needs it")
    every_gait = codec.decode(Water, _water_table(table["water"], "water"), "water")
    joints = table.get("joints")
    if joints is not None and not isinstance(joints, str):
        joints = codec.decode(JointLaw, joints, "joints")
    own: dict[str, Water] = {}
    own_changes: dict[str, Adjustments] = {}
    for gait in GAITS:
        if gait not in table:
            continue
        entries = codec.table_of(table[gait], gait)
        codec.check_keys(entries, ("water", *NAMES), gait)
        if "water" in entries:
            path = f"{gait}.water"
            own[gait] = codec.updated(every_gait, _water_table(entries["water"], path), path)
        own_changes[gait] = read_adjustments(
            {key: entries[key] for key in NAMES if key in entries}, gait
        )
    with codec.arguments_of(""):
        return Parameters(
            name=table["name"],
            title=table["title"],
            basis=table.get("basis", ""),
            fitted=_read_names(table.get("fitted", [])),
            joints=joints,
            every_gait=every_gait,
            own=own,
            changes=read_adjustments({key: table[key] for key in NAMES if key in table}),
            own_changes=own_changes,
        )


def _read_names(value: object) -> tuple[str, ...]:
    """Return the names of the numbers that were identified."""
    if not isinstance(value, list):
        raise codec.BadKey("fitted", f"must be a list of dotted names, got {value!r}")
    names = cast("list[object]", value)
    return tuple(check_label("fitted", name) for name in names)


def _differences(own: Any, usual: Any) -> codec.Table:
    """Return, in the form of a file, the fields in which a gait's water, or one of its laws, differs from the usual."""
    table: codec.Table = {}
    hints = hints_of(own.__class__)
    for field in fields(own):
        name = field.name
        own_value = getattr(own, name)
        usual_value = getattr(usual, name)
        if name == "name" or own_value == usual_value:
            continue
        if own_value is None:
            raise BadArgument(
                name, "must be a number, as it is for every gait; a file cannot remove it"
            )
        if isinstance(own_value, DragLaw) and own_value.__class__ is usual_value.__class__:
            table[name] = _differences(own_value, usual_value)
        else:
            table[name] = codec.encode(own_value, hints[name])
    return table


def _water_table(value: object, path: str) -> codec.Table:
    table = codec.table_of(value, path)
    if "name" in table:
        raise codec.BadKey(
            f"{path}.name", "must not be given: the water takes the name of the file"
        )
    return codec.with_new_names(Water, table)
