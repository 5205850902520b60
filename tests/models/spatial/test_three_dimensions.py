"""The third dimension: pitching waves, depth, the helix, paths in space, the ground and the shore."""

from dataclasses import replace
from math import pi, radians

import numpy as np
import pytest

import laticauda as lc
from laticauda.models.simulate import build_plant, resume, run
from laticauda.models.spatial.scene import Shore
from laticauda.scenarios import ORIENTATION
from laticauda.scenarios.interfaces import Command, OpenLoop, Start
from laticauda.show.pictures.lines import dash_path
from laticauda.water.fluid.laws import CoulombFriction
from laticauda.water.mujoco.ground import SINK

ROBOT = lc.load_robot("mamba-modules")
WATER = lc.load_water("paper-lateral")
NEUTRAL = replace(WATER, density=ROBOT.mass / ROBOT.volume)
SMOOTH = replace(
    lc.load_ground("coulomb"), friction=CoulombFriction(regularization_speed=1e-2)
)  # steps ten times as long
A, F, D = radians(30.0), radians(120.0), radians(40.0)
WAVE = lc.Wave(amplitude=A, frequency=F, phase_shift=D)
YAW = lc.lateral_undulation(amplitude=A, frequency=F, phase_shift=D)
STILL = replace(YAW, amplitude=0.0)


def swim(gait, duration=8.0, robot=ROBOT, environment=WATER, **settings):
    return lc.swim(
        robot, gait, duration, environment=environment, model="spatial", throw=True, **settings
    )


def displacement(trial):
    return trial.center_of_mass[-1] - trial.center_of_mass[0]


def crawl(gait, duration, ground=SMOOTH, **settings):
    return run(
        build_plant(ROBOT, ground, model="spatial", **settings),
        OpenLoop(command=Command(gait=gait)),
        duration,
        throw=True,
    )


# ---- steps ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(("joints", "accuracy"), [("prescribed", 1e-6), ("pd", 5e-5)])
def test_a_robot_that_pitches_and_rolls_is_where_small_steps_bring_it(joints, accuracy):
    gait = replace(YAW, pitch=replace(WAVE, amplitude=0.2, phase_shift=0.5))
    dt = build_plant(ROBOT, WATER, model="spatial", joints=joints).dt
    usual, exact = (swim(gait, 4.0, joints=joints, dt=dt / divisor) for divisor in (1, 8))
    assert np.abs(exact.signals["orientation_x"]).max() > 0.05
    np.testing.assert_allclose(usual.center_of_mass, exact.center_of_mass, atol=accuracy)
    for signal in ORIENTATION:
        np.testing.assert_allclose(usual.signals[signal], exact.signals[signal], atol=accuracy)


# ---- swimming ------------------------------------------------------------------------------------


@pytest.mark.usefixtures("limit_case")
def test_with_circular_sections_a_pitch_wave_moves_the_robot_as_a_yaw_wave_does():
    # A moment of inertia that a round body can have; the robot's own is that of a thin rod.
    section = replace(ROBOT.modules[0].section, half_width=ROBOT.modules[0].section.half_height)
    modules = tuple(replace(m, section=section, inertia=2e-3) for m in ROBOT.modules)
    turned = tuple(replace(j, axis="pitch" if j.axis == "yaw" else "yaw") for j in ROBOT.joints)
    yaw = swim(YAW, robot=replace(ROBOT, modules=modules), gravity=False)
    pitch = swim(
        replace(STILL, pitch=WAVE),
        robot=replace(ROBOT, modules=modules, joints=turned),
        gravity=False,
        dt=0.002,
    )
    (x, y, _), (u, v, w) = displacement(yaw), displacement(pitch)
    assert x > 1.0
    np.testing.assert_allclose(
        (u, v, w), (x, 0.0, -y), atol=1e-6
    )  # positive is down for pitch, left for yaw
    np.testing.assert_allclose(pitch.signals["pitch"], yaw.heading, atol=1e-5)
    np.testing.assert_allclose(pitch.work[-1], yaw.work[-1], rtol=1e-4)


