"""Parameters of a robot's modules and joints, under the names by which sweeps know them.

Those of modules are numbers from which the rows of a link follow by `link_formulas`; here is also
what these formulas read. Those of joints are rows themselves.

Left out is what the loads on other parts depend on: sections and lengths where fins and flat modules
are plates, and lengths where friction tapers along the body. Of robots whose modules are merged into
links of the planar model, modules have no parameters.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from operator import attrgetter
from typing import Any, NamedTuple

import laticauda as lc
from laticauda.connect.native.joint_rows import first_row_of_body, list_body_joints
from laticauda.connect.native.link_formulas import (
    ADDED_INERTIA_AT,
    ADDED_MASS_AT,
    CENTER_AT,
    DENSITY,
    DRAG_AT,
    FIRST_ROW,
    FRICTION_AT,
    HALF_HEIGHT_AT,
    HALF_WIDTH_AT,
    HAS_WAKE,
    INERTIA_AT,
    IS_CLASSIC,
    IS_IN_STRIPS,
    LENGTH_AT,
    MASS_AT,
    N_ATTACHED,
    N_BODIES,
    N_LINKS,
    NONE,
    NUMBERS,
    RECORDS,
    TANGENTIAL,
)
from laticauda.connect.native.variable import Variable, one_row, unit_of
from laticauda.models.planar import PlanarPlant, rows
from laticauda.motion.joints import Drive
from laticauda.robot import Actuator, Joint, Module, Section, has_power_model, links_in_water
from laticauda.values import Quantity, quantities_of
from laticauda.water.fluid.sections import Link

COVERED = 1.0 - 1e-9
"""Largest share of the depth that a half-height may have: the surface lies above it [-]."""
MODULE_PLACES = {
    "length": LENGTH_AT,
    "mass": MASS_AT,
    "center": CENTER_AT,
    "inertia": INERTIA_AT,
    "section.half_height": HALF_HEIGHT_AT,
    "section.half_width": HALF_WIDTH_AT,
    "tangential_friction": FRICTION_AT,
    "normal_drag": DRAG_AT,
    "added_mass": ADDED_MASS_AT,
    "added_inertia": ADDED_INERTIA_AT,
}
"""Paths to the numbers of a module, and their places in a record of `link_formulas`."""
WATER_FIELDS = ("tangential_friction", "normal_drag", "added_mass", "added_inertia")
"""Coefficients that modules have in common with the water, in the order of a record."""
SKIN_ROWS = {"stiffness": rows.STIFFNESS, "damping": rows.DAMPING}
"""Numbers of a joint's skin, and the rows of a joint that hold them."""
MOTOR_FIELDS = ("stall_torque", "no_load_speed", "friction_torque", "viscous_friction")
"""Numbers of an actuator on which its electrical power depends."""


def list_module_parameters(plant: PlanarPlant) -> Iterator[Variable]:
    """Yield the numbers that the modules state, tail first.

    Args:
        plant: Plant in water, of a robot whose modules are all links.
    """
    for index, module in enumerate(plant.robot.modules):
        for path, place in MODULE_PLACES.items():
            value: float | None = attrgetter(path)(module)
            if value is None or _is_fixed(place, plant):
                continue
            quantity = _quantity_of(path)
            limits = _range_of(place, module, plant)
            yield Variable(
                name=f"robot.module[{index}].{path}",
                causality="parameter",
                unit=unit_of(quantity),
                description=f"Module {index}: {_describe(quantity)}.",
                start=value,
                least=max(quantity.least, limits.least),
                most=min(quantity.le, limits.most),
            )


def _quantity_of(path: str) -> Quantity:
    """Return what is declared of a number of a module."""
    owner, _, field = path.rpartition(".")
    return quantities_of(Section if owner else Module)[field]


def _describe(quantity: Quantity) -> str:
    """Return what a number is, without what it means that there is none."""
    text, _, _ = quantity.text.replace("; None", ", or None").partition(", or None")
    return text


