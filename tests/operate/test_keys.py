import io
import os
import sys
import time

import pytest

from laticauda.operate.keys import EMERGENCY, STOP, Keys, Terminal

termios = pytest.importorskip("termios", reason="terminals are of Unix")


@pytest.fixture
def terminal():
    """The two ends of a pseudo-terminal: what a person types into, and what a program reads."""
    import pty

    person, program = pty.openpty()
    with os.fdopen(program) as stream:
        yield person, stream
    os.close(person)


def until(keys: Keys, event: str) -> None:
    end = time.monotonic() + 5.0
    while event not in keys.events and time.monotonic() < end:
        time.sleep(0.01)


@pytest.mark.parametrize(("key", "says"), [(b" ", "by space"), (b"q", "by q")])
def test_a_single_key_stops_and_the_second_is_the_emergency_stop(terminal, key: bytes, says: str):
    person, stream = terminal
    keys = Keys()
    with Terminal(keys, stream):
        os.write(person, b"xyz" + key)
        until(keys, STOP)
        assert keys.events == {STOP: says}
        os.write(person, key)
        until(keys, EMERGENCY)
        assert keys.events == {STOP: says, EMERGENCY: says}


def test_the_terminal_is_as_it_was_afterwards_also_after_an_error(terminal):
    _, stream = terminal
    before = termios.tcgetattr(stream)
    with pytest.raises(RuntimeError), Terminal(Keys(), stream):
        assert not termios.tcgetattr(stream)[3] & (termios.ICANON | termios.ECHO)
        assert termios.tcgetattr(stream)[3] & termios.ISIG  # Ctrl-C stays a signal
        raise RuntimeError
    assert termios.tcgetattr(stream) == before


def test_a_terminal_that_is_closed_by_the_person_ends_nothing():
    import pty

    person, program = pty.openpty()
    keys = Keys()
    with os.fdopen(program) as stream, Terminal(keys, stream):
        os.close(person)
        time.sleep(0.05)
    assert keys.events == {}


def test_without_a_terminal_there_are_no_keys_and_no_error(tmp_path, monkeypatch):
    file = tmp_path / "in"
    file.write_text("q")
    with file.open() as stream, Terminal(keys := Keys(), stream):
        time.sleep(0.05)
    with Terminal(keys, io.StringIO("q")):
        time.sleep(0.05)
    monkeypatch.setattr(sys, "stdin", None)
    with Terminal(keys):
        pass
    assert keys.events == {}