def test_a_robot_without_weight_swims_up_as_its_mirror_image_swims_down():
    gait = replace(
        YAW, pitch=replace(WAVE, amplitude=radians(10.0), phase=0.4, offset=radians(4.0))
    )
    mirrored = replace(gait, pitch=replace(gait.pitch, phase=0.4 + pi, offset=-gait.pitch.offset))
    down, up = swim(gait, gravity=False), swim(mirrored, gravity=False)
    assert displacement(down)[2] < -0.05
    np.testing.assert_allclose(displacement(up), displacement(down) * (1.0, 1.0, -1.0), atol=1e-9)


def test_yaw_and_pitch_a_quarter_apart_make_a_helix_that_swims():
    trial = swim(replace(YAW, pitch=replace(WAVE, phase=0.5 * pi)), gravity=False)
    assert displacement(trial)[0] > 0.3
    assert np.max(np.abs(displacement(trial)[1:])) < 0.05


def test_a_pitch_offset_steers_in_depth():
    down, straight, up = (
        swim(
            replace(YAW, pitch=replace(WAVE, amplitude=0.0, offset=radians(offset))),
            12.0,
            environment=NEUTRAL,
        )
        for offset in (2.0, 0.0, -2.0)
    )
    assert displacement(down)[2] < -0.2
    assert abs(displacement(straight)[2]) < 0.01
    assert displacement(up)[2] > 0.2
    assert down.signals["pitch"][-1] > 0.1


def test_what_is_observed_is_the_state_itself():
    body = build_plant(ROBOT, NEUTRAL, model="spatial")
    command = Command(gait=replace(YAW, offset=0.1), pitch_offset=0.1)
    state, log, _ = body.march(body.init(Start(), command), command, 3.0, 0.5)
    seen = body.observe(state)
    for name in ("center_of_mass", "heading", "link_angle", "joint_angle"):
        np.testing.assert_allclose(getattr(seen, name), getattr(log, name)[-1], atol=1e-12)
    assert seen.pitch == pytest.approx(log.signals["pitch"][-1])
    assert np.ptp(seen.joint_angle) > 0.5


def test_a_trial_with_a_pitch_wave_is_saved_and_loaded_equal(tmp_path):
    trial = swim(replace(YAW, pitch=replace(WAVE, phase=1.0, offset=0.1)), 1.0)
    trial.save(tmp_path / "run.nc")
    again = lc.load_trial(tmp_path / "run.nc")
    assert again.equals(trial)
    assert again.gait.pitch == trial.gait.pitch


def test_pitch_is_refused_where_there_are_no_pitch_joints():
    gait = replace(YAW, pitch=WAVE)
    with pytest.raises(
        ValueError,
        match=r"`gait.pitch` must be None unless `model` is `spatial`: the planar model has no",
    ):
        lc.swim(ROBOT, gait, 1.0)
    with pytest.raises(
        ValueError, match=r"`gait.pitch` must be None for a robot without pitch joints"
    ):
        swim(gait, robot=lc.load_robot("mamba"))
    with pytest.raises(ValueError, match=r"`gait.pitch` must be None with a planar root"):
        swim(gait, root="planar")
    with pytest.raises(ValueError, match="`pitch` must be of class Wave, got float"):
        replace(YAW, pitch=0.1)
    with pytest.raises(
        ValueError, match=r"`amplitude` must be between 0 and 3\.14159 rad, got -0\.1"
    ):
        replace(WAVE, amplitude=-0.1)


# ---- paths in space ------------------------------------------------------------------------------


