"""The operator's keys: the first Ctrl-C straightens and stops the robot, the second is the emergency stop."""

import signal
import threading
from types import FrameType, TracebackType
from typing import Any, Self

STOP, EMERGENCY = "operator_key", "emergency_key"


class Keys:
    """What the operator has pressed so far; within a `with` block, also by signals."""

    def __init__(self) -> None:
        self._pressed: dict[str, str] = {}
        self._before: dict[int, Any] = {}

    @property
    def events(self) -> dict[str, str]:
        """For the supervisor: a key that was pressed stays pressed."""
        return dict(self._pressed)

    def stop(self, how: str = "by key") -> None:
        """Straighten and stop; the second time, the emergency stop.

        Args:
            how: It was asked for.
        """
        self._pressed.setdefault(EMERGENCY if STOP in self._pressed else STOP, how)

    def emergency(self, how: str = "by key") -> None:
        """The emergency stop.

        Args:
            how: It was asked for.
        """
        self._pressed.setdefault(EMERGENCY, how)

    def _signalled(self, number: int, frame: FrameType | None) -> None:
        self.stop(f"by {signal.Signals(number).name}")

    def __enter__(self) -> Self:
        """Take the signals; only the main thread of a program can."""
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                self._before[number] = signal.signal(number, self._signalled)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Give the signals back."""
        for number, handler in self._before.items():
            signal.signal(number, handler)
        self._before.clear()
