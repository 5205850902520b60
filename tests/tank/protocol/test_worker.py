import gc
import os
import sys
import threading

import pytest
from patience import until

from laticauda.tank.protocol.clock import DEVICE_PRIORITY, LOOP_PRIORITY, Clock, urgent
from laticauda.tank.protocol.worker import MOST_WAITING_ITEMS, Worker, hardware
from laticauda.values.errors import LaticaudaError, MissingExtra


class Idle(Worker[int]):
    def __init__(self) -> None:
        super().__init__("idle")
        self._start()

    def work(self) -> None:
        self._ended.wait(0.05)


class Counting(Worker[int]):
    """Finds 0, 1, 2 and so on; as long as it has a `fault`, that happens instead."""

    def __init__(self, fault: Exception | None = None) -> None:
        super().__init__("counting")
        self.fault, self.n, self.n_released = fault, 0, 0
        self._start()

    def work(self) -> None:
        if (fault := self.fault) is not None:
            raise fault
        self._received.append(self.n)
        self.n += 1
        self._ended.wait(0.001)

    def release(self) -> None:
        self.n_released += 1


def test_what_is_found_is_received_once_in_its_order_and_the_device_is_given_back_once():
    with Counting() as worker:
        until(lambda: worker.n > 5)
        first = worker.receive()
        until(lambda: worker.n > len(first) + 2)
        second = worker.receive()
    worker.close()
    assert worker.n_released == 1 and not worker._thread.is_alive()
    assert (*first, *second) == tuple(range(len(first) + len(second)))
    assert worker._received.maxlen == MOST_WAITING_ITEMS


@pytest.mark.parametrize(
    ("fault", "says"),
    [
        (LaticaudaError("The cable is out."), "The cable is out."),
        (ValueError("it is 3"), "ValueError: it is 3"),
        (ZeroDivisionError(), "ZeroDivisionError"),
    ],
)
def test_an_error_becomes_a_sentence_and_the_thread_tries_again(monkeypatch, fault, says):
    monkeypatch.setattr("laticauda.tank.protocol.worker.RETRY_DELAY", 0.05)
    with Counting(fault) as worker:
        until(lambda: worker.trouble)
        assert worker.trouble == says and worker.n == 0
        worker.fault = None
        until(lambda: worker.n > 0 and not worker.trouble)


def test_a_worker_without_work_says_so_and_one_that_never_began_is_closed():
    idle = Worker("nothing")
    with pytest.raises(NotImplementedError):
        idle.work()
    idle.close()
    assert idle.trouble == "" and idle.receive() == ()


def test_a_library_that_is_not_installed_is_named_with_its_extra():
    with pytest.raises(
        MissingExtra,
        match=r"Operating a robot needs nosuch; run `pip install .*\[hardware\]\"`",
    ):
        hardware("nosuch", "nosuch_module")
    assert hardware("msgpack", "msgpack").packb(1) == b"\x01"


def test_a_clock_goes_at_its_speed_and_waits_for_what_is_to_come_only():
    clock = Clock(speed=50.0)
    clock.wait_until(-1.0)
    begin = clock.now()
    clock.wait_until(begin + 1.0)
    assert clock.now() >= begin + 1.0
    with pytest.raises(ValueError, match=r"`speed` must be > 0, got 0"):
        Clock(speed=0.0)


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


def cores(*threads: threading.Thread) -> list[set[int]]:
    return [os.sched_getaffinity(thread.native_id) for thread in threads]


@pytest.mark.skipif(not allowed(), reason="this system gives no real-time priority")
def test_the_loop_comes_before_its_devices_with_which_it_shares_a_core_and_these_before_other_threads():
    other = threading.Thread(target=threading.Event().wait, daemon=True)
    other.start()
    with Idle() as device:
        threads = threading.current_thread(), device._thread, other
        before = cores(*threads)
        with urgent() as granted:
            assert priorities(*threads) == [LOOP_PRIORITY, DEVICE_PRIORITY, 0]
            (loop,), (devices,), others = cores(*threads)
            assert loop == devices
            assert others == before[2]
        assert priorities(*threads) == [0, 0, 0]
        assert cores(*threads) == before
    assert granted.startswith("The loop has real-time priority, and memory that ")


def test_a_system_that_gives_no_priority_is_said_and_no_error(monkeypatch):
    def refused(*_):
        raise PermissionError

    monkeypatch.setattr(os, "sched_setscheduler", refused, raising=False)
    with urgent() as granted:
        pass
    assert granted.startswith(
        "The loop has normal priority, as the system allows no other, and memory"
    )


def test_within_a_loop_no_garbage_is_collected_and_afterwards_all_is_as_before():
    before = gc.isenabled(), sys.getswitchinterval()
    with Clock().undisturbed() as granted:
        assert not gc.isenabled()
        assert gc.get_freeze_count() > 0
    assert (gc.isenabled(), sys.getswitchinterval(), gc.get_freeze_count()) == (*before, 0)
    assert granted


def test_a_program_that_collects_no_garbage_is_left_so():
    gc.disable()
    try:
        with Clock().undisturbed():
            assert not gc.isenabled()
        assert not gc.isenabled()
    finally:
        gc.enable()


def test_memory_that_cannot_be_kept_in_place_is_said(monkeypatch):
    class Library:
        def mlockall(self, flags: int) -> int:
            return -1

    monkeypatch.setattr("ctypes.CDLL", lambda name: Library())
    with urgent() as granted:
        pass
    assert granted.endswith("and memory that may be swapped out.")


def test_a_system_without_a_way_to_keep_memory_in_place_is_said_too(monkeypatch):
    def refuse_to_load(name: None) -> None:
        raise OSError("no such library")

    monkeypatch.setattr("ctypes.CDLL", refuse_to_load)
    with urgent() as granted:
        pass
    assert granted.endswith("and memory that may be swapped out.")


def test_a_driver_written_before_may_use_the_former_name_of_what_it_received():
    worker = Idle()
    with pytest.warns(DeprecationWarning, match="_received"):
        worker._found.append(1)
    assert worker.receive() == (1,)
