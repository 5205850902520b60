"""The page in Chromium: from a disk and from a file server, as large as a desk's screen and as a phone's."""

import functools
import http.server
import importlib.util
import threading

import pytest
from cockpit_browser import browser, shots, until
from web_pages import by_python, difference

import laticauda as lc

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        importlib.util.find_spec("ziglang") is None, reason="ziglang is not installed"
    ),
]
DESK, PHONE = {"width": 1366, "height": 768}, {"width": 390, "height": 844}


@pytest.fixture(scope="module")
def launched():
    with browser() as found:
        yield found


@pytest.fixture
def chromium(launched):
    """The browser, whose pages are closed after each test: they would swim on."""
    yield launched
    for context in launched.contexts:
        context.close()


@pytest.fixture(scope="module")
def address(folder):
    """Of a plain file server."""
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=str(folder))
    handler.log_message = lambda *_: None
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/index.html"
        server.shutdown()


def opened(chromium, address, size=DESK):
    page = chromium.new_page(viewport=size)
    page.set_default_timeout(30_000)
    faults = []
    page.on("pageerror", lambda fault: faults.append(fault))
    page.goto(address)
    assert until(lambda: page.evaluate("page.swimmer !== null && page.swimmer.get('time') > 0.5"))
    assert faults == []
    return page


def test_a_robot_swims_from_a_disk_and_what_is_set_is_in_the_link(chromium, folder, tmp_path):
    page = opened(chromium, (folder / "index.html").as_uri())
    page.locator("#amplitude-deg").fill("45")
    page.locator("#normal-drag").fill("2.5")
    page.locator("#gait").select_option("eel_like")
    page.locator("#follow").check()
    assert page.url.endswith(page.evaluate("'#' + toLink(page.setting)"))
    assert {"amplitude-deg=45", "normal-drag=2.5", "gait=eel_like"} <= set(
        page.url.partition("#")[2].split("&")
    )
    assert "--amplitude-deg 45" in page.locator("#shell").inner_text()

    # A point of the path, taken by the mouse, goes along.
    before = page.evaluate("page.setting.waypoints")
    page.evaluate("view.follows = false, scrollTo(0, 0)")
    x, y = page.evaluate(
        "(([x, y]) => { const box = view.canvas.getBoundingClientRect();"
        " return [box.left + 0.5 * box.width + view.scale * (x - view.center[0]),"
        " box.top + 0.5 * box.height - view.scale * (y - view.center[1])]; })(page.setting.waypoints[0])"
    )
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 60, y + 30, steps=4)
    page.mouse.up()
    after, scale = page.evaluate("page.setting.waypoints"), page.evaluate("view.scale")
    assert after[1:] == before[1:]
    moved = after[0][0] - before[0][0], after[0][1] - before[0][1]
    assert moved == pytest.approx((60 / scale, -30 / scale), abs=0.02)

    # The link opens it again.
    again = opened(chromium, page.url)
    assert again.evaluate("page.setting") == page.evaluate("page.setting")
    again.screenshot(path=shots(tmp_path) / "web-desk.png")


def test_the_table_that_the_page_hands_out_is_the_trial_that_its_python_makes(chromium, address):
    page = opened(
        chromium, f"{address}#robot=mamba-fin&fin=elastic&flexural-rigidity=0.3&current-x=0.05"
    )
    with page.expect_download() as handed_out:
        page.locator("#csv").click()
    assert handed_out.value.suggested_filename == "trial.csv"
    trial = lc.swim(by_python(page.locator("#python").inner_text()))
    assert difference(handed_out.value.path().read_text(), trial) < 1e-10  # of servos
    assert until(
        lambda: f"speed {trial.forward_velocity:.3f} m/s" in page.locator("#figures").inner_text()
    )


def test_a_phone_shows_it_without_scrolling_sideways_and_fingers_pan(chromium, address, tmp_path):
    page = opened(chromium, address, PHONE)
    assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
    page.mouse.move(200, 250)
    page.mouse.down()
    page.mouse.move(140, 250, steps=3)
    page.mouse.up()
    assert not page.evaluate("view.follows")
    page.locator("#home").click()
    assert page.evaluate("view.follows")
    page.locator("#play").click()
    time = page.evaluate("page.swimmer.get('time')")
    page.wait_for_timeout(300)
    assert page.evaluate("page.swimmer.get('time')") == time
    page.screenshot(path=shots(tmp_path) / "web-phone.png")


def test_a_change_of_the_water_goes_on_from_where_the_robot_is(chromium, address):
    page = opened(chromium, address)
    page.locator("#play").click()  # it stands still
    state = "page.swimmer.body.state.map((row) => page.swimmer.rows[row])"
    before = page.evaluate(state)
    page.locator("#tangential-friction").fill("0.6")
    assert page.evaluate(state) == before
    assert page.evaluate("page.swimmer.get('water.tangential_friction')") == 0.6
