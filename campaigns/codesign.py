"""Does the gradient design a better eel than CMA-ES, at an equal number of trials?

    python campaigns/codesign.py           # the stored table in words
    python campaigns/codesign.py --write   # run what is not in codesign.csv yet (30 s of processor time a search)

60 numbers of body, fin and gait of `examples/eel.toml` are sought at once, for the highest speed with
one servo in all joints, one battery that has to last for 5 km, at most 7 kg, and as heavy as the water
that it displaces. What slopes cost counts as trials: one for each number (peaks of joints are
differentiated by differences) and nine for each figure that is differentiated backward in time. Every
search begins at the robot as it is. Five seeds of CMA-ES stand against one run along the slopes, whose
seed matters only where it explores.
"""

import argparse
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from _rows import append_row, stored

import laticauda as lc
from laticauda.models.simulate import run_scenario
from laticauda.robot import with_servos
from laticauda.studies import Method, Optimization, optimize

TABLE = Path(__file__).with_suffix(".csv")
BODY = Path(__file__).parent.parent / "examples" / "eel.toml"
SERVO = "xw540-t140"
BUDGET = 4000
"""Trials of every search."""
DURATION = 12.0
"""Duration of a trial [s]."""
RAMP = 2.0
"""Duration of the smooth start: without one, joints are strained most by starting [s]."""
N_MODULES = 10
MASS_OF_PARTS = 0.4
"""Mass of a module without ballast: servo, shell, a share of the battery [kg]."""
PROBLEMS = ("masses", "ballast")
METHODS: tuple[Method, ...] = ("slopes", "cma-es")
JOBS: list[tuple[str, Method, int]] = [
    ("masses", "slopes", 0),
    *(("masses", "cma-es", seed) for seed in range(5)),
    ("ballast", "slopes", 0),
    *(("ballast", "cma-es", seed) for seed in range(5)),
]
"""Problem, method and seed of every search."""


@dataclass(frozen=True)
class Run:
    """A search, and the best design that it found."""

    problem: str
    method: str
    seed: int
    trials: int
    slope_trials: int
    """Trials that slopes cost, among `trials`."""
    infeasible: int
    """Points that were refused."""
    seconds: float
    """Processor time [s]."""
    start: float
    """Speed of the robot with which it began [m/s]."""
    speed: float
    """Speed of the best design [m/s]."""
    battery: float
    """Share of the battery that it takes [-]."""
    utilization: float
    """Share of the servos that it uses [-]."""
    mass: float
    """Its mass [kg]."""


def bounds_of_body(*, with_masses: bool) -> dict[str, tuple[float, float]]:
    """Return the ranges of the numbers that are sought.

    Args:
        with_masses: Whether masses of modules are among them; they are 60 numbers then, else 50.
    """
    modules = range(N_MODULES)
    bounds: dict[str, tuple[float, float]] = {}
    for i in modules:
        bounds[f"robot.module[{i}].length"] = (0.09, 0.2)
        bounds[f"robot.module[{i}].section.half_height"] = (0.035, 0.06)
        bounds[f"robot.module[{i}].section.half_width"] = (0.03, 0.05)
    if with_masses:
        for i in modules:
            bounds[f"robot.module[{i}].mass"] = (0.35, 1.5)
    bounds["robot.caudal_fin.length"] = (0.08, 0.3)
    bounds["robot.caudal_fin.height"] = (0.06, 0.2)
    for i in range(N_MODULES - 1):
        bounds[f"gait.amplitude[{i}]"] = (0.05, 0.9)
    for i in range(1, N_MODULES - 1):
        bounds[f"gait.phase[{i}]"] = (-1.5, 1.5)
    bounds["gait.frequency"] = (1.0, 8.0)
    return bounds


def make_problem(name: str) -> Optimization:
    """Return a problem: masses of modules are sought, too, or follow from ballast.

    Args:
        name: `masses` or `ballast`.
    """
    with_ballast = name == "ballast"
    robot = with_servos(lc.load_robot(BODY), SERVO)
    if with_ballast:
        modules = tuple(replace(module, mass=MASS_OF_PARTS) for module in robot.modules)
        robot = replace(robot, modules=modules)
    gait = lc.eel_like(amplitude=0.5, frequency=3.0, phase_shift=0.6)
    return Optimization(
        scenario=lc.build_scenario(robot, gait, DURATION, ramp=RAMP),
        bounds=bounds_of_body(with_masses=not with_ballast),
        objectives="forward_velocity",
        battery=60.0,
        battery_range=5000.0,
        servo_share=0.5,
        most_mass=7.0,
        buoyancy_tolerance=None if with_ballast else 0.01,
        ballast=with_ballast,
    )


def run(problem: str, method: Method, seed: int) -> Run:
    """Run one search.

    Args:
        problem: Name of the problem.
        method: Name of the search.
        seed: Its seed.
    """
    sought = make_problem(problem)
    begin = time.process_time()
    front = optimize(sought, budget=BUDGET, method=method, seed=seed, threads=1)
    seconds = time.process_time() - begin
    first = run_scenario(sought.scenario, lc.build_plant(sought.scenario))
    figures = {name: float(values[0]) for name, values in front.figures.items()}
    robot = front.scenario(0).robot
    joules_per_meter = (figures["mean_power"] + robot.idle_power) / figures["speed_through_water"]
    return Run(
        problem=problem,
        method=method,
        seed=seed,
        trials=front.n_trials + front.n_slope_trials,
        slope_trials=front.n_slope_trials,
        infeasible=front.n_infeasible,
        seconds=round(seconds, 1),
        start=round(first.forward_velocity, 4),
        speed=round(figures["forward_velocity"], 4),
        battery=round(joules_per_meter * 5000.0 / (60.0 * 3600.0), 4),
        utilization=round(figures["utilization"], 4),
        mass=round(robot.mass, 3),
    )


def read_table() -> list[Run]:
    """Return the stored runs."""
    return stored(TABLE, Run)


def summarize(runs: list[Run]) -> str:
    """Return what the table says, a line for each problem and method.

    Args:
        runs: The runs.
    """
    lines: list[str] = []
    for problem in PROBLEMS:
        for method in METHODS:
            similar_runs = [run for run in runs if (run.problem, run.method) == (problem, method)]
            if not similar_runs:
                continue
            speeds = np.array([run.speed for run in similar_runs])
            seconds = np.mean([run.seconds for run in similar_runs])
            lines.append(
                f"{problem}, {method}: {len(similar_runs)} runs of at most {BUDGET} trials, best {speeds.max():.3f}, "
                f"median {np.median(speeds):.3f}, worst {speeds.min():.3f} m/s, {seconds:.0f} s each"
            )
    return "\n".join(lines)


def main() -> None:
    """Run all searches, or print what is stored."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    if arguments.write:
        stored_jobs = {(run.problem, run.method, run.seed) for run in read_table()}
        for problem, method, seed in JOBS:
            if (problem, method, seed) not in stored_jobs:
                result = run(problem, method, seed)
                append_row(TABLE, result)
                print(result, flush=True)
    print(summarize(read_table()))


if __name__ == "__main__":
    main()
