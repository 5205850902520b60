"""What the loop adds to a tick; whole operations are in test_session.py."""

import pytest

from laticauda.tank.operate.loop import SWITCHES_ON_WITHIN, without_late_enabling
from laticauda.tank.operate.procedure.state import Outputs
from laticauda.tank.operate.recording.entries import Event
from laticauda.tank.operate.safety.supervisor import HOLD_AFTER, LIMP_FROM
from laticauda.tank.protocol import NodeCommand, Order, Sync

ENABLE = NodeCommand(order=Order.ENABLE)
DISABLE = NodeCommand(order=Order.DISABLE)
SYNC = Sync(counter=1)


def test_an_order_to_switch_on_is_not_sent_by_a_tick_that_took_too_long_and_that_is_recorded():
    outputs = Outputs(messages=(ENABLE, SYNC), entries=(Event(time=5.0, kind="loop", message="b"),))
    late = without_late_enabling(outputs, 5.0, 6.5)
    assert late.messages == (SYNC,)
    assert [event.message for event in late.events] == ["b", "not switched on: the tick took 1.5 s"]
    assert late.events[-1].time == 6.5


@pytest.mark.parametrize("messages", [(ENABLE, SYNC), (DISABLE, SYNC), ()])
def test_everything_else_is_sent_as_it_is(messages):
    outputs = Outputs(messages=messages)
    assert without_late_enabling(outputs, 0.0, SWITCHES_ON_WITHIN) is outputs
    if ENABLE not in messages:
        assert without_late_enabling(outputs, 0.0, 9.0) is outputs


def test_the_last_order_to_switch_on_reaches_a_module_before_it_may_be_limp():
    from laticauda.tank.lab import NodeSettings

    assert LIMP_FROM + SWITCHES_ON_WITHIN < NodeSettings().limp_after
    assert SWITCHES_ON_WITHIN < HOLD_AFTER
