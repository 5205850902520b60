import gc
import os
import sys
import threading

import pytest

from laticauda.protocol.worker import DEVICES, LOOP, Clock, Worker, urgent


class Idle(Worker[int]):
    def __init__(self) -> None:
        super().__init__("idle")
        self._start()

    def work(self) -> None:
        self._ended.wait(0.05)


def allowed() -> bool:
    """Whether this system gives a thread real-time priority."""
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
    except (AttributeError, OSError):
        return False
    os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    return True


def priorities(*threads: threading.Thread) -> list[int]:
    return [os.sched_getparam(thread.native_id).sched_priority for thread in threads]


@pytest.mark.skipif(not allowed(), reason="this system gives no real-time priority")
def test_the_loop_comes_before_its_devices_and_these_before_other_threads():
    other = threading.Thread(target=threading.Event().wait, daemon=True)
    other.start()
    with Idle() as device:
        threads = threading.current_thread(), device._thread, other
        with urgent() as granted:
            assert priorities(*threads) == [LOOP, DEVICES, 0]
        assert priorities(*threads) == [0, 0, 0]
    assert granted.startswith("The loop has real-time priority, and memory that ")


def test_a_system_that_gives_no_priority_is_said_and_no_error(monkeypatch):
    def refused(*_):
        raise PermissionError

    monkeypatch.setattr(os, "sched_setscheduler", refused, raising=False)
    with urgent() as granted:
        pass
    assert granted.startswith("The loop has the priority of any program, for the system allows no other, and memory")


def test_within_a_loop_no_garbage_is_collected_and_afterwards_all_is_as_before():
    before = gc.isenabled(), sys.getswitchinterval()
    with Clock().undisturbed() as granted:
        assert not gc.isenabled()
        assert gc.get_freeze_count() > 0
    assert (gc.isenabled(), sys.getswitchinterval(), gc.get_freeze_count()) == (*before, 0)
    assert granted
