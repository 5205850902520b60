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
from typing import NamedTuple

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
    command = [sys.executable, str(PAGE), address]
    pages = [
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        for _ in range(PAGES)
    ]
    bytes_per_second: list[int] = []

    def listen(page: subprocess.Popen[bytes]) -> None:
        bytes_per_second.extend(map(int, page.stdout))

    for page in pages:
        threading.Thread(target=listen, args=(page,), daemon=True).start()
    try:
        yield bytes_per_second
    finally:
        for page in pages:
            page.kill()
            page.wait()


@contextlib.contextmanager
def browsers(address: str) -> Iterator[list[int]]:
    """Pages in Chromium."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=list(FLAGS)
        )
        for _ in range(PAGES):
            page = chromium.new_page(viewport={"width": 800, "height": 500})
            page.goto(address)
        try:
            yield []
        finally:
            chromium.close()


class Usage(NamedTuple):
    """What has passed until now [s]."""

    wall: float
    processor: float
    simulated: float
    lag: float
    """Time that was given up because the computer is too slow."""

    @classmethod
    def now(cls, live: Live) -> "Usage":
        return cls(time.perf_counter(), time.process_time(), live.simulation.time, live.lag)


def measure(model: str, duration: float, *, speed: float = 1.0, browser: bool = False) -> None:
    live = Live(lc.build_scenario("mamba-fin", GAIT, model=model))
    live.speed = speed
    cockpit = Cockpit(live, port=0)
    cockpit.open()
    open_pages = browsers if browser else readers
    with open_pages(cockpit.address) as bytes_per_second:
        while cockpit.pages < PAGES:
            time.sleep(0.1)
        time.sleep(5.0)
        bytes_per_second.clear()
        start = Usage.now(live)
        time.sleep(duration)
        end = Usage.now(live)
        wall = end.wall - start.wall
        simulated = end.simulated - start.simulated
        processor = end.processor - start.processor
        traffic = "Chromium"
        if bytes_per_second:
            megabytes = sum(bytes_per_second) / 1e6
            traffic = f"{megabytes / wall / PAGES:.2f} MB/s per page"
        print(
            f"{model:8s} {PAGES} pages, {traffic}, time x {speed:g}: "
            f"simulated/real {simulated / wall:.3f}, "
            f"given up {end.lag - start.lag:.2f} s, "
            f"server {100.0 * processor / wall:.0f} % of a core, {resident():.0f} MB, "
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
