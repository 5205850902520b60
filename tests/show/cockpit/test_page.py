"""The page in a browser: what somebody does on it, and what comes of it."""

import json
import math
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest
from cockpit_browser import (
    FLAGS,
    PHONE,
    SMALL,
    browser,
    changed,
    choose,
    close_notes,
    drag,
    field,
    height,
    need_chromium,
    number,
    on_screen,
    open_page,
    picture,
    shots,
    still_picture,
    until,
)
from patience import LONG, running

import laticauda as lc
from laticauda.show.cockpit import Cockpit, Live
from laticauda.show.cockpit.cameras import FIELD_OF_VIEW, HOME
from laticauda.show.cockpit.changes import read_depth
from laticauda.show.cockpit.shapes import compute_poses

pytestmark = pytest.mark.slow
GAIT = lc.lateral_undulation(
    amplitude=math.radians(30.0), frequency=math.radians(130.0), phase_shift=math.radians(40.0)
)
SPEED_OF_TIME = 4  # the how many-th slider
SPEED, ERROR = "over the last gait cycle", "cross-track error"


@pytest.fixture(scope="module")
def launched():
    pytest.importorskip("viser")
    with browser() as found:
        yield found


@pytest.fixture
def chromium(launched):
    """The browser; pages that a test leaves open would go on drawing."""
    yield launched
    for context in launched.contexts:
        context.close()


@pytest.fixture
def address():
    """Of `laticauda cockpit`, in a process of its own."""
    words = [
        "-c",
        "import sys; from laticauda.cli import main; sys.exit(main())",
        "cockpit",
        "--port",
        "0",
        "--json",
    ]
    with running([sys.executable, *words], stdout=subprocess.PIPE) as process:
        yield json.loads(process.stdout.readline())["address"]
        assert process.poll() is None  # nothing has brought it down
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=LONG)
        assert process.returncode == 0


@pytest.fixture
def cockpit():
    pytest.importorskip("viser")
    served = Cockpit(Live(lc.build_scenario("mamba", GAIT)), port=0)
    served.open()
    yield served
    served.close()


def test_what_is_done_on_the_page_acts_at_once_and_is_seen(chromium, address, tmp_path):
    page, folder = open_page(chromium, address), shots(tmp_path)
    sliders = page.get_by_role("slider")
    pause = page.get_by_text("pause", exact=True)
    # Steadily, it swims at 0.143 m/s, and at 80 degrees a second at 0.113, a fifth less.
    assert until(lambda: number(page, SPEED) > 0.142)
    before, speed = picture(page, folder / "1-swims.png"), number(page, SPEED)

    # A slider: the speed and the picture change. A paused world stands still in the picture.
    drag(page, sliders.nth(1), 0.36)
    page.wait_for_timeout(
        200
    )  # viser's page sends every 50 ms what was changed last, of whatever control
    sliders.nth(SPEED_OF_TIME).press("End")
    assert until(lambda: number(page, SPEED) < 0.8 * speed)
    assert 75.0 <= float(field(page, "frequency [°/s]").input_value()) <= 85.0
    assert changed(before, picture(page)) > 0.005
    pause.click()
    bare = still_picture(page)

    # The fin.
    choose(page, "fin", "rigid")
    assert until(lambda: changed(bare, picture(page, folder / "2-fin.png")) > 0.001)

    # What cannot be is refused in the words of the API, and the field goes back.
    choose(page, "fin", "elastic")
    rigidity = field(page, "rigidity [N m²]")
    rigidity.fill("-1")
    rigidity.press("Enter")
    page.get_by_text("`flexural_rigidity` must be > 0 N m^2, got -1").wait_for()
    assert until(lambda: rigidity.input_value() == "0.2")
    page.screenshot(path=folder / "3-refused.png")
    field(page, "amplitude [°]").fill("99")
    page.get_by_text("`amplitude_deg` must be between 0 and 60, got 99").wait_for()
    assert until(lambda: field(page, "amplitude [°]").input_value() == "30")
    close_notes(page)
    choose(page, "fin", "none")

    # The map, and the best gait on it.
    page.get_by_role("tab", name="Map").click()
    page.get_by_text("show the map").click()
    page.get_by_text("swim the best of the map").click()
    page.screenshot(path=folder / "4-map.png")
    page.get_by_role("tab", name="Swim").click()
    assert until(lambda: field(page, "amplitude [°]").input_value() != "30")

    # A path: the error falls.
    page.get_by_text("follow a path").click()
    page.get_by_text("link forces").click()
    assert until(lambda: abs(number(page, ERROR)) > 0.4)
    pause.click()
    assert until(lambda: abs(number(page, ERROR)) < 0.1)
    page.screenshot(path=folder / "5-path.png")
    page.get_by_role("tab", name="Plots").click()
    assert until(lambda: height(page, "Speed [m/s]") < 30.0)  # has found its width
    page.screenshot(path=folder / "6-plots.png")
    page.get_by_role("tab", name="Run").click()
    page.screenshot(path=folder / "7-run.png")
    page.context.close()


