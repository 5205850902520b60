"""Does the cockpit lose memory while a page is left open?

Question: how do the memory of the server and of a page grow over 30 minutes, once with nothing done
and once with something done on it every ten seconds (gait, fin, joints, current, path, forces,
reset)? Time is made to go faster: as many pictures are sent as in those minutes, each with its
share of the world's time. The page is Chromium, if that and playwright are there, and otherwise a
client that reads everything and draws nothing.

    python campaigns/cockpit_soak.py                       # 30 minutes, ten times as fast as real time
    python campaigns/cockpit_soak.py --minutes 10 --every 0.2 --no-browser   # 3000 changes
    python campaigns/cockpit_soak.py --day     # 24 hours, the clock 50 times as fast, 200 visits, a change a minute
    python campaigns/cockpit_soak.py --day --no-browser       # the same, where two cores cannot draw so fast

The tests run a slice of it.

The first 20 minutes fill the memory that is set aside for the run: only after them is growth a
loss. A change empties it, so that one look at the memory says little: a day looks every ten
minutes, and compares means of two hours.

The day without a browser (2 cores, beside the whole test suite, 2026-11-27): 24 h, 200 visits and
1440 changes at 31 times real time; the last two hours are 0.1 % above hours 2 and 3. Memory of the
server, means of an hour, and what its allocator held at least in it, which a change does not empty
[MB]:
    hour         1      2      3      4      8     12     16     20     22     23     24
    server   305.1  306.8  306.9  306.6  307.1  306.4  306.9  307.6  306.7  307.2  306.8
    held      84.6   84.2   84.6   84.3   84.7   84.4   84.4   84.3   84.6   84.3   84.6
Before what pages leave behind was collected, it held 44 MB in the first hour and 52 in the last,
and the server grew by 6.1 %. (It began with kernels from a cache then; the numbers above have 50 MB
of the compiler in them.) With Chromium an hour takes some 2.5 minutes there; the day has not been
run with it.

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
from typing import Any, NamedTuple

import numpy as np

import laticauda as lc
from laticauda.control import StraightLine
from laticauda.show.cockpit import Cockpit, Live
from laticauda.show.cockpit.changes import change_fin
from laticauda.show.cockpit.page import FRAME

GAIT = lc.lateral_undulation(
    amplitude=math.radians(30.0), frequency=math.radians(130.0), phase_shift=math.radians(40.0)
)
PAGE = Path(__file__).parent.parent / "benchmarks" / "_page.py"
EVERY = 10.0  # time between two things that are done on a busy page, in the world's time [s]
DAY = 50.0  # how much faster a day goes by
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


class Visitor(NamedTuple):
    """Whoever has the page open."""

    heap: Callable[[], float] = lambda: math.nan
    """Memory of the page's JavaScript after a collection [MB]."""
    again: Callable[[], None] = lambda: None
    """Close the page, and open it anew."""


@contextlib.contextmanager
def reader(address: str) -> Iterator[Visitor]:
    """A page without a picture, in a process of its own."""
    words = [sys.executable, str(PAGE), address]
    there: list[subprocess.Popen[bytes]] = []

    def leave() -> None:
        there[-1].kill()
        there.pop().wait()

    def again() -> None:
        if there:
            leave()
        there.append(subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))

    again()
    try:
        yield Visitor(again=again)
    finally:
        leave()


