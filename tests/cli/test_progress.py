import io
import sys

import pytest

from laticauda.cli import progress


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def screen(monkeypatch: pytest.MonkeyPatch, kind: type[io.StringIO]) -> io.StringIO:
    # In the test itself: between fixtures and test, pytest puts its own capture in place.
    found = kind()
    monkeypatch.setattr(sys, "stderr", found)
    return found


def clock(monkeypatch: pytest.MonkeyPatch, step: float) -> None:
    times = iter(i * step for i in range(1000))
    monkeypatch.setattr(progress.time, "monotonic", lambda: next(times))


def test_a_long_run_shows_a_bar_on_a_terminal(monkeypatch):
    terminal = screen(monkeypatch, Terminal)
    clock(monkeypatch, 3.0)
    show = progress.run_bar(30.0)
    for reached in (10.0, 20.0, 30.0):
        show(reached)
    assert "swam 20 of 30 s" in terminal.getvalue()


def test_a_short_run_shows_nothing(monkeypatch):
    terminal = screen(monkeypatch, Terminal)
    clock(monkeypatch, 0.1)
    show = progress.run_bar(30.0)
    for reached in (10.0, 20.0, 30.0):
        show(reached)
    assert terminal.getvalue() == ""


def test_nothing_is_shown_where_nobody_looks(monkeypatch):
    terminal = screen(monkeypatch, io.StringIO)
    clock(monkeypatch, 3.0)
    progress.run_bar(30.0)(10.0)
    assert terminal.getvalue() == ""


def test_a_long_film_says_every_tenth_where_nobody_looks(monkeypatch):
    log = screen(monkeypatch, io.StringIO)
    clock(monkeypatch, 3.0)
    show = progress.film_bar(30.0)
    for k in range(901):
        show(k / 30.0)
    lines = log.getvalue().splitlines()
    assert [line.split(" %")[0] for line in lines] == [f"laticauda: {tenth}0" for tenth in range(1, 11)]
    assert lines[2] == "laticauda: 30 % filmed, 9.0 of 30.0 s"


def test_a_stopped_study_says_how_many_trials_are_stored_and_how_to_go_on():
    with pytest.raises(KeyboardInterrupt, match=r"^stopped; 3 of 9 trials are stored in a\. Run the same"):
        with progress.stored_trials("a") as show:
            show(3, 9)
            raise KeyboardInterrupt
