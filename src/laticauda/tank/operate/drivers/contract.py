"""Tests of a single driver: what comes from it, and whether it obeys the rules of `base`.

A driver's test is one line, with the device or its emulator connected; `absent` is an address
without a device:

    assert contract.list_broken_rules("mocap", "mine@127.0.0.1:9870", absent="mine@127.0.0.1:1") == ()
"""

import math
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from laticauda.tank.operate.drivers.base import Clock, DeviceFailed, Frame
from laticauda.tank.operate.recording.entries import PowerReading, SensorSample
from laticauda.tank.operate.settings import Connection
from laticauda.tank.protocol import (
    CanMessage,
    EmergencyStop,
    Heartbeat,
    JointState,
    NodeCommand,
    Order,
    Sync,
    encode_references,
)

TICK = 0.01
"""Time between two calls, as in a loop [s]."""
LONGEST_CALL = 0.05
"""Time that a call of the loop may take [s]."""
FEWEST_BEATS = 5.0
"""Heartbeats per second and node [1/s]."""
FEWEST_ANSWERS = 20.0
"""Answers to a Sync per second and node [1/s]."""
ENABLE_TIME = 0.5
"""Time within which modules are active [s]."""
LIMP_TIME = 1.5
"""Time within which modules are limp without references, or after an emergency stop [s]."""
END_TIME = 3.0
"""Time in which a driver's threads must end after `close` [s]."""
ROTATION_ERROR = 1e-3
"""By how much a rotation matrix may be not orthonormal [-]."""
SYNC_COUNTS = 65536
"""Number of the values that the counter of a Sync has."""


class Heard(NamedTuple):
    """One item received from a driver."""

    what: str
    """Kind of item, with the node."""
    time: float
    """Time of arrival [s]."""
    value: Any
    """Value that the loop would get."""


def listen(
    driver: Any, clock: Clock, duration: float, *, messages: Any = ()
) -> tuple[list[Heard], float]:
    """Act as the loop for a while: call `receive` a hundred times a second.

    A bus is sent a `Sync` each time.

    Args:
        driver: Connected driver of any kind.
        clock: Clock of the driver.
        duration: How long to listen [s].
        messages: For a bus: messages to send each time, before the `Sync`.

    Returns:
        The items received, oldest first, and the duration of the longest call [s].
    """
    items: list[Heard] = []
    longest_call = 0.0
    begun = time.monotonic()
    while True:
        now = time.monotonic()
        if now >= begun + duration:
            return items, longest_call
        if hasattr(driver, "send"):
            sync = Sync(counter=int((now - begun) / TICK) % SYNC_COUNTS)
            driver.send((*messages, sync))
        received = driver.receive()
        longest_call = max(longest_call, time.monotonic() - now)
        for item in received:
            items.append(_describe_item(item, clock.now()))
        time.sleep(TICK)


def _describe_item(item: Any, now: float) -> Heard:
    if isinstance(item, Frame):
        node = getattr(item.message, "node", None)
        description = f"{type(item.message).__name__} of node {node}"
        if node is None:
            description = f"frame {item.identifier:#05x}"
        return Heard(description, item.time, item.message)
    if isinstance(item, PowerReading):
        return Heard("reading", item.time, item)
    if isinstance(item, str):
        return Heard("reason to stop", now, item)
    arrival, sample = item
    if isinstance(sample, SensorSample):
        return Heard(f"sensor {sample.sensor}", arrival, sample)
    pose = sample
    return Heard("body not seen" if pose.is_lost else "body", arrival, pose)