def follow(profile, duration, **changes):
    controller = lc.SpatialPathFollowing(
        gait=YAW,
        path=lc.StraightLine(),
        profile=profile,
        guidance=lc.LineOfSight(look_ahead_distance=0.5),
        climb_guidance=lc.LineOfSight(look_ahead_distance=1.0),
        heading=lc.HeadingController(gain=0.4, max_offset=radians(15.0)),
        climb=lc.HeadingController(gain=0.2, max_offset=radians(5.0)),
    )
    robot = changes.pop("robot", ROBOT)
    body = build_plant(robot, NEUTRAL, **{"model": "spatial", **changes})
    return run(body, controller, duration, start=Start(center_of_mass=(0.0, 0.3)))


@pytest.mark.parametrize(
    "profile",
    [
        lc.StraightLine(point=(0.0, -1.0)),
        lc.StraightLine(point=(0.0, -0.7), angle=radians(-8.0)),
        lc.Spline(waypoints=((0.0, -0.5), (2.0, -0.5), (5.0, -1.0), (12.0, -1.5))),
    ],
    ids=["deeper", "slope", "spline"],
)
def test_it_converges_to_a_line_in_space(profile):
    trial = follow(profile, 60.0)
    late = trial.time > 40.0
    assert np.max(np.abs(trial.signals["cross_track_error"][late])) < 0.05
    assert np.max(np.abs(trial.signals["height_error"][late])) < 0.05
    y, z = trial.center_of_mass[late, 1:].T
    assert np.max(np.abs(y)) < 0.05
    ends = profile.points(trial.signals["along_track_distance"][late])
    assert (
        np.max(np.abs(z - ends[:, 1])) < 0.15
    )  # points at that length along the profile, not at that x


def test_the_path_is_drawn_at_its_own_height():
    trial = follow(lc.StraightLine(point=(0.0, -1.0)), 15.0)
    dashes = np.array([end for dash in dash_path(trial, 0.0) for end in dash])
    assert len(dashes) > 10
    np.testing.assert_allclose(dashes[:, 2], -1.0 - 1.3 * 0.055, atol=0.01)


def test_path_following_in_space_refuses_what_cannot_climb():
    line = lc.StraightLine(point=(0.0, -1.0))
    with pytest.raises(
        ValueError, match="`robot` must have pitch joints for a path in space, got `mamba`"
    ):
        follow(line, 1.0, robot=lc.load_robot("mamba"))
    with pytest.raises(
        ValueError, match="`robot` must have pitch joints for a path in space, got `mamba-modules`"
    ):
        follow(line, 1.0, model="planar")
    stiff = replace(
        ROBOT,
        joints=tuple(replace(j, limit=1.6 if j.axis == "yaw" else 0.05) for j in ROBOT.joints),
    )
    with pytest.raises(ValueError, match=r"`climb.max_offset` must be <= 0.05 rad"):
        follow(line, 1.0, robot=stiff)


# ---- ground --------------------------------------------------------------------------------------


def test_it_rests_on_the_ground_where_its_weight_is_carried():
    trial = crawl(STILL, 0.3)
    depth = trial.center_of_mass[0, 2] - trial.center_of_mass[-1, 2]
    assert depth == pytest.approx(SINK, rel=1e-3)
    np.testing.assert_allclose(displacement(trial)[:2], 0.0, atol=1e-9)
    held = (
        run(
            build_plant(ROBOT, SMOOTH, model="spatial"),
            OpenLoop(command=Command(gait=STILL)),
            0.3,
            link_forces=True,
        )
        .link_force["drag"][-1]
        .sum(axis=0)
    )
    np.testing.assert_allclose(held, (0.0, 0.0, ROBOT.mass * SMOOTH.gravity), atol=1e-2)


@pytest.mark.parametrize("friction", ["coulomb", "viscous"])
def test_lateral_undulation_crawls_as_in_the_plane(friction):
    ground = SMOOTH if friction == "coulomb" else lc.load_ground("viscous")
    spatial, planar = crawl(YAW, 8.0, ground), lc.swim(ROBOT, YAW, 8.0, environment=ground)
    assert spatial.forward_velocity == pytest.approx(planar.forward_velocity, rel=0.2)
    assert displacement(spatial)[0] > 0.8


