"""How much faster is the planar model than MuJoCo with its own fluid, on the same robot and gait?

Question: ten of Mamba's links in the plane, pd joints, 30 s. MuJoCo's force law differs: its
ellipsoid model has drag and added-mass velocity terms of its own, on each geom, and no added-mass
inertia; so the two swim differently, and the speeds are printed to say so. MuJoCo's integrator is
implicitfast; under Euler, its ellipsoids take less time per step. Printed: time of one
core, ratio, and each one's error against its own run at a fine step, over the distance. It needs
the extra `spatial`.
"""

import time
from functools import partial

import mujoco
import mujoco.rollout
import numpy as np
from _timing import fastest, of_links, print_load

import laticauda as lc

GAIT = lc.lateral_undulation(
    amplitude=np.deg2rad(30), frequency=np.deg2rad(130), phase_shift=np.deg2rad(40)
)
DURATION = 30.0
STEPS = (0.005, 0.002)
FINE = 0.0002


def mujoco_model(robot: lc.Robot, step: float) -> mujoco.MjModel:
    """The same links and pd gains, on a root that slides and turns in the plane."""
    text = (
        f'<mujoco><option gravity="0 0 0" density="1000" viscosity="9e-4" integrator="implicitfast" timestep="{step}">'
        '<flag contact="disable"/></option><worldbody>'
    )
    for i, module in enumerate(robot.modules):
        position = robot.modules[i - 1].length
        joint = f'<joint name="j{i}" axis="0 0 1"/>'
        if i == 0:
            position = 0.0
            joint = '<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/><joint axis="0 0 1"/>'
        a, b, l = module.section.half_height, module.section.half_width, module.half_length  # noqa: E741
        text += (
            f'<body pos="{position} 0 0">{joint}<geom type="ellipsoid" size="{l} {b} {a}" pos="{l} 0 0" '
            f'mass="{module.mass}" fluidshape="ellipsoid"/>'
        )
    text += "</body>" * robot.n_links + "</worldbody><actuator>"
    for i, joint in enumerate(robot.joints, start=1):
        motor = joint.actuator
        text += (
            f'<position joint="j{i}" kp="{motor.proportional_gain}" kv="{motor.derivative_gain}"/>'
        )
    return mujoco.MjModel.from_xml_string(text + "</actuator></mujoco>")


def swim_in_mujoco(robot: lc.Robot, step: float) -> np.ndarray:
    """Where the center of mass is at the end."""
    model = mujoco_model(robot, step)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    begin = data.subtree_com[1, :2].copy()
    state = np.zeros(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    times = np.arange(round(DURATION / step))[:, np.newaxis] * step
    joint = np.arange(robot.n_joints)
    phase = GAIT.frequency * times + joint * GAIT.phase_shift
    control = GAIT.amplitude * np.minimum(times, 1.0) * np.sin(phase)
    mujoco.rollout.rollout(model, data, state[np.newaxis], control[np.newaxis])
    mujoco.mj_forward(model, data)
    return data.subtree_com[1, :2] - begin


def main() -> None:
    """Print the table."""
    robot, water = of_links(10), lc.load_water("paper-lateral")
    print(f"{'':<26}{'time [ms]':>10}{'x batch, pd':>13}{'speed [m/s]':>13}{'error':>10}")

    def time_batch(joints: str, n: int) -> float:
        """Time of one core per trial [s]."""
        swim = partial(lc.swim_many, robot, [GAIT] * n, environments=water, joints=joints)
        return fastest(time.process_time, partial(swim, threads=1), 5) / n

    batch_times = {"pd": time_batch("pd", 80), "prescribed": time_batch("prescribed", 800)}
    batch = batch_times["pd"]
    exact = swim_in_mujoco(robot, FINE)
    for step in STEPS:
        seconds = fastest(time.process_time, partial(swim_in_mujoco, robot, step), 2)
        end = swim_in_mujoco(robot, step)
        error = np.linalg.norm(end - exact) / np.linalg.norm(exact)
        speed = np.linalg.norm(end) / DURATION
        print(
            f"{f'MuJoCo, {step:g} s':<26}{1e3 * seconds:>10.1f}{seconds / batch:>13.1f}{speed:>13.3f}{error:>10.1e}"
        )
    for joints, time_in_batch in batch_times.items():
        trial = lc.swim(robot, GAIT, environment=water, joints=joints)
        dt = float(trial.settings["dt"])
        fine = lc.swim(robot, GAIT, environment=water, joints=joints, dt=dt / 16).center_of_mass[-1]
        error = np.linalg.norm(trial.center_of_mass[-1] - fine) / np.linalg.norm(fine)
        swim = partial(lc.swim, robot, GAIT, environment=water, joints=joints)
        time_alone = fastest(time.process_time, swim, 10)
        rows = {f"swim, {joints}": time_alone, f"batch, {joints}": time_in_batch}
        for name, seconds in rows.items():
            line = f"{name:<26}{1e3 * seconds:>10.2f}{seconds / batch:>13.2f}"
            print(f"{line}{trial.forward_velocity:>13.3f}{error:>10.1e}")
    print_load()


if __name__ == "__main__":
    main()
