"""What steers and pushes in three dimensions: starts, currents, thrusters, dive planes, envelopes of pitch waves."""

from dataclasses import replace
from functools import cache
from math import cos, radians, sin

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import laticauda as lc
from laticauda.models.simulate import build_plant
from laticauda.motion.gaits import Generator
from laticauda.motion.gaits.gait import EelLike
from laticauda.robot import PectoralFin, Thruster
from laticauda.robot.kinematics import turn
from laticauda.scenarios.interfaces import ORIENTATION, Command, Start
from laticauda.values.angles import from_quaternion

ROBOT = lc.load_robot("mamba-modules")
WATER = lc.load_water("paper-lateral")
NEUTRAL = replace(WATER, density=ROBOT.mass / ROBOT.volume)
STRAIGHT = lc.lateral_undulation(amplitude=0.0, frequency=1.0, phase_shift=0.5)
HELD = Command(gait=STRAIGHT)
MIDDLE = ROBOT.n_links // 2


@cache
def neutral():
    return build_plant(ROBOT, NEUTRAL, model="spatial")


def moved(robot=ROBOT, water=NEUTRAL, command=HELD, start=Start(), duration=0.2, **model):  # noqa: B008
    body = build_plant(robot, water, model="spatial", **model)
    return body.march(body.init(start, command), command, duration, duration)[1]


@settings(max_examples=30, deadline=None)
@given(
    st.tuples(st.floats(-3, 3), st.floats(-3, 3)),
    st.floats(0.3, 3.0),
    st.floats(-3, 3),
    st.floats(-1.5, 1.5),
    st.floats(-3, 3),
)
def test_a_robot_begins_where_its_start_says(place, depth, heading, pitch, roll):
    start = Start(
        center_of_mass=place, depth=depth, heading=heading, pitch=pitch, roll=roll, velocity=0.1
    )
    body = neutral()
    seen = body.observe(body.init(start, HELD))
    axes = turn("yaw", heading) @ turn("pitch", pitch) @ turn("roll", roll)
    ballast = body.settings.ballast_depth * axes[:, 2]
    np.testing.assert_allclose(
        seen.center_of_mass + np.array((0, 0, ballast[2])), (*place, -depth), atol=1e-9
    )
    np.testing.assert_allclose(seen.center_of_mass_velocity, 0.1 * axes[:, 0], atol=1e-9)
    assert seen.pitch == pytest.approx(pitch, abs=1e-9)
    assert np.cos(seen.heading - heading) == pytest.approx(1.0)
    log = body.march(body.init(start, HELD), HELD, 1e-6, 1e-6)[1]
    np.testing.assert_allclose(
        from_quaternion(*(log.signals[name][0] for name in ORIENTATION)), axes, atol=1e-9
    )


def test_a_start_out_of_the_plane_is_refused_by_the_planar_model():
    for changes in ({"depth": 1.0}, {"pitch": 0.1}, {"roll": 0.1}):
        for body in (
            build_plant(ROBOT, WATER),
            build_plant(lc.load_robot("mamba"), WATER, model="spatial"),
        ):
            with pytest.raises(
                ValueError,
                match=f"`start.{next(iter(changes))}` must be left out unless `model` is",
            ):
                body.init(Start(**changes), HELD)


