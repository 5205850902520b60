"""What the cockpit costs: real-time factor, share of a core and memory, with three pages that read everything.

    python benchmarks/cockpit.py [seconds]

The pages are websocket clients that take all messages as a browser does. They draw nothing and report no camera, so
what it costs to let cameras follow is not in the figures.
"""

import asyncio
import math
import sys
import threading
import time

import websockets

import laticauda as lc
from laticauda.cockpit import Cockpit, Live, Setting

PAGES = 3
GAIT = lc.lateral_undulation(
    amplitude=math.radians(30.0), frequency=math.radians(130.0), phase_shift=math.radians(40.0)
)


def resident() -> float:
    """Memory of this process [MB]."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096 / 1e6


async def read(address: str, stop: threading.Event, count: list[int]) -> None:
    import viser

    url = address.replace("http", "ws")
    protocol = f"viser-v{viser.__version__}"
    async with websockets.connect(url, max_size=None, subprotocols=[protocol]) as page:
        while not stop.is_set():
            try:
                count.append(len(await asyncio.wait_for(page.recv(), 0.5)))
            except TimeoutError:
                continue
            except websockets.ConnectionClosed:
                return


def measure(model: str, duration: float, speed: float = 1.0) -> None:
    live = Live(Setting(robot=lc.load_robot("mamba-fin"), gait=GAIT, model=model))
    live.speed = speed
    cockpit = Cockpit(live, port=0)
    stop, sizes = threading.Event(), [[] for _ in range(PAGES)]
    readers = [
        threading.Thread(target=asyncio.run, args=(read(cockpit.address, stop, size),), daemon=True) for size in sizes
    ]
    cockpit.open()
    for reader in readers:
        reader.start()
    time.sleep(3.0)
    begun, cpu, world, memory = time.perf_counter(), time.process_time(), live.world.time, resident()
    time.sleep(duration)
    wall = time.perf_counter() - begun
    print(
        f"{model:8s} {PAGES} pages, time x {speed:g}: real-time factor {(live.world.time - world) / wall / speed:.3f}, "
        f"{100.0 * (time.process_time() - cpu) / wall:.0f} % of a core (pages' reading included), "
        f"{sum(map(sum, sizes)) / 1e6 / (wall + 3.0) / PAGES:.2f} MB/s per page, "
        f"memory {memory:.0f} -> {resident():.0f} MB, lag {live.lag:.2f} s"
    )
    stop.set()
    cockpit.close()


if __name__ == "__main__":
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 20.0
    for model in ("planar", "spatial"):
        measure(model, seconds)
    measure("planar", seconds, speed=8.0)
