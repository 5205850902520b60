"""The stored answer of campaigns/wake.py: what the docs say of it."""

from pathlib import Path

import numpy as np
import pytest
from campaign_scripts import campaign

wake = campaign("wake")
PAGE = Path(__file__).parent.parent / "docs/theory/moving-water.md"


def rows_beside(beside):
    return [row for row in wake.read_table() if row.beside == beside]


def test_the_table_of_the_page_is_that_of_the_stored_answer():
    assert wake.tabulate(wake.read_table()) in PAGE.read_text(encoding="utf-8")


def test_every_place_and_phase_was_swum_once():
    swum = [(row.beside, row.gap, row.leader_phase) for row in wake.read_table()]
    assert np.array(swum) == pytest.approx(np.array(list(wake.places())))


def test_in_line_the_phase_of_lowest_power_turns_once_in_the_spacing_of_the_vortices():
    fit = wake.fit_wave(rows_beside(0.0), "power")
    assert 2.0 * np.pi / fit.wave_number == pytest.approx(0.316, rel=0.01)
    assert fit.explained > 0.95


def test_a_meter_costs_least_where_the_tail_moves_with_the_water_of_the_vortices():
    fit = wake.fit_wave(rows_beside(0.0), "cost", 2.0 * np.pi / 0.316)
    cheapest = np.degrees(fit.best + np.pi)
    assert abs(cheapest) < 25.0