def test_a_current_in_three_dimensions_carries_a_robot_that_goes_along():
    current = (0.05, -0.02, 0.03)
    water = replace(NEUTRAL, current=current)
    # Galilei: in water that moves, everything is as in still water to somebody who moves along.
    still, carried = (moved(water=one, duration=4.0, gravity=False) for one in (NEUTRAL, water))
    assert np.linalg.norm(carried.center_of_mass_velocity[-1]) < np.linalg.norm(current)
    assert carried.center_of_mass_velocity[-1] @ current > 0.0
    gait = replace(STRAIGHT, amplitude=0.5)
    held = Command(gait=gait)
    body = build_plant(
        ROBOT, replace(water, added_mass_form="kirchhoff"), model="spatial", gravity=False
    )
    rest = build_plant(
        ROBOT, replace(NEUTRAL, added_mass_form="kirchhoff"), model="spatial", gravity=False
    )
    state = body.init(Start(), held)
    values = state.values.copy()
    n = values.size - ROBOT.n_links - body.model.nv
    values[n : n + 3] += current
    log = body.march(replace(state, values=values), held, 2.0, 0.5)[1]
    other = rest.march(rest.init(Start(), held), held, 2.0, 0.5)[1]
    np.testing.assert_allclose(
        log.center_of_mass - np.outer(log.time, current), other.center_of_mass, atol=1e-9
    )
    assert still.center_of_mass[-1] == pytest.approx(still.center_of_mass[0], abs=1e-6)


def test_the_planar_model_refuses_a_current_that_is_not_in_its_plane():
    with pytest.raises(
        ValueError, match=r"`current` must be horizontal unless .*, got 0.1 m/s upward"
    ):
        lc.swim(ROBOT, STRAIGHT, 1.0, environment=replace(WATER, current=(0.0, 0.0, 0.1)))
    assert replace(WATER, current=(0.1, 0.2, 0.0)) == replace(WATER, current=(0.1, 0.2))


@settings(max_examples=20, deadline=None)
@given(st.floats(-3, 3), st.floats(-1.5, 1.5), st.floats(-3, 3), st.floats(0.2, 5.0))
def test_a_thruster_pushes_the_way_that_it_is_mounted(angle, elevation, roll, thrust):
    one = Thruster(
        link=MIDDLE, thrust=0.0, max_thrust=5.0, angle=angle, elevation=elevation, roll=roll
    )
    robot = replace(ROBOT, thrusters=(one,))
    body = build_plant(robot, NEUTRAL, model="spatial")
    state = body.init(Start(), HELD)
    log = body.march(state, replace(HELD, thrusts=(thrust,)), 1e-4, 1e-4, link_forces=True)[1]
    force = log.link_force["effector"][0].sum(axis=0)
    expected = thrust * np.array(
        (cos(elevation) * cos(angle), cos(elevation) * sin(angle), sin(elevation))
    )
    np.testing.assert_allclose(force, expected, atol=1e-9)
    np.testing.assert_allclose(log.signals["thrust_0"], thrust)


def test_a_vertical_thruster_on_command_dives_and_no_more_than_it_can():
    down = Thruster(link=MIDDLE, thrust=0.0, max_thrust=2.0, elevation=radians(-90))
    robot = replace(ROBOT, thrusters=(down,))
    off, on, too_much = (
        moved(robot, command=replace(HELD, thrusts=(thrust,)), duration=3.0)
        for thrust in (0.0, 2.0, 50.0)
    )
    assert abs(off.center_of_mass[-1, 2] - off.center_of_mass[0, 2]) < 1e-3
    assert on.center_of_mass[-1, 2] - on.center_of_mass[0, 2] < -0.03
    np.testing.assert_array_equal(too_much.center_of_mass, on.center_of_mass)
    np.testing.assert_array_equal(too_much.signals["thrust_0"], 2.0)


def test_both_models_drive_a_thruster_and_a_fin_alike_and_as_if_they_were_built_so():
    thrusters = (
        Thruster(link=0, thrust=0.5, x=-0.05),
        Thruster(link=3, thrust=0.0, max_thrust=3.0, angle=0.3),
    )
    fin = PectoralFin(
        link=6, area=0.02, lift_slope=2.0, stall_angle=0.4, angle=0.1, max_deflection=0.5
    )
    mamba = replace(lc.load_robot("mamba"), thrusters=thrusters, pectoral_fins=(fin,))
    built = replace(
        mamba,
        thrusters=(thrusters[0], replace(thrusters[1], thrust=1.5)),
        pectoral_fins=(replace(fin, deflection=0.2),),
    )
    command = replace(HELD, thrusts=(1.5,), deflections=(0.2,))
    logs = []
    for model in ("planar", "spatial"):
        for robot, given_ in ((mamba, command), (built, HELD)):
            body = build_plant(robot, WATER, model=model, dt=0.0125)
            logs.append(body.march(body.init(Start(velocity=0.2), given_), given_, 3.0, 0.5)[1])
    for log in logs[1:]:
        np.testing.assert_allclose(
            log.center_of_mass[:, :2], logs[0].center_of_mass[:, :2], atol=1e-6
        )
        np.testing.assert_allclose(log.heading, logs[0].heading, atol=1e-6)
    assert abs(logs[0].heading[-1]) > 0.005


