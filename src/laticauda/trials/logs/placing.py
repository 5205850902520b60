"""Position and shape of a robot from the columns of an external log: units, axes, kinematics, gaps."""

import dataclasses
import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from laticauda import robot
from laticauda.robot import kinematics
from laticauda.trials.arrays import Samples
from laticauda.trials.logs.column_maps import ANGLES, AXES, LENGTHS, UNITS, Body, ColumnMap, Frame
from laticauda.trials.logs.tables import Table
from laticauda.values import BadArgument

Points = Float[np.ndarray, "n_samples 2"]
Angles = Float[np.ndarray, "n_samples n_columns"]
Places = dict[str, Float[np.ndarray, "n_samples ..."]]


@dataclass
class Measured:
    """The part of a table that forms the trial, and a record of what had to be filled in."""

    table: Table
    """The whole file."""
    column_map: ColumnMap
    """Meaning of its columns."""
    rows: Bool[np.ndarray, " n_rows"]
    """Rows of the table that belong to the trial."""
    time: Samples
    """Time since the start of the trial [s]."""
    lost: Bool[np.ndarray, " n_samples"]
    """Samples that had a gap in any quantity."""
    filled_columns: list[str] = field(default_factory=list[str])
    """Names of the quantities that had a gap."""

    def raw(self, name: str) -> Samples:
        """Return the column `name` as it is in the file, including its gaps."""
        return self.table[name][self.rows]

    def whole(self, name: str, values: Samples) -> Samples:
        """Return the `values` of the quantity `name` with gaps filled."""
        found, lost = fill_gaps(
            name, self.time + (self.column_map.start or 0.0), values, self.column_map.longest_gap
        )
        if np.any(lost):
            self.filled_columns.append(name)
            self.lost |= lost
        return found

    def lengths(self, names: Any, unit: str | None) -> Float[np.ndarray, "n_samples n_columns"]:
        """Return the columns `names` as lengths [m], including gaps; `unit` if the map states it."""
        return np.stack(
            [LENGTHS[self._unit(name, unit, LENGTHS)] * self.raw(name) for name in names], axis=1
        )

    def angle(self, name: str, unit: str | None) -> Samples:
        """Return the column `name` as angles [rad], including gaps; `unit` if the map states it."""
        return ANGLES[self._unit(name, unit, ANGLES)] * self.raw(name)

    def _unit(self, name: str, asked: str | None, units: dict[str, float]) -> str:
        unit = asked or self.table.units.get(name) or next(iter(units))
        if unit not in units:
            raise ValueError(
                f"Column `{name}` must be in {', '.join(units)}, but the file says {unit!r}."
            )
        return unit


def place_of(log: Measured, chain: robot.Robot) -> Places:
    """Return the position and orientation of the robot, as far as known, from the section of the map that defines them.

    Args:
        log: The log.
        chain: The planar robot.

    Returns:
        `center_of_mass`, `heading` and `link_angle`, as in a trial.

    Raises:
        ValueError: If a column is missing, has a long gap, or the map does not fit the robot.
    """
    given = log.column_map
    if given.ends is not None:
        return _from_ends(log, chain)
    if given.body is not None:
        return _from_body(log, chain, given.body)
    assert given.center_of_mass is not None
    found = {
        "center_of_mass": _plane(
            log, given.center_of_mass.position, given.center_of_mass.length_unit
        )
    }
    if given.heading is not None:
        yaw = log.angle(given.heading.column, given.heading.unit)
        forward = np.stack((np.cos(yaw), np.sin(yaw), 0.0 * yaw), axis=1)
        found["heading"] = _direction(log, given.heading.column, forward)
    if given.heading is not None and given.joint_angle is not None:
        joints = joints_of(log, "joint_angle", chain)
        found["link_angle"] = kinematics.link_angles(joints, angle=found["heading"])
    return found


