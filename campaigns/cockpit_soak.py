"""Does the cockpit lose memory while a page is left open?

Question: how do the memory of the server and of a page grow over 30 minutes, once with nothing done and once with
something done on it every ten seconds (gait, fin, joints, current, path, forces, reset)? Time is made to go faster: as
many pictures are sent as in those minutes, each with its share of the world's time. The page is Chromium, if that and
playwright are there, and otherwise a client that reads everything and draws nothing.

    python campaigns/cockpit_soak.py                       # 30 minutes, ten times as fast as real time
    python campaigns/cockpit_soak.py --minutes 10 --every 0.2 --no-browser   # 3000 changes

The tests run a slice of it.

The first 20 minutes fill the memory that is set aside for the run: only after them is growth a loss.

Last answer (2 cores, 2026-11-21), with Chromium:
    minutes                       1      5     10     15     20     25     30
    nothing done  server [MB] 241.2  243.3  245.9  248.4  251.1  251.2  251.2
                  page [MB]    15.8   16.3   17.7   16.6   17.0   17.2   17.2
    busy          server [MB] 258.0  262.2  263.5  265.5  265.7  266.1  266.3
                  page [MB]    16.4   17.4   17.8   18.9   19.3   18.7   18.6
"""

import argparse
import contextlib
import math
import random
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import laticauda as lc
from laticauda.cockpit import Cockpit, Live
from laticauda.cockpit.page import FRAME
from laticauda.cockpit.simulation import with_fin
from laticauda.control import StraightLine

GAIT = lc.lateral_undulation(
    amplitude=math.radians(30.0), frequency=math.radians(130.0), phase_shift=math.radians(40.0)
)
PAGE = Path(__file__).parent.parent / "benchmarks" / "_page.py"
EVERY = 10.0  # time between two things that are done on a busy page, in the world's time [s]
SAMPLE = 60.0  # likewise between two looks at the memory [s]
FLAGS = ("--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")


@dataclass(frozen=True, kw_only=True)
class Soak:
    """Memory over time."""

    minutes: np.ndarray
    """Of the world's time [min]."""
    server: np.ndarray
    """Memory of the server's process [MB]."""
    page: np.ndarray
    """Memory of the page's JavaScript after a collection; nan without a browser [MB]."""
    times: float
    """How much faster than real time it went [-]."""


def slope(minutes: np.ndarray, memory: np.ndarray) -> float:
    """Growth in the last third [kB/min]."""
    n = max(len(minutes) // 3, 2)
    return 1000.0 * float(np.polyfit(minutes[-n:], memory[-n:], 1)[0])


def resident() -> float:
    """Memory of this process [MB]."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096 / 1e6


@contextlib.contextmanager
def reader(address: str) -> Iterator[Callable[[], float]]:
    """A page without a picture, in a process of its own."""
    process = subprocess.Popen(
        [sys.executable, str(PAGE), address], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        yield lambda: math.nan
    finally:
        process.kill()
        process.wait()


@contextlib.contextmanager
def chromium(address: str) -> Iterator[Callable[[], float]]:
    """A page in a browser; what it hands on measures its memory [MB]."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        found = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=list(FLAGS))
        page = found.new_page(viewport={"width": 640, "height": 400})
        page.goto(address)
        talk = page.context.new_cdp_session(page)

        def heap() -> float:
            talk.send("HeapProfiler.collectGarbage")
            return talk.send("Runtime.getHeapUsage")["usedSize"] / 1e6

        try:
            yield heap
        finally:
            found.close()


def do_something(cockpit: Cockpit, chance: random.Random) -> None:
    """What somebody might do on the page."""
    live = cockpit.live
    robot = live.scenario.robot
    things: tuple[Callable[[], None], ...] = (
        lambda: live.alter(gait=replace(live.scenario.gait, amplitude=math.radians(chance.uniform(10.0, 40.0)))),
        lambda: live.alter(robot=with_fin(robot, robot.caudal_fin is None, None)),
        lambda: live.alter(robot=with_fin(robot, True, chance.uniform(0.1, 0.5))),
        lambda: live.alter(joints=chance.choice(("prescribed", "pd", "servo"))),
        lambda: live.alter(current=(chance.uniform(-0.05, 0.05), 0.0)),
        lambda: live.alter(path=None if isinstance(live.scenario.motion, lc.PathFollowing) else StraightLine()),
        lambda: setattr(live, "link_forces", not live.link_forces),
        cockpit._reset,
    )
    chance.choice(things)()
    cockpit._show_scenario()


def soak(
    minutes: float,
    times: float,
    *,
    every: float,
    browser: bool,
    seed: int = 0,
    sample: float = SAMPLE,
) -> Soak:
    """Let the world live with one page open.

    Args:
        minutes: For how long, in the world's time [min].
        times: How much faster than real time, if the computer can [-].
        every: Time between two things that are done on the page, in the world's time; infinity: nothing is done [s].
        browser: Whether the page is one in Chromium.
        seed: Of what is done.
        sample: Time between two looks at the memory, in the world's time [s].
    """
    chance = random.Random(seed)
    pause = round(every / FRAME) if math.isfinite(every) else 0
    cockpit = Cockpit(Live(lc.scenario("mamba-fin", GAIT)), port=0)
    rows: list[tuple[float, float, float]] = []
    with (chromium if browser else reader)(cockpit.address) as heap:
        end = time.monotonic() + 60.0
        while cockpit.pages == 0 and time.monotonic() < end:
            time.sleep(0.05)
        if cockpit.pages == 0:
            raise RuntimeError("The page did not come.")
        begun = time.monotonic()
        for k in range(1, round(60.0 * minutes / FRAME) + 1):
            cockpit.live.advance(FRAME)
            cockpit.frame()
            if pause and k % pause == 0:
                do_something(cockpit, chance)
            if k % round(sample / FRAME) == 0:
                rows.append((k * FRAME / 60.0, resident(), heap()))
            time.sleep(max(begun + k * FRAME / times - time.monotonic(), 0.0))
        took = time.monotonic() - begun
        if cockpit.pages != 1:
            raise RuntimeError("The page was lost.")
    cockpit.close()
    at, server, page = np.array(rows).T
    return Soak(minutes=at, server=server, page=page, times=60.0 * minutes / took)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--times", type=float, default=10.0)
    parser.add_argument("--every", type=float, default=EVERY)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--no-browser", action="store_true")
    options = parser.parse_args()
    browser = not options.no_browser and shutil.which("chromium") is not None
    for kind, every in (("idle", math.inf), ("busy", options.every)):
        found = soak(options.minutes, options.times, every=every, browser=browser, seed=options.seed)
        for row in zip(found.minutes, found.server, found.page, strict=True):
            print("{} {:6.1f} min  server {:6.1f} MB  page {:6.1f} MB".format(kind, *row))
        print(
            f"{kind}: {options.minutes:g} min at {found.times:.1f} x real time; growth in the last third: server "
            f"{slope(found.minutes, found.server):+.0f} kB/min, page {slope(found.minutes, found.page):+.0f} kB/min",
            flush=True,
        )


if __name__ == "__main__":
    main()
