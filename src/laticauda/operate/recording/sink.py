"""What keeps the record of an operation: a thread writes what the loop hands over, so that no disk makes it late."""

import threading
from collections import deque
from typing import Self

from laticauda.operate.course.state import OperatorState, Outputs
from laticauda.operate.drivers.can import Frame
from laticauda.operate.recording.recorder import OperationRecorder
from laticauda.operate.timing import Tick

PAUSE = 0.02  # of the thread when there is nothing to write [s, wall clock]
PATIENCE = 10.0  # for the rest to be written at the end [s, wall clock]


class Sink:
    """What keeps a record of every tick; this one keeps nothing."""

    trouble = ""
    """Why nothing is recorded any more; "" as long as it is."""

    def tick(self, state: OperatorState, outputs: Outputs, frames: tuple[Frame, ...], tick: Tick | None) -> None:
        """Keep one tick: the state after it, what went out, the frames of the bus, both ways, and when it was."""


class PlainSink(Sink):
    """Writes at once; for operations without a clock.

    Args:
        recorder: Open; it stays open.
        frames: Whether the raw frames of the bus are kept, which are most of a recording.
    """

    def __init__(self, recorder: OperationRecorder, *, frames: bool = True) -> None:
        self._recorder, self._frames = recorder, frames

    def tick(self, state: OperatorState, outputs: Outputs, frames: tuple[Frame, ...], tick: Tick | None) -> None:
        """Write one tick; after an error nothing more."""
        if self.trouble:
            return
        try:
            self._write(state, outputs, frames if self._frames else (), tick)
        except Exception as error:
            self.trouble = str(error) or type(error).__name__

    def _write(self, state: OperatorState, outputs: Outputs, frames: tuple[Frame, ...], tick: Tick | None) -> None:
        recorder, now = self._recorder, state.now
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


class RecordingSink(PlainSink):
    """Writes in a thread; a context manager, whose end waits until all is written."""

    def __init__(self, recorder: OperationRecorder) -> None:
        super().__init__(recorder)
        self._waiting: deque[tuple[OperatorState, Outputs, tuple[Frame, ...], Tick | None]] = deque()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="laticauda-recorder", daemon=True)

    def tick(self, state: OperatorState, outputs: Outputs, frames: tuple[Frame, ...], tick: Tick | None) -> None:
        """Hand one tick over."""
        if not self.trouble:
            self._waiting.append((state, outputs, frames, tick))

    def _run(self) -> None:
        while self._waiting or not self._ended.is_set():
            if self._waiting:
                super().tick(*self._waiting.popleft())
            else:
                self._ended.wait(PAUSE)

    def __enter__(self) -> Self:
        """Begin to write."""
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Write the rest."""
        self._ended.set()
        self._thread.join(PATIENCE)
