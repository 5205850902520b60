"""Events of pages are answered in the order in which they came, and with the value that they had then."""

import asyncio
import threading
from types import SimpleNamespace

import pytest

from laticauda.show.cockpit.events import MOST_WAITING, EventQueue


@pytest.fixture
def events():
    made = EventQueue()
    yield made
    made.close()


def come(heard, *values, client="a page"):
    """As the page's server does it: the control is further on when its event is answered."""
    control = SimpleNamespace(value=None)

    async def all_of_them():
        for value in values:
            control.value = value
            await heard(SimpleNamespace(client=client, target=control))

    asyncio.run(all_of_them())


def test_every_value_is_done_in_its_order_and_the_pages_are_brought_up_to_date_once(events):
    done, after, all_there = [], [], threading.Event()

    def act(event):
        all_there.wait(10.0)
        done.append(event.value)

    come(events.handler(act, then=lambda: after.append(len(done))), *range(10))
    all_there.set()
    events.close()
    assert done == list(range(10))
    assert after == [10]


def test_what_the_program_sets_itself_is_no_event(events):
    done = []
    come(events.handler(done.append), 1, 2, client=None)
    events.close()
    assert done == []


def test_a_fault_is_logged_and_the_next_event_is_answered(events, caplog):
    done = []

    def act(event):
        if event.value == 1:
            raise RuntimeError("one")
        done.append(event.value)

    come(events.handler(act), 1, 2)
    events.close()
    assert done == [2]
    assert "A control of the cockpit failed: RuntimeError('one')" in caplog.text


def test_a_page_that_sends_more_than_can_be_answered_does_not_fill_the_memory(events):
    done, all_there = [], threading.Event()

    def act(event):
        all_there.wait(10.0)
        done.append(event.value)

    come(events.handler(act), *range(3 * MOST_WAITING))
    all_there.set()
    events.close()
    assert done[:MOST_WAITING] == list(range(MOST_WAITING))
    assert len(done) <= MOST_WAITING + 1
