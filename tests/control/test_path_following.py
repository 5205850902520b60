import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import laticauda as lc
from laticauda.control import (
    HeadingController,
    IntegralLineOfSight,
    LineOfSight,
    PathFollowing,
    Polyline,
    Spline,
    StraightLine,
)
from laticauda.trials import following

GAIT = lc.lateral_undulation(
    amplitude=math.radians(30), frequency=math.radians(90), phase_shift=math.radians(40)
)
EEL = lc.eel_like(
    amplitude=math.radians(40), frequency=math.radians(90), phase_shift=math.radians(40)
)
PAPER = PathFollowing(
    gait=GAIT,
    path=StraightLine(),
    guidance=LineOfSight(look_ahead_distance=0.18),
    heading=HeadingController(gain=0.4, max_offset=math.radians(20)),
)
WATER = {"lateral_undulation": "paper-lateral", "eel_like": "paper-eel", "custom": "paper-lateral"}


def follow(controller, duration, robot="mamba", *, x=0.0, y=1.7352, heading=-0.0325, **choices):
    water = choices.pop("water", lc.load_water(WATER[controller.gait.kind]))
    plant = lc.build_plant(lc.load_robot(robot), water, **choices)
    return lc.run(
        plant, controller, duration, start=lc.Start(center_of_mass=(x, y), heading=heading)
    )


def last_third(trial):
    return following.last_third_error(trial.time, trial.signals["cross_track_error"], trial.period)


@pytest.mark.parametrize("bandwidth", [4.0, 10.0])
@pytest.mark.parametrize("robot", ["mamba", "mamba-fin"])
@pytest.mark.parametrize("gait", [GAIT, EEL], ids=["lateral", "eel"])
def test_the_papers_gains_bring_mamba_to_the_path(gait, robot, bandwidth):
    trial = follow(replace(PAPER, gait=gait), 90.0, robot, offset_bandwidth=bandwidth)
    error, along = trial.signals["cross_track_error"], trial.signals["along_track_distance"]
    reached = following.convergence(trial.time, error, along, trial.period)
    assert reached is not None
    assert reached.distance < 2.0
    assert abs(last_third(trial)) < 0.005
    assert 0.07 < trial.forward_velocity < 0.2


@pytest.mark.parametrize("gait", [GAIT, EEL], ids=["lateral", "eel"])
def test_a_mean_heading_needs_a_longer_look_ahead_distance_than_the_papers(gait):
    mean = replace(PAPER, gait=gait, heading_estimate="cycle-mean")
    near = follow(mean, 90.0)
    far = follow(
        replace(
            mean,
            guidance=LineOfSight(look_ahead_distance=1.62),
            heading=replace(PAPER.heading, gain=0.2),
        ),
        90.0,
    )
    swing = [np.ptp(trial.signals["cross_track_error"][trial.time > 60.0]) for trial in (near, far)]
    assert swing[0] > 0.1
    assert swing[1] < 0.1


