"""Tests of a single driver: what comes from it, and whether it obeys the rules of `drivers.base`.

A driver's test is one line, with the device or its emulator connected; `absent` is an address
without a device:

    assert contract.broken("mocap", "mine@127.0.0.1:9870", absent="mine@127.0.0.1:1") == ()
"""

import math
import threading
import time
from collections.abc import Iterator
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from laticauda.tank.operate.drivers.base import Clock, DeviceFailed, Frame
from laticauda.tank.operate.recording.entries import PowerReading
from laticauda.tank.operate.settings import Connection
from laticauda.tank.protocol import (
    EmergencyStop,
    Heartbeat,
    JointState,
    NodeCommand,
    Order,
    Sync,
    encode_references,
)

TICK = 0.01  # [s]
LONGEST = 0.05  # time that a call of the loop may take [s]
LEAST_BEATS, LEAST_ANSWERS = 5.0, 20.0  # per second and node
LIMP_WITHIN = 1.5  # without references, or after an emergency stop [s]
END_WITHIN = 3.0  # time in which a driver's threads must end after `close` [s]


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
    """Act as the loop for a while: call `receive` a hundred times a second; a bus is sent a `Sync` each time.

    Args:
        driver: Connected driver of any kind.
        clock: Clock of the driver.
        duration: How long to listen [s].
        messages: For a bus: messages to send each time, before the `Sync`.

    Returns:
        The items received, oldest first, and the duration of the longest call [s].
    """
    found: list[Heard] = []
    longest, begun = 0.0, time.monotonic()
    while (now := time.monotonic()) < begun + duration:
        if hasattr(driver, "send"):
            driver.send((*messages, Sync(counter=int((now - begun) / TICK) % 65536)))
        came = driver.receive()
        longest = max(longest, time.monotonic() - now)
        found += [_heard(one, clock.now()) for one in came]
        time.sleep(TICK)
    return found, longest


def _heard(one: Any, now: float) -> Heard:
    if isinstance(one, Frame):
        node = getattr(one.message, "node", None)
        what = (
            f"frame {one.identifier:#05x}"
            if node is None
            else f"{type(one.message).__name__} of node {node}"
        )
        return Heard(what, one.time, one.message)
    if isinstance(one, PowerReading):
        return Heard("reading", one.time, one)
    if isinstance(one, str):
        return Heard("reason to stop", now, one)
    return Heard("body not seen" if one[1].is_lost else "body", *one)


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
    threads, clock, found = set(threading.enumerate()), Clock(), list[str]()
    there = Connection(mocap_body=body).at(**{kind: device})
    with there.opened(kind, clock) as driver:
        heard, longest = listen(driver, clock, duration)
        times, values = [one.time for one in heard], [one.value for one in heard]
        right = times == sorted(times) and all(0.0 < one <= clock.now() for one in times)
        found += [] if right else ["arrival times must be on the given clock, and increase"]
        found += [f"a call of the loop took {longest:.3f} s"] if longest > LONGEST else []
        found += [f"it reports: {driver.trouble}"] if driver.trouble else []
        few = kind in ("mocap", "meter") and len(values) < math.floor(duration)
        found += (
            [f"{len(values)} items came in {duration:g} s"]
            if few
            else RULES[kind](values, duration)
        )
        if kind == "bus":
            found += _limp(driver, clock, values, moves)
        elif kind == "meter":
            driver.restart()
    driver.close()  # closing twice does no harm
    there.opened(kind, clock).close()  # a closed driver can be opened again
    end = time.monotonic() + END_WITHIN
    while (left := set(threading.enumerate()) - threads) and time.monotonic() < end:
        time.sleep(TICK)
    found += (
        [f"threads are left after `close`: {', '.join(thread.name for thread in left)}"]
        if left
        else []
    )
    try:
        if absent:
            there.at(**{kind: absent}).opened(kind, clock).close()
            found.append(f"{absent} must be refused, with `DeviceFailed`")
    except DeviceFailed as error:
        found += (
            []
            if absent.rpartition("@")[2] in str(error)
            else [f"the error must name the address: {error}"]
        )
    return tuple(found)


def _bus(found: list[Any], duration: float) -> Iterator[str]:
    """Check that every node answers and sends heartbeats."""
    nodes = sorted({one.node for one in found if isinstance(one, JointState | Heartbeat)})
    if not nodes or nodes != list(range(1, len(nodes) + 1)):
        yield f"the nodes must be 1, 2, ..., got {nodes}"
    for kind, least in ((JointState, LEAST_ANSWERS), (Heartbeat, LEAST_BEATS)):
        counts = [
            sum(isinstance(one, kind) and one.node == node for one in found) for node in nodes
        ]
        if min(counts, default=0) < least * duration:
            yield f"every node must send {least:g} {kind.__name__} a second, got {counts} in {duration:g} s"


def _limp(driver: Any, clock: Clock, found: list[Any], moves: bool) -> Iterator[str]:
    """Check that modules are limp without references, and after an emergency stop."""
    angles = {one.node: one.angle for one in found if isinstance(one, JointState)}
    held = encode_references([angles[node] for node in sorted(angles)]) if angles else ()
    steps = [
        ("active with references", (NodeCommand(order=Order.ENABLE), *held), 0.5, True),
        ("limp without references", (), LIMP_WITHIN, False),
        ("limp after an emergency stop", (EmergencyStop(reason=2),), LIMP_WITHIN, False),
    ]
    for what, messages, duration, is_on in steps if moves else steps[-1:]:
        heard, _ = listen(driver, clock, duration, messages=messages)
        states = {
            one.value.node: one.value.state for one in heard if isinstance(one.value, Heartbeat)
        }
        if not states or any(state.is_on != is_on for state in states.values()):
            yield f"modules must be {what}, got {states}"
    sent = driver.send((NodeCommand(order=Order.CLEAR),))
    if [(type(one.message), one.is_ours) for one in sent] != [
        (NodeCommand, True)
    ] or driver.bus_off:
        yield f"`send` must return the frames that were sent, got {sent}; it reports {driver.bus_off!r}"


def _mocap(found: list[Any], duration: float) -> Iterator[str]:
    """Check the poses of one body: none is repeated, and all rotations are valid."""
    if all(pose.is_lost for pose in found):
        yield "the body must be seen"
    if any(after.time <= before.time for before, after in pairwise(found)):
        yield "the times of poses must increase"
    for turned in (pose.rotation for pose in found if pose.rotation is not None):
        if not np.allclose(turned @ turned.T, np.eye(3), atol=1e-3) or np.linalg.det(turned) < 0.0:
            yield f"rotation matrices must be orthonormal and right-handed, got {turned.tolist()}"
            return


def _others(found: list[Any], duration: float) -> Iterator[str]:
    """Check that readings are finite numbers, and that there is no reason to stop."""
    reasons = [one for one in found if isinstance(one, str)]
    if reasons:
        yield f"the contact must be closed for this test: {reasons[0]}"
    elif not all(math.isfinite(reading.current) for reading in found):
        yield f"readings must be finite, got {found}"


RULES = {"bus": _bus, "mocap": _mocap, "meter": _others, "stop": _others}
