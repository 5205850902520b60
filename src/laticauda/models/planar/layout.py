"""Convert a robot and its environment to the flat array of `rows` that the kernels work on."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from itertools import accumulate
from typing import Any, NamedTuple, cast

import numpy as np
from jaxtyping import Float, Int

from laticauda import robot as robots
from laticauda.models.dynamics.joint_table import joint_table
from laticauda.models.planar import rows, sample_format
from laticauda.motion.joints import JointLaw, Prescribed
from laticauda.robot import Coefficients, fin_edge, link_coefficients, wake_mass
from laticauda.values import BadArgument, add_up
from laticauda.water.fluid import flow as flows


@dataclass(frozen=True, kw_only=True, eq=False)
class Layout:
    """One trial's parameters as rows, and the shape of its chain: the arguments of the kernels."""

    template: Float[np.ndarray, " rows"]
    """All rows of one lane, with the robot straight and at rest."""
    n_bodies: int
    """Number of links, plus the fin bodies if the fin is not folded into the tail link."""
    first_strip: Int[np.ndarray, " n_bodies_plus_1"]
    """Strips first_strip[i] to first_strip[i + 1] are rigidly attached to body i."""
    first_plate: Int[np.ndarray, " n_bodies_plus_1"]
    """The same for pectoral fins."""
    law: Int[np.ndarray, " n_bodies"]
    """Joint law at the tail end of each body (`rows.LOCKED` ... `rows.OWN_DRIVEN`); unused for body 0."""
    tail_link: int
    """Index of the body that is the robot's tail link; fin bodies come before it."""
    has_extras: bool
    """Whether any body has loads in addition to its own drag."""

    @property
    def has_finite_span(self) -> bool:
        """Whether a plate of finite span is at the tail: lanes side by side all have one, or none has."""
        return bool(self.template[rows.EDGE_LAG] > 0.0)

    @property
    def has_known_shape(self) -> bool:
        """Whether the joints move as they are told, and no loads but those of the bodies' own elements act."""
        joint_laws = self.law[1:]
        return not self.has_extras and bool(np.all(joint_laws < rows.FIRST_FREE))

    @property
    def n_joints(self) -> int:
        """Number of joints, those of the fin included."""
        return self.n_bodies - 1

    @cached_property
    def state_size(self) -> int:
        """Count of the numbers of a state vector."""
        return sample_format.size_of_state(self.n_joints)

    @cached_property
    def sample_size(self) -> int:
        """Count of the numbers of a sample, which begins with a state vector."""
        return sample_format.size_of_sample(self.n_joints)

    @cached_property
    def state_rows(self) -> Int[np.ndarray, " n_numbers"]:
        """Rows that make up a state vector."""
        return sample_format.rows_of_state(self.n_joints)

    def bodies_of(self, S: Float[np.ndarray, " rows"]) -> Float[np.ndarray, "n_bodies n_rows"]:
        """Return a view of the records of all bodies, one per row.

        Args:
            S: All rows of one lane.
        """
        end = rows.HEADER_ROWS + self.n_bodies * rows.BODY_ROWS
        return S[rows.HEADER_ROWS : end].reshape(-1, rows.BODY_ROWS)

    @cached_property
    def chain(self) -> tuple[object, ...]:
        """Shape of the chain, as the kernels take it."""
        return (
            self.n_bodies,
            self.first_strip,
            self.first_plate,
            self.law,
            self.tail_link,
            self.has_extras,
        )


NOT_PER_ELEMENT = ("fin", "areas")
"""Fields of `Coefficients` that hold further elements."""


class _Part(NamedTuple):
    """Mass without water: m [kg], center x from the body's tail end [m], inertia about it [kg m^2]."""

    mass: float
    position: float
    inertia: float


class _Body(NamedTuple):
    """One rigid body of the chain while the array is assembled."""

    length: float
    parts: tuple[_Part, ...]
    strips: Coefficients | None = None
    """Coefficients of its strips, positions from the body's tail end."""
    law: int = rows.LOCKED
    """Joint law of the hinge at the head end of a piece of the fin."""
    is_hinged: bool = False
    """Whether there is such a hinge."""


