"""The operator's terminal: keys that stop the robot, and the display, a dashboard or plain lines.

Space, q or Ctrl-C straightens and stops the robot; the second time, it triggers the emergency stop.
"""

# rich is typed but has many kinds of renderables; `Any` stands for all of them.

import contextlib
import math
import os
import select
import signal
import sys
import threading
from collections import deque
from typing import Any, Self, TextIO

import numpy as np

from laticauda.tank.operate.course.state import OperatorState, Outputs
from laticauda.tank.operate.recording.entries import Event, Tick
from laticauda.tank.operate.safety import limits
from laticauda.tank.operate.safety.supervisor import PHASES
from laticauda.tank.operate.settings import Operation
from laticauda.tank.protocol import NodeState, worker
from laticauda.values.optional import optional_import

STOP, EMERGENCY = "operator_key", "emergency_key"
WORDS = {b" ": "by space", b"q": "by q", b"Q": "by q"}
"""Terminal keys that stop the robot, and how the log describes them."""
LOOK = 0.1  # interval at which the terminal's thread checks whether to end [s, wall clock]


class Keys:
    """Keys that the operator has pressed so far; within a `with` block, signals count as well."""

    def __init__(self) -> None:
        self._pressed: dict[str, str] = {}
        self._before: dict[int, Any] = {}

    @property
    def events(self) -> dict[str, str]:
        """Events for the supervisor; a key that was pressed stays pressed."""
        return dict(self._pressed)

    def stop(self, how: str = "by key") -> None:
        """Request to straighten and stop; the second time, request the emergency stop.

        Args:
            how: How it was requested, for the log.
        """
        self._pressed.setdefault(EMERGENCY if STOP in self._pressed else STOP, how)

    def __enter__(self) -> Self:
        """Install the signal handlers; only possible in the main thread of a program."""
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                self._before[number] = signal.signal(
                    number, lambda n, _: self.stop(f"by {signal.Signals(n).name}")
                )
        return self

    def __exit__(self, *_: object) -> None:
        """Restore the previous signal handlers."""
        for number, handler in self._before.items():
            signal.signal(number, handler)
        self._before.clear()


class Terminal(worker.Worker[None]):
    """Reader of single keys, without Enter, within a `with` block; does nothing if there is no terminal.

    The terminal is restored afterwards. Ctrl-C remains a signal. A program in the background reads
    no keys.

    Args:
        keys: Object that registers the keys pressed.
        stream: The terminal; None: standard input.
    """

    def __init__(self, keys: Keys, stream: TextIO | None = None) -> None:
        super().__init__("keys")
        self._keys, self._stream = keys, sys.stdin if stream is None else stream
        self._before: list[Any] | None = None

    def __enter__(self) -> Self:
        """Read keys one by one, without echo."""
        # On another operating system, or without a terminal, only Ctrl-C works.
        with contextlib.suppress(ImportError, AttributeError, OSError, ValueError):
            import termios
            import tty

            number = self._stream.fileno()
            if self._stream.isatty() and _in_front(number):
                self._before = termios.tcgetattr(number)
                tty.setcbreak(number)
                self._start()
        return self

    def release(self) -> None:
        """Restore the terminal."""
        if self._before is not None:
            import termios

            with contextlib.suppress(OSError, ValueError, termios.error):
                termios.tcsetattr(self._stream.fileno(), termios.TCSADRAIN, self._before)

    def work(self) -> None:
        """Wait for a key."""
        number = self._stream.fileno()
        if select.select([number], [], [], LOOK)[0]:
            pressed = os.read(number, 1)
            if not pressed:
                raise EOFError("the terminal is gone")
            if pressed in WORDS:
                self._keys.stop(WORDS[pressed])


def _in_front(number: int) -> bool:
    """Return whether this program is in the foreground of its terminal; otherwise it must not change the terminal."""
    try:
        return os.tcgetpgrp(number) == os.getpgrp()
    except (
        OSError
    ):  # not the controlling terminal of this program: no other program is in its foreground
        return True


REFRESH = 0.2  # [s, wall clock]
LAST_EVENTS = 6
RECENT = 1000  # number of ticks whose lateness is shown
COLORS = {
    "idle": "white",
    "ready": "cyan",
    "running": "green",
    "stopping": "yellow",
    "fault": "red",
}
STATE_COLORS = {
    NodeState.ACTIVE: "green",
    NodeState.HOLD: "yellow",
    NodeState.LIMP: "yellow",
    NodeState.FAULT: "red",
}


def print_events(state: OperatorState, outputs: Outputs) -> None:
    """Write the events of one tick to standard error, one per line; can be passed as a callback for every tick."""
    for event in outputs.events:
        if event.kind != "phase":
            sys.stderr.write(f"{line_of(event)}\n")


def line_of(event: Event) -> str:
    """Return an event as one line: time, kind, message."""
    return f"{event.time:8.2f} s  {event.kind.replace('_', ' '):<13} {event.message}"


