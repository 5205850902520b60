import math
from dataclasses import replace

import numpy as np
import pytest
from averaged_models import AVERAGED_MODEL
from hypothesis import assume, given, strategies as st

import laticauda as lc
from laticauda.control import AveragedModel, Following
from laticauda.control.current import BEND, PSI, CurrentObserver, crab_angle
from laticauda.trials import following

FREQUENCY = 1.5
MODEL = AVERAGED_MODEL
NOTHING = np.zeros(1)


def watched(drift, offsets, *, mirrored=False, ripple=0.15):
    """What the filter believes of a robot that is the model, carried by `drift`, with a ripple; and the truth."""
    sign = -1.0 if mirrored else 1.0
    observer, truth, state = CurrentObserver(model=MODEL), (0.0,) * 6, None
    for k, offset in enumerate(offsets):
        time = 0.2 * k
        place = np.array([truth[0] + drift[0] * time, sign * (truth[1] + drift[1] * time)])
        heading = sign * (
            truth[PSI] + MODEL.bend * truth[BEND] + ripple * math.sin(FREQUENCY * time)
        )
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
        state = (
            observer.init(seen)
            if state is None
            else observer.step(state, FREQUENCY, sign * held, seen)
        )
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
    (usual, _, _), (mirrored, _, _) = (
        watched((0.01, 0.03), TURN),
        watched((0.01, 0.03), TURN, mirrored=True),
    )
    signs = np.array([1, -1, -1, -1, 1, -1, 1, -1, -1, -1])
    np.testing.assert_allclose(mirrored.mean, signs * usual.mean, atol=1e-9)


def test_what_is_seen_twice_tells_nothing_new():
    state, _, seen = watched((0.0, 0.0), STRAIGHT[:20])
    assert CurrentObserver(model=MODEL).step(state, FREQUENCY, 0.0, seen) is state


def test_its_uncertainty_stays_symmetric_and_positive():
    state, _, seen = watched((0.0, 0.03), TURN)
    later = CurrentObserver(model=MODEL).step(
        state, FREQUENCY, 0.2, replace(seen, time=seen.time + 5.0)
    )
    for covariance in (state.covariance, later.covariance):
        np.testing.assert_allclose(covariance, covariance.T, atol=1e-15)
        assert np.linalg.eigvalsh(covariance).min() > 0.0


@given(
    st.floats(-4.0, 4.0),
    st.floats(-3.2, 3.2),
    st.floats(0.0, 0.5),
    st.floats(0.01, 0.5),
    st.floats(0.1, math.pi / 2),
)
def test_a_robot_that_points_upstream_goes_where_it_is_to_go_unless_the_current_is_said_to_be_too_strong(
    course, direction, current, speed, most
):
    velocity = current * np.array([math.cos(direction), math.sin(direction)])
    angle, is_limited = crab_angle(course, velocity, speed, most)
    heading = course - angle
    over_ground = velocity + speed * np.array([math.cos(heading), math.sin(heading)])
    ahead, beside = over_ground @ np.array(
        [[math.cos(course), -math.sin(course)], [math.sin(course), math.cos(course)]]
    )
    assert abs(angle) <= most
    assume(
        abs(ahead) > 1e-12
    )  # a current that leaves no way forward to the last digit may be said to be either
    if not is_limited:
        assert ahead > 0.0
        assert beside == pytest.approx(0.0, abs=1e-9)
    elif ahead > 1e-12:  # beyond rounding; what is left goes downstream
        assert beside * (velocity @ (-math.sin(course), math.cos(course))) > -1e-12
        assert abs(angle) == most


OBSERVER = CurrentObserver(
    model=AveragedModel(  # of Mamba with its fin: laticauda.studies.averaged_model
        turn_0=0.0177,
        turn_1=0.547,
        bend=1.36,
        bend_lag=0.235,
        speed_0=0.0062,
        speed_1=0.0775,
        speed_offset=-0.19,
        speed_lag=0.6,
        sway=0.26,
        sway_lag=1.3,
        power_0=0.0,
        power_1=4.0,
        power_exponent=2.2,
        power_offset=0.0,
    )
)
FAR = Following(guidance="line_of_sight", look_ahead_distance=1.62, gain=0.25)


def followed(current, observer, **changes):
    gait = lc.lateral_undulation(
        amplitude=math.radians(30), frequency=math.radians(90), phase_shift=math.radians(40)
    )
    water = replace(lc.load_water("paper-lateral"), current=current)
    controller = replace(FAR, observer=observer, **changes).controller(gait)
    start = lc.Start(center_of_mass=(0.0, 0.5))
    trial = lc.swim(
        "mamba-fin", controller, 90.0, environment=water, start=start, offset_bandwidth=10.0
    )
    return trial, following.last_third_error(
        trial.time, trial.signals["cross_track_error"], trial.period
    )


def test_line_of_sight_that_observes_the_current_holds_a_line_across_it_and_knows_how_well():
    current = (0.02, 0.05)
    (usual, off), (observing, held) = followed(current, None), followed(current, OBSERVER)
    assert off > 0.5
    assert abs(held) < 0.01
    said = {name: values[-1] for name, values in observing.signals.items()}
    for name, true in zip(("drift_x", "drift_y"), current, strict=True):
        assert abs(said[name] - true) < 3.0 * said[f"{name}_std"] < 0.04
    assert said["crab_angle"] == pytest.approx(math.asin(0.05 / 0.128), abs=0.06)
    assert not said["is_crab_limited"]
    assert set(observing.signals) - set(usual.signals) == {
        "drift_x", "drift_y", "drift_x_std", "drift_y_std", "crab_angle", "is_crab_limited"
    }  # fmt: skip


def test_a_current_that_is_too_strong_is_said():
    trial, _ = followed((0.0, -0.2), OBSERVER)
    limited = trial.signals["is_crab_limited"] > 0.0
    assert limited[trial.time > 20.0].all()  # learned by then
    assert trial.signals["crab_angle"].min() == pytest.approx(-math.radians(60.0))
    assert trial.signals["cross_track_error"][-1] < -1.0


def test_an_observer_is_stored_with_its_scenario_and_its_trial(tmp_path):
    gait = lc.lateral_undulation(amplitude=0.5, frequency=1.5, phase_shift=0.7)
    scenario = lc.build_scenario("mamba-fin", replace(FAR, observer=OBSERVER).controller(gait), 0.2)
    lc.save_scenario(scenario, tmp_path / "observed.toml")
    assert lc.load_scenario(tmp_path / "observed.toml") == scenario
    trial = lc.swim(scenario)
    trial.save(tmp_path / "observed.nc")
    assert lc.load_trial(tmp_path / "observed.nc").equals(trial)
