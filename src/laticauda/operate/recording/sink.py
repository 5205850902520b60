"""What keeps the record of an operation: a thread writes what the loop hands over, so that no disk makes it late."""

import threading
from collections import deque
from types import TracebackType
from typing import Self

from laticauda.operate.course.state import OperatorState, Outputs
from laticauda.operate.drivers.can import Frame
from laticauda.operate.recording.entries import Tick
from laticauda.operate.recording.recorder import OperationRecorder

PAUSE = 0.02  # of the thread when there is nothing to write [s, wall clock]
PATIENCE = 10.0  # for the rest to be written at the end [s, wall clock]
TickRecord = tuple[OperatorState, Outputs, tuple[Frame, ...], Tick | None]


def write_tick(
    recorder: OperationRecorder,
    state: OperatorState,
    outputs: Outputs,
    frames: tuple[Frame, ...],
    tick: Tick | None = None,
) -> None:
    """Write everything of one tick.

    Args:
        recorder: Open.
        state: After the tick.
        outputs: Of the tick.
        frames: Of the bus, both ways.
        tick: When it was; None where there is no clock.
    """
    now = state.now
    assert now is not None  # it was a tick
    for frame in frames:
        recorder.can(frame.time, frame.identifier, frame.data, sent=frame.is_ours)
    for sample in outputs.samples:
        recorder.sample(sample, received=now)
    if outputs.estimate is not None:
        recorder.estimate(outputs.estimate)
        if outputs.command is not None:
            recorder.command(outputs.estimate.time, outputs.command, outputs.signals)
    if tick is not None:
        recorder.tick(tick)
    for event in outputs.events:
        recorder.event(event)
        if event.kind == "idle_current" and "current" in event.data:
            recorder.note("idle", event.data)
        if event.kind == "settling" and "heading" in event.data:
            recorder.note("initial", event.data)


class PlainSink:
    """Writes at once; for operations without a clock.

    Args:
        recorder: Open; it stays open.
        frames: Whether the raw frames of the bus are kept, which are most of a recording.
    """

    def __init__(self, recorder: OperationRecorder, *, frames: bool = True) -> None:
        self._recorder, self._frames = recorder, frames
        self.trouble = ""

    def tick(self, state: OperatorState, outputs: Outputs, frames: tuple[Frame, ...], tick: Tick | None) -> None:
        """Write one tick; after an error nothing more."""
        if self.trouble:
            return
        try:
            write_tick(self._recorder, state, outputs, frames if self._frames else (), tick)
        except Exception as error:
            self.trouble = str(error) or type(error).__name__


class RecordingSink(PlainSink):
    """Writes in a thread; a context manager, whose end waits until all is written."""

    def __init__(self, recorder: OperationRecorder) -> None:
        super().__init__(recorder)
        self._waiting: deque[TickRecord] = deque()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="laticauda-recorder", daemon=True)

    def tick(self, state: OperatorState, outputs: Outputs, frames: tuple[Frame, ...], tick: Tick | None) -> None:
        """Hand one tick over."""
        if not self.trouble:
            self._waiting.append((state, outputs, frames, tick))

    def _run(self) -> None:
        while self._waiting or not self._ended.is_set():
            if not self._waiting:
                self._ended.wait(PAUSE)
                continue
            what = self._waiting.popleft()
            try:
                write_tick(self._recorder, *what)
            except Exception as error:
                self.trouble = str(error) or type(error).__name__
                self._waiting.clear()

    def __enter__(self) -> Self:
        """Begin to write."""
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Write the rest."""
        self._ended.set()
        self._thread.join(PATIENCE)
