"""The fin that bends and the fin that is driven: bending frequencies, energy, limits, and what goes with a run."""

from dataclasses import replace

import numpy as np
import printed_equations as equations
import pytest
from chains import kernels, oracle
from hypothesis import given, settings, strategies as st
from scipy.linalg import eigh

import laticauda as lc
from laticauda.models.dynamics.samples import PlantState
from laticauda.models.planar import rows, sample_format
from laticauda.models.planar.layout import build_layout
from laticauda.models.planar.model import PlanarPlant
from laticauda.models.simulate import compute_sensitivities
from laticauda.robot import CaudalFin, Joint, Module, Robot, Section, load_robot, load_water
from laticauda.robot.hydrodynamics import bending_frequencies
from laticauda.water.fluid.laws import PolynomialDrag

GAIT = lc.lateral_undulation(
    amplitude=np.deg2rad(30), frequency=np.deg2rad(130), phase_shift=np.deg2rad(40)
)
WAVE = lc.Wave(amplitude=0.4, frequency=2.5, phase=1.0, offset=0.1)
WATER = load_water("paper-lateral")
RIGID = load_robot("mamba-fin")
SECTION = Section(half_height=0.05, half_width=0.05)
VACUUM = replace(WATER, density=1e-6)


def fitted(robot=RIGID, **changes):
    return replace(robot, caudal_fin=replace(robot.caudal_fin, **changes))


ELASTIC = fitted(n_hinges=3, flexural_rigidity=1.0)
DRIVEN = fitted(joint=Joint())
BOTH = fitted(
    joint=Joint(stiffness=0.5, damping=0.1), n_hinges=2, flexural_rigidity=0.5, bending_damping=0.02
)
ROBOTS = {
    "elastic": (ELASTIC, GAIT),
    "driven": (DRIVEN, replace(GAIT, fin=WAVE)),
    "both": (BOTH, replace(GAIT, fin=WAVE)),
}


# ---- bending frequencies -------------------------------------------------------------------------


def bending_rates(fin, water):
    """Angular frequencies of a fin on a body too heavy to move, from the accelerations that the kernel computes."""
    robot = Robot(
        name="wall",
        modules=(Module(length=0.2, mass=1e6, inertia=1e6, section=SECTION),),
        caudal_fin=fin,
    )
    a = build_layout(robot, water)
    hinges = np.flatnonzero(a.law == rows.PASSIVE)
    give = np.empty((hinges.size, hinges.size))
    for k, pushed in enumerate(hinges):
        S = a.template.copy()
        body = S[rows.HEADER_ROWS : rows.HEADER_ROWS + a.n_bodies * rows.BODY_ROWS].reshape(
            -1, rows.BODY_ROWS
        )
        stiffness = body[hinges, rows.STIFFNESS].copy()
        body[pushed, rows.TOTAL_TORQUE] = 1.0
        is_free = a.law == rows.PASSIVE
        kernels().evaluate(
            S, a.n_bodies, a.first_strip, a.first_plate, is_free, a.tail_link, a.has_extras
        )
        give[:, k] = body[hinges, rows.ACCELERATION]
    root = np.diag(np.sqrt(stiffness))
    return np.sqrt(np.linalg.eigvalsh(root @ (0.5 * (give + give.T)) @ root))


def beam_rates(length, rigidity, mass_per_length, n=60):
    """The same of a clamped beam, by finite elements with Hermite's cubics; `mass_per_length` a function of place."""
    h = length / n
    K, M = np.zeros((2 * n + 2,) * 2), np.zeros((2 * n + 2,) * 2)
    k = [[12, 6 * h, -12, 6 * h], [6 * h, 4 * h**2, -6 * h, 2 * h**2]]
    k += [[-12, -6 * h, 12, -6 * h], [6 * h, 2 * h**2, -6 * h, 4 * h**2]]
    m = [[156, 22 * h, 54, -13 * h], [22 * h, 4 * h**2, 13 * h, -3 * h**2]]
    m += [[54, 13 * h, 156, -22 * h], [-13 * h, -3 * h**2, -22 * h, 4 * h**2]]
    for e in range(n):
        at = slice(2 * e, 2 * e + 4)
        K[at, at] += np.array(k) * rigidity / h**3
        M[at, at] += np.array(m) * mass_per_length((e + 0.5) * h) * h / 420.0
    return np.sqrt(eigh(K[2:, 2:], M[2:, 2:], eigvals_only=True))


