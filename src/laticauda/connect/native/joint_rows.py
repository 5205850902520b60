"""Rows of the kernels that belong to joints: where the record of each joint begins."""

from typing import NamedTuple

from laticauda.models.planar import PlanarPlant, rows


class JointRecord(NamedTuple):
    """A joint, and the kernel rows of the body at whose tail end it is."""

    number: int
    """Number of the joint, as other tools see it [-]."""
    first_row: int
    """First of the rows [-]."""


def first_row_of_body(body: int) -> int:
    """Return the first row of the record of a body, whose joint is the one at its tail end.

    Args:
        body: Index of the body in the kernels, from the last piece of the fin on.
    """
    return rows.HEADER_ROWS + body * rows.BODY_ROWS


def list_body_joints(plant: PlanarPlant) -> list[JointRecord]:
    """Return the joints between the robot's links, tail first.

    Args:
        plant: Plant in water.
    """
    layout = plant.layout
    first_body = layout.tail_link + 1
    records: list[JointRecord] = []
    for body in range(first_body, layout.n_bodies):
        record = JointRecord(number=body - first_body, first_row=first_row_of_body(body))
        records.append(record)
    return records


def list_fin_joints(plant: PlanarPlant) -> list[JointRecord]:
    """Return the joints of the fin, numbered as in `Robot.fin_joints`.

    Args:
        plant: Plant in water.
    """
    tail_link = plant.layout.tail_link
    records: list[JointRecord] = []
    for number in plant.robot.fin_joints:
        record = JointRecord(number=number, first_row=first_row_of_body(tail_link - number))
        records.append(record)
    return records
