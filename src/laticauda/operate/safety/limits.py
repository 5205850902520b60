"""What is wrong now: from what the devices say to the events of the supervisor's table. A value and a pure step."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from laticauda.operate.safety.modules import MOVING, Modules
from laticauda.operate.settings import Limits
from laticauda.protocol import NodeState

Numbers = Float[np.ndarray, " n_joints"]
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
    silent = modules.silent(now, limits.heartbeat_timeout)
    if silent:
        found["lost_heartbeat"] = f"module {_listed(silent)}"
    old = tuple(int(k) + 1 for k in np.flatnonzero(now - modules.angle_time > limits.joint_timeout))
    if old:
        found["lost_joints"] = f"module {_listed(old)}"
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
            if beat is not None and beat.state not in MOVING:
                found.setdefault("module_fault", f"module {node} does not move: {beat.state.name.lower()}")
    return found


def _listed(nodes: tuple[int, ...]) -> str:
    return ", ".join(map(str, nodes))