def test_a_broken_file_says_what_is_wrong_and_a_whole_one_swims_as_a_ghost(
    chromium, cockpit, tmp_path
):
    (tmp_path / "broken.nc").write_bytes(b"no netCDF")
    lc.swim(cockpit.live.scenario.robot, GAIT, 5.0).save(tmp_path / "run.nc")
    page = open_page(chromium, cockpit.address)
    page.get_by_role("tab", name="Run").click()

    def load(name):
        with page.expect_file_chooser() as chooser:
            page.get_by_text("play back a trial").click()
        chooser.value.set_files(tmp_path / name)

    load("broken.nc")
    page.get_by_text("Cannot load broken.nc").wait_for()
    close_notes(page)
    load("run.nc")
    page.get_by_text("remove the ghost").wait_for()
    page.screenshot(path=shots(tmp_path) / "8-ghost.png")
    with page.expect_download() as download:
        page.get_by_text("save the run").click()
    download.value.save_as(tmp_path / "saved.nc")
    page.context.close()
    assert lc.load_trial(tmp_path / "saved.nc").robot == cockpit.live.scenario.robot


def rests_for_a_second(camera):
    """Return whether a camera is, a second later, where it was."""
    position = np.array(camera.position)
    time.sleep(1.0)
    return np.allclose(camera.position, position, atol=1e-3)


def test_pages_keep_their_own_view(chromium, cockpit):
    cockpit.live.paused = True
    one, other = (open_page(chromium, cockpit.address, SMALL) for _ in range(2))
    assert until(
        lambda: cockpit.pages == 2 and all(view.is_home for view in cockpit._cameras.all())
    )
    views = cockpit._cameras.all()
    first, second = (view.camera for view in views)
    home = np.array(first.position)
    np.testing.assert_allclose(second.position, home, atol=1e-3)
    other.mouse.move(100, 300)
    other.mouse.down()
    other.mouse.move(200, 250, steps=2)
    other.mouse.up()
    assert until(lambda: np.abs(second.position - home).max() > 0.3)
    np.testing.assert_allclose(first.position, home, atol=1e-3)

    # The page whose camera follows goes along, the other one stays.
    other.get_by_text("camera follows").click()
    assert until(lambda: [view.follows.value for view in views] == [True, False])
    # What was dragged arrives in pieces, late ones on a busy machine.
    assert until(lambda: rests_for_a_second(second))
    left = np.array(second.position)
    cockpit.live.speed, cockpit.live.paused = 8.0, False
    assert until(lambda: cockpit.live.latest().center_of_mass[0] > 1.5)
    assert until(lambda: first.position[0] > home[0] + 1.0)
    view = np.subtract(*HOME)
    assert until(lambda: np.allclose(first.position - first.look_at, view, atol=1e-3), patience=5.0)
    np.testing.assert_allclose(second.position, left, atol=0.1)
    for page in (one, other):
        page.context.close()
    assert until(lambda: cockpit.pages == 0)


