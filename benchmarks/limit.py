"""How far is the package from what the machine can do, and what does each of its ways to swim cost?

Question: what does a trial of 30 s and ten links with prescribed joints cost in `swim_many`, with a
gait for every trial and in columns, and in the kernel alone, against a hand-written program that
does the same work, in turns? And how far from its limit does such a trial end?

PROGRAM is such a program, with the same method, step, torques, work and samples: called with a
number of rounds, it prints a line that ends in `ms/trial` and a number. Look where its trial ends
before its speed is believed: -ffast-math removes what keeps its sines right. Then the time of one
core of the other calls; with `--against`, of another version of the package too.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import cast

import numpy as np
from _timing import fastest, of_links, print_load, random_gaits

import laticauda as lc
from laticauda.models.planar import COMMAND, FILTERED_COMMAND, PATH_ROWS, WIDTH, aligned
from laticauda.models.simulate import make_run_table

TRIALS, ROUNDS = 1600, 7
DURATION, STEP = 30.0, 0.05
CONVERGED_TRIALS = 160
"""Trials that are run with a small step, too."""
SMALLER_STEP = STEP / 16
CONVERGED = 1e-6
"""Distance of the end from that of a run with a small step, relative to the distance swum, that is asked for."""
PROGRAM_GAIT = lc.lateral_undulation(
    amplitude=np.deg2rad(30), frequency=np.deg2rad(130), phase_shift=np.deg2rad(40)
)
"""The gait of the reference program's first trial."""
WAVE = ("amplitude", "frequency", "phase_shift")


def time_program(program: Path) -> float:
    """Return the processor time per trial of the reference program, without what it takes to begin [s]."""
    user_before = os.times().children_user
    start = time.perf_counter()
    process = subprocess.run([program, "400"], capture_output=True, text=True, check=True)
    share_of_core = (os.times().children_user - user_before) / (time.perf_counter() - start)
    milliseconds = float(re.findall(r"ms/trial\s+([\d.]+)", process.stdout)[0])
    return 1e-3 * milliseconds * min(1.0, share_of_core)


class Batch:
    """The trials, in the three ways in which they can be run on one core."""

    def __init__(self) -> None:
        self.robot = of_links(10)
        self.gaits = random_gaits(TRIALS)
        self.scenario = lc.build_scenario(self.robot, self.gaits[0], DURATION)
        self.columns = {
            f"gait.{name}": np.array([getattr(gait, name) for gait in self.gaits]) for name in WAVE
        }

    def run_gaits(self) -> None:
        """Run them with an object for every trial."""
        lc.swim_many(self.robot, self.gaits, DURATION, threads=1)

    def run_columns(self) -> None:
        """Run them without one."""
        lc.swim_many(self.scenario, columns=self.columns, threads=1)

    def run_kernel(self) -> None:
        """Run the kernel alone."""
        table = make_run_table(self.scenario, self.columns)
        plant = table.bases[0].plant
        march = plant.kernels_of(WIDTH).run
        rows_of_base = np.repeat(table.bases[0].rows[:, np.newaxis], WIDTH, axis=1)
        lanes = aligned(rows_of_base.shape, float)
        n_steps = round(DURATION / STEP)
        log = aligned((1 + n_steps, PATH_ROWS, WIDTH), float)
        for first in range(0, TRIALS, WIDTH):
            waves = table.waves[:, first : first + WIDTH]
            lanes[:] = rows_of_base
            lanes[COMMAND] = waves
            lanes[FILTERED_COMMAND] = waves[: len(FILTERED_COMMAND)]
            march(lanes, *plant.layout.chain, plant.is_implicit, n_steps, STEP, 1, log)

    def print_ratios(self, program: Path) -> None:
        """Print the processor time of all three relative to the program's, in turns."""
        ways = {
            "gaits": self.run_gaits,
            "columns": self.run_columns,
            "kernel alone": self.run_kernel,
        }
        ratios: dict[str, list[float]] = {name: [] for name in ways}
        for run in ways.values():
            run()
        for _ in range(ROUNDS):
            reference = time_program(program)
            print(f"program {1e3 * reference:.3f} ms", end="")
            for name, run in ways.items():
                start = time.process_time()
                run()
                own = (time.process_time() - start) / TRIALS
                ratios[name].append(own / reference)
                print(f", {name} {1e3 * own:.3f} ms ({own / reference:.2f})", end="")
            print()
        for name, values in ratios.items():
            print(f"median of the ratios, {name}: {sorted(values)[ROUNDS // 2]:.2f}")

    def print_convergence(self) -> None:
        """Print how far the trials end from where those with a small step end."""
        gaits = [PROGRAM_GAIT, *self.gaits[:CONVERGED_TRIALS]]
        end = lc.swim_many(self.robot, gaits, DURATION, dt=STEP).center_of_mass
        fine_end = lc.swim_many(self.robot, gaits, DURATION, dt=SMALLER_STEP).center_of_mass
        distance = np.linalg.norm(fine_end, axis=1)
        errors = np.linalg.norm(end - fine_end, axis=1) / distance
        print(
            f"end against that of a step {STEP / SMALLER_STEP:.0f} times smaller, of the distance: "
            f"the program's gait {errors[0]:.1e}; of {CONVERGED_TRIALS} others "
            f"median {np.median(errors[1:]):.1e}, largest {np.max(errors[1:]):.1e}, "
            f"{np.sum(errors[1:] > CONVERGED)} above {CONVERGED:g}"
        )