def list_broken_rules(
    kind: str,
    device: str,
    *,
    absent: str = "",
    body: str = "",
    duration: float = 2.0,
    moves: bool = False,
) -> tuple[str, ...]:
    """Return the rules that a driver violates, as sentences; none if all is well.

    Args:
        kind: One of `laticauda.tank.operate.drivers.KINDS`.
        device: DRIVER@ADDRESS of a device that is present.
        absent: The same with an address without a device; "": that it is refused is not tested.
        body: For motion capture: name of the body.
        duration: How long to listen [s].
        moves: For a bus: also switch the motors on where the joints are, and see them go off
            without references.
    """
    threads_before = set(threading.enumerate())
    clock = Clock()
    connection = Connection(mocap_body=body).at(**{kind: device})
    broken: list[str] = []
    with connection.opened(kind, clock) as driver:
        items, longest_call = listen(driver, clock, duration)
        values = [item.value for item in items]
        broken += _check_calls(driver, clock, items, longest_call)
        is_periodic = kind in ("mocap", "meter", "sensors")
        if is_periodic and len(values) < math.floor(duration):
            broken.append(f"{len(values)} items came in {duration:g} s")
        else:
            broken += RULES[kind](values, duration)
        if kind == "bus":
            broken += _check_limp(driver, clock, values, moves=moves)
        elif kind == "meter":
            driver.restart()
    driver.close()  # closing twice does no harm
    connection.opened(kind, clock).close()  # a closed driver can be opened again
    broken += _check_threads(threads_before)
    if absent:
        broken += _check_refusal(connection, kind, absent, clock)
    return tuple(broken)


def _check_calls(
    driver: Any, clock: Clock, items: Sequence[Heard], longest_call: float
) -> Iterator[str]:
    """Check arrival times, the duration of calls, and that nothing is reported."""
    times = [item.time for item in items]
    are_on_clock = all(0.0 < arrival <= clock.now() for arrival in times)
    if times != sorted(times) or not are_on_clock:
        yield "arrival times must be on the given clock, and increase"
    if longest_call > LONGEST_CALL:
        yield f"a call of the loop took {longest_call:.3f} s"
    if driver.trouble:
        yield f"it reports: {driver.trouble}"


def _check_threads(threads_before: set[threading.Thread]) -> Iterator[str]:
    """Check that no thread is left soon after `close`."""
    end = time.monotonic() + END_TIME
    while True:
        left = set(threading.enumerate()) - threads_before
        if not left:
            return
        if time.monotonic() >= end:
            names = ", ".join(thread.name for thread in left)
            yield f"threads are left after `close`: {names}"
            return
        time.sleep(TICK)


def _check_refusal(connection: Connection, kind: str, absent: str, clock: Clock) -> Iterator[str]:
    """Check that a device that is not there is refused, and named."""
    _, _, address = absent.rpartition("@")
    try:
        connection.at(**{kind: absent}).opened(kind, clock).close()
    except DeviceFailed as error:
        if address not in str(error):
            yield f"the error must name the address: {error}"
        return
    yield f"{absent} must be refused, with `DeviceFailed`"


def _check_bus(messages: Sequence[Any], duration: float) -> Iterator[str]:
    """Check that every node answers and sends heartbeats."""
    nodes = sorted(
        {message.node for message in messages if isinstance(message, JointState | Heartbeat)}
    )
    if not nodes or nodes != list(range(1, len(nodes) + 1)):
        yield f"the nodes must be 1, 2, ..., got {nodes}"
    for message_class, fewest in ((JointState, FEWEST_ANSWERS), (Heartbeat, FEWEST_BEATS)):
        senders = [message.node for message in messages if isinstance(message, message_class)]
        counts = [senders.count(node) for node in nodes]
        if min(counts, default=0) < fewest * duration:
            yield (
                f"every node must send {fewest:g} {message_class.__name__} a second, "
                f"got {counts} in {duration:g} s"
            )


class LimpTest(NamedTuple):
    """What modules must be after some messages."""

    description: str
    """What they must be, in words."""
    messages: tuple[CanMessage, ...]
    """Messages that they get at every tick."""
    duration: float
    """Time that they have for it [s]."""
    is_on: bool
    """Whether their motors must be on."""


