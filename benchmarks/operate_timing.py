"""How punctual is the operator's loop?

Question: 100 Hz for 10 minutes, the virtual tank in another process, everything recorded: the distribution of the
loop's lateness and of its latency (from when a tick is due until its last frame is on the bus), and the missed
deadlines. A bare loop that does nothing runs beside it in a process of its own: no deadline is to be missed that it
meets.
Printed, and drawn to out/operate_timing.png. Other work on the computer shows: look at the load that is printed.

    python benchmarks/operate_timing.py [--duration 600] [--plain] [--learning]

With --plain neither loop has real-time priority; with --learning a second twin learns beside the recording. The filter
has its twin, as by the command.

Last answer: see docs/how-to/operate.md; docs/images/operate-timing.png is its picture.
"""

import argparse
import json
import math
import subprocess
import sys
import tempfile
import time
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
from _timing import print_load

import laticauda as lc
from laticauda.control import Following
from laticauda.estimation import Learning
from laticauda.figures import save_figure, timing_sheet
from laticauda.operate.session import operate
from laticauda.operate.settings import Calibration, CaptureVolume, Connection, Limits, Operation
from laticauda.protocol import worker

BUS = "udp_multicast:239.74.163.2:43119"
BARE = """
import os, sys, time
if sys.argv[2] == "urgent":
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(20))
end, due = time.monotonic() + float(sys.argv[1]), time.monotonic()
while due < end:
    due += 0.01
    time.sleep(max(due - time.monotonic(), 0.0))
    print(due, time.monotonic() - due)
"""
SPREAD = (50.0, 99.0, 99.9, 100.0)


def missed_at(moment: float, bare: np.ndarray) -> bool:
    """Whether the bare loop missed a deadline of its own within two periods of a moment."""
    return bool(np.any((np.abs(bare[:, 0] - moment) < 0.02) & (bare[:, 1] > 0.01)))


def main() -> None:
    """Print the figures and draw them."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--duration", type=float, default=600.0)
    parser.add_argument("--plain", action="store_true", help="without real-time priority")
    parser.add_argument("--learning", action="store_true", help="with a twin that learns meanwhile")
    given = parser.parse_args()
    duration = given.duration
    if given.plain:
        worker.urgent = lambda: nullcontext("The loop has normal priority.")
    words = ["lab", "--json", "--robot", "mamba-modules", "--bus", BUS, "--port", "0", "--position", "0", "0.5"]
    program = [sys.executable, "-c", "from laticauda.cli import main; raise SystemExit(main())"]
    lab: Any = subprocess.Popen([*program, *words], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    try:
        at = json.loads(lab.stdout.readline())
        what = Operation(
            name="timing",
            robot="mamba-modules",
            gait=lc.lateral_undulation(
                amplitude=math.radians(12), frequency=math.radians(60), phase_shift=math.radians(40)
            ),
            following=Following(),
            duration=duration,
            countdown=0.0,
            supply_voltage=35.0,
            connection=Connection(
                bus_address="udp_multicast:239.74.163.2:43119",
                mocap_address=at["qtm"],
                meter_address=at["meter"],
            ),
            tank=CaptureVolume(volume_x=(-1.0, 11.0)),
            calibration=Calibration(joint_zeros=True, idle_time=0.5, still_time=0.5),
            # The run is to go on, however late the loop is.
            limits=Limits(max_lateness=10.0, joint_timeout=10.0, heartbeat_timeout=10.0, mocap_timeout=10.0),
            learning=Learning() if given.learning else None,
        )
        twin = lc.plant(what.body(), what.pool(), joints="servo")
        words = [sys.executable, "-c", BARE, str(duration + 30.0), "plain" if given.plain else "urgent"]
        with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryFile("w+") as told:
            bare = subprocess.Popen(words, stdout=told)
            result = operate(what, Path(folder), clock=(clock := worker.Clock()), twin=twin)
            offset = time.monotonic() - clock.now()
            bare.terminate()
            bare.wait()
            told.seek(0)
            beside = np.array([[float(word) for word in line.split()] for line in told.read().splitlines()[:-1]])
    finally:
        lab.terminate()
        lab.wait(10)
    timing = result.timing
    assert timing is not None
    print(f"{result.reason} {len(timing.times)} ticks of {1e3 * timing.interval:g} ms")
    for name, value in timing.summary().items():
        print(f"{name:<18}{1e3 * value:>10.3f} ms" if isinstance(value, float) else f"{name:<18}{value:>10}")
    print(f"bare loop: lateness {SPREAD} % {1e3 * np.percentile(beside[:, 1], SPREAD)} ms")
    met = [one for one in timing.times[timing.latency > timing.interval, 0] if not missed_at(one + offset, beside)]
    print(f"missed while the bare loop met its own: {len(met)}")
    print_load()
    Path("out").mkdir(exist_ok=True)
    note = "tank in another process, everything recorded"
    save_figure(timing_sheet(timing.lateness, timing.latency, timing.interval, note=note), "out/operate_timing.png")


if __name__ == "__main__":
    main()
