"""How punctual is the operator's loop?

Question: 100 Hz for 60 s, the virtual tank in another process, everything recorded: the distribution of the loop's
period and of its latency (from when a tick is due until its last frame is on the bus), and the missed deadlines.
Printed, and drawn to out/operate_timing.png. Other work on the computer shows: look at the load that is printed.

    python benchmarks/operate_timing.py [--duration 60]

Last answer (2 cores, load 1.3, 2026-11-21): period median 10.00, 99 % 11.7, largest 30.8 ms; latency median 2.90, 99 %
6.68, largest 35.9 ms; 6 of 6577 deadlines missed. docs/images/operate-timing.png is its picture.
"""

import argparse
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

from _timing import print_load

import laticauda as lc
from laticauda.control import Following
from laticauda.figures import save_figure, timing_sheet
from laticauda.operate.session import operate
from laticauda.operate.settings import Calibration, CaptureVolume, Connection, Limits, Operation

BUS = "udp_multicast:239.74.163.2:43119"


def main() -> None:
    """Print the figures and draw them."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--duration", type=float, default=60.0)
    duration = parser.parse_args().duration
    words = ["lab", "--json", "--robot", "mamba-modules", "--bus", BUS, "--port", "0", "--position", "0", "0.5"]
    program = [sys.executable, "-c", "from laticauda.cli import main; raise SystemExit(main())"]
    lab = subprocess.Popen([*program, *words], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    try:
        at = json.loads(lab.stdout.readline())
        host, port = at["qtm"].split(":")
        what = Operation(
            name="timing",
            robot="mamba-modules",
            gait=lc.lateral_undulation(
                amplitude=math.radians(20), frequency=math.radians(90), phase_shift=math.radians(40)
            ),
            following=Following(),
            duration=duration,
            countdown=0.0,
            supply_voltage=35.0,
            connection=Connection(
                can_channel="239.74.163.2",
                can_port=43119,
                mocap_host=host,
                mocap_port=int(port),
                meter_port=at["meter"],
            ),
            tank=CaptureVolume(volume_x=(-1.0, 11.0)),
            calibration=Calibration(joint_zeros=True, idle_time=0.5, still_time=0.5),
            # The run is to go on, however late the loop is.
            limits=Limits(max_lateness=10.0, joint_timeout=10.0, heartbeat_timeout=10.0, mocap_timeout=10.0),
        )
        with tempfile.TemporaryDirectory() as folder:
            result = operate(what, Path(folder))
    finally:
        lab.terminate()
        lab.wait(10)
    timing = result.timing
    print(f"{result.reason} {len(timing.ticks)} ticks of {1e3 * timing.interval:g} ms")
    for name, value in timing.summary().items():
        print(f"{name:<18}{1e3 * value:>10.3f} ms" if isinstance(value, float) else f"{name:<18}{value:>10}")
    print_load()
    Path("out").mkdir(exist_ok=True)
    note = "tank in another process, everything recorded"
    save_figure(timing_sheet(timing.period, timing.latency, timing.interval, note=note), "out/operate_timing.png")


if __name__ == "__main__":
    main()
