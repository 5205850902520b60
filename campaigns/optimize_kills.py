"""Does an optimization lose anything when it is killed?

Question: an optimization is killed by SIGKILL at random moments, again and again, and resumed: is
what comes out the same, bit for bit, as without?

    python campaigns/optimize_kills.py              # 20 kills each, two objectives and one

The tests run a slice of it.

Last answer (2 shared cores, 2026-11-21):
    front  6000 trials, 20 kills hit: the same bits
    speed  6000 trials, 20 kills hit: the same bits
"""

import argparse
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

import laticauda as lc
from laticauda.studies import SPEED_POWER, Front, Optimization, optimize

PATIENCE = 120.0  # [s]
POPULATION = 12
KINDS = {"front": SPEED_POWER, "speed": ("forward_velocity",)}


def run(folder: Path | None, budget: int, kind: str = "front", say: bool = False) -> Front:
    """An optimization of short trials, also over the number of links, or the rest of it."""
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
    sought = Optimization(
        scenario=lc.build_scenario("mamba", gait, 2.0),
        bounds={
            "gait.amplitude": (0.2, 2.0),
            "gait.phase_shift": (0.2, 1.2),
            "robot.n_links": (8, 9),
        },
        objectives=KINDS[kind],
    )
    how: Any = {"progress": lambda done, total: print(done, flush=True)} if say else {}
    return optimize(sought, folder, budget=budget, population=POPULATION, seed=5, **how)


def contents(front: Front) -> dict[str, bytes]:
    """Every number of a front, as bits."""
    return {name: np.asarray(column).tobytes() for name, column in front.figures.items()} | {
        "values": front.values.tobytes()
    }


def kill_at_moments(folder: Path, budget: int, kills: int, seed: int, kind: str = "front") -> int:
    """Kill an optimization at random moments and resume it, until it has been hit so often.

    Args:
        folder: Of the optimization.
        budget: Its size.
        kills: How often.
        seed: Of the moments.
        kind: Of the objectives.

    Returns:
        How many kills hit one that was still running.
    """
    chance = random.Random(seed)
    hits = 0
    for _ in range(kills):
        words = [
            sys.executable,
            __file__,
            "--child",
            str(folder),
            "--budget",
            str(budget),
            "--kind",
            kind,
        ]
        process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
        assert process.stdout is not None
        for _ in range(2):  # it has begun, and stored a generation
            process.stdout.readline()
        time.sleep(chance.uniform(0.0, 0.15))
        process.kill()
        hits += process.wait(PATIENCE) == -signal.SIGKILL
        process.stdout.close()
    return hits


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--child", type=Path)
    parser.add_argument("--kind", default="front")
    parser.add_argument("--budget", type=int, default=6000)
    parser.add_argument("--kills", type=int, default=20)
    options = parser.parse_args()
    if options.child:
        run(options.child, options.budget, options.kind, say=True)
        return
    failed = False
    with tempfile.TemporaryDirectory() as scratch:
        for kind in KINDS:
            expected = contents(run(None, options.budget, kind))
            folder = Path(scratch, kind)
            hits = kill_at_moments(folder, options.budget, options.kills, 1, kind)
            same = contents(run(folder, options.budget, kind)) == expected
            failed |= not same
            print(
                f"{kind:6} {options.budget} trials, {hits} kills hit: {'the same bits' if same else 'DIFFERENT'}"
            )
    sys.exit(failed)


if __name__ == "__main__":
    main()