# What the first frequency may be off by: docs/theory/fin.md has the table.
BOUNDS = (6e-3, 3e-4, 1e-4, 1e-4, 1e-4, 1e-4)


@pytest.mark.parametrize("n", range(1, 7))
def test_in_vacuum_the_first_frequency_is_the_cantilevers(n):
    fin = CaudalFin(opening="closed", n_strips=200, n_hinges=n, flexural_rigidity=2.0)
    expected = 1.8751040687**2 / fin.length**2 * np.sqrt(2.0 / (fin.mass / fin.length))
    assert bending_rates(fin, VACUUM)[0] == pytest.approx(expected, rel=BOUNDS[n - 1])


@pytest.mark.parametrize("n", range(1, 7))
def test_in_water_the_first_frequency_is_that_of_the_plate_with_its_added_mass(n):
    fin = CaudalFin(
        opening="closed", n_strips=200, n_hinges=n, flexural_rigidity=2.0, added_mass=1.0
    )
    mass = fin.mass / fin.length + WATER.density * np.pi * (fin.height / 2.0) ** 2
    expected = 1.8751040687**2 / fin.length**2 * np.sqrt(2.0 / mass)
    assert bending_rates(fin, WATER)[0] == pytest.approx(expected, rel=BOUNDS[n - 1] + 5e-5)


@pytest.mark.parametrize(("opening", "bounds"), [("open", (6e-3, 1e-2)), ("closed", (3e-4, 8e-3))])
def test_two_frequencies_are_those_of_a_beam_of_finite_elements(opening, bounds):
    fin = CaudalFin(
        opening=opening,
        opening_length=0.125,
        n_strips=300,
        n_hinges=2,
        flexural_rigidity=2.0,
        added_mass=1.0,
    )
    water = WATER.density * np.pi * (fin.height / 2.0) ** 2
    beam = beam_rates(
        0.5, 2.0, lambda x: fin.mass / fin.length + water * (opening == "closed" or x > 0.125)
    )
    found = bending_rates(fin, WATER)
    assert found[0] == pytest.approx(beam[0], rel=bounds[0])
    assert found[1] == pytest.approx(beam[1], rel=bounds[1])


@pytest.mark.parametrize("opening", ["open", "closed"])
@pytest.mark.parametrize("rotational", ["paper", "strip"])
def test_the_stated_frequencies_are_those_of_the_kernel(opening, rotational):
    water = replace(WATER, rotational=rotational)
    for n in range(1, 7):
        fin = CaudalFin(opening=opening, n_hinges=n, flexural_rigidity=0.7)
        stated = bending_frequencies(replace(RIGID, caudal_fin=fin), water)
        np.testing.assert_allclose(2.0 * np.pi * stated, bending_rates(fin, water), rtol=1e-4)
    with pytest.raises(
        ValueError, match=r"`robot` must have a fin that bends \(`caudal_fin.n_hinges` > 0\)"
    ):
        bending_frequencies(RIGID, water)


def test_a_plucked_fin_swings_at_that_frequency():
    fin = CaudalFin(
        opening="closed", n_strips=50, n_hinges=2, flexural_rigidity=2.0, added_mass=1.0
    )
    still = replace(WATER, drag=PolynomialDrag(linear=False, quadratic=False))
    heavy = Robot(
        name="wall",
        modules=(Module(length=0.2, mass=1e9, inertia=1e9, section=SECTION),),
        caudal_fin=fin,
    )
    plant = PlanarPlant(robot=heavy, environment=still, settings=lc.Planar(dt=2e-4))
    command = lc.Command(gait=GAIT)
    state = plant.init(lc.Start(), command)
    state.values[-2:] = 0.02, 0.05  # rates of the hinges, the outer one first
    log = plant.march(state, command, 10.0, 2e-3)[1]
    angle = log.signals["fin_angle_1"]
    spectrum = np.abs(np.fft.rfft(angle * np.hanning(angle.size), 16 * angle.size))
    assert np.argmax(spectrum) / (16 * angle.size * 2e-3) == pytest.approx(
        bending_rates(fin, still)[0] / (2 * np.pi), rel=5e-3
    )


