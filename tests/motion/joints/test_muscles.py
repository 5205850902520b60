"""Muscles: their laws, their slopes, and a robot that swims by them, in both models."""

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

import laticauda as lc
from laticauda.motion.joints import Drive, Ekeberg, Hill, laws
from laticauda.values import value_class

ON = Drive(1.0, 1.0, 1.0, 10.0, 5.0, 0.0, 0.0)
OFF = Drive(0.0, 0.0, 0.0, 0.0, 5.0, 0.0, 0.0)
LAWS = (Ekeberg(), Hill())
GAIT = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40)


@value_class
class _NotSaidToBeLinear(Ekeberg):
    """Ekeberg's muscles, of which the kernels do not know that they are linear."""


@value_class
class _Stiffening(Ekeberg):
    """Ekeberg's muscles that stiffen as they bend."""

    def __call__(self, angle, rate, *others):
        """Return the torque and its slopes."""
        u, stiffness, damping = super().__call__(angle, rate, *others)
        return u - 30.0 * angle**3, stiffness + 90.0 * angle**2, damping


ANGLES = st.floats(-1.0, 1.0)
RATES = st.floats(-6.0, 6.0)


def torque(law, angle, rate, reference, drive=ON):
    return law(angle, rate, reference, 0.0, 0.0, drive)


@pytest.mark.parametrize("law", LAWS)
@given(ANGLES, RATES, ANGLES)
def test_left_and_right_are_alike(law, angle, rate, reference):
    to_left, *slopes = torque(law, angle, rate, reference)
    to_right, *mirrored_slopes = torque(law, -angle, -rate, -reference)
    assert to_left == pytest.approx(-to_right, abs=1e-12)
    assert slopes == pytest.approx(mirrored_slopes)


@pytest.mark.parametrize("law", LAWS)
@given(ANGLES, RATES)
def test_without_activation_a_joint_only_takes_energy_from_its_motion(law, angle, rate):
    u, stiffness, _ = torque(law, angle, rate, 0.5, OFF)
    elastic = -stiffness * angle
    assert (u - elastic) * rate <= 1e-12


@pytest.mark.parametrize("law", LAWS)
@given(ANGLES, st.floats(0.1, 6.0), ANGLES)
def test_the_damping_is_the_slope_over_the_rate(law, angle, rate, reference):
    step = 1e-6
    if abs(rate * 0.05 / 0.75 - 1.0) < 1e-3:
        return  # the kink at the largest speed
    slope = (
        torque(law, angle, rate - step, reference)[0]
        - torque(law, angle, rate + step, reference)[0]
    ) / (2.0 * step)
    assert torque(law, angle, rate, reference)[2] == pytest.approx(slope, rel=1e-5, abs=1e-6)


def test_a_muscle_that_shortens_at_its_largest_speed_has_no_force():
    law = Hill(tone=0.0, passive_damping=0.0, passive_stiffness=0.0)
    fastest = law.largest_speed * law.fiber_length / law.lever
    assert torque(law, 0.0, fastest, 1.0)[0] == pytest.approx(0.0, abs=1e-12)
    assert torque(law, 0.0, 0.0, 1.0)[0] == pytest.approx(law.force * law.lever)
    assert torque(law, 0.0, -fastest, 1.0)[0] == pytest.approx(1.5 * law.force * law.lever)


def test_tone_makes_a_joint_stiffer_and_the_stroke_smaller():
    gait = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40)
    strokes = []
    for tone in (0.0, 0.4, 0.8):
        trial = lc.swim("mamba", gait, 10.0, joints=Ekeberg(tone=tone, gain=0.3))
        strokes.append(np.abs(trial.joint_angle[100:]).max())
    assert strokes[0] > strokes[1] > strokes[2]


@pytest.mark.parametrize("law", LAWS)
def test_muscles_swim_alike_in_both_models(law):
    pytest.importorskip("mujoco")
    gait = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40)
    in_plane = lc.swim("mamba", gait, 6.0, joints=law)
    in_space = lc.swim("mamba", gait, 6.0, joints=law, model="spatial")
    assert in_plane.forward_velocity > 0.02
    assert in_space.forward_velocity == pytest.approx(in_plane.forward_velocity, rel=2e-3)
    assert math.degrees(np.abs(in_plane.joint_angle).max()) < 60.0


def test_a_linear_law_swims_as_if_the_kernels_had_to_find_its_tangents():
    linear = lc.swim("mamba", GAIT, 2.0, joints=Ekeberg())
    found = lc.swim("mamba", GAIT, 2.0, joints=_NotSaidToBeLinear())
    assert linear.center_of_mass == pytest.approx(found.center_of_mass, rel=1e-7, abs=1e-9)
    assert linear.joint_torque == pytest.approx(found.joint_torque, rel=1e-6, abs=1e-7)


def test_a_law_that_is_derived_from_a_linear_one_is_not_taken_for_linear():
    assert Ekeberg().code == laws.OWN_LINEAR
    assert _Stiffening().code == laws.OWN_DRIVEN
