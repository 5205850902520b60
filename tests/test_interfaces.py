"""References and switches from outside: what a robot on a bus needs, and what both bodies do with them."""

import math

import numpy as np
import pytest

from laticauda import eel_like, load_robot
from laticauda.gaits import Generator
from laticauda.interfaces import Command, Start
from laticauda.robot import load_water
from laticauda.simulate import plant

GAIT = eel_like(amplitude=math.radians(30), frequency=math.radians(120), phase_shift=math.radians(40), offset=0.2)
MODELS = ("planar", "spatial")


def body(model: str, joints: str = "servo"):
    return plant(load_robot("mamba"), load_water("paper-eel"), model=model, joints=joints)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("joints", ["servo", "pd"])
def test_joints_go_to_the_references_that_are_given(model, joints):
    plant_ = body(model, joints)
    references = tuple(0.1 * math.sin(k) for k in range(8))
    state = plant_.init(Start(), Command(gait=GAIT))
    state, log, failure = plant_.march(state, Command(gait=GAIT, references=references), 3.0, 0.5)
    assert failure is None
    np.testing.assert_array_equal(log.joint_angle_ref[1:], np.tile(references, (6, 1)))
    np.testing.assert_allclose(log.joint_angle[-1], references, atol=0.01)


@pytest.mark.parametrize("model", MODELS)
def test_the_generator_from_outside_swims_as_the_one_inside(model):
    plant_ = body(model)
    inside = plant_.init(Start(), Command(gait=GAIT))
    outside, generator, step = inside, Generator(n_links=9, ramp=0.0), 0.01
    thought = generator.init(GAIT)
    for _ in range(100):
        inside = plant_.step(inside, Command(gait=GAIT), step)
        thought = generator.step(thought, GAIT, step)
        angles = generator.joints(thought, GAIT)[0]
        outside = plant_.step(outside, Command(gait=GAIT, references=tuple(angles)), step)
    one, other = plant_.observe(inside), plant_.observe(outside)
    # References that are held for 10 ms are on average 5 ms late or early.
    np.testing.assert_allclose(other.joint_angle, one.joint_angle, atol=0.02)
    np.testing.assert_allclose(other.center_of_mass, one.center_of_mass, atol=0.01)


@pytest.mark.parametrize("model", MODELS)
def test_the_generator_goes_on_where_it_stood(model):
    plant_ = body(model)
    begin = plant_.step(plant_.init(Start(), Command(gait=GAIT)), Command(gait=GAIT), 0.5)
    after = plant_.step(begin, Command(gait=GAIT, references=(0.0,) * 8), 0.1)
    changed = np.flatnonzero(after.values != begin.values)
    # Time, pose and work, and what belongs to the joints, but no row of the generator.
    generator = range(8, 17) if model == "planar" else {*range(2, 11), *range(15, 24)}
    assert changed.size > 0
    assert not set(changed) & set(generator)


@pytest.mark.parametrize("model", MODELS)
def test_joints_that_are_off_do_no_work_and_draw_nothing(model):
    plant_ = body(model)
    command = Command(gait=GAIT, references=(0.5,) * 8, enabled=(False,) * 8)
    _, log, _ = plant_.march(plant_.init(Start(), command), command, 1.0, 0.1)
    assert np.all(log.joint_torque == 0.0)
    assert log.electrical_work[-1] == 0.0


@pytest.mark.parametrize("model", MODELS)
def test_one_joint_that_is_off_leaves_the_others_on(model):
    plant_ = body(model)
    command = Command(gait=GAIT, references=(0.3,) * 8, enabled=(True, True, False, *[True] * 5))
    _, log, _ = plant_.march(plant_.init(Start(), command), command, 1.0, 0.1)
    assert np.all(log.joint_torque[:, 2] == 0.0)
    assert np.all(np.abs(np.delete(log.joint_angle[-1], 2) - 0.3) < 0.05)


@pytest.mark.parametrize("model", MODELS)
def test_what_does_not_fit_is_refused(model):
    plant_ = body(model)
    state = plant_.init(Start(), Command(gait=GAIT))
    with pytest.raises(ValueError, match=r"`references` must have one entry per joint, 8 of them, got 3\."):
        plant_.step(state, Command(gait=GAIT, references=(0.0,) * 3), 0.01)
    with pytest.raises(ValueError, match=r"`references\[1\]` must be a finite number in rad, got nan\."):
        plant_.step(state, Command(gait=GAIT, references=(0.0, math.nan, *[0.0] * 6)), 0.01)
    with pytest.raises(ValueError, match=r"`enabled` must have one entry per joint, 8 of them, got 1\."):
        plant_.step(state, Command(gait=GAIT, enabled=(True,)), 0.01)
    stiff = body(model, "prescribed")
    with pytest.raises(ValueError, match="`references` must be None for prescribed joints"):
        stiff.step(stiff.init(Start(), Command(gait=GAIT)), Command(gait=GAIT, references=(0.0,) * 8), 0.01)
