import math
from dataclasses import replace

import pytest

from laticauda.paper import (
    load_efficiency_settings,
    load_path_following_settings,
    read_path_following_trials,
)

SETTINGS = load_path_following_settings()


def test_the_groups_hold_every_row_of_table_2_in_its_order():
    assert [row for group in SETTINGS.groups for row in group.path_following_cases] == list(
        read_path_following_trials()
    )
    assert SETTINGS.n_cases == 12


def test_every_figure_from_12_to_23_has_one_place():
    assert [number for group in SETTINGS.groups for number in group.figures] == list(range(12, 24))


def test_the_groups_are_named_and_made_as_those_of_the_efficiency_study():
    same = [(group.name, group.robot, group.has_fin) for group in load_efficiency_settings().groups]
    assert [(group.name, group.robot, group.has_fin) for group in SETTINGS.groups] == same
    assert SETTINGS.coefficients == load_efficiency_settings().models[0]


def test_the_gains_are_the_papers():
    assert (SETTINGS.following.look_ahead_distance, SETTINGS.following.gain) == (0.18, 0.4)
    assert SETTINGS.following.max_offset == pytest.approx(math.radians(20))
    assert SETTINGS.following.interval == 0.05


def test_the_chosen_way_is_in_the_band_and_not_run_twice():
    assert SETTINGS.band("pd", 4.0) == SETTINGS.band("servo", 10)
    assert len(SETTINGS.band("pd", 4.0)) == 6
    assert SETTINGS.band("pd", 6.0)[0] == ("pd", 6.0)
    assert len(SETTINGS.band("pd", 6.0)) == 7
    assert SETTINGS.n_runs("pd", 4.0) == 12 * 7 + 4 + 1 + 2 * (12 * 2 + 4 + 1)
    assert SETTINGS.n_runs("pd", 6.0) == 12 * 8 + 4 + 1 + 2 * (12 * 2 + 4 + 1)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"duration": 14.0}, "`duration` must be between 15 and 100000 s, got 14.0"),
        ({"distance": 0.0}, "`distance` must be > 0 m, got 0.0"),
        ({"following": None}, "`following` must be"),
        ({"groups": ()}, "`groups` must hold at least one entry, got none"),
        ({"joint_laws": ()}, "`joint_laws` must hold at least one entry, got none"),
        (
            {"groups": (replace(SETTINGS.groups[1], figures=(15, 16, 17, 18)),)},
            "`figures` must be at most as many as Table 2 has cases of lateral undulation, with fin, 3, got 4",
        ),
    ],
)
def test_settings_that_make_no_sense_are_refused(change, message):
    with pytest.raises(ValueError, match=message):
        replace(SETTINGS, **change)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"look_ahead_distance": 0.0}, "`look_ahead_distance` must be > 0 m, got 0.0"),
        ({"gain": math.nan}, "`gain` must be a finite number, got nan"),
        ({"max_offset": -0.1}, "`max_offset` must be > 0 rad, got -0.1"),
        ({"interval": 0.0}, "`interval` must be >= 0.0001 s, got 0.0"),
    ],
)
def test_steering_that_makes_no_sense_is_refused(change, message):
    with pytest.raises(ValueError, match=message):
        replace(SETTINGS.following, **change)
