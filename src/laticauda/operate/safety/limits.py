"""What the operator knows about the joint modules, and what is wrong now: events of the supervisor's table.

Both are values with a pure step.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from laticauda.operate.settings import Limits
from laticauda.protocol import CanMessage, Heartbeat, JointState, NodeState

Numbers = Float[np.ndarray, " n_joints"]
MEASURED = ("angle", "rate", "current", "torque")  # by a module, of its joint


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
            beat is not None and beat.state.is_on and now - time <= timeout
            for beat, time in zip(self.heartbeat, self.heartbeat_time, strict=True)
        )

    def all_active(self) -> bool:
        """Whether every module follows its references."""
        return all(beat is not None and beat.state.is_on for beat in self.heartbeat)

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
    unknown, never = dict.fromkeys(MEASURED, np.full(n, np.nan)), np.full(n, -math.inf)
    return Modules(**unknown, angle_time=never, heartbeat=(None,) * n, heartbeat_time=never)


def updated(modules: Modules, messages: Iterable[tuple[float, CanMessage]]) -> Modules:
    """What is known after some more messages.

    Args:
        modules: Before.
        messages: When each came [s], and what; those of nodes that the robot does not have are ignored.
    """
    n = modules.n
    values = {name: getattr(modules, name).copy() for name in (*MEASURED, "angle_time")}
    beats, beat_times = list(modules.heartbeat), modules.heartbeat_time.copy()
    for time, message in messages:
        if isinstance(message, JointState) and message.node <= n:
            k = message.node - 1
            for name in MEASURED:
                values[name][k] = getattr(message, name)
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
            found.append(f"module {node} has {beat.temperature:.0f} degC, allowed: {max_temperature:.0f}; let it cool")
        if beat.voltage < min_voltage:
            found.append(f"module {node} has {beat.voltage:.1f} V, needed are {min_voltage:.1f}: check the supply")
    return tuple(found)


SPIN_UP = 1.0  # what modules may take to follow references after the first ones [s]


@dataclass(frozen=True, kw_only=True, eq=False)
class LimitState:
    """Since when something has been beyond its limit without a break; infinite: it is not."""

    current: Numbers
    """Motor currents, by joint [s]."""
    joint_error: Numbers
    """Joint errors, by joint [s]."""
    sending: float = math.inf
    """Since when references have been sent [s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Reports:
    """What the devices say at one tick."""

    now: float
    """[s]."""
    lateness: float
    """By how much this tick came too late [s]."""
    modules: Modules
    """The modules."""
    references: Numbers | None
    """Those of the last tick; None if none were sent [rad]."""
    mocap_age: float
    """Time since the cameras saw the robot last [s]."""
    meter_age: float | None
    """Time since the meter was read last; None without a meter [s]."""
    room: float
    """Distance to the edge that the robot swims to [m]."""


def within_limits(n_joints: int) -> LimitState:
    """Nothing is wrong yet.

    Args:
        n_joints: Of the robot, all axes.
    """
    never = np.full(n_joints, np.inf)
    return LimitState(current=never, joint_error=never)


def compare(limits: Limits, state: LimitState, reports: Reports) -> tuple[LimitState, dict[str, str]]:
    """Compare what the devices say with the limits, once a tick.

    Args:
        limits: What is accepted.
        state: As the last call returned it, or `within_limits`.
        reports: What the devices say.

    Returns:
        The state now, and what is wrong: events of the supervisor's table with a sentence each.
    """
    now, modules = reports.now, reports.modules
    is_high = np.abs(modules.current) > limits.max_current
    is_off = np.zeros(modules.n, dtype=bool)
    if reports.references is not None:
        is_off = np.abs(reports.references - modules.angle) > limits.max_joint_error
    sending = math.inf if reports.references is None else min(state.sending, now)
    after = LimitState(
        current=np.where(is_high, np.minimum(state.current, now), np.inf),
        joint_error=np.where(is_off, np.minimum(state.joint_error, now), np.inf),
        sending=sending,
    )
    # What a module says of itself tells more than what it does.
    found = {**_of_motors(after, reports, limits), **_of_modules(modules, limits, now)}
    if reports.lateness > limits.max_lateness:
        found["late_loop"] = f"a tick came {reports.lateness:.3f} s late"
    if reports.references is not None:
        if reports.mocap_age > limits.mocap_timeout:
            found["lost_mocap"] = f"the robot was seen {reports.mocap_age:.1f} s ago"
        if reports.room < limits.edge_margin:
            found["edge"] = f"{max(reports.room, 0.0):.2f} m are left to the edge"
    if reports.meter_age is not None and reports.meter_age > limits.meter_timeout:
        found["lost_meter"] = f"the meter was read {reports.meter_age:.1f} s ago"
    return after, found


def _of_modules(modules: Modules, limits: Limits, now: float) -> dict[str, str]:
    """What the heartbeats say, and those that stay away."""
    found: dict[str, str] = {}
    late = {
        "lost_heartbeat": modules.silent(now, limits.heartbeat_timeout),
        "lost_joints": np.flatnonzero(now - modules.angle_time > limits.joint_timeout) + 1,
    }
    found |= {event: f"module {', '.join(map(str, nodes))}" for event, nodes in late.items() if len(nodes)}
    for node, beat in enumerate(modules.heartbeat, start=1):
        if beat is None:
            continue
        if beat.leak:
            found.setdefault("leak", f"module {node}")
        if beat.over_temperature or beat.temperature > limits.max_temperature:
            found.setdefault("over_temperature", f"module {node}: {beat.temperature:.0f} degC")
        if beat.over_current:
            found.setdefault("over_current", f"module {node}")
        if beat.voltage < limits.min_voltage:
            found.setdefault("low_voltage", f"module {node}: {beat.voltage:.1f} V")
        if beat.voltage > limits.max_voltage:
            found.setdefault("high_voltage", f"module {node}: {beat.voltage:.1f} V")
        if beat.state == NodeState.FAULT:
            faults = [flag for flag in beat.faults if flag != "emergency_stopped"]  # that one we sent, or know already
            if faults:
                found.setdefault("module_fault", f"module {node}: {', '.join(faults).replace('_', ' ')}")
    return found


def _of_motors(state: LimitState, reports: Reports, limits: Limits) -> dict[str, str]:
    """What lasts: currents, errors, and modules that do not follow."""
    found: dict[str, str] = {}
    for k in np.flatnonzero(reports.now - state.current > limits.current_time):
        found.setdefault("over_current", f"module {k + 1}: {reports.modules.current[k]:.1f} A")
    for k in np.flatnonzero(reports.now - state.joint_error > limits.joint_error_time):
        assert reports.references is not None  # only then is there an error
        error = math.degrees(reports.references[k] - reports.modules.angle[k])
        found.setdefault("joint_error", f"module {k + 1}: {error:+.0f} deg")
    if reports.now - state.sending > SPIN_UP:
        for node, beat in enumerate(reports.modules.heartbeat, start=1):
            if beat is not None and not beat.state.is_on:
                found.setdefault("module_fault", f"module {node} does not move: {beat.state.name.lower()}")
    return found
