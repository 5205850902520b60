"""A robot with a severed cord swims only by what it feels: the stored networks, and one of them again."""

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


def test_a_stored_network_swims_the_same_again():
    stored = severed_networks.read_table()[1]
    network = severed_networks.run(1)
    for column in COLUMNS:
        assert getattr(network, column) == pytest.approx(getattr(stored, column), abs=2e-4), column
