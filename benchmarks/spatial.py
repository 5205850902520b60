"""How fast is MuJoCo with water, exact added mass included, beside MuJoCo's own ellipsoid fluid model?

Question: on the same chain of 20 ellipsoids, its joints alternating as Mamba's and driven by
position servos, with the same step of 2 ms, is it at least 8 times as fast as the ellipsoid model
under implicitfast, and how far is each from its own run with a fine step? In space both kinds of
joints move; in the plane the pitch joints stand still, and MuJoCo skips what is zero in its
derivative. Single thread, `mujoco.rollout`, processor time, best of three; error: distance of the
end point from that of the fine run after 10 s, over the distance traveled.

Besides: are two threads at least 1.8 times as fast as one (`swim_many`); is a planar trial frozen
by a march in space; and with `--against SRC`, in turns in one run, is the model as fast as that of
other sources?

Last answer (2026-11-22), two cores shared with other work, at real-time priority:
    in space      MuJoCo's ellipsoids, implicitfast     6 000 steps/s    error 3.1e-03
                  water, implicitfast                  83 000           13.9 x    1.2e-02
                  water, Euler                         84 000           14.1 x    1.2e-02
    in the plane  MuJoCo's ellipsoids, implicitfast    15 900           error 2.0e-03
                  water, implicitfast                  86 000            5.4 x    2.7e-03
                  no water                            133 000
    SpatialPlant  prescribed (RK4) 22 400, pd (of order 2 then) 43 800
    against the version before water that accelerates, scenes and threads: prescribed 1.00 x, pd 0.99 x
    24 trials of 20 s: two threads 1.90 times as fast as one
    planar trials beside a march wait at most 0.002 of its time (1: it freezes them)
"""

import argparse
import os
import subprocess
import sys
import threading
import time

import mujoco
import mujoco.rollout
import numpy as np
from _timing import print_load

import laticauda as lc
from laticauda.models.simulate import build_plant, run
from laticauda.scenarios.interfaces import Command, OpenLoop
from laticauda.water import mujoco as water

N, DURATION, STEP, FINE = 20, 10.0, 2e-3, 1e-4
ROUNDS = 5
GAIT = lc.lateral_undulation(amplitude=0.26, frequency=2.27, phase_shift=0.35)
OWN = 'density="1000" viscosity="9e-4"'


def chain(option: str, *, ellipsoid: bool) -> mujoco.MjSpec:
    """A chain of neutrally buoyant ellipsoids with position servos."""
    text = f'<mujoco><option gravity="0 0 0" {option}/><worldbody>'
    shape = 'fluidshape="ellipsoid"' if ellipsoid else ""
    for i in range(N):
        joint = f'<joint name="j{i}" axis="0 {1 - i % 2} {i % 2}" damping="0.3"/>'
        if i == 0:
            joint = "<freejoint/>"
        text += f'<body name="b{i}" pos="{0.09 * (i > 0)} 0 0">{joint}<geom name="g{i}" type="ellipsoid" '
        text += f'size=".045 .04 .045" pos=".045 0 0" density="1000" contype="0" conaffinity="0" {shape}/>'
    text += "</body>" * N + "</worldbody><actuator>"
    text += "".join(f'<position joint="j{i}" kp="3"/>' for i in range(1, N))
    return mujoco.MjSpec.from_string(text + "</actuator></mujoco>")


def controls(step: float, motion: str) -> np.ndarray:
    """A traveling wave along the yaw joints and another along the pitch joints, growing over the first second."""
    t = np.arange(round(DURATION / step))[:, np.newaxis] * step
    joint = np.arange(1, N)
    is_yaw = joint % 2 == 1
    pitch_amplitude = 20.0 if motion == "in space" else 0.0
    amplitude = np.deg2rad(np.where(is_yaw, 30.0, pitch_amplitude))
    phase = np.deg2rad(20.0) * joint + np.where(is_yaw, 0.0, np.pi / 2.0)
    return amplitude * np.minimum(t, 1.0) * np.sin(np.deg2rad(130.0) * t + phase)


def roll_out(
    model: mujoco.MjModel, step: float, repeats: int, motion: str
) -> tuple[np.ndarray, float]:
    """Path of the tail module, and steps per second."""
    model.opt.timestep = step
    data = mujoco.MjData(model)
    kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
    start = np.zeros(mujoco.mj_stateSize(model, kind))
    mujoco.mj_getState(model, data, start, kind)
    control = controls(step, motion)
    fastest = np.inf
    for _ in range(repeats):
        begin = time.process_time()
        states, _ = mujoco.rollout.rollout(model, data, start, control)
        fastest = min(fastest, time.process_time() - begin)
    return states[0, :, 1:4], len(control) / fastest


def wet(integrator: str, *, implicit_drag: bool = False) -> mujoco.MjModel:
    """The chain with our water."""
    model = water.compile_spec(chain(f'integrator="{integrator}"', ellipsoid=False))
    elements = [
        water.geom_element(model, f"g{i}", water.GeomCoefficients(rotational_drag=1.0))
        for i in range(N)
    ]
    water.attach(model, elements, implicit_drag=implicit_drag)
    return model


def marches() -> dict[str, float]:
    """Steps per second of processor time of a plant's two kinds of joints."""
    rates: dict[str, float] = {}
    robot = lc.load_robot("mamba").with_links(N)
    environment = lc.load_water("paper-lateral")
    controller = OpenLoop(command=Command(gait=GAIT))
    for joints in ("prescribed", "pd"):
        plant = build_plant(
            robot, environment, model="spatial", joints=joints, dt=STEP, root="free", gravity=False
        )
        run(plant, controller, 0.1)
        begin = time.process_time()
        run(plant, controller, 10.0)
        rates[joints] = 10.0 / STEP / (time.process_time() - begin)
    return rates


