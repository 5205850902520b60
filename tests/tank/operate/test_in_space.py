"""An operation in space: depth and pitch by the cameras and the joints, a depth that is steered, its recording."""

from dataclasses import replace
from math import radians

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import laticauda as lc
from laticauda.control import Following
from laticauda.control.estimation import JointSample, KinematicEstimator, Mount, PoseSample
from laticauda.robot.kinematics import from_quaternion, module_poses, turn
from laticauda.scenarios.interfaces import ORIENTATION, Start
from laticauda.tank.lab import LabSettings, Tank, VirtualRobot
from laticauda.tank.operate.loop import run_loop
from laticauda.tank.operate.procedure.operator import Operator
from laticauda.tank.operate.recording.log import read_operation
from laticauda.tank.operate.recording.recorder import OperationRecorder, Sink
from laticauda.tank.operate.recording.to_trial import trial_of
from laticauda.tank.operate.session import header_of
from laticauda.tank.operate.settings import Calibration, CaptureVolume, Operation
from laticauda.tank.operate.tank_devices import TankDevices

ROBOT = lc.load_robot("mamba-modules")
WATER = replace(lc.load_water("paper-lateral"), density=ROBOT.mass / ROBOT.volume)
GAIT = lc.lateral_undulation(
    amplitude=radians(30),
    frequency=radians(130),
    phase_shift=radians(40),
    pitch=lc.Wave(
        amplitude=radians(10), frequency=radians(130), phase_shift=radians(40), offset=radians(2)
    ),
)


@pytest.fixture(scope="module")
def swum() -> lc.Trial:
    start = Start(heading=1.0, pitch=0.3, roll=0.2, depth=0.7)
    return lc.swim(
        ROBOT, GAIT, 3.0, environment=WATER, model="spatial", ballast_depth=0.0, start=start
    )


@settings(max_examples=20, deadline=None)
@given(
    st.integers(0, ROBOT.n_links - 1),
    st.tuples(st.floats(-0.05, 0.05), st.floats(-0.05, 0.05), st.floats(-0.05, 0.1)),
    st.floats(-3.0, 3.0),
)
def test_one_pose_of_the_markers_and_the_joints_say_where_the_robot_is_in_space(
    swum, module, offset, angle
):
    # What MuJoCo says of the center of mass, the heading and the pitch is what they are measured to
    # be.
    estimator = KinematicEstimator(
        robot=ROBOT, mount=Mount(module=module, offset=offset, angle=angle), in_space=True
    )
    state = estimator.init()
    for k in range(0, swum.time.size, 4):
        tail = from_quaternion(*(swum.signals[name][k] for name in ORIENTATION))
        poses = module_poses(ROBOT, swum.center_of_mass[k], tail, swum.joint_angle[k])
        rotation = poses.rotation[module]
        position = poses.position[module] + rotation @ np.array(offset)
        time = float(swum.time[k])
        state = estimator.step(state, JointSample(time=time, angle=swum.joint_angle[k]))
        state = estimator.step(
            state, PoseSample(time=time, position=position, rotation=rotation @ turn("yaw", angle))
        )
        found = estimator.estimate(state, time)
        np.testing.assert_allclose(found.center_of_mass, swum.center_of_mass[k], atol=1e-9)
        np.testing.assert_allclose(found.link_angle, swum.link_angle[k], atol=1e-9)
        assert found.heading == pytest.approx(swum.heading[k], abs=1e-9)
        assert found.pitch == pytest.approx(swum.signals["pitch"][k], abs=1e-9)


def test_a_depth_is_steered_through_wires_and_cameras_and_stands_in_the_recording(tmp_path):
    operation = Operation(
        name="dive",
        robot="mamba-modules",
        gait=replace(GAIT, pitch=None),
        following=Following(path_depth=(1.2,), look_ahead_distance=0.5, climb_gain=1.0),
        duration=6.0,
        ramp=1.0,
        offset_bandwidth=10.0,
        countdown=0.1,
        tank=CaptureVolume(volume_x=(-3.0, 12.0), surface=0.0),
        calibration=Calibration(joint_zeros=True, still_time=0.5),
    )
    plant = lc.build_plant(ROBOT, WATER, model="spatial", joints="servo")
    tank = Tank(VirtualRobot(ROBOT, plant, Start(depth=0.6)), LabSettings())
    operator, depths = Operator(operation=operation), []

    def show(state, outputs):
        if state.phase == "running" and state.estimate is not None:
            depths.append((-tank.truth.center_of_mass[2], -state.estimate.center_of_mass[2]))

    path = tmp_path / "dive.mcap"
    with OperationRecorder(path, header_of(operator)) as recorder:
        state, _ = run_loop(
            operator,
            TankDevices(tank, has_meter=False),
            sink=Sink(recorder),
            show=show,
            longest=600.0,
        )
    truth, measured = np.array(depths).T
    assert (state.failure, state.stopped_by) == ("", "")
    assert truth[-1] - truth[0] > 0.03
    assert abs(measured - truth).max() < 0.04  # noise of the cameras, and the ballast
    trial = trial_of(read_operation(path))
    assert trial.center_of_mass.shape[1] == 3 and trial.joint_angle.shape[1] == ROBOT.n_joints
    assert np.ptp(
        trial.joint_angle_ref[:, [joint.axis == "pitch" for joint in ROBOT.joints]]
    ) > radians(3)
    assert trial.signals["pitch"].max() > radians(3)
    assert trial.signals["height_error"][-1] < trial.signals["height_error"][0]
    np.testing.assert_allclose(-trial.center_of_mass[-1, 2], measured[-1], atol=0.02)


def test_an_operation_in_the_plane_is_what_it_was():
    plane = Operation(name="plane", gait=replace(GAIT, pitch=None), following=Following())
    assert not plane.in_space
    assert Operation(name="helix", robot="mamba-modules", gait=GAIT).in_space
    volume = CaptureVolume(path_origin=(1.0, 2.0), path_heading=0.3, surface=1.4)
    at = np.array([0.2, -0.4, 0.9])
    np.testing.assert_allclose(volume.to_tank(volume.to_path(at)), at)
    assert volume.to_path(at)[2] == pytest.approx(-0.5)