# ---- energy --------------------------------------------------------------------------------------


def energy(trial, water):
    """Kinetic energy, of the water too, and that of the springs at every sample [J]; for a closed opening."""
    robot, fin = trial.robot, trial.robot.caudal_fin
    chain, options, n_fin = oracle(robot, water)
    middle = np.cumsum(2.0 * chain.half_length[:n_fin][::-1]) - chain.half_length[:n_fin][::-1]
    piece = np.searchsorted([p.end for p in fin.pieces], middle)[::-1]
    found = np.empty(trial.time.size)
    for i in range(found.size):
        tail = (
            trial.heading_rate[i]
            - trial.joint_rate[i] @ np.arange(robot.n_joints, 0, -1) / robot.n_links
        )
        rate = tail + np.append(0.0, np.cumsum(trial.joint_rate[i]))
        driven = [] if fin.joint is not None else [0.0]
        bend, swing = (np.cumsum([*driven, *of[i]]) for of in (trial.fin_angle, trial.fin_rate))
        found[i] = equations.kinetic_energy(
            np.append(trial.link_angle[i, 0] - bend[piece], trial.link_angle[i]),
            np.append(tail - swing[piece], rate),
            trial.center_of_mass_velocity[i],
            chain,
            options,
        )
    stiffness = [] if fin.joint is None else [fin.joint.stiffness]
    return found + 0.5 * trial.fin_angle**2 @ [
        *stiffness,
        *(hinge.stiffness for hinge in fin.hinges),
    ]


@pytest.mark.parametrize("form", ["relative", "kirchhoff"])
@pytest.mark.parametrize("joints", ["prescribed", "pd"])
def test_without_drag_the_work_of_the_joints_is_in_motion_and_springs(form, joints):
    water = replace(WATER, added_mass_form=form, drag=PolynomialDrag(linear=False, quadratic=False))
    robot = fitted(opening="closed", n_hinges=2, flexural_rigidity=1.0, joint=Joint())
    gait = replace(GAIT, fin=WAVE)
    trial = lc.swim(
        robot,
        gait,
        duration=3.0,
        environment=water,
        joints=joints,
        dt=5e-4 if joints == "prescribed" else 1e-4,
    )
    assert np.abs(trial.fin_angle).max() > 0.2
    lost = trial.work[:, 1] - energy(trial, water)
    first = (
        1 if joints == "pd" else 0
    )  # pd starts with a jerk that the trapezoids of the work do not resolve
    np.testing.assert_allclose(
        lost[first:], lost[first], rtol=0, atol=1e-4 * np.max(trial.work[:, 1])
    )


@settings(max_examples=5, deadline=None)
@given(st.integers(1, 4), st.floats(0.01, 100.0), st.floats(0.0, 0.3), st.integers(0, 2**32 - 1))
def test_a_fin_let_go_loses_energy_to_drag_and_damping_only(n, rigidity, damping, seed):
    robot = fitted(
        opening="closed", n_hinges=n, flexural_rigidity=rigidity, bending_damping=damping
    )
    still = lc.lateral_undulation(amplitude=0.0, frequency=1.0, phase_shift=0.0)
    first = lc.swim(robot, still, duration=1e-3, environment=WATER, sample_interval=1e-3)
    joints = (first.state["planar"].size - rows.LOG_STATE) // 2
    state = first.state["planar"].copy()
    state[-joints:][:n] = np.random.default_rng(seed).uniform(-5.0, 5.0, n)
    plant = lc.build_plant(robot, WATER, dt=1e-3)
    trial = lc.resume(plant, replace(first, state={"planar": state}), 1.0, sample_interval=0.02)
    left = energy(trial, WATER)
    assert np.all(np.diff(left) < 1e-9 * left[0])
    assert left[-1] < 0.5 * left[0]


