"""What water that moves in space and time does to a robot in the plane that is held, by the recursion."""

import math
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.models.planar import rows
from laticauda.models.planar.model import PlanarPlant
from laticauda.robot import Section, load_robot
from laticauda.robot.hydrodynamics import immersion_factor
from laticauda.water.fluid.laws import PolynomialDrag
from laticauda.water.fluid.waves import Sea, Waves

RADIUS, N = 0.05, 6
ROBOT = load_robot("chain", n_links=N)
ROBOT = replace(
    ROBOT,
    modules=tuple(
        replace(m, section=Section(half_height=RADIUS, half_width=RADIUS)) for m in ROBOT.modules
    ),
)
WATER = lc.Water(
    tangential_friction=0.2,
    normal_drag=1.1,
    added_mass=0.9,
    tangential_added_mass=0.3,
    drag=PolynomialDrag(linear=False),
)
WAVES = Waves(height=0.12, length=1.8, depth=0.9, direction=0.8, phase=0.3)
FLOWS = {
    "along": replace(WAVES, direction=0.0),
    "across": replace(WAVES, direction=0.5 * math.pi),
    "oblique": WAVES,
    "sea": Sea(significant_height=0.1, peak_period=1.3, spread=0.5, components=5, seed=2),
}


def held(water, heading, times):
    """Force on the straight robot that is held at the origin, world axes [N]."""
    plant = PlanarPlant(robot=ROBOT, environment=water)
    a, force = plant.layout, []
    for t in times:
        S = a.template.copy()
        S[rows.TIME], S[rows.HEADING] = t, heading
        locked = np.zeros(a.n_bodies, dtype=bool)
        plant._kernels.evaluate(
            S, a.n_bodies, a.first_strip, a.first_plate, locked, a.tail_link, a.has_extras
        )
        force.append(-S[rows.HEADER_ROWS :][[rows.P1, rows.P2]])
    return np.array(force)


def morison(water, heading, times):
    """The same by Morison's formula at the middle of each link: rho pi a^2 (1 + C_A) Du/Dt + rho C_D a |u| u."""
    z, area = -(water.depth or 0.0), math.pi * RADIUS**2
    added = water.added_mass * immersion_factor(RADIUS, water.depth)
    axis = np.array([math.cos(heading), math.sin(heading)])
    normal, total = np.array([-axis[1], axis[0]]), 0.0
    length = ROBOT.modules[0].length
    for i in range(N):
        x, y = (i + 0.5 - 0.5 * N) * length * axis
        u, w, gradient, rate = below(water.current, x, y, z, np.asarray(times))
        acceleration = rate + np.einsum("ijt,jt->it", gradient, np.array([*u, w]))
        (u_t, u_n), (a_t, a_n) = ((axis @ one, normal @ one) for one in (u, acceleration))
        along = (1.0 + water.tangential_added_mass) * area * a_t + FRICTION * RADIUS * np.abs(
            u_t
        ) * u_t
        across = (1.0 + added) * area * a_n + water.normal_drag * RADIUS * np.abs(u_n) * u_n
        total += water.density * length * (np.outer(along, axis) + np.outer(across, normal))
    return total


FRICTION = 0.5 * math.pi * WATER.tangential_friction


def below(flow, x, y, z, t):
    """Velocity, gradient and rate of the water below waves, from textbook potentials summed one by one."""
    u, w, gradient, rate = (
        np.zeros((2, t.size)),
        np.zeros(t.size),
        np.zeros((2, 3, t.size)),
        np.zeros((2, t.size)),
    )
    for wave in flow.parts:
        k, depth = math.hypot(wave.k_x, wave.k_y), getattr(flow, "depth", math.inf)
        ahead = np.array([wave.k_x, wave.k_y]) / k
        high = (
            math.exp(k * z)
            if depth == math.inf
            else math.cosh(k * (z + depth)) / math.sinh(k * depth)
        )
        low = (
            math.exp(k * z)
            if depth == math.inf
            else math.sinh(k * (z + depth)) / math.sinh(k * depth)
        )
        theta, speed = (
            wave.k_x * x + wave.k_y * y - wave.omega * t + wave.phase,
            wave.amplitude * wave.omega,
        )
        u += speed * high * np.outer(ahead, np.cos(theta))
        w += speed * low * np.sin(theta)
        rate += speed * high * wave.omega * np.outer(ahead, np.sin(theta))
        gradient[:, :2] -= speed * high * k * np.einsum("i,j,t->ijt", ahead, ahead, np.sin(theta))
        gradient[:, 2] += speed * low * k * np.outer(ahead, np.cos(theta))
    return u, w, gradient, rate


@pytest.mark.parametrize("form", ["relative", "kirchhoff", "classic"])
@pytest.mark.parametrize("depth", [None, 0.4])
@pytest.mark.parametrize("flow", FLOWS.values(), ids=FLOWS)
def test_a_cylinder_held_in_waves_bears_the_force_of_morisons_formula(flow, depth, form):
    water = replace(WATER, current=flow, depth=depth, added_mass_form=form)
    times = np.linspace(0.0, 3.0, 61)
    found, expected = held(water, 0.3, times), morison(water, 0.3, times)
    assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()


def test_a_run_that_goes_on_in_the_middle_of_a_sea_is_the_run_that_was_never_cut():
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.2, phase_shift=0.7)
    whole, half = (
        lc.swim("mamba-fin", gait, duration, current=Sea(seed=2)) for duration in (6.0, 3.0)
    )
    rest = lc.resume(lc.build_plant(half.scenario), half, 3.0)
    assert np.array_equal(rest.center_of_mass[-1], whole.center_of_mass[-1])
    assert np.array_equal(rest.joint_torque[-1], whole.joint_torque[-1])
