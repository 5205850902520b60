"""Water on any MuJoCo model: added mass to rounding, energy, Archimedes, terminal speed, threads, bad input."""

import copy
import gc
import math
import pickle
import warnings
from dataclasses import replace
from pathlib import Path

import mujoco
import mujoco.batch
import mujoco.rollout
import numpy as np
import pytest
import water_oracle as oracle
from hypothesis import given, settings, strategies as st
from scipy.integrate import solve_ivp

from laticauda.water import mujoco as water
from laticauda.water.fluid.laws import PolynomialDrag
from laticauda.water.mujoco import (
    Element,
    GeomCoefficients,
    hydrostatics,
    native,
    registry,
)
from laticauda.water.mujoco.floating import metacentric_height
from laticauda.water.mujoco.lamb import lamb

RK4_ORDER = (
    4 if mujoco.mj_version() >= 4_000_000 else 2
)  # before, free and ball joints turned to second order
STILL = "ignore:body .* turns over"


def pair(option: str = "", joint: str = "", n: int = 5):
    """Two models of the same snake: one to be wetted, one that stays dry."""
    text = oracle.snake(n, option=option, joint=joint)
    return (water.compile_spec(mujoco.MjSpec.from_string(text)) for _ in range(2))


def body(
    shape: str,
    size: str,
    *,
    option: str = 'gravity="0 0 0"',
    density: float = 1000.0,
    extra: str = "",
) -> str:
    return (
        f'<mujoco><option timestep="0.002" {option}/><worldbody>{extra}<body name="b"><freejoint/>'
        f'<geom name="g" type="{shape}" size="{size}" density="{density}"/></body></worldbody></mujoco>'
    )


# ---- added mass ----------------------------------------------------------------------------------


def test_an_ellipsoid_accelerates_with_its_added_mass():
    model = water.compile_spec(mujoco.MjSpec.from_string(body("ellipsoid", ".5 .1 .1")))
    data = mujoco.MjData(model)
    element = water.geom_element(model, "g", GeomCoefficients(drag=(0, 0, 0)))
    water.attach(model, [element])
    data.xfrc_applied[1] = force = np.array([1.0, 2.0, 3.0, 0.1, 0.2, 0.3])
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(
        data.qacc[:3], force[:3] / (model.body_mass[1] + element.added_mass), rtol=1e-12
    )
    np.testing.assert_allclose(
        data.qacc[3:], force[3:] / (model.body_inertia[1] + element.added_inertia), rtol=1e-12
    )
    assert (
        0.5 < data.qacc[1] * model.body_mass[1] / force[1] < 0.55
    )  # "about half", neutrally buoyant and broadside


def test_lamb_s_factors_are_those_of_the_tables():
    share, inertia = lamb((1.0, 1.0, 1.0))
    np.testing.assert_allclose(share, 0.5, rtol=1e-9)
    np.testing.assert_array_equal(inertia, 0.0)
    share, inertia = lamb(
        (5.0, 1.0, 1.0)
    )  # Lamb's table: 0.059, 0.895, k' = 0.701 (of the inertia (25 + 1) / 5)
    np.testing.assert_allclose(share, [0.059, 0.895, 0.895], atol=1e-3)
    np.testing.assert_allclose(inertia / 5.2, [0.0, 0.70, 0.70], atol=2e-3)


@pytest.mark.parametrize("form", ["relative", "kirchhoff", "classic"])
def test_a_chain_accelerates_as_the_oracle_outside_of_the_callback_says(form: str):
    wet, dry = pair(joint='damping=".1" stiffness="2" armature="0.01"')
    elements, current = oracle.elements(), (0.3, -0.2, 0.1)
    water.attach(wet, elements, form=form, current=current, usual_speed=0.01)
    d, e = mujoco.MjData(wet), mujoco.MjData(dry)
    for seed in range(5):
        oracle.random_state(wet, d, seed)
        oracle.random_state(dry, e, seed)
        mujoco.mj_forward(wet, d)
        expected = oracle.acceleration(dry, e, elements, form, current)
        np.testing.assert_allclose(
            d.qacc, expected, rtol=1e-9, atol=1e-9 * np.max(np.abs(expected))
        )


def test_way_b_as_an_applied_force_gives_the_same():
    wet, dry = pair(n=2)
    elements = oracle.elements(2)
    water.attach(wet, elements, usual_speed=0.01)
    d, e = mujoco.MjData(wet), mujoco.MjData(dry)
    oracle.random_state(wet, d)
    oracle.random_state(dry, e)
    mujoco.mj_forward(wet, d)
    e.qfrc_applied[:] = oracle.qfrc(dry, e, elements)
    mujoco.mj_forward(dry, e)
    np.testing.assert_allclose(d.qacc, e.qacc, rtol=1e-9)


@pytest.mark.parametrize("integrator", ["Euler", "RK4", "implicit", "implicitfast"])
def test_every_integrator_steps_with_m_plus_a(integrator: str):
    wet, dry = pair(f'integrator="{integrator}"', 'damping=".1" stiffness="2"')
    elements = oracle.elements()
    water.attach(wet, elements, usual_speed=0.01)
    d, e = mujoco.MjData(wet), mujoco.MjData(dry)
    errors = []
    for step in (1e-5, 5e-6):
        wet.opt.timestep = step
        oracle.random_state(wet, d)
        oracle.random_state(dry, e)
        before = d.qvel.copy()
        mujoco.mj_step(wet, d)
        expected = oracle.acceleration(dry, e, elements)
        errors.append(
            np.max(np.abs((d.qvel - before) / step - expected)) / np.max(np.abs(expected))
        )
    assert errors[0] < 0.01
    assert errors[1] == pytest.approx(
        0.5 * errors[0], rel=0.1
    )  # of first order in the step: exact at its start


@pytest.mark.parametrize("integrator", ["Euler", "implicitfast"])
def test_joint_damping_is_implicit_in_m_plus_a(integrator: str):
    step, damping = 0.01, 50.0
    wet, dry = pair(f'integrator="{integrator}"', f'damping="{damping}"')
    wet.opt.timestep = step
    elements = oracle.elements()
    water.attach(wet, elements, usual_speed=0.001)
    d, e = mujoco.MjData(wet), mujoco.MjData(dry)
    oracle.random_state(wet, d)
    oracle.random_state(dry, e)
    before = d.qvel.copy()
    mujoco.mj_step(wet, d)
    mujoco.mj_forward(dry, e)
    M = np.zeros((wet.nv, wet.nv))
    mujoco.mj_fullM(dry, e, M)
    A, fluid = oracle.inertia_and_force(dry, e, elements)
    expected = np.linalg.solve(M + A + step * np.diag(wet.dof_damping), e.qfrc_smooth + fluid)
    np.testing.assert_allclose((d.qvel - before) / step, expected, rtol=1e-8)


def test_evaluating_twice_adds_the_water_once():
    (wet, _) = pair()
    water.attach(wet, oracle.elements(), usual_speed=0.01)
    data = mujoco.MjData(wet)
    oracle.random_state(wet, data)
    mujoco.mj_forward(wet, data)
    once = data.qacc.copy()
    mujoco.mj_forwardSkip(wet, data, mujoco.mjtStage.mjSTAGE_POS, 0)
    np.testing.assert_array_equal(data.qacc, once)