class Dashboard:
    """Live display of modules, pose, state and events, redrawn by a thread of rich within a `with` block.

    Args:
        operation: Operation that is displayed.
    """

    def __init__(self, operation: Operation) -> None:
        self._operation = operation
        self._state: OperatorState | None = None
        self._events: tuple[Event, ...] = ()
        self._late, self._latest = deque[float](maxlen=RECENT), 0.0
        often = {"refresh_per_second": 1.0 / REFRESH, "screen": False}
        self._live: Any = _rich("live").Live(get_renderable=self._drawn, **often)

    def __call__(self, state: OperatorState, outputs: Outputs) -> None:
        """Take in one tick; the thread draws it."""
        self._state = state
        for tick in (entry for entry in outputs.entries if isinstance(entry, Tick)):
            self._late.append(tick.began - tick.due)
            self._latest = max(self._latest, self._late[-1])
        events = tuple(event for event in outputs.events if event.kind != "phase")
        if events:
            outdated = {"learned"} & {event.kind for event in events}
            kept = (event for event in self._events if event.kind not in outdated)
            self._events = (*kept, *events)[-LAST_EVENTS:]

    def _drawn(self) -> Any:
        if self._state is None:
            return ""
        late = 1e3 * float(np.percentile([0.0, *self._late.copy()], 99.9))
        loop = f"loop late by {late:.1f} ms (99.9 % of the last {RECENT}), {1e3 * self._latest:.1f} ms at most"
        return render_dashboard(self._operation, self._state, self._events, loop)

    def __enter__(self) -> Self:
        """Start drawing."""
        self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Draw the final state, and release the terminal."""
        self._live.stop()


def render_dashboard(
    operation: Operation, state: OperatorState, events: tuple[Event, ...], loop: str = ""
) -> Any:
    """Return the dashboard as a renderable of rich.

    Args:
        operation: Operation that is displayed.
        state: State after the latest tick.
        events: The latest events.
        loop: Text about the punctuality of the loop.
    """
    columns = _rich("columns").Columns(
        [_modules(state.modules), _pose(operation, state)], padding=(0, 2)
    )
    log = _rich("text").Text(
        "\n".join(line_of(event) for event in events), style="dim", overflow="ellipsis"
    )
    group = _rich("console").Group(_head(operation, state), columns, log)
    title = f"[bold]{operation.name}[/bold]   space, q, Ctrl-C: straighten and stop; again: emergency stop"
    style = {
        "border_style": COLORS[state.supervisor.state],
        "title_align": "left",
        "subtitle_align": "right",
    }
    return _rich("panel").Panel(group, title=title, subtitle=f"[dim]{loop}[/]", **style)


def _head(operation: Operation, state: OperatorState) -> Any:
    """Return state, phase and time as one line."""
    supervisor = state.supervisor
    phase = state.phase.replace("_", " ")
    steps = f"{PHASES.index(state.phase) + 1}/{len(PHASES)}"
    color = COLORS[supervisor.state]
    text = _rich("text").Text.from_markup(
        f"[bold {color}]{supervisor.state.upper():<9}[/] {phase} ({steps})"
    )
    if state.begun is not None and state.now is not None:
        end = state.now if state.ended is None else state.ended
        gone, whole = end - state.begun, operation.duration
        filled = round(24 * min(gone / whole, 1.0))
        text.append(f"   {gone:5.1f} of {whole:.0f} s  [{'=' * filled}{' ' * (24 - filled)}]")
    if supervisor.cause:
        text.append(
            f"   {supervisor.cause.replace('_', ' ')}: {supervisor.action.replace('_', ' ')}",
            style=color,
        )
    return text


def _modules(modules: limits.Modules) -> Any:
    """Return a table with one row per module."""
    table = _rich("table").Table(box=None, pad_edge=False, header_style="bold")
    for name, width in (
        ("node", 4),
        ("state", 11),
        ("angle", 9),
        ("current", 8),
        ("temp.", 7),
        ("supply", 7),
    ):
        table.add_column(name, justify="left" if name == "state" else "right", min_width=width)
    for k, beat in enumerate(modules.heartbeat):
        if beat is None:
            table.add_row(str(k + 1), "[red]silent[/]", "", "", "", "")
            continue
        color = "red" if beat.leak else STATE_COLORS.get(beat.state, "white")
        word = "LEAK" if beat.leak else beat.state.name.lower()
        table.add_row(
            str(k + 1),
            f"[{color}]{word}[/]",
            _number(math.degrees(modules.angle[k]), 1, "°"),
            _number(modules.current[k], 2, " A"),
            _number(beat.temperature, 0, " °C"),
            _number(beat.voltage, 1, " V"),
        )
    return table


def _pose(operation: Operation, state: OperatorState) -> Any:
    """Return a table of the robot's pose and the current it draws."""
    table = _rich("table").Table.grid(padding=(0, 2))
    estimate = state.estimate
    rows: list[tuple[str, str]] = []
    if estimate is None:
        rows.append(("pose", "not known yet"))
    else:
        x, y, *height = estimate.center_of_mass
        speed = math.hypot(*estimate.center_of_mass_velocity)
        rows += [
            ("position", f"{x:7.3f}, {y:7.3f} m"),
            ("speed", f"{speed:7.3f} m/s"),
            ("heading", f"{math.degrees(estimate.heading):7.1f}°"),
            ("cameras", f"{estimate.status}, {estimate.age:.2f} s"),
        ]
        rows += [
            ("depth", f"{-z:7.3f} m, pitch {math.degrees(estimate.pitch):.1f}° down")
            for z in height
        ]
    if state.reference.command is not None and operation.following is not None:
        rows.append(("offset", f"{math.degrees(state.reference.command.offset):7.1f}°"))
    if state.reading is not None:
        rows.append(("supply", f"{state.reading.current:7.3f} A"))
    if state.idle.mean is not None:
        rows.append(("at rest", f"{state.idle.mean:7.3f} A"))
    for name, value in rows:
        table.add_row(f"[bold]{name}[/]", value)
    return table


def _number(value: float, digits: int, unit: str) -> str:
    return f"{value:.{digits}f}{unit}" if math.isfinite(value) else "-"


def _rich(name: str) -> Any:
    """Import a module of rich."""
    return optional_import("The dashboard", "rich", "hardware", f"rich.{name}")
