"""Is anything lost when a job of any kind is killed?

Question: sweeps, optimizations, identifications, the paper's reproduction and operations are killed by SIGKILL at
random moments, 20 times each, and run again: are the results the same, bit for bit, as those of a job that nobody
killed? A recording cannot be the same: it has to be readable, and to be the beginning of a whole one.

    python campaigns/kills.py                           # 100 kills
    python campaigns/kills.py --kills 2 --only operate  # fewer

Sweeps and optimizations go on where they were; identifications and reproductions begin anew, over what is there.

There is no answer yet: on a busy machine it did not come to its end. What is known of sweeps and optimizations alone
is in sweep_kills.py and optimize_kills.py.
"""

import argparse
import hashlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import laticauda as lc

PATIENCE = 300.0  # [s]
GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
IDENTIFY = (
    "identify run-0.nc run-1.nc run-2.nc --parameters water.normal_drag --robot mamba "
    "--measured forward_velocity=0.004 --starts 2"
)
WORDS: dict[str, str] = {
    "sweep": "sweep --vary amplitude-deg=20:60:1500 --duration 2 --output out",
    "optimize": "optimize --vary amplitude-deg=20:60 --duration 2 --budget 1200 --seed 3 --output out",
    "identify": f"{IDENTIFY} --threads 1 --output out",
}
JOBS = (*WORDS, "reproduce", "operate")


def recorded(folder: Path) -> None:
    """Operate a robot in the virtual tank, without wires, and keep its recording as ``run.mcap``."""
    from laticauda.lab import LabSettings, NodeSettings, Tank, VirtualRobot
    from laticauda.operate.session import operate
    from laticauda.operate.settings import Calibration, CaptureVolume, Connection, Operation

    robot = lc.load_robot("mamba")
    world = VirtualRobot(robot, lc.plant(robot, lc.load_water("paper-lateral"), joints="servo"))
    nodes = NodeSettings(startup_time=0.2, calibration_time=0.2)
    operation = Operation(
        name="run",
        gait=GAIT,
        duration=6.0,
        rate=50.0,
        countdown=0.1,
        tank=CaptureVolume(volume_x=(-5.0, 11.0), volume_y=(-5.0, 5.0)),
        connection=Connection(meter_port="stepped"),
        supply_voltage=35.0,
        calibration=Calibration(joint_zeros=True, idle_time=0.5, still_time=0.5),
    )
    operate(operation, folder, tank=Tank(world, LabSettings(seed=1, nodes=nodes)))


def reproduced(folder: Path) -> None:
    """The paper's side trials and a few rows of its sweeps, by two workers."""
    from laticauda.paper.report.reproduce import Experiments, paper_experiments, reproduce
    from laticauda.paper.side_trials import SideSettings

    whole = paper_experiments()
    sweeps = tuple(replace(sweep, step=10 * sweep.step) for sweep in whole.efficiency.sweeps)
    small = Experiments(
        efficiency=replace(whole.efficiency, sweeps=sweeps, models=whole.efficiency.models[:1]),
        side=replace(SideSettings(), phase_shifts=sweeps[2], duration=10.0),
        path_following=replace(
            whole.path_following, duration=16.0, joint_laws=("prescribed",), offset_bandwidths=(10.0,)
        ),
    )
    reproduce(folder / "out", small, only="efficiency", workers=2)


def child(job: str, folder: Path) -> int:
    """The process that is killed."""
    if job == "operate":
        recorded(folder / "out")
    elif job == "reproduce":
        reproduced(folder)
    else:
        from laticauda.cli import main

        return main(WORDS[job].split())
    return 0


def started(job: str, folder: Path) -> "subprocess.Popen[bytes]":
    """The job in a process of its own."""
    words = [sys.executable, __file__, "--child", job, "--folder", str(folder)]
    return subprocess.Popen(words, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def contents(job: str, folder: Path) -> dict[str, str]:
    """Digests of all files of a finished job; of a page and a figure too."""
    out = folder / "out"
    if job == "operate":
        return {}
    if job == "sweep":
        from laticauda.studies import open_sweep

        found = open_sweep(out)
        assert found.n_finished == found.n_trials, "the sweep is not finished"
        return {str(name): digest(array.to_numpy().tobytes()) for name, array in found.variables.items()}
    return {str(file.relative_to(out)): digest(file.read_bytes()) for file in out.rglob("*") if file.is_file()}


def digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def replays(folder: Path, whole: Path) -> bool:
    """Whether a recording that broke off is readable, and is the beginning of a whole one."""
    from laticauda.errors import LaticaudaError
    from laticauda.operate.recording.log import read_operation

    file = folder / "out" / "run.mcap"
    if not file.exists() or file.stat().st_size < 4096:  # it had not begun
        return True
    try:
        found = read_operation(file)
    except LaticaudaError as error:
        return "header" in str(error) or "empty" in str(error)
    other = read_operation(whole / "out" / "run.mcap")
    n = len(found.entries)
    return n <= len(other.entries) and repr(found.entries) == repr(other.entries[:n])


def killed(job: str, kills: int, scratch: Path, seed: int = 0) -> tuple[int, bool]:
    """Kill a job so often, and let it finish: how many kills hit it at work, and whether nothing was lost."""
    chance, whole, broken = random.Random(f"{job} {seed}"), scratch / f"{job}-whole", scratch / f"{job}-broken"
    for folder in (whole, broken):
        (folder / "out").mkdir(parents=True)
        for k in range(3):
            lc.swim("mamba", replace(GAIT, amplitude=0.4 + 0.1 * k), 4.0).save(folder / f"run-{k}.nc")
    begun = time.monotonic()
    assert started(job, whole).wait(PATIENCE) == 0, f"{job} does not run"
    took = time.monotonic() - begun
    hits, is_same = 0, True
    while hits < kills:
        if job in ("operate", "sweep", "optimize") and (job == "operate" or (broken / "out" / "front.csv").exists()):
            shutil.rmtree(broken / "out")
            (broken / "out").mkdir()
        process = started(job, broken)
        time.sleep(chance.uniform(0.3, 1.0) * took)
        process.kill()
        hits += process.wait(PATIENCE) == -signal.SIGKILL
        is_same = is_same and (job != "operate" or replays(broken, whole))
    if job != "operate":
        assert started(job, broken).wait(PATIENCE) == 0, f"{job} does not go on"
        is_same = contents(job, broken) == contents(job, whole)
    return hits, is_same


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--child")
    parser.add_argument("--folder", type=Path)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--only", nargs="*", default=list(JOBS))
    options = parser.parse_args()
    if options.child:
        sys.exit(child(options.child, options.folder))
    failed = False
    with tempfile.TemporaryDirectory() as scratch:
        for job in options.only:
            hits, is_same = killed(job, options.kills, Path(scratch))
            failed |= not is_same
            kept = "readable, the beginning of a whole one" if job == "operate" else "the same bits"
            print(f"    {job:10} {hits} kills hit: {kept if is_same else 'DIFFERENT'}", flush=True)
    sys.exit(failed)


if __name__ == "__main__":
    main()
