"""One trial of Table 2 in the virtual tank, operated like the robot: the tank and
the operator are two processes.

They share only a CAN bus, a network port and a serial line. The same trial is then
simulated without any of these, and the velocities are compared with each other and
with that of the robot in the paper's tank.

    python examples/lab/run.py [--speed 2] [--duration 90]
"""

import argparse
import json
import math
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import laticauda as lc
from laticauda.paper.measured import read_path_following_trials
from laticauda.tank.operate.settings import load_operation
from laticauda.trials import following

HERE = Path(__file__).parent
BUS = "udp_multicast:239.74.163.2:43117"


def simulated(operation, start, duration) -> lc.Trial:
    """The same controller and model, with nothing in between."""
    plant = lc.build_plant(
        operation.body(),
        operation.pool(),
        joints=operation.joint_law(),
        ramp=operation.ramp,
        offset_bandwidth=operation.offset_bandwidth,
    )
    return lc.run(plant, operation.controller(), duration, start=start)


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--speed", default="1")
    parser.add_argument("--duration", type=float)
    options = parser.parse_args()
    operation = load_operation(HERE / "trial.toml")
    text = (HERE / "trial.toml").read_text(encoding="utf-8")
    if options.duration:
        text = text.replace(
            f"duration = {operation.duration}", f"duration = {options.duration}"
        )
        operation = replace(operation, duration=options.duration)
    x, y = operation.start.position
    command = [
        sys.executable,
        "-c",
        "from laticauda.cli import main; raise SystemExit(main())",
    ]
    words = [
        "lab",
        "--json",
        "--robot",
        operation.robot,
        "--parameters",
        operation.parameters,
        "--position",
        str(x),
        str(y),
    ]
    words += [
        "--heading-deg",
        str(math.degrees(operation.start.heading)),
        "--bus",
        BUS,
        "--port",
        "0",
        "--speed",
        options.speed,
    ]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "trial.toml")
        file.write_text(text, encoding="utf-8")
        tank = subprocess.Popen(
            [*command, *words],
            stdout=subprocess.PIPE,
            stdin=subprocess.PIPE,
            text=True,
        )
        try:
            at = json.loads(tank.stdout.readline())
            print(f"the tank: {at}", flush=True)
            qtm = (
                at["qtm"]
                if isinstance(at["qtm"], str)
                else ":".join(map(str, at["qtm"]))
            )
            words = [
                "operate",
                str(file),
                "--json",
                "--output",
                folder,
                "--bus",
                BUS,
                "--mocap",
                qtm,
            ]
            words += ["--meter", at["meter"], "--speed", options.speed]
            done = subprocess.run(
                [*command, *words], stdout=subprocess.PIPE, text=True
            )
        finally:
            tank.terminate()
            tank.wait(10)
        if not done.stdout:
            return done.returncode
        found = json.loads(done.stdout)
        trial = (
            lc.load_trial(Path(folder, f"{operation.name}.nc"))
            if found["accepted"]
            else None
        )
    print(json.dumps(found, indent=1))
    if trial is None:
        return 1
    start = lc.Start(center_of_mass=(x, y), heading=operation.start.heading)
    pure = simulated(operation, start, trial.duration)  # the tank may end first
    ratio = trial.forward_velocity / pure.forward_velocity
    for name, one in (("operated", trial), ("simulated", pure)):
        error = one.signals["cross_track_error"]
        reached = following.convergence(
            one.time, error, one.signals["along_track_distance"], one.period
        )
        when = (
            "does not converge"
            if reached is None
            else f"within 0.1 m of the path after {reached.time:.0f} s"
        )
        print(
            f"{name:<10} {one.forward_velocity:.4f} m/s, {when}, p_y at the end "
            f"{error[-1]:+.3f} m"
        )
    print(f"the velocities differ by {100 * (ratio - 1):+.1f} %")
    if not options.duration:  # a shorter run is mostly turn and start
        (measured,) = (
            case
            for case in read_path_following_trials()
            if case.gait.kind == operation.gait.kind
            and case.has_fin
            and case.case == 1
        )
        error = trial.forward_velocity / measured.forward_velocity - 1
        print(
            f"the robot in the paper's tank: {measured.forward_velocity:.4f} m/s; the virtual "
            f"one differs by {100 * error:+.1f} %"
        )
    return 0 if abs(ratio - 1) < 0.05 else 1


if __name__ == "__main__":
    sys.exit(main())