@pytest.mark.parametrize("joints", ["pd", "servo"])
def test_driven_joints_crawl_as_in_the_plane(joints):
    ground = lc.load_ground("viscous")
    spatial, planar = (
        crawl(YAW, 8.0, ground, joints=joints),
        lc.swim(ROBOT, YAW, 8.0, environment=ground, joints=joints),
    )
    assert displacement(spatial)[0] == pytest.approx(displacement(planar)[0], rel=0.1)


def test_without_anisotropy_lateral_undulation_does_not_crawl():
    slippery = crawl(YAW, 6.0, replace(SMOOTH, tangential=0.3, normal=0.3))
    assert abs(displacement(slippery)[0]) < 0.25 * displacement(crawl(YAW, 6.0))[0]


def test_sidewinding_goes_sideways_and_its_mirror_image_to_the_other_side():
    isotropic = replace(SMOOTH, tangential=0.4, normal=0.4)
    lift = replace(WAVE, amplitude=radians(5.0))
    right, left = (
        crawl(
            replace(YAW, amplitude=radians(25.0), pitch=replace(lift, phase=phase)), 6.0, isotropic
        )
        for phase in (0.5 * pi, -0.5 * pi)
    )
    assert displacement(right)[1] < -0.5
    assert displacement(left)[1] > 0.5
    assert abs(displacement(right)[1]) > 2.0 * abs(displacement(right)[0])


def test_it_crawls_from_the_shore_into_the_water_and_swims_on():
    body = build_plant(ROBOT, WATER, model="spatial", scene=Shore(ground=SMOOTH))
    trial = run(
        body,
        OpenLoop(command=Command(gait=YAW)),
        25.0,
        start=Start(center_of_mass=(1.6, 0.0)),
        throw=True,
    )
    z = trial.center_of_mass[:, 2]
    assert z[0] > 0.14  # dry
    assert z[-1] < -0.1  # below the surface, and above the ramp
    assert z[-1] > 0.1 - np.tan(radians(12.0)) * (trial.center_of_mass[-1, 0] - 2.5) + 0.05
    assert displacement(trial)[0] > 2.5
    late = trial.time > 20.0
    assert np.ptp(trial.center_of_mass[late, 0]) > 0.2
    assert trial.settings["scene"] == "shore"


def test_a_run_from_the_shore_goes_on_where_it_ended():
    body = build_plant(ROBOT, WATER, model="spatial", scene=Shore(ground=SMOOTH))
    first = run(body, OpenLoop(command=Command(gait=YAW)), 1.0)
    again = build_plant(first.scenario)
    assert again.settings == body.settings
    whole = run(body, OpenLoop(command=Command(gait=YAW)), 2.0)
    np.testing.assert_allclose(
        resume(again, first, 1.0).center_of_mass[-1], whole.center_of_mass[-1], atol=1e-6
    )


def test_a_shore_is_refused_where_it_cannot_be():
    with pytest.raises(ValueError, match="`scene` must be left out unless `model` is `spatial`"):
        build_plant(ROBOT, WATER, scene="shore")
    with pytest.raises(
        ValueError, match="`scene` must not be `shore` without water, got the ground `coulomb`"
    ):
        build_plant(ROBOT, SMOOTH, model="spatial", scene="shore")
    with pytest.raises(
        ValueError, match="`root` must be `free`, with `gravity`, for a robot that lies on a scene"
    ):
        build_plant(ROBOT, WATER, model="spatial", scene="shore", root="planar")
    with pytest.raises(ValueError, match="`root` must be `planar` on the ground without `gravity`"):
        build_plant(ROBOT, SMOOTH, model="spatial", gravity=False)
