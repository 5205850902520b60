from dataclasses import replace

import numpy as np
import printed_equations as equations
import pytest
from chains import kernels, oracle, random_robot, random_state, random_water, recursion
from hypothesis import given, settings, strategies as st
from numba.core.runtime import rtsys
from scipy.integrate import solve_ivp

import laticauda as lc
from laticauda.models.planar import rows
from laticauda.models.planar.layout import build_layout
from laticauda.models.planar.model import specialize
from laticauda.motion.joints import PD
from laticauda.robot import Joint, load_robot, load_water
from laticauda.water.fluid.laws import PolynomialDrag

seeds = st.integers(0, 2**32 - 1)
GAIT = lc.lateral_undulation(
    amplitude=np.deg2rad(30), frequency=np.deg2rad(130), phase_shift=np.deg2rad(40)
)


def errors(steps, robot=None, **choices):
    """Distance of the end point from that with an eighth of the smallest step."""
    robot = robot or load_robot("mamba")
    end = [
        lc.swim(robot, GAIT, duration=4.0, dt=dt, sample_interval=0.4, **choices).center_of_mass[-1]
        for dt in (*steps, min(steps) / 8)
    ]
    return [float(np.linalg.norm(point - end[-1])) for point in end[:-1]]


def order(steps, found):
    return np.polyfit(np.log(steps), np.log(found), 1)[0]


def test_prescribed_joints_converge_with_order_five_where_the_drag_is_smooth():
    steps = [0.1, 0.05, 0.025]
    smooth = replace(load_water("paper-lateral"), drag=PolynomialDrag(quadratic=False))
    assert order(steps, errors(steps, environment=smooth)) == pytest.approx(5.0, abs=0.3)


@pytest.mark.parametrize("joints", ["pd", "servo"])
def test_driven_joints_converge_with_order_two_at_least(joints):
    steps = [0.02, 0.01, 0.005]
    assert order(steps, errors(steps, joints=joints)) > 2.0


@pytest.mark.parametrize(
    ("joints", "target"), [("prescribed", 1e-6), ("pd", 1e-5), ("servo", 1e-5)]
)
def test_the_default_step_is_converged(joints, target):
    robot = load_robot("mamba")
    usual = lc.swim(robot, GAIT, joints=joints)
    fine = lc.swim(robot, GAIT, joints=joints, dt=usual.settings["dt"] / 16)
    error = np.linalg.norm(usual.center_of_mass[-1] - fine.center_of_mass[-1])
    assert error < target * np.linalg.norm(fine.center_of_mass[-1])


def test_a_stiff_pd_step_stays_stable_far_beyond_the_explicit_limit():
    # The fastest rate of these gains is 8 400/s, so an explicit step would have to be below 0.33
    # ms.
    trial = lc.swim(load_robot("mamba"), GAIT, joints="pd", dt=0.02)
    assert trial.forward_velocity == pytest.approx(0.1113, rel=5e-3)


@settings(max_examples=3, deadline=None)
@given(seeds, st.sampled_from(["relative", "kirchhoff"]))
def test_without_drag_and_actuation_energy_is_kept_and_by_kirchhoff_momentum(seed, form):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 6))
    robot = random_robot(rng, n, fin=bool(rng.random() < 0.5))
    water = random_water(rng, form, drag=False)
    chain, options, n_fin = oracle(robot, water)
    first = random_state(rng, n, fast=2.0)

    def whole(y):
        theta, rate = y[: n + 2][:n], y[n + 2 : 2 * n + 2]
        fin = [0] * n_fin
        return np.append(theta[fin], theta), np.append(rate[fin], rate), y[2 * n + 2 :]

    def slope(_, y):
        state = type(first)(y[:n], y[n + 2 : 2 * n + 2], y[2 * n + 2 :])
        links, center, _, _ = recursion(robot, water, state, joint_torque=np.zeros(n - 1))
        return np.concatenate((state.rate, state.velocity, links, center))

    y0 = np.concatenate((first.theta, np.zeros(2), first.rate, first.velocity))
    end = solve_ivp(slope, (0.0, 10.0), y0, method="DOP853", rtol=1e-11, atol=1e-11).y[:, -1]
    before, after = (equations.kinetic_energy(*whole(y), chain, options) for y in (y0, end))
    assert after == pytest.approx(before, rel=1e-8)
    if form == "kirchhoff":
        before, after = (
            equations.momentum(*whole(y)[:2], y[n : n + 2], y[2 * n + 2 :], chain, options)
            for y in (y0, end)
        )
        np.testing.assert_allclose(after[0], before[0], rtol=0, atol=1e-8 * np.abs(before[0]).max())


