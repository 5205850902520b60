import io
import math
import os
import sys
import time
from dataclasses import replace

import pytest
from rich.console import Console
from tank.operate.rig import run_of

import laticauda as lc
from laticauda.control import Following
from laticauda.tank.operate import Event
from laticauda.tank.operate.procedure.operator import Operator
from laticauda.tank.operate.settings import Calibration, Connection, Operation
from laticauda.tank.operate.terminal import (
    EMERGENCY,
    STOP,
    Dashboard,
    Keys,
    Terminal,
    print_events,
    render_dashboard,
)

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
    end = time.monotonic() + 20.0
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


WHAT = Operation(
    name="shown",
    gait=lc.lateral_undulation(
        amplitude=math.radians(30), frequency=math.radians(90), phase_shift=math.radians(40)
    ),
    following=Following(),
    duration=5.0,
    rate=25.0,
    estimator="kinematics",
    countdown=0.1,
    connection=Connection(meter_address="there"),
    supply_voltage=35.0,
    calibration=Calibration(idle_time=0.2, still_time=0.3),
)


def text_of(run) -> str:
    console = Console(record=True, width=110, file=io.StringIO())
    console.print(render_dashboard(WHAT, run.state, tuple(run.events[-4:])))
    return console.export_text()


def test_the_dashboard_shows_modules_pose_state_and_events():
    run = run_of(Operator(operation=WHAT))
    first = text_of(run)
    assert "silent" in first
    assert "not known yet" in first
    run.until("running")
    run.tick(25)
    shown = text_of(run)
    for word in (
        "RUNNING",
        "active",
        "25 °C",
        "35.0 V",
        "0.30 A",
        "m/s",
        "tracking",
        "at rest",
        "1.180 A",
        "of 5 s",
    ):
        assert word in shown, word
    assert max(len(line) for line in shown.splitlines()) <= 110
    run.rig.leak = {3}
    run.tick(20)
    shown = text_of(run)
    assert "LEAK" in shown
    assert "FAULT" in shown
    assert "emergency stop" in shown


def test_it_is_drawn_by_a_thread_that_ends():
    run = run_of(Operator(operation=WHAT))
    with Dashboard(WHAT) as dashboard:
        dashboard(run.state, run.outputs)
    assert not dashboard._live.is_started


def test_only_what_was_learnt_last_stays_on_the_dashboard():
    run = run_of(Operator(operation=WHAT))
    learned = [Event(time=1.0 * k, kind="learned", message=f"normal drag {k}") for k in range(9)]
    changed = Event(time=3.0, kind="changed", message="The fin is gone.")
    dashboard = Dashboard(WHAT)
    for event in (*learned[:3], changed, *learned[3:]):
        dashboard(run.state, replace(run.outputs, entries=(event,)))
    assert dashboard._events == (changed, learned[-1])


def test_without_a_terminal_there_is_a_line_per_event(capsys):
    run = run_of(Operator(operation=WHAT))
    while run.state.phase != "running":
        run.tick()
        print_events(run.state, run.outputs)
    told = capsys.readouterr().err
    assert "8 modules and the motion capture respond" in told
    assert "I_0 = 1.180 A" in told
    assert "phase" not in told
