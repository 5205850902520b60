"""The page in a browser: what somebody does on it, and what comes of it."""

import math
import time

import numpy as np
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


def choose(page, present, wanted):
    page.locator(f"input[value={present}]").first.click()
    page.get_by_role("option", name=wanted, exact=True).click()


def picture(page):
    """The 3D picture, without the panel."""
    import io

    from matplotlib.image import imread

    return imread(io.BytesIO(page.screenshot(clip={"x": 0, "y": 200, "width": 400, "height": 300}, timeout=60_000)))


def test_what_is_done_on_the_page_acts_at_once_and_is_seen(cockpit, tmp_path):
    live, folder = cockpit.live, shots(tmp_path)
    with browser() as found:
        page = open_page(found, cockpit.address)
        assert until(lambda: page.get_by_text("m/s").count() > 0)
        assert until(lambda: (live.numbers().cycle_velocity or 0.0) > 0.1)
        page.screenshot(path=folder / "1-swims.png", timeout=60_000)
        before, speed = picture(page), live.numbers().cycle_velocity

        # A slider: the gait, the speed and the picture change.
        thumb = page.get_by_role("slider").nth(1)
        for _ in range(10):
            thumb.press("ArrowLeft")
        assert until(lambda: math.degrees(live.setting.gait.frequency) == pytest.approx(80.0))
        assert until(lambda: live.numbers().time > 8.0)
        assert live.numbers().cycle_velocity < 0.8 * speed
        shown = f"{live.numbers().cycle_velocity:.2f}"
        assert until(lambda: page.get_by_text(shown).count() > 0)
        assert np.abs(picture(page) - before).max() > 0.2

        # The fin.
        choose(page, "none", "rigid")
        assert until(lambda: live.setting.robot.caudal_fin is not None)
        page.screenshot(path=folder / "2-fin.png", timeout=60_000)


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
