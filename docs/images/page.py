"""Pictures of the cockpit's page in headless Chromium, for `make.py`; it needs playwright and a `chromium`."""

import contextlib
import shutil
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from playwright.sync_api import sync_playwright

import laticauda as lc
from laticauda.show.cockpit import Cockpit, Live

SIZE = {"width": 1600, "height": 900}
# Without a graphics card.
FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)
PATIENCE = 300_000.0  # a slow computer draws some pictures in a minute [ms]
STEP = 0.05  # between two pictures that the page is told of [s]
# A page in a browser without a graphics card says so.
NO_NOTES = ".mantine-Notifications-root { display: none !important; }"


class Camera:
    """A cockpit whose time goes on only when it is told to, and a page that shows it."""

    def __init__(self, cockpit: Cockpit, page: Any) -> None:
        self.cockpit, self.page = cockpit, page

    def pass_time(self, duration: float) -> None:
        """Let the robot swim [s]."""
        for _ in range(round(duration / STEP)):
            self.cockpit.live.advance(STEP)
            self.cockpit.frame()

    def swim(self, scenario: lc.Scenario, duration: float) -> None:
        """Let a robot swim from rest [s]."""
        self.cockpit.live.change(scenario)
        self.cockpit._show_scenario()
        self.cockpit._reset()
        self.pass_time(duration)

    def open(self, tab: str) -> None:
        """Open a tab of the panel."""
        self.page.get_by_role("tab", name=tab).click()

    def look(self, offset: tuple[float, float, float], ahead: float) -> None:
        """Put the camera beside the robot; `ahead` of it is the middle of the picture [m]."""
        (view,) = self.cockpit._cameras.all()
        view.follows.value = False
        x, y = (float(value) for value in self.cockpit.live.latest().center_of_mass[:2])
        target = np.array([x + ahead, y, 0.0])
        self.settle()
        view.camera.position, view.camera.look_at = target + offset, target
        self.settle()

    def settle(self, rounds: int = 24) -> None:
        """Give the page time to draw what it is told."""
        for _ in range(rounds):
            self.cockpit.frame()
            time.sleep(0.25)

    def shoot(self, path: Path) -> None:
        """Write what is seen to a file."""
        self.page.screenshot(path=path)
        Image.open(path).convert("RGB").save(path, optimize=True)


@contextlib.contextmanager
def camera(scenario: lc.Scenario) -> Iterator[Camera]:
    """A cockpit and its page, as long as the block lasts.

    Args:
        scenario: What swims how.
    """
    cockpit = Cockpit(Live(scenario), port=0)
    try:
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(
                executable_path=shutil.which("chromium"), args=list(FLAGS)
            )
            page = browser.new_page(viewport=SIZE)  # pyright: ignore[reportArgumentType]
            page.set_default_timeout(PATIENCE)
            page.goto(cockpit.address)
            page.wait_for_selector("text=frequency")
            page.add_style_tag(content=NO_NOTES)
            yield Camera(cockpit, page)
            browser.close()
    finally:
        cockpit.close()