@pytest.mark.parametrize("form", ["relative", "kirchhoff"])
@pytest.mark.parametrize("fin", ["mamba", "mamba-fin"])
def test_without_drag_the_work_of_the_joints_is_the_kinetic_energy(form, fin):
    water = replace(
        load_water("paper-lateral"),
        added_mass_form=form,
        drag=PolynomialDrag(linear=False, quadratic=False),
    )
    robot = load_robot(fin)
    trial = lc.swim(robot, GAIT, duration=3.0, environment=water, dt=0.0005)
    chain, options, n_fin = oracle(robot, water)
    theta = trial.link_angle[-1]
    tail = (
        trial.heading_rate[-1]
        - trial.joint_rate[-1] @ np.arange(robot.n_joints, 0, -1) / robot.n_links
    )
    rate = tail + np.append(0.0, np.cumsum(trial.joint_rate[-1]))
    fin_links = [0] * n_fin
    energy = equations.kinetic_energy(
        np.append(theta[fin_links], theta),
        np.append(rate[fin_links], rate),
        trial.center_of_mass_velocity[-1],
        chain,
        options,
    )
    assert trial.work[-1, 1] == pytest.approx(energy, rel=1e-5)


def test_positive_work_is_what_the_joints_put_in_and_not_what_they_take_out():
    work = lc.swim(load_robot("mamba"), GAIT, duration=3.0).work
    absolute, net, positive = work[-1]
    assert 0.0 < net < 0.999 * absolute  # the joints take some out
    assert positive == pytest.approx(0.5 * (absolute + net), rel=1e-12)


@pytest.mark.parametrize("joints", ["prescribed", "pd", "servo"])
def test_a_run_cut_in_the_middle_and_resumed_is_the_same_run(joints):
    robot = load_robot("mamba-fin")
    whole = lc.swim(robot, GAIT, duration=6.0, joints=joints)
    first = lc.swim(robot, GAIT, duration=3.0, joints=joints)
    second = lc.resume(lc.build_plant(robot, first.environment, joints=joints), first, 3.0)
    both = lc.joined(first, second)
    for name in ("time", "center_of_mass", "link_angle", "joint_torque", "work"):
        np.testing.assert_array_equal(getattr(both, name), getattr(whole, name))


@settings(max_examples=10, deadline=None)
@given(st.floats(0.1, 0.7), st.floats(1.0, 3.0), st.floats(0.3, 1.2), st.floats(-0.2, 0.2))
def test_a_mirrored_gait_swims_the_mirrored_path(amplitude, frequency, phase_shift, offset):
    robot = load_robot("mamba-fin")
    shape = dict(amplitude=amplitude, frequency=frequency, phase_shift=phase_shift, n_links=9)
    right = lc.swim(
        robot, lc.custom_gait(envelope=lambda i, n: 1.0, offset=offset, **shape), duration=5.0
    )
    left = lc.swim(
        robot, lc.custom_gait(envelope=lambda i, n: -1.0, offset=-offset, **shape), duration=5.0
    )
    np.testing.assert_allclose(left.center_of_mass, right.center_of_mass * [1.0, -1.0], atol=1e-10)
    np.testing.assert_allclose(left.joint_torque, -right.joint_torque, atol=1e-8)


@settings(max_examples=10, deadline=None)
@given(st.floats(-3.0, 3.0))
def test_a_rotated_start_rotates_the_path(angle):
    robot = load_robot("mamba")
    straight = lc.swim(robot, GAIT, duration=5.0)
    turned = lc.swim(robot, GAIT, duration=5.0, start=lc.Start(heading=angle))
    c, s = np.cos(angle), np.sin(angle)
    np.testing.assert_allclose(
        turned.center_of_mass, straight.center_of_mass @ [[c, s], [-s, c]], atol=1e-10
    )


@pytest.mark.parametrize("joints", ["prescribed", "pd"])
def test_link_forces_move_the_center_of_mass(joints):
    robot = load_robot("mamba-fin")
    trial = lc.swim(
        robot, GAIT, duration=2.0, joints=joints, sample_interval=0.002, dt=0.0005, link_forces=True
    )
    total = sum(force.sum(axis=1) for force in trial.link_force.values())
    acceleration = np.gradient(trial.center_of_mass_velocity, trial.time, axis=0)
    late = (
        trial.time > 1.1
    )  # past the first fast transient of pd, and past the kink in the jerk where the ramp ends
    np.testing.assert_allclose(
        total[late][:-1], robot.mass * acceleration[late][:-1], atol=1e-3 * np.abs(total).max()
    )