def turned(points, angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.asarray(points) @ np.array([[c, s], [-s, c]])


@settings(max_examples=8)
@given(
    angle=st.floats(-math.pi, math.pi),
    estimate=st.sampled_from(["raw", "cycle_mean"]),
    curve=st.booleans(),
)
def test_a_path_that_is_rotated_gives_the_rotated_motion(angle, estimate, curve):
    corners = np.array([(0.0, 0.0), (1.0, 0.3), (2.0, -0.2), (4.0, 0.0)])
    path = Spline(waypoints=corners) if curve else StraightLine()
    rotated = Spline(waypoints=turned(corners, angle)) if curve else StraightLine(angle=angle)
    usual = follow(replace(PAPER, path=path, heading_estimate=estimate), 15.0, y=0.5, heading=0.1)
    (x, y), start = turned((0.0, 0.5), angle), 0.1 + angle
    other = follow(
        replace(PAPER, path=rotated, heading_estimate=estimate), 15.0, x=x, y=y, heading=start
    )
    np.testing.assert_allclose(other.center_of_mass, turned(usual.center_of_mass, angle), atol=1e-6)
    np.testing.assert_allclose(other.heading, usual.heading + angle, atol=1e-6)
    for name in ("cross_track_error", "along_track_distance", "offset"):
        np.testing.assert_allclose(other.signals[name], usual.signals[name], atol=1e-6)


@settings(max_examples=8)
@given(
    y=st.floats(-2.0, 2.0),
    heading=st.floats(-1.5, 1.5),
    estimate=st.sampled_from(["raw", "cycle_mean"]),
)
def test_a_mirrored_start_gives_the_mirrored_path(y, heading, estimate):
    wave = {
        "amplitude": GAIT.amplitude,
        "frequency": GAIT.frequency,
        "phase_shift": GAIT.phase_shift,
    }
    left, right = (
        lc.custom_gait(envelope=[1.0] * 8, **wave),
        lc.custom_gait(envelope=[-1.0] * 8, **wave),
    )
    controller = replace(PAPER, gait=left, heading_estimate=estimate)
    usual = follow(controller, 15.0, y=y, heading=heading)
    mirrored = follow(replace(controller, gait=right), 15.0, y=-y, heading=-heading)
    np.testing.assert_allclose(
        mirrored.center_of_mass, usual.center_of_mass * (1.0, -1.0), atol=1e-6
    )
    np.testing.assert_allclose(mirrored.signals["offset"], -usual.signals["offset"], atol=1e-6)


def test_an_integral_takes_a_steady_current_off_and_line_of_sight_does_not():
    water = replace(lc.load_water("paper-eel"), current=(0.0, 0.05))
    controller = replace(
        PAPER, gait=EEL, heading=HeadingController(gain=0.25, max_offset=math.radians(20))
    )
    plain = replace(controller, guidance=LineOfSight(look_ahead_distance=1.62))
    integral = replace(
        controller, guidance=IntegralLineOfSight(look_ahead_distance=1.62, integral_gain=0.12)
    )
    drifted, kept = (
        follow(each, 150.0, "mamba-fin", y=0.5, water=water) for each in (plain, integral)
    )
    assert abs(last_third(drifted)) > 0.2
    assert abs(last_third(kept)) < 0.05


@pytest.mark.parametrize(
    "path",
    [Polyline(waypoints=((0, 0), (4, 0), (8, 3))), Spline(waypoints=((0, 0), (4, 0), (8, 3)))],
)
def test_mamba_follows_a_path_with_a_bend(path):
    trial = follow(replace(PAPER, path=path), 90.0, y=0.2)
    assert trial.signals["along_track_distance"][-1] > 5.0
    assert np.abs(trial.signals["cross_track_error"][trial.time > 20.0]).max() < 0.3


def test_the_signals_of_a_trial_are_those_of_its_samples():
    trial = follow(PAPER, 5.0)
    signals = trial.signals
    np.testing.assert_allclose(
        signals["cross_track_error"][:-1], trial.center_of_mass[:-1, 1], atol=1e-12
    )
    np.testing.assert_allclose(signals["heading_used"][:-1], trial.heading[:-1], atol=1e-12)
    np.testing.assert_allclose(
        signals["heading_ref"], -np.arctan(signals["cross_track_error"] / 0.18), atol=1e-12
    )
    raw = 0.4 * (signals["heading_ref"] - signals["heading_used"])
    np.testing.assert_allclose(
        signals["offset"], np.clip(raw, -np.radians(20), np.radians(20)), atol=1e-12
    )
    np.testing.assert_array_equal(signals["is_saturated"], np.abs(raw) > np.radians(20))
    assert trial.scenario.motion.guidance == LineOfSight(look_ahead_distance=0.18)
    assert trial.scenario.motion.heading_estimate == "raw"
    assert trial.scenario.model.offset_bandwidth == 10.0


def test_the_same_state_and_observation_give_the_same_answer():
    plant = lc.build_plant(lc.load_robot("mamba"), lc.load_water("paper-lateral"))
    seen = plant.observe(plant.init(lc.Start(center_of_mass=(0.0, 1.0)), lc.Command(gait=GAIT)))
    state = PAPER.init()
    assert PAPER.step(state, seen) == PAPER.step(state, seen)


def test_a_saturation_that_takes_a_joint_beyond_its_limit_is_refused():
    wide = replace(PAPER, heading=HeadingController(gain=0.4, max_offset=math.radians(61)))
    with pytest.raises(
        ValueError, match=r"`max_offset` must be <= 1\.047 rad, or joint 0 goes beyond its limit"
    ):
        follow(wide, 1.0)
    assert follow(
        replace(wide, heading=HeadingController(gain=0.4, max_offset=math.radians(59))), 1.0
    ).succeeded
    bent = replace(
        wide, gait=replace(GAIT, offset=-0.2), heading=HeadingController(gain=0.4, max_offset=1.0)
    )
    with pytest.raises(ValueError, match=r"`max_offset` must be <= 0\.8472 rad"):
        follow(bent, 1.0)


@pytest.mark.parametrize(
    ("choices", "message"),
    [
        ({"interval": 0.0}, "`interval` must be >= 0.0001 s, got 0.0"),
        ({"interval": math.inf}, "`interval` must be a finite number in s, got inf"),
        (
            {"heading_estimate": "mean"},
            "`heading_estimate` must be one of `raw`, `cycle_mean`, got 'mean'",
        ),
        (
            {"heading_estimate": "cycle_mean", "gait": replace(GAIT, frequency=0.0)},
            r"`gait\.frequency` must be > 0 rad/s for a mean over its cycle, got 0\.0",
        ),
    ],
)
def test_a_bad_field_is_refused(choices, message):
    with pytest.raises(ValueError, match=message):
        replace(PAPER, **choices)