def _is_fixed(place: int, plant: PlanarPlant) -> bool:
    """Return whether loads of other parts depend on a number of a module, so that it is no parameter."""
    water = plant.environment
    assert isinstance(water, lc.Water)
    has_plates = water.plate_drag is not None or water.plate_added_mass is not None
    if plant.robot.caudal_fin is not None and water.trailing_edge == "finite-span":
        has_plates = True
    if place == LENGTH_AT:
        return has_plates or water.friction_taper != 0.0
    return has_plates and place in (HALF_HEIGHT_AT, HALF_WIDTH_AT)


class _Range(NamedTuple):
    """Values that a number may have besides what is declared of it."""

    least: float = -math.inf
    most: float = math.inf


def _range_of(place: int, module: Module, plant: PlanarPlant) -> _Range:
    """Return which values of a number can be those of this module in this water."""
    depth: float | None = getattr(plant.environment, "depth", None)
    if place == CENTER_AT:
        return _Range(-module.half_length, module.half_length)
    if place == HALF_HEIGHT_AT and depth is not None:
        return _Range(most=COVERED * depth)
    return _Range()


def list_joint_parameters(plant: PlanarPlant) -> Iterator[Variable]:
    """Yield the numbers of the joints' skins and of their actuators, as far as the run depends on these.

    Args:
        plant: Plant in water, of a robot whose joints are all in the plane.
    """
    skin = quantities_of(Joint)
    actuator = quantities_of(Actuator)
    for record, joint in zip(list_body_joints(plant), plant.robot.joints, strict=True):
        for field, row in SKIN_ROWS.items():
            yield _joint_parameter(
                number=record.number,
                path=field,
                quantity=skin[field],
                value=getattr(joint, field),
                row=record.first_row + row,
            )
        for field in _list_drive_fields(plant):
            yield _joint_parameter(
                number=record.number,
                path=f"actuator.{field}",
                quantity=actuator[field],
                value=getattr(joint.actuator, field),
                row=record.first_row + rows.DRIVE + Drive._fields.index(field),
            )


def _list_drive_fields(plant: PlanarPlant) -> tuple[str, ...]:
    if not plant.joints.prescribed:
        return Drive._fields
    if has_power_model(plant.robot, plant.joints):
        return MOTOR_FIELDS
    return ()


def _joint_parameter(
    *, number: int, path: str, quantity: Quantity, value: float, row: int
) -> Variable:
    return Variable(
        name=f"robot.joint[{number}].{path}",
        causality="parameter",
        unit=unit_of(quantity),
        description=f"Joint {number}: {_describe(quantity)}.",
        start=value,
        least=quantity.least,
        most=quantity.le,
        rows=one_row(row),
    )


class LinkTable(NamedTuple):
    """What `link_formulas` reads."""

    places: list[int]
    """Places, records, and rows that are positions on a link; places in the array of reals count from the first of
    `numbers`."""
    numbers: list[float]
    """Numbers as they were."""


def build_link_table(plant: PlanarPlant, variables: Sequence[Variable]) -> LinkTable:
    """Return what the compiled function needs in order to change links.

    Args:
        plant: Plant in water.
        variables: All variables; without parameters of modules, no link can be changed.
    """
    variable_numbers = {variable.name: number for number, variable in enumerate(variables)}
    if not any(name.startswith("robot.module[") for name in variable_numbers):
        return LinkTable(places=[0] * RECORDS, numbers=[])
    robot = plant.robot
    water = plant.environment
    layout = plant.layout
    assert isinstance(water, lc.Water)
    depth = water.depth
    if depth is None:
        depth = math.inf
    attached = _list_attached(plant)
    header = {
        N_LINKS: robot.n_links,
        FIRST_ROW: first_row_of_body(layout.tail_link),
        N_BODIES: layout.n_bodies,
        DENSITY: variable_numbers["water.density"],
        TANGENTIAL: variable_numbers["water.tangential_added_mass"],
        IS_IN_STRIPS: water.rotational == "strip",
        IS_CLASSIC: water.added_mass_form == "classic",
        HAS_WAKE: _is_wake_of_tail_module(robot, water),
        NUMBERS: 0,
        N_ATTACHED: len(attached),
    }
    places = [int(header[place]) for place in range(RECORDS)]
    numbers = [robot.mass, depth]
    for record in _list_records(plant, water, variable_numbers):
        places += record.variables
        places.append(int(record.is_rod))
        places.append(len(numbers))
        numbers += record.numbers
    for row in attached:
        places.append(row.link)
        places.append(row.row)
    return LinkTable(places=places, numbers=numbers)


