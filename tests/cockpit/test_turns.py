"""Turns: what pages ask for is done in the order in which it came, and with the value that it had then."""

import asyncio
import threading
from types import SimpleNamespace

import pytest

from laticauda.cockpit.turns import Turns


@pytest.fixture
def turns():
    made = Turns()
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


def test_every_value_is_done_in_its_order_and_the_pages_are_brought_up_to_date_once(turns):
    done, after, all_there = [], [], threading.Event()

    def act(asked):
        all_there.wait(10.0)
        done.append(asked.value)

    come(turns.hear(act, then=lambda: after.append(len(done))), *range(10))
    all_there.set()
    turns.close()
    assert done == list(range(10))
    assert after == [10]


def test_what_the_program_sets_itself_is_no_turn(turns):
    done = []
    come(turns.hear(done.append), 1, 2, client=None)
    turns.close()
    assert done == []


def test_a_fault_is_logged_and_the_next_turn_is_taken(turns, caplog):
    done = []

    def act(asked):
        if asked.value == 1:
            raise RuntimeError("one")
        done.append(asked.value)

    come(turns.hear(act), 1, 2)
    turns.close()
    assert done == [2]
    assert "A control of the cockpit failed." in caplog.text
