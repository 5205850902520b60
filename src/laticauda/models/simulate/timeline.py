"""Time of a run: spans between control instants, and legs with one command each.

A run is split into spans at the control instants, where controllers see their robots and decide. A
long time between two control instants becomes several spans, only to report progress between them;
nobody decides there. A command may take effect later, inside a span, which is then split into legs
with one command each.
"""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any, Generic, NamedTuple, TypeVar

Issued = TypeVar("Issued")
"""What a controller issues: a command, or those of many robots."""

CLOSE = 1e-9
"""Times closer than this are equal [s]."""
LONGEST_SPAN = 2000
"""Samples in a span, at most, so that `progress` is called every some tens of milliseconds of work."""


class CommandQueue(Generic[Issued]):
    """The command that acts, and those on their way from the controller to the joints.

    Args:
        first: Command that acts until the first one of the controller does.
        delay: Time after which a command takes effect [s].
    """

    def __init__(self, first: Issued, *, delay: float) -> None:
        self.delay = delay
        self._commands = [(0.0, first)]
        """When each takes effect, or did [s], and the command, in this order."""

    @property
    def latest(self) -> Issued:
        """The command that was issued last."""
        return self._commands[-1][1]

    def add(self, now: float, command: Issued) -> None:
        """Issue a command at a control instant.

        Args:
            now: Time of the control instant [s].
            command: The command.
        """
        self._commands.append((now + self.delay, command))
        while len(self._commands) > 1 and self._commands[1][0] <= now + CLOSE:
            del self._commands[0]

    def acting(self, now: float, elapsed: float) -> Issued:
        """Return the command that acts some time after a control instant.

        Args:
            now: Time of the control instant [s].
            elapsed: Time since then [s].
        """
        acting = self._commands[0][1]
        for due, command in self._commands:
            if due - now <= elapsed + CLOSE:
                acting = command
        return acting

    def changes(self, now: float, length: float) -> list[float]:
        """Return the times since the begin of a span at which a command takes effect inside it [s].

        Args:
            now: Time of its begin [s].
            length: Its length [s].
        """
        if len(self._commands) == 1:  # as always without a delay
            return []
        return [
            due - now for due, _ in self._commands[1:] if now + CLOSE < due < now + length - CLOSE
        ]


class Span(NamedTuple):
    """Time without a control instant inside."""

    length: float
    """Its length [s]."""
    n_samples: int
    """Number of samples, the one at its end included."""
    end: float
    """Time reached at its end [s]."""
    begins_at_control_instant: bool
    """Whether the controllers decide at its begin."""


def split_run(duration: float, sample_interval: float, control_interval: float) -> Iterator[Span]:
    """Split a run at its control instants, and long spans so that `progress` is called often enough.

    Args:
        duration: Duration of the run [s].
        sample_interval: Time between two samples [s], adjusted so that it divides that between two
            control instants.
        control_interval: Time between two control instants [s], adjusted so that it divides the
            duration.
    """
    n_intervals, n_samples = count_samples_of_run(duration, sample_interval, control_interval)
    length = duration / n_intervals
    for i in range(n_intervals):
        for first in range(0, n_samples, LONGEST_SPAN):
            count = min(LONGEST_SPAN, n_samples - first)
            yield Span(
                length=length * count / n_samples,
                n_samples=count,
                end=length * (i + (first + count) / n_samples),
                begins_at_control_instant=first == 0,
            )


def count_samples_of_run(
    duration: float, sample_interval: float, control_interval: float
) -> tuple[int, int]:
    """Return the number of control intervals of a run, and that of the samples in each.

    Args:
        duration: Duration of the run [s].
        sample_interval: Time between two samples, not yet adjusted [s].
        control_interval: Time between two control instants, not yet adjusted [s].
    """
    n_intervals = max(1, math.ceil(duration / control_interval - 1e-9))
    n_samples = max(1, round(duration / n_intervals / sample_interval))
    return n_intervals, n_samples


def cut_duration(duration: float, control_interval: float, n_finished: int) -> float:
    """Return the shortened duration of a run that ends after `n_finished` control intervals [s].

    Repeated with this duration, the run has control instants at the same times to the last bit,
    if one of the neighboring floating-point numbers allows it.

    Args:
        duration: Duration of the whole run [s].
        control_interval: Time between two control instants [s].
        n_finished: Number of control intervals after which it ends.
    """
    length = duration / max(1, math.ceil(duration / control_interval - 1e-9))
    cut = length * n_finished
    for candidate in (cut, math.nextafter(cut, 0.0), math.nextafter(cut, 2.0 * cut)):
        if candidate / n_finished == length:
            return candidate
    return cut


class Leg(NamedTuple):
    """Part of a span during which every swimmer has one command; times since the span's begin."""

    begin: float
    """Begin [s]."""
    end: float
    """End [s]."""
    sample_interval: float
    """Time between its samples [s]."""
    ends_at_sample: bool
    """Whether the log has a sample at its end."""


def split_span(queues: Sequence[CommandQueue[Any]], now: float, span: Span) -> list[Leg]:
    """Return the legs of a span: all of it, or from sample to sample if a command takes effect inside.

    In the latter case it is also split where the command takes effect between two samples.

    Args:
        queues: Commands of all swimmers.
        now: Time of the span's begin [s].
        span: The span.
    """
    sample_interval = span.length / span.n_samples
    changes: list[float] = []
    for queue in queues:
        changes += queue.changes(now, span.length)
    if not changes:
        return [Leg(0.0, span.length, sample_interval, ends_at_sample=True)]
    samples = [i * sample_interval for i in range(span.n_samples + 1)]
    between_samples = {change for change in changes if not _is_close_to_one(change, samples)}
    return [
        Leg(begin, end, sample_interval=end - begin, ends_at_sample=end in samples)
        for begin, end in pairwise(sorted([*samples, *between_samples]))
    ]


def _is_close_to_one(time: float, times: Sequence[float]) -> bool:
    return min(abs(time - candidate) for candidate in times) <= CLOSE