def _from_body(log: Measured, chain: robot.Robot, body: Body) -> Places:
    if body.link >= chain.n_links:
        raise BadArgument(
            "body.link", f"must be < {chain.n_links}, the number of links, got {body.link}"
        )
    if body.name is not None:
        body = _of_qtm(log.table, body)
    assert body.position is not None
    position = _plane(log, body.position, body.length_unit)
    angle = _direction(log, body.position[0], _forward(log, body)) + math.radians(
        body.angle_offset_deg
    )
    link_angle = kinematics.link_angles(
        joints_of(log, "joint_angle", chain), angle=angle, link=body.link
    )
    center = kinematics.center_of_mass(
        chain, position, link_angle, link=body.link, offset=body.offset
    )
    return {
        "center_of_mass": center,
        "heading": kinematics.heading(link_angle),
        "link_angle": link_angle,
    }


def _of_qtm(table: Table, body: Body) -> Body:
    """Return a rigid body that is given by name with all of its columns."""
    position = [f"{body.name} {axis}" for axis in AXES]
    rotation = [f"{body.name} Rot[{i}]" for i in range(9)]
    if all(name in table.columns for name in rotation):
        return dataclasses.replace(body, name=None, position=position, rotation=rotation)
    return dataclasses.replace(body, name=None, position=position, yaw=f"{body.name} Yaw")


def _from_ends(log: Measured, chain: robot.Robot) -> Places:
    ends = log.column_map.ends
    assert ends is not None
    if len(ends.markers) != chain.n_links + 1:
        need = f"{chain.n_links + 1} names: tail end, {chain.n_joints} joints, head end"
        raise BadArgument("ends.markers", f"must have {need}; got {len(ends.markers)}")
    place: list[Points] = []
    for marker in ends.markers:
        names = [ends.columns.format(marker=marker, axis=axis) for axis in AXES]
        # Without a Z column, the markers are in the plane.
        place.append(
            _plane(
                log,
                [name for name in names if name in log.table.columns] or names,
                ends.length_unit,
            )
        )
    links = np.diff(np.stack(place, axis=1), axis=1)
    link_angle: Angles = np.unwrap(np.arctan2(links[..., 1], links[..., 0]), axis=0)
    # The initial turn of a link is not observable: assume that it is within half a turn of its
    # neighbor.
    link_angle = link_angle + (np.unwrap(link_angle[0]) - link_angle[0])
    # Every link yields the center of mass; averaging over the links' midpoints gives the least
    # noise.
    middles = 0.5 * (np.stack(place[1:], axis=1) + np.stack(place[:-1], axis=1))
    centers = [
        kinematics.center_of_mass(chain, middles[:, i], link_angle, link=i)
        for i in range(chain.n_links)
    ]
    center = np.mean(centers, axis=0)
    return {
        "center_of_mass": center,
        "heading": kinematics.heading(link_angle),
        "link_angle": link_angle,
    }


def _forward(log: Measured, body: Body) -> Float[np.ndarray, "n_samples 3"]:
    """Return the direction toward the head in the axes of the file."""
    sign, axis = -1.0 if body.forward.startswith("-") else 1.0, "xyz".index(body.forward[-1])
    if body.rotation is not None:  # the columns of the matrix are the body's axes
        return sign * np.stack(
            [log.raw(name) for name in body.rotation[3 * axis : 3 * axis + 3]], axis=1
        )
    if body.quaternion is not None:
        return sign * kinematics.from_quaternion(*map(log.raw, body.quaternion))[:, axis].T
    assert body.yaw is not None
    angle = log.angle(body.yaw, body.angle_unit)
    if axis == 2:
        raise BadArgument(
            "body.forward", "must be x or y, or its opposite, with `yaw`: z does not turn with it"
        )
    angle = angle + 0.5 * math.pi * axis
    return sign * np.stack((np.cos(angle), np.sin(angle), 0.0 * angle), axis=1)


def _axes(frame: Frame) -> Float[np.ndarray, "2 3"]:
    """Return the trial's x and y axes in the axes of the file, as rows."""
    rows = np.zeros((2, 3))
    for row, name in enumerate((frame.x, frame.y)):
        rows[row, "xyz".index(name[-1])] = -1.0 if name.startswith("-") else 1.0
    return rows


