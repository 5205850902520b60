import math
from dataclasses import fields, replace

import numpy as np
import pytest
from averaged_models import AVERAGED_MODEL
from hypothesis import given, settings, strategies as st

import laticauda as lc
from laticauda.control import AveragedModel, OffsetSteps, fit_averaged
from laticauda.scenarios import Experiment

MODEL = replace(AVERAGED_MODEL, speed_lag=1.5)
GAIT = lc.lateral_undulation(amplitude=0.5, frequency=1.5, phase_shift=0.7)
STEPS = OffsetSteps(gait=GAIT)
STATE = (0.0, 0.0, 0.2, 0.1, 0.05, 0.01)


def swum(frequency, model=MODEL):
    """A trial of the averaged model itself, with a ripple of the gait on its heading and place."""
    time = np.arange(0.0, STEPS.duration + 1e-9, 0.05)
    held = (time + 1e-9) // STEPS.interval
    offset = np.array(STEPS.offsets)[np.minimum(held.astype(int), len(STEPS.offsets) - 1)]
    states, spent = [(0.0,) * 6], [0.0]
    for value in offset[:-1]:
        states.append(model.after(states[-1], frequency, value, 0.05))
        spent.append(spent[-1] + 0.05 * model.power(frequency, value))
    x, y, psi, bent, *_ = np.array(states).T
    swing = np.sin(frequency * time)
    robot, zeros = lc.load_robot("mamba"), np.zeros((time.size, 8))
    n = robot.planar().n_links
    zeros = np.zeros((time.size, n - 1))
    return lc.Trial(
        time=time,
        center_of_mass=np.stack([x, y + 0.02 * swing], axis=1),
        center_of_mass_velocity=np.zeros((time.size, 2)),
        heading=psi + model.bend * bent + 0.15 * swing,
        heading_rate=np.zeros_like(time),
        link_angle=np.zeros((time.size, n)),
        joint_angle=zeros,
        joint_rate=zeros,
        joint_angle_ref=zeros,
        joint_torque=zeros,
        work=np.stack([spent] * 3, axis=1),
        signals={"offset": offset},
        scenario=lc.build_scenario(robot, replace(GAIT, frequency=frequency)),
        version=lc.__version__,
    )


def test_the_fit_finds_the_model_that_made_the_trials():
    found = fit_averaged([swum(frequency) for frequency in (1.0, 1.5, 2.0, 2.5)])
    frequencies, offsets = np.array([1.0, 1.7, 2.5]), np.array([0.1, -0.2, 0.15])
    # The speed is that along the chord of a cycle, and a robot that turns swims further than that.
    for name, tolerance in (("turning", 2e-3), ("speed", 5e-3), ("power", 0.1)):
        expected = getattr(MODEL, name)(frequencies, offsets)
        np.testing.assert_allclose(
            getattr(found, name)(frequencies, offsets), expected, atol=tolerance
        )
    for name, tolerance in (
        ("bend", 0.05),
        ("bend_lag", 0.03),
        ("speed_lag", 0.1),
        ("sway", 0.02),
        ("sway_lag", 0.3),
    ):
        assert getattr(found, name) == pytest.approx(getattr(MODEL, name), abs=tolerance), name


def test_a_robot_in_the_water_is_foretold_from_cycle_to_cycle():
    plant = lc.build_plant(lc.load_robot("mamba-fin"), lc.load_water("paper-lateral"))
    makers = [OffsetSteps(gait=replace(GAIT, frequency=frequency)) for frequency in (1.0, 1.5, 2.0)]
    model = fit_averaged([lc.run(plant, maker, maker.duration) for maker in makers])
    other = lc.run(
        plant,
        OffsetSteps(gait=replace(GAIT, frequency=1.75), offsets=(0.0, 0.1), interval=30.0),
        60.0,
    )
    middle, heading = other.heading_cycle_mean
    late = middle > 40.0
    assert np.polyfit(middle[late], heading[late], 1)[0] == pytest.approx(
        model.turning(1.75, 0.1), rel=0.2
    )
    straight = lc.swim(lc.load_robot("mamba-fin"), replace(GAIT, frequency=1.75), duration=30.0)
    assert straight.steady_velocity == pytest.approx(model.speed(1.75, 0.0), rel=0.03)


@settings(max_examples=30)
@given(offset=st.floats(-0.4, 0.4), frequency=st.floats(0.5, 3.0), dt=st.floats(0.01, 2.0))
def test_a_mirrored_command_gives_the_mirrored_motion(offset, frequency, dt):
    signs = np.array([1, -1, -1, -1, 1, -1])
    usual = MODEL.after(STATE, frequency, offset, dt)
    mirrored = MODEL.after(tuple(signs * STATE), frequency, -offset, dt)
    np.testing.assert_allclose(mirrored, signs * usual, atol=1e-15)


def test_two_steps_are_one():
    whole = MODEL.after(STATE, 1.5, 0.2, 0.4)
    halves = MODEL.after(MODEL.after(STATE, 1.5, 0.2, 0.2), 1.5, 0.2, 0.2)
    np.testing.assert_allclose(halves[2:], whole[2:], atol=1e-14)
    np.testing.assert_allclose(halves[:2], whole[:2], atol=1e-5)


UNKNOWN = Experiment(robot=lc.load_robot("mamba"), environment=lc.load_water("paper-lateral"))


@pytest.mark.parametrize(
    ("frequencies", "change", "message"),
    [
        ((1.0, 2.0), {}, "`trials` must have at least 3 different frequencies, got 2"),
        (
            (1.0, 1.5, 2.0),
            {"signals": {}},
            "`trials` must include at least one with a nonzero offset",
        ),
        (
            (1.0, 1.5, 2.0),
            {"scenario": UNKNOWN},
            r"`trials\[0\]` must have a gait that moves, got None",
        ),
        ((1.0, 1.5, 2.0), {"not_measured": ("work",)}, "measured `work` for an averaged model"),
    ],
)
def test_trials_that_do_not_tell_are_refused(frequencies, change, message):
    with pytest.raises(ValueError, match=message):
        fit_averaged([replace(swum(frequency), **change) for frequency in frequencies])


def test_trials_of_different_gaits_are_refused():
    trials = [swum(frequency) for frequency in (1.0, 1.5, 2.0)]
    slower = replace(trials[1].gait, amplitude=0.3)
    trials[1] = replace(trials[1], scenario=replace(trials[1].scenario, motion=slower))
    with pytest.raises(
        ValueError, match="`trials` must share a gait except for frequency and offset, got 2 gaits"
    ):
        fit_averaged(trials)


@pytest.mark.parametrize("name", [field.name for field in fields(AveragedModel)])
def test_a_number_of_the_model_must_be_finite(name):
    with pytest.raises(ValueError, match=f"`{name}` must be a finite number"):
        replace(MODEL, **{name: math.nan})


def test_a_lag_must_be_positive():
    with pytest.raises(ValueError, match="`bend_lag` must be > 0 s, got 0"):
        replace(MODEL, bend_lag=0.0)


def test_steps_without_offsets_are_refused():
    with pytest.raises(
        ValueError, match="`offsets` must hold at least one offset in rad, got none"
    ):
        OffsetSteps(gait=GAIT, offsets=())
    with pytest.raises(ValueError, match=r"`interval` must be >= 0\.0001 s, got 0"):
        OffsetSteps(gait=GAIT, interval=0.0)