def test_skin_stiffness_loads_the_actuators():
    soft, stiff = load_robot("mamba"), load_robot("mamba")
    joint = Joint(stiffness=2.0, damping=0.1)
    stiff = replace(stiff, joints=(joint,) * stiff.n_joints)
    free, loaded = (lc.swim(robot, GAIT, duration=3.0) for robot in (soft, stiff))
    np.testing.assert_allclose(
        loaded.joint_torque - free.joint_torque,
        2.0 * free.joint_angle + 0.1 * free.joint_rate,
        atol=1e-9,
    )
    np.testing.assert_array_equal(loaded.center_of_mass, free.center_of_mass)


def test_the_time_loop_does_not_allocate():
    robot, water = load_robot("mamba"), load_water("paper-lateral")
    a = build_layout(robot, water, joints=PD())

    def allocations(steps):
        S = a.template.copy()
        log = np.empty((2, rows.LOG_STATE + 4 * (a.n_bodies - 1), 1))
        before = rtsys.get_allocation_stats().alloc
        chain = (a.n_bodies, a.first_strip, a.first_plate, a.law, a.tail_link, a.has_extras)
        kernels().run(S, *chain, True, steps, 0.002, steps, log)
        return rtsys.get_allocation_stats().alloc - before

    allocations(1)
    assert allocations(1000) == allocations(10)


def test_eight_lanes_give_what_eight_single_runs_give():
    robot = load_robot("mamba-fin")
    a = build_layout(robot, load_water("paper-lateral"))
    chain = (a.n_bodies, a.first_strip, a.first_plate, a.law, a.tail_link, a.has_extras)
    trials = []
    for amplitude in np.linspace(0.2, 0.6, 8):
        S = a.template.copy()
        S[[rows.AMPLITUDE, rows.AMPLITUDE_NOW]] = amplitude
        S[[rows.FREQUENCY, rows.FREQUENCY_NOW]] = 2.0
        S[[rows.PHASE_SHIFT, rows.PHASE_SHIFT_NOW]] = 0.7
        S[rows.BANDWIDTH], S[rows.RAMP] = 10.0, 1.0
        S[
            rows.HEADER_ROWS + rows.ENVELOPE : rows.HEADER_ROWS
            + 9 * rows.BODY_ROWS : rows.BODY_ROWS
        ] = 1.0
        trials.append(S)

    def march(lanes, width):
        S = np.ascontiguousarray(
            np.array(lanes).T
        )  # as batches hand it on, so that their kernel is found again
        S = S.ravel() if width == 1 else S
        log = np.empty((5, rows.LOG_STATE + 32, width))
        specialize(width).run(S, *chain, False, 40, 0.025, 10, log)
        return log

    single = np.concatenate([march([S], 1) for S in trials], axis=2)
    np.testing.assert_allclose(march(trials, 8), single, rtol=1e-12, atol=1e-12)


@pytest.fixture(scope="module")
def march():
    plant = lc.build_plant("mamba", joints="servo")
    command = lc.Command(gait=GAIT)
    flat = plant.rows(plant.init(lc.Start(), command), command)

    def advance(S, n_samples):
        log = np.full((1 + n_samples, plant.layout.sample_size, 1), np.nan)
        n_logged = kernels().run(S, *plant.layout.chain, True, 5 * n_samples, 0.005, 5, log)
        return n_logged, log

    return flat, advance


def test_a_run_that_resumes_leaves_the_sample_at_its_begin_to_the_run_before(march):
    flat, advance = march
    S = flat.copy()
    _, whole = advance(S, 8)
    S = flat.copy()
    advance(S, 4)
    S[rows.RESUMES] = 1.0
    n_logged, second = advance(S, 4)
    assert n_logged == S[rows.SAMPLES] == 5
    assert np.all(np.isnan(second[0]))
    np.testing.assert_array_equal(second[1:], whole[5:])
    assert not np.any(np.isnan(advance(S, 1)[1]))  # it resumes once


def test_still_water_is_a_current_of_nothing(march):
    flat, advance = march
    ends = []
    for current in (0.0, 1e-200):
        S = flat.copy()
        S[rows.CURRENT_X] = current
        ends.append(advance(S, 40)[1][-1])
        assert S[rows.IS_STILL] == (current == 0.0)
    np.testing.assert_allclose(ends[1], ends[0], rtol=1e-12, atol=1e-12)
