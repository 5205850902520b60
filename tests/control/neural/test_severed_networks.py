"""A robot with a severed cord swims only by what it feels: the stored networks, and all of them again."""

import numpy as np
import pytest
from campaign_scripts import campaign

severed_networks = campaign("severed_networks")
COLUMNS = ("intact", "severed", "severed_with_feedback")


def test_with_feedback_severed_networks_swim_at_half_the_intact_speed_or_faster():
    networks = severed_networks.read_table()
    shares = severed_networks.shares_of(networks, "severed_with_feedback")
    assert len(networks) == 20
    assert np.sum(shares > 0.5) == 19


def test_without_feedback_severed_networks_hardly_swim():
    shares = severed_networks.shares_of(severed_networks.read_table(), "severed")
    assert np.median(shares) < 0.1
    assert np.sum(shares < 0.1) == 13


def test_the_stored_networks_swim_the_same_again():
    networks = severed_networks.run(severed_networks.SEEDS)
    for network, stored in zip(networks, severed_networks.read_table(), strict=True):
        for column in COLUMNS:
            speed = getattr(network, column)
            assert speed == pytest.approx(getattr(stored, column), abs=2e-4), (network, column)
