"""Bodies in water that moves, against what theory says of them: Morison, orbits, heave, and water that turns."""

import math
from dataclasses import replace

import mujoco
import numpy as np
import pytest
import water_oracle as oracle
from hypothesis import given, settings, strategies as st
from scipy.integrate import solve_ivp

from laticauda.values.quantities import quantity, value_class
from laticauda.water import mujoco as water
from laticauda.water.fluid.flow import Flow
from laticauda.water.fluid.laws import PolynomialDrag
from laticauda.water.mujoco import Element

GRAVITY = 9.81


@value_class
class Airy(Flow):
    """Waves along x over a level bed."""

    amplitude: float = quantity("m", "of the surface")
    k: float = quantity("1/m", "wave number")
    omega: float = quantity("rad/s", "frequency")
    depth: float = quantity("m", "of the water")

    def __call__(self, x, y, z, t):
        k, omega, a = self.k, self.omega, self.amplitude
        scale = a * omega / np.sinh(k * self.depth)
        along, upward = scale * np.cosh(k * (z + self.depth)), scale * np.sinh(k * (z + self.depth))
        c, s = np.cos(k * x - omega * t), np.sin(k * x - omega * t)
        o = 0.0 * c
        rates, slopes = (
            (omega * along * s, o, -omega * upward * c),
            (-k * along * s, o, k * upward * c, o, o, o),
        )
        return (along * c, o, upward * s, *rates, *slopes, k * upward * c, o, k * along * s, a * c)


def airy(amplitude: float, k: float, depth: float) -> Airy:
    return Airy(
        amplitude=amplitude, k=k, depth=depth, omega=math.sqrt(GRAVITY * k * math.tanh(k * depth))
    )


def model_of(body: str, gravity: float = GRAVITY, dt: float = 0.005):
    text = f"""<mujoco><option timestep="{dt}" gravity="0 0 {-gravity}" integrator="RK4"/><worldbody>{body}</worldbody>
    </mujoco>"""
    return water.compile_spec(mujoco.MjSpec.from_string(text))


@pytest.mark.filterwarnings("ignore:body .* has buoyancy but no free joint")
def test_a_cylinder_that_is_held_in_waves_bears_the_force_of_morison_s_equation():
    """Upright, of ten pieces: rho pi a^2 (1 + C_A) Du/Dt + rho C_D a |u| u per length, each at its height."""
    rho, radius, c_a, c_d, n, piece = 1000.0, 0.05, 0.9, 1.1, 10, 0.1
    held = (
        '<body name="b"><joint type="slide" axis="1 0 0" armature="1e15"/><geom size=".1"/></body>'
    )
    model, wave = model_of(held), airy(0.06, 1.7, 1.5)
    heights = [-0.15 - piece * i for i in range(n)]
    across, ends = math.pi * radius**2 * piece, 0.5**0.5
    elements = [
        Element(
            body="b",
            position=(0.0, 0.0, z),
            orientation=(ends, 0.0, -ends, 0.0),  # its axis upward
            drag=(0.0, rho * c_d * radius * piece, rho * c_d * radius * piece),
            added_mass=(0.0, rho * c_a * across, rho * c_a * across),
            volume=across,
            shape="cylinder",
            half_size=(0.5 * piece, radius, radius),
        )
        for z in heights
    ]
    handle = water.attach(model, elements, surface=0.0, current=wave)
    data = mujoco.MjData(model)
    found, expected = np.zeros(48), np.zeros(48)
    for i in range(48):
        data.time = i / 48 * 2.0 * math.pi / wave.omega
        loads = handle.forces(data)
        found[i] = (loads["drag"] + loads["added_mass"])[:, 0].sum()
        for z in heights:
            scale, theta = (
                wave.amplitude * wave.omega / math.sinh(1.7 * 1.5),
                -wave.omega * data.time,
            )
            cosh, sinh = scale * math.cosh(1.7 * (z + 1.5)), scale * math.sinh(1.7 * (z + 1.5))
            u, w = cosh * math.cos(theta), sinh * math.sin(theta)
            rate = (
                wave.omega * cosh * math.sin(theta)
                - 1.7 * u * cosh * math.sin(theta)
                + 1.7 * w * sinh * math.cos(theta)
            )
            expected[i] += (
                rho * across * (1.0 + c_a) * rate + rho * c_d * radius * piece * abs(u) * u
            )
    assert np.ptp(expected) > 10.0
    np.testing.assert_allclose(found, expected, atol=1e-9 * np.abs(expected).max())


def test_a_neutral_sphere_goes_round_with_the_water_of_long_waves():
    """A particle's path, solved apart: an orbit of radius a e^(kz) that drifts."""
    ball = '<body name="b" pos="0 0 -0.7"><freejoint/><geom name="g" size=".05" density="1000"/></body>'
    model, k, amplitude = model_of(ball), 2.0 * math.pi / 8.0, 0.03
    wave = airy(amplitude, k, 20.0)
    water.attach(model, [water.geom_element(model, "g")], surface=0.0, current=wave)
    data = mujoco.MjData(model)
    speed = wave.velocity(np.array([0.0, 0.0, -0.7]), 0.0)
    data.qvel[:3] = speed
    period = 2.0 * math.pi / wave.omega
    times = np.arange(1, 1 + round(3.0 * period / 0.005)) * 0.005
    path = np.zeros((times.size, 3))
    for i in range(times.size):
        mujoco.mj_step(model, data)
        path[i] = data.qpos[:3]
    solved = solve_ivp(
        lambda t, at: wave.velocity(at, t),
        (0.0, times[-1]),
        (0.0, 0.0, -0.7),
        t_eval=times,
        rtol=1e-9,
        atol=1e-12,
    )
    radius, middle = 0.5 * np.ptp(path[:, 2]), 0.5 * (path[:, 2].max() + path[:, 2].min())
    assert np.abs(path - solved.y.T).max() < 1e-6 * radius
    assert radius == pytest.approx(amplitude * math.exp(k * middle), rel=1e-3)


