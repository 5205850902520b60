"""Variables that another tool reads: motion, angles, torques, powers and works."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from laticauda.connect.native.joint_rows import (
    JointRecord,
    list_body_joints,
    list_fin_joints,
)
from laticauda.connect.native.sensors import list_sensor_outputs
from laticauda.connect.native.variable import RowShare, Variable, one_row
from laticauda.models.planar import PlanarPlant, rows
from laticauda.robot import has_power_model

MOTION = (
    Variable(
        name="center_of_mass.x",
        causality="output",
        unit="m",
        symbol="p_x",
        description="Center of mass, fin included.",
        rows=one_row(rows.X),
    ),
    Variable(
        name="center_of_mass.y",
        causality="output",
        unit="m",
        symbol="p_y",
        description="Center of mass, fin included.",
        rows=one_row(rows.Y),
    ),
    Variable(
        name="center_of_mass_velocity.x",
        causality="output",
        unit="m/s",
        symbol="p'_x",
        description="Its velocity.",
        rows=one_row(rows.VX),
    ),
    Variable(
        name="center_of_mass_velocity.y",
        causality="output",
        unit="m/s",
        symbol="p'_y",
        description="Its velocity.",
        rows=one_row(rows.VY),
    ),
    Variable(
        name="heading",
        causality="output",
        unit="rad",
        symbol="theta",
        description="Mean angle of the links, unwrapped.",
        rows=one_row(rows.HEADING),
    ),
    Variable(
        name="heading_rate",
        causality="output",
        unit="rad/s",
        symbol="theta'",
        description="Its rate.",
        rows=one_row(rows.HEADING_RATE),
    ),
)
"""Motion of the whole robot."""


class PowerRows(NamedTuple):
    """A kind of power, and the rows of the kernels that hold it and its integral."""

    kind: str
    """Name of the kind [-]."""
    description: str
    """Description [-]."""
    power_row: int
    """Row of the power [-]."""
    work_row: int
    """Row of the work [-]."""


MECHANICAL_POWERS = (
    PowerRows(
        kind="mechanical",
        description="Sum of |u_i phi'_i|",
        power_row=rows.POWER_ABSOLUTE,
        work_row=rows.WORK_ABSOLUTE,
    ),
    PowerRows(
        kind="net",
        description="Sum of u_i phi'_i",
        power_row=rows.POWER_NET,
        work_row=rows.WORK_NET,
    ),
    PowerRows(
        kind="positive",
        description="Sum of max(u_i phi'_i, 0)",
        power_row=rows.POWER_POSITIVE,
        work_row=rows.WORK_POSITIVE,
    ),
)
ELECTRICAL_POWER = PowerRows(
    kind="electrical",
    description="Electrical power above idle",
    power_row=rows.POWER_ELECTRICAL,
    work_row=rows.WORK_ELECTRICAL,
)
"""Power of robots whose actuators have a power model."""


class JointQuantity(NamedTuple):
    """A quantity that every joint has in a row of its record."""

    name: str
    """Name of the variables, before the number of the joint [-]."""
    unit: str
    """Unit [-]."""
    symbol: str
    """Symbol in the formulas of the docs [-]."""
    description: str
    """Description; `{}` stands for the number of the joint [-]."""
    row: int
    """Row in the record of a joint [-]."""


JOINT_ANGLE = JointQuantity(
    name="joint_angle",
    unit="rad",
    symbol="phi_i",
    description="Angle of joint {}.",
    row=rows.ANGLE,
)
JOINT_RATE = JointQuantity(
    name="joint_rate",
    unit="rad/s",
    symbol="phi'_i",
    description="Rate of joint {}.",
    row=rows.RATE,
)
JOINT_TORQUE = JointQuantity(
    name="joint_torque",
    unit="N.m",
    symbol="u_i",
    description="Torque of the drive of joint {}.",
    row=rows.TORQUE,
)
FIN_ANGLE = JointQuantity(
    name="fin_angle",
    unit="rad",
    symbol="phi_j",
    description="Angle of a joint of the fin.",
    row=rows.ANGLE,
)
FIN_RATE = JointQuantity(
    name="fin_rate",
    unit="rad/s",
    symbol="phi'_j",
    description="Its rate.",
    row=rows.RATE,
)


def list_outputs(plant: PlanarPlant) -> Iterator[Variable]:
    """Yield all outputs.

    Args:
        plant: Plant in water.
    """
    yield from MOTION
    yield from _list_link_angles(plant)
    yield from _list_joint_outputs(plant)
    yield from _list_fin_outputs(plant)
    yield from _list_powers(plant)
    yield from list_sensor_outputs(plant)


def _list_link_angles(plant: PlanarPlant) -> Iterator[Variable]:
    """Yield theta_i: the heading, minus the joints' mean rotation, plus that of the joints between tail and link i."""
    joints = list_body_joints(plant)
    n_links = plant.robot.n_links
    for link in range(n_links):
        shares = [RowShare(row=rows.HEADING, factor=1.0)]
        for joint in joints:
            is_before_link = float(joint.number < link)
            factor = is_before_link - (n_links - 1 - joint.number) / n_links
            shares.append(RowShare(row=joint.first_row + rows.ANGLE, factor=factor))
        yield Variable(
            name=f"link_angle[{link}]",
            causality="output",
            unit="rad",
            symbol="theta_i",
            description=f"Angle of link {link}.",
            rows=tuple(shares),
        )


