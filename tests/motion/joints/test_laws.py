import numpy as np
import pytest
from derivatives import by_differences, check_compiled, check_complex_steps
from hypothesis import assume, given, strategies as st

from laticauda.motion import joints as actuation
from laticauda.motion.joints import Drive, motor_power
from laticauda.motion.joints.laws import joint_powers, servo_power
from laticauda.robot import Actuator

angles = st.floats(-1.5, 1.5)
rates = st.floats(-10.0, 10.0)
positive = st.floats(0.1, 10.0)
frictions = st.floats(0.0, 1.0)

ANGLE, RATE = 0, 1
STALL, SPEED = 2.9, 7.5

published, servo_of = actuation.PD.__call__, actuation.servo


def pd(angle, rate, reference, reference_rate, acceleration, k_p, k_d):
    drive = Drive(k_p, k_d, 0.0, 0.0, 0.0, 0.0, 0.0)
    return published(0.0, angle, rate, reference, reference_rate, acceleration, drive)


def servo(
    angle, rate, reference, gain, stall_torque, no_load_speed, friction_torque, viscous_friction
):
    drive = Drive(0.0, 0.0, gain, stall_torque, no_load_speed, friction_torque, viscous_friction)
    return servo_of(angle, rate, reference, drive)


def mambas(
    angle: float, rate: float, reference: float, **friction: float
) -> tuple[float, float, float, float]:
    dry = {"friction_torque": 0.0, "viscous_friction": 0.0, **friction}
    return servo(angle, rate, reference, 5.7, STALL, SPEED, **dry)


# --- pd -------------------------------------------------------------------------------------------


def test_the_pd_law_is_the_published_one():
    assert pd(0.1, 0.2, 0.3, 0.5, 0.7, 20.0, 5.0)[0] == pytest.approx(0.7 + 5.0 * 0.3 + 20.0 * 0.2)


@given(angles, rates, rates, positive, positive)
def test_a_joint_that_follows_its_reference_gets_the_feed_forward_alone(
    angle: float, rate: float, acceleration: float, k_p: float, k_d: float
):
    assert pd(angle, rate, angle, rate, acceleration, k_p, k_d)[0] == acceleration


@given(st.tuples(angles, rates, angles, rates, rates, positive, positive))
def test_the_slopes_of_the_pd_law_are_its_derivatives(arguments: tuple[float, ...]):
    _, stiffness, damping = pd(*arguments)
    assert stiffness == pytest.approx(-by_differences(pd, arguments, ANGLE)[0], abs=1e-8)
    assert damping == pytest.approx(-by_differences(pd, arguments, RATE)[0], abs=1e-8)


# --- servo ----------------------------------------------------------------------------------------


def test_a_servo_stalls_at_its_stall_torque_and_stops_pulling_at_its_no_load_speed():
    for side in (1.0, -1.0):
        assert mambas(0.0, 0.0, side)[0] == pytest.approx(side * STALL)
        assert mambas(0.0, side * SPEED, side)[0] == pytest.approx(0.0, abs=1e-12)
        assert side * mambas(0.0, side * 1.2 * SPEED, side)[0] < 0.0


@given(angles, angles, rates, frictions, frictions)
def test_a_servo_at_work_never_exceeds_its_stall_torque_nor_its_no_load_speed(
    angle: float, reference: float, rate: float, dry: float, viscous: float
):
    torque, _, _, duty = mambas(
        angle, rate, reference, friction_torque=dry, viscous_friction=viscous
    )
    assert -1.0 <= duty <= 1.0
    if torque * rate > 0.0:
        assert abs(torque) <= STALL
        assert abs(rate) < SPEED


@given(angles, rates, angles, frictions, frictions)
def test_a_servo_is_the_same_to_both_sides(
    angle: float, rate: float, reference: float, dry: float, viscous: float
):
    friction = {"friction_torque": dry, "viscous_friction": viscous}
    torque, stiffness, damping, duty = mambas(angle, rate, reference, **friction)
    assert mambas(-angle, -rate, -reference, **friction) == (-torque, stiffness, damping, -duty)


@given(angles, rates, frictions, frictions)
def test_a_servo_that_is_where_it_should_be_only_brakes(
    angle: float, rate: float, dry: float, viscous: float
):
    torque = mambas(angle, rate, angle, friction_torque=dry, viscous_friction=viscous)[0]
    assert torque * rate <= 0.0


@given(rates, frictions, frictions)
def test_friction_takes_torque_away_from_motion_and_is_zero_at_rest(
    rate: float, dry: float, viscous: float
):
    lost = (
        mambas(0.0, rate, 0.1)[0]
        - mambas(0.0, rate, 0.1, friction_torque=dry, viscous_friction=viscous)[0]
    )
    assert lost * rate >= 0.0
    assert abs(lost) <= dry + viscous * abs(rate) + 1e-12
    if abs(rate) > 0.5:
        assert lost == pytest.approx(np.sign(rate) * (dry + viscous * abs(rate)), abs=1e-8)


@given(st.tuples(angles, rates, angles, positive, positive, positive, frictions, frictions))
def test_the_slopes_of_the_servo_are_its_derivatives(arguments: tuple[float, ...]):
    demand = arguments[3] * (arguments[2] - arguments[0])
    assume(abs(abs(demand) - 1.0) > 0.01)
    _, stiffness, damping, _ = servo(*arguments)
    assert stiffness == pytest.approx(-by_differences(servo, arguments, ANGLE)[0], abs=1e-6)
    assert damping == pytest.approx(-by_differences(servo, arguments, RATE, step=1e-5)[0], abs=1e-6)
    assert (stiffness == 0.0) == (abs(demand) > 1.0)


