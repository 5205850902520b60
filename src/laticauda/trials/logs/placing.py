"""Position and shape of a robot from the columns of an external log: axes and kinematics."""

import dataclasses
import math
from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
from jaxtyping import Float

from laticauda import robot
from laticauda.motion.gaits import Gait
from laticauda.robot import kinematics
from laticauda.trials.arrays import Samples
from laticauda.trials.logs.map_sections import (
    AXES,
    JOINT_UNITS,
    Body,
    Direction,
    Ends,
    Frame,
    Heading,
    JointColumns,
    Position,
)
from laticauda.trials.logs.measured_log import MeasuredLog
from laticauda.values import BadArgument
from laticauda.values.tables import (
    ANGLES,
    SMALLEST_SWING,
    Table,
    check_jumps,
    check_unit,
    mend_turns,
)

Points: TypeAlias = Float[np.ndarray, "n_samples 2"]
Directions: TypeAlias = Float[np.ndarray, "n_samples 3"]
Angles: TypeAlias = Float[np.ndarray, "n_samples n_columns"]
Placement: TypeAlias = dict[str, Float[np.ndarray, "n_samples ..."]]
"""`center_of_mass` and, as far as known, `heading` and `link_angle`, as in a trial."""

SMALLEST_HORIZONTAL_PART = 0.1
"""Part of a unit vector that must be horizontal for its angle to be known [-]."""


def measure_placement(log: MeasuredLog, chain: robot.Robot) -> Placement:
    """Return the position and orientation of the robot, as far as known, from the section of the map that defines them.

    Args:
        log: The log.
        chain: The planar robot.

    Returns:
        `center_of_mass`, `heading` and `link_angle`, as in a trial.

    Raises:
        ValueError: If a column is missing, has a long gap, or the map does not fit the robot.
    """
    column_map = log.column_map
    if column_map.ends is not None:
        return _place_by_ends(log, chain, column_map.ends)
    if column_map.body is not None:
        return _place_by_body(log, chain, column_map.body)
    assert column_map.center_of_mass is not None
    return _place_by_center_of_mass(
        log, chain, column_map.center_of_mass, heading=column_map.heading
    )


# ---- center of mass and heading ------------------------------------------------------------------


def _place_by_center_of_mass(
    log: MeasuredLog, chain: robot.Robot, position: Position, heading: Heading | None
) -> Placement:
    center_of_mass = _read_position(log, position.position, position.length_unit)
    placement: Placement = {"center_of_mass": center_of_mass}
    if heading is None:
        return placement
    yaw = log.read_heading(heading.column, heading.unit)
    forward = np.stack((np.cos(yaw), np.sin(yaw), 0.0 * yaw), axis=1)
    placement["heading"] = _angle_of_direction(log, heading.column, forward)
    if log.column_map.joint_angle is not None:
        joint_angle = read_joints(log, "joint_angle", chain)
        placement["link_angle"] = kinematics.link_angles(joint_angle, angle=placement["heading"])
    return placement


# ---- one tracked link ----------------------------------------------------------------------------


def _place_by_body(log: MeasuredLog, chain: robot.Robot, body: Body) -> Placement:
    if body.link >= chain.n_links:
        rule = f"must be < {chain.n_links}, the number of links, got {body.link}"
        raise BadArgument("body.link", rule)
    if body.name is not None:
        body = _with_columns_of_qtm(log.table, body)
    assert body.position is not None
    position = _read_position(log, body.position, body.length_unit)
    angle_of_body = _angle_of_direction(log, body.position[0], _read_forward_axis(log, body))
    angle = angle_of_body + math.radians(body.angle_offset_deg)
    joint_angle = read_joints(log, "joint_angle", chain)
    link_angle = kinematics.link_angles(joint_angle, angle=angle, link=body.link)
    center_of_mass = kinematics.center_of_mass(
        chain, position, link_angle, link=body.link, offset=body.offset
    )
    return {
        "center_of_mass": center_of_mass,
        "heading": kinematics.heading(link_angle),
        "link_angle": link_angle,
    }