def _list_joint_outputs(plant: PlanarPlant) -> Iterator[Variable]:
    joints = list_body_joints(plant)
    yield from _list_for_joints(JOINT_ANGLE, joints)
    yield from _list_for_joints(JOINT_RATE, joints)
    for joint in joints:
        yield _joint_reference(plant, joint)
    yield from _list_for_joints(JOINT_TORQUE, joints)


def _list_for_joints(quantity: JointQuantity, joints: Sequence[JointRecord]) -> Iterator[Variable]:
    for joint in joints:
        yield Variable(
            name=f"{quantity.name}[{joint.number}]",
            causality="output",
            unit=quantity.unit,
            symbol=quantity.symbol,
            description=quantity.description.format(joint.number),
            rows=one_row(joint.first_row + quantity.row),
        )


def _joint_reference(plant: PlanarPlant, joint: JointRecord) -> Variable:
    """Return the reference of the gait; the kernel's own is the share of it that prescribed joints follow."""
    share = 1.0
    if plant.joints.prescribed:
        share = plant.robot.joints[joint.number].actuator.tracking
    shares = [RowShare(row=joint.first_row + rows.REFERENCE, factor=1.0 / share)]
    if share != 1.0:
        shares.append(RowShare(row=rows.OFFSET_NOW, factor=1.0 - 1.0 / share))
    return Variable(
        name=f"joint_angle_ref[{joint.number}]",
        causality="output",
        unit="rad",
        symbol="phi_i,ref",
        description=f"Reference angle of joint {joint.number}.",
        rows=tuple(shares),
    )


def _list_fin_outputs(plant: PlanarPlant) -> Iterator[Variable]:
    """Yield the variables of the fin's joints, numbered as in `Robot.fin_joints`."""
    joints = list_fin_joints(plant)
    yield from _list_for_joints(FIN_ANGLE, joints)
    yield from _list_for_joints(FIN_RATE, joints)
    is_driven = 0 in plant.robot.fin_joints
    if is_driven:
        drive = joints[0]
        yield Variable(
            name="fin_torque",
            causality="output",
            unit="N.m",
            description="Torque of the fin's drive.",
            rows=one_row(drive.first_row + rows.TORQUE),
        )


def _list_powers(plant: PlanarPlant) -> Iterator[Variable]:
    powers = [*MECHANICAL_POWERS]
    if has_power_model(plant.robot, plant.joints):
        powers.append(ELECTRICAL_POWER)
    for power in powers:
        yield Variable(
            name=f"{power.kind}_power",
            causality="output",
            unit="W",
            symbol="P",
            description=f"{power.description}, at this moment.",
            rows=one_row(power.power_row),
        )
    for power in powers:
        yield Variable(
            name=f"{power.kind}_work",
            causality="output",
            unit="J",
            description=f"{power.description}, since the start.",
            rows=one_row(power.work_row),
        )
