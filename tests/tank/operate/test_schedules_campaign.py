"""A slice of campaigns/lab_schedules.py, and what its stored answer says."""

import campaign_scripts
import pytest

schedules = campaign_scripts.campaign("lab_schedules")


def test_no_schedule_was_unsafe_wrongly_accepted_lost_or_stuck():
    totals = schedules.stored()
    assert totals["violations"] == 0
    assert totals["schedules"] == totals["next_seed"] >= 20
    assert set(totals["tried"]) <= set(schedules.KINDS)


@pytest.mark.parametrize("seed", [3, 20])
def test_whatever_goes_wrong_an_operation_is_safe_and_its_record_whole(seed: int):
    assert schedules.run(seed).wrong == []


def test_a_run_whose_cameras_clock_stepped_back_is_right_or_not_accepted():
    assert schedules.run(100).wrong == []


def test_the_same_seed_gives_the_same_bits():
    seed = 10  # four mishaps in a short operation
    outcome, again = schedules.run(seed), schedules.run(seed)
    without_mishaps = schedules.run(seed, ())
    assert outcome == again
    assert outcome.digest != without_mishaps.digest


def test_a_schedule_at_fault_is_cut_down_to_what_it_takes_and_says_how_to_repeat_it(
    monkeypatch: pytest.MonkeyPatch,
):
    key = schedules.Mishap(kind="operator_key", time=4.4, duration=0.05)
    monkeypatch.setattr(schedules, "REACTION", -9.0)  # no stop is soon enough
    silence = schedules.Mishap(kind="meter_silent", time=4.0, duration=0.05)
    outcome = schedules.run(3, (silence, key))
    assert outcome.faults == {"unsafe"}
    assert len(outcome.wrong) == 1
    least = schedules.shrink(outcome)
    assert least.mishaps == (key,)
    assert least.line.startswith(
        'python campaigns/lab_schedules.py --seed 3 --mishaps \'[{"kind": "operator_key"'
    )