def _with_columns_of_qtm(table: Table, body: Body) -> Body:
    """Return a rigid body that is given by name with all of its columns."""
    position = [f"{body.name} {axis}" for axis in AXES]
    rotation = [f"{body.name} Rot[{i}]" for i in range(9)]
    if all(name in table.columns for name in rotation):
        return dataclasses.replace(body, name=None, position=position, rotation=rotation)
    return dataclasses.replace(body, name=None, position=position, yaw=f"{body.name} Yaw")


def _read_forward_axis(log: MeasuredLog, body: Body) -> Directions:
    """Return the direction toward the head in the axes of the file."""
    forward = _parse_direction(body.forward)
    if body.rotation is not None:  # the columns of the matrix are the body's axes
        names = body.rotation[3 * forward.axis : 3 * forward.axis + 3]
        return forward.sign * np.stack([log.read(name) for name in names], axis=1)
    if body.quaternion is not None:
        w, x, y, z = [log.read(name) for name in body.quaternion]
        rotation = kinematics.from_quaternion(w, x, y, z)
        return forward.sign * rotation[:, forward.axis].T
    assert body.yaw is not None
    yaw = log.read_heading(body.yaw, body.angle_unit)
    if forward.axis == 2:
        rule = "must be x or y, or its opposite, with `yaw`: z does not turn with it"
        raise BadArgument("body.forward", rule)
    angle = yaw + 0.5 * math.pi * forward.axis
    return forward.sign * np.stack((np.cos(angle), np.sin(angle), 0.0 * angle), axis=1)


# ---- markers at the ends of all links ------------------------------------------------------------


def _place_by_ends(log: MeasuredLog, chain: robot.Robot, ends: Ends) -> Placement:
    if len(ends.markers) != chain.n_links + 1:
        need = f"{chain.n_links + 1} names: tail end, {chain.n_joints} joints, head end"
        raise BadArgument("ends.markers", f"must have {need}; got {len(ends.markers)}")
    markers = [_read_marker(log, ends, marker) for marker in ends.markers]
    links = np.diff(np.stack(markers, axis=1), axis=1)
    link_angle: Angles = np.unwrap(np.arctan2(links[..., 1], links[..., 0]), axis=0)
    # The initial turn of a link is not observable: assume that it is within half a turn of its
    # neighbor.
    link_angle = link_angle + (np.unwrap(link_angle[0]) - link_angle[0])
    # Every link yields the center of mass; averaging over the links' midpoints gives the least
    # noise.
    midpoints = 0.5 * (np.stack(markers[1:], axis=1) + np.stack(markers[:-1], axis=1))
    centers = [
        kinematics.center_of_mass(chain, midpoints[:, i], link_angle, link=i)
        for i in range(chain.n_links)
    ]
    return {
        "center_of_mass": np.mean(centers, axis=0),
        "heading": kinematics.heading(link_angle),
        "link_angle": link_angle,
    }


def _read_marker(log: MeasuredLog, ends: Ends, marker: str) -> Points:
    """Return the position of a marker; without a Z column, the markers are in the plane."""
    names = [ends.columns.format(marker=marker, axis=axis) for axis in AXES]
    names_in_file = [name for name in names if name in log.table.columns]
    return _read_position(log, names_in_file or names, ends.length_unit)


# ---- axes ----------------------------------------------------------------------------------------


class _SignedAxis(NamedTuple):
    """One of three axes, or its opposite."""

    axis: int
    """0, 1 or 2: x, y or z."""
    sign: float
    """-1 for the opposite, else 1."""


def _parse_direction(direction: Direction) -> _SignedAxis:
    sign = 1.0
    if direction.startswith("-"):
        sign = -1.0
    return _SignedAxis(axis="xyz".index(direction[-1]), sign=sign)


def _axes_of_trial(frame: Frame) -> Float[np.ndarray, "2 3"]:
    """Return the trial's x and y axes in the axes of the file, as rows, before the rotation."""
    axes = np.zeros((2, 3))
    for row, direction in enumerate((frame.x, frame.y)):
        signed_axis = _parse_direction(direction)
        axes[row, signed_axis.axis] = signed_axis.sign
    return axes


