"""What is known about the joint modules, and what is wrong now, as events of the supervisor's table.

Both are values with a pure step.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from laticauda.tank.operate.safety.supervisor import LIMP_FROM
from laticauda.tank.operate.settings import Limits
from laticauda.tank.protocol import CanMessage, Heartbeat, JointState, NodeState

Numbers = Float[np.ndarray, " n_joints"]
MEASURED = ("angle", "rate", "current", "torque")  # quantities that a module measures at its joint


@dataclass(frozen=True, kw_only=True, eq=False)
class Modules:
    """State of the modules, tail first: entry k is CAN node k + 1. Unknown values are nan or None."""

    angle: Numbers
    """Joint angles phi [rad]."""
    rate: Numbers
    """Joint rates phi' [rad/s]."""
    current: Numbers
    """Motor currents [A]."""
    torque: Numbers
    """Joint torques [N m]."""
    angle_time: Numbers
    """Times at which the angles arrived [s]."""
    heartbeat: tuple[Heartbeat | None, ...]
    """Last heartbeat of each module."""
    heartbeat_time: Numbers
    """Times at which they arrived; minus infinity before the first [s]."""
    highest: int = 0
    """Highest node heard, even beyond those of the robot [-]."""

    @property
    def n(self) -> int:
        """Number of modules [-]."""
        return len(self.heartbeat)

    @property
    def unheard(self) -> tuple[int, ...]:
        """Nodes that have not sent both a heartbeat and an angle yet."""
        heard = zip(self.heartbeat, self.angle, strict=True)
        return tuple(
            k
            for k, (beat, angle) in enumerate(heard, 1)
            if beat is None or not math.isfinite(angle)
        )

    def is_limp(self, now: float, timeout: float) -> bool:
        """Return whether every module that is heard reports that its motor is off.

        Args:
            now: Current time [s].
            timeout: Age beyond which a heartbeat does not count [s].
        """
        return not any(
            beat is not None and beat.state.is_on and now - time <= timeout
            for beat, time in zip(self.heartbeat, self.heartbeat_time, strict=True)
        )

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
        return tuple(int(k) + 1 for k in np.flatnonzero(now - self.heartbeat_time > timeout))


def no_reports(n: int) -> Modules:
    """Return the state of the modules before any message.

    Args:
        n: Number of modules.
    """
    unknown, never = dict.fromkeys(MEASURED, np.full(n, np.nan)), np.full(n, -math.inf)
    return Modules(**unknown, angle_time=never, heartbeat=(None,) * n, heartbeat_time=never)


