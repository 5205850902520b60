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
        joint = (
            f'<joint name="j{i}" axis="0 {1 - i % 2} {i % 2}" damping="0.3"/>'
            if i
            else "<freejoint/>"
        )
        text += f'<body name="b{i}" pos="{0.09 * (i > 0)} 0 0">{joint}<geom name="g{i}" type="ellipsoid" '
        text += f'size=".045 .04 .045" pos=".045 0 0" density="1000" contype="0" conaffinity="0" {shape}/>'
    text += "</body>" * N + "</worldbody><actuator>"
    text += "".join(f'<position joint="j{i}" kp="3"/>' for i in range(1, N))
    return mujoco.MjSpec.from_string(text + "</actuator></mujoco>")


def controls(step: float, motion: str) -> np.ndarray:
    """A traveling wave along the yaw joints and another along the pitch joints, growing over the first second."""
    t = np.arange(round(DURATION / step))[:, np.newaxis] * step
    joint = np.arange(1, N)
    amplitude = np.deg2rad(np.where(joint % 2, 30.0, 20.0 if motion == "in space" else 0.0))
    phase = np.deg2rad(20.0) * joint + np.where(joint % 2, 0.0, np.pi / 2.0)
    return amplitude * np.minimum(t, 1.0) * np.sin(np.deg2rad(130.0) * t + phase)


def swum(model: mujoco.MjModel, step: float, repeats: int, motion: str) -> tuple[np.ndarray, float]:
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
    robot, water_ = lc.load_robot("mamba").with_links(N), lc.load_water("paper-lateral")
    for joints in ("prescribed", "pd"):
        body = build_plant(
            robot, water_, model="spatial", joints=joints, dt=STEP, root="free", gravity=False
        )
        run(body, OpenLoop(command=Command(gait=GAIT)), 0.1)
        begin = time.process_time()
        run(body, OpenLoop(command=Command(gait=GAIT)), 10.0)
        rates[joints] = 10.0 / STEP / (time.process_time() - begin)
    return rates


def against(older: str) -> None:
    """The same with the sources of another version, in turns; each in processes of its own."""
    best: dict[str, dict[str, float]] = {}
    for _ in range(ROUNDS):
        for sources in (older, os.environ.get("PYTHONPATH", "")):
            told = {**os.environ, "PYTHONPATH": sources}
            done = subprocess.run(
                [sys.executable, __file__, "--marches"], env=told, capture_output=True, check=True
            )
            for joints, rate in (line.split() for line in done.stdout.decode().splitlines()):
                mine = best.setdefault(joints, {})
                mine[sources] = max(mine.get(sources, 0.0), float(rate))
    for joints, rates in best.items():
        before, now = rates.values()
        print(
            f"SpatialPlant, {joints:<12}{before:>10,.0f} before{now:>10,.0f} now{now / before:>8.2f} x"
        )


def threads() -> None:
    """Wall time of 24 trials of 20 s on one thread over that on two."""
    gaits = [
        lc.lateral_undulation(amplitude=a, frequency=2.27, phase_shift=0.7)
        for a in np.linspace(0.2, 0.6, 24)
    ]
    best = dict.fromkeys((1, 2), np.inf)
    for _ in range(ROUNDS):
        for n in best:
            begin = time.perf_counter()
            lc.swim_many(lc.load_robot("mamba"), gaits, 20.0, model="spatial", threads=n)
            best[n] = min(best[n], time.perf_counter() - begin)
    print(
        f"swim_many, 24 spatial trials: two threads are {best[1] / best[2]:.2f} times as fast as one"
    )


def beside() -> None:
    """How a planar trial fares beside a march in space: its longest wait, as a share of that march."""
    robot = lc.load_robot("mamba")
    body, command = (
        build_plant(robot, lc.load_water("paper-lateral"), model="spatial"),
        Command(gait=GAIT),
    )
    start = body.init(lc.Start(), command)
    lc.swim(robot, GAIT, 0.1)
    shares: list[float] = []
    for _ in range(ROUNDS):
        march = threading.Thread(target=body.march, args=(start, command, 300.0, 300.0))
        begin = last = time.perf_counter()
        march.start()
        longest = 0.0
        while march.is_alive():
            lc.swim(robot, GAIT, 0.1)
            now = time.perf_counter()
            longest, last = max(longest, now - last), now
        shares.append(longest / (last - begin))
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
    told = parser.parse_args()
    if told.marches:
        print("\n".join(f"{joints} {rate}" for joints, rate in marches().items()))
        return
    print_load()
    threads()
    beside()
    if told.against:
        against(told.against)
        return
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
        own = 0.0
        print(motion)
        for name, model in models.items():
            path, rate = swum(model, STEP, 3, motion)
            if "ellipsoids, implicitfast" in name:
                own = rate
            fine, _ = swum(model, FINE, 1, motion)
            traveled = float(np.sum(np.linalg.norm(np.diff(fine, axis=0), axis=1)))
            apart = float(np.linalg.norm(path[-1] - fine[-1]))
            error = f"{apart / traveled:.1e}" if "bare" not in name else "-"
            print(
                f"{name:<44}{rate:>10,.0f}{f'{rate / own:.1f}' if own else '-':>8}{error:>15}",
                flush=True,
            )
    for joints, rate in marches().items():
        name = f"SpatialPlant, {joints}, {4 if joints == 'prescribed' else 2} evaluations a step"
        print(f"{name:<44}{rate:>10,.0f}")


if __name__ == "__main__":
    main()
