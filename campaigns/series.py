"""Does a series come to its end with no run lost or doubled, however often it is stopped?

    python campaigns/series.py [--seed 1]

A series of six runs (two settings, three repeats each) over real wires, the virtual tank in another
process. At moments by chance, Ctrl-C stops it five times and it is killed twice; then it may come
to its end. Every file that was there when it was stopped has to be the same at the end, all but
what a killed program was writing, which becomes a trial of its own or is rejected; and every
setting has its three accepted runs. Takes some three minutes.
"""

import argparse
import hashlib
import json
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

PROGRAM = (sys.executable, "-c", "from laticauda.cli import main; raise SystemExit(main())")
STOPS = (*[signal.SIGINT] * 5, *[signal.SIGKILL] * 2)
LONGEST = 20.0  # into a call until it is stopped [s]; a run takes some 8 s
SETTINGS, REPEATS = ("slow", "fast"), 3
SERIES = """
kind = "series"
name = "tank"
repeats = 3
retries = 12
[common]
duration = 6.0
supply_voltage = 35.0
rate = 20
countdown = 0.1
tank = {volume_x = [-90, 90], volume_y = [-90, 90]}
calibration = {joint_zeros = true, idle_time = 0.3, still_time = 0.3}
limits = {max_lateness = 3, joint_timeout = 3, heartbeat_timeout = 3, mocap_timeout = 5, straighten_time = 0.5}
[[trials]]
name = "slow"
gait = {amplitude_deg = 20, frequency_deg_s = 90, phase_shift_deg = 40}
[[trials]]
name = "fast"
gait = {amplitude_deg = 20, frequency_deg_s = 120, phase_shift_deg = 40}
"""


def digests(folder: Path) -> dict[str, str]:
    """Of all trials and recordings."""
    files = (
        path for path in folder.glob("*") if path.suffix in (".mcap", ".nc") and path.name[0] != "."
    )
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def lab() -> tuple[subprocess.Popen[str], list[str]]:
    """The virtual tank, and the words with which `operate` finds it."""
    words = [
        "lab",
        "--json",
        "--robot",
        "mamba",
        "--bus",
        "udp_multicast:239.74.163.7:43127",
        "--port",
        "0",
    ]
    process = subprocess.Popen(
        [*PROGRAM, *words], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    at = json.loads(process.stdout.readline())
    return process, ["--bus", at["bus"], "--mocap", at["qtm"], "--meter", at["meter"]]


def operate(
    folder: Path, wires: list[str], stop: signal.Signals | None, after: float
) -> tuple[int, dict[str, Any]]:
    """One call of the series, stopped after some time or not at all; its status, and what it says at its end."""
    words = ["operate", "series.toml", "--json", "--output", "runs", "--clear", *wires]
    pipe: Any = subprocess.PIPE
    process = subprocess.Popen(
        [*PROGRAM, *words], cwd=folder, stdout=pipe, stderr=pipe, stdin=subprocess.DEVNULL
    )
    try:
        out, err = process.communicate(timeout=None if stop is None else after)
    except subprocess.TimeoutExpired:
        process.send_signal(stop or signal.SIGKILL)
        out, err = process.communicate()
    assert b"Traceback" not in err, err.decode()
    return process.returncode, json.loads(out) if out else {}


def main() -> None:
    """Print what every call left, and the verdict."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    chance = random.Random(parser.parse_args().seed)
    stops = list(STOPS)
    chance.shuffle(stops)
    signal.signal(
        signal.SIGINT, signal.default_int_handler
    )  # a shell starts its background jobs deaf to it
    tank, wires = lab()
    with tempfile.TemporaryDirectory() as name:
        folder, runs = Path(name), Path(name) / "runs" / "tank"
        (folder / "series.toml").write_text(SERIES)
        before, changed, said = dict[str, str](), set[str](), dict[str, Any]()
        for stop in (*stops, None):
            after = chance.uniform(4.0, LONGEST)
            begun = time.monotonic()
            status, said = operate(folder, wires, stop, after)
            now = digests(runs)
            changed |= {file for file, digest in before.items() if now.get(file) != digest}
            before = now
            if stop is signal.SIGKILL:  # what it was writing may be completed by the next call
                last = max(now, key=lambda file: (runs / file).stat().st_mtime, default="")
                before = {file: digest for file, digest in now.items() if file != last}
            how = (
                "to its end"
                if stop is None
                else f"{stop.name} after {min(after, time.monotonic() - begun):4.1f} s"
            )
            print(f"{how:<22} status {status:>3}, {len(now):>2} files", flush=True)
        tank.terminate()
        tank.wait(10)
        accepted = {one["name"]: one["accepted"] for one in said["settings"]}
        recorded = {Path(file).stem for file in before if file.endswith(".mcap")}
        tried = sum(one["accepted"] + len(one["rejected"]) for one in said["settings"])
    print(
        f"complete: {said['complete']}, accepted: {accepted}, files that changed: {sorted(changed) or 'none'}"
    )
    print(f"recordings: {len(recorded)}, runs that the series tells of: {tried}")
    well = (
        said["complete"]
        and accepted == dict.fromkeys(SETTINGS, REPEATS)
        and not changed
        and tried == len(recorded)
    )
    raise SystemExit(0 if well else 1)


if __name__ == "__main__":
    main()