# ---- limits, stability and symmetry --------------------------------------------------------------


@pytest.mark.parametrize("n", [1, 3, 6])
def test_a_very_stiff_fin_swims_like_a_rigid_one(n):
    rigid = lc.swim(fitted(n_strips=32), GAIT)
    stiff = lc.swim(fitted(n_strips=32, n_hinges=n, flexural_rigidity=1e5), GAIT)
    assert stiff.forward_velocity == pytest.approx(rigid.forward_velocity, rel=1e-4)
    assert stiff.mean_power == pytest.approx(rigid.mean_power, rel=1e-3)
    assert np.abs(stiff.fin_angle).max() < 1e-4


@settings(max_examples=8, deadline=None)
@given(
    st.integers(1, 6),
    st.floats(-6.0, 6.0),
    st.sampled_from(["prescribed", "pd", "servo"]),
    st.sampled_from(["open", "closed"]),
)
def test_at_the_default_step_every_stiffness_is_stable(n, exponent, joints, opening):
    robot = fitted(n_hinges=n, flexural_rigidity=10.0**exponent, opening=opening)
    trial = lc.swim(robot, GAIT, duration=6.0, joints=joints)
    assert trial.succeeded
    assert 0.01 < trial.forward_velocity < 0.4


def test_a_limp_fin_pushes_no_more_than_none():
    limp = lc.swim(fitted(n_hinges=4, flexural_rigidity=1e-6), GAIT).forward_velocity
    assert (
        limp
        < lc.swim(load_robot("mamba"), GAIT).forward_velocity
        < lc.swim(RIGID, GAIT).forward_velocity
    )


@pytest.mark.parametrize("name", ROBOTS)
def test_the_mirrored_gait_swims_the_mirrored_path(name):
    robot, gait = ROBOTS[name]
    wave = gait.fin and replace(gait.fin, phase=gait.fin.phase + np.pi, offset=-gait.fin.offset)
    mirrored = lc.custom_gait(
        envelope=lambda i, n: -1.0,
        n_links=9,
        amplitude=GAIT.amplitude,
        frequency=GAIT.frequency,
        phase_shift=GAIT.phase_shift,
    )
    left = lc.swim(robot, replace(mirrored, fin=wave), duration=5.0)
    right = lc.swim(robot, gait, duration=5.0)
    np.testing.assert_allclose(left.center_of_mass, right.center_of_mass * [1.0, -1.0], atol=1e-10)
    np.testing.assert_allclose(left.fin_angle, -right.fin_angle, atol=1e-10)


# ---- stepping ------------------------------------------------------------------------------------


def test_an_elastic_fin_behind_prescribed_joints_converges_with_order_three():
    steps = np.array([0.01, 0.005, 0.0025])
    ends = [lc.swim(ELASTIC, GAIT, 4.0, dt=dt, sample_interval=0.4) for dt in (*steps, 3e-4)]
    places = [trial.center_of_mass[-1] for trial in ends]
    errors = [np.linalg.norm(place - places[-1]) for place in places[:-1]]
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(3.0, abs=0.3)
    # The work of prescribed joints has kinks where a power changes its sign.
    np.testing.assert_allclose(ends[0].work[-1], ends[-1].work[-1], rtol=1e-5)


@pytest.mark.parametrize("rigidity", [0.1, 1.0, 100.0])
def test_the_default_step_is_converged(rigidity):
    robot = fitted(n_hinges=3, flexural_rigidity=rigidity)
    usual, fine = lc.swim(robot, GAIT), lc.swim(robot, GAIT, dt=5e-4)
    gap = np.linalg.norm(usual.center_of_mass[-1] - fine.center_of_mass[-1])
    assert 0.005 < usual.settings["dt"] <= 0.01
    assert gap < 1e-5 * np.linalg.norm(fine.center_of_mass[-1])
    assert usual.mean_power == pytest.approx(fine.mean_power, rel=1e-4)


