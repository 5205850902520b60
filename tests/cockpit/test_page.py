"""The page in a browser: what somebody does on it, and what comes of it."""

import math
import time

import pytest
from cockpit_browser import browser, open_page, shots

import laticauda as lc
from laticauda.cockpit import Cockpit, Live, Setting

pytestmark = pytest.mark.slow
GAIT = lc.lateral_undulation(
    amplitude=math.radians(30.0), frequency=math.radians(130.0), phase_shift=math.radians(40.0)
)


@pytest.fixture
def cockpit():
    pytest.importorskip("viser")
    served = Cockpit(Live(Setting(robot=lc.load_robot("mamba"), gait=GAIT)), port=0)
    served.open()
    yield served
    served.close()


def until(condition, patience=40.0):
    """Wait until a condition holds; whether it did."""
    end = time.monotonic() + patience
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.1)
    return bool(condition())


def test_the_page_shows_the_robot_and_its_numbers_in_a_browser(cockpit, tmp_path):
    with browser() as found:
        page = open_page(found, cockpit.address)
        assert until(lambda: cockpit.pages == 1)
        assert until(lambda: cockpit.live.numbers().cycle_velocity > 0.1)
        assert until(lambda: page.get_by_text("forward velocity (5)").count() > 0)
        page.screenshot(path=shots(tmp_path) / "cockpit.png", timeout=60_000)
    assert until(lambda: cockpit.pages == 0)


def test_pages_that_vanish_in_the_middle_harm_nothing(cockpit):
    websockets = pytest.importorskip("websockets.sync.client")
    viser = pytest.importorskip("viser")

    def joined():
        protocol = f"viser-v{viser.__version__}"
        page = websockets.connect(
            cockpit.address.replace("http", "ws"), subprotocols=[protocol], max_size=None, compression=None
        )
        assert page.recv(timeout=10.0)
        return page

    pages = [joined() for _ in range(3)]
    for page in pages[:2]:
        page.socket.close()  # without a word
    ticks = cockpit.live.world.ticks
    assert until(lambda: cockpit.live.world.ticks > ticks + 40)
    assert pages[2].recv(timeout=10.0)
    assert cockpit._thread.is_alive()
    pages[2].close()
