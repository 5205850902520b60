"""Tests of things that live by the clock on the wall wait for what is to come, and do not sleep and hope."""

import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from laticauda.tank.operate.drivers import contract

LONG = 120.0
"""Time in which anything that is going to end ends [s], also on a computer that is busy with other tests."""


@contextmanager
def running(words: Sequence[object], **how) -> Iterator["subprocess.Popen[str]"]:
    """A program that is killed at the end of the block if it still runs: a test that fails does not wait for it."""
    with subprocess.Popen([str(word) for word in words], text=True, **how) as program:
        try:
            yield program
        finally:
            program.kill()


def until(holds: Callable[[], object], patience: float = 20.0) -> None:
    """Wait until something holds; a test fails if it does not within some time [s]."""
    end = time.monotonic() + patience
    while not holds():
        assert time.monotonic() < end, f"not within {patience:g} s"
        time.sleep(0.005)


def complaints(monkeypatch, *args, tries: int = 3, **how) -> Sequence[str]:
    """What a driver does not keep to, each time, of the contract on a computer that is busy with other tests."""
    for name, patient in {
        "LONGEST_CALL": 0.5,
        "FEWEST_ANSWERS": 2.0,
        "FEWEST_BEATS": 0.5,
        "LIMP_TIME": 4.0,
    }.items():
        monkeypatch.setattr(contract, name, patient)
    found: Sequence[str] = ()
    for _ in range(tries):
        if not (found := contract.list_broken_rules(*args, **how)):
            break
    return found