@pytest.mark.parametrize("joints", ["prescribed", "servo"])
@pytest.mark.parametrize("name", ROBOTS)
def test_a_run_cut_in_the_middle_and_resumed_is_the_same_run(name, joints):
    robot, gait = ROBOTS[name]
    whole = lc.swim(robot, gait, duration=4.0, joints=joints)
    first = lc.swim(robot, gait, duration=2.0, joints=joints)
    both = lc.joined(
        first, lc.resume(lc.build_plant(robot, first.environment, joints=joints), first, 2.0)
    )
    for figure in ("center_of_mass", "joint_torque", "work", "fin_angle"):
        np.testing.assert_array_equal(getattr(both, figure), getattr(whole, figure))


@pytest.mark.parametrize("name", ROBOTS)
def test_a_batch_gives_what_single_trials_give(name):
    robot, gait = ROBOTS[name]
    gaits = [replace(gait, amplitude=amplitude) for amplitude in (0.3, 0.5, 0.6)]
    many = lc.swim_many(robot, gaits, 15.0)
    alone = [lc.swim(robot, gait, 15.0) for gait in gaits]
    np.testing.assert_allclose(
        many.forward_velocity, [t.forward_velocity for t in alone], rtol=1e-10
    )
    np.testing.assert_allclose(many.mean_power, [t.mean_power for t in alone], rtol=1e-10)


def test_sensitivities_to_the_stiffness_are_those_of_differences():
    names = ["robot.caudal_fin.flexural_rigidity", "robot.caudal_fin.bending_damping"]
    robot = fitted(n_hinges=3, flexural_rigidity=1.0, bending_damping=0.05)
    found = compute_sensitivities(robot, GAIT, 20.0, names=names)
    for i, (name, value) in enumerate(zip(names, (1.0, 0.05), strict=True)):
        step = 1e-5 * value
        plus, minus = (
            lc.swim(
                fitted(robot, **{name.rsplit(".", 1)[-1]: value + sign * step}), GAIT, 20.0
            ).forward_velocity
            for sign in (1.0, -1.0)
        )
        assert found.of("forward_velocity", name)[0] == pytest.approx(
            (plus - minus) / (2.0 * step), rel=1e-5
        ), i


# ---- the driven fin ------------------------------------------------------------------------------


def test_a_driven_fin_follows_its_own_wave_and_its_power_counts():
    trial = lc.swim(DRIVEN, replace(GAIT, fin=WAVE), 20.0)
    late = trial.time > 5.0
    np.testing.assert_allclose(
        trial.fin_angle[late, 0],
        WAVE.offset + WAVE.amplitude * np.sin(WAVE.frequency * trial.time[late] + WAVE.phase),
        atol=1e-8,
    )
    np.testing.assert_array_equal(trial.signals["fin_angle_ref"], trial.fin_angle[:, 0])
    assert trial.settings["dt"] == 0.05  # nothing is free: the explicit method
    own = trial.signals["fin_torque"] * trial.signals["fin_rate_0"]
    body = np.sum(trial.joint_torque * trial.joint_rate, axis=1)
    dense = lc.swim(DRIVEN, replace(GAIT, fin=WAVE), 20.0, sample_interval=0.01)
    own = dense.signals["fin_torque"] * dense.signals["fin_rate_0"]
    body = np.sum(dense.joint_torque * dense.joint_rate, axis=1)
    assert np.trapezoid(own + body, dense.time) == pytest.approx(dense.work[-1, 1], rel=1e-3)
    assert abs(np.trapezoid(own, dense.time)) > 0.01 * dense.work[-1, 1]


def test_without_a_wave_a_driven_fin_stays_straight_and_steering_leaves_it_alone():
    still = lc.swim(DRIVEN, replace(GAIT, offset=0.1), 10.0)
    rigid = lc.swim(RIGID, replace(GAIT, offset=0.1), 10.0)
    assert not np.any(still.fin_angle)
    np.testing.assert_allclose(still.center_of_mass, rigid.center_of_mass, atol=1e-10)