def build_layout(
    robot: robots.Robot,
    environment: robots.Environment,
    *,
    joints: JointLaw | None = None,
    coefficients: Coefficients | None = None,
) -> Layout:
    """Lay out a planar robot for the kernels.

    Args:
        robot: Robot whose joints all turn about the vertical axis (see `Robot.planar`).
        environment: Water or ground that the robot moves in or on.
        joints: Law by which the driven joints follow the gait; None: they are prescribed.
        coefficients: `link_coefficients` of robot and environment, if already known.

    Returns:
        The layout, straight and at rest at the origin.
    """
    joints = joints or Prescribed()
    coefficients = coefficients or link_coefficients(robot, environment)
    links, fin = _links_and_fin(robot, coefficients, joints)
    bodies = [*reversed(fin), *links]
    n = len(bodies)
    first_strip = [0, *accumulate(body.strips.mass.size if body.strips else 0 for body in bodies)]
    bodies_of_plates = [plate.link + len(fin) for plate in robot.pectoral_fins]
    first_plate = [sum(body < i for body in bodies_of_plates) for i in range(n + 1)]
    size = rows.HEADER_ROWS + n * rows.BODY_ROWS + first_strip[-1] * rows.STRIP_ROWS
    S = np.zeros(size + first_plate[-1] * rows.PLATE_ROWS)
    _write_environment(S, environment, robot, joints, folded=not fin)
    records = S[rows.HEADER_ROWS : rows.HEADER_ROWS + n * rows.BODY_ROWS].reshape(n, rows.BODY_ROWS)
    strips = S[rows.HEADER_ROWS + records.size : size].reshape(-1, rows.STRIP_ROWS)
    _write_bodies(records, bodies, coefficients, environment)
    records[:, rows.HEADING_SHARE] = [
        (len(links) - max(i - len(fin), 0)) / len(links) for i in range(n)
    ]
    for i, body in enumerate(bodies):
        if body.strips is not None:
            strips_of_body = strips[first_strip[i] : first_strip[i + 1]]
            strips_of_body[:, rows.POSITION_OF] = body.strips.position
            strips_of_body[:, rows.C_T_OF : rows.DISPLACED_OF + 1] = _load_coefficients(
                body.strips
            ).T
    law = _write_joints(records, robot, fin, joints)
    write_effectors(S, robot, environment, first_link=len(fin))
    flow = flow_rows(environment).numbers
    S[rows.FLOW] = S.size
    has_strips_or_plates = first_strip[-1] > 0 or first_plate[-1] > 0
    has_extras = (
        bool(robot.thrusters) or has_strips_or_plates or _is_pulled_at_tail(robot, environment)
    )
    return Layout(
        template=np.concatenate((S, flow)),
        n_bodies=n,
        first_strip=np.array(first_strip),
        first_plate=np.array(first_plate),
        law=law,
        tail_link=len(fin),
        has_extras=has_extras,
    )


def _is_pulled_at_tail(robot: robots.Robot, environment: robots.Environment) -> bool:
    """Return whether a tether or the wake of a trailing edge pulls at the tail."""
    if not isinstance(environment, robots.Water):
        return False
    tether = robot.tether
    return environment.trailing_edge != "none" or tether.drag > 0.0 or any(tether.force)


def _links_and_fin(
    robot: robots.Robot, coefficients: Coefficients, joints: JointLaw
) -> tuple[list[_Body], list[_Body]]:
    """Return the bodies of the links and of a movable fin, root first; a rigid fin is part of the tail link."""
    # A batch of an identification lays out one robot per run: what modules or joints share is
    # computed only once.
    body_of_module: dict[int, _Body] = {}
    for module in robot.modules:
        if id(module) not in body_of_module:
            position = module.length / 2.0 + module.center
            part = _Part(module.mass, position, module.moment_of_inertia)
            body_of_module[id(module)] = _Body(module.length, (part,))
    links = [body_of_module[id(module)] for module in robot.modules]
    if coefficients.areas is not None:
        links = _with_areas(links, robot, coefficients.areas)
    if robot.caudal_fin is None or coefficients.fin is None:
        return links, []
    fin = _fin_bodies(robot.caudal_fin, coefficients.fin, joints.code)
    if len(fin) == 1 and fin[0].law == rows.LOCKED:
        links[0] = _fold(links[0], fin.pop())
    return links, fin