def _turn(frame: Frame) -> Float[np.ndarray, "2 2"]:
    return kinematics.turn("yaw", math.radians(frame.rotation_deg))[:2, :2]


def _plane(log: Measured, names: Any, unit: str | None) -> Points:
    """Return a position in the trial's axes [m], without gaps."""
    place, frame = log.lengths(names, unit), log.column_map.frame
    axes = _axes(frame)
    place = np.stack(
        [log.whole(name, column) for name, column in zip(names, place.T, strict=True)], axis=1
    )
    if place.shape[1] == 2:
        if np.any(axes[:, 2]):
            raise BadArgument("frame", "must not name z: the position has no z")
        place = np.hstack((place, np.zeros((len(place), 1))))
    return (place @ axes.T - np.array(frame.origin)) @ _turn(frame).T


def _direction(log: Measured, name: str, forward: Float[np.ndarray, "n_samples 3"]) -> Samples:
    """Return the angle of a direction from the trial's x axis [rad], unwrapped, without gaps."""
    frame = log.column_map.frame
    ours = forward @ _axes(frame).T @ _turn(frame).T
    known = np.all(np.isfinite(ours), axis=1)
    if np.any(np.hypot(*ours[known].T) < 0.1):
        raise ValueError(
            f"The body of `{name}` must lie flat: its forward axis is almost upright. Is `forward` right?"
        )
    angle = np.full(len(ours), np.nan)
    angle[known] = np.unwrap(np.arctan2(ours[known, 1], ours[known, 0]))
    return log.whole(f"angle of {name}", angle)


def joints_of(log: Measured, section: str, chain: robot.Robot) -> Angles:
    """Return the values that one section defines for every joint, in SI units, without gaps.

    Args:
        log: The log.
        section: Section of the map, one of `UNITS`.
        chain: The planar robot.

    Raises:
        ValueError: If a column is missing or has a long gap, or the number of columns is not the
            number of joints.
    """
    given = getattr(log.column_map, section)
    factor = given.sign * UNITS[section][given.unit or next(iter(UNITS[section]))]
    try:
        names = given.names(chain.n_joints)
    except ValueError as error:
        raise ValueError(str(error).replace("`columns`", f"`{section}.columns`")) from error
    found = [log.whole(name, factor * log.raw(name)) for name in names]
    return np.stack(found, axis=1) if found else np.zeros((log.time.size, 0))


def fill_gaps(
    name: str, time: Samples, signal: Float[np.ndarray, " n_samples"], longest: float
) -> tuple[Samples, Bool[np.ndarray, " n_samples"]]:
    """Fill the gaps of a signal by linear interpolation.

    Args:
        name: Name of the signal, for the error message.
        time: Times of the samples [s].
        signal: Values; nan where missing.
        longest: Longest time over which values may be missing [s].

    Returns:
        The values, and which of them were missing.

    Raises:
        ValueError: If values are missing over a longer time, or at either end.
    """
    lost = ~np.isfinite(signal)
    if not np.any(lost):
        return signal, lost
    known = np.flatnonzero(~lost)
    advice = "cut it off with `start` and `stop`, or fill it by hand"
    if not known.size:
        raise BadArgument(
            name, f"must hold numbers, but it holds none from {time[0]:g} s to {time[-1]:g} s"
        )
    if lost[0] or lost[-1]:
        end, at = ("begins", time[known[0]]) if lost[0] else ("ends", time[known[-1]])
        raise BadArgument(
            name, f"must hold numbers at both ends, but it {end} at {at:.6g} s; {advice}"
        )
    steps = np.diff(time[known])
    gap = int(np.argmax(np.where(np.diff(known) > 1, steps, 0.0)))
    if steps[gap] > longest * (1.0 + 1e-9):
        begin, end = time[known[gap]], time[known[gap + 1]]
        rule = f"must have no gap longer than `longest_gap` = {longest:g} s, got one of {steps[gap]:.4g} s"
        raise BadArgument(name, f"{rule} from {begin:.6g} s to {end:.6g} s; {advice}")
    return np.interp(time, time[known], signal[known]), lost