@pytest.mark.usefixtures("limit_case")
def test_a_weak_servo_does_not_reach_what_is_asked_of_the_fin():
    asked = replace(GAIT, fin=lc.Wave(amplitude=1.0, frequency=4.0))
    missed = []
    for torque in (0.3, 20.0):
        joint = Joint()
        robot = fitted(joint=replace(joint, actuator=replace(joint.actuator, stall_torque=torque)))
        trial = lc.swim(robot, asked, 10.0, joints="servo")
        braking = (
            1.0 + np.abs(trial.signals["fin_rate_0"]) / joint.actuator.no_load_speed
        )  # adds to what stalls it
        assert np.all(np.abs(trial.signals["fin_torque"]) <= torque * braking * (1.0 + 1e-9))
        missed.append(
            np.abs(trial.fin_angle[:, 0] - trial.signals["fin_angle_ref"])[trial.time > 5.0].max()
        )
    assert missed[0] > 3.0 * missed[1]


@pytest.mark.parametrize("robot", [RIGID, ELASTIC, load_robot("mamba")])
def test_a_wave_for_a_fin_that_nothing_drives_is_refused(robot):
    with pytest.raises(
        ValueError, match=r"`gait.fin` must be None unless the fin is driven \(`caudal_fin.joint`\)"
    ):
        lc.swim(robot, replace(GAIT, fin=WAVE), 1.0)


def test_a_phase_shift_of_the_fins_wave_is_refused():
    with pytest.raises(
        ValueError, match=r"`fin.phase_shift` must be 0: a fin has one joint, got 0\.5 rad\."
    ):
        replace(GAIT, fin=replace(WAVE, phase_shift=0.5))


# ---- around a run --------------------------------------------------------------------------------


def test_fin_joints_are_signals_and_no_columns_of_the_body(tmp_path):
    trial = lc.swim(BOTH, replace(GAIT, fin=WAVE), 3.0)
    assert trial.joint_angle.shape[1] == 8 and trial.link_angle.shape[1] == 9
    assert trial.fin_angle.shape == (trial.time.size, 3)
    trial.save(tmp_path / "run.nc")
    again = lc.load_trial(tmp_path / "run.nc")
    assert again.gait == trial.gait and again.robot == trial.robot
    np.testing.assert_array_equal(again.fin_angle, trial.fin_angle)


def test_the_center_of_mass_is_that_of_the_bent_robot():
    trial = lc.swim(BOTH, replace(GAIT, fin=WAVE), 5.0, sample_interval=0.005)
    from laticauda.robot import kinematics

    posture = kinematics.Posture(
        trial.robot, trial.center_of_mass, trial.link_angle, trial.fin_angle
    )
    marker = posture.link_centers[:, 4]
    back = kinematics.center_of_mass(
        trial.robot, marker, trial.link_angle, link=4, fin_angle=trial.fin_angle
    )
    np.testing.assert_allclose(back, trial.center_of_mass, atol=1e-12)


@pytest.mark.parametrize("joints", ["prescribed", "pd"])
def test_the_torque_of_a_locked_root_is_that_of_the_state(joints):
    plant = lc.build_plant(ELASTIC, WATER, model="planar", joints=joints)
    layout = plant.layout
    n_joints, root = layout.n_joints, layout.tail_link
    assert layout.law[root] == rows.LOCKED
    assert 0 not in plant.robot.fin_joints  # no `Samples` show the torque of the root
    place = sample_format.place_of(rows.TORQUE)
    column = sample_format.column_of_joint(place, root - 1, n_joints)
    command = lc.Command(gait=GAIT)
    differences = []
    for dt in (0.002, 0.001):
        n_steps = round(1.5 / dt)
        end, samples = plant._run(plant.init(lc.Start(), command), command, 1, n_steps, dt)
        state = PlantState(values=end)
        no_time = 1e-12
        _, sample = plant._run(state, command, 1, 1, no_time)
        differences.append(samples[-1, column] - sample[0, column])
    assert differences == [0.0, 0.0]
