"""Angles of joints in tables: whole turns are taken out, and nothing else."""

import math

import numpy as np
import pytest

from laticauda.values.tables import check_jumps, check_unit, mend_turns

TIME = 0.05 * np.arange(100)
SWING = 0.5 * np.sin(3.0 * TIME)
TURNS = {
    "one turn up": (TIME > 2.0) * 1.0,
    "one turn down": (TIME > 2.0) * -1.0,
    "two turns at once": (TIME > 2.0) * 2.0,
    "up and down again": ((TIME > 1.0) & (TIME < 3.0)) * 1.0,
    "ever more": np.floor(TIME),
    "one sample": (TIME == TIME[40]) * 1.0,
    "the first sample": (TIME == 0.0) * -1.0,
    "the last sample": (TIME == TIME[-1]) * 3.0,
    "every other sample": np.arange(100) % 2.0,
    "turned from the beginning, then back": (TIME < 1.0) * 5.0,
}


@pytest.mark.parametrize("name", TURNS)
def test_whole_turns_are_taken_out(name):
    mended = mend_turns(SWING + math.tau * TURNS[name])
    np.testing.assert_allclose(mended.radians, SWING, atol=1e-12)
    assert mended.n_turns > 0


def test_gaps_are_kept_and_what_does_not_turn_is_left_alone():
    swing = SWING.copy()
    swing[10:13] = np.nan
    mended = mend_turns(swing)
    np.testing.assert_array_equal(mended.radians, swing)
    assert mended.n_turns == 0


@pytest.mark.parametrize("jump", [0.8, 2.0, 3.0, 4.0, -1.5])
def test_a_jump_of_less_than_a_turn_is_refused_with_its_row(jump):
    time = 0.01 * np.arange(100)
    jumped = 0.3 * np.sin(3.0 * time)
    jumped[50:] += jump
    mended = mend_turns(jumped)
    assert mended.n_turns == 0
    with pytest.raises(ValueError, match=r"`a` jumps by .* from 0.49 s to 0.5 s, in row 52: no"):
        check_jumps("a", time, mended.radians, range(2, 102))


def test_resting_joints_are_in_any_unit():
    check_unit("a", np.zeros(5), "deg")
    check_unit("a", np.array([math.nan]), "rad")