@pytest.mark.parametrize("form", ["relative", "kirchhoff"])
def test_without_drag_energy_is_kept_to_the_integrator_s_order(form: str):
    def drift(step: float) -> float:
        (wet, _) = pair('integrator="RK4"')
        wet.opt.timestep = step
        water.attach(wet, oracle.elements(drag=0.0), form=form)
        data = mujoco.MjData(wet)
        oracle.random_state(wet, data)
        energies = []
        for _ in range(round(0.5 / step)):
            mujoco.mj_forward(wet, data)
            M = np.zeros((wet.nv, wet.nv))
            mujoco.mj_fullM(wet, data, M)
            energies.append(0.5 * data.qvel @ M @ data.qvel)
            mujoco.mj_step(wet, data)
        return abs(energies[-1] / energies[0] - 1.0)

    if form == "relative":  # per axis f = -m e d(e.u)/dt, so f.u dt is a differential too
        assert drift(2.5e-4) < 1e-6
    coarse, fine = drift(2e-3), drift(1e-3)
    assert fine < 1e-5
    assert fine < coarse / 2.0 ** (RK4_ORDER - 0.5)


def test_a_spheroid_off_its_course_turns_broadside_as_fast_as_theory_says():
    """Munk: sway and yaw of a slender body grow with one rate; the growing motion alone is set going."""
    text = body("ellipsoid", ".5 .1 .1", option='gravity="0 0 0" integrator="RK4"')
    model = water.compile_spec(mujoco.MjSpec.from_string(text))
    element = water.geom_element(model, "g", GeomCoefficients(drag=(0, 0, 0)))
    water.attach(model, [element])  # by default
    along, across, _ = model.body_mass[1] + np.array(element.added_mass)
    inertia = model.body_inertia[1, 2] + element.added_inertia[2]
    rate = np.sqrt((across - along) / inertia * along / across)
    data = mujoco.MjData(model)
    data.qvel[0], data.qvel[1], data.qvel[5] = 1.0, -1e-6, 1e-6 * rate * across / along
    seconds = 2.0
    for _ in range(round(seconds / model.opt.timestep)):
        mujoco.mj_step(model, data)
    assert data.qvel[5] == pytest.approx(
        1e-6 * rate * across / along * np.exp(rate * seconds), rel=0.01
    )


@pytest.mark.parametrize(
    ("shape", "size"),
    [
        ("ellipsoid", ".3 .1 .05"),
        ("ellipsoid", ".1 .1 .4"),
        ("box", ".3 .2 .01"),
        ("cylinder", ".05 .3"),
    ],
)
def test_a_body_tumbles_by_default_as_kirchhoff_s_equations_say(shape: str, size: str):
    """Momenta P and L in body axes, solved apart: P' = P x w, L' = L x w + P x u; in a current too."""
    current = np.array((0.3, -0.2, 0.1))
    text = body(shape, size, option='gravity="0 0 0" integrator="RK4" timestep="0.001"').replace(
        'timestep="0.002" ', ""
    )
    model = water.compile_spec(mujoco.MjSpec.from_string(text))
    element = water.geom_element(model, "g", GeomCoefficients(drag=(0, 0, 0)))
    water.attach(model, [element], current=current)
    data = mujoco.MjData(model)
    data.qvel[:] = np.array((0.5, 0.3, -0.2, 0.8, -1.2, 0.6)) + np.concatenate(
        [current, np.zeros(3)]
    )
    mujoco.mj_forward(model, data)
    axes = np.zeros(9)
    mujoco.mju_quat2Mat(axes, np.array(element.orientation))
    A = axes.reshape(3, 3)  # a cylinder's element lies across its geom
    mass = np.diag(np.full(3, model.body_mass[1])) + A @ np.diag(element.added_mass) @ A.T
    own = data.ximat[1].reshape(3, 3)  # at the start, body and world axes are one
    inertia = (
        own @ np.diag(model.body_inertia[1]) @ own.T + A @ np.diag(element.added_inertia) @ A.T
    )

    def rates(_, state):
        q, P, L = state[3:7], state[7:10], state[10:]
        u, w = np.linalg.solve(mass, P), np.linalg.solve(inertia, L)
        turned, moved = np.zeros(4), np.zeros(3)
        mujoco.mju_mulQuat(turned, q, np.array((0.0, *w)))
        mujoco.mju_rotVecQuat(moved, u, q)
        return np.concatenate(
            [moved + current, 0.5 * turned, np.cross(P, w), np.cross(L, w) + np.cross(P, u)]
        )

    start = np.concatenate([data.qpos, mass @ (data.qvel[:3] - current), inertia @ data.qvel[3:]])
    found = solve_ivp(rates, (0, 3), start, "DOP853", rtol=1e-12, atol=1e-13).y[:7, -1]
    mujoco.mj_step(model, data, nstep=3000)
    np.testing.assert_allclose(data.qpos, found, atol=1e-8 if RK4_ORDER == 4 else 1e-5)


def test_kirchhoff_keeps_momentum():
    model = water.compile_spec(
        mujoco.MjSpec.from_string(
            body("ellipsoid", ".5 .1 .2", option='gravity="0 0 0" integrator="RK4"')
        )
    )
    data = mujoco.MjData(model)
    element = water.geom_element(model, "g", GeomCoefficients(drag=(0, 0, 0)))
    water.attach(model, [element])
    data.qvel[:] = 0.3, -0.2, 0.4, 1.0, -2.0, 0.5
    total = model.body_mass[1] + np.array(element.added_mass)

    def momentum():
        mujoco.mj_forward(model, data)
        R = data.xmat[1].reshape(3, 3)
        return R @ (total * (R.T @ data.qvel[:3]))

    before = momentum()
    for _ in range(500):
        mujoco.mj_step(model, data)
    np.testing.assert_allclose(
        momentum(), before, atol=(1e-7 if RK4_ORDER == 4 else 1e-4) * np.linalg.norm(before)
    )


# ---- contacts ------------------------------------------------------------------------------------


@pytest.mark.parametrize("solver", ["Newton", "CG"])
@pytest.mark.parametrize("integrator", ["Euler", "RK4", "implicit", "implicitfast"])
@pytest.mark.filterwarnings(STILL)
def test_a_heavy_chain_rests_on_the_floor_with_its_weight_in_water(solver: str, integrator: str):
    text = f"""<mujoco><option timestep="0.002" integrator="{integrator}" solver="{solver}" tolerance="1e-12"
    iterations="300"/><worldbody><geom type="plane" size="5 5 .1"/>
    <body name="b0" pos="0 0 .2"><freejoint/><geom name="g0" type="box" size=".2 .05 .04" density="1500"/>
    <body name="b1" pos=".45 0 0"><joint axis="0 1 0" range="-20 20" pos="-.22 0 0" damping=".5"/>
    <geom name="g1" type="box" size=".2 .05 .04" density="1500"/></body></body></worldbody></mujoco>"""
    model = water.compile_spec(mujoco.MjSpec.from_string(text))
    data = mujoco.MjData(model)
    coefficients = GeomCoefficients(drag=(1.0, 1.0, 1.0), rotational_drag=1.0)
    elements = [water.geom_element(model, f"g{i}", coefficients) for i in range(2)]
    water.attach(model, elements)
    for _ in range(1500):
        mujoco.mj_step(model, data)
        M = np.zeros((model.nv, model.nv))
    mujoco.mj_forward(model, data)
    mujoco.mj_fullM(model, data, M)
    forces = data.qfrc_smooth + data.qfrc_constraint
    np.testing.assert_allclose(M @ data.qacc, forces, atol=1e-4 * np.max(np.abs(data.qfrc_smooth)))
    np.testing.assert_allclose(data.xpos[1:, 2], 0.04, atol=1e-3)
    weight = 9.81 * sum(model.body_mass[i + 1] - 1000.0 * e.volume for i, e in enumerate(elements))
    total = 0.0
    for i in range(data.ncon):
        force = np.zeros(6)
        mujoco.mj_contactForce(model, data, i, force)
        total += force[0]
    assert total == pytest.approx(weight, rel=0.01)


