import math

import pytest

from laticauda.trial import compare


def by_name(rows):
    return {row.figure.name: row for row in rows}


def test_differences_are_percent_of_the_first_trial(make_trial):
    rows = by_name(compare([make_trial(), make_trial(speed=0.18), make_trial(duration=2.0)]))
    assert rows["forward_velocity"].values == pytest.approx((0.15, 0.18, 0.15))
    assert rows["forward_velocity"].differences_percent == pytest.approx((0.0, 20.0, 0.0), abs=1e-9)
    assert rows["steady_velocity"].values[2] is None
    assert rows["steady_velocity"].differences_percent[2] is None


def test_a_figure_that_no_trial_has_is_left_out(make_trial):
    assert "electrical_power" not in by_name(compare([make_trial(), make_trial()]))


def test_angles_have_no_difference_in_percent(make_trial):
    rows = by_name(compare([make_trial(direction=0.1), make_trial(direction=0.2)]))
    assert rows["course"].values == pytest.approx((0.1, 0.2))
    assert rows["course"].differences == pytest.approx((0.0, 0.1))
    assert rows["course"].differences_percent == (None, None)


def test_the_difference_of_directions_goes_the_short_way_round(make_trial):
    rows = by_name(compare([make_trial(direction=3.1), make_trial(direction=-3.1)]))
    assert rows["course"].differences[1] == pytest.approx(2.0 * math.pi - 6.2)


@pytest.mark.parametrize("speed", [1e-9, 1e-3])
def test_beside_next_to_nothing_a_difference_has_no_percent(make_trial, speed):
    rows = by_name(compare([make_trial(speed=speed), make_trial()]))
    assert rows["forward_velocity"].differences_percent == (None if speed < 1e-6 else 0.0, None)
    assert rows["forward_velocity"].differences == pytest.approx((0.0, 0.15 - speed))


def test_mechanical_and_electrical_power_are_never_set_against_each_other(make_trial):
    mechanical = make_trial()
    rows = by_name(compare([mechanical, make_trial(electrical_work=90.0 * mechanical.time)]))
    assert not {"mean_power", "cost_of_transport", "joules_per_meter"} & rows.keys()
    assert rows["mechanical_power"].values == pytest.approx((3.0, 3.0))
    assert rows["electrical_power"].differences_percent == (None, None)


def test_one_trial_is_not_enough_to_compare(make_trial):
    with pytest.raises(ValueError, match=r"`trials` must hold at least 2 trials to compare, got 1\."):
        compare([make_trial()])
