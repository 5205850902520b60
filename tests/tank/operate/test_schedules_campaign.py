"""A slice of campaigns/lab_schedules.py, and what its stored answer says."""

import campaign_scripts
import pytest

schedules = campaign_scripts.campaign("lab_schedules")


def test_no_schedule_was_unsafe_wrongly_accepted_lost_or_stuck():
    kept = schedules.stored()
    assert kept["violations"] == 0
    assert kept["schedules"] == kept["next_seed"] >= 20
    assert set(kept["tried"]) <= set(schedules.KINDS)


@pytest.mark.parametrize("seed", [3, 20])
def test_whatever_goes_wrong_an_operation_is_safe_and_its_record_whole(seed: int):
    assert schedules.run(seed).wrong == []


def test_a_run_whose_cameras_clock_stepped_back_is_right_or_not_accepted():
    assert schedules.run(100).wrong == []


def test_the_same_seed_gives_the_same_bits():
    seed = 10  # four mishaps in a short operation
    one, again, other = schedules.run(seed), schedules.run(seed), schedules.run(seed, ())
    assert one == again
    assert one.digest != other.digest


def test_a_schedule_at_fault_is_cut_down_to_what_it_takes_and_says_how_to_repeat_it(
    monkeypatch: pytest.MonkeyPatch,
):
    key = schedules.Mishap(kind="operator_key", time=4.4, duration=0.05)
    monkeypatch.setattr(schedules, "REACTION", -9.0)  # no stop is soon enough
    found = schedules.run(3, (schedules.Mishap(kind="meter_silent", time=4.0, duration=0.05), key))
    assert [one.split(":")[0] for one in found.wrong] == ["unsafe"]
    least = schedules.shrunk(found)
    assert least.mishaps == (key,)
    assert least.line.startswith(
        'python campaigns/lab_schedules.py --seed 3 --mishaps \'[{"kind": "operator_key"'
    )
