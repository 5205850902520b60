"""A newcomer who types a word into the search of the site finds a guide among the first three."""

import pytest
from site_search import SITE, search

GUIDES = {
    "units": "conventions/",
    "speed": "how-to/identify/",
    "turn": "how-to/swim/",
    "film": "how-to/spatial/",
    "jupyter": "notebooks/first-swim/",
    "FARMS": "",  # the front page
    "compare": "how-to/identify/",
    "noise": "how-to/identify/#noise",
    "interval": "tutorials/first-hour/",
    "swim": "how-to/swim/",
    "fin": "how-to/elastic-fin/",
    "current": "how-to/follow-a-path/",
    "power": "how-to/what-to-build/",
    "servo": "how-to/my-robot/",
    "identify": "how-to/identify/",
    "robot file": "how-to/my-robot/",
    "plot": "how-to/plot/",
    "gait": "tutorials/first-hour/",
    "path": "how-to/",
    "install": "install/",
}
"""The page that each word has to lead to."""
N_LOOKED_AT = 3


def leads_to(page: str, location: str) -> bool:
    if page == "":
        return location.partition("#")[0] == page
    return location.startswith(page)


@pytest.mark.skipif(
    not (SITE / "search.json").exists(), reason="the site is not built: run `make docs`"
)
def test_a_word_leads_to_its_guide():
    found = search(GUIDES)
    missed = {
        word: [hit.location for hit in found[word][:N_LOOKED_AT]]
        for word, page in GUIDES.items()
        if not any(leads_to(page, hit.location) for hit in found[word][:N_LOOKED_AT])
    }
    assert missed == {}
