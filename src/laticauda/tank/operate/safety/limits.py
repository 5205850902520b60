"""What is wrong now, as events of the supervisor's table; a value with a pure step."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool

from laticauda.tank.operate.safety.modules import JointValues, Modules
from laticauda.tank.operate.safety.supervisor import LIMP_FROM
from laticauda.tank.operate.settings import Limits
from laticauda.tank.protocol import Heartbeat, NodeState

SPIN_UP = 1.0
"""Time within which modules must follow references after the first ones [s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LimitState:
    """Times since which values have exceeded their limits without a break.

    Infinite: they do not.
    """

    current: JointValues
    """Motor currents, by joint [s]."""
    joint_error: JointValues
    """Joint errors, by joint [s]."""
    sending: float = math.inf
    """Time since which references have been sent [s]."""
    has_been_on: Bool[np.ndarray, " n_joints"]
    """Whether each module has reported that its motor is on since references have been sent [-]."""

    @classmethod
    def initial(cls, n_joints: int) -> "LimitState":
        """Return the initial state, in which nothing is wrong yet.

        Args:
            n_joints: Number of the driven joints.
        """
        never = np.full(n_joints, np.inf)
        return cls(current=never, joint_error=never, has_been_on=np.zeros(n_joints, dtype=bool))


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
    references: JointValues | None
    """References of the last tick; None if none were sent [rad]."""
    mocap_age: float
    """Time since the cameras last saw the robot [s]."""
    meter_age: float | None
    """Time since the meter was last read; None without a meter [s]."""
    room: float
    """Distance to the edge that the robot swims toward [m]."""


def compare_with_limits(
    limits: Limits, state: LimitState, reports: Reports
) -> tuple[LimitState, dict[str, str]]:
    """Compare what the devices report with the limits, once per tick.

    Args:
        limits: Limits of what is accepted.
        state: State returned by the last call, or `LimitState.initial`.
        reports: What the devices report.

    Returns:
        The new state, and what is wrong: events of the supervisor's table, each with a sentence.
    """
    state = _update(limits, state, reports)
    # What a module reports about itself says more than what it does, and takes its place.
    events = {
        **_events_of_motors(limits, state, reports),
        **_events_of_modules(limits, reports.modules, reports.now),
    }
    limp = _describe_limp_modules(state, reports)
    if limp:
        events["went_limp"] = limp
    if reports.lateness > limits.max_lateness:
        events["late_loop"] = f"a tick came {reports.lateness:.3f} s late"
    if reports.references is not None:
        if reports.mocap_age > limits.mocap_timeout:
            events["lost_mocap"] = f"the robot was last seen {reports.mocap_age:.1f} s ago"
        if reports.room < limits.edge_margin:
            events["edge"] = f"{max(reports.room, 0.0):.2f} m left to the edge"
    if reports.meter_age is not None and reports.meter_age > limits.meter_timeout:
        events["lost_meter"] = f"the meter was last read {reports.meter_age:.1f} s ago"
    return state, events


def _update(limits: Limits, state: LimitState, reports: Reports) -> LimitState:
    """Return since when values have exceeded their limits, after one more tick."""
    now = reports.now
    modules = reports.modules
    is_current_high = np.abs(modules.current) > limits.max_current
    current = np.where(is_current_high, np.minimum(state.current, now), np.inf)
    if reports.references is None:
        idle = LimitState.initial(modules.n)
        return LimitState(
            current=current,
            joint_error=idle.joint_error,
            sending=idle.sending,
            has_been_on=idle.has_been_on,
        )
    is_off = np.abs(reports.references - modules.angle) > limits.max_joint_error
    return LimitState(
        current=current,
        joint_error=np.where(is_off, np.minimum(state.joint_error, now), np.inf),
        sending=min(state.sending, now),
        has_been_on=state.has_been_on | modules.are_on(),
    )


def _events_of_modules(limits: Limits, modules: Modules, now: float) -> dict[str, str]:
    """Return what the heartbeats report, and which are missing."""
    events: dict[str, str] = {}
    silent = modules.silent(now, limits.heartbeat_timeout)
    if silent:
        events["lost_heartbeat"] = _name_modules(silent)
    without_angle = modules.without_angle(now, limits.joint_timeout)
    if without_angle:
        events["lost_joints"] = _name_modules(without_angle)
    for node, beat in enumerate(modules.heartbeat, start=1):
        if beat is not None:
            for event, description in _events_of_heartbeat(limits, node, beat).items():
                events.setdefault(event, description)  # the first module is named
    return events


def _events_of_heartbeat(limits: Limits, node: int, beat: Heartbeat) -> dict[str, str]:
    """Return what one module reports about itself."""
    events: dict[str, str] = {}
    if beat.leak:
        events["leak"] = f"module {node}"
    if beat.over_temperature or beat.temperature > limits.max_temperature:
        events["over_temperature"] = f"module {node}: {beat.temperature:.0f} degC"
    if beat.over_current:
        events["over_current"] = f"module {node}"
    if beat.voltage < limits.min_voltage:
        events["low_voltage"] = f"module {node}: {beat.voltage:.1f} V"
    if beat.voltage > limits.max_voltage:
        events["high_voltage"] = f"module {node}: {beat.voltage:.1f} V"
    if beat.state == NodeState.FAULT:
        # An emergency stop was sent by us, or is known already.
        faults = [flag for flag in beat.faults if flag != "emergency_stopped"]
        if faults:
            events["module_fault"] = f"module {node}: {', '.join(faults).replace('_', ' ')}"
    return events


def _events_of_motors(limits: Limits, state: LimitState, reports: Reports) -> dict[str, str]:
    """Return what has lasted too long: currents, errors, and modules that do not follow."""
    events: dict[str, str] = {}
    modules = reports.modules
    for k in np.flatnonzero(reports.now - state.current > limits.current_time):
        events.setdefault("over_current", f"module {k + 1}: {modules.current[k]:.1f} A")
    for k in np.flatnonzero(reports.now - state.joint_error > limits.joint_error_time):
        assert reports.references is not None  # otherwise there is no error
        error = math.degrees(reports.references[k] - modules.angle[k])
        events.setdefault("joint_error", f"module {k + 1}: {error:+.0f} deg")
    if reports.now - state.sending > SPIN_UP:
        for k in np.flatnonzero(~state.has_been_on):
            beat = modules.heartbeat[k]
            if beat is not None:
                events.setdefault(
                    "module_fault", f"module {k + 1} does not move: {beat.state.name.lower()}"
                )
    return events


def _describe_limp_modules(state: LimitState, reports: Reports) -> str:
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
        return _name_modules(nodes.tolist())
    return ""


def _name_modules(nodes: Sequence[int]) -> str:
    return f"module {', '.join(map(str, nodes))}"
