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
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

PROGRAM = (sys.executable, "-c", "from laticauda.cli import main; raise SystemExit(main())")
STOPS = (*[signal.SIGINT] * 5, *[signal.SIGKILL] * 2)
"""Signals that stop the series, before they are shuffled."""
LONGEST = 20.0
"""Time into a call until it is stopped at most [s]; a run takes some 8 s."""
SETTINGS = ("slow", "fast")
REPEATS = 3
"""Accepted runs of every setting."""
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
    found: dict[str, str] = {}
    for path in folder.glob("*"):
        if path.suffix in (".mcap", ".nc") and not path.name.startswith("."):
            found[path.name] = hashlib.sha256(path.read_bytes()).hexdigest()
    return found


class Lab(NamedTuple):
    """The virtual tank."""

    process: subprocess.Popen[str]
    options: list[str]
    """Options with which `operate` finds it."""


def start_lab() -> Lab:
    options = ["--robot", "mamba", "--bus", "udp_multicast:239.74.163.7:43127", "--port", "0"]
    process = subprocess.Popen(
        [*PROGRAM, "lab", "--json", *options],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    addresses = json.loads(process.stdout.readline())
    options = ["--bus", addresses["bus"], "--mocap", addresses["qtm"]]
    return Lab(process, [*options, "--meter", addresses["meter"]])


class Call(NamedTuple):
    """One call of the series."""

    status: int
    result: dict[str, Any]
    """What it says at its end."""


def operate(folder: Path, options: list[str], stop: signal.Signals | None, after: float) -> Call:
    """One call of the series, stopped after some time [s] or not at all."""
    words = ["operate", "series.toml", "--json", "--output", "runs", "--clear", *options]
    pipe: Any = subprocess.PIPE
    process = subprocess.Popen(
        [*PROGRAM, *words], cwd=folder, stdout=pipe, stderr=pipe, stdin=subprocess.DEVNULL
    )
    timeout = None
    if stop is not None:
        timeout = after
    try:
        output, errors = process.communicate(timeout=timeout)
    except subprocess.TimeoutExpired:
        process.send_signal(stop or signal.SIGKILL)
        output, errors = process.communicate()
    assert b"Traceback" not in errors, errors.decode()
    result: dict[str, Any] = {}
    if output:
        result = json.loads(output)
    return Call(process.returncode, result)


def main() -> None:
    """Print what every call left, and the verdict."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    chance = random.Random(parser.parse_args().seed)
    stops = list(STOPS)
    chance.shuffle(stops)
    # A shell starts its background jobs deaf to it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    lab = start_lab()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        runs = folder / "runs" / "tank"
        (folder / "series.toml").write_text(SERIES)
        digests_before: dict[str, str] = {}
        changed: set[str] = set()
        result: dict[str, Any] = {}
        for stop in (*stops, None):
            after = chance.uniform(4.0, LONGEST)
            begin = time.monotonic()
            status, result = operate(folder, lab.options, stop, after)
            after = min(after, time.monotonic() - begin)
            digests_now = digests(runs)
            for file, digest in digests_before.items():
                if digests_now.get(file) != digest:
                    changed.add(file)
            digests_before = digests_now.copy()
            if stop is signal.SIGKILL:  # what it was writing may be completed by the next call
                digests_before.pop(newest_of(digests_now, runs), None)
            end = "to its end"
            if stop is not None:
                end = f"{stop.name} after {after:4.1f} s"
            print(f"{end:<22} status {status:>3}, {len(digests_now):>2} files", flush=True)
        lab.process.terminate()
        lab.process.wait(10)
    settings = result["settings"]
    accepted = {setting["name"]: setting["accepted"] for setting in settings}
    n_recordings = sum(file.endswith(".mcap") for file in digests_before)
    n_told = sum(setting["accepted"] + len(setting["rejected"]) for setting in settings)
    print(
        f"complete: {result['complete']}, accepted: {accepted}, "
        f"files that changed: {sorted(changed) or 'none'}"
    )
    print(f"recordings: {n_recordings}, runs that the series tells of: {n_told}")
    are_all_accepted = accepted == dict.fromkeys(SETTINGS, REPEATS)
    is_well = result["complete"] and are_all_accepted and not changed and n_told == n_recordings
    raise SystemExit(0 if is_well else 1)


def newest_of(names: Iterable[str], folder: Path) -> str:
    """Name of the file that was written last; "" if there is none."""
    return max(names, key=lambda name: (folder / name).stat().st_mtime, default="")


if __name__ == "__main__":
    main()
