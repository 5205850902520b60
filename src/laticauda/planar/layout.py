"""From a robot and its environment to the flat array of `rows` that the kernels work on."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from jaxtyping import Float, Int

from laticauda.fluid import Coefficients, link_coefficients
from laticauda.planar import rows
from laticauda.planar.fin import FinBody, fin_bodies
from laticauda.robot import Actuator, Environment, Ground, Joint, Module, Robot, Thruster, Water

JOINT_LAWS = {"prescribed": rows.PRESCRIBED, "pd": rows.PD, "servo": rows.SERVO}


@dataclass(frozen=True, kw_only=True, eq=False)
class Layout:
    """One trial's parameters as rows, and the shape of its chain; what the kernels take as arguments."""

    template: Float[np.ndarray, " rows"]
    """All rows of one lane, state at rest and straight."""
    n_bodies: int
    """Links, and fin bodies when the fin is not folded into the tail link."""
    first_strip: Int[np.ndarray, " n_bodies_plus_1"]
    """Strips first_strip[i] to first_strip[i + 1] are rigid on body i."""
    first_plate: Int[np.ndarray, " n_bodies_plus_1"]
    """The same for pectoral fins."""
    law: Int[np.ndarray, " n_bodies"]
    """Joint law at the tail end of each body (`rows.LOCKED` ... `rows.PASSIVE`); that of body 0 means nothing."""
    tail_link: int
    """Index of the body that is the robot's tail link; fin bodies come before it."""
    has_extras: bool
    """Whether any body has loads besides its own drag."""

    @property
    def chain(self) -> tuple[object, ...]:
        """The shape of the chain, as the kernels take it."""
        return self.n_bodies, self.first_strip, self.first_plate, self.law, self.tail_link, self.has_extras


@dataclass(frozen=True)
class _Part:
    """Mass without water: m [kg], middle x from the body's tail end [m], own inertia [kg m^2]."""

    mass: float
    position: float
    inertia: float


@dataclass
class _Body:
    """One rigid body of the chain while the array is being put together."""

    length: float
    parts: list[_Part]
    water: Coefficients
    index: int | None
    """Which element of `water` is the body's own; None for a piece of the fin, which has strips only."""
    strips: Coefficients | None = None


@lru_cache(maxsize=64)  # repeated runs of one robot need not lay it out again; nobody writes to the arrays
def layout(robot: Robot, environment: Environment, *, joints: str = "prescribed", fin_as_links: bool = False) -> Layout:
    """Lay out a planar robot for the kernels.

    Args:
        robot: All joints turn about the vertical axis (see `Robot.planar`).
        environment: The water it swims in or the ground it crawls on.
        joints: prescribed, pd or servo: how the driven joints follow the gait.
        fin_as_links: Keep the strips of a rigid fin as links with locked joints instead of folding them into the tail
            link; the accelerations are the same.

    Returns:
        The layout, straight and at rest at the origin.
    """
    coefficients = link_coefficients(robot, environment)
    links = [
        _Body(length=m.length, parts=[_own_part(m)], water=coefficients, index=i) for i, m in enumerate(robot.modules)
    ]
    pieces: list[FinBody] = []
    if robot.caudal_fin is not None and coefficients.fin is not None:
        pieces = fin_bodies(robot.caudal_fin, coefficients.fin, joints=JOINT_LAWS[joints], as_links=fin_as_links)
        if len(pieces) == 1 and pieces[0].law == rows.LOCKED and not fin_as_links:
            _fold(links[0], pieces.pop())
    fin = [_fin_body(piece, coefficients) for piece in pieces]
    bodies = [*reversed(fin), *links]
    n = len(bodies)
    first_strip = np.cumsum([0, *(len(b.strips.mass) if b.strips else 0 for b in bodies)])
    plates = [[p for p in robot.pectoral_fins if p.link == i - len(fin)] for i in range(n)]
    first_plate = np.cumsum([0, *(len(p) for p in plates)])
    size = rows.HEADER_ROWS + n * rows.BODY_ROWS + first_strip[-1] * rows.STRIP_ROWS
    S = np.zeros(size + first_plate[-1] * rows.PLATE_ROWS)
    _write_environment(S, environment, robot, folded=not fin)
    total = sum(part.mass for body in bodies for part in body.parts)
    records = S[rows.HEADER_ROWS : rows.HEADER_ROWS + n * rows.BODY_ROWS].reshape(n, rows.BODY_ROWS)
    strips = S[rows.HEADER_ROWS + records.size : size].reshape(-1, rows.STRIP_ROWS)
    for i, body in enumerate(bodies):
        _write_body(records[i], body, environment, total)
        link = max(i - len(fin), 0)
        records[i, rows.HEADING_SHARE] = (len(links) - link) / len(links)
        if body.strips is not None:
            _write_strips(strips[first_strip[i] : first_strip[i + 1]], body.strips)
    for thruster in robot.thrusters:
        _add_thruster(records[len(fin) + thruster.link], robot, thruster.link, thruster)
    for i, joint in enumerate(robot.joints):
        _write_joint(records[len(fin) + i + 1], joint, joints)
    law = np.full(n, JOINT_LAWS[joints])
    law[0] = rows.LOCKED
    for i, piece in enumerate(pieces):  # its hinge is at the tail end of the body before it
        law[len(fin) - i] = piece.law
        _write_hinge(records[len(fin) - i], piece, joints)
    half_density = 0.5 * environment.density if isinstance(environment, Water) else 0.0
    for e, plate in enumerate(p for group in plates for p in group):
        at = S[size + e * rows.PLATE_ROWS :]
        at[: rows.PLATE_ROWS] = (
            plate.x + robot.modules[plate.link].length / 2.0,
            plate.y,
            plate.angle,
            half_density * plate.area,
            plate.lift_slope,
            plate.stall_angle,
            plate.stall_sharpness,
            plate.parasitic_drag,
        )
    wake = S[rows.WAKE_MASS] > 0.0
    pulled = S[rows.TETHER_DRAG] > 0.0 or bool(np.any(S[[rows.TETHER_FORCE_X, rows.TETHER_FORCE_Y]] != 0.0))
    return Layout(
        template=S,
        n_bodies=n,
        first_strip=first_strip,
        first_plate=first_plate,
        law=law,
        tail_link=len(fin),
        has_extras=bool(robot.thrusters or first_strip[-1] or first_plate[-1] or wake or pulled),
    )


