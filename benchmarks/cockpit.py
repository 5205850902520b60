"""What the cockpit costs: simulated time per real time and share of a core, with three pages open.

    python benchmarks/cockpit.py                 # 20 s each; pages that take everything and draw nothing
    python benchmarks/cockpit.py 20 --browser    # three pages in Chromium, which draws without a graphics card here

The pages run in processes of their own: the share is that of the server alone, which holds the
world too. They report their cameras, and the cameras follow.
"""

import argparse
import contextlib
import math
import os
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import laticauda as lc
from laticauda.show.cockpit import Cockpit, Live

PAGES = 3
PAGE = Path(__file__).with_name("_page.py")
FLAGS = ("--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
GAIT = lc.lateral_undulation(
    amplitude=math.radians(30.0), frequency=math.radians(130.0), phase_shift=math.radians(40.0)
)


def resident() -> float:
    """Memory of this process [MB]."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096 / 1e6


@contextlib.contextmanager
def readers(address: str) -> Iterator[list[int]]:
    """Pages without a picture; the bytes that they get, second by second."""
    found = [
        subprocess.Popen(
            [sys.executable, str(PAGE), address], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
        )
        for _ in range(PAGES)
    ]
    got: list[int] = []
    for page in found:
        threading.Thread(
            target=lambda page=page: got.extend(map(int, page.stdout)), daemon=True
        ).start()
    try:
        yield got
    finally:
        for page in found:
            page.kill()
            page.wait()


@contextlib.contextmanager
def browsers(address: str) -> Iterator[list[int]]:
    """Pages in Chromium."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        found = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=list(FLAGS)
        )
        for _ in range(PAGES):
            found.new_page(viewport={"width": 800, "height": 500}).goto(address)
        try:
            yield []
        finally:
            found.close()


def measure(model: str, duration: float, *, speed: float = 1.0, browser: bool = False) -> None:
    live = Live(lc.build_scenario("mamba-fin", GAIT, model=model))
    live.speed = speed
    cockpit = Cockpit(live, port=0)
    cockpit.open()
    with (browsers if browser else readers)(cockpit.address) as got:
        while cockpit.pages < PAGES:
            time.sleep(0.1)
        time.sleep(5.0)
        got.clear()
        begun, cpu, world, lag = (
            time.perf_counter(),
            time.process_time(),
            live.simulation.time,
            live.lag,
        )
        time.sleep(duration)
        wall = time.perf_counter() - begun
        cpu, world, lag = time.process_time() - cpu, live.simulation.time - world, live.lag - lag
        size = f"{sum(got) / 1e6 / wall / PAGES:.2f} MB/s per page" if got else "Chromium"
        print(
            f"{model:8s} {PAGES} pages, {size}, time x {speed:g}: simulated/real {world / wall:.3f}, "
            f"given up {lag:.2f} s, server {100.0 * cpu / wall:.0f} % of a core, {resident():.0f} MB, "
            f"load {os.getloadavg()[0]:.1f}",
            flush=True,
        )
    cockpit.close()


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("seconds", nargs="?", type=float, default=20.0)
    parser.add_argument("--browser", action="store_true")
    options = parser.parse_args()
    for model in ("planar", "spatial"):
        measure(model, options.seconds, browser=options.browser)
    measure("planar", options.seconds, speed=8.0, browser=options.browser)


if __name__ == "__main__":
    main()
