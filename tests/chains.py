"""Random robots, their states, and both ways to compute their accelerations."""

from dataclasses import dataclass, replace
from functools import cache, lru_cache
from itertools import pairwise

import numpy as np
import printed_equations as equations

from laticauda.models.planar import rows
from laticauda.models.planar.layout import Layout, build_layout
from laticauda.models.planar.model import specialize
from laticauda.robot import CaudalFin, Joint, Module, Robot, Section, Thruster, Water
from laticauda.robot.hydrodynamics import link_coefficients
from laticauda.water.fluid.laws import PolynomialDrag

FORMS = ("relative", "kirchhoff", "classic")


def random_robot(rng, n_links, *, fin=False, thrusters=0):
    modules = tuple(
        Module(
            length=rng.uniform(0.05, 0.3),
            mass=rng.uniform(0.3, 2.0),
            section=Section(
                half_height=rng.uniform(0.03, 0.08), half_width=rng.uniform(0.02, 0.07)
            ),
            normal_drag=rng.uniform(0.5, 2.0) if rng.random() < 0.3 else None,
        )
        for _ in range(n_links)
    )
    return Robot(
        name="random",
        modules=modules,
        joints=tuple(Joint() for _ in range(n_links - 1)),
        caudal_fin=random_fin(rng) if fin else None,
        thrusters=tuple(
            Thruster(
                link=int(rng.integers(n_links)),
                thrust=rng.uniform(-2, 2),
                angle=rng.uniform(-3, 3),
                x=rng.uniform(-0.05, 0.05),
                y=rng.uniform(-0.05, 0.05),
            )
            for _ in range(thrusters)
        ),
    )


def random_fin(rng):
    """Some have a C_A of their own."""
    opening, n_strips = rng.choice(["open", "closed"]), int(rng.integers(2, 9))
    return CaudalFin(opening=opening, n_strips=n_strips, added_mass=1.2 if n_strips % 2 else None)


def random_water(rng, form, *, drag=True, law=None, **changes):
    return replace(
        Water(
            tangential_friction=rng.uniform(0.01, 0.5),
            normal_drag=rng.uniform(0.5, 2.0),
            added_mass=rng.uniform(0.5, 2.0),
            added_inertia=rng.uniform(0.0, 2.0),
            tangential_added_mass=rng.uniform(0.0, 0.5),
            drag=law
            or PolynomialDrag(
                linear=drag,
                quadratic=drag,
                reference_speed=rng.uniform(0.2, 2.0),
                sway_friction=rng.uniform(0.0, 2.0) if drag else 0.0,
            ),
            friction_taper=rng.uniform(-1.0, 1.0),
            added_mass_form=form,
            rotational=str(rng.choice(["paper", "strip"])),
            current=tuple(rng.uniform(-0.3, 0.3, 2)),
        ),
        **changes,
    )


@dataclass(frozen=True)
class State:
    """Link angles of the body (without fin), their rates, and the velocity of the center of mass."""

    theta: np.ndarray
    rate: np.ndarray
    velocity: np.ndarray


def random_state(rng, n_links, fast=3.0):
    return State(
        rng.uniform(-3, 3, n_links), rng.uniform(-fast, fast, n_links), rng.uniform(-0.5, 0.5, 2)
    )


@cache
def kernels(law=None):
    return specialize(1, law)


def oracle(robot, water):
    """The robot as the equations see it, fin strips (and opening) as links; and the number of fin links."""
    c = link_coefficients(robot, water)
    names = ("c_t", "c_n", "mu_t", "mu_n", "lambda_1", "lambda_2", "lambda_3")
    columns = {name: getattr(c, name) for name in names}
    half, mass = c.half_length, c.mass
    inertia = np.array([m.moment_of_inertia for m in robot.modules])
    n_fin = 0
    if c.fin is not None:
        fin_half, fin_mass = c.fin.half_length[::-1], c.fin.mass[::-1]
        fin = {name: getattr(c.fin, name)[::-1] for name in names}
        opening = robot.caudal_fin.length - 2.0 * fin_half.sum()
        if opening > 1e-9:
            fin_half = np.append(fin_half, opening / 2.0)
            fin_mass = np.append(
                fin_mass, robot.caudal_fin.mass * opening / robot.caudal_fin.length
            )
            fin = {name: np.append(values, 0.0) for name, values in fin.items()}
        n_fin = len(fin_half)
        half, mass = np.append(fin_half, half), np.append(fin_mass, mass)
        inertia = np.append(fin_mass * fin_half**2 / 3.0, inertia)
        columns = {name: np.append(fin[name], columns[name]) for name in names}
    chain = equations.Chain(half_length=half, mass=mass, inertia=inertia, **columns)
    last = robot.caudal_fin or robot.modules[0]
    C_A = water.added_mass if last.added_mass is None else last.added_mass
    height = (
        robot.caudal_fin.height / 2.0 if robot.caudal_fin else robot.modules[0].section.half_height
    )
    options = equations.Options(
        form=water.added_mass_form,
        drag=water.drag,
        current=np.array(water.current),
        wake_mass=water.density * np.pi * C_A * height**2
        if water.trailing_edge == "elongated"
        else 0.0,
    )
    return chain, options, n_fin