def _own_part(module: Module) -> _Part:
    return _Part(module.mass, module.length / 2.0 + module.center, module.moment_of_inertia)


def _fin_body(piece: FinBody, coefficients: Coefficients) -> _Body:
    part = _Part(piece.mass, piece.length / 2.0, piece.mass * piece.length**2 / 12.0)
    return _Body(length=piece.length, parts=[part], water=coefficients, index=None, strips=piece.strips)


def _fold(tail: _Body, piece: FinBody) -> None:
    """Make a fin of one rigid piece a part of the tail link."""
    tail.parts.append(_Part(piece.mass, -piece.length / 2.0, piece.mass * piece.length**2 / 12.0))
    tail.strips = replace(piece.strips, position=piece.strips.position - piece.length)


def _write_environment(S: np.ndarray, environment: Environment, robot: Robot, *, folded: bool) -> None:
    S[rows.OWN_VELOCITY] = 1.0
    S[rows.LINEAR] = 1.0
    S[rows.BANDWIDTH] = 1.0
    S[rows.REFERENCE_SPEED] = 1.0
    if isinstance(environment, Ground):
        if environment.friction == "coulomb":
            S[rows.REFERENCE_SPEED] = environment.regularization_speed
        return
    S[rows.TETHER_DRAG] = robot.tether.drag
    S[[rows.TETHER_FORCE_X, rows.TETHER_FORCE_Y]] = robot.tether.force
    S[[rows.CURRENT_X, rows.CURRENT_Y]] = environment.current
    S[rows.REFERENCE_SPEED] = environment.reference_speed
    S[rows.LINEAR] = environment.linear_drag
    S[rows.QUADRATIC] = environment.quadratic_drag
    S[rows.SWAY_FRICTION] = environment.sway_friction
    S[rows.OWN_VELOCITY] = environment.added_mass_form != "classic"
    S[rows.KIRCHHOFF] = environment.added_mass_form == "kirchhoff"
    if environment.trailing_edge == "elongated":
        fin = robot.caudal_fin
        half_height = fin.height / 2.0 if fin else robot.modules[0].section.half_height
        S[rows.WAKE_MASS] = environment.density * np.pi * half_height**2
        S[rows.WAKE_POSITION] = -fin.length if fin and folded else 0.0


