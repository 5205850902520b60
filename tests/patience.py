"""Tests of things that live by the clock on the wall wait for what is to come, and do not sleep and hope."""

import time
from collections.abc import Callable, Sequence

from laticauda.operate.drivers import contract


def until(holds: Callable[[], object], patience: float = 20.0) -> None:
    """Wait until something holds; a test fails if it does not within some time [s]."""
    end = time.monotonic() + patience
    while not holds():
        assert time.monotonic() < end, f"not within {patience:g} s"
        time.sleep(0.005)


def complaints(monkeypatch, *args, tries: int = 3, **how) -> Sequence[str]:
    """What a driver does not keep to, each time, of the contract on a computer that is busy with other tests."""
    for name, patient in {"LONGEST": 0.5, "LEAST_ANSWERS": 2.0, "LEAST_BEATS": 0.5, "OBEYS_WITHIN": 15.0}.items():
        monkeypatch.setattr(contract, name, patient)
    found: Sequence[str] = ()
    for _ in range(tries):
        if not (found := contract.broken(*args, **how)):
            break
    return found
