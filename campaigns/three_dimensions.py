"""Does Mamba do in three dimensions what it is asked for: hold a depth, swim a helix, go around an upright pipe?

Question: four runs of the robot that is 1 % lighter than its water, with servo joints: a depth step
of 0.3 m; a helix of one and a half turns of 1.2 m radius, 0.6 m down, without its surroundings; the
same around a pipe that stands in the model, which it must not touch; and examples/lab/pipe.toml
through modules and cameras in the virtual tank (stepped). Depth and place count by the truth, after
60 s, as means over the gait's cycle. A depth has to be held within 2 cm (in the lab the axis is
measured, and the center of mass lies 0.5 cm below it), a path or a radius within 10 cm.

    python campaigns/three_dimensions.py

The tests run slices of it, in tests/control/test_following.py, tests/tank/operate/test_in_space.py and
tests/show/cockpit/test_controls.py.

Last answer (2 shared cores, 2026-11-22; some 4 minutes):
    depth step from 0.5 to 0.8 m       depth within 0.5 cm, path within 0.0 cm
    helix, 1.5 turns, 0.6 m down       depth within 1.8 cm, path within 2.4 cm
    the same around an upright pipe    depth within 1.8 cm, path within 2.4 cm
                                       largest force of the pipe on the robot 0 N
    examples/lab/pipe.toml in the lab  depth within 1.4 cm, path within 2.1 cm
"""

import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

import laticauda as lc
from laticauda.control import Following
from laticauda.models.spatial.scene import Pipe
from laticauda.tank.lab import LabSettings, Tank, VirtualRobot
from laticauda.tank.operate import Decision
from laticauda.tank.operate.loop import run_loop
from laticauda.tank.operate.procedure.operator import Operator
from laticauda.tank.operate.settings import load_operation
from laticauda.tank.operate.tank_devices import TankDevices

ROBOT, WATER = lc.load_robot("mamba-modules"), lc.load_water("paper-lateral")
GAIT = lc.lateral_undulation(
    amplitude=math.radians(30), frequency=math.radians(130), phase_shift=math.radians(40)
)
CYCLE = 2.0 * math.pi / GAIT.frequency
UPRIGHT = Pipe(bore=0.2, length=1.5, center=(0.0, 0.0, -0.75), tilt=0.5 * math.pi)
AROUND = {"guidance": "integral_line_of_sight", "integral_gain": 0.02, "look_ahead_distance": 0.5}


def mean_over_cycles(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Running means over a gait cycle, at an even pace."""
    n = max(round(CYCLE / float(np.median(np.diff(time)))), 1)
    return np.convolve(values, np.full(n, 1.0 / n), mode="valid")


def judged(name: str, time: np.ndarray, away: dict[str, tuple[np.ndarray, float]]) -> bool:
    """Print the largest deviations after the transient [cm], and say whether all are within what they may be [m]."""
    late = time > time[0] + 60.0
    found = {
        what: float(np.abs(mean_over_cycles(time[late], one[late])).max())
        for what, (one, _) in away.items()
    }
    fine = all(found[what] < most for what, (_, most) in away.items())
    words = ", ".join(f"{what} within {100 * one:.1f} cm" for what, one in found.items())
    print(f"    {name:34} {words}{'' if fine else '  TOO FAR'}", flush=True)
    return fine


def simulated(
    name: str, duration: float, place: tuple[float, float], following: Following, **model: object
) -> bool:
    """One run of the model."""
    start = lc.Start(center_of_mass=place, depth=0.5)
    body = lc.build_plant(ROBOT, WATER, model="spatial", joints="servo", **model)
    trial = lc.run(
        body,
        following.controller(GAIT),
        duration,
        start=start,
        link_forces="scene" in model,
        throw=True,
    )
    away = {
        "depth": (trial.signals["height_error"], 0.02),
        "path": (trial.signals["cross_track_error"], 0.1),
    }
    fine = judged(name, trial.time, away)
    if "scene" in model:
        touched = float(np.abs(trial.link_force["contact"]).max())
        print(f"    {'':34} largest force of the pipe on the robot {touched:g} N", flush=True)
        fine = fine and touched == 0.0
    return fine


def operated() -> bool:
    """The trial file of the lab, through modules and cameras."""
    operation = replace(
        load_operation(Path(__file__).parents[1] / "examples/lab/pipe.toml"), duration=120.0
    )
    pipe = replace(UPRIGHT, center=(3.0, 0.0, -0.75))
    body = lc.build_plant(ROBOT, WATER, model="spatial", joints="servo", scene=pipe)
    tank = Tank(
        VirtualRobot(ROBOT, body, lc.Start(center_of_mass=(3.0, -1.5), depth=0.5)), LabSettings()
    )
    rows: list[tuple[float, ...]] = []

    def show(state, outputs):
        if state.phase == "running" and state.estimate is not None:
            x, y, z = tank.truth.center_of_mass
            signals = next(
                (one.signals for one in outputs.entries if isinstance(one, Decision)), {}
            )
            profile = operation.controller().profile
            along = signals.get("along_track_distance", rows[-1][3] if rows else 0.0)
            asked = profile.locate(0, np.array([along, 0.0]))[
                1
            ].cross_track_error  # height of 0 above the profile
            rows.append((state.now, z + asked, math.hypot(x - 3.0, y) - 1.5, along))

    devices = TankDevices(tank, has_meter=False)
    state, _ = run_loop(Operator(operation=operation), devices, show=show, longest=600.0)
    time, height, radius, _ = np.array(rows).T
    fine = judged(
        "examples/lab/pipe.toml in the lab", time, {"depth": (height, 0.02), "path": (radius, 0.1)}
    )
    return fine and not state.failure and not state.stopped_by


def main() -> int:
    """All of it."""
    circle = Following(circle=(0.0, 0.0, 1.2, 1.5), path_depth=(0.5, 1.1), **AROUND)
    print(
        "Mamba, 1 % lighter than its water, servo joints; after 60 s, means over the gait's cycle:",
        flush=True,
    )
    fine = [
        simulated(
            "depth step from 0.5 to 0.8 m",
            100.0,
            (0.0, 0.0),
            Following(path_depth=(0.8,), look_ahead_distance=0.5),
        ),
        simulated("helix, 1.5 turns, 0.6 m down", 140.0, (0.0, -1.2), circle),
        simulated("the same around an upright pipe", 140.0, (0.0, -1.2), circle, scene=UPRIGHT),
        operated(),
    ]
    print("all as asked" if all(fine) else "NOT as asked")
    return 0 if all(fine) else 1


if __name__ == "__main__":
    sys.exit(main())
