"""The spatial plant: a state is a value, joints follow, bad settings are refused, and it floats where it should."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

import laticauda as lc
from laticauda.models.dynamics.plant import Plant
from laticauda.models.simulate import build_plant, resume, run
from laticauda.models.spatial.model import SpatialPlant
from laticauda.models.spatial.rows import STATE_ROWS
from laticauda.models.spatial.water_robot import robot_elements
from laticauda.motion.joints import Servo
from laticauda.scenarios.interfaces import Command, OpenLoop, Start

ROBOT = lc.load_robot("mamba")
WATER = lc.load_water("paper-lateral")
GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)


def test_it_is_a_plant_whose_state_is_a_value():
    body: Plant = build_plant(ROBOT, WATER, model="spatial", joints="pd")
    command = Command(gait=GAIT)
    start = body.init(Start(), command)
    kept = start.values.copy()
    once, twice = (body.march(start, command, 0.5, 0.1)[0].values for _ in range(2))
    np.testing.assert_array_equal(once, twice)
    np.testing.assert_array_equal(start.values, kept)
    in_steps = start
    for _ in range(5):
        in_steps = body.step(in_steps, command, 0.1)
    np.testing.assert_allclose(in_steps.values[STATE_ROWS:], once[STATE_ROWS:], atol=1e-9)
    np.testing.assert_array_equal(body.unpack(body.pack(in_steps)).values, in_steps.values)


def test_the_water_is_there_again_when_somebody_took_the_callback():
    body = build_plant(ROBOT, WATER, model="spatial")
    command = Command(gait=GAIT)
    start = body.init(Start(), command)
    expected = body.march(start, command, 1.0, 0.1)[0].values
    with pytest.warns(UserWarning, match="models with water have lost it"):
        mujoco.set_mjcb_passive(None)
    np.testing.assert_array_equal(body.march(start, command, 1.0, 0.1)[0].values, expected)


def test_it_starts_straight_at_the_start_that_is_asked_for():
    for root in ("planar", "free"):
        body = build_plant(ROBOT, WATER, model="spatial", root=root)
        seen = body.observe(
            body.init(Start(center_of_mass=(1.0, -2.0), heading=2.5), Command(gait=GAIT))
        )
        np.testing.assert_allclose(seen.center_of_mass[:2], (1.0, -2.0), atol=1e-12)
        np.testing.assert_allclose(seen.link_angle, 2.5)
        assert seen.heading == pytest.approx(2.5)
        np.testing.assert_array_equal(seen.joint_angle, 0.0)


def test_a_run_goes_on_from_where_it_ended():
    body = build_plant(ROBOT, WATER, model="spatial", root="free", gravity=False)
    whole = run(body, OpenLoop(command=Command(gait=GAIT)), 2.0)
    first = run(body, OpenLoop(command=Command(gait=GAIT)), 1.0)
    again = build_plant(first.scenario)
    assert again.settings == body.settings
    second = resume(again, first, 1.0)
    np.testing.assert_allclose(second.center_of_mass[-1], whole.center_of_mass[-1], atol=1e-9)
    np.testing.assert_allclose(second.work[-1], whole.work[-1], rtol=1e-6)


def test_prescribed_joints_are_on_the_reference_and_pitch_joints_straight():
    robot = lc.load_robot("mamba-modules-fin")
    trial = lc.swim(robot, GAIT, 3.0, model="spatial", gravity=False)
    np.testing.assert_allclose(trial.joint_angle, trial.joint_angle_ref, atol=1e-12)
    pitch = [joint.axis == "pitch" for joint in robot.joints]
    assert trial.joint_angle.shape[1] == robot.n_joints
    np.testing.assert_array_equal(trial.joint_angle[:, pitch], 0.0)
    assert np.all(np.ptp(trial.joint_angle[:, ~np.array(pitch)], axis=0) > 0.5)
    assert trial.center_of_mass.shape[1] == 3


def test_without_gravity_a_free_root_stays_in_the_plane_and_equals_the_planar_root():
    free, held = (
        lc.swim(ROBOT, GAIT, 4.0, model="spatial", root=root, gravity=False)
        for root in ("free", "planar")
    )
    np.testing.assert_allclose(free.center_of_mass[:, 2], free.center_of_mass[0, 2], atol=1e-9)
    np.testing.assert_allclose(free.center_of_mass[:, :2], held.center_of_mass[:, :2], atol=1e-6)
    np.testing.assert_allclose(free.heading, held.heading, atol=1e-6)


def test_the_heading_is_unwrapped_through_full_turns():
    gait = replace(GAIT, offset=0.3)
    free, held = (
        lc.swim(ROBOT, gait, 25.0, model="spatial", root=root, gravity=False)
        for root in ("free", "planar")
    )
    assert held.heading[-1] > 2.0 * np.pi
    np.testing.assert_allclose(free.heading, held.heading, atol=1e-4)


def test_a_light_robot_floats_up_to_archimedes_depth():
    still = replace(GAIT, amplitude=0.0)
    robot = lc.load_robot("mamba")
    trial = lc.swim(robot, still, 60.0, model="spatial", root="free")
    a = robot.modules[0].section.half_height
    s = np.linspace(-1.0, 1.0, 100001)
    covered = 1.0 - (np.arccos(s) - s * np.sqrt(1.0 - s**2)) / np.pi
    share = robot.mass / (WATER.density * robot.volume)
    axis = trial.center_of_mass[-1, 2] + 0.005  # the ballast's depth
    assert axis == pytest.approx(-a * np.interp(share, covered, s), abs=1e-3)


def test_the_physical_robot_swims_upright_from_any_roll():
    robot = lc.load_robot("mamba-modules-fin")
    body = SpatialPlant(robot=robot, environment=WATER)
    command = Command(gait=GAIT)
    state = body.init(Start(), command)
    values = state.values.copy()
    quaternion = values[STATE_ROWS + 3 : STATE_ROWS + 7]
    np.testing.assert_array_equal(quaternion, [1, 0, 0, 0])
    quaternion[:2] = np.cos(0.5), np.sin(0.5)  # 57 degrees
    state = replace(state, values=values)
    state, log, failure = body.march(state, command, 15.0, 0.1)
    assert failure is None
    up = body.data(state).xmat[1:].reshape(-1, 3, 3)[:, 2, 2]
    assert np.all(up > np.cos(np.deg2rad(12.0)))
    assert log.center_of_mass[-1, 0] > 1.5


@pytest.mark.usefixtures("limit_case")
def test_a_heavy_robot_sinks_to_the_floor_of_the_tank_and_rests_there():
    robot = replace(ROBOT, modules=tuple(replace(m, mass=1.8) for m in ROBOT.modules))
    body = SpatialPlant(
        robot=robot,
        environment=WATER,
        settings=lc.Spatial(root="free", scene="tank", dt=0.002, joints=Servo()),
    )
    command = Command(gait=replace(GAIT, amplitude=0.0))
    _, log, failure = body.march(
        body.init(Start(center_of_mass=(2.0, 0.0)), command), command, 12.0, 0.1
    )
    assert failure is None
    height = robot.modules[0].section.half_height - body.settings.ballast_depth
    assert log.center_of_mass[-1, 2] == pytest.approx(-1.5 + height, abs=2e-3)
    assert np.max(np.abs(log.center_of_mass_velocity[-1])) < 1e-3


def test_joint_limits_do_not_hold_prescribed_joints_up():
    far = replace(GAIT, amplitude=0.0, offset=0.6)
    tight = replace(ROBOT, joints=tuple(replace(j, limit=0.3) for j in ROBOT.joints))
    paths = [lc.swim(robot, far, 3.0, model="spatial").center_of_mass for robot in (ROBOT, tight)]
    np.testing.assert_array_equal(*paths)


def test_where_the_mass_is_above_the_middle_it_is_warned_of():
    robot = lc.load_robot("mamba-modules-fin")
    body = SpatialPlant(
        robot=robot, environment=WATER, settings=lc.Spatial(ballast_depth=-0.002, dt=0.01)
    )
    with pytest.warns(UserWarning, match="`module_0` turns over"):
        body.model  # noqa: B018


def test_neutral_and_deep_it_swims_in_space_as_in_the_plane():
    robot = lc.load_robot("mamba-modules-fin")
    planar = lc.swim(robot, GAIT, 20.0)
    spatial = lc.swim(robot, GAIT, 20.0, model="spatial", gravity=False)
    assert spatial.forward_velocity == pytest.approx(planar.forward_velocity, rel=0.02)


def test_elements_have_the_planar_model_s_numbers_in_the_plane_and_the_turned_ellipse_s_across_it():
    from laticauda.robot.hydrodynamics import link_coefficients

    robot = lc.load_robot("mamba-fin")
    c, elements = link_coefficients(robot, WATER), robot_elements(robot, WATER)
    section = robot.modules[0].section
    for i in range(robot.n_links):
        e = elements[i]
        assert e.drag[:2] == (c.c_t[i], c.c_n[i])
        assert e.added_mass[:2] == (c.mu_t[i], c.mu_n[i])
        assert e.drag[2] == pytest.approx(c.c_n[i] * section.half_width / section.half_height)
        assert e.added_mass[2] == pytest.approx(
            c.mu_n[i] * (section.half_width / section.half_height) ** 2
        )
    assert sum(e.volume for e in elements) == pytest.approx(robot.volume)
    assert sum(e.added_mass[1] for e in elements[robot.n_links :]) == pytest.approx(
        np.sum(c.fin.mu_n)
    )


def test_bad_settings_are_refused_by_name():
    with pytest.raises(ValueError, match="`root` must be one of `free`, `planar`, got 'held'"):
        build_plant(ROBOT, WATER, model="spatial", root="held")
    with pytest.raises(
        ValueError, match="`root` must be left out unless `model` is `spatial`, got 'free'"
    ):
        build_plant(ROBOT, WATER, root="free")
    with pytest.raises(ValueError, match="`dt` must be between"):
        SpatialPlant(robot=ROBOT, environment=WATER, settings=lc.Spatial(dt=0.0))
    with pytest.raises(
        ValueError, match="`state` must be that of a spatial run of 9 links with a planar root"
    ):
        build_plant(ROBOT, WATER, model="spatial").unpack({})


@pytest.mark.usefixtures("limit_case")
@pytest.mark.filterwarnings("ignore:`timestep`")
def test_a_run_that_blows_up_is_a_trial_that_says_so():
    water = replace(WATER, normal_drag=1e4)
    trial = lc.swim(ROBOT, GAIT, 2.0, environment=water, model="spatial", dt=0.02)
    assert not trial.succeeded
    assert "diverged" in trial.status
    assert np.all(np.isfinite(trial.center_of_mass))