def updated(modules: Modules, messages: Iterable[tuple[float, CanMessage]]) -> Modules:
    """Return the state of the modules after some more messages.

    Args:
        modules: State before.
        messages: Arrival time [s] and content of each; nodes that the robot does not have only
            count for `highest`.
    """
    n = modules.n
    values = {name: getattr(modules, name).copy() for name in (*MEASURED, "angle_time")}
    beats, beat_times, highest = (
        list(modules.heartbeat),
        modules.heartbeat_time.copy(),
        modules.highest,
    )
    for time, message in messages:
        highest = max(highest, getattr(message, "node", 0))
        if isinstance(message, JointState) and message.node <= n:
            k = message.node - 1
            for name in MEASURED:
                values[name][k] = getattr(message, name)
            values["angle_time"][k] = time
        elif isinstance(message, Heartbeat) and message.node <= n:
            beats[message.node - 1] = message
            beat_times[message.node - 1] = time
    return replace(
        modules, **values, heartbeat=tuple(beats), heartbeat_time=beat_times, highest=highest
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
    found: list[str] = []
    if modules.highest > modules.n:
        found.append(
            f"module {modules.highest} responds, but the robot has {modules.n}: check `robot`"
        )
    for node, beat in enumerate(modules.heartbeat, start=1):
        if beat is None:
            found.append(f"module {node} does not respond: check its power and its bus connection")
            continue
        if beat.leak:
            found.append(f"module {node} reports water inside: take the robot out and dry it")
        if beat.state == NodeState.FAULT:
            flags = ", ".join(beat.faults).replace("_", " ") or "no flag"
            found.append(f"module {node} is in its fault state ({flags})")
        if beat.temperature > max_temperature:
            found.append(
                f"module {node} is at {beat.temperature:.0f} degC, limit {max_temperature:.0f}: let it cool"
            )
        if beat.voltage < min_voltage:
            found.append(
                f"module {node} has {beat.voltage:.1f} V, but needs {min_voltage:.1f}: check the supply"
            )
    return tuple(found)


SPIN_UP = 1.0  # time within which modules must follow references after the first ones [s]


@dataclass(frozen=True, kw_only=True, eq=False)
class LimitState:
    """Times since which values have exceeded their limits without a break; infinite: they do not."""

    current: Numbers
    """Motor currents, by joint [s]."""
    joint_error: Numbers
    """Joint errors, by joint [s]."""
    sending: float = math.inf
    """Time since which references have been sent [s]."""
    has_been_on: Bool[np.ndarray, " n_joints"]
    """Whether each module has reported that its motor is on since references have been sent [-]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Reports:
    """What the devices report at one tick."""

    now: float
    """Current time [s]."""
    lateness: float
    """Lateness of this tick [s]."""
    pause: float
    """Time since the last tick, thus since the modules last heard from us [s]."""
    modules: Modules
    """State of the modules."""
    references: Numbers | None
    """References of the last tick; None if none were sent [rad]."""
    mocap_age: float
    """Time since the cameras last saw the robot [s]."""
    meter_age: float | None
    """Time since the meter was last read; None without a meter [s]."""
    room: float
    """Distance to the edge that the robot swims toward [m]."""


def within_limits(n_joints: int) -> LimitState:
    """Return the initial state, in which nothing is wrong yet.

    Args:
        n_joints: Number of the driven joints.
    """
    never = np.full(n_joints, np.inf)
    return LimitState(current=never, joint_error=never, has_been_on=np.zeros(n_joints, dtype=bool))


def compare(
    limits: Limits, state: LimitState, reports: Reports
) -> tuple[LimitState, dict[str, str]]:
    """Compare what the devices report with the limits, once per tick.

    Args:
        limits: Limits of what is accepted.
        state: State returned by the last call, or by `within_limits`.
        reports: What the devices report.

    Returns:
        The new state, and what is wrong: events of the supervisor's table, each with a sentence.
    """
    now, modules = reports.now, reports.modules
    is_high = np.abs(modules.current) > limits.max_current
    is_off = np.zeros(modules.n, dtype=bool)
    if reports.references is not None:
        is_off = np.abs(reports.references - modules.angle) > limits.max_joint_error
    sending, has_been_on = math.inf, np.zeros(modules.n, dtype=bool)
    if reports.references is not None:
        sending, has_been_on = min(state.sending, now), state.has_been_on | modules.are_on()
    after = LimitState(
        current=np.where(is_high, np.minimum(state.current, now), np.inf),
        joint_error=np.where(is_off, np.minimum(state.joint_error, now), np.inf),
        sending=sending,
        has_been_on=has_been_on,
    )
    # What a module reports about itself says more than what it does.
    found = {**_of_motors(after, reports, limits), **_of_modules(modules, limits, now)}
    why = _gone_limp(after, reports)
    if why:
        found["went_limp"] = why
    if reports.lateness > limits.max_lateness:
        found["late_loop"] = f"a tick came {reports.lateness:.3f} s late"
    if reports.references is not None:
        if reports.mocap_age > limits.mocap_timeout:
            found["lost_mocap"] = f"the robot was last seen {reports.mocap_age:.1f} s ago"
        if reports.room < limits.edge_margin:
            found["edge"] = f"{max(reports.room, 0.0):.2f} m left to the edge"
    if reports.meter_age is not None and reports.meter_age > limits.meter_timeout:
        found["lost_meter"] = f"the meter was last read {reports.meter_age:.1f} s ago"
    return after, found


def _of_modules(modules: Modules, limits: Limits, now: float) -> dict[str, str]:
    """Return what the heartbeats report, and which are missing."""
    found: dict[str, str] = {}
    late = {
        "lost_heartbeat": modules.silent(now, limits.heartbeat_timeout),
        "lost_joints": np.flatnonzero(now - modules.angle_time > limits.joint_timeout) + 1,
    }
    found |= {
        event: f"module {', '.join(map(str, nodes))}" for event, nodes in late.items() if len(nodes)
    }
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
            faults = [
                flag for flag in beat.faults if flag != "emergency_stopped"
            ]  # sent by us, or known already
            if faults:
                found.setdefault(
                    "module_fault", f"module {node}: {', '.join(faults).replace('_', ' ')}"
                )
    return found


def _of_motors(state: LimitState, reports: Reports, limits: Limits) -> dict[str, str]:
    """Return what has lasted too long: currents, errors, and modules that do not follow."""
    found: dict[str, str] = {}
    for k in np.flatnonzero(reports.now - state.current > limits.current_time):
        found.setdefault("over_current", f"module {k + 1}: {reports.modules.current[k]:.1f} A")
    for k in np.flatnonzero(reports.now - state.joint_error > limits.joint_error_time):
        assert reports.references is not None  # otherwise there is no error
        error = math.degrees(reports.references[k] - reports.modules.angle[k])
        found.setdefault("joint_error", f"module {k + 1}: {error:+.0f} deg")
    if reports.now - state.sending > SPIN_UP:
        for k in np.flatnonzero(~state.has_been_on):
            beat = reports.modules.heartbeat[k]
            if beat is not None:
                found.setdefault(
                    "module_fault", f"module {k + 1} does not move: {beat.state.name.lower()}"
                )
    return found


def _gone_limp(state: LimitState, reports: Reports) -> str:
    """Return why modules count as limp although references are being sent; "" if they do not.

    A module that has never been on since references are sent has not gone limp: it is being switched
    on. If we were away for longer than modules wait for references, they are limp whatever they last
    said.
    """
    if reports.references is None:
        return ""
    if reports.pause > LIMP_FROM:
        return f"they had no references for {reports.pause:.1f} s"
    nodes = np.flatnonzero(state.has_been_on & ~reports.modules.are_on()) + 1
    if nodes.size:
        return f"module {', '.join(map(str, nodes))}"
    return ""