def costs() -> dict[str, float]:
    """Least time of one core of every call [s]."""
    from laticauda.control import HeadingController, LineOfSight, PathFollowing, StraightLine
    from laticauda.models.planar.layout import build_layout
    from laticauda.models.simulate import compute_sensitivities

    robot = of_links(10)
    gaits = random_gaits(TRIALS)
    gait = gaits[0]

    def time_of(work: Callable[[], object], rounds: int = ROUNDS) -> float:
        return fastest(time.process_time, work, rounds)

    seconds: dict[str, float] = {}
    batch = time_of(lambda: lc.swim_many(robot, gaits, threads=1))
    seconds["batch, per trial"] = batch / TRIALS
    for joints in ("prescribed", "pd", "servo"):
        seconds[f"swim, {joints}"] = time_of(partial(lc.swim, robot, gait, joints=joints))
    names = ["gait.amplitude", "gait.frequency", "gait.phase_shift", "gait.offset"]
    slopes = time_of(lambda: compute_sensitivities(robot, gaits[:64], names=names, threads=1))
    seconds["derivative"] = (slopes / 64 - seconds["batch, per trial"]) / len(names)
    law = PathFollowing(
        gait=gait,
        path=StraightLine(),
        guidance=LineOfSight(look_ahead_distance=1.8),
        heading=HeadingController(gain=0.4, max_offset=0.35),
    )
    with_controller = time_of(lambda: lc.swim(robot, law, 30.0))
    without_controller = time_of(lambda: lc.swim(robot, gait))
    n_instants = 30.0 / law.interval
    seconds["control instant"] = (with_controller - without_controller) / n_instants
    water = lc.load_water("paper-lateral")
    seconds["layout"] = time_of(lambda: build_layout(robot, water), 50)
    return seconds


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=Path, nargs="?", help="the reference program")
    parser.add_argument("--against", type=Path, help="folder `src` of another version")
    parser.add_argument("--json", action="store_true", help="print the costs alone")
    given = parser.parse_args()
    if given.json:
        print(json.dumps(costs()))
        return
    batch = Batch()
    if given.program is not None:
        batch.print_ratios(given.program.resolve())
    batch.print_convergence()
    tables: dict[str, dict[str, float]] = {}
    for name, sources in {"before": given.against, "now": Path(lc.__file__).parents[1]}.items():
        if sources is not None:
            run = [sys.executable, __file__, "--json"]
            environment = {**os.environ, "PYTHONPATH": str(sources)}
            said = subprocess.run(
                run, env=environment, capture_output=True, text=True, check=True
            ).stdout
            tables[name] = cast("dict[str, float]", json.loads(said))
    print(f"{'time of one core [ms]':<24}" + "".join(f"{name:>10}" for name in tables))
    for name in tables["now"]:
        print(f"{name:<24}" + "".join(f"{1e3 * table[name]:>10.3f}" for table in tables.values()))
    print_load()


if __name__ == "__main__":
    main()
