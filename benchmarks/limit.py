"""How far is the package from what the machine can do, and what does each of its ways to swim cost?

Question: what does a trial of 30 s and ten links with prescribed joints cost in `swim_many`,
against a hand-written program that does the same work, in turns? PROGRAM is such a program: called
with a number of rounds, it prints a line that ends in `ms/trial` and a number. Then the time of one
core of the other calls; with `--against`, of another version of the package too.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import time
from pathlib import Path
from typing import cast

from _timing import fastest, of_links, print_load, random_gaits

import laticauda as lc

TRIALS, ROUNDS = 1600, 7


def reference_of(program: Path) -> float:
    """Processor time per trial of the reference program, without what it takes to begin [s]."""
    said = subprocess.run([program, "200"], capture_output=True, text=True, check=True).stdout
    wall = float(re.findall(r"ms/trial\s+([\d.]+)", said)[0])
    before = os.times()
    start = time.perf_counter()
    subprocess.run([program, "200"], capture_output=True, check=True)
    after, passed = os.times(), time.perf_counter() - start
    return 1e-3 * wall * min(1.0, (after.children_user - before.children_user) / passed)


def costs() -> dict[str, float]:
    """Least time of one core of every call [s]."""
    from laticauda.control import HeadingController, LineOfSight, PathFollowing, StraightLine
    from laticauda.models.planar.layout import build_layout
    from laticauda.models.simulate import compute_sensitivities

    robot, gaits, clock = of_links(10), random_gaits(TRIALS), time.process_time
    water, gait = lc.load_water("paper-lateral"), gaits[0]
    found = {
        "batch, per trial": fastest(clock, lambda: lc.swim_many(robot, gaits, threads=1), ROUNDS)
        / TRIALS
    }
    for joints in ("prescribed", "pd", "servo"):
        found[f"swim, {joints}"] = fastest(
            clock, lambda j=joints: lc.swim(robot, gait, joints=j), ROUNDS
        )
    names = ["gait.amplitude", "gait.frequency", "gait.phase_shift", "gait.offset"]
    slopes = fastest(
        clock, lambda: compute_sensitivities(robot, gaits[:64], names=names, threads=1), ROUNDS
    )
    found["derivative"] = (slopes / 64 - found["batch, per trial"]) / len(names)
    heading, guidance = (
        HeadingController(gain=0.4, max_offset=0.35),
        LineOfSight(look_ahead_distance=1.8),
    )
    law = PathFollowing(gait=gait, path=StraightLine(), guidance=guidance, heading=heading)
    followed = fastest(clock, lambda: lc.swim(robot, law, 30.0), ROUNDS)
    held = fastest(clock, lambda: lc.swim(robot, gait), ROUNDS)
    found["control instant"] = (followed - held) / (30.0 / law.interval)
    found["layout"] = fastest(clock, lambda: build_layout(robot, water), 50)
    return found


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
    if given.program is not None:
        robot, gaits = of_links(10), random_gaits(TRIALS)
        ratios: list[float] = []
        for _ in range(ROUNDS):
            reference = reference_of(given.program.resolve())
            own = (
                fastest(time.process_time, lambda: lc.swim_many(robot, gaits, threads=1), 1)
                / TRIALS
            )
            ratios.append(own / reference)
            print(
                f"batch {1e3 * own:.3f} ms, program {1e3 * reference:.3f} ms, ratio {own / reference:.2f}"
            )
        print(f"median of the ratios: {sorted(ratios)[ROUNDS // 2]:.2f}")
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
