"""A slice of campaigns/torque_returns.py in the stepped tank, and the stored answer of its real processes."""

import pytest
from campaign_scripts import campaign

from laticauda.tank.protocol import NodeState

torque = campaign("torque_returns")
SEEDS = (2, 3, 4, 5, 8, 11, 12, 13)


def test_the_slice_has_every_kind_of_mishap_with_limits_that_notice_it_and_with_others():
    mishaps = [torque.drawn(seed) for seed in SEEDS]
    assert {mishap.kind for mishap in mishaps} == set(torque.KINDS)
    assert {mishap.is_patient for mishap in mishaps} == {True, False}
    assert len({torque.drawn(seed) for seed in SEEDS}) == len(SEEDS)


@pytest.mark.parametrize("seed", SEEDS)
def test_no_motor_comes_on_again_that_went_off_whatever_happens_in_a_run(seed):
    monitor, state, events = torque.stepped(torque.drawn(seed))
    assert monitor.first_on is not None
    assert monitor.returned == []
    assert monitor.n_orders_after_limp == 0
    assert monitor.on == set()
    assert state.is_done
    told = [event.message for event in events if event.kind == "torque"]
    assert sum("enable" in message.split()[-1] or "again" in message for message in told) == (
        monitor.n_orders
    )


def test_the_monitor_sees_an_order_after_a_motor_went_off_and_a_motor_that_returns():
    monitor = torque.Monitor()
    monitor.order()
    for now, state in ((0.0, NodeState.ACTIVE), (0.3, NodeState.HOLD), (1.1, NodeState.LIMP)):
        monitor.module(now, 3, is_on=state.is_on)
    assert (monitor.n_orders, monitor.n_orders_after_limp, monitor.returned) == (1, 0, [])
    monitor.order()
    monitor.module(1.2, 3, is_on=True)
    assert (monitor.n_orders, monitor.n_orders_after_limp) == (2, 1)
    assert monitor.returned == [(1.2, 3)]


def test_in_the_stored_runs_of_real_processes_torque_never_returned_and_nothing_was_lost():
    rows = torque.stored()
    kinds = [row["kind"] for row in rows]
    assert kinds.count("freeze") >= 20
    assert kinds.count("cable") >= 10
    for row in rows:
        assert row["returned"] == row["orders_after_limp"] == "0"
        assert (row["recording"], row["replay"]) == ("complete", "shows it")
        assert row["verdict"] in ("there", "no run")
    assert sum(row["verdict"] == "there" for row in rows) >= 15


def test_no_stored_run_counts_of_which_nobody_heard_the_robot_for_more_than_half_a_second():
    cut = [
        row
        for row in torque.stored()
        if row["since"] == "run"
        and float(row["duration"]) > 0.6
        and float(row["moment"]) + 0.6 < torque.DURATION
    ]
    assert len(cut) > 15
    assert all(row["status"] == "1" for row in cut)
