"""The search of campaigns/supervisor_states.py, with one event at a time, and its stored answer."""

import pytest
from campaign_scripts import campaign

from laticauda.tank.operate.safety import supervisor

states = campaign("supervisor_states")


@pytest.fixture(scope="module")
def answer():
    return states.search(1)


def test_in_no_reachable_state_does_any_event_break_a_law_of_the_supervisor(answer):
    assert answer.violations == []
    assert {place.state for place in answer.places} == set(supervisor.STATES)


def test_the_table_of_torque_lists_what_is_reached_and_nothing_else(answer):
    assert {(place.state, place.action) for place in answer.places} == supervisor.TORQUE.keys()


def test_the_stored_answer_is_of_this_supervisor_and_has_no_violation(answer):
    rows = {int(row["events"]): row for row in states.stored()}
    assert set(rows) == {1, 2}
    assert all(int(row["violations"]) == 0 for row in rows.values())
    found = len(answer.places), answer.n_steps
    assert found == (int(rows[1]["states"]), int(rows[1]["steps"]))


def test_every_threshold_of_the_supervisor_is_told_apart_by_the_ages_of_the_search():
    thresholds = {
        supervisor.CONFIRM_TIME,
        supervisor.LIMP_FROM,
        supervisor.LIMP_AFTER,
        states.OLDEST,
    }
    ages = [states.GRID * k for k in range(11)]
    for low, high in zip(sorted(thresholds), sorted(thresholds)[1:], strict=False):
        assert any(low <= age < high - 1e-9 for age in ages)


def test_motors_that_are_switched_on_while_the_robot_straightens_are_found(monkeypatch):
    monkeypatch.setitem(supervisor.TORQUE, ("stopping", "straighten"), "enable")
    found = {violation.split(":")[0] for violation in states.search(1, most=1).violations}
    assert "a motor is switched on outside `ready`" in found
