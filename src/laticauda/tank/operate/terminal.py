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

from laticauda.control.estimation import Estimate
from laticauda.tank.operate.procedure.state import OperatorState, Outputs
from laticauda.tank.operate.recording.entries import Event
from laticauda.tank.operate.recording.timing import Tick
from laticauda.tank.operate.safety.modules import Modules
from laticauda.tank.operate.safety.supervisor import PHASES
from laticauda.tank.operate.settings import Operation
from laticauda.tank.protocol import NodeState, worker
from laticauda.values import optional_import

STOP = "operator_key"
"""Event of the supervisor's table: straighten and stop."""
EMERGENCY = "emergency_key"
"""Event of the supervisor's table: emergency stop."""
STOP_KEYS = {b" ": "by space", b"q": "by q", b"Q": "by q"}
"""Terminal keys that stop the robot, and how the log describes them."""
LOOK_INTERVAL = 0.1
"""Interval at which the terminal's thread checks whether to end [s, wall clock]."""


class Keys:
    """Keys that the operator has pressed so far; within a `with` block, signals count as well."""

    def __init__(self) -> None:
        self._pressed: dict[str, str] = {}
        self._handlers_before: dict[int, Any] = {}

    @property
    def events(self) -> dict[str, str]:
        """Events for the supervisor; a key that was pressed stays pressed."""
        return dict(self._pressed)

    def stop(self, how: str = "by key") -> None:
        """Request to straighten and stop; the second time, request the emergency stop.

        Args:
            how: How it was requested, for the log.
        """
        event = EMERGENCY if STOP in self._pressed else STOP
        self._pressed.setdefault(event, how)

    def __enter__(self) -> Self:
        """Install the signal handlers; only possible in the main thread of a program."""
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                self._handlers_before[number] = signal.signal(number, self._stop_by_signal)
        return self

    def __exit__(self, *_: object) -> None:
        """Restore the previous signal handlers."""
        for number, handler in self._handlers_before.items():
            signal.signal(number, handler)
        self._handlers_before.clear()

    def _stop_by_signal(self, number: int, _: object) -> None:
        self.stop(f"by {signal.Signals(number).name}")


class Terminal(worker.Worker[None]):
    """Reader of single keys, without Enter, within a `with` block.

    It does nothing if there is no terminal. The terminal is restored afterwards. Ctrl-C remains a
    signal. A program in the background reads no keys.

    Args:
        keys: Object that registers the keys pressed.
        stream: The terminal; None: standard input.
    """

    def __init__(self, keys: Keys, stream: TextIO | None = None) -> None:
        super().__init__("keys")
        self._keys = keys
        self._stream = sys.stdin if stream is None else stream
        self._attributes_before: list[Any] | None = None

    def __enter__(self) -> Self:
        """Read keys one by one, without echo."""
        # On another operating system, or without a terminal, only Ctrl-C works.
        with contextlib.suppress(ImportError, AttributeError, OSError, ValueError):
            import termios
            import tty

            number = self._stream.fileno()
            if self._stream.isatty() and _is_in_foreground(number):
                self._attributes_before = termios.tcgetattr(number)
                tty.setcbreak(number)
                self._start()
        return self

    def release(self) -> None:
        """Restore the terminal."""
        if self._attributes_before is None:
            return
        import termios

        with contextlib.suppress(OSError, ValueError, termios.error):
            number = self._stream.fileno()
            termios.tcsetattr(number, termios.TCSADRAIN, self._attributes_before)

    def work(self) -> None:
        """Wait for a key."""
        number = self._stream.fileno()
        readable, _, _ = select.select([number], [], [], LOOK_INTERVAL)
        if not readable:
            return
        pressed = os.read(number, 1)
        if not pressed:
            raise EOFError("the terminal is gone")
        if pressed in STOP_KEYS:
            self._keys.stop(STOP_KEYS[pressed])


def _is_in_foreground(number: int) -> bool:
    """Return whether this program is in the foreground of its terminal.

    Otherwise it must not change the terminal.
    """
    try:
        return os.tcgetpgrp(number) == os.getpgrp()
    except OSError:
        # Not the controlling terminal of this program: no other program is in its foreground.
        return True


REFRESH_INTERVAL = 0.2
"""Time between two pictures of the dashboard [s, wall clock]."""
LAST_EVENTS = 6
"""Number of events that are shown."""
RECENT_TICKS = 1000
"""Number of ticks whose lateness is shown."""
PROGRESS_WIDTH = 24
"""Width of the bar that shows how much of the run is over, in characters."""
COLORS = {
    "idle": "white",
    "ready": "cyan",
    "running": "green",
    "stopping": "yellow",
    "fault": "red",
}
"""Colors of the supervisor's states."""
STATE_COLORS = {
    NodeState.ACTIVE: "green",
    NodeState.HOLD: "yellow",
    NodeState.LIMP: "yellow",
    NodeState.FAULT: "red",
}
"""Colors of the modules' states; all others are white."""
MODULE_COLUMNS = {"node": 4, "state": 11, "angle": 9, "current": 8, "temp.": 7, "supply": 7}
"""Columns of the table of modules, with their least widths in characters."""


def print_events(state: OperatorState, outputs: Outputs) -> None:
    """Write the events of one tick to standard error, one per line; a callback for every tick."""
    for event in outputs.events:
        if event.kind != "phase":
            sys.stderr.write(f"{line_of(event)}\n")


def line_of(event: Event) -> str:
    """Return an event as one line: time, kind, message."""
    return f"{event.time:8.2f} s  {event.kind.replace('_', ' '):<13} {event.message}"