def _rotation_of_trial(frame: Frame) -> Float[np.ndarray, "2 2"]:
    return kinematics.turn("yaw", math.radians(frame.rotation_deg))[:2, :2]


def _read_position(log: MeasuredLog, names: Sequence[str], unit: str | None) -> Points:
    """Return a position in the trial's axes [m], without gaps, from its two or three columns."""
    frame = log.column_map.frame
    body_length = log.column_map.robot.planar().length
    columns = log.read_positions(names, unit, body_length=body_length).T
    axes = _axes_of_trial(frame)
    filled = [log.fill(name, column) for name, column in zip(names, columns, strict=True)]
    position = np.stack(filled, axis=1)
    if position.shape[1] == 2:
        if np.any(axes[:, 2]):
            raise BadArgument("frame", "must not name z: the position has no z")
        position = np.hstack((position, np.zeros((len(position), 1))))
    return (position @ axes.T - np.array(frame.origin)) @ _rotation_of_trial(frame).T


def _angle_of_direction(log: MeasuredLog, name: str, direction: Directions) -> Samples:
    """Return the angle of a direction from the trial's x axis [rad], unwrapped, without gaps."""
    frame = log.column_map.frame
    in_plane = direction @ _axes_of_trial(frame).T @ _rotation_of_trial(frame).T
    is_known = np.all(np.isfinite(in_plane), axis=1)
    x = in_plane[is_known, 0]
    y = in_plane[is_known, 1]
    if np.any(np.hypot(x, y) < SMALLEST_HORIZONTAL_PART):
        raise ValueError(
            f"The body of `{name}` must lie flat: its forward axis is almost upright. Is `forward` right?"
        )
    angle = np.full(len(in_plane), np.nan)
    angle[is_known] = np.arctan2(y, x)
    label = f"angle of {name}"
    angle = log.without_lost_angles(label, angle)
    is_known = np.isfinite(angle)
    angle[is_known] = np.unwrap(angle[is_known])
    return log.fill(label, angle)


# ---- joints --------------------------------------------------------------------------------------


def read_joints(log: MeasuredLog, section: str, chain: robot.Robot) -> Angles:
    """Return the values that one section defines for every joint, in SI units, without gaps.

    Args:
        log: The log.
        section: Section of the map, one of `JOINT_UNITS`.
        chain: The planar robot.

    Raises:
        ValueError: If a column is missing or has a long gap, or the number of columns is not the
            number of joints.
    """
    columns: JointColumns = getattr(log.column_map, section)
    try:
        names = columns.names(chain.n_joints)
    except ValueError as error:
        raise ValueError(str(error).replace("`columns`", f"`{section}.columns`")) from error
    if not names:
        return np.zeros((log.time.size, 0))
    joints: list[Samples] = []
    for name in names:
        values = _read_joint(log, section, name, columns.unit)
        joints.append(log.fill(name, columns.sign * values))
    angles = np.stack(joints, axis=1)
    if JOINT_UNITS[section] is ANGLES:
        unit = log.find_unit(names[0], columns.unit, ANGLES)
        check_unit(section, angles, unit, are_moving=_is_swimming(log.column_map.gait))
    return angles


def _is_swimming(gait: Gait | None) -> bool:
    """Return whether joints are known to swing so far that angles in rad would show."""
    return gait is not None and gait.amplitude > SMALLEST_SWING


def _read_joint(log: MeasuredLog, section: str, name: str, unit_in_map: str | None) -> Samples:
    """Return the values of one joint in SI units, nan where one is missing; angles without whole turns."""
    units = JOINT_UNITS[section]
    unit = log.find_unit(name, unit_in_map, units)
    values = units[unit] * log.read(name)
    if units is not ANGLES:
        return values
    mended = mend_turns(values)
    if mended.n_turns:
        log.remarks.append(f"whole turns were taken out of `{name}` at {mended.n_turns} samples")
    if unit == "rad":
        check_unit(section, mended.radians, unit)
    check_jumps(name, log.time, mended.radians, log.row_numbers)
    return mended.radians
