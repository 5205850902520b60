"""How punctual is the operator's loop?

Question: 100 Hz for 10 minutes, the virtual tank in another process, everything recorded: the
distribution of the loop's lateness and of its latency (from when a tick is due until its last frame
is on the bus), and the missed deadlines. A bare loop that does nothing runs beside it in a process
of its own: no deadline is to be missed that it meets. With --counting there is no operator: a loop
that counts for 3 ms in every period, as long as a tick takes, has its place. What it misses is due
to the computer and to the length of a tick, not to what the operator does. Printed, and drawn to
out/operate_timing.png. Other work on the computer shows: look at the load that is printed.

    python benchmarks/operate_timing.py [--duration 600] [--plain] [--learning] [--counting]

With --plain neither loop has real-time priority; with --learning a second twin learns beside the
recording. The filter has its twin, as by the command.

Last answer: see docs/how-to/operate.md; docs/images/operate-timing.png is its picture.
"""

import argparse
import json
import math
import subprocess
import sys
import tempfile
import time
from collections.abc import Generator
from contextlib import ExitStack, contextmanager, nullcontext
from pathlib import Path
from typing import Any

import numpy as np
from _timing import print_load

import laticauda as lc
from laticauda.control import Following
from laticauda.control.estimation import Learning
from laticauda.show.figures import save_figure, timing_sheet
from laticauda.tank.operate.session import operate
from laticauda.tank.operate.settings import (
    Calibration,
    CaptureVolume,
    Connection,
    Limits,
    Operation,
)
from laticauda.tank.protocol import clock as clocks

BUS = "udp_multicast:239.74.163.2:43119"
BARE = """
import os, sys, time
if sys.argv[2] == "urgent":
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(20))

def count(number):
    begun = time.monotonic()
    for _ in range(number):
        pass
    return time.monotonic() - begun

number = round(float(sys.argv[3]) * 10_000 / min(count(10_000) for _ in range(50)))
end, due = time.monotonic() + float(sys.argv[1]), time.monotonic()
while due < end:
    due += 0.01
    time.sleep(max(due - time.monotonic(), 0.0))
    late = time.monotonic() - due
    count(number)
    print(due, late, time.monotonic() - due)
"""
COUNTED = 0.003  # what the counting loop counts for [s]
SPREAD = (50.0, 99.0, 99.9, 100.0)


@contextmanager
def beside(duration: float, priority: str, work: float = 0.0) -> Generator[list[np.ndarray]]:
    """A loop in a process of its own; at the end its due times, lateness and latency, [s], are in the list."""
    told: list[np.ndarray] = []
    with tempfile.TemporaryFile("w+") as printed:
        loop = subprocess.Popen(
            [sys.executable, "-c", BARE, str(duration + 30.0), priority, str(work)], stdout=printed
        )
        try:
            yield told
        finally:
            loop.terminate()
            loop.wait()
        printed.seek(0)
        told.append(
            np.array(
                [
                    [float(word) for word in line.split()]
                    for line in printed.read().splitlines()[:-1]
                ]
            )
        )


def missed_at(moment: float, bare: np.ndarray) -> bool:
    """Whether the bare loop missed a deadline of its own within two periods of a moment."""
    return bool(np.any((np.abs(bare[:, 0] - moment) < 0.02) & (bare[:, 1] > 0.01)))


def print_missed(missed: np.ndarray, bare: np.ndarray) -> None:
    """Print how late the bare loop was, and how many of the deadlines that were missed it met."""
    met = [moment for moment in missed if not missed_at(moment, bare)]
    print(f"bare loop: lateness {SPREAD} % {1e3 * np.percentile(bare[:, 1], SPREAD)} ms")
    print(f"missed: {len(missed)}, while the bare loop met its own: {len(met)}")


def main() -> None:
    """Print the figures and draw them."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--duration", type=float, default=600.0)
    parser.add_argument("--plain", action="store_true", help="without real-time priority")
    parser.add_argument("--learning", action="store_true", help="with a twin that learns meanwhile")
    parser.add_argument(
        "--counting", action="store_true", help="a loop that only counts, instead of the operator"
    )
    given = parser.parse_args()
    duration, how = given.duration, "plain" if given.plain else "urgent"
    if given.counting:
        with beside(duration, how) as none, beside(duration, how, COUNTED) as counts:
            time.sleep(duration)
        due, late, latency = counts[0].T
        print(
            f"counting loop: {due.size} ticks, lateness {SPREAD} % {1e3 * np.percentile(late, SPREAD)} ms"
        )
        print(f"counting loop: latency {SPREAD} % {1e3 * np.percentile(latency, SPREAD)} ms")
        print_missed(due[latency > 0.01], none[0])
        print_load()
        return
    if given.plain:
        clocks.urgent = lambda: nullcontext("The loop has normal priority.")
    words = [
        "lab",
        "--json",
        "--robot",
        "mamba-modules",
        "--bus",
        BUS,
        "--port",
        "0",
        "--position",
        "0",
        "0.5",
    ]
    program = [sys.executable, "-c", "from laticauda.cli import main; raise SystemExit(main())"]
    lab: Any = subprocess.Popen(
        [*program, *words], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
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
            limits=Limits(
                max_lateness=10.0, joint_timeout=10.0, heartbeat_timeout=10.0, mocap_timeout=10.0
            ),
            learning=Learning() if given.learning else None,
        )
        twin = lc.build_plant(what.body(), what.pool(), joints="servo")
        clock = clocks.Clock()
        with ExitStack() as stack:
            folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
            none = stack.enter_context(beside(duration, how))
            result = operate(what, folder, clock=clock, twin=twin)
            offset = time.monotonic() - clock.now()
    finally:
        lab.terminate()
        lab.wait(10)
    timing = result.timing
    assert timing is not None
    print(f"{result.reason} {len(timing.times)} ticks of {1e3 * timing.interval:g} ms")
    for name, value in timing.summary().items():
        print(
            f"{name:<18}{1e3 * value:>10.3f} ms"
            if isinstance(value, float)
            else f"{name:<18}{value:>10}"
        )
    print_missed(timing.times[timing.latency > timing.interval, 0] + offset, none[0])
    print_load()
    Path("out").mkdir(exist_ok=True)
    note = "tank in another process, everything recorded"
    save_figure(
        timing_sheet(timing.lateness, timing.latency, timing.interval, note=note),
        "out/operate_timing.png",
    )


if __name__ == "__main__":
    main()