def _write_body(record: np.ndarray, body: _Body, environment: Environment, total_mass: float) -> None:
    """Masses and added masses of a body about its tail end; its own drag at its middle."""
    mass = sum(p.mass for p in body.parts)
    moment = sum(p.mass * p.position for p in body.parts)
    own = np.array([] if body.index is None else [body.index], dtype=int)
    elements = [_elements(body.water, own, np.full(own.size, body.length / 2.0))]
    if body.strips is not None:
        elements.append(_elements(body.strips, np.arange(body.strips.mass.size), body.strips.position))
    x, mu_t, mu_n, lambda_1 = np.concatenate(elements, axis=1)
    moment_t = float(np.sum(mu_t * x))
    classic = isinstance(environment, Water) and environment.added_mass_form == "classic"
    record[rows.LENGTH] = body.length
    record[rows.CENTER] = body.length / 2.0
    rigid = sum(p.inertia + p.mass * p.position**2 for p in body.parts)
    record[rows.INERTIA] = rigid + np.sum(lambda_1 + mu_n * x**2)
    record[rows.COUPLING] = moment + np.sum(mu_n * x)
    # In the other forms the centripetal term of mu_t cancels against its velocity term.
    record[rows.CENTRIPETAL] = moment + (moment_t if classic else 0.0)
    record[rows.MASS_T] = mass + np.sum(mu_t)
    record[rows.MASS_N] = mass + np.sum(mu_n)
    record[rows.MU_T] = np.sum(mu_t)
    record[rows.MU_N] = np.sum(mu_n)
    record[rows.MOMENT_T] = moment_t
    record[rows.MOMENT_N] = np.sum(mu_n * x)
    record[rows.MASS_SHARE] = mass / total_mass
    record[rows.FIRST_MOMENT_SHARE] = moment / total_mass
    if body.index is not None:
        w, i = body.water, body.index
        record[[rows.C_T, rows.C_N, rows.LAMBDA_2, rows.LAMBDA_3]] = w.c_t[i], w.c_n[i], w.lambda_2[i], w.lambda_3[i]


def _elements(water: Coefficients, index: np.ndarray, position: np.ndarray) -> np.ndarray:
    return np.array([position, water.mu_t[index], water.mu_n[index], water.lambda_1[index]])


def _write_strips(strips: np.ndarray, water: Coefficients) -> None:
    strips[:, rows.STRIP_POSITION] = water.position
    strips[:, rows.STRIP_C_T] = water.c_t
    strips[:, rows.STRIP_C_N] = water.c_n
    strips[:, rows.STRIP_LAMBDA_2] = water.lambda_2
    strips[:, rows.STRIP_LAMBDA_3] = water.lambda_3


def _add_thruster(record: np.ndarray, robot: Robot, link: int, thruster: Thruster) -> None:
    along, across = thruster.thrust * np.cos(thruster.angle), thruster.thrust * np.sin(thruster.angle)
    x = robot.modules[link].length / 2.0 + thruster.x
    record[[rows.THRUST_T, rows.THRUST_N]] += along, across
    record[rows.THRUST_MOMENT] += x * across - thruster.y * along


def _write_joint(record: np.ndarray, joint: Joint, drive: str) -> None:
    record[rows.ENVELOPE] = joint.actuator.tracking if drive == "prescribed" else 1.0
    record[[rows.STIFFNESS, rows.DAMPING]] = joint.stiffness, joint.damping
    record[rows.LAW_0 : rows.LAW_5 + 1] = _law_parameters(joint.actuator, drive)


def _write_hinge(record: np.ndarray, piece: FinBody, drive: str) -> None:
    if piece.joint is not None:
        _write_joint(record, piece.joint, drive)
        record[rows.ENVELOPE] = 1.0
    elif piece.hinge is not None:
        record[[rows.STIFFNESS, rows.DAMPING]] = piece.hinge.stiffness, piece.hinge.damping


def _law_parameters(actuator: Actuator, drive: str) -> tuple[float, ...]:
    if drive == "pd":
        return (actuator.proportional_gain, actuator.derivative_gain, 0.0, 0.0, 0.0, 0.0)
    return (
        actuator.servo_gain,
        actuator.stall_torque,
        actuator.no_load_speed,
        actuator.friction_torque,
        actuator.viscous_friction,
        actuator.voltage * actuator.stall_current,
    )
