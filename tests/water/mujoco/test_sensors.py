"""Force and torque sensors in water: what a real one would tell, on strangers' chains and on the robot."""

import copy
from dataclasses import replace

import mujoco
import mujoco.rollout
import numpy as np
import pytest
import water_oracle as oracle

import laticauda as lc
from laticauda.models.spatial import mjcf
from laticauda.models.spatial.water_robot import robot_elements
from laticauda.water import mujoco as water

pytestmark = pytest.mark.filterwarnings("ignore:`timestep`", "ignore:body .* (floats|turns)")
N = 4


def chain(option: str = 'integrator="RK4"') -> tuple[mujoco.MjModel, water.Water]:
    """A snake in water, half of it above the surface, with a force and a torque sensor at every joint, askew."""
    text = oracle.snake(N, option=option).replace("0 0 0", "0 0 -9.81", 1)
    for i in range(N):
        text = text.replace(
            f'<geom name="g{i}"', f'<site name="s{i}" euler="10 20 {i}"/><geom name="g{i}"'
        )
    sensors = "".join(f'<force site="s{i}"/><torque site="s{i}"/>' for i in range(N))
    model = water.compile_spec(
        mujoco.MjSpec.from_string(text.replace("</mujoco>", f"<sensor>{sensors}</sensor></mujoco>"))
    )
    elements = [replace(e, volume=1e-3) for e in oracle.elements(N)]
    return model, water.attach(model, elements, surface=0.0, current=(0.3, 0.1, 0.0))


def sensed(model, data) -> np.ndarray:
    """Force and torque at every joint, world axes, (n, 2, 3)."""
    own = data.sensordata[: 6 * N].reshape(N, 2, 3)
    return np.einsum("nij,nkj->nki", data.site_xmat.reshape(N, 3, 3), own)


@pytest.mark.parametrize("integrator", ["RK4", "Euler", "implicitfast"])
def test_a_free_hinge_bears_no_torque_about_its_axis_and_nothing_holds_a_free_root(integrator: str):
    model, _ = chain(f'integrator="{integrator}"')
    data = mujoco.MjData(model)
    for seed in range(3):
        oracle.random_state(model, data, seed)
        mujoco.mj_step(model, data, nstep=20)
        mujoco.mj_forward(model, data)
        found = sensed(model, data)
        scale = np.max(np.abs(found))
        assert scale > 1.0
        np.testing.assert_allclose(found[0], 0.0, atol=1e-10 * scale)
        np.testing.assert_allclose(
            np.sum(found[1:, 1] * data.xaxis[1:], axis=1), 0.0, atol=1e-10 * scale
        )


def test_what_is_sensed_weight_and_water_are_the_rate_of_momentum():
    """Of what hangs on each joint; the momentum from finite differences."""
    model, handle = chain()
    data, model.opt.timestep = mujoco.MjData(model), 1e-5
    oracle.random_state(model, data, 1)

    def momenta() -> np.ndarray:
        mujoco.mj_forward(model, data)
        mujoco.mj_subtreeVel(model, data)
        return model.body_subtreemass[1:, None] * data.subtree_linvel[1:]

    before = momenta()
    mujoco.mj_step(model, data)
    momenta()
    loads = handle.forces(data)
    found = sensed(model, data)[:, 0]
    mujoco.mj_step(model, data)
    rate = (momenta() - before) / (2.0 * model.opt.timestep)
    water_loads = sum(loads.values())
    below = np.cumsum(water_loads[::-1], axis=0)[::-1]  # of a chain: all from joint i on
    weight = model.body_subtreemass[1:, None] * model.opt.gravity
    np.testing.assert_allclose(found + weight + below, rate, atol=1e-5 * np.max(np.abs(rate)))


def test_copies_and_rollouts_sense_the_same_and_detaching_gives_the_sensors_back():
    model, _ = chain()
    data = mujoco.MjData(model)
    oracle.random_state(model, data)
    twin, other = copy.deepcopy(model), copy.copy(data)
    kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
    start = np.empty(mujoco.mj_stateSize(model, kind))
    mujoco.mj_getState(model, data, start, kind)
    mujoco.mj_step(model, data, nstep=3)
    mujoco.mj_step(twin, other, nstep=3)
    _, readings = mujoco.rollout.rollout(model, mujoco.MjData(model), start, nstep=3)
    np.testing.assert_array_equal(other.sensordata, data.sensordata)
    np.testing.assert_array_equal(readings[0, -1], data.sensordata)
    water.attach(model, oracle.elements(N)).detach()
    forces = mujoco.mjtSensor.mjSENS_FORCE, mujoco.mjtSensor.mjSENS_TORQUE
    assert model.sensor_type.tolist() == [int(kind) for kind in forces] * N
    assert np.all(model.sensor_refid == -1)


def test_a_sensor_callback_that_was_there_still_runs():
    calls: list[int] = []
    there = mujoco.get_mjcb_sensor()
    try:
        mujoco.set_mjcb_sensor(lambda model, data, stage: calls.append(stage))
        model, _ = chain()
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        assert calls
        assert np.max(np.abs(data.sensordata)) > 0.1
    finally:
        mujoco.set_mjcb_sensor(there)


def test_the_joints_of_a_swimming_robot_sense_their_drives_and_a_free_one_nothing():
    robot = lc.load_robot("mamba-modules-fin")
    medium = lc.load_water("paper-lateral")
    spec = mjcf.build_spec(robot, medium, actuators="servo", visuals=False)
    spec.delete(next(a for a in spec.actuators if a.target == "joint_8"))
    model = water.compile_spec(spec)
    free = model.joint("joint_8").dofadr[0]
    model.dof_damping[free] = model.dof_frictionloss[free] = model.dof_armature[free] = 0.0
    model.opt.tolerance = 1e-14
    water.attach(model, robot_elements(robot, medium), surface=0.0, form="relative")
    data = mujoco.MjData(model)
    driven = [model.actuator(k).trnid[0] for k in range(model.nu)]
    for step in range(600):
        phase = 2.3 * data.time - 0.35 * np.arange(model.nu)
        data.ctrl[:] = 0.4 * min(1.0, data.time) * np.sin(phase)
        mujoco.mj_step(model, data)
        if step % 50 == 49:
            mujoco.mj_forward(model, data)
            worst = 0.0
            for j in range(18):
                joint = model.joint(f"joint_{j}")
                site = model.site(f"module_{j + 1}_tail").id
                torque = data.site_xmat[site].reshape(3, 3) @ data.sensor(f"torque_{j + 1}").data
                about, dof = torque @ data.xaxis[joint.id], joint.dofadr[0]
                drive = data.qfrc_actuator[dof] + data.qfrc_spring[dof] + data.qfrc_damper[dof]
                drive += data.qfrc_constraint[dof] - model.dof_armature[dof] * data.qacc[dof]
                worst = max(worst, abs(about - drive))
                if joint.id not in driven:
                    assert abs(about) < 1e-6
            assert worst < 1e-6
    assert np.max(np.abs(data.qfrc_actuator)) > 0.1