def _is_wake_of_tail_module(robot: lc.Robot, water: lc.Water) -> bool:
    """Return whether the section of the tail-most module decides on the wake, and not that of a fin."""
    return robot.caudal_fin is None and water.trailing_edge != "none"


class _Record(NamedTuple):
    """A module in the table."""

    variables: list[int]
    """Variables that are its own numbers, then those of the water that it is a multiple of."""
    is_rod: bool
    """Whether its inertia is that of a rod."""
    numbers: list[float]
    """Its numbers, the multiples, and the area of its section over the product of its half-axes."""


def _list_records(
    plant: PlanarPlant, water: lc.Water, variable_numbers: Mapping[str, int]
) -> Iterator[_Record]:
    links = links_in_water(plant.robot, water)
    links_at_zero = links_in_water(plant.robot, _with_coefficients(water, 0.0))
    links_at_one = links_in_water(plant.robot, _with_coefficients(water, 1.0))
    for index, module in enumerate(plant.robot.modules):
        own_numbers: list[int] = []
        for path in MODULE_PLACES:
            name = f"robot.module[{index}].{path}"
            own_numbers.append(variable_numbers.get(name, NONE))
        coefficients = _coefficients_of(links[index])
        at_zero = _coefficients_of(links_at_zero[index])
        at_one = _coefficients_of(links_at_one[index])
        water_numbers: list[int] = []
        multiples: list[float] = []
        for field, low, high in zip(WATER_FIELDS, at_zero, at_one, strict=True):
            multiple = high - low
            multiples.append(multiple)
            follows_water = multiple != 0.0
            water_numbers.append(variable_numbers[f"water.{field}"] if follows_water else NONE)
        section = module.section
        yield _Record(
            variables=[*own_numbers, *water_numbers],
            is_rod=module.inertia is None,
            numbers=[
                module.length,
                module.mass,
                module.center,
                module.moment_of_inertia,
                section.half_height,
                section.half_width,
                *coefficients,
                *multiples,
                section.area / (section.half_height * section.half_width),
            ],
        )


def _with_coefficients(water: lc.Water, value: float) -> lc.Water:
    """Return a water whose coefficients are all the same."""
    coefficients: Any = dict.fromkeys(WATER_FIELDS, value)
    return replace(water, **coefficients)


def _coefficients_of(link: Link) -> list[float]:
    """Return a link's coefficients, in the order of `WATER_FIELDS`."""
    return [link.friction, link.drag, link.added_mass, link.added_inertia]


class _AttachedRow(NamedTuple):
    """A row that is a position on a link, from its tail end."""

    link: int
    """Number of the link [-]."""
    row: int
    """Index of the row [-]."""


def _list_attached(plant: PlanarPlant) -> list[_AttachedRow]:
    """Return where drag areas and pectoral fins are on their links; a caudal fin is at the tail end itself."""
    layout = plant.layout
    robot = plant.robot
    first_strip_row = first_row_of_body(layout.n_bodies)
    n_strips = int(layout.first_strip[-1])
    first_plate_row = first_strip_row + n_strips * rows.STRIP_ROWS
    attached: list[_AttachedRow] = []
    for link in range(robot.n_links):
        body = layout.tail_link + link
        # Strips of drag areas stand behind those of a rigid fin, if the link has one.
        last_strip = int(layout.first_strip[body + 1])
        n_areas = sum(area.link == link for area in robot.drag_areas)
        for strip in range(last_strip - n_areas, last_strip):
            strip_row = first_strip_row + strip * rows.STRIP_ROWS
            position_row = strip_row + rows.POSITION_OF
            attached.append(_AttachedRow(link, position_row))
        first_plate = int(layout.first_plate[body])
        last_plate = int(layout.first_plate[body + 1])
        for plate in range(first_plate, last_plate):
            plate_row = first_plate_row + plate * rows.PLATE_ROWS
            position_row = plate_row + rows.PLATE_X
            attached.append(_AttachedRow(link, position_row))
    return attached
