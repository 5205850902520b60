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
from contextlib import contextmanager, nullcontext
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
PERIOD = 0.01
"""Period of all loops [s]."""
COUNTED = 0.003
"""Time for which the counting loop counts in every period [s]."""
SPREAD = (50.0, 99.0, 99.9, 100.0)
"""Percentiles that are printed."""


class Loop:
    """A loop in a process of its own; it has figures after it has ended."""

    due: np.ndarray
    """Times at which its periods were due [s]."""
    lateness: np.ndarray
    """How late they began [s]."""
    latency: np.ndarray
    """How late they ended [s]."""

    def read(self, printed: str) -> None:
        """Take the figures from what the loop has printed; its last line may be cut off."""
        rows = [line.split() for line in printed.splitlines()[:-1]]
        self.due, self.lateness, self.latency = np.array(rows, dtype=float).T

    def missed_around(self, moment: float) -> bool:
        """Return whether it missed a deadline within two periods of a moment [s]."""
        is_near = np.abs(self.due - moment) < 2.0 * PERIOD
        return bool(np.any(is_near & (self.lateness > PERIOD)))


@contextmanager
def loop_beside(duration: float, priority: str, work: float = 0.0) -> Generator[Loop]:
    """A loop that works for some time in every period [s], beside what the block does."""
    loop = Loop()
    command = [sys.executable, "-c", BARE, str(duration + 30.0), priority, str(work)]
    with tempfile.TemporaryFile("w+") as printed:
        process = subprocess.Popen(command, stdout=printed)
        try:
            yield loop
        finally:
            process.terminate()
            process.wait()
        printed.seek(0)
        loop.read(printed.read())


def describe_spread(seconds: np.ndarray) -> str:
    return f"{SPREAD} % {1e3 * np.percentile(seconds, SPREAD)} ms"


def print_missed(missed: np.ndarray, bare: Loop) -> None:
    """Print how late the bare loop was, and how many of the deadlines that were missed it met."""
    met_by_bare = [moment for moment in missed if not bare.missed_around(moment)]
    print(f"bare loop: lateness {describe_spread(bare.lateness)}")
    print(f"missed: {len(missed)}, while the bare loop met its own: {len(met_by_bare)}")


def time_counting(duration: float, priority: str) -> None:
    """Print how punctual a loop is that only counts."""
    with (
        loop_beside(duration, priority) as bare,
        loop_beside(duration, priority, COUNTED) as counting,
    ):
        time.sleep(duration)
    print(
        f"counting loop: {counting.due.size} ticks, lateness {describe_spread(counting.lateness)}"
    )
    print(f"counting loop: latency {describe_spread(counting.latency)}")
    print_missed(counting.due[counting.latency > PERIOD], bare)


@contextmanager
def lab_in_another_process() -> Generator[dict[str, Any]]:
    """A virtual tank; where it can be reached."""
    program = [sys.executable, "-c", "from laticauda.cli import main; raise SystemExit(main())"]
    options = ["--robot", "mamba-modules", "--bus", BUS, "--port", "0", "--position", "0", "0.5"]
    lab: Any = subprocess.Popen(
        [*program, "lab", "--json", *options],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        yield json.loads(lab.stdout.readline())
    finally:
        lab.terminate()
        lab.wait(10)


def operation_at(addresses: dict[str, Any], duration: float, learning: bool) -> Operation:
    """A trial that goes on, however late the loop is."""
    gait = lc.lateral_undulation(
        amplitude=math.radians(12), frequency=math.radians(60), phase_shift=math.radians(40)
    )
    patient = Limits(
        max_lateness=10.0, joint_timeout=10.0, heartbeat_timeout=10.0, mocap_timeout=10.0
    )
    return Operation(
        name="timing",
        robot="mamba-modules",
        gait=gait,
        following=Following(),
        duration=duration,
        countdown=0.0,
        supply_voltage=35.0,
        connection=Connection(
            bus_address=BUS, mocap_address=addresses["qtm"], meter_address=addresses["meter"]
        ),
        tank=CaptureVolume(volume_x=(-1.0, 11.0)),
        calibration=Calibration(joint_zeros=True, idle_time=0.5, still_time=0.5),
        limits=patient,
        learning=Learning() if learning else None,
    )


def time_operator(duration: float, priority: str, learning: bool) -> None:
    """Print how punctual the operator's loop is, and draw it."""
    with lab_in_another_process() as addresses:
        operation = operation_at(addresses, duration, learning)
        twin = lc.build_plant(operation.body(), operation.pool(), joints="servo")
        clock = clocks.Clock()
        with (
            tempfile.TemporaryDirectory() as folder,
            loop_beside(duration, priority) as bare,
        ):
            result = operate(operation, Path(folder), clock=clock, twin=twin)
            offset = time.monotonic() - clock.now()
    timing = result.timing
    assert timing is not None
    print(f"{result.reason} {len(timing.times)} ticks of {1e3 * timing.interval:g} ms")
    for name, value in timing.summary().items():
        if isinstance(value, float):
            print(f"{name:<18}{1e3 * value:>10.3f} ms")
        else:
            print(f"{name:<18}{value:>10}")
    print_missed(timing.times[timing.latency > timing.interval, 0] + offset, bare)
    Path("out").mkdir(exist_ok=True)
    note = "tank in another process, everything recorded"
    sheet = timing_sheet(timing.lateness, timing.latency, timing.interval, note=note)
    save_figure(sheet, "out/operate_timing.png")


def main() -> None:
    """Print the figures and draw them."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--duration", type=float, default=600.0)
    parser.add_argument("--plain", action="store_true", help="without real-time priority")
    parser.add_argument("--learning", action="store_true", help="with a twin that learns meanwhile")
    parser.add_argument(
        "--counting", action="store_true", help="a loop that only counts, instead of the operator"
    )
    options = parser.parse_args()
    priority = "plain" if options.plain else "urgent"
    if options.counting:
        time_counting(options.duration, priority)
    else:
        if options.plain:
            clocks.urgent = lambda: nullcontext("The loop has normal priority.")
        time_operator(options.duration, priority, options.learning)
    print_load()


if __name__ == "__main__":
    main()
