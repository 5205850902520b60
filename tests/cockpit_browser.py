"""A page in headless Chromium, for tests; skips where there is none."""

import contextlib
import os
import shutil
from pathlib import Path

import pytest

# Software rendering: some two pictures a second.
FLAGS = ("--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
SIZE = {"width": 800, "height": 500}
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


@contextlib.contextmanager
def browser():
    sync = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("Chromium is not installed")
    with sync.sync_playwright() as playwright:
        found = playwright.chromium.launch(executable_path=CHROMIUM, args=list(FLAGS))
        try:
            yield found
        finally:
            found.close()


def open_page(found, address):
    page = found.new_page(viewport=SIZE)
    page.set_default_timeout(15_000)
    page.goto(address)
    page.wait_for_selector("text=amplitude [°]", timeout=60_000)
    return page


def shots(tmp_path):
    """Where screenshots are kept: where `LATICAUDA_SHOTS` says, or with pytest's other files."""
    folder = Path(os.environ.get("LATICAUDA_SHOTS", tmp_path))
    folder.mkdir(parents=True, exist_ok=True)
    return folder
