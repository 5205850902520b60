import io
import json
import os
import signal
import sys
from pathlib import Path

import pytest

from laticauda import cli
from laticauda.cli import progress
from laticauda.cli.command import Command, Outcome, until_stopped
from laticauda.cli.flags import PictureOutput, TrialOutput
from laticauda.values.errors import BadArgument
from laticauda.values.quantities import option, value_class


@value_class
class Part:
    """A part of it."""

    plot: PictureOutput = option("Draw it", default=None)


@value_class
class Count(Command):
    """Count."""

    part: Part = option("A part", default=Part())
    save: TrialOutput = option("Keep it", default=None)
    fails: bool = option("Whether it fails", default=False)

    def run(self) -> Outcome:
        """Count."""
        Path("ran").touch()
        problem = "too much" if self.fails else ""
        return Outcome(facts={"n": 3}, text="three", problem=problem, succeeded=not self.fails)


@value_class
class Weigh(Command):
    """Weigh."""

    robot: str = option("A preset or a TOML file", default="mamba")
    name: str = option("What to call it", default="it")


def test_every_field_of_a_command_from_elsewhere_is_a_flag():
    found = Weigh.read(["--robot", "chain", "--name", "x"], "weigh")
    assert (found.robot, found.name) == ("chain", "x")


def test_an_outcome_is_text_or_one_json_object_and_a_status(
    folder: Path, capsys: pytest.CaptureFixture[str]
):
    assert Count()() == 0
    assert capsys.readouterr() == ("three\n", "")
    assert Count(json=True, fails=True)() == 1
    out, err = capsys.readouterr()
    assert json.loads(out) == {"n": 3}
    assert err == "too much\n"


@pytest.mark.parametrize(
    ("command", "name"),
    [(Count(save="a.txt"), "save"), (Count(part=Part(plot="no/a.png")), "plot")],
)
def test_files_that_cannot_be_written_are_refused_before_the_work(
    folder: Path, command: Count, name: str
):
    with pytest.raises(BadArgument) as refused:
        command()
    assert refused.value.name == name
    assert not (folder / "ran").exists()


def test_a_server_ends_well_by_ctrl_c_and_is_closed(capsys: pytest.CaptureFixture[str]):
    closed: list[bool] = []
    with until_stopped(lambda: closed.append(True)):
        raise KeyboardInterrupt
    assert closed == [True]
    assert capsys.readouterr().err == "stopped.\n"


def test_a_server_that_is_stopped_while_something_is_compiled_is_closed_and_goes_on_to_save(capsys):
    closed: list[bool] = []
    compiler = compile(
        "import signal; signal.raise_signal(signal.SIGINT)",
        f"{os.sep}numba{os.sep}lower.py",
        "exec",
    )
    before = signal.signal(signal.SIGINT, cli._stop)
    try:
        with until_stopped(lambda: closed.append(True)):
            exec(compiler)
        assert signal.getsignal(signal.SIGINT) is cli._stop
    finally:
        signal.signal(signal.SIGINT, before)
    assert closed == [True]
    assert capsys.readouterr().err == "stopped.\n"


def test_a_server_in_the_background_of_a_script_goes_on_at_ctrl_c():
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with until_stopped(lambda: None):
            signal.raise_signal(signal.SIGINT)
            assert signal.getsignal(signal.SIGINT) == signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)


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
    assert [line.split(" %")[0] for line in lines] == [
        f"laticauda: {tenth}0" for tenth in range(1, 11)
    ]
    assert lines[2] == "laticauda: 30 % filmed, 9.0 of 30.0 s"


def test_a_stopped_study_says_how_many_trials_are_stored_and_how_to_go_on():
    with pytest.raises(
        KeyboardInterrupt, match=r"^stopped; 3 of 9 trials are stored in a\. Run the same"
    ):
        with progress.stored_trials("a") as show:
            show(3, 9)
            raise KeyboardInterrupt


def test_a_server_that_is_asked_to_terminate_closes_as_by_ctrl_c_and_goes_on_to_save(capsys):
    before, closed = signal.getsignal(signal.SIGTERM), []
    with until_stopped(lambda: closed.append(True)):
        signal.raise_signal(signal.SIGTERM)
    assert closed
    assert signal.getsignal(signal.SIGTERM) is before
    assert capsys.readouterr().err == "stopped.\n"