@contextlib.contextmanager
def chromium(address: str) -> Iterator[Visitor]:
    """A page in a browser."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        found = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=list(FLAGS)
        )
        pages: list[Any] = []

        def again() -> None:
            if pages:
                pages.pop().close()
            pages.append(found.new_page(viewport={"width": 640, "height": 400}))
            pages[-1].goto(address)

        def heap() -> float:
            talk = pages[-1].context.new_cdp_session(pages[-1])
            talk.send("HeapProfiler.collectGarbage")
            return talk.send("Runtime.getHeapUsage")["usedSize"] / 1e6

        again()
        try:
            yield Visitor(heap, again)
        finally:
            found.close()


def do_something(cockpit: Cockpit, chance: random.Random) -> None:
    """What somebody might do on the page."""
    live = cockpit.live
    robot = live.scenario.robot
    things: tuple[Callable[[], None], ...] = (
        lambda: live.alter(
            gait=replace(live.scenario.gait, amplitude=math.radians(chance.uniform(10.0, 40.0)))
        ),
        lambda: live.alter(robot=change_fin(robot, robot.caudal_fin is None, None)),
        lambda: live.alter(robot=change_fin(robot, True, chance.uniform(0.1, 0.5))),
        lambda: live.alter(joints=chance.choice(("prescribed", "pd", "servo"))),
        lambda: live.alter(current=(chance.uniform(-0.05, 0.05), 0.0)),
        lambda: live.alter(
            path=None if isinstance(live.scenario.motion, lc.PathFollowing) else StraightLine()
        ),
        lambda: setattr(live, "link_forces", not live.link_forces),
        cockpit._reset,
    )
    chance.choice(things)()
    cockpit._show_scenario()


def wait_for_page(cockpit: Cockpit) -> None:
    """Until there is one page, and no other any more."""
    end = time.monotonic() + 120.0
    while cockpit.pages != 1 and time.monotonic() < end:
        time.sleep(0.05)
    if cockpit.pages != 1:
        raise RuntimeError("The page did not come.")


def soak(
    minutes: float,
    times: float,
    *,
    every: float,
    browser: bool,
    seed: int = 0,
    sample: float = SAMPLE,
    clock: float = 1.0,
    visits: int = 0,
    longest: float = math.inf,
) -> Soak:
    """Let the world live with one page open.

    Args:
        minutes: For how long, in the world's time [min].
        times: How much faster than real time, if the computer can [-].
        every: Time between two things that are done on the page, in the world's time; infinity:
            nothing is done [s].
        browser: Whether the page is one in Chromium.
        seed: Of what is done.
        sample: Time between two looks at the memory, in the world's time [s].
        clock: The world's time from picture to picture, over that of a page at normal speed [-].
        visits: How often the page is closed and opened again [-].
        longest: How long it may take on the wall; what is left is not done then [s].
    """
    chance = random.Random(seed)
    frame = FRAME * clock
    pause = round(every / frame) if math.isfinite(every) else 0
    n = round(60.0 * minutes / frame)
    cockpit = Cockpit(Live(lc.build_scenario("mamba-fin", GAIT)), port=0)
    rows: list[tuple[float, float, float]] = []
    with (chromium if browser else reader)(cockpit.address) as visitor:
        wait_for_page(cockpit)
        begun = time.monotonic()
        for k in range(1, n + 1):
            cockpit.live.advance(frame)
            cockpit.frame()
            if pause and k % pause == 0:
                do_something(cockpit, chance)
            if visits and k % (n // visits) == 0 and k < n:
                visitor.again()
                wait_for_page(cockpit)
            if k % round(sample / frame) == 0:
                rows.append((k * frame / 60.0, resident(), visitor.heap()))
                if clock > 1.0:
                    print(
                        "{:6.0f} min  server {:6.1f} MB  page {:6.1f} MB".format(*rows[-1]),
                        flush=True,
                    )
            if time.monotonic() > begun + longest:
                minutes = k * frame / 60.0
                break
            time.sleep(max(begun + k * frame / times - time.monotonic(), 0.0))
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
    parser.add_argument("--day", action="store_true")
    parser.add_argument("--longest", type=float, default=math.inf)
    options = parser.parse_args()
    browser = not options.no_browser and shutil.which("chromium") is not None
    if options.day:
        way = {
            "every": 60.0,
            "browser": browser,
            "seed": options.seed,
            "sample": 600.0,
            "longest": options.longest,
        }
        found = soak(24 * 60.0, DAY, clock=DAY, visits=200, **way)
        hours = found.minutes / 60.0
        early, late = (
            found.server[(hours > end - 2.0) & (hours <= end)] for end in (3.0, hours[-1])
        )
        growth, visits = late.mean() / early.mean() - 1.0, round(200 * hours[-1] / 24.0)
        print(
            f"{hours[-1]:.0f} h, {visits} visits, at {found.times:.1f} x real time: the last two hours "
            f"{100.0 * growth:+.1f} % above hours 2 and 3"
        )
        return
    for kind, every in (("idle", math.inf), ("busy", options.every)):
        found = soak(
            options.minutes, options.times, every=every, browser=browser, seed=options.seed
        )
        for row in zip(found.minutes, found.server, found.page, strict=True):
            print("{} {:6.1f} min  server {:6.1f} MB  page {:6.1f} MB".format(kind, *row))
        print(
            f"{kind}: {options.minutes:g} min at {found.times:.1f} x real time; growth in the last third: server "
            f"{slope(found.minutes, found.server):+.0f} kB/min, page {slope(found.minutes, found.page):+.0f} kB/min",
            flush=True,
        )


if __name__ == "__main__":
    main()