class Dashboard:
    """Live display of modules, pose, state and events.

    It is redrawn by a thread of rich within a `with` block.

    Args:
        operation: Operation that is displayed.
    """

    def __init__(self, operation: Operation) -> None:
        self._operation = operation
        self._state: OperatorState | None = None
        self._events: tuple[Event, ...] = ()
        self._lateness = deque[float](maxlen=RECENT_TICKS)
        self._largest_lateness = 0.0
        self._live: Any = _rich("live").Live(
            get_renderable=self._draw, refresh_per_second=1.0 / REFRESH_INTERVAL, screen=False
        )

    def __call__(self, state: OperatorState, outputs: Outputs) -> None:
        """Take in one tick; the thread draws it."""
        self._state = state
        for entry in outputs.entries:
            if isinstance(entry, Tick):
                lateness = entry.began - entry.due
                self._lateness.append(lateness)
                self._largest_lateness = max(self._largest_lateness, lateness)
        new_events = [event for event in outputs.events if event.kind != "phase"]
        if new_events:
            events = list(self._events)
            if any(event.kind == "learned" for event in new_events):  # replaces what was learned
                events = [event for event in events if event.kind != "learned"]
            self._events = (*events, *new_events)[-LAST_EVENTS:]

    def _draw(self) -> Any:
        if self._state is None:
            return ""
        almost_all = float(np.percentile([0.0, *self._lateness.copy()], 99.9))
        loop = (
            f"loop late by {1e3 * almost_all:.1f} ms (99.9 % of the last {RECENT_TICKS}), "
            f"{1e3 * self._largest_lateness:.1f} ms at most"
        )
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
    tables = [_render_modules(state.modules), _render_pose(operation, state)]
    columns = _rich("columns").Columns(tables, padding=(0, 2))
    event_lines = "\n".join(line_of(event) for event in events)
    log = _rich("text").Text(event_lines, style="dim", overflow="ellipsis")
    group = _rich("console").Group(_render_state(operation, state), columns, log)
    keys = "space, q, Ctrl-C: straighten and stop; again: emergency stop"
    return _rich("panel").Panel(
        group,
        title=f"[bold]{operation.name}[/bold]   {keys}",
        title_align="left",
        subtitle=f"[dim]{loop}[/]",
        subtitle_align="right",
        border_style=COLORS[state.supervisor.state],
    )


def _render_state(operation: Operation, state: OperatorState) -> Any:
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
        elapsed = end - state.begun
        bar = _render_progress(elapsed / operation.duration)
        text.append(f"   {elapsed:5.1f} of {operation.duration:.0f} s  [{bar}]")
    if supervisor.cause:
        cause = supervisor.cause.replace("_", " ")
        action = supervisor.action.replace("_", " ")
        text.append(f"   {cause}: {action}", style=color)
    return text


def _render_progress(share: float) -> str:
    """Return a bar that shows which share of the run is over."""
    n_filled = round(PROGRESS_WIDTH * min(share, 1.0))
    return "=" * n_filled + " " * (PROGRESS_WIDTH - n_filled)


def _render_modules(modules: Modules) -> Any:
    """Return a table with one row per module."""
    table = _rich("table").Table(box=None, pad_edge=False, header_style="bold")
    for name, width in MODULE_COLUMNS.items():
        justify = "left" if name == "state" else "right"
        table.add_column(name, justify=justify, min_width=width)
    for k, beat in enumerate(modules.heartbeat):
        if beat is None:
            table.add_row(str(k + 1), "[red]silent[/]", "", "", "", "")
            continue
        color = STATE_COLORS.get(beat.state, "white")
        state = beat.state.name.lower()
        if beat.leak:
            color = "red"
            state = "LEAK"
        table.add_row(
            str(k + 1),
            f"[{color}]{state}[/]",
            _number(math.degrees(modules.angle[k]), 1, "°"),
            _number(modules.current[k], 2, " A"),
            _number(beat.temperature, 0, " °C"),
            _number(beat.voltage, 1, " V"),
        )
    return table


def _render_pose(operation: Operation, state: OperatorState) -> Any:
    """Return a table of the robot's pose and the current it draws."""
    table = _rich("table").Table.grid(padding=(0, 2))
    rows = [("pose", "not known yet")]
    if state.estimate is not None:
        rows = _describe_estimate(state.estimate)
    if state.reference.command is not None and operation.following is not None:
        rows.append(("offset", f"{math.degrees(state.reference.command.offset):7.1f}°"))
    if state.reading is not None:
        rows.append(("supply", f"{state.reading.current:7.3f} A"))
    if state.idle.mean is not None:
        rows.append(("at rest", f"{state.idle.mean:7.3f} A"))
    for name, value in rows:
        table.add_row(f"[bold]{name}[/]", value)
    return table


def _describe_estimate(estimate: Estimate) -> list[tuple[str, str]]:
    """Return names and values of a pose, one row each."""
    position = estimate.center_of_mass
    speed = math.hypot(*estimate.center_of_mass_velocity)
    rows = [
        ("position", f"{position[0]:7.3f}, {position[1]:7.3f} m"),
        ("speed", f"{speed:7.3f} m/s"),
        ("heading", f"{math.degrees(estimate.heading):7.1f}°"),
        ("cameras", f"{estimate.status}, {estimate.age:.2f} s"),
    ]
    if position.size == 3:
        depth = -position[2]
        pitch = math.degrees(estimate.pitch)
        rows.append(("depth", f"{depth:7.3f} m, pitch {pitch:.1f}° down"))
    return rows


def _number(value: float, digits: int, unit: str) -> str:
    if not math.isfinite(value):
        return "-"
    return f"{value:.{digits}f}{unit}"


def _rich(name: str) -> Any:
    """Import a module of rich."""
    return optional_import("The dashboard", "rich", "hardware", f"rich.{name}")