@pytest.mark.parametrize("integrator", ["Euler", "RK4", "implicitfast"])
def test_a_joint_at_its_limit_carries_the_weight_in_water(integrator: str):
    text = f"""<mujoco><option timestep="0.002" integrator="{integrator}"/><worldbody><body name="b0">
    <joint axis="0 1 0" range="-90 30" damping="0.1"/>
    <geom name="g0" type="ellipsoid" size=".2 .05 .04" pos=".2 0 0" density="1500"/></body></worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    element = water.geom_element(model, "g0", GeomCoefficients(rotational_drag=1.0))
    with pytest.warns(UserWarning, match="no free joint"):
        water.attach(model, [element])
    for _ in range(3000):
        mujoco.mj_step(model, data)
    assert data.qpos[0] == pytest.approx(np.deg2rad(30), abs=0.01)
    moment = (model.body_mass[1] - 1000.0 * element.volume) * 9.81 * 0.2 * np.cos(data.qpos[0])
    assert data.qfrc_constraint[0] == pytest.approx(-moment, rel=0.01)


def test_a_closed_loop_moves_with_m_plus_a():
    text = oracle.snake(4, option='solver="Newton" tolerance="1e-14"')
    text = text.replace(
        "</mujoco>",
        '<equality><connect body1="b0" body2="b3" anchor="-.1 .1 0"/></equality></mujoco>',
    )
    wet, dry = (water.compile_spec(mujoco.MjSpec.from_string(text)) for _ in range(2))
    elements = oracle.elements(4)
    water.attach(wet, elements, usual_speed=0.01)
    d, e = mujoco.MjData(wet), mujoco.MjData(dry)
    d.qvel[:] = e.qvel[:] = np.random.default_rng(0).normal(size=wet.nv)
    mujoco.mj_forward(wet, d)
    mujoco.mj_forward(dry, e)
    M = np.zeros((wet.nv, wet.nv))
    mujoco.mj_fullM(dry, e, M)
    A, fluid = oracle.inertia_and_force(dry, e, elements)
    assert np.max(np.abs(d.qfrc_constraint)) > 1.0
    np.testing.assert_allclose(
        (M + A) @ d.qacc, e.qfrc_smooth + fluid + d.qfrc_constraint, atol=1e-6
    )


# ---- buoyancy and drag ---------------------------------------------------------------------------


@pytest.mark.filterwarnings(STILL)
@pytest.mark.parametrize(
    ("shape", "size", "depth"),
    [
        ("box", ".2 .1 .05", lambda share: 0.1 * share - 0.05),  # draft = share of the height
        ("sphere", ".1", None),
        ("cylinder", ".1 .3", None),
    ],
)
@pytest.mark.parametrize("share", [0.3, 0.8])
def test_a_floating_body_settles_where_archimedes_says(shape: str, size: str, depth, share: float):
    option = 'gravity="0 0 -9.81" integrator="RK4"'
    text = body(shape, size, option=option, density=1000.0 * share)
    if shape == "cylinder":
        text = text.replace('name="g"', 'name="g" euler="0 90 0"')  # lying
    model = water.compile_spec(mujoco.MjSpec.from_string(text))
    data = mujoco.MjData(model)
    element = water.geom_element(
        model,
        "g",
        GeomCoefficients(
            drag=(2, 2, 2), rotational_drag=1.0, law=PolynomialDrag(reference_speed=0.5)
        ),
    )
    water.attach(model, [element], surface=0.0)
    for _ in range(6000):
        mujoco.mj_step(model, data)
    if depth is None:
        s = np.linspace(-1.0, 1.0, 200001)
        if shape == "sphere":
            covered = (1 + s) ** 2 * (2 - s) / 4
        else:
            covered = 1 - (np.arccos(s) - s * np.sqrt(1 - s**2)) / np.pi
        expected = -0.1 * np.interp(share, covered, s)
    else:
        expected = -depth(share)
    assert data.qpos[2] == pytest.approx(expected, abs=1e-3)


@pytest.mark.filterwarnings(STILL)
@pytest.mark.parametrize("axis", [0, 1])
def test_a_raft_floats_flat_again_after_a_heel(axis: int):
    text = body("box", ".3 .2 .03", option='gravity="0 0 -9.81"', density=500.0)
    model = water.compile_spec(mujoco.MjSpec.from_string(text))
    data = mujoco.MjData(model)
    element = water.geom_element(
        model,
        "g",
        GeomCoefficients(
            drag=(1, 1, 1), rotational_drag=1.0, law=PolynomialDrag(reference_speed=0.5)
        ),
    )
    water.attach(model, [element], surface=0.0)
    data.qpos[3], data.qpos[4 + axis] = np.cos(0.15), np.sin(0.15)
    for _ in range(4000):
        mujoco.mj_step(model, data)
    assert data.xmat[1, 8] > np.cos(np.deg2rad(0.5))
    assert data.qpos[2] == pytest.approx(0.0, abs=1e-3)


@pytest.mark.filterwarnings(STILL)
def test_a_sinking_body_reaches_its_terminal_speed():
    text = body("sphere", ".1", option='gravity="0 0 -9.81"', density=2000.0)
    model = water.compile_spec(mujoco.MjSpec.from_string(text))
    data = mujoco.MjData(model)
    element = water.geom_element(model, "g", GeomCoefficients(drag=(0.5, 0.5, 0.5), added_mass=1.0))
    water.attach(model, [element], usual_speed=3.0)
    for _ in range(3000):
        mujoco.mj_step(model, data)
    weight = (model.body_mass[1] - 1000.0 * element.volume) * 9.81
    assert -data.qvel[2] == pytest.approx(
        np.sqrt(2 * weight / (1000.0 * 0.5 * np.pi * 0.1**2)), rel=1e-3
    )


@pytest.mark.filterwarnings("ignore:`timestep`", STILL)
def test_implicit_drag_is_stable_at_any_step_and_right_at_small_ones():
    def fall(step: float, implicit: bool) -> float:
        text = body("sphere", ".1", option='gravity="0 0 -9.81"', density=1100.0)
        model = water.compile_spec(mujoco.MjSpec.from_string(text))
        model.opt.timestep = step
        data = mujoco.MjData(model)
        element = Element(
            body="b",
            drag=(300.0,) * 3,
            volume=4 / 3 * np.pi * 1e-3,
            law=PolynomialDrag(reference_speed=1.0),
        )
        water.attach(model, [element], implicit_drag=implicit)
        for _ in range(round(1.0 / step)):
            mujoco.mj_step(model, data)
        return float(data.qvel[2])

    exact = fall(1e-4, False)
    assert fall(0.1, True) == pytest.approx(exact, rel=1e-3)
    assert fall(1e-4, True) == pytest.approx(exact, rel=1e-6)


def test_a_body_drifts_with_a_current_that_depends_on_place_and_time():
    def swirl(x, y, z, t):
        return 0.1 - y, x, 0.02 * t

    model = water.compile_spec(mujoco.MjSpec.from_string(body("sphere", ".1")))
    data = mujoco.MjData(model)
    data.qpos[:3] = 0.5, 0.2, 0.1
    element = Element(
        body="b", drag=(500.0,) * 3, law=PolynomialDrag(reference_speed=1.0), volume=0.0
    )
    water.attach(model, [element], current=swirl, implicit_drag=True)
    for _ in range(500):
        mujoco.mj_step(model, data)
    x, y, z = data.qpos[:3]
    np.testing.assert_allclose(data.qvel[:3], [0.1 - y, x, 0.02], rtol=0.05)
    assert z == pytest.approx(0.11, abs=1e-3)


def test_water_at_rest_and_water_that_moves_differ_by_the_current_only():
    velocities = []
    for V in (np.zeros(3), np.array([0.3, -0.1, 0.2])):
        (wet, _) = pair(n=3)
        water.attach(wet, oracle.elements(3), form="kirchhoff", current=V, usual_speed=0.01)
        data = mujoco.MjData(wet)
        oracle.random_state(wet, data)
        data.qvel[:3] += V
        for _ in range(300):
            mujoco.mj_step(wet, data)
        velocities.append(data.qvel - np.concatenate([V, np.zeros(wet.nv - 3)]))
    np.testing.assert_allclose(velocities[0], velocities[1], atol=1e-9)


def test_water_that_is_told_to_move_is_water_that_was_attached_moving():
    V, speeds = np.array([0.3, -0.1, 0.2]), []
    for first, told in ((V, None), (np.zeros(3), V)):
        (wet, _) = pair(n=3)
        handle = water.attach(wet, oracle.elements(3), current=first, usual_speed=0.01)
        if told is not None:
            handle.set_current(told)
        data = mujoco.MjData(wet)
        oracle.random_state(wet, data)
        mujoco.mj_step(wet, data)
        speeds.append(data.qvel.copy())
    np.testing.assert_array_equal(speeds[0], speeds[1])


def test_drag_only_takes_energy():
    (wet, _) = pair('integrator="RK4"')
    handle = water.attach(wet, oracle.elements(), usual_speed=0.01)
    data = mujoco.MjData(wet)
    for seed in range(20):
        oracle.random_state(wet, data, seed, speed=2.0)
        force = handle.forces(data)["drag"]
        velocity = [
            data.cvel[i + 1, 3:] + np.cross(data.cvel[i + 1, :3], at - data.subtree_com[1])
            for i, at in enumerate(
                data.xpos[i + 1] + data.xmat[i + 1].reshape(3, 3) @ e.position
                for i, e in enumerate(handle.elements)
            )
        ]
        assert np.all(np.sum(force * np.array(velocity), axis=1) <= 0.0)


# ---- water that accelerates ----------------------------------------------------------------------


def waves(x, y, z, t):
    """Water waves 1.3 m deep in the mean, as a velocity; waves of k = 2/m that run along x and y."""
    phase, decay = 2.0 * (0.6 * x + 0.8 * y) - 4.4 * t, math.exp(2.0 * (z - 1.3))
    along = 0.5 * decay * math.cos(phase)
    return 0.6 * along - y * z, 0.8 * along + 0.3 * x, 0.5 * decay * math.sin(phase)


def waves_complete(x, y, z, t):
    """The same as a `Motion`, derivatives by hand."""
    phase, decay = 2.0 * (0.6 * x + 0.8 * y) - 4.4 * t, math.exp(2.0 * (z - 1.3))
    c, s = 0.5 * decay * math.cos(phase), 0.5 * decay * math.sin(phase)
    along_x = (-0.72 * s, -0.96 * s - z, 1.2 * c - y)
    along_y = (-0.96 * s + 0.3, -1.28 * s, 1.6 * c)
    velocity, rate = (
        (0.6 * c - y * z, 0.8 * c + 0.3 * x, s),
        (0.6 * 4.4 * s, 0.8 * 4.4 * s, -4.4 * c),
    )
    return velocity + rate + along_x + along_y + (1.2 * c, 1.6 * c, 2.0 * s, 0.0)


def waves_by_hand(x, y, z, t):
    """Their velocity, material acceleration and rotation."""
    numbers = np.array(waves_complete(x, y, z, t))
    velocity, rate, gradient = numbers[:3], numbers[3:6], numbers[6:15].reshape(3, 3)
    turning = gradient - gradient.T
    return *velocity, *(rate + gradient @ velocity), *(0.5 * turning[[2, 0, 1], [1, 2, 0]])


@pytest.mark.parametrize(("field", "error"), [(waves_complete, 1e-9), (waves, 1e-7)])
def test_a_chain_in_waves_accelerates_as_the_oracle_says_with_derivatives_given_or_found(
    field, error: float
):
    wet, dry = pair()
    elements = [replace(e, volume=1e-3) for e in oracle.elements()]
    water.attach(wet, elements, current=field, usual_speed=0.01)
    d, e = mujoco.MjData(wet), mujoco.MjData(dry)
    for seed in range(5):
        oracle.random_state(wet, d, seed)
        oracle.random_state(dry, e, seed)
        d.time = e.time = 0.1 * seed
        mujoco.mj_forward(wet, d)
        expected = oracle.acceleration(dry, e, elements, "kirchhoff", waves_by_hand)
        np.testing.assert_allclose(d.qacc, expected, atol=error * np.max(np.abs(expected)))


@pytest.mark.parametrize("density", [300.0, 1000.0, 4000.0])
def test_a_sphere_in_water_that_goes_to_and_fro_moves_as_theory_says(density: float):
    """(m + m_A) dv/dt = (rho V + m_A) dV/dt; a neutral one moves with the water."""
    text = body("sphere", ".1", option='gravity="0 0 0" integrator="RK4"', density=density)
    model = water.compile_spec(mujoco.MjSpec.from_string(text))
    element = water.geom_element(model, "g", GeomCoefficients(drag=(0, 0, 0)))
    water.attach(model, [element], current=to_and_fro)
    data = mujoco.MjData(model)
    share = (1000.0 * element.volume + element.added_mass[0]) / (
        model.body_mass[1] + element.added_mass[0]
    )
    for _ in range(10):
        mujoco.mj_step(model, data, nstep=100)
        assert data.qvel[0] == pytest.approx(share * 0.2 * np.sin(3.0 * data.time), abs=1e-6)


def to_and_fro(x, y, z, t):
    return 0.2 * math.sin(3.0 * t), 0.0, 0.0


def gust(x, y, z, t):
    return 0.5 * t, -0.3 * t, 0.8 * t


@pytest.mark.filterwarnings(STILL)
def test_water_that_accelerates_as_one_is_still_water_under_another_gravity():
    motions = []
    for current, gravity in ((gust, (0.0, 0.0, -9.81)), ((0.0, 0.0, 0.0), (-0.5, 0.3, -10.61))):
        text = oracle.snake(3, option='integrator="RK4"').replace("1000", "900")
        model = water.compile_spec(mujoco.MjSpec.from_string(text))
        model.opt.gravity = gravity
        drags = GeomCoefficients(drag=(0.2, 1.0, 1.0), rotational_drag=1.0)
        water.attach(
            model,
            [water.geom_element(model, g, drags) for g in range(3)],
            current=current,
            usual_speed=0.01,
        )
        data = mujoco.MjData(model)
        oracle.random_state(model, data)
        mujoco.mj_step(model, data, nstep=500)
        moved = np.array(gust(0, 0, 0, data.time) if current is gust else current)
        motions.append(np.concatenate([data.qvel[:3] - moved, data.qvel[3:], data.qpos[3:]]))
    np.testing.assert_allclose(*motions, atol=1e-8)


def whirl(x, y, z, t):
    return -0.7 * y, 0.7 * x, 0.0


@pytest.mark.parametrize("size", [".1 .1 .1", ".05 .02 .03"])
def test_a_neutral_body_goes_round_with_turning_water(size: str):
    text = body("ellipsoid", size, option='gravity="0 0 0" integrator="RK4"')
    model = water.compile_spec(mujoco.MjSpec.from_string(text))
    element = water.geom_element(model, "g", GeomCoefficients(rotational_drag=1.0))
    water.attach(model, [element], current=whirl)
    data = mujoco.MjData(model)
    data.qpos[0], data.qvel[1], data.qvel[5] = 1.0, 0.7, 0.7
    mujoco.mj_step(model, data, nstep=1000)
    angle = 0.7 * data.time
    np.testing.assert_allclose(data.qpos[:3], [np.cos(angle), np.sin(angle), 0.0], atol=1e-9)
    np.testing.assert_allclose(
        data.qpos[3:], [np.cos(angle / 2), 0.0, 0.0, np.sin(angle / 2)], atol=1e-9
    )


# ---- through the surface -------------------------------------------------------------------------


def energy(model, data, elements) -> float:
    """Of bodies and water: all that moves, weight, and what is displaced."""
    M, total = np.zeros((model.nv, model.nv)), 0.0
    mujoco.mj_forward(model, data)
    mujoco.mj_fullM(model, data, M)
    for e in elements:
        b = model.body(e.body).id
        R, at = data.xmat[b].reshape(3, 3), data.xpos[b] + data.xmat[b].reshape(3, 3) @ e.position
        up = (R @ e.rotation)[2]
        share, *center = hydrostatics.wetted(
            getattr(hydrostatics, e.shape.upper()), e.half_size, up, -at[2]
        )
        total -= 1000.0 * 9.81 * e.volume * share * (at[2] + up @ center)
    return total + 0.5 * data.qvel @ M @ data.qvel + 9.81 * model.body_mass @ data.xipos[:, 2]


def dropped(text: str, seconds: float, start) -> tuple[np.ndarray, np.ndarray, tuple[Element, ...]]:
    """Heights of the root, and energies over what there was above the surface to begin with; every 10 ms."""
    model = water.compile_spec(mujoco.MjSpec.from_string(text))
    data = mujoco.MjData(model)
    elements = tuple(
        water.geom_element(model, g, GeomCoefficients(drag=(0, 0, 0))) for g in range(model.ngeom)
    )
    water.attach(model, elements, surface=0.0)
    start(data)
    height, energies = [], []
    for _ in range(round(seconds / 0.01)):
        height.append(data.qpos[2])
        energies.append(energy(model, data, elements))
        mujoco.mj_step(model, data, nstep=round(0.01 / model.opt.timestep))
    scale = 9.81 * model.body_mass.sum() * height[0]
    return np.array(height), np.array(energies) / scale, elements


@pytest.mark.filterwarnings(STILL)
@pytest.mark.parametrize("integrator", ["RK4", "implicitfast"])
def test_a_light_ball_that_is_dropped_plunges_and_comes_back_as_its_equation_says(integrator: str):
    text = body("sphere", ".1", option=f'integrator="{integrator}"', density=500.0)
    height, energies, (ball,) = dropped(text, 3.0, lambda data: data.qpos.__setitem__(2, 0.3))
    mass, added = 500.0 * ball.volume, ball.added_mass[2]

    def fall(_, state):
        z, v = state
        s = np.clip(-z / 0.1, -1.0, 1.0)
        share, rate = (1 + s) ** 2 * (2 - s) / 4, 0.75 * (1 - s * s) * -v / 0.1
        force = 9.81 * (1000.0 * ball.volume * share - mass) - max(0.0, rate) * added * v
        return v, force / (mass + share * added)

    t = np.arange(len(height)) * 0.01
    expected = solve_ivp(
        fall, (0, 3), (0.3, 0), "DOP853", t_eval=t, rtol=1e-10, atol=1e-12, max_step=0.01
    ).y[0]
    assert height.min() > -0.3
    assert height.min() == pytest.approx(
        expected.min(), rel=0.02 if integrator == "implicitfast" else 1e-4
    )
    assert np.max(energies) < energies[0] + 1e-3
    if integrator == "RK4":
        np.testing.assert_allclose(height, expected, atol=1e-4)


@pytest.mark.filterwarnings(STILL)
@pytest.mark.parametrize("shape", ["box", "cylinder", "ellipsoid", "chain"])
def test_nothing_that_tumbles_through_the_surface_gains_energy(shape: str):
    size = {"box": ".2 .1 .05", "cylinder": ".1 .2", "ellipsoid": ".3 .1 .05", "chain": ""}[shape]
    text = body(shape, size, option='integrator="RK4"', density=500.0)
    if shape == "chain":
        text = (
            oracle.snake(3, option='integrator="RK4"')
            .replace("0 0 0", "0 0 -9.81", 1)
            .replace("1000", "500")
        )

    def start(data):
        data.qpos[2:7] = 0.4, *np.array((0.8, 0.5, 0.3, 0.1)) / np.sqrt(0.99)
        data.qvel[:6] = 0.5, 0.2, 0.0, 0.3, 2.0, -1.0

    height, energies, _ = dropped(text, 2.5, start)
    assert np.min(height) < 0.0
    assert np.max(np.diff(energies)) < 1e-5
    assert energies[-1] < energies[0] - 0.2  # the splash keeps some


@pytest.mark.filterwarnings(STILL)
@pytest.mark.parametrize("tilt", [0.0, 0.02, 0.3])
@pytest.mark.parametrize("integrator", ["Euler", "implicitfast", "RK4"])
def test_a_light_plate_that_is_covered_within_one_step_gains_no_energy(
    integrator: str, tilt: float
):
    """It comes to move some twenty times its mass of water, and falls deeper in a step than it is thick."""
    option = f'integrator="{integrator}" timestep="0.005"'
    text = body("box", ".3 .2 .005", option=option, density=500.0).replace('timestep="0.002" ', "")

    def start(data):
        data.qpos[2:7] = 0.5, np.cos(tilt / 2), np.sin(tilt / 2), 0.0, 0.0
        data.qvel[0] = 0.3

    _, energies, _ = dropped(text, 1.5, start)
    assert np.max(energies) < energies[0] + 1e-3


# ---- several models, threads ---------------------------------------------------------------------


def test_models_of_one_process_are_kept_apart():
    wet, dry = pair()
    other, _ = pair(n=3)
    water.attach(wet, oracle.elements(), usual_speed=0.01)
    handle = water.attach(other, oracle.elements(3), usual_speed=0.01)
    accelerations = []
    for model in (wet, dry, other):
        data = mujoco.MjData(model)
        oracle.random_state(model, data)
        mujoco.mj_forward(model, data)
        accelerations.append(data.qacc.copy())
    assert np.max(np.abs(accelerations[0] - accelerations[1])) > 0.1
    data = mujoco.MjData(other)
    handle.detach()
    oracle.random_state(other, data)
    mujoco.mj_forward(other, data)
    assert np.max(np.abs(accelerations[2] - data.qacc)) > 0.1
    assert handle.active


def test_a_copy_of_a_model_has_its_water_and_outlives_it():
    (wet, _) = pair()
    water.attach(wet, oracle.elements(), usual_speed=0.01)
    twin = copy.deepcopy(wet)
    accelerations = []
    for model in (wet, twin):
        data = mujoco.MjData(model)
        oracle.random_state(model, data)
        mujoco.mj_forward(model, data)
        accelerations.append(data.qacc.copy())
    del wet, model, data
    gc.collect()
    data = mujoco.MjData(twin)
    oracle.random_state(twin, data)
    mujoco.mj_forward(twin, data)
    np.testing.assert_array_equal(accelerations[1], accelerations[0])
    np.testing.assert_array_equal(data.qacc, accelerations[0])


def test_batches_and_threaded_rollouts_equal_a_loop_bit_for_bit():
    (wet, _) = pair(joint='damping=".1"')
    water.attach(wet, oracle.elements(), form="kirchhoff", usual_speed=0.01)
    loop = []
    data = mujoco.MjData(wet)
    kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
    starts = np.empty((8, mujoco.mj_stateSize(wet, kind)))
    for seed in range(8):
        oracle.random_state(wet, data, seed)
        mujoco.mj_getState(wet, data, starts[seed], kind)
        for _ in range(50):
            mujoco.mj_step(wet, data)
        loop.append(data.qpos.copy())
    batch = mujoco.batch.Batch(wet, 8, nthread=2)
    qpos, qvel = batch.bind("qpos"), batch.bind("qvel")
    for seed in range(8):
        oracle.random_state(wet, data, seed)
        qpos[seed], qvel[seed] = data.qpos, data.qvel
    for _ in range(50):
        batch.step()
    np.testing.assert_array_equal(qpos, loop)
    states, _ = mujoco.rollout.rollout(
        wet, [mujoco.MjData(wet) for _ in range(2)], starts, nstep=50
    )
    np.testing.assert_array_equal(states[:, -1, 1 : 1 + wet.nq], loop)


def test_a_model_with_gravity_disabled_has_no_buoyancy():
    option = 'gravity="0 0 -9.81"/><option><flag gravity="disable"/></option><option'
    model = water.compile_spec(
        mujoco.MjSpec.from_string(body("ellipsoid", ".3 .1 .1", option=option, density=900.0))
    )
    water.attach(model)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    np.testing.assert_array_equal(data.qacc, 0.0)
    model.opt.disableflags = 0
    mujoco.mj_forward(model, data)
    assert data.qacc[2] > 0.1


def speeds_after_a_step(model) -> np.ndarray:
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data)
    return data.qvel.copy()


def test_a_copy_has_a_current_of_its_own():
    (wet, _) = pair(n=3)
    handle = water.attach(wet, oracle.elements(3), current=(0.3, 0.0, 0.0), usual_speed=0.01)
    twin = copy.deepcopy(wet)
    both = [speeds_after_a_step(model) for model in (wet, twin)]
    handle.set_current((0.0, -0.2, 0.0))
    water.attached(twin).set_current((0.0, 0.0, 0.1))
    (other, _) = pair(n=3)
    for model, current in ((wet, (0.0, -0.2, 0.0)), (twin, (0.0, 0.0, 0.1))):
        water.attach(other, oracle.elements(3), current=current, usual_speed=0.01)
        np.testing.assert_array_equal(speeds_after_a_step(model), speeds_after_a_step(other))
    np.testing.assert_array_equal(*both)


def test_a_current_that_is_set_after_a_function_acts():
    (wet, _) = pair(n=2)
    handle = water.attach(
        wet, oracle.elements(2), current=lambda x, y, z, t: (0.0, 0.5, z), usual_speed=0.01
    )
    by_function = speeds_after_a_step(wet)
    handle.set_current((0.3, 0.0, 0.0))
    (other, _) = pair(n=2)
    water.attach(other, oracle.elements(2), current=(0.3, 0.0, 0.0), usual_speed=0.01)
    np.testing.assert_array_equal(speeds_after_a_step(wet), speeds_after_a_step(other))
    assert np.max(np.abs(by_function - speeds_after_a_step(wet))) > 1e-6


def test_more_models_than_the_registry_began_with_keep_their_water():
    (first, _) = pair(n=2)
    handle = water.attach(first, oracle.elements(2), current=(0.1, 0.0, 0.0), usual_speed=0.01)
    before, models = speeds_after_a_step(first), []
    for _ in range(2 * len(registry._rows[-1])):
        models.append(copy.deepcopy(first))
        water.attach(models[-1], handle.elements, current=(0.1, 0.0, 0.0), usual_speed=0.01)
    for model in (first, models[0], models[-1]):
        np.testing.assert_array_equal(speeds_after_a_step(model), before)


def test_a_pickled_model_brings_its_water_along_and_its_current():
    (wet, _) = pair(n=3)
    water.attach(
        wet, oracle.elements(3), density=1025.0, surface=0.1, usual_speed=0.01
    ).set_current((0.1, 0.2, 0.3))
    before, stored = speeds_after_a_step(wet), pickle.dumps(wet)
    mark = registry._mark(wet)
    del wet
    gc.collect()
    registry._forget(mark)  # as in another process
    np.testing.assert_array_equal(speeds_after_a_step(pickle.loads(stored)), before)
    _, dry = pair()
    assert water.attached(pickle.loads(pickle.dumps(dry))) is None


def test_a_model_from_an_mjb_file_says_that_it_has_lost_its_water(tmp_path):
    (wet, _) = pair(n=2)
    water.attach(wet, oracle.elements(2), usual_speed=0.01)
    mujoco.mj_saveModel(wet, str(tmp_path / "wet.mjb"), None)
    loaded = mujoco.MjModel.from_binary_path(str(tmp_path / "wet.mjb"))
    np.testing.assert_array_equal(speeds_after_a_step(loaded), speeds_after_a_step(wet))
    registry._forget(registry._mark(wet))  # as in another process
    with pytest.raises(mujoco.FatalError, match="this model has lost its water: an MJB file"):
        mujoco.mj_forward(loaded, mujoco.MjData(loaded))
    water.attach(loaded, oracle.elements(2), usual_speed=0.01)
    mujoco.mj_forward(loaded, mujoco.MjData(loaded))


# ---- all geoms of a model ------------------------------------------------------------------------

STRANGER = """<mujoco><option timestep="0.001" density="1.2"/><worldbody>
<geom type="plane" size="5 5 .1"/><geom name="rock" size=".5" pos="2 0 0"/>
<body pos="0 0 -1"><freejoint/>
<geom name="hull" type="ellipsoid" size=".5 .12 .1" density="900"/>
<geom name="paint" type="box" size=".6 .2 .2" contype="0" conaffinity="0" mass="0"/>
<geom name="battery" type="box" size=".1 .05 .05" pos="0 0 -.02"/>
<geom name="nose" size=".1" pos=".45 0 0" density="500"/>
<body pos="-.5 0 0"><joint axis="0 0 1" damping=".1"/>
<geom name="tail" type="capsule" size=".05 .1" euler="0 90 0" contype="0" conaffinity="0" pos="-.2 0 0"/></body>
</body></worldbody></mujoco>"""


class Wrapped:
    """As environments hold a model: `physics.model` of dm_control."""

    def __init__(self, model) -> None:
        self.ptr = model


def test_one_line_puts_a_stranger_s_model_in_water_and_says_what_it_left_out():
    model = mujoco.MjModel.from_xml_string(STRANGER)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        handle = water.attach(Wrapped(model))
    said = [str(one.message) for one in caught]
    assert len(said) == 3
    assert any("replaces MuJoCo's own medium of 1.2 kg/m^3 and 0 Pa s" in one for one in said)
    assert any("geom `battery` overlaps `hull` by 100 %: it is left out" in one for one in said)
    assert any("geom `nose` overlaps `hull` by" in one and "twice" in one for one in said)
    assert [(e.body, e.shape) for e in handle.elements] == [
        ("1", "ellipsoid"),
        ("1", "ellipsoid"),
        ("2", "cylinder"),
    ]
    assert model.opt.density == 0.0
    data = mujoco.MjData(model)
    data.qvel[:] = 0.5
    for _ in range(1000):
        mujoco.mj_step(model, data)
    assert np.all(np.isfinite(data.qpos)) and np.max(np.abs(data.qvel)) < 2.0


def test_a_model_of_nothing_that_moves_is_refused():
    with pytest.raises(
        ValueError, match="`model` must have a geom with a volume on a body that can move"
    ):
        water.attach(
            mujoco.MjModel.from_xml_string(
                '<mujoco><worldbody><geom size="1"/></worldbody></mujoco>'
            )
        )


def element_of_mesh(vertices: np.ndarray) -> Element:
    """Return the element of the convex hull of points."""
    text = " ".join(f"{x:.17g}" for x in vertices.ravel())
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><asset><mesh name="m" vertex="{text}"/></asset><worldbody><body><freejoint/>'
        '<geom name="g" type="mesh" mesh="m"/></body></worldbody></mujoco>'
    )
    return water.geom_element(model, "g")


@given(st.tuples(*[st.floats(0.05, 0.5)] * 3), st.tuples(*[st.floats(-1.0, 1.0)] * 3))
@settings(max_examples=20, deadline=None)
def test_a_mesh_that_is_a_box_has_the_element_of_the_box(half, shift):
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    element = element_of_mesh(corners + shift)
    size = " ".join(map(str, half))
    box = water.geom_element(
        mujoco.MjModel.from_xml_string(body("box", size, option="", density=500.0)), "g"
    )
    turn = np.abs(element.rotation)  # vertices are kept in single precision
    assert element.shape == "box"
    assert element.volume == pytest.approx(box.volume, rel=1e-5)
    np.testing.assert_allclose(element.position, shift, atol=1e-5)
    for name in ("half_size", "added_mass", "added_inertia", "drag"):
        np.testing.assert_allclose(turn @ getattr(element, name), getattr(box, name), rtol=1e-3)


@given(st.tuples(*[st.floats(0.05, 0.5)] * 3), st.tuples(*[st.floats(-1.0, 1.0)] * 3))
@settings(max_examples=20, deadline=None)
def test_a_mesh_has_the_element_of_its_volume_and_its_moments(half, shift):
    corners = np.vstack([np.zeros(3), np.eye(3)]) * half  # a tetrahedron
    element = element_of_mesh(corners + shift)
    volume = np.prod(half) / 6.0
    assert element.shape == "ellipsoid"
    assert element.volume == pytest.approx(volume, rel=1e-4)
    np.testing.assert_allclose(element.position, np.array(half) / 4.0 + shift, atol=1e-5)
    moments = element.rotation @ np.diag(np.square(element.half_size)) @ element.rotation.T / 5.0
    spread = np.outer(half, half) * (4.0 * np.eye(3) - 1.0) / 80.0
    np.testing.assert_allclose(moments, spread, atol=1e-5)


def test_a_mesh_of_a_prism_with_many_sides_has_the_element_of_the_cylinder():
    angle = np.arange(32) * np.pi / 16.0
    ring = np.column_stack([0.1 * np.cos(angle), 0.1 * np.sin(angle), np.zeros(32)])
    element = element_of_mesh(
        np.vstack([ring - np.array([0, 0, 0.4]), ring + np.array([0, 0, 0.4])])
    )
    text = body("cylinder", "0.1 0.4", option="", density=500.0)
    cylinder = water.geom_element(mujoco.MjModel.from_xml_string(text), "g")
    assert element.shape == "cylinder"
    for name in ("half_size", "added_mass", "added_inertia", "drag"):
        np.testing.assert_allclose(getattr(element, name), getattr(cylinder, name), rtol=0.03)


def test_a_mesh_that_encloses_nothing_is_refused_by_name():
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><asset><mesh name="m" inertia="shell" vertex="0 0 0 1 0 0 0 1 0 0 0 1"'
        ' face="0 1 2 0 2 1"/></asset><worldbody><body><freejoint/><geom size=".1"/>'
        '<geom name="sail" type="mesh" mesh="m"/></body></worldbody></mujoco>'
    )
    with pytest.raises(
        ValueError, match=r"`geom` must have a volume, got `sail`, whose mesh has none"
    ):
        water.geom_element(model, "sail")


@given(st.floats(0.05, 0.6), st.floats(0.05, 0.6), st.floats(0.02, 0.3), st.floats(0.05, 0.95))
@settings(max_examples=30, deadline=None)
def test_a_float_s_metacentric_height_is_that_of_the_textbook_and_warns_where_it_is_negative(
    a, b, c, share
):
    model = mujoco.MjModel.from_xml_string(
        body("box", f"{a} {b} {c}", option="", density=1000.0 * share)
    )
    element = Element(body="b", volume=8.0 * a * b * c, shape="box", half_size=(a, b, c))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        handle = water.attach(model, [element], surface=0.0)
    draft = 2.0 * c * share
    expected = 0.5 * draft - c + min(a, b) ** 2 / (3.0 * draft)
    found = metacentric_height(model, 1, handle)
    slack = 2e-3 * (c + min(a, b) ** 2 / draft)
    assert found == pytest.approx(expected, abs=slack)
    if abs(expected) > slack:
        assert bool(caught) == (expected < 0.0)


# ---- versions of MuJoCo --------------------------------------------------------------------------


def joined_heap(jacobian: str) -> str:
    """Bodies with three arms each, whose arms are joined at random: what the fault of MuJoCo 4.0.0 needs."""
    random = np.random.default_rng(0)
    arm = '<body pos=".1 {y} 0" name="{name}"><joint axis="0 1 0"/><joint axis="0 0 1"/><geom size=".05"/></body>'
    bodies, joined = "", ""
    for i in range(10):
        arms = "".join(arm.format(name=f"{i}_{k}", y=0.05 * k) for k in range(3))
        x, y, z = random.uniform(-0.3, 0.3, 3)
        bodies += f'<body pos="{x} {y} {z}"><freejoint/><geom type="box" size=".08 .06 .05"/>{arms}</body>'
    for _ in range(10):
        i, j = random.choice(10, 2, replace=False)
        joined += f'<connect body1="{i}_{random.integers(3)}" body2="{j}_{random.integers(3)}" anchor=".05 0 0"/>'
    return f"""<mujoco><option jacobian="{jacobian}" tolerance="1e-12"/><worldbody>{bodies}</worldbody>
    <equality>{joined}</equality></mujoco>"""


def test_a_sparse_constraint_jacobian_gives_what_a_dense_one_does_whatever_the_version():
    found = []
    for jacobian in ("sparse", "auto", "dense"):
        model = mujoco.MjModel.from_xml_string(joined_heap(jacobian))
        water.attach(model, [Element(body="0_0", drag=(0.01,) * 3)])
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        found.append(data.qacc.copy())
    size = np.max(np.abs(found[2]))
    assert size > 1.0
    np.testing.assert_allclose(found[0], found[2], atol=1e-9 * size)
    np.testing.assert_allclose(found[1], found[2], atol=1e-9 * size)


def test_the_library_that_runs_is_opened_though_another_lies_beside_it(tmp_path, monkeypatch):
    native.library.cache_clear()
    folder = Path(mujoco.__file__).parent
    for name in ("libmujoco.so.0.0.1", "libmujoco.so.9.9.9"):
        (tmp_path / name).write_bytes(b"another version's")
    (tmp_path / "libmujoco.so.5.0.0").symlink_to(next(folder.glob("libmujoco*")))
    monkeypatch.setattr(mujoco, "__file__", str(tmp_path / "__init__.py"))
    assert native.library().mj_version() == mujoco.mj_version()
    native.library.cache_clear()
    monkeypatch.setattr(mujoco, "__version__", "0.0.1")
    with pytest.raises(
        OSError, match=r"no library of MuJoCo 0\.0\.1 is running from .* install `mujoco` again"
    ):
        native.library()


# ---- bad input -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("option", "says"),
    [
        ('solver="PGS"', "must have the solver Newton or CG"),
        (
            'integrator="discrete"',
            "must have one of the integrators Euler, RK4, implicit, implicitfast",
        ),
    ],
)
def test_what_added_mass_does_not_hold_for_is_refused(option: str, says: str):
    (wet, _) = pair(option)
    with pytest.raises(ValueError, match=says):
        water.attach(wet, oracle.elements())


def test_a_model_that_keeps_its_diagonal_only_is_refused_with_the_remedy():
    model = mujoco.MjModel.from_xml_string(body("sphere", ".1"))
    element = Element(body="b", added_mass=(1, 1, 2))
    with pytest.raises(ValueError, match="attach the water to its file or `MjSpec` instead"):
        water.attach(model, [element])


def test_a_model_that_is_compiled_for_water_is_the_same_model():
    spec = mujoco.MjSpec.from_string(body("box", ".1 .2 .3", option='gravity="0 0 -9.81"'))
    plain, full = spec.compile(), water.compile_spec(spec)
    np.testing.assert_array_equal(full.body_inertia, plain.body_inertia)
    states = []
    for model in (plain, full):
        data = mujoco.MjData(model)
        data.qvel[:] = 1, 2, 3, 4, 5, 6
        for _ in range(100):
            mujoco.mj_step(model, data)
        states.append(data.qpos.copy())
    np.testing.assert_allclose(*states, rtol=1e-10)


def test_bad_elements_and_geoms_are_refused_by_name():
    with pytest.raises(ValueError, match=r"`drag\[1\]` must be >= 0 N s\^2/m\^2, got -1"):
        Element(body="b", drag=(1, -1, 1))
    with pytest.raises(ValueError, match="`added_mass` must be three numbers in kg"):
        Element(body="b", added_mass=(1, 1))
    model = mujoco.MjModel.from_xml_string(
        body("sphere", ".1", extra='<geom name="floor" type="plane" size="1 1 1"/>')
    )
    with pytest.raises(ValueError, match="got `floor`, a plane"):
        water.geom_element(model, "floor", GeomCoefficients())
    with pytest.raises(ValueError, match="got 'nose'"):
        water.attach(model, [Element(body="nose")])
    with pytest.raises(ValueError, match="got the world"):
        water.attach(model, [Element(body="world")])


def test_a_geom_without_volume_is_refused_by_name():
    model = mujoco.MjModel.from_xml_string(body("sphere", ".1"))
    model.geom_size[0] = 0.0
    with pytest.raises(ValueError, match="`geom` must have a volume, got `g`"):
        water.geom_element(model, "g", GeomCoefficients())


def test_a_step_too_large_for_the_drag_is_warned_of_and_does_diverge():
    model = water.compile_spec(mujoco.MjSpec.from_string(body("sphere", ".1")))
    element = Element(body="b", drag=(2000.0,) * 3, law=PolynomialDrag(reference_speed=1.0))
    with pytest.warns(
        UserWarning,
        match=r"`timestep` 0.002 s is too large for the drag: at 1 m/s, steps are stable",
    ):
        handle = water.attach(model, [element])
    limit = water.stable_step(model, handle.elements, 0.0)
    for factor, grows in ((0.9, False), (1.1, True)):
        model.opt.timestep = factor * limit
        data = mujoco.MjData(model)
        data.qvel[0] = 1e-6
        for _ in range(20):
            mujoco.mj_step(model, data)
        assert (abs(data.qvel[0]) > 1e-6) == grows


def test_buoyancy_without_a_free_joint_is_warned_of():
    text = oracle.snake(2, root='<joint type="slide" axis="0 0 1"/>')
    model = mujoco.MjModel.from_xml_string(text)
    water.attach(
        model, [Element(body="b0", volume=1e-3)]
    )  # without weight there is no buoyancy to warn of
    model.opt.gravity[2] = -9.81
    with pytest.warns(UserWarning, match="`b0` has buoyancy but no free joint"):
        water.attach(model, [Element(body="b0", volume=1e-3)])


def test_a_robot_that_will_turn_over_is_warned_of():
    model = water.compile_spec(
        mujoco.MjSpec.from_string(body("sphere", ".1", option='gravity="0 0 -9.81"'))
    )
    with pytest.warns(UserWarning, match="center of buoyancy. is 0.01 m below its center of mass"):
        water.attach(model, [Element(body="b", volume=1e-3, position=(0, 0, -0.01))])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        water.attach(model, [Element(body="b", volume=1e-3, position=(0, 0, 0.01))])


def test_a_python_callback_that_is_there_already_is_refused():
    (wet, _) = pair()
    there = mujoco.get_mjcb_passive()
    try:
        mujoco.set_mjcb_passive(lambda model, data: None)
        with pytest.raises(ValueError, match="a Python function is set there"):
            water.attach(wet, oracle.elements())
    finally:
        mujoco.set_mjcb_passive(there)