def test_on_a_phone_the_robot_is_seen_above_the_panel(chromium, cockpit, tmp_path):
    cockpit.live.paused = True
    page = open_page(chromium, cockpit.address, PHONE)
    assert until(lambda: [view.is_home for view in cockpit._cameras.all()] == [True])
    camera = cockpit._cameras.all()[0].camera
    handle = page.get_by_text("laticauda cockpit", exact=True)
    panel = handle.locator(
        "xpath=ancestor::*[contains(@class, 'mantine-Paper-root')]"
    ).bounding_box()
    assert (panel["x"], panel["width"]) == (0.0, PHONE["width"])
    parts = compute_poses(cockpit.live.scenario.robot, cockpit.live.latest()).position
    seen = [
        on_screen(camera.position, camera.look_at, FIELD_OF_VIEW, part, PHONE) for part in parts
    ]
    assert all(0.0 < x < PHONE["width"] and 0.0 < y < panel["y"] - 50.0 for x, y in seen)
    page.screenshot(path=shots(tmp_path) / "phone.png")
    handle.click()  # the panel folds up
    page.get_by_text("speed in the tank").wait_for(state="hidden")
    page.context.close()


def test_a_browser_that_is_killed_harms_nothing(cockpit, tmp_path):
    words = [
        need_chromium(),
        "--headless",
        *FLAGS,
        f"--user-data-dir={tmp_path}",
        "--no-first-run",
        cockpit.address,
    ]
    killed = subprocess.Popen(
        words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    )
    try:
        assert until(lambda: cockpit.pages == 1)
    finally:
        os.killpg(killed.pid, signal.SIGKILL)
        killed.wait()
    ticks = cockpit.live.simulation.ticks
    assert until(lambda: cockpit.pages == 0)
    assert until(lambda: cockpit.live.simulation.ticks > ticks + 40)
    assert cockpit._thread.is_alive()


def test_pages_that_vanish_in_the_middle_harm_nothing(cockpit):
    websockets = pytest.importorskip("websockets.sync.client")
    viser = pytest.importorskip("viser")

    def joined():
        protocol = f"viser-v{viser.__version__}"
        page = websockets.connect(
            cockpit.address.replace("http", "ws"),
            subprotocols=[protocol],
            max_size=None,
            compression=None,
        )
        assert page.recv(timeout=10.0)
        return page

    pages = [joined() for _ in range(3)]
    for page in pages[:2]:
        page.socket.close()  # without a word
    ticks = cockpit.live.simulation.ticks
    assert until(lambda: cockpit.live.simulation.ticks > ticks + 40)
    assert pages[2].recv(timeout=10.0)
    assert cockpit._thread.is_alive()
    pages[2].socket.close()


def test_a_depth_is_typed_and_held_in_space(chromium, tmp_path):
    robot = lc.load_robot("mamba-modules")
    water = replace(lc.load_water("paper-lateral"), density=robot.mass / robot.volume)
    start = lc.Start(depth=0.7)
    served = Cockpit(
        Live(lc.build_scenario(robot, GAIT, environment=water, model="spatial", start=start)),
        port=0,
    )
    served.open()
    page = open_page(chromium, served.address)
    depth = field(page, "hold depth [m]")
    depth.fill("0.85")
    depth.press("Enter")
    assert until(lambda: read_depth(served.live.scenario) == 0.85)
    served.live.speed = 4.0
    assert until(lambda: abs(number(page, "depth") - 0.85) < 0.04)
    assert all(
        "deg" in page.locator(f"tr:has-text('{name}')").last.inner_text()
        for name in ("pitch", "roll")
    )
    page.screenshot(path=shots(tmp_path) / "depth.png")
    assert served.live.simulation.failure is None
    page.close()
    served.close()
