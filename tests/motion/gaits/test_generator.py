from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import laticauda as lc
from laticauda.motion.gaits import (
    Gait,
    Generator,
    GeneratorState,
    custom_gait,
    eel_like,
    envelope_of,
    lateral_undulation,
)

WAVE: dict[str, Any] = {"amplitude": 0.5, "frequency": 2.0, "phase_shift": 0.7}

gaits = st.builds(
    Gait,
    amplitude=st.floats(0.0, 1.0),
    frequency=st.floats(0.0, 4.0),
    phase_shift=st.floats(-1.5, 1.5),
    offset=st.floats(-0.5, 0.5),
)
times = st.floats(0.0, 5.0)


def go(generator: Generator, gait: Gait, time: float) -> GeneratorState:
    return generator.step(generator.init(gait), gait, time)


# --- what it generates ----------------------------------------------------------------------------


@given(gaits, st.floats(6.0, 60.0), st.sampled_from(["lateral_undulation", "eel_like"]))
def test_once_settled_the_joints_follow_the_papers_gait(gait: Gait, time: float, kind: str):
    n = 7
    gait = replace(gait, envelope=envelope_of(kind))
    angle, rate, acceleration = Generator(n_links=n).joints(
        go(Generator(n_links=n), gait, time), gait
    )
    i = np.arange(1, n)
    g = np.ones(n - 1) if kind == "lateral_undulation" else (n - i) / (n + 1)
    psi = gait.frequency * time + (i - 1) * gait.phase_shift
    np.testing.assert_allclose(angle, gait.amplitude * g * np.sin(psi) + gait.offset, atol=1e-9)
    np.testing.assert_allclose(rate, gait.amplitude * g * gait.frequency * np.cos(psi), atol=1e-9)
    np.testing.assert_allclose(
        acceleration, -gait.amplitude * g * gait.frequency**2 * np.sin(psi), atol=1e-9
    )


@given(gaits)
def test_with_the_smooth_start_every_joint_begins_straight_and_at_rest(gait: Gait):
    generator = Generator(n_links=6)
    angle, rate, acceleration = generator.joints(generator.init(gait), gait)
    assert not angle.any() and not rate.any()
    np.testing.assert_allclose(
        acceleration, 100.0 * gait.offset
    )  # the offset's filter alone is under way


@given(gaits, gaits, times, st.floats(0.0, 2.0), st.integers(1, 7))
def test_the_step_does_not_matter(first: Gait, then: Gait, before: float, after: float, n: int):
    generator = Generator(n_links=5)
    state = go(generator, first, before)
    once = generator.step(state, then, after)
    for _ in range(n):
        state = generator.step(state, then, after / n)
    np.testing.assert_allclose(
        generator.joints(state, then), generator.joints(once, then), atol=1e-8
    )


@given(gaits, gaits, times)
def test_the_phase_is_the_integral_of_the_frequency(first: Gait, then: Gait, before: float):
    generator = Generator(n_links=5)
    start = go(generator, first, before)
    t, weight = np.polynomial.legendre.leggauss(40)
    frequency = [generator.step(start, then, 0.5 * (1.0 + ti)).yaw.frequency for ti in t]
    turned = generator.step(start, then, 1.0).yaw.phase - start.yaw.phase
    assert turned == pytest.approx(0.5 * np.sum(weight * frequency), abs=1e-10)


@given(gaits, gaits, times, st.floats(0.01, 1.0))
def test_rates_and_accelerations_are_the_derivatives_also_while_the_gait_changes(
    first: Gait, then: Gait, before: float, after: float
):
    generator = Generator(n_links=5, ramp=2.0)
    start = go(generator, first, before)
    h = 1e-4
    a, b, c = (
        generator.joints(generator.step(start, then, after + dt), then) for dt in (-h, 0.0, h)
    )
    np.testing.assert_allclose(b[1], (c[0] - a[0]) / (2.0 * h), atol=1e-3)
    np.testing.assert_allclose(b[2], (c[1] - a[1]) / (2.0 * h), atol=2e-2)


# --- live changes ---------------------------------------------------------------------------------


@given(gaits, gaits, times)
def test_whatever_is_asked_for_angles_and_rates_do_not_jump(first: Gait, then: Gait, before: float):
    generator = Generator(n_links=5)
    state = go(generator, first, before)
    np.testing.assert_array_equal(
        generator.joints(state, then)[:2], generator.joints(state, first)[:2]
    )
    soon = generator.joints(generator.step(state, then, 1e-7), then)
    np.testing.assert_allclose(soon[:2], generator.joints(state, then)[:2], atol=1e-4)


@given(gaits, gaits)
def test_after_a_change_the_new_gait_is_reached(first: Gait, then: Gait):
    generator = Generator(n_links=5)
    state = generator.step(go(generator, first, 3.0), then, 5.0)
    for name in ("amplitude", "frequency", "phase_shift", "offset"):
        value, rate = getattr(state.yaw, name), getattr(state.yaw, f"{name}_rate")
        assert (value, rate) == (
            pytest.approx(getattr(then, name), abs=1e-9),
            pytest.approx(0.0, abs=1e-9),
        )


def test_the_envelope_is_not_filtered_but_at_amplitude_zero_it_may_change():
    generator = Generator(n_links=5)
    undulating, eel = lateral_undulation(**WAVE), eel_like(**WAVE)
    state = go(generator, undulating, 3.3)
    assert (
        np.abs(generator.joints(state, eel)[0] - generator.joints(state, undulating)[0]).max() > 0.1
    )
    quiet = generator.step(state, replace(undulating, amplitude=0.0), 5.0)
    np.testing.assert_allclose(
        generator.joints(quiet, eel)[:2], generator.joints(quiet, undulating)[:2], atol=1e-15
    )