def _with_areas(links: Sequence[_Body], robot: robots.Robot, areas: Coefficients) -> list[_Body]:
    """Return the links with their drag areas, which are strips for the kernels."""
    link_of_area = np.array([area.link for area in robot.drag_areas])
    with_areas: list[_Body] = []
    for i, body in enumerate(links):
        is_on_link = link_of_area == i
        if np.any(is_on_link):
            with_areas.append(body._replace(strips=_select(areas, is_on_link, 0.0)))
        else:
            with_areas.append(body)
    return with_areas


def _join(first: Coefficients, second: Coefficients) -> Coefficients:
    """Return the strips of both, those of the first before those of the second."""
    joined: dict[str, Any] = {
        field.name: np.concatenate((getattr(first, field.name), getattr(second, field.name)))
        for field in fields(first)
        if field.name not in NOT_PER_ELEMENT
    }
    return Coefficients(**joined)


def _fin_bodies(fin: robots.CaudalFin, strips: Coefficients, joints: int) -> list[_Body]:
    """Cut the fin at its hinges, which never cut through a strip; `joints` is the law of a driven root."""
    middle = -strips.position
    bodies: list[_Body] = []
    for piece in fin.pieces:
        joint = fin.joint if piece.begin == 0.0 else None
        law = rows.LOCKED if piece.hinge is None else rows.PASSIVE
        if joint is not None:
            law = joints
        inertia = piece.mass * piece.length**2 / 12.0
        is_on_piece = (middle > piece.begin) & (middle < piece.end)
        bodies.append(
            _Body(
                length=piece.length,
                parts=(_Part(piece.mass, piece.length / 2.0, inertia),),
                strips=_select(strips, is_on_piece, piece.end),
                law=law,
                is_hinged=joint is not None or piece.hinge is not None,
            )
        )
    return bodies


def _select(strips: Coefficients, is_selected: np.ndarray, end: float) -> Coefficients:
    """Return the selected strips, with positions measured from `end` behind the root."""
    selected = {
        field.name: getattr(strips, field.name)[is_selected]
        for field in fields(strips)
        if field.name not in NOT_PER_ELEMENT
    }
    selected["position"] = selected["position"] + end
    return Coefficients(**selected)


def _fold(tail: _Body, piece: _Body) -> _Body:
    """Return the tail link with a fin of one rigid piece as part of it."""
    part = piece.parts[0]
    strips = cast(Coefficients, piece.strips)
    strips = replace(strips, position=strips.position - piece.length)
    if tail.strips is not None:
        strips = _join(strips, tail.strips)
    return tail._replace(parts=(*tail.parts, part._replace(position=-part.position)), strips=strips)


