"""Does a sweep lose anything when it is killed?

Question: a sweep is killed by SIGKILL, again and again, and resumed: is what comes out the same,
bit for bit, as without? Three ways: at random moments; before a random file operation in its folder
(between two of them a file is half written, or a region without its mark); and by killing workers
of a Dask cluster that runs it.

    python campaigns/sweep_kills.py                 # 20 kills at random moments, 20 at file operations, 20 workers

The tests run a slice of it.

Last answer (2 shared cores, 2026-11-21):
    grid     10000 trials, kill_at_moments    20 kills hit: the same bits
    grid     10000 trials, kill_at_operations 20 kills hit: the same bits
    grid     10000 trials, kill_workers       20 kills hit: the same bits
    samples  10000 trials, kill_at_moments    20 kills hit: the same bits
    samples  10000 trials, kill_at_operations 20 kills hit: the same bits
    samples  10000 trials, kill_workers       20 kills hit: the same bits
"""

import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import laticauda as lc
from laticauda.studies import Grid, Rows, Samples, Sweep, open_sweep, run_sweep

REGION_SIZE = 25
# Of a child that is to be killed at a file operation; see `die_at`.
KILL_AT = "SWEEP_KILL_AT"
PATIENCE = 120.0  # [s]


def sweep(n: int, kind: str = "grid") -> Sweep:
    """About n^2 short trials, over a grid or over samples; some of them with another number of links."""
    points: dict[str, Grid | Rows | Samples] = {
        "grid": Grid(
            values={
                "robot.n_links": [8, 9],
                "gait.amplitude": np.linspace(0.2, 0.9, n),
                "water.normal_drag": np.linspace(1.0, 2.0, n // 2),
            }
        ),
        "samples": Samples(
            ranges={
                "gait.amplitude": (0.2, 0.9),
                "robot.n_links": (8, 9),
                "water.normal_drag": (1.0, 2.0),
            },
            n_points=n * n,
            seed=4,
        ),
    }
    gait = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
    return Sweep(scenario=lc.build_scenario("mamba", gait, 2.0), points=points[kind])


def contents(folder: Path) -> dict[str, bytes]:
    """Every number of a finished sweep, as bits."""
    found = open_sweep(folder)
    assert found.n_finished == found.n_trials, "the sweep is not finished"
    return {str(name): array.to_numpy().tobytes() for name, array in found.variables.items()}


def die_at(number: int, folder: Path) -> None:
    """Kill this process before a file operation in the folder, counted from 1."""
    count = 0

    def hook(event: str, args: tuple[object, ...]) -> None:
        nonlocal count
        if event in ("open", "os.rename", "os.mkdir") and str(args[0]).startswith(str(folder)):
            count += 1
            if count == number:
                os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(hook)


def child(folder: Path, n: int, kind: str) -> None:
    """The process that is killed: it runs the sweep, or the rest of it."""
    work = sweep(n, kind)
    if KILL_AT in os.environ:
        die_at(int(os.environ[KILL_AT]), folder)
    run_sweep(
        work, folder, region_size=REGION_SIZE, progress=lambda done, total: print(done, flush=True)
    )


def started(folder: Path, n: int, kind: str, **environment: str) -> "subprocess.Popen[str]":
    """A child that has begun with the sweep."""
    words = [sys.executable, __file__, "--child", str(folder), "--size", str(n), "--kind", kind]
    process = subprocess.Popen(
        words, stdout=subprocess.PIPE, text=True, env={**os.environ, **environment}
    )
    assert process.stdout is not None
    process.stdout.readline()
    return process


def kill_at_moments(folder: Path, n: int, kills: int, seed: int, kind: str = "grid") -> int:
    """Kill a sweep at random moments and resume it, then let it finish.

    Args:
        folder: Of the sweep.
        n: Size of the sweep.
        kills: How often.
        seed: Of the moments.
        kind: Of the points.

    Returns:
        How many kills hit a sweep that was still running.
    """
    chance = random.Random(seed)
    hits = 0
    for _ in range(kills):
        process = started(folder, n, kind)
        time.sleep(chance.uniform(0.0, 0.3))
        process.kill()
        hits += process.wait(PATIENCE) == -signal.SIGKILL
        assert process.stdout is not None
        process.stdout.close()
    run_sweep(sweep(n, kind), folder, region_size=REGION_SIZE)
    return hits


def kill_at_operations(folder: Path, n: int, kills: int, seed: int, kind: str = "grid") -> int:
    """The same, before random file operations: from the making of the folder to the last marks."""
    chance = random.Random(seed)
    hits = 0
    for _ in range(kills):
        process = started(folder, n, kind, **{KILL_AT: str(chance.randint(1, 200))})
        assert process.stdout is not None
        process.stdout.read()
        hits += process.wait(PATIENCE) == -signal.SIGKILL
        process.stdout.close()
    run_sweep(sweep(n, kind), folder, region_size=REGION_SIZE)
    return hits


def kill_workers(folder: Path, n: int, kills: int, seed: int, kind: str = "grid") -> int:
    """Run a sweep on a Dask cluster of two processes, and kill one of them now and then; it is started anew."""
    import dask
    from distributed import Client, LocalCluster

    # A local cluster gives a worker up that is away for 15 s, or that is away again after that
    # time.
    dask.config.set({"distributed.deploy.lost-worker-timeout": "1h"})

    chance = random.Random(seed)
    work = sweep(n, kind)
    at = sorted(chance.randint(1, work.n_trials - 1) for _ in range(kills))
    hits = 0

    def kill(done: int, total: int) -> None:
        nonlocal hits
        at_work = [
            nanny for nanny in cluster.workers.values() if nanny.worker_address in client.nthreads()
        ]
        # One that is just being started anew would take its nanny with it, and nobody would start
        # another.
        if at and done >= at[0] and at_work:
            at.pop(0)
            if done < total:
                os.kill(chance.choice(at_work).pid, signal.SIGKILL)
                hits += 1

    with (
        LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0"
        ) as cluster,
        Client(cluster, set_as_default=False) as client,
    ):
        run_sweep(work, folder, client=client, region_size=REGION_SIZE, progress=kill)
    return hits


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--child", type=Path)
    parser.add_argument("--kind", default="grid")
    parser.add_argument("--size", type=int, default=100)
    parser.add_argument("--kills", type=int, default=20)
    options = parser.parse_args()
    if options.child:
        child(options.child, options.size, options.kind)
        return
    failed = False
    with tempfile.TemporaryDirectory() as scratch:
        for kind in ("grid", "samples"):
            work = sweep(options.size, kind)
            run_sweep(work, Path(scratch, kind), region_size=REGION_SIZE)
            expected = contents(Path(scratch, kind))
            for seed, way in enumerate((kill_at_moments, kill_at_operations, kill_workers)):
                folder = Path(scratch, f"{kind}-{way.__name__}")
                hits = way(folder, options.size, options.kills, seed, kind)
                same = contents(folder) == expected
                failed |= not same
                print(
                    f"{kind:8} {work.n_trials} trials, {way.__name__:18} {hits} kills hit: "
                    f"{'the same bits' if same else 'DIFFERENT'}",
                    flush=True,
                )
    sys.exit(failed)


if __name__ == "__main__":
    main()
