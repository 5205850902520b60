"""A driver alone: what comes from it, and whether it keeps to what `laticauda.operate.drivers.base` says of drivers.

The test of a driver's author is one line, with the device there, or its emulator; `absent` is an address of nothing:

    assert contract.broken("mocap", "mine@127.0.0.1:9870", absent="mine@127.0.0.1:1") == ()
"""

import math
import threading
import time
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from laticauda.operate.drivers.base import Clock, DeviceFailed, Frame
from laticauda.operate.settings import Connection
from laticauda.protocol import EmergencyStop, Heartbeat, JointState, NodeCommand, NodeState, Order, Sync, references

TICK = 0.01  # [s]
LONGEST = 0.05  # that a call of the loop may take [s]
LEAST_RATE = {"mocap": 1.0, "meter": 1.0}  # of what comes in [1/s]
LEAST_BEATS, LEAST_ANSWERS = 5.0, 20.0  # per second and node
LIMP_WITHIN = 1.5  # without references, or after an emergency stop [s]
END_WITHIN = 3.0  # of a driver's threads, after `close` [s]


class Heard(NamedTuple):
    """One thing that came from a driver."""

    what: str
    """Its kind, with the node."""
    time: float
    """When it came [s]."""
    value: Any
    """What the loop would get."""


def listen(driver: Any, clock: Clock, duration: float, *, messages: Any = ()) -> tuple[list[Heard], float]:
    """Do as the loop does for a while: ask for what there is, a hundred times a second; a bus gets a `Sync` each time.

    Args:
        driver: Of any kind, connected.
        clock: Its clock.
        duration: For how long [s].
        messages: For a bus: what is sent each time, before the `Sync`.

    Returns:
        What came, oldest first, and how long the longest call took [s].
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
        what = f"frame {one.identifier:#05x}" if node is None else f"{type(one.message).__name__} of node {node}"
        return Heard(what, one.time, one.message)
    if isinstance(one, tuple):
        arrival, pose = one
        return Heard("body not seen" if pose.is_lost else "body", arrival, pose)
    return Heard("reason to stop", now, one) if isinstance(one, str) else Heard("reading", one.time, one)


def broken(
    kind: str, device: str, *, absent: str = "", body: str = "", duration: float = 2.0, moves: bool = False
) -> tuple[str, ...]:
    """What a driver does not keep to, in sentences; none if it is well.

    Args:
        kind: One of `laticauda.operate.drivers.KINDS`.
        device: DRIVER@ADDRESS of the device that is there.
        absent: The same with an address where nothing is; "" leaves out that it is refused.
        body: For a motion capture: name of the body.
        duration: How long it is listened to [s].
        moves: For a bus: switch the motors on where the joints stand, too, and see them off again without references.
    """
    return tuple(_broken(Connection(mocap_body=body), kind, device, absent, duration, moves))


def _broken(usual: Connection, kind: str, device: str, absent: str, duration: float, moves: bool) -> Iterator[str]:
    threads, clock = set(threading.enumerate()), Clock()
    with usual.at(**{kind: device}).opened(kind, clock) as driver:
        found, longest = listen(driver, clock, duration)
        times = [one.time for one in found]
        if longest > LONGEST:
            yield f"a call of the loop took {longest:.3f} s"
        if len(found) < LEAST_RATE.get(kind, 0.0) * duration:
            yield f"{len(found)} items came in {duration:g} s"
        if times != sorted(times) or not all(0.0 < one <= clock.now() for one in times):
            yield "times of arrival must be those of the given clock, and grow"
        if driver.trouble:
            yield f"it has a trouble: {driver.trouble}"
        yield from RULES[kind](driver, clock, [one.value for one in found], duration, moves)
    driver.close()  # twice does no harm
    end = time.monotonic() + END_WITHIN
    while (left := set(threading.enumerate()) - threads) and time.monotonic() < end:
        time.sleep(TICK)
    if left:
        yield f"threads are left after `close`: {', '.join(sorted(thread.name for thread in left))}"
    with usual.at(**{kind: device}).opened(kind, clock):
        pass  # what was closed can be opened again
    if absent:
        try:
            usual.at(**{kind: absent}).opened(kind, clock).close()
            yield f"{absent} must be refused, with `DeviceFailed`"
        except DeviceFailed as error:
            if absent.rpartition("@")[2] not in str(error):
                yield f"the refusal must say the address: {error}"


def _bus(driver: Any, clock: Clock, found: list[Any], duration: float, moves: bool) -> Iterator[str]:
    """Every node answers and is well, and gets limp by an emergency stop."""
    nodes = {one.node for one in found if isinstance(one, JointState | Heartbeat)}
    if nodes != set(range(1, len(nodes) + 1)) or not nodes:
        yield f"the nodes must be 1, 2, ..., got {sorted(nodes)}"
    for kind, least in ((JointState, LEAST_ANSWERS), (Heartbeat, LEAST_BEATS)):
        for node in sorted(nodes):
            n = sum(isinstance(one, kind) and one.node == node for one in found)
            if n < least * duration:
                yield f"node {node} sent {n} {kind.__name__} in {duration:g} s"
    sent = driver.send((Sync(counter=0),))
    if [(type(one.message), one.is_ours) for one in sent] != [(Sync, True)] or driver.bus_off:
        yield f"`send` must give the frames that went out, got {sent}; it says {driver.bus_off!r}"
    angles = {one.node: one.angle for one in found if isinstance(one, JointState)}
    stop = (EmergencyStop(reason=2),)
    if moves and angles:
        held = references([angles[node] for node in sorted(angles)])
        on, _ = listen(driver, clock, 0.5, messages=(NodeCommand(order=Order.ENABLE), *held))
        if not _states(on) or any(state != NodeState.ACTIVE for state in _states(on).values()):
            yield f"modules must be active with references, got {_states(on)}"
        off, _ = listen(driver, clock, LIMP_WITHIN)
        if any(state.is_on for state in _states(off).values()):
            yield f"modules must be limp {LIMP_WITHIN:g} s after the last references, got {_states(off)}"
    after, _ = listen(driver, clock, LIMP_WITHIN, messages=stop)
    if any(state.is_on for state in _states(after).values()):
        yield f"modules must be limp after an emergency stop, got {_states(after)}"
    driver.send((NodeCommand(order=Order.CLEAR),))


def _states(found: list[Heard]) -> dict[int, NodeState]:
    """The last state of each node."""
    return {one.value.node: one.value.state for one in found if isinstance(one.value, Heartbeat)}


def _mocap(driver: Any, clock: Clock, found: list[Any], duration: float, moves: bool) -> Iterator[str]:
    """Poses of one body, none twice, with rotations that are some."""
    if all(pose.is_lost for pose in found):
        yield "the body must be seen"
    stamps = [pose.time for pose in found]
    if any(b <= a for a, b in zip(stamps, stamps[1:], strict=False)):
        yield "the times of poses must grow"
    for pose in found:
        turned = pose.rotation
        if turned is not None and not (
            np.allclose(turned @ turned.T, np.eye(3), atol=1e-3) and np.linalg.det(turned) > 0
        ):
            yield f"a rotation must be one, got {turned.tolist()}"
            return


def _meter(driver: Any, clock: Clock, found: list[Any], duration: float, moves: bool) -> Iterator[str]:
    """Currents that are numbers."""
    if not all(math.isfinite(reading.current) for reading in found):
        yield "currents must be finite"
    driver.restart()


def _stop(driver: Any, clock: Clock, found: list[Any], duration: float, moves: bool) -> Iterator[str]:
    """No reason to stop, as long as the contact is closed."""
    if found:
        yield f"the contact must be closed for this test: {found[0]}"


RULES = {"bus": _bus, "mocap": _mocap, "meter": _meter, "stop": _stop}
