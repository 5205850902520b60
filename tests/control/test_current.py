import math
from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.control import AveragedModel
from laticauda.control.current import BEND, PSI, CurrentObserver

FREQUENCY = 1.5
MODEL = AveragedModel(
    turn_0=0.02,
    turn_1=0.55,
    bend=1.4,
    bend_lag=0.25,
    speed_0=0.01,
    speed_1=0.08,
    speed_offset=-0.2,
    speed_lag=0.5,
    sway=0.25,
    sway_lag=1.2,
    power_0=1.0,
    power_1=3.0,
    power_exponent=2.3,
    power_offset=9.0,
)
NOTHING = np.zeros(1)


def watched(drift, offsets, *, mirrored=False, ripple=0.15):
    """What the filter believes of a robot that is the model, carried by `drift`, with a ripple; and the truth."""
    sign = -1.0 if mirrored else 1.0
    observer, truth, state = CurrentObserver(model=MODEL), (0.0,) * 6, None
    for k, offset in enumerate(offsets):
        time = 0.2 * k
        place = np.array([truth[0] + drift[0] * time, sign * (truth[1] + drift[1] * time)])
        heading = sign * (truth[PSI] + MODEL.bend * truth[BEND] + ripple * math.sin(FREQUENCY * time))
        seen = lc.Observation(
            time=time,
            center_of_mass=place,
            center_of_mass_velocity=np.zeros(2),
            heading=heading,
            heading_rate=0.0,
            link_angle=NOTHING,
            joint_angle=NOTHING,
            joint_rate=NOTHING,
        )
        held = offsets[k - 1] if k else 0.0
        state = observer.init(seen) if state is None else observer.step(state, FREQUENCY, sign * held, seen)
        if k + 1 < len(offsets):
            truth = MODEL.after(truth, FREQUENCY, offset, 0.2)
    return state, truth, seen


STRAIGHT, TURN = [0.0] * 200, [0.0] * 200 + [0.2] * 6


@pytest.mark.parametrize("drift", [(0.0, 0.0), (0.02, -0.05)])
def test_the_drift_and_the_direction_are_found_under_the_ripple(drift):
    state, truth, _ = watched(drift, STRAIGHT)
    np.testing.assert_allclose(state.drift, drift, atol=2e-3)
    assert state.mean[PSI] == pytest.approx(truth[PSI], abs=0.01)


def test_links_that_bend_are_not_taken_for_a_robot_that_has_turned():
    state, truth, _ = watched((0.0, 0.03), TURN)
    assert MODEL.bend * truth[BEND] > 0.25
    assert state.mean[PSI] == pytest.approx(truth[PSI], abs=0.03)


def test_a_mirrored_robot_is_seen_mirrored():
    (usual, _, _), (mirrored, _, _) = watched((0.01, 0.03), TURN), watched((0.01, 0.03), TURN, mirrored=True)
    signs = np.array([1, -1, -1, -1, 1, -1, 1, -1, -1, -1])
    np.testing.assert_allclose(mirrored.mean, signs * usual.mean, atol=1e-9)


def test_what_is_seen_twice_tells_nothing_new():
    state, _, seen = watched((0.0, 0.0), STRAIGHT[:20])
    assert CurrentObserver(model=MODEL).step(state, FREQUENCY, 0.0, seen) is state


def test_its_uncertainty_stays_symmetric_and_positive():
    state, _, seen = watched((0.0, 0.03), TURN)
    later = CurrentObserver(model=MODEL).step(state, FREQUENCY, 0.2, replace(seen, time=seen.time + 5.0))
    for covariance in (state.covariance, later.covariance):
        np.testing.assert_allclose(covariance, covariance.T, atol=1e-15)
        assert np.linalg.eigvalsh(covariance).min() > 0.0