# --- power ----------------------------------------------------------------------------------------


@given(angles, rates, angles, positive, positive, positive, frictions, frictions)
def test_the_power_is_the_supply_times_the_current_for_the_share_of_time_that_the_servo_is_on(
    angle: float,
    rate: float,
    reference: float,
    gain: float,
    stall: float,
    speed: float,
    dry: float,
    viscous: float,
):
    assume(stall > 0.01 and speed > 0.01)
    torque, _, _, duty = servo(angle, rate, reference, gain, stall, speed, dry, viscous)
    expected = 34.0 * max(duty * (duty - rate / speed), 0.0)
    scale = 34.0 * (1.0 + (abs(rate) / speed) ** 2 + ((dry + viscous * abs(rate)) / stall) ** 2)
    assert motor_power(torque, rate, stall, speed, dry, viscous, 34.0) == pytest.approx(
        expected, abs=1e-11 * scale
    )
    assert servo_power(angle, rate, reference, gain, speed, 34.0) == pytest.approx(expected)


@given(st.floats(-5.0, 5.0), rates, positive, positive, frictions, frictions, st.floats(1.0, 5.0))
def test_a_motor_draws_at_least_what_it_delivers_and_never_gives_energy_back(
    torque: float, rate: float, stall: float, speed: float, dry: float, viscous: float, loss: float
):
    assume(stall > 0.01 and speed > 0.01)
    power = motor_power(torque, rate, stall, speed, dry, viscous, loss * stall * speed)
    assert power >= 0.0
    assert power >= torque * rate * (1.0 - 1e-9) - 1e-12


def test_a_motor_draws_its_stall_power_when_blocked_and_nothing_without_torque_or_when_it_is_driven():
    stall = 2.9
    for torque, rate, expected in (
        (stall, 0.0, 34.0),
        (-stall, 0.0, 34.0),
        (0.5 * stall, 0.0, 8.5),
        (0.0, SPEED, 0.0),
        (0.0, 3.0, 0.0),
        (-0.1 * stall, 0.6 * SPEED, 0.0),
    ):
        assert motor_power(torque, rate, stall, SPEED, 0.0, 0.0, 34.0) == pytest.approx(
            expected, abs=1e-12
        )


def test_powers_are_the_size_the_signed_and_the_positive_one():
    assert joint_powers(2.0, -3.0) == (6.0, -6.0, 0.0)
    assert joint_powers(2.0, 3.0) == (6.0, 6.0, 6.0)


def test_mambas_servo_does_not_create_energy():
    actuator = Actuator()
    assert (
        actuator.voltage * actuator.stall_current >= actuator.stall_torque * actuator.no_load_speed
    )


# --- derivatives and compilation ------------------------------------------------------------------


@given(st.tuples(angles, rates, angles, rates, rates, positive, positive))
def test_every_derivative_of_the_pd_law_by_complex_step_is_that_by_differences(
    arguments: tuple[float, ...],
):
    check_complex_steps(pd, arguments)


@given(
    st.tuples(
        angles, st.floats(-0.2, 0.2), angles, positive, positive, positive, frictions, frictions
    )
)
def test_every_derivative_of_the_servo_by_complex_step_is_that_by_differences(
    arguments: tuple[float, ...],
):
    assume(abs(abs(arguments[3] * (arguments[2] - arguments[0])) - 1.0) > 0.01)
    check_complex_steps(servo, arguments)


@given(
    st.tuples(
        st.floats(-5.0, 5.0),
        st.floats(-0.2, 0.2),
        *[st.floats(0.3, 5.0)] * 2,
        *[frictions] * 2,
        positive,
    )
)
def test_every_derivative_of_the_motors_power_by_complex_step_is_that_by_differences(
    arguments: tuple[float, ...],
):
    torque, rate, stall, speed, dry, viscous, _ = arguments
    current = (torque + viscous * rate + dry * np.tanh(rate / 0.05)) / stall
    assume(abs(current * (current + rate / speed)) > 0.02 and abs(current) > 0.01)
    check_complex_steps(motor_power, arguments)


@pytest.mark.parametrize(
    ("law", "arguments"),
    [
        (pd, (0.1, 0.2, 0.3, 0.5, 0.7, 20.0, 5.0)),
        (servo, (0.1, 0.2, 0.15, 5.7, 2.9, 7.5, 0.1, 0.05)),
        (servo, (0.1, 0.2, 0.9, 5.7, 2.9, 7.5, 0.1, 0.05)),
        (servo, (0.1, 0.2, -0.9, 5.7, 2.9, 7.5, 0.1, 0.05)),
        (motor_power, (0.3, 0.2, 2.9, 7.5, 0.1, 0.05, 34.0)),
        (motor_power, (-0.3, 7.2, 2.9, 7.5, 0.0, 0.0, 34.0)),
    ],
)
def test_the_laws_compile_for_real_and_for_complex_numbers(
    law: object, arguments: tuple[float, ...]
):
    check_compiled(law, arguments)  # pyright: ignore[reportArgumentType]
