"""What the operator knows about the joint modules: the latest message of each, and when it came."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from jaxtyping import Float

from laticauda.protocol import CanMessage, Heartbeat, JointState, NodeState

MOVING = (NodeState.ACTIVE, NodeState.HOLD)
"""States in which the motor of a module is on."""
Numbers = Float[np.ndarray, " n_joints"]


@cache
def _unknown(n: int) -> Numbers:
    values = np.full(n, np.nan)
    values.flags.writeable = False
    return values


@dataclass(frozen=True, kw_only=True, eq=False)
class Modules:
    """The modules, tail first: entry k is CAN node k + 1. What has not been heard is nan or None."""

    angle: Numbers
    """phi [rad]."""
    rate: Numbers
    """phi' [rad/s]."""
    current: Numbers
    """Of the motor [A]."""
    torque: Numbers
    """[N m]."""
    angle_time: Numbers
    """When the angle came [s]."""
    heartbeat: tuple[Heartbeat | None, ...]
    """The last one of each."""
    heartbeat_time: Numbers
    """When it came; minus infinity before the first [s]."""

    @property
    def n(self) -> int:
        """How many there are [-]."""
        return len(self.heartbeat)

    @property
    def have_reported(self) -> bool:
        """Whether every module has sent a heartbeat and an angle."""
        return None not in self.heartbeat and bool(np.isfinite(self.angle).all())

    def is_limp(self, now: float, timeout: float) -> bool:
        """Whether every module that is heard says that its motor is off.

        Args:
            now: [s].
            timeout: A heartbeat that is older does not count [s].
        """
        return not any(
            beat is not None and beat.state in MOVING and now - time <= timeout
            for beat, time in zip(self.heartbeat, self.heartbeat_time, strict=True)
        )

    def all_active(self) -> bool:
        """Whether every module follows its references."""
        return all(beat is not None and beat.state in MOVING for beat in self.heartbeat)

    def silent(self, now: float, timeout: float) -> tuple[int, ...]:
        """The nodes that have sent no heartbeat for longer than `timeout`.

        Args:
            now: [s].
            timeout: [s].
        """
        return tuple(int(k) + 1 for k in np.flatnonzero(now - self.heartbeat_time > timeout))


def no_reports(n: int) -> Modules:
    """Before any message.

    Args:
        n: How many modules there are.
    """
    unknown = _unknown(n)
    return Modules(
        angle=unknown,
        rate=unknown,
        current=unknown,
        torque=unknown,
        angle_time=np.full(n, -math.inf),
        heartbeat=(None,) * n,
        heartbeat_time=np.full(n, -math.inf),
    )


def updated(modules: Modules, messages: Iterable[tuple[float, CanMessage]]) -> Modules:
    """What is known after some more messages.

    Args:
        modules: Before.
        messages: When each came [s], and what; those of nodes that the robot does not have are ignored.
    """
    n = modules.n
    values = {name: getattr(modules, name).copy() for name in ("angle", "rate", "current", "torque", "angle_time")}
    beats, beat_times = list(modules.heartbeat), modules.heartbeat_time.copy()
    for time, message in messages:
        if isinstance(message, JointState) and message.node <= n:
            k = message.node - 1
            values["angle"][k], values["rate"][k] = message.angle, message.rate
            values["current"][k], values["torque"][k] = message.current, message.torque
            values["angle_time"][k] = time
        elif isinstance(message, Heartbeat) and message.node <= n:
            beats[message.node - 1] = message
            beat_times[message.node - 1] = time
    return replace(modules, **values, heartbeat=tuple(beats), heartbeat_time=beat_times)


def complaints(modules: Modules, *, max_temperature: float, min_voltage: float) -> tuple[str, ...]:
    """What speaks against starting, module by module, in sentences that say what to look at.

    Args:
        modules: All of which have been heard.
        max_temperature: [degC].
        min_voltage: [V].
    """
    found: list[str] = []
    for node, beat in enumerate(modules.heartbeat, start=1):
        if beat is None:
            found.append(f"module {node} is not heard: check its power and its place on the bus")
            continue
        if beat.leak:
            found.append(f"module {node} reports water inside: take the robot out and dry it")
        if beat.state == NodeState.FAULT:
            flags = ", ".join(beat.faults).replace("_", " ") or "no flag"
            found.append(f"module {node} is in its fault state ({flags})")
        if beat.temperature > max_temperature:
            found.append(
                f"module {node} has {beat.temperature:.0f} degC, allowed are {max_temperature:.0f}: let it cool"
            )
        if beat.voltage < min_voltage:
            found.append(f"module {node} has {beat.voltage:.1f} V, needed are {min_voltage:.1f}: check the supply")
    return tuple(found)
