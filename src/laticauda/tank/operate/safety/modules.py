"""What is known about the joint modules, from their messages; a value with a pure step."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from laticauda.tank.protocol import CanMessage, Heartbeat, JointState, NodeState

JointValues = Float[np.ndarray, " n_joints"]
MEASURED = ("angle", "rate", "current", "torque")
"""Quantities that a module measures at its joint."""
STARTING = {NodeState.STARTUP: "starting up", NodeState.CALIBRATING: "calibrating"}
"""States, in words, in which a module refuses zeros and torque, and does not know its angle yet."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Modules:
    """State of the modules, tail first: entry k is CAN node k + 1. Unknown values are nan or None."""

    angle: JointValues
    """Joint angles phi [rad]."""
    rate: JointValues
    """Joint rates phi' [rad/s]."""
    current: JointValues
    """Motor currents [A]."""
    torque: JointValues
    """Joint torques [N m]."""
    angle_time: JointValues
    """Times at which the angles arrived [s]."""
    heartbeat: tuple[Heartbeat | None, ...]
    """Last heartbeat of each module."""
    heartbeat_time: JointValues
    """Times at which they arrived; minus infinity before the first [s]."""
    highest: int = 0
    """Highest node heard, even beyond those of the robot [-]."""

    @classmethod
    def before_messages(cls, n: int) -> "Modules":
        """Return the state of the modules before any message.

        Args:
            n: Number of modules.
        """
        unknown = np.full(n, np.nan)
        never = np.full(n, -math.inf)
        return cls(
            angle=unknown,
            rate=unknown,
            current=unknown,
            torque=unknown,
            angle_time=never,
            heartbeat=(None,) * n,
            heartbeat_time=never,
        )

    @property
    def n(self) -> int:
        """Number of modules [-]."""
        return len(self.heartbeat)

    @property
    def unheard(self) -> tuple[int, ...]:
        """Nodes that have not sent both a heartbeat and an angle yet."""
        nodes: list[int] = []
        for node, (beat, angle) in enumerate(zip(self.heartbeat, self.angle, strict=True), start=1):
            if beat is None or not math.isfinite(angle):
                nodes.append(node)
        return tuple(nodes)

    def is_limp(self, now: float, timeout: float) -> bool:
        """Return whether every module that is heard reports that its motor is off.

        Args:
            now: Current time [s].
            timeout: Age beyond which a heartbeat does not count [s].
        """
        for beat, time in zip(self.heartbeat, self.heartbeat_time, strict=True):
            if beat is not None and beat.state.is_on and now - time <= timeout:
                return False
        return True

    def are_on(self) -> Bool[np.ndarray, " n_joints"]:
        """Return whether each module has reported that its motor is on, when it was last heard."""
        return np.array([beat is not None and beat.state.is_on for beat in self.heartbeat])

    def all_active(self) -> bool:
        """Return whether every module follows its references."""
        return bool(np.all(self.are_on()))

    def silent(self, now: float, timeout: float) -> tuple[int, ...]:
        """Return the nodes that have sent no heartbeat for longer than `timeout`.

        Args:
            now: Current time [s].
            timeout: Longest time between heartbeats [s].
        """
        return _nodes(now - self.heartbeat_time > timeout)

    def without_angle(self, now: float, timeout: float) -> tuple[int, ...]:
        """Return the nodes that have sent no angle for longer than `timeout`.

        Args:
            now: Current time [s].
            timeout: Longest time between angles [s].
        """
        return _nodes(now - self.angle_time > timeout)


def _nodes(is_concerned: Bool[np.ndarray, " n_joints"]) -> tuple[int, ...]:
    """Return the CAN nodes of these modules."""
    return tuple(int(k) + 1 for k in np.flatnonzero(is_concerned))


def update_modules(modules: Modules, messages: Iterable[tuple[float, CanMessage]]) -> Modules:
    """Return the state of the modules after some more messages.

    Args:
        modules: State before.
        messages: Arrival time [s] and content of each; nodes that the robot does not have only
            count for `highest`.
    """
    measured = {name: getattr(modules, name).copy() for name in MEASURED}
    angle_time = modules.angle_time.copy()
    heartbeats = list(modules.heartbeat)
    heartbeat_time = modules.heartbeat_time.copy()
    highest = modules.highest
    for time, message in messages:
        highest = max(highest, getattr(message, "node", 0))
        if isinstance(message, JointState) and message.node <= modules.n:
            k = message.node - 1
            for name in MEASURED:
                measured[name][k] = getattr(message, name)
            angle_time[k] = time
        elif isinstance(message, Heartbeat) and message.node <= modules.n:
            k = message.node - 1
            heartbeats[k] = message
            heartbeat_time[k] = time
    return replace(
        modules,
        **measured,
        angle_time=angle_time,
        heartbeat=tuple(heartbeats),
        heartbeat_time=heartbeat_time,
        highest=highest,
    )


def list_complaints(
    modules: Modules, *, max_temperature: float, min_voltage: float
) -> tuple[str, ...]:
    """Return the reasons not to start, module by module, as sentences that say what to check.

    Args:
        modules: The modules.
        max_temperature: Highest allowed temperature [degC].
        min_voltage: Lowest allowed voltage [V].
    """
    complaints: list[str] = []
    if modules.highest > modules.n:
        complaints.append(
            f"module {modules.highest} responds, but the robot has {modules.n}: check `robot`"
        )
    for node, beat in enumerate(modules.heartbeat, start=1):
        if beat is None:
            complaints.append(
                f"module {node} does not respond: check its power and its bus connection"
            )
            continue
        if beat.leak:
            complaints.append(f"module {node} reports water inside: take the robot out and dry it")
        if beat.state in STARTING:
            complaints.append(f"module {node} is still {STARTING[beat.state]}: wait, or restart it")
        if beat.state == NodeState.FAULT:
            flags = ", ".join(beat.faults).replace("_", " ") or "no flag"
            complaints.append(f"module {node} is in its fault state ({flags})")
        if beat.temperature > max_temperature:
            complaints.append(
                f"module {node} is at {beat.temperature:.0f} degC, limit {max_temperature:.0f}: "
                "let it cool"
            )
        if beat.voltage < min_voltage:
            complaints.append(
                f"module {node} has {beat.voltage:.1f} V, but needs {min_voltage:.1f}: "
                "check the supply"
            )
    return tuple(complaints)