def effectors(robot, theta, n_fin):
    """World forces and torques of the thrusters on every link of the oracle's chain."""
    force, torque = np.zeros((n_fin + robot.n_links, 2)), np.zeros(n_fin + robot.n_links)
    for t in robot.thrusters:
        i = n_fin + t.link
        angle = theta[t.link] + t.angle
        force[i] += t.thrust * np.array([np.cos(angle), np.sin(angle)])
        torque[i] += t.thrust * (t.x * np.sin(t.angle) - t.y * np.cos(t.angle))
    return force, torque


def fill(a: Layout, state: State):
    """Rows with a body state set; fin links follow the tail."""
    S = a.template.copy()
    body = S[rows.HEADER_ROWS : rows.HEADER_ROWS + a.n_bodies * rows.BODY_ROWS].reshape(
        -1, rows.BODY_ROWS
    )
    body[a.tail_link + 1 :, rows.ANGLE] = np.diff(state.theta)
    body[a.tail_link + 1 :, rows.RATE] = np.diff(state.rate)
    S[rows.HEADING], S[rows.HEADING_RATE] = state.theta.mean(), state.rate.mean()
    S[rows.VX], S[rows.VY] = state.velocity
    return S, body


class CutFin(CaudalFin):
    """A rigid fin that is cut where its strips begin, which makes links with locked joints of them."""

    edges = ()

    @property
    def pieces(self):
        (whole,) = super().pieces
        ends = [
            0.0,
            *(edge for edge in self.edges if 1e-9 < edge < self.length - 1e-9),
            self.length,
        ]
        return tuple(
            replace(whole, begin=begin, end=end, mass=whole.mass * (end - begin) / self.length)
            for begin, end in pairwise(ends)
        )


@lru_cache(maxsize=8)
def laid_out(robot, water, fin_as_links):
    """The layout, once for all states of a robot; the accelerations do not depend on how a rigid fin is made."""
    coefficients = link_coefficients(robot, water)
    if fin_as_links and robot.caudal_fin is not None:
        fin, strips = CutFin(**vars(robot.caudal_fin)), coefficients.fin
        object.__setattr__(fin, "edges", (-strips.position - strips.half_length).tolist())
        robot = replace(robot, caudal_fin=fin)
    return build_layout(robot, water, coefficients=coefficients)


def recursion(
    robot, water, state, *, joint_acceleration=None, joint_torque=None, fin_as_links=False
):
    """Accelerations by the kernel: theta'' of the body's links, p'', joint accelerations, joint torques."""
    a = laid_out(robot, water, fin_as_links)
    S, body = fill(a, state)
    is_free = np.zeros(a.n_bodies, dtype=bool)
    if joint_torque is None:
        body[a.tail_link + 1 :, rows.REFERENCE_2] = joint_acceleration
    else:
        is_free[a.tail_link + 1 :] = True
        body[a.tail_link + 1 :, rows.TOTAL_TORQUE] = joint_torque
    of_law = kernels() if isinstance(water.drag, PolynomialDrag) else kernels(water.drag)
    of_law.evaluate(S, a.n_bodies, a.first_strip, a.first_plate, is_free, a.tail_link, a.has_extras)
    own = body[a.tail_link :]
    return (
        own[:, rows.LINK_ACCELERATION].copy(),
        S[[rows.AX, rows.AY]].copy(),
        own[1:, rows.ACCELERATION].copy(),
        own[1:, rows.TOTAL_TORQUE].copy(),
    )