def _check_limp(
    driver: Any, clock: Clock, messages: Sequence[Any], *, moves: bool
) -> Iterator[str]:
    """Check that modules are limp without references, and after an emergency stop."""
    tests = [
        LimpTest(
            description="limp after an emergency stop",
            messages=(EmergencyStop(reason=2),),
            duration=LIMP_TIME,
            is_on=False,
        )
    ]
    if moves:
        tests = [*_tests_of_motors(messages), *tests]
    for test in tests:
        items, _ = listen(driver, clock, test.duration, messages=test.messages)
        heartbeats = [item.value for item in items if isinstance(item.value, Heartbeat)]
        states = {beat.node: beat.state for beat in heartbeats}
        if not states or any(state.is_on != test.is_on for state in states.values()):
            yield f"modules must be {test.description}, got {states}"
    sent: tuple[Frame, ...] = driver.send((NodeCommand(order=Order.CLEAR),))
    kinds = [(type(frame.message), frame.is_ours) for frame in sent]
    if kinds != [(NodeCommand, True)] or driver.bus_off:
        yield (
            f"`send` must return the frames that were sent, got {sent}; "
            f"it reports {driver.bus_off!r}"
        )


def _tests_of_motors(messages: Sequence[Any]) -> list[LimpTest]:
    """Return the tests that switch motors on, at the angles that the joints have."""
    angle_of = {
        message.node: message.angle for message in messages if isinstance(message, JointState)
    }
    references: tuple[CanMessage, ...] = ()
    if angle_of:
        references = encode_references([angle_of[node] for node in sorted(angle_of)])
    return [
        LimpTest(
            description="active with references",
            messages=(NodeCommand(order=Order.ENABLE), *references),
            duration=ENABLE_TIME,
            is_on=True,
        ),
        LimpTest(
            description="limp without references", messages=(), duration=LIMP_TIME, is_on=False
        ),
    ]


def _check_mocap(poses: Sequence[Any], duration: float) -> Iterator[str]:
    """Check the poses of one body: none is repeated, and all rotations are valid."""
    if all(pose.is_lost for pose in poses):
        yield "the body must be seen"
    if any(later.time <= earlier.time for earlier, later in pairwise(poses)):
        yield "the times of poses must increase"
    for pose in poses:
        if pose.rotation is not None and not _is_rotation(pose.rotation):
            yield (
                "rotation matrices must be orthonormal and right-handed, "
                f"got {pose.rotation.tolist()}"
            )
            return


def _is_rotation(matrix: np.ndarray) -> bool:
    is_orthonormal = np.allclose(matrix @ matrix.T, np.eye(3), atol=ROTATION_ERROR)
    return is_orthonormal and not np.linalg.det(matrix) < 0.0


def _check_meter(readings: Sequence[Any], duration: float) -> Iterator[str]:
    """Check that readings are finite numbers."""
    if not all(math.isfinite(reading.current) for reading in readings):
        yield f"readings must be finite, got {readings}"


def _check_stop(reasons: Sequence[Any], duration: float) -> Iterator[str]:
    """Check that there is no reason to stop."""
    if reasons:
        yield f"the contact must be closed for this test: {reasons[0]}"


def _check_sensors(samples: Sequence[Any], duration: float) -> Iterator[str]:
    """Check that every sensor is announced, and that the measurements of each come in order."""
    announced = {sample.sensor for sample in samples if not sample.has_values}
    latest: dict[str, float] = {}
    for sample in samples:
        if not sample.has_values:
            continue
        if sample.sensor not in announced:
            yield f"`{sample.sensor}` must first be announced, by a sample without values"
            return
        if sample.values.size != len(sample.columns):
            yield f"a sample of `{sample.sensor}` must have a value for each of its columns"
            return
        if sample.time <= latest.get(sample.sensor, -math.inf):
            yield f"the times of `{sample.sensor}` must increase"
            return
        latest[sample.sensor] = sample.time


Rule = Callable[[Sequence[Any], float], Iterator[str]]
RULES: Mapping[str, Rule] = {
    "bus": _check_bus,
    "mocap": _check_mocap,
    "meter": _check_meter,
    "stop": _check_stop,
    "sensors": _check_sensors,
}
"""Functions that yield what is wrong with the values that came from a driver, by its kind."""
