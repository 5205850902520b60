"""A servo with a speed loop: what limits its speed and its torque, and what it becomes with torque to spare."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from derivatives import by_complex_step, check_compiled, check_complex_steps
from hypothesis import assume, given, strategies as st

import laticauda as lc
from laticauda.models.simulate import compute_sensitivities, list_parameters
from laticauda.models.simulate.numbers import change_parameters
from laticauda.motion import joints as actuation
from laticauda.motion.joints import Drive, JointLaw, Servo, SpeedServo, motor_power
from laticauda.robot import Actuator, Joint, load_robot
from laticauda.robot.parameters import adjust
from laticauda.values.codec import decode, encode

angles = st.floats(-1.5, 1.5)
rates = st.floats(-10.0, 10.0)
positive = st.floats(0.1, 10.0)
frictions = st.floats(0.0, 1.0)
everything = st.tuples(
    angles,
    rates,
    angles,
    positive,
    positive,
    st.floats(0.1, 100.0),
    positive,
    positive,
    frictions,
    frictions,
)

LIMIT, STALL, SPEED = 0.7, 2.9, 7.5
GAIT = lc.lateral_undulation(
    amplitude=np.deg2rad(30), frequency=np.deg2rad(130), phase_shift=np.deg2rad(40)
)
SLOW = SpeedServo(speed_limit=LIMIT, position_gain=4.0, speed_gain=20.0)

law_of = actuation.speed_servo


class Loops(NamedTuple):
    """What the law has of its own, complex numbers too."""

    position_gain: float
    speed_limit: float
    speed_gain: float


def speed_servo(
    angle, rate, reference, position_gain, speed_limit, speed_gain, stall, speed, dry, viscous
):
    loops, drive = (
        Loops(position_gain, speed_limit, speed_gain),
        Drive(0.0, 0.0, 0.0, stall, speed, dry, viscous),
    )
    return law_of(angle, rate, reference, loops, drive)


def servo(angle, rate, reference, gain, stall, speed, dry, viscous):
    return actuation.servo(
        angle, rate, reference, Drive(0.0, 0.0, gain, stall, speed, dry, viscous)
    )


def mambas(angle, rate, reference, *, dry=0.0, viscous=0.0):
    return speed_servo(angle, rate, reference, 4.0, LIMIT, 20.0, STALL, SPEED, dry, viscous)


def kink(arguments):
    """How far the rate that is asked for is from its limit."""
    return abs(abs(arguments[3] * (arguments[2] - arguments[0])) - arguments[4])


# --- the formula ----------------------------------------------------------------------------------


@given(everything)
def test_its_slopes_are_its_derivatives_to_rounding(arguments):
    assume(kink(arguments) > 1e-6)
    _, stiffness, damping, _ = speed_servo(*arguments)
    scale = 1.0 + abs(stiffness) + abs(damping) + arguments[6] / arguments[7]
    slopes = [-by_complex_step(speed_servo, arguments, k)[0] for k in (0, 1)]
    assert stiffness == pytest.approx(slopes[0], abs=1e-11 * scale)
    assert damping == pytest.approx(slopes[1], abs=1e-11 * scale)


@given(
    st.tuples(angles, st.floats(-0.2, 0.2), angles, *[st.floats(0.5, 3.0)] * 5, *[frictions] * 2)
)
def test_every_derivative_by_complex_step_is_that_by_differences(arguments):
    assume(kink(arguments) > 0.01)
    check_complex_steps(speed_servo, arguments)


@pytest.mark.parametrize("reference", [0.15, 0.9, -0.9])
def test_it_compiles_for_real_and_for_complex_numbers(reference):
    check_compiled(speed_servo, (0.1, 0.2, reference, 4.0, 0.7, 20.0, 2.9, 7.5, 0.1, 0.05))


@given(angles, rates, angles, frictions, frictions)
def test_it_is_the_same_to_both_sides(angle, rate, reference, dry, viscous):
    torque, stiffness, damping, duty = mambas(angle, rate, reference, dry=dry, viscous=viscous)
    other = mambas(-angle, -rate, -reference, dry=dry, viscous=viscous)
    assert other == (-torque, stiffness, damping, -duty)


@given(everything)
def test_its_torque_stays_within_the_motors_line_and_friction_only_brakes(arguments):
    angle, rate, reference, *loops, stall, speed, _, _ = arguments
    torque = speed_servo(*arguments)[0]
    smooth = speed_servo(angle, rate, reference, *loops, stall, speed, 0.0, 0.0)[0]
    assert (
        abs(smooth + stall * rate / speed)
        <= stall * (1.0 + 1e-12) + 1e-12 * abs(rate) * stall / speed
    )
    assert (torque - smooth) * rate <= 1e-12
    if smooth * rate > 0.0:
        assert abs(rate) < speed


def test_the_torque_at_hand_falls_from_stall_to_nothing_at_the_no_load_speed_and_beyond_it_brakes():
    stiff = {"position_gain": 1e3, "speed_limit": 20.0, "speed_gain": 1e4}
    for rate, torque in (
        (0.0, STALL),
        (0.5 * SPEED, 0.5 * STALL),
        (SPEED, 0.0),
        (1.2 * SPEED, -0.2 * STALL),
    ):
        for side in (1.0, -1.0):
            found = speed_servo(0.0, side * rate, side, *stiff.values(), STALL, SPEED, 0.0, 0.0)[0]
            assert found == pytest.approx(side * torque, abs=1e-6)


@given(angles, rates, angles, frictions, frictions)
def test_with_torque_to_spare_it_is_the_servo_that_imitated_it(
    angle, rate, reference, dry, viscous
):
    imitation = servo(angle, rate, reference, 5.7, 200.0, LIMIT, dry, viscous)
    loops = 5.7 * LIMIT, LIMIT, 200.0 / LIMIT
    own = speed_servo(angle, rate, reference, *loops, 1e12, 1e12, dry, viscous)
    assert own[:3] == pytest.approx(imitation[:3], rel=1e-12, abs=1e-9)


@given(angles, rates, angles, frictions, frictions)
def test_a_motor_that_is_off_leaves_friction(angle, rate, reference, dry, viscous):
    off = speed_servo(angle, rate, reference, 4.0, LIMIT, 20.0, 0.0, SPEED, dry, viscous)
    limp = servo(angle, rate, reference, 0.0, 0.0, SPEED, dry, viscous)
    assert off[:3] == pytest.approx(limp[:3], rel=1e-12, abs=1e-12)


@given(angles, rates, angles, frictions, frictions)
def test_its_duty_is_what_its_power_is_made_of(angle, rate, reference, dry, viscous):
    torque, _, _, duty = mambas(angle, rate, reference, dry=dry, viscous=viscous)
    power = motor_power(torque, rate, STALL, SPEED, dry, viscous, 34.0)
    scale = 1.0 + (abs(rate) / SPEED) ** 2 + ((dry + viscous * abs(rate)) / STALL) ** 2
    assert power == pytest.approx(34.0 * max(duty * (duty - rate / SPEED), 0.0), abs=1e-10 * scale)
    drive = Drive(20.0, 5.0, 5.7, STALL, SPEED, dry, viscous)
    assert SLOW.duty(angle, rate, reference, drive) == pytest.approx(duty, rel=1e-12, abs=1e-15)


# --- in the models --------------------------------------------------------------------------------


def with_motor(robot, **numbers):
    return adjust(load_robot(robot), {"actuator": numbers})


@pytest.mark.usefixtures("limit_case")
@pytest.mark.parametrize("robot", ["mamba-fin", "mamba-modules"])
def test_a_robot_swims_as_with_the_servo_that_imitated_it(robot):
    strong = with_motor(robot, stall_torque=200.0, no_load_speed=LIMIT)
    spare = with_motor(robot, stall_torque=1e6, no_load_speed=1e6)
    law = SpeedServo(speed_limit=LIMIT, position_gain=5.7 * LIMIT, speed_gain=200.0 / LIMIT)
    imitation, own = (
        lc.swim(strong, GAIT, 6.0, joints="servo", dt=0.005),
        lc.swim(spare, GAIT, 6.0, joints=law, dt=0.005),
    )
    np.testing.assert_allclose(own.center_of_mass, imitation.center_of_mass, atol=1e-7)
    np.testing.assert_allclose(own.joint_angle, imitation.joint_angle, atol=1e-7)
    assert own.mean_power_kind == "electrical"


@pytest.mark.usefixtures("limit_case")
def test_its_joints_turn_no_faster_than_their_limit_and_do_what_that_leaves_of_the_gait():
    spare = with_motor("mamba", stall_torque=200.0, no_load_speed=200.0)
    law = SpeedServo(speed_limit=0.708, position_gain=5.7 * 0.708, speed_gain=200.0 / 0.708)
    for frequency, done in ((110, 26.0), (130, 23.0), (150, 21.0)):
        gait = replace(GAIT, frequency=math.radians(frequency))
        trial = lc.swim(spare, gait, 15.0, joints=law)
        late = trial.time > 8.0
        assert np.abs(trial.joint_rate).max() < 0.708 * 1.02
        assert math.degrees(np.abs(trial.joint_angle[late, 4]).max()) == pytest.approx(
            done, abs=1.0
        )


@pytest.mark.usefixtures("limit_case")
def test_a_motor_without_the_torque_slows_it_down():
    weak, strong = (
        lc.swim(with_motor("mamba-fin", stall_torque=u), GAIT, 8.0, joints=SLOW)
        for u in (0.7, 50.0)
    )
    late = weak.time > 4.0
    assert (
        np.ptp(weak.joint_angle[late], axis=0).min()
        < 0.8 * np.ptp(strong.joint_angle[late], axis=0).min()
    )
    assert weak.forward_velocity < 0.9 * strong.forward_velocity
    assert np.abs(weak.joint_torque).max() < 0.7 * (1.0 + 1.0 / 7.5)


def test_a_batch_has_the_figures_of_single_runs_to_rounding_and_a_run_goes_on():
    laws = [replace(SLOW, speed_limit=limit) for limit in (0.4, 0.7, 2.0)]
    scenarios = [lc.build_scenario("mamba-fin", GAIT, 2.0, joints=law) for law in laws]
    singles = [lc.swim(one) for one in scenarios]
    found = lc.swim_many(scenarios).forward_velocity
    np.testing.assert_allclose(found, [one.forward_velocity for one in singles], rtol=1e-14)
    half = replace(scenarios[0], duration=1.0)
    after = lc.resume(lc.build_plant(half), lc.swim(half), 1.0)
    np.testing.assert_array_equal(after.center_of_mass[-1], singles[0].center_of_mass[-1])


def test_the_model_in_space_agrees_with_that_in_the_plane_with_friction_and_skin():
    pytest.importorskip("mujoco")
    rubbing = {"actuator": {"friction_torque": 0.1, "viscous_friction": 0.05}}
    robot = adjust(
        load_robot("mamba-fin"), {**rubbing, "joint": {"stiffness": 0.5, "damping": 0.1}}
    )
    planar = lc.swim(robot, GAIT, 3.0, joints=SLOW, dt=0.001)
    spatial = lc.swim(robot, GAIT, 3.0, joints=SLOW, dt=0.001, model="spatial", root="planar")
    free = lc.swim("mamba-fin", GAIT, 3.0, joints=SLOW, dt=0.001)
    assert np.abs(planar.joint_angle).max() < 0.995 * np.abs(free.joint_angle).max()
    length = np.linalg.norm(planar.center_of_mass[-1])
    np.testing.assert_allclose(
        spatial.center_of_mass[:, :2], planar.center_of_mass, atol=2e-3 * length
    )
    np.testing.assert_allclose(spatial.joint_angle, planar.joint_angle, atol=2e-3)


@pytest.mark.usefixtures("limit_case")
@pytest.mark.parametrize("stall", [1.0, 2.9, 200.0])
def test_its_usual_step_is_converged_with_and_without_torque_to_spare(stall):
    robot = with_motor("mamba-fin", stall_torque=stall)
    coarse, fine = (lc.swim(robot, GAIT, 10.0, joints=SLOW, dt=dt) for dt in (None, 0.0005))
    miss = np.linalg.norm(coarse.center_of_mass[-1] - fine.center_of_mass[-1])
    assert miss < 2e-3 * np.linalg.norm(fine.center_of_mass[-1])


def test_files_sweeps_and_derivatives_know_its_numbers():
    assert decode(JointLaw, encode(SLOW, JointLaw)) == SLOW
    scenario = lc.build_scenario("mamba", GAIT, 3.0, joints=SLOW, dt=0.001)
    known = list_parameters(scenario)
    assert [
        known[f"joints.{name}"].unit for name in ("speed_limit", "position_gain", "speed_gain")
    ] == [
        "rad/s",
        "1/s",
        "N m s/rad",
    ]
    name, step = "joints.speed_gain", 1e-3
    found = compute_sensitivities([scenario], names=[name]).of("forward_velocity", name)[0]
    up, down = lc.swim_many(
        [change_parameters(scenario, {name: 20.0 + one}) for one in (step, -step)]
    ).forward_velocity
    assert found == pytest.approx((up - down) / (2.0 * step), rel=1e-3)


def test_it_is_a_servo_to_whoever_asks_for_one():
    assert isinstance(SLOW, Servo)
    assert "speed-servo" in JointLaw.names()
    assert (
        SLOW.words
        == "speed servo, speed_limit 0.7 rad/s, position_gain 4 1/s, speed_gain 20 N m s/rad"
    )
    assert Joint().actuator == Actuator()
