import numpy as np
import printed_equations as equations
import pytest
from chains import (
    FORMS,
    State,
    effectors,
    fill,
    kernels,
    oracle,
    random_robot,
    random_state,
    random_water,
    recursion,
)
from hypothesis import given, settings, strategies as st

from laticauda.models.planar import rows
from laticauda.models.planar.layout import build_layout
from laticauda.robot import Tether, Water, load_robot, load_water
from laticauda.water.fluid.laws import TotalSpeedDrag

seeds = st.integers(0, 2**32 - 1)
laws = settings(max_examples=60, deadline=None)


def close(actual, expected, tolerance=1e-9):
    scale = max(1.0, float(np.abs(expected).max(initial=0.0)))
    np.testing.assert_allclose(actual, expected, rtol=0.0, atol=tolerance * scale)


def extended(state, n_fin):
    """The state with the fin's links, which follow the tail link."""
    return np.append([state.theta[0]] * n_fin, state.theta), np.append(
        [state.rate[0]] * n_fin, state.rate
    )


def setting(seed, form, *, fin=True, thrusters=2, n_least=2, **changes):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(n_least, 8))
    robot = random_robot(rng, n, fin=fin and rng.random() < 0.5, thrusters=thrusters)
    water = random_water(rng, form, **changes)
    return rng, robot, water, random_state(rng, n), oracle(robot, water)


@laws
@given(seeds, st.sampled_from(FORMS), st.booleans())
def test_prescribed_joints_accelerate_as_the_matrices_say(seed, form, fin_as_links):
    rng, robot, water, state, (chain, options, n_fin) = setting(seed, form)
    theta, rate = extended(state, n_fin)
    joint = rng.uniform(-5, 5, robot.n_links - 1)
    expected = equations.constrained_accelerations(
        theta,
        rate,
        state.velocity,
        chain,
        options,
        np.append(np.zeros(n_fin), joint),
        *effectors(robot, state.theta, n_fin),
    )
    links, center, _, torque = recursion(
        robot, water, state, joint_acceleration=joint, fin_as_links=fin_as_links
    )
    close(links, expected[0][n_fin:])
    close(center, expected[1])
    close(torque, expected[2][n_fin:])


@laws
@given(seeds, st.sampled_from(FORMS), st.booleans())
def test_free_joints_accelerate_as_the_matrices_say(seed, form, fin_as_links):
    rng, robot, water, state, (chain, options, n_fin) = setting(seed, form)
    theta, rate = extended(state, n_fin)
    torque = rng.uniform(-1, 1, robot.n_links - 1)
    fixed = np.arange(n_fin + robot.n_links - 1) < n_fin
    expected = equations.constrained_accelerations(
        theta,
        rate,
        state.velocity,
        chain,
        options,
        np.zeros(fixed.size),
        *effectors(robot, state.theta, n_fin),
        prescribed=fixed,
        joint_torque=np.append(np.zeros(n_fin), torque),
    )
    links, center, _, _ = recursion(
        robot, water, state, joint_torque=torque, fin_as_links=fin_as_links
    )
    close(links, expected[0][n_fin:])
    close(center, expected[1])


@pytest.mark.parametrize(
    "law", [None, TotalSpeedDrag(beta=0.4, gamma=0.9)], ids=["polynomial", "total speed"]
)
@laws
@given(seed=seeds)
def test_the_elongated_trailing_edge_is_that_of_the_equations(seed, law):
    rng, robot, water, state, (chain, options, n_fin) = setting(
        seed, "kirchhoff", trailing_edge="elongated", law=law
    )
    theta, rate = extended(state, n_fin)
    joint = rng.uniform(-5, 5, robot.n_links - 1)
    expected = equations.constrained_accelerations(
        theta,
        rate,
        state.velocity,
        chain,
        options,
        np.append(np.zeros(n_fin), joint),
        *effectors(robot, state.theta, n_fin),
    )
    links, center, _, torque = recursion(robot, water, state, joint_acceleration=joint)
    close(links, expected[0][n_fin:])
    close(center, expected[1])
    close(torque, expected[2][n_fin:])


@laws
@given(seeds, st.sampled_from(FORMS))
def test_torques_of_the_inverse_dynamics_give_back_the_prescribed_accelerations(seed, form):
    rng, robot, water, state, _ = setting(seed, form)
    joint = rng.uniform(-5, 5, robot.n_links - 1)
    links, center, _, torque = recursion(robot, water, state, joint_acceleration=joint)
    again = recursion(robot, water, state, joint_torque=torque)
    close(again[0], links, 1e-8)
    close(again[1], center, 1e-8)
    close(again[2], joint, 1e-8)


@laws
@given(seeds, st.sampled_from(["relative", "kirchhoff"]))
def test_a_current_is_the_same_as_moving_the_other_way_in_still_water(seed, form):
    rng, robot, water, state, _ = setting(seed, form)
    still = random_water(np.random.default_rng(seed), form, current=(0.0, 0.0))
    joint = rng.uniform(-5, 5, robot.n_links - 1)
    current = rng.uniform(-0.5, 0.5, 2)
    flowing = random_water(np.random.default_rng(seed), form, current=tuple(current))
    moved = State(state.theta, state.rate, state.velocity + current)
    one = recursion(robot, still, state, joint_acceleration=joint)
    other = recursion(robot, flowing, moved, joint_acceleration=joint)
    for a, b in zip(one, other, strict=True):
        close(a, b)
    del water


@laws
@given(seeds, st.sampled_from(FORMS))
def test_a_mirrored_state_accelerates_in_the_mirror(seed, form):
    rng, robot, water, state, _ = setting(seed, form, thrusters=0, current=(0.2, 0.0))
    joint = rng.uniform(-5, 5, robot.n_links - 1)
    flip = np.array([1.0, -1.0])
    mirrored = State(-state.theta, -state.rate, flip * state.velocity)
    links, center, _, torque = recursion(robot, water, state, joint_acceleration=joint)
    again = recursion(robot, water, mirrored, joint_acceleration=-joint)
    close(-again[0], links)
    close(flip * again[1], center)
    close(-again[3], torque)


def test_a_tether_pulls_back_in_proportion_to_the_square_of_the_speed_and_by_its_constant_force():
    robot = load_robot("chain", n_links=3)
    tethered = load_robot("chain", n_links=3)
    object.__setattr__(tethered, "tether", Tether(drag=2.0, force=(0.5, 0.0)))
    water = Water(tangential_friction=0.0, normal_drag=0.0, added_mass=0.0)
    state = State(np.zeros(3), np.zeros(3), np.array([0.4, 0.0]))
    free = recursion(robot, water, state, joint_acceleration=np.zeros(2))[1]
    held = recursion(tethered, water, state, joint_acceleration=np.zeros(2))[1]
    assert (held - free)[0] * robot.mass == pytest.approx(0.5 - 2.0 * 0.4**2)


def test_sine_and_cosine_are_good_to_the_last_digits():
    a = build_layout(load_robot("chain", n_links=2), load_water("paper-lateral"))
    worst = 0.0
    for angle in np.concatenate((np.linspace(-100, 100, 20001), np.linspace(-9e4, 9e4, 2001))):
        S, body = fill(a, State(np.array([angle, angle]), np.zeros(2), np.zeros(2)))
        kernels().evaluate(
            S, 2, a.first_strip, a.first_plate, np.zeros(2, dtype=bool), a.tail_link, a.has_extras
        )
        at = S[rows.HEADING]
        worst = max(worst, abs(body[0, rows.SIN] - np.sin(at)), abs(body[0, rows.COS] - np.cos(at)))
    assert worst < 3e-16
