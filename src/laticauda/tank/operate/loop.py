"""The loop of an operation: reads the devices, ticks, and sends the outputs, at a fixed rate.

The loop depends neither on the kind of clock nor on the kind of devices: it operates a robot over
wires as well as something that is stepped, such as `laticauda.tank.lab.Tank`, without threads and as
fast as possible.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from laticauda.tank import protocol
from laticauda.tank.operate.devices import Devices
from laticauda.tank.operate.procedure.operator import Operator
from laticauda.tank.operate.procedure.state import Inputs, OperatorState, Outputs
from laticauda.tank.operate.recording.entries import Entry, Event
from laticauda.tank.operate.recording.recorder import Sink
from laticauda.tank.operate.recording.timing import Tick, Timing
from laticauda.tank.operate.recording.writer import Writer
from laticauda.values.packaging import renamed_names

MOST_TICKS = 200_000
"""Ticks whose times are kept, half an hour at 100 Hz; then the oldest are overwritten."""
MOST_ERRORS = 3
"""Consecutive errors of the tick after which the operation is given up."""
SWITCHES_ON_WITHIN = 0.1
"""Time from the beginning of a tick within which its order to switch motors on is sent [s].

Of a later one nobody knows any more whether the motors have gone limp in the meantime.
"""
Show = Callable[[OperatorState, Outputs], None]
"""Function that is called with every tick; must be fast."""


def run_loop(
    operator: Operator,
    devices: Devices,
    *,
    keys: Callable[[float], Mapping[str, str]] = lambda now: {},
    sink: Sink | Writer | None = None,
    show: Show | None = None,
    longest: float = math.inf,
) -> tuple[OperatorState, Timing | None]:
    """Run the loop until the operation is done.

    Args:
        operator: Operation to run.
        devices: Connected devices.
        keys: Function that returns what the operator has pressed by a time [s].
        sink: Sink that keeps the record; None: no record is kept.
        show: Function that is called with every tick.
        longest: Time after which the operation is given up [s].

    Returns:
        The last state, and the punctuality of the loop; None if its clock is not real.

    Raises:
        RuntimeError: If the operation is not done by then, or the operator's program fails
            repeatedly.
    """
    clock = devices.clock
    interval = 1.0 / operator.operation.rate
    operation = _GuardedOperation(operator)
    times = _TickTimes(interval) if clock.is_real else None
    n_ticks = 0
    with clock.undisturbed() as priority:
        begun = clock.now()
        origin = begun  # of the schedule: ticks are due at whole intervals after it
        n_since_origin = 0
        while not operation.state.is_done:
            due = origin + n_since_origin * interval
            if due - begun > longest:
                phase = operation.state.phase
                raise RuntimeError(f"the operation is not done after {longest:g} s: {phase}")
            clock.wait_until(due)
            now = clock.now()
            inputs, received = devices.receive(
                {
                    **keys(now),
                    "recorder_failed": sink.trouble if sink else "",
                    "program_error": operation.error,
                }
            )
            outputs = operation.tick(now, inputs, devices)
            outputs = without_late_enabling(outputs, now, clock.now())
            sent = devices.bus.send(outputs.messages)
            if devices.meter is not None and any(event.kind == "start" for event in outputs.events):
                devices.meter.restart()  # its averages start over
            if times is not None:
                tick = Tick(due=due, began=now, sent=clock.now())
                times.add(tick)
                loop_entries: list[Entry] = [tick]
                if n_ticks == 0:
                    loop_entries.append(Event(time=now, kind="loop", message=priority))
                outputs = replace(outputs, entries=(*loop_entries, *outputs.entries))
            n_ticks += 1
            if sink is not None:
                sink.keep(now, (*received, *sent, *outputs.entries))
            if show is not None:
                show(operation.state, outputs)
            n_since_origin += 1
            if now > origin + (n_since_origin + 1) * interval:  # missed ticks are not made up for
                origin = now
                n_since_origin = 1
    return operation.state, None if times is None else times.timing()


class _GuardedOperation:
    """An operation whose errors stop the robot instead of leaving it swimming.

    Args:
        operator: The operation.
    """

    error = ""
    """What went wrong at the last tick; "" if nothing did."""

    def __init__(self, operator: Operator) -> None:
        self._operator = operator
        self._n_errors = 0
        self.state = operator.init()
        """State after the last tick that succeeded."""

    def tick(self, now: float, inputs: Inputs, devices: Devices) -> Outputs:
        """Perform one tick; without outputs if it fails.

        Raises:
            RuntimeError: If ticks fail repeatedly; the modules have then got an emergency stop.
        """
        try:
            self.state, outputs = self._operator.tick(self.state, now, inputs)
        except Exception as error:
            self._n_errors += 1
            self.error = f"{type(error).__name__}: {error}"
            if self._n_errors >= MOST_ERRORS:
                devices.bus.send((protocol.EmergencyStop(reason=2),))
                raise RuntimeError(
                    f"The operation was aborted with an emergency stop: {self.error}"
                ) from error
            return Outputs()
        self._n_errors = 0
        self.error = ""
        return outputs


class _TickTimes:
    """Times of the latest ticks, allocated once: nothing grows in the loop.

    Args:
        interval: Nominal time between two ticks [s].
    """

    def __init__(self, interval: float) -> None:
        self._interval = interval
        self._times = np.empty((MOST_TICKS, 3))
        self._n_ticks = 0

    def add(self, tick: Tick) -> None:
        """Keep the times of a tick."""
        self._times[self._n_ticks % MOST_TICKS] = tick.due, tick.began, tick.sent
        self._n_ticks += 1

    def timing(self) -> Timing:
        """Return the punctuality of the ticks, in the order of their times."""
        return Timing(times=np.sort(self._times[: self._n_ticks], axis=0), interval=self._interval)


def without_late_enabling(outputs: Outputs, began: float, now: float) -> Outputs:
    """Return the outputs of a tick, without an order to switch motors on that would be late.

    Args:
        outputs: Outputs of the tick.
        began: When the tick began [s].
        now: Current time [s].
    """
    enable = protocol.NodeCommand(order=protocol.Order.ENABLE)
    duration = now - began
    if enable not in outputs.messages or duration <= SWITCHES_ON_WITHIN:
        return outputs
    text = f"not switched on: the tick took {duration:.1f} s"
    refusal = Event(time=now, kind="torque", message=text)
    return Outputs(
        messages=tuple(message for message in outputs.messages if message != enable),
        entries=(*outputs.entries, refusal),
    )


# Names of 0.2, for one release.
__getattr__ = renamed_names(
    __name__, {"TankDevices": "laticauda.tank.operate.tank_devices:TankDevices"}
)