def _write_environment(
    S: np.ndarray,
    environment: robots.Environment,
    robot: robots.Robot,
    joints: JointLaw,
    *,
    folded: bool,
) -> None:
    S[rows.OWN_VELOCITY] = 1.0
    S[rows.BANDWIDTH] = 1.0
    S[rows.ACTIVE_POWER] = robot.active_power or 0.0
    law_numbers = robots.law_of(environment).numbers
    S[rows.LAW : rows.LAW + len(law_numbers)] = law_numbers
    S[rows.JOINT_LAW : rows.JOINT_LAW + len(joints.numbers)] = joints.numbers
    if isinstance(environment, robots.Ground):
        return
    S[rows.TETHER_DRAG] = robot.tether.drag
    S[rows.TETHER_FORCE_X], S[rows.TETHER_FORCE_Y] = robot.tether.force
    S[rows.CURRENT_X], S[rows.CURRENT_Y], upward = environment.uniform
    if upward:
        raise BadArgument(
            "current",
            f"must be horizontal unless `model` is `spatial`, got {upward:g} m/s upward",
        )
    S[rows.HEIGHT] = -(environment.depth or 0.0)
    S[rows.OWN_VELOCITY] = environment.added_mass_form != "classic"
    S[rows.KIRCHHOFF] = environment.added_mass_form == "kirchhoff"
    if environment.trailing_edge == "none":
        return
    edge = fin_edge(robot, environment)
    if edge is not None and robot.caudal_fin is not None:
        S[rows.EDGE : rows.EDGE_LAG + 1] = edge.plate
        S[rows.WAKE_POSITION] = -edge.distance
        if not folded:
            S[rows.WAKE_POSITION] += robot.caudal_fin.length
        return
    S[rows.WAKE_MASS] = wake_mass(robot, environment)
    if robot.caudal_fin and folded:
        S[rows.WAKE_POSITION] = -robot.caudal_fin.length


def _write_bodies(
    records: np.ndarray, bodies: Sequence[_Body], w: Coefficients, environment: robots.Environment
) -> None:
    """Write masses and added masses of the bodies about their tail ends, and their own drag at their centers."""
    solids: dict[int, tuple[float, float, float, float]] = {}
    for body in bodies:
        if id(body) not in solids:
            solids[id(body)] = _solid(body)
    length, mass, moment, rigid = np.array([solids[id(body)] for body in bodies]).T
    mu_t, mu_n, moment_t, moment_n, added = _added_mass(bodies, w, length[-w.mass.size :] / 2.0)
    classic = isinstance(environment, robots.Water) and environment.added_mass_form == "classic"
    total = add_up(part.mass for body in bodies for part in body.parts)
    # In the other forms the centripetal term of mu_t cancels its velocity term. The classic form has two
    # more places, see `loads`.
    centripetal = moment + moment_t if classic else moment
    inertia = rigid + added, moment + moment_n, centripetal
    masses = mass + mu_t, mass + mu_n, mu_t, mu_n, moment_t, moment_n, mass / total, moment / total
    records[:, rows.LENGTH : rows.CENTER + 1] = np.array(
        (length, *inertia, *masses, length / 2.0)
    ).T
    records[-w.mass.size :, rows.C_T : rows.DISPLACED + 1] = _load_coefficients(w).T


def _load_coefficients(w: Coefficients) -> np.ndarray:
    """Return the load coefficients of elements: the rows of an element from C_T on."""
    return np.array((w.c_t, w.c_n, w.lambda_2, w.lambda_3, w.mu_t, w.mu_n, w.displaced))


def _solid(body: _Body) -> tuple[float, float, float, float]:
    """Return the length and, without water, m, m x and the moment of inertia about the tail end."""
    mass = moment = inertia = 0.0
    for part in body.parts:
        mass += part.mass
        moment += part.mass * part.position
        inertia += part.inertia + part.mass * part.position**2
    return body.length, mass, moment, inertia


def flow_rows(environment: robots.Environment) -> flows.Rows:
    """Return the flow of the water in the kernels' form; empty for the ground or a constant uniform current.

    Args:
        environment: Water or ground.
    """
    if not isinstance(environment, robots.Water) or environment.flow is None:
        return flows.Rows()
    return flows.rows_of(environment.flow, -(environment.depth or 0.0))


def _added_mass(bodies: Sequence[_Body], w: Coefficients, x: np.ndarray) -> np.ndarray:
    """Sum mu_t, mu_n, mu_t x, mu_n x and lambda_1 + mu_n x^2 over each body and its strips, x from its tail end.

    The last bodies are the links, whose own coefficients `w` apply at `x`.
    """
    sums = np.zeros((5, len(bodies)))
    sums[:, -x.size :] = w.mu_t, w.mu_n, w.mu_t * x, w.mu_n * x, w.lambda_1 + w.mu_n * (x * x)
    for i, body in enumerate(bodies):
        strips = body.strips
        if strips is None:
            continue
        position, mu_t, mu_n = strips.position, strips.mu_t, strips.mu_n
        sums[:, i] += (
            mu_t.sum(),
            mu_n.sum(),
            mu_t @ position,
            mu_n @ position,
            strips.lambda_1.sum() + mu_n @ (position * position),
        )
    return sums