def test_a_larger_bandwidth_follows_faster():
    still, steered = lateral_undulation(**WAVE), lateral_undulation(**WAVE, offset=0.3)
    offsets: list[float] = []
    for bandwidth in (1.0, 10.0, 100.0):
        generator = Generator(n_links=5, bandwidth=bandwidth)
        offsets.append(generator.step(go(generator, still, 2.0), steered, 0.1).yaw.offset)
    assert offsets == sorted(offsets)
    assert offsets[-1] == pytest.approx(0.3, rel=1e-2)


# --- the same as in the kernels -------------------------------------------------------------------


@pytest.mark.parametrize(
    ("robot", "gait"),
    [
        ("mamba", lateral_undulation(amplitude=0.5236, frequency=2.2689, phase_shift=0.6981)),
        ("mamba-fin", eel_like(amplitude=0.5236, frequency=2.2689, phase_shift=0.6981, offset=0.2)),
        ("mamba", custom_gait(envelope=lambda i, n: i / n, n_links=9, **WAVE, offset=-0.1)),
    ],
)
def test_prescribed_joints_are_where_the_generator_says(robot: str, gait: Gait):
    trial = lc.swim(lc.load_robot(robot), gait, duration=10.0, sample_interval=0.25)
    generator = Generator(n_links=9)
    found = np.array([generator.joints(go(generator, gait, t), gait) for t in trial.time])
    np.testing.assert_allclose(trial.joint_angle, found[:, 0], rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(trial.joint_rate, found[:, 1], rtol=0.0, atol=1e-12)


@settings(max_examples=10)
@given(
    gaits,
    gaits,
    st.sampled_from(["prescribed", "pd"]),
    st.floats(2.0, 20.0),
    st.sampled_from([0.0, 0.7, 2.0]),
)
def test_a_plant_follows_a_change_of_gait_like_the_generator(
    first: Gait, then: Gait, joints: str, bandwidth: float, ramp: float
):
    robot = lc.load_robot("mamba")
    generator = Generator(n_links=robot.n_links, bandwidth=bandwidth, ramp=ramp)
    plant: Any = lc.build_plant(
        robot, lc.load_water("paper-lateral"), joints=joints, offset_bandwidth=bandwidth, ramp=ramp
    )
    command = lc.Command(gait=first)
    body, _, _ = plant.march(plant.init(lc.Start(), command), command, 1.5, 1.5)
    _, log, _ = plant.march(
        body, lc.Command(gait=replace(then, offset=0.0), offset=then.offset), 1.0, 0.1
    )
    state = go(generator, first, 1.5)
    expected = [generator.joints(generator.step(state, then, t - 1.5), then)[0] for t in log.time]
    np.testing.assert_allclose(log.joint_angle_ref, expected, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("joints", ["prescribed", "servo"])
def test_in_space_pitch_joints_and_a_driven_fin_follow_the_waves_that_the_generator_says(
    joints: str,
):
    robot = lc.load_robot("mamba-modules-fin")
    assert robot.caudal_fin is not None
    robot = replace(robot, caudal_fin=replace(robot.caudal_fin, joint=robot.joints[0]))
    first = replace(
        lateral_undulation(**WAVE),
        pitch=lc.Wave(amplitude=0.1, frequency=2.5, phase_shift=0.6, phase=1.5, offset=0.01),
        fin=lc.Wave(amplitude=0.2, frequency=3.0, phase=0.4, offset=0.02),
    )
    assert first.pitch is not None and first.fin is not None
    then = replace(
        first, pitch=replace(first.pitch, amplitude=0.2), fin=replace(first.fin, frequency=2.0)
    )
    plant: Any = lc.build_plant(
        robot, lc.load_water("paper-lateral"), "spatial", joints=joints, ramp=0.7
    )
    body, _, _ = plant.march(
        plant.init(lc.Start(), lc.Command(gait=first)), lc.Command(gait=first), 0.5, 0.5
    )
    _, log, _ = plant.march(body, lc.Command(gait=then, pitch_offset=0.05), 0.5, 0.1)
    generator = Generator(
        n_links=robot.n_links, axes=tuple(joint.axis for joint in robot.joints), ramp=0.7
    )
    state, steered = go(generator, first, 0.5), lc.Command(gait=then, pitch_offset=0.05).steered
    states = [generator.step(state, steered, t - 0.5) for t in log.time]
    expected = [generator.joints(one, steered)[0] for one in states]
    np.testing.assert_allclose(log.joint_angle_ref, expected, rtol=0.0, atol=1e-12)
    fin = [generator.fin(one, steered)[0] for one in states]
    np.testing.assert_allclose(log.signals["fin_angle_ref"], fin, rtol=0.0, atol=1e-12)


# --- bad input ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"bandwidth": 0.0}, r"`bandwidth` must be > 0 rad/s, got 0.0\."),
        ({"bandwidth": float("inf")}, r"`bandwidth` must be a finite number in rad/s, got inf\."),
        ({"ramp": -1.0}, r"`ramp` must be >= 0 s, got -1.0\."),
        ({"axes": ("yaw", "pitch")}, r"`axes` must have one entry per joint, 8, got 2\."),
        ({"n_links": 0}, r"`n_links` must be a whole number >= 1, got 0\."),
    ],
)
def test_a_generator_refuses(changes: dict[str, Any], message: str):
    with pytest.raises(ValueError, match=message):
        Generator(**{"n_links": 9, **changes})


def test_an_envelope_for_another_robot_is_refused():
    generator, gait = Generator(n_links=9), custom_gait(envelope=[1.0, 1.0], **WAVE)
    with pytest.raises(ValueError, match="one value per joint, 8 for 9 links, got 2"):
        generator.joints(generator.init(gait), gait)
