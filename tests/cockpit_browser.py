"""A page in headless Chromium, for tests; skips where there is none."""

import contextlib
import ctypes.util
import io
import os
import re
import shutil
import time
from pathlib import Path

import numpy as np
import pytest
from patience import LONG

# Nobody has a graphics card here: Mesa draws some five pictures a second, Chromium's own software
# two.
DRAWN_BY = "gl-egl" if ctypes.util.find_library("EGL_mesa") else "swiftshader"
FLAGS = (
    "--no-sandbox",
    "--use-gl=angle",
    f"--use-angle={DRAWN_BY}",
    "--ignore-gpu-blocklist",
    "--enable-unsafe-swiftshader",
    # Smooth edges are two fifths of the work of a picture.
    "--webgl-antialiasing-mode=none",
    "--webgl-msaa-sample-count=0",
)
SIZE = {"width": 1024, "height": 640}
SMALL = {"width": 640, "height": 400}
PHONE = {"width": 390, "height": 844}
PANEL = 400  # width of what the panel hides on the right [px]
PIXELS_PER_POINT = 0.5
"""Of the 3D picture, along and across: without a graphics card, each pixel costs."""
FEWER_PICTURES = """
const draw = window.requestAnimationFrame.bind(window);
window.requestAnimationFrame = callback => setTimeout(() => draw(callback), 150);
"""
"""Script that lets a page draw some six pictures a second; without it, it draws as many as it can."""
CHROMIUM = (
    shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
)


def need_chromium():
    """Its path, or the test is skipped."""
    if CHROMIUM is None:
        pytest.skip("Chromium is not installed")
    return CHROMIUM


@contextlib.contextmanager
def browser():
    sync = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    path = need_chromium()
    with sync.sync_playwright() as playwright:
        found = playwright.chromium.launch(executable_path=path, args=list(FLAGS))
        try:
            yield found
        finally:
            found.close()


def open_page(found, address, size=SIZE):
    """A page that shows the cockpit, and draws no more and no finer pictures than a test needs."""
    from playwright.sync_api import TimeoutError as TooLate

    page = found.new_page(viewport=size)
    page.set_default_timeout(1e3 * LONG)
    page.add_init_script(FEWER_PICTURES)
    page.goto(f"{address}?fixedDpr={PIXELS_PER_POINT}")
    page.wait_for_selector("text=amplitude [°]")
    # The page warns that no graphics card draws it.
    with contextlib.suppress(TooLate):
        page.wait_for_selector("text=Software WebGL", timeout=5_000)
        close_notes(page)
    return page


def close_notes(page):
    """Away with the notes in the corner."""
    page.evaluate(
        "document.querySelectorAll('.mantine-Notification-root button').forEach(it => it.click())"
    )


def until(condition, patience=LONG):
    """Wait until a condition holds; whether it did."""
    end = time.monotonic() + patience
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.1)
    return bool(condition())


def number(page, name):
    """What the table on the page says of a figure; nan where it says nothing."""
    text = page.locator(f"tr:has-text('{name}')").last.locator("td, th").last.inner_text()
    found = re.match(r"-?[0-9.]+", text)
    return float(found.group()) if found else float("nan")


def height(page, text):
    """Of what shows a text [px]; infinite as long as nothing does."""
    box = page.get_by_text(text).bounding_box()
    return float("inf") if box is None else box["height"]


def field(page, label):
    """The field of a control."""
    return page.get_by_text(label, exact=True).locator(
        "xpath=following::input[not(@type='hidden')][1]"
    )


def choose(page, label, wanted):
    """Choose something from a list, and wait until its field shows that."""
    field(page, label).click()
    page.get_by_role("option", name=wanted, exact=True).click()
    assert until(lambda: field(page, label).input_value() == wanted)


def drag(page, slider, share):
    """Take hold of a slider and let it go at this share of its length.

    Not with the arrow keys: viser's page turns the camera with them, too, if a picture is drawn
    while they are down.
    """
    thumb = slider.bounding_box()
    track = slider.locator(
        "xpath=ancestor::*[contains(@class, 'mantine-Slider-root')]"
    ).bounding_box()
    height = thumb["y"] + 0.5 * thumb["height"]
    page.mouse.move(thumb["x"] + 0.5 * thumb["width"], height)
    page.mouse.down()
    page.mouse.move(track["x"] + share * track["width"], height, steps=10)
    page.mouse.up()


def picture(page, path=None):
    """The 3D picture beside the panel; with a path, the whole page is kept there."""
    from matplotlib.image import imread

    taken = page.screenshot() if path is None else page.screenshot(path=path)
    return imread(io.BytesIO(taken))[:, : SIZE["width"] - PANEL, :3]


def still_picture(page):
    """The 3D picture once nothing moves in it any more."""
    before = picture(page)
    for _ in range(20):
        now = picture(page)
        if changed(before, now) == 0.0:
            return now
        before = now
    raise AssertionError("The picture does not come to rest.")


def changed(one, other):
    """The share of pixels that differ visibly."""
    return float((np.abs(one - other).max(axis=-1) > 0.05).mean())


def shots(tmp_path):
    """Where screenshots are kept: where `LATICAUDA_SHOTS` says, or with pytest's other files."""
    folder = Path(os.environ.get("LATICAUDA_SHOTS", tmp_path))
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def on_screen(position, look_at, field_of_view, point, size=SIZE):
    """Where a point of the world is on the page, for a camera [px]."""
    position, look_at = np.array(position), np.array(look_at)
    forward = (look_at - position) / np.linalg.norm(look_at - position)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    ray = np.asarray(point) - position
    scale = 0.5 * size["height"] / np.tan(0.5 * field_of_view) / (ray @ forward)
    x, y = ray @ right, ray @ np.cross(right, forward)
    return 0.5 * size["width"] + scale * x, 0.5 * size["height"] - scale * y