def write_effectors(
    S: np.ndarray, robot: robots.Robot, environment: robots.Environment, *, first_link: int
) -> None:
    """Write the rows of thrusters and pectoral fins.

    Args:
        S: All rows of a lane, with those of the fins at the end.
        robot: Robot that has the thrusters and fins.
        environment: Water or ground that the robot moves in or on.
        first_link: Index of the body that is the robot's tail link.

    Raises:
        ValueError: If a thruster or fin acts out of the plane.
    """
    for group in ("thrusters", "pectoral_fins"):
        for i, effector in enumerate(getattr(robot, group)):
            _check_in_plane(f"{group}[{i}]", effector)
    records = S[rows.HEADER_ROWS :][first_link * rows.BODY_ROWS :][: robot.n_links * rows.BODY_ROWS]
    records = records.reshape(-1, rows.BODY_ROWS)
    records[:, rows.THRUST_T : rows.THRUST_MOMENT + 1] = 0.0
    for thruster in robot.thrusters:
        _add_thruster(records[thruster.link], robot, thruster.link, thruster)
    half_density = 0.5 * environment.density if isinstance(environment, robots.Water) else 0.0
    plates = sorted(robot.pectoral_fins, key=lambda plate: plate.link)
    plate_records = S[S.size - len(plates) * rows.PLATE_ROWS :].reshape(-1, rows.PLATE_ROWS)
    for record, plate in zip(plate_records, plates, strict=True):
        record[: rows.PLATE_WATER] = _plate_numbers(plate, robot.modules[plate.link], half_density)


def _check_in_plane(name: str, effector: robots.Thruster | robots.PectoralFin) -> None:
    """Reject a thruster or fin that acts out of the plane."""
    for angle in ("elevation", "roll"):
        value = getattr(effector, angle)
        if value != 0.0:
            raise BadArgument(
                f"{name}.{angle}",
                "must be 0 unless `model` is `spatial`, since it acts out of the plane, "
                f"got {value}",
            )


def _add_thruster(
    record: np.ndarray, robot: robots.Robot, link: int, thruster: robots.Thruster
) -> None:
    along = thruster.thrust * np.cos(thruster.angle)
    across = thruster.thrust * np.sin(thruster.angle)
    x = robot.modules[link].length / 2.0 + thruster.x
    record[[rows.THRUST_T, rows.THRUST_N]] += along, across
    record[rows.THRUST_MOMENT] += x * across - thruster.y * along


def _write_joints(
    records: np.ndarray, robot: robots.Robot, fin: Sequence[_Body], joints: JointLaw
) -> Int[np.ndarray, " n_bodies"]:
    """Write the parameters of the joint at the tail end of every body; return the joint laws."""
    table = joint_table(robot, joints)
    records[len(fin) + 1 :, : rows.JOINT_ROWS] = table[: robot.n_joints]
    fin_joints = iter(table[robot.n_joints :])
    law = np.full(len(records), joints.code)
    law[0] = rows.LOCKED
    # The hinge of a piece is at the tail end of the body ahead.
    for i, piece in zip(range(len(fin), 0, -1), fin, strict=True):
        law[i] = piece.law
        if piece.is_hinged:
            records[i, : rows.JOINT_ROWS] = next(fin_joints)
    return law


def _plate_numbers(
    plate: robots.PectoralFin, module: robots.Module, half_density: float
) -> tuple[float, ...]:
    """Return the rows of a pectoral fin."""
    place = plate.x + module.length / 2.0, plate.y, plate.angle + plate.deflection
    shape = plate.lift_slope, plate.stall_angle, plate.stall_sharpness, plate.parasitic_drag
    return *place, half_density * plate.area, *shape
