"""A slice of campaigns/cockpit_soak.py: a page left open, with somebody busy on it, leaks no memory."""

import campaign_scripts
import pytest

ROOM = 8.0  # for what is not set aside yet, and what the interpreter keeps [MB]


@pytest.fixture(scope="module")
def campaign():
    pytest.importorskip("viser")
    return campaign_scripts.campaign("cockpit_soak")


@pytest.mark.slow
def test_a_page_left_open_leaks_no_memory(campaign):
    found = campaign.soak(0.5, 20.0, every=0.5, browser=False, seed=4, sample=5.0)
    assert len(found.server) == 6
    assert found.server[-1] - found.server[2] < ROOM
