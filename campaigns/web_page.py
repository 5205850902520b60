"""The page without a server in Chromium and Firefox, and its numbers for all its robots.

    python campaigns/web_page.py [FOLDER]       pictures go to FOLDER, out/web_page if left out

Takes two minutes. It says how large the page is, how far 40 settings by chance are from Python (at
most 1e-10 of each series' largest number), and for each browser, from a disk and from a file
server, on a desk and on a phone: when the robot made its first stroke, what swimming takes of a
frame at real time, and whether a link opens its setting again. What is not installed is left out,
and said.
"""

import argparse
import functools
import gzip
import http.server
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

from firefox import FIREFOX, firefox
from web_pages import NODE, by_python, difference, some_links, trials

import laticauda as lc
from laticauda.connect.web import export_web
from laticauda.values.errors import BadArgument

LINK = "robot=mamba-fin&current-y=0.03&waypoints=0.2+-0.5+2.4+-0.5+3.8+0.6"
SIZES = {"desk": (1366, 768), "phone": (390, 844)}
MOST = {
    "difference": 1e-10,  # servos at the end of their speed make rounding larger; without them 1e-14
    "kilobytes": 500.0,
    "first stroke [ms]": 1000.0,
    "of a frame [ms]": 4.0,
}
TIMES = "({...page.timing, wide: document.documentElement.scrollWidth})"
OTHER = "robot=mamba-fin&fin=elastic&gait=eel_like&amplitude-deg=41&flexural-rigidity=0.35&waypoints=0+1+2+1.5"


def worst_difference(folder: Path, count: int = 40, seed: int = 11) -> tuple[float, int]:
    """Between settings by chance on the page and in Python, and how many of them Python took."""
    links, worst, taken = some_links(folder, count, seed), 0.0, 0
    for found in trials(folder, links):
        try:
            trial = lc.swim(by_python(found["python"]))
        except BadArgument:
            assert found["refusal"], "Python refuses what the page does not"
            continue
        worst, taken = max(worst, difference(found["csv"], trial)), taken + 1
    return worst, taken


def looked_at(
    evaluate: Callable[[str], Any], go: Callable[[str], None], address: str, width: int
) -> dict[str, Any]:
    """What a browser shows at an address, after some seconds."""
    go(f"{address}#{LINK}")
    time.sleep(4.0)
    times = evaluate(TIMES)
    assert times["wide"] <= width, "it scrolls sideways"
    evaluate(f"openSetting(fromLink('{OTHER}'))")
    time.sleep(1.0)
    link = evaluate("location.hash")
    assert evaluate(
        "JSON.stringify(page.setting) === JSON.stringify(fromLink(location.hash.slice(1)))"
    )
    return {
        "first stroke [ms]": times["first"],
        "of a frame [ms]": times["spent"] / times["frames"],
        "link": link,
    }


def in_chromium(addresses: dict[str, str], pictures: Path) -> dict[str, dict[str, Any]]:
    """All of it in Chromium."""
    from cockpit_browser import browser

    found: dict[str, dict[str, Any]] = {}
    with browser() as chromium:
        for (way, address), (size, (width, height)) in _all(addresses):
            page = chromium.new_page(viewport={"width": width, "height": height})
            found[f"Chromium, {way}, {size}"] = looked_at(page.evaluate, page.goto, address, width)
            page.screenshot(path=pictures / f"chromium-{way}-{size}.png")
            page.close()
    return found


def in_firefox(addresses: dict[str, str], pictures: Path) -> dict[str, dict[str, Any]]:
    """All of it in Firefox."""
    found: dict[str, dict[str, Any]] = {}
    with firefox() as page:
        for (way, address), (size, (width, height)) in _all(addresses):
            page.size(width, height)
            found[f"Firefox, {way}, {size}"] = looked_at(page.evaluate, page.open, address, width)
            page.screenshot(pictures / f"firefox-{way}-{size}.png")
    return found


def _all(addresses: dict[str, str]) -> list[Any]:
    return [(one, size) for one in addresses.items() for size in SIZES.items()]


def main() -> int:
    """Do it, and say what came out; 1 if something is beyond its limit."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("pictures", nargs="?", type=Path, default=Path("out/web_page"))
    pictures: Path = parser.parse_args().pictures
    pictures.mkdir(parents=True, exist_ok=True)
    figures: dict[str, dict[str, Any]] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        files = export_web(folder)
        figures["page"] = {
            "kilobytes": sum(len(gzip.compress(file.read_bytes())) for file in files) / 1000.0
        }
        if NODE is None:
            print("node is not installed: no numbers are compared")
        else:
            worst, taken = worst_difference(folder)
            figures[f"{taken} settings"] = {"difference": worst}
        handler: Any = functools.partial(http.server.SimpleHTTPRequestHandler, directory=name)
        http.server.SimpleHTTPRequestHandler.log_message = lambda *_: None  # type: ignore[method-assign]
        with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            index = "index.html"
            addresses = {
                "disk": (folder / index).as_uri(),
                "server": f"http://127.0.0.1:{server.server_port}/{index}",
            }
            figures |= in_chromium(addresses, pictures)
            if FIREFOX is None:
                print("Firefox is not installed")
            else:
                figures |= in_firefox(addresses, pictures)
            server.shutdown()
    bad = 0
    for name, found in figures.items():
        beyond = [key for key, number in found.items() if key in MOST and not number <= MOST[key]]
        bad += len(beyond)
        words = ", ".join(f"{key} {number:.3g}" for key, number in found.items() if key in MOST)
        print(f"{name}: {words}{'  <- TOO MUCH' if beyond else ''}")
    print(f"pictures in {pictures}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