def marches_elsewhere(sources: str) -> dict[str, float]:
    """The same with some sources of the package, in a process of its own."""
    process = subprocess.run(
        [sys.executable, __file__, "--marches"],
        env={**os.environ, "PYTHONPATH": sources},
        capture_output=True,
        text=True,
        check=True,
    )
    rates: dict[str, float] = {}
    for line in process.stdout.splitlines():
        joints, rate = line.split()
        rates[joints] = float(rate)
    return rates


def larger_of_both(rates: dict[str, float], others: dict[str, float]) -> dict[str, float]:
    return {joints: max(rate, rates.get(joints, 0.0)) for joints, rate in others.items()}


def against(older: str) -> None:
    """Print the best rates of another version's sources and of these, in turns."""
    rates_before: dict[str, float] = {}
    rates_now: dict[str, float] = {}
    for _ in range(ROUNDS):
        rates_before = larger_of_both(rates_before, marches_elsewhere(older))
        own_sources = os.environ.get("PYTHONPATH", "")
        rates_now = larger_of_both(rates_now, marches_elsewhere(own_sources))
    for joints, before in rates_before.items():
        now = rates_now[joints]
        print(
            f"SpatialPlant, {joints:<12}{before:>10,.0f} before{now:>10,.0f} now{now / before:>8.2f} x"
        )


def threads() -> None:
    """Wall time of 24 trials of 20 s on one thread over that on two."""
    gaits = [
        lc.lateral_undulation(amplitude=a, frequency=2.27, phase_shift=0.7)
        for a in np.linspace(0.2, 0.6, 24)
    ]
    robot = lc.load_robot("mamba")
    least_time = dict.fromkeys((1, 2), np.inf)
    for _ in range(ROUNDS):
        for n in least_time:
            begin = time.perf_counter()
            lc.swim_many(robot, gaits, 20.0, model="spatial", threads=n)
            least_time[n] = min(least_time[n], time.perf_counter() - begin)
    gain = least_time[1] / least_time[2]
    print(f"swim_many, 24 spatial trials: two threads are {gain:.2f} times as fast as one")


def beside() -> None:
    """How a planar trial fares beside a march in space: its longest wait, as a share of that march."""
    robot = lc.load_robot("mamba")
    plant = build_plant(robot, lc.load_water("paper-lateral"), model="spatial")
    command = Command(gait=GAIT)
    start = plant.init(lc.Start(), command)
    lc.swim(robot, GAIT, 0.1)
    shares: list[float] = []
    for _ in range(ROUNDS):
        march = threading.Thread(target=plant.march, args=(start, command, 300.0, 300.0))
        moments = [time.perf_counter()]
        march.start()
        while march.is_alive():
            lc.swim(robot, GAIT, 0.1)
            moments.append(time.perf_counter())
        shares.append(max(np.diff(moments)) / (moments[-1] - moments[0]))
    print(
        f"planar trials beside a march in space wait at most {min(shares):.3f} of its time (1: it freezes them)"
    )


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--marches", action="store_true", help="print only the steps per second of SpatialPlant"
    )
    parser.add_argument(
        "--against", metavar="SRC", help="sources of another version to compare with, in one run"
    )
    options = parser.parse_args()
    if options.marches:
        for joints, rate in marches().items():
            print(joints, rate)
        return
    print_load()
    threads()
    beside()
    if options.against:
        against(options.against)
        return
    compare_models()
    for joints, rate in marches().items():
        evaluations = 4 if joints == "prescribed" else 2
        name = f"SpatialPlant, {joints}, {evaluations} evaluations a step"
        print(f"{name:<44}{rate:>10,.0f}")


def compare_models() -> None:
    """Print the rate of every model, beside that of MuJoCo's ellipsoids, and its error."""
    print(f"{'model':<44}{'steps/s':>10}{'ratio':>8}{'error at 2 ms':>15}")
    models = {
        "bare (no water)": chain("", ellipsoid=False).compile(),
        "MuJoCo's ellipsoids, implicitfast": chain(
            OWN + ' integrator="implicitfast"', ellipsoid=True
        ).compile(),
        "MuJoCo's ellipsoids, Euler": chain(OWN + ' integrator="Euler"', ellipsoid=True).compile(),
        "water with exact added mass, implicitfast": wet("implicitfast"),
        "water with exact added mass, Euler": wet("Euler"),
        "water, implicit drag, Euler": wet("Euler", implicit_drag=True),
    }
    for motion in ("in space", "in the plane"):
        reference_rate = 0.0
        print(motion)
        for name, model in models.items():
            path, rate = roll_out(model, STEP, 3, motion)
            if "ellipsoids, implicitfast" in name:
                reference_rate = rate
            fine_path, _ = roll_out(model, FINE, 1, motion)
            ratio = f"{rate / reference_rate:.1f}" if reference_rate else "-"
            error = f"{relative_error(path, fine_path):.1e}"
            if "bare" in name:
                error = "-"
            print(f"{name:<44}{rate:>10,.0f}{ratio:>8}{error:>15}", flush=True)


def relative_error(path: np.ndarray, fine_path: np.ndarray) -> float:
    """Distance of the ends, over the distance traveled [-]."""
    traveled = float(np.sum(np.linalg.norm(np.diff(fine_path, axis=0), axis=1)))
    return float(np.linalg.norm(path[-1] - fine_path[-1])) / traveled


if __name__ == "__main__":
    main()