def test_a_command_for_other_effectors_is_refused():
    robot = replace(ROBOT, thrusters=(Thruster(link=0, thrust=1.0),))
    with pytest.raises(
        ValueError, match="`thrusts` must have one entry per effector with a `max_thrust`, 0 in all"
    ):
        moved(robot, command=replace(HELD, thrusts=(1.0,)))
    with pytest.raises(
        ValueError, match=r"`thrusters\[0\].elevation` must be 0 unless `model` is `spatial`"
    ):
        lc.swim(
            replace(ROBOT, thrusters=(Thruster(link=0, thrust=1.0, elevation=0.1),)), STRAIGHT, 1.0
        )
    flat = PectoralFin(link=3, area=0.01, lift_slope=3.0, stall_angle=0.3, roll=radians(90))
    with pytest.raises(
        ValueError, match=r"`pectoral_fins\[0\].roll` must be 0 unless `model` is `spatial`"
    ):
        lc.swim(replace(ROBOT, pectoral_fins=(flat,)), STRAIGHT, 1.0)


def test_a_dive_plane_lifts_as_the_same_plate_upright_pushes_aside():
    # Turned by a quarter about the robot's axis, without weight and with round sections: the same
    # forces, turned.
    plate = PectoralFin(link=MIDDLE, area=0.02, lift_slope=3.0, stall_angle=0.4, max_deflection=0.3)
    forces = []
    for roll in (0.0, radians(90)):
        robot = replace(ROBOT, pectoral_fins=(replace(plate, roll=roll),))
        body = build_plant(robot, NEUTRAL, model="spatial")
        state = body.init(Start(velocity=0.5), HELD)
        log = body.march(state, replace(HELD, deflections=(0.15,)), 1e-4, 1e-4, link_forces=True)[1]
        forces.append(log.link_force["effector"][0].sum(axis=0))
    (x, y, z), (u, v, w) = forces
    assert y > 1.0  # the chord turned to the left pushes to the left; flat, the nose up pushes up
    np.testing.assert_allclose((u, v, w), (x, -z, y), atol=1e-9)


def test_an_envelope_spreads_a_pitch_wave_as_it_does_a_yaw_wave():
    wave = lc.Wave(amplitude=0.3, frequency=2.0, phase_shift=0.6, envelope=EelLike())
    gait = replace(STRAIGHT, pitch=wave)
    log = neutral().march(
        neutral().init(Start(), Command(gait=gait)), Command(gait=gait), 3.0, 0.5
    )[1]
    turned = [joint.axis == "pitch" for joint in ROBOT.joints]
    yaw = lc.eel_like(amplitude=0.3, frequency=2.0, phase_shift=0.6)
    alone = Generator(n_links=sum(turned) + 1)
    state = alone.step(alone.init(yaw), yaw, 3.0)
    np.testing.assert_allclose(
        log.joint_angle_ref[-1, turned], alone.joints(state, yaw)[0], atol=1e-9
    )
    own = Generator(n_links=ROBOT.n_links, axes=tuple(joint.axis for joint in ROBOT.joints))
    state = own.step(own.init(gait), gait, 3.0)
    np.testing.assert_allclose(log.joint_angle_ref[-1], own.joints(state, gait)[0], atol=1e-9)
