"""The front page of the built site is one screen."""

import pytest
from cockpit_browser import browser
from site_search import SITE

SCREENS = ((1280, 800), (1440, 900), (1920, 1080))
"""Width and height of common screens [px]."""
BOTTOM = "document.querySelector('.compact').getBoundingClientRect().bottom"
TOP = "document.querySelector('.front').getBoundingClientRect().top"


@pytest.mark.skipif(
    not (SITE / "index.html").exists(), reason="the site is not built: run `make docs`"
)
def test_the_front_page_fits_one_screen():
    with browser() as started:
        for width, height in SCREENS:
            page = started.new_page(viewport={"width": width, "height": height})
            page.goto((SITE / "index.html").as_uri())
            page.wait_for_selector(".front img")
            assert 0.0 < page.evaluate(TOP) < page.evaluate(BOTTOM) <= height
            page.close()