@pytest.mark.filterwarnings("ignore:body .* has buoyancy but no free joint")
@pytest.mark.parametrize(
    ("share", "heave", "ratio"), [(0.4, 1e-3, 1.012), (1.0, 1e-3, 3.480), (2.0, 1e-4, 0.0688)]
)
def test_a_floating_box_heaves_as_its_equation_says(share: float, heave: float, ratio: float):
    """(m + s m_A) z'' + s b (z' - w) + rho g A (z - eta) = (m + s m_A) w', linear, s wet; waves radiate nothing.

    At a share of the frequency of resonance; w is the water's at the middle of the box, which is
    below the surface.
    """
    side, half, density, drag, added = 0.1, 0.4, 875.0, 3.0, 0.5
    wet = density / 1000.0
    mass, stiffness = density * side**2 * 2.0 * half, 1000.0 * GRAVITY * side**2
    omega = share * math.sqrt(stiffness / (mass + wet * added))
    k = omega**2 / GRAVITY
    middle = half - 2.0 * half * wet  # of the box at rest
    decay, inertia = math.exp(k * middle), mass + wet * added
    height = (stiffness + decay * (1j * omega * wet * drag - omega**2 * inertia)) / (
        stiffness + 1j * omega * wet * drag - omega**2 * inertia
    )
    amplitude = heave / abs(height)
    box = f"""<body name="b" pos="0 0 {middle}"><joint type="slide" axis="0 0 1"/>
    <geom type="box" size="{0.5 * side} {0.5 * side} {half}" density="{density}"/></body>"""
    model = model_of(box)
    element = Element(
        body="b",
        drag=(0.0, 0.0, drag),
        added_mass=(0.0, 0.0, added),
        volume=side**2 * 2.0 * half,
        shape="box",
        half_size=(0.5 * side, 0.5 * side, half),
        law=PolynomialDrag(reference_speed=1.0, quadratic=False),
    )
    wave = Airy(amplitude=amplitude, k=k, omega=omega, depth=20.0 / k)
    water.attach(model, [element], surface=0.0, current=wave)
    data = mujoco.MjData(model)
    steps = round(4.0 * 2.0 * math.pi / omega / 0.005)
    there = (
        amplitude * height * np.exp(1j * omega * 0.005 * np.arange(steps + 1))
    )  # eta = a e^(i omega t) at x = 0
    data.qpos[0], data.qvel[0] = there[0].real, (1j * omega * there[0]).real
    found = [data.qpos[0]]
    for _ in range(steps):
        mujoco.mj_step(model, data)
        found.append(data.qpos[0])
    assert np.abs(found - there.real).max() < 0.02 * abs(there[0])
    assert abs(height) == pytest.approx(ratio, rel=1e-3)


@value_class
class Turning(Flow):
    """Water that turns as one about the origin."""

    w_x: float = quantity("rad/s", "angular velocity", default=0.0)
    w_y: float = quantity("rad/s", "angular velocity", default=0.0)
    w_z: float = quantity("rad/s", "angular velocity", default=0.0)

    def __call__(self, x, y, z, t):
        p, q, r = self.w_x, self.w_y, self.w_z
        o = 0.0 * x
        velocity = (q * z - r * y, r * x - p * z, p * y - q * x)
        return (*velocity, o, o, o, o, -r + o, q + o, r + o, o, -p + o, -q + o, p + o, o, o)


@settings(max_examples=20, deadline=None)
@given(
    st.tuples(*[st.floats(-2.0, 2.0)] * 3),
    st.integers(0, 1000),
    st.sampled_from(["relative", "kirchhoff"]),
)
def test_a_body_at_rest_in_turning_water_feels_the_torque_of_one_that_turns_in_still_water(
    spin, seed: int, form: str
):
    """All that acts about the center; of `relative`, which keeps no momentum, the drag."""
    torques: list[np.ndarray] = []
    elements = oracle.elements(1)
    if form == "relative":
        elements = [replace(e, added_mass=(0.0,) * 3, added_inertia=(0.0,) * 3) for e in elements]
    for turning in (True, False):
        model = model_of('<body name="b0"><joint type="ball"/><geom size=".1"/></body>', 0.0)
        current = Turning(w_x=spin[0], w_y=spin[1], w_z=spin[2]) if turning else (0.0, 0.0, 0.0)
        water.attach(model, elements, current=current, form=form, usual_speed=1e-3)
        data = mujoco.MjData(model)
        orientation = np.random.default_rng(seed).normal(size=4)
        data.qpos[:] = orientation / np.linalg.norm(orientation)
        axes = np.zeros(9)
        mujoco.mju_quat2Mat(axes, data.qpos)
        data.qvel[:] = 0.0 if turning else -axes.reshape(3, 3).T @ spin
        mujoco.mj_forward(model, data)
        torques.append(data.qfrc_fluid.copy())
    np.testing.assert_allclose(*torques, atol=1e-11)
