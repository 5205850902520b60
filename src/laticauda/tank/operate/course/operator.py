"""One operation as a pure tick: from inputs and time to outputs, without clock, bus or threads.

`safety.supervisor` has the table of its phases and of the supervisor's states; `preparing` has the
phases before the run.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from laticauda.control.estimation import Estimator, KinematicEstimator
from laticauda.models.dynamics.plant import Plant
from laticauda.robot import Robot
from laticauda.tank.operate.course import preparing
from laticauda.tank.operate.course.reference_source import ReferenceSource
from laticauda.tank.operate.course.state import Inputs, OperatorState, Outputs, Prepared, take_in
from laticauda.tank.operate.recording.entries import Decision, Entry, Event
from laticauda.tank.operate.safety.limits import Reports, compare, no_reports, within_limits
from laticauda.tank.operate.safety.supervisor import (
    BY_EVENT,
    Reaction,
    Supervisor,
    cause_of,
    phase_after,
    phase_with,
)
from laticauda.tank.operate.settings import Operation
from laticauda.tank.protocol import (
    CanMessage,
    EmergencyStop,
    NodeCommand,
    Order,
    Sync,
    encode_references,
)

REPEAT = 0.1
"""Time after which orders that are not yet obeyed are repeated [s]."""
SYNC_COUNTS = 65536
"""Number of the values that the counter of a Sync has."""
STRAIGHT_SHARE = 0.7
"""Share of the straightening time in which the references move; then the joints catch up."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Operator:
    """Everything that an operation needs except its devices.

    Raises:
        ValueError: If the robot's joints cannot do what the controller may command.
    """

    operation: Operation
    """Operation to run."""
    clears: bool = False
    """Whether to clear faults of the modules first, which somebody has inspected."""
    check_only: bool = False
    """Whether to stop after the preparations, with the robot limp all the time."""
    twin: Plant[Any] | None = None
    """Twin that runs along as the filter's motion model; None: the filter has no model of the water."""

    @cached_property
    def robot(self) -> Robot:
        """The robot."""
        return self.operation.body()

    @cached_property
    def supervisor(self) -> Supervisor:
        """The safety supervisor."""
        return Supervisor(straighten_time=self.operation.limits.straighten_time)

    @cached_property
    def reference_source(self) -> ReferenceSource:
        """The source of references, from observations."""
        how = self.operation
        filters = {"ramp": how.ramp, "offset_bandwidth": how.offset_bandwidth}
        return ReferenceSource(robot=self.robot, controller=how.controller(), **filters)

    @cached_property
    def estimator(self) -> Estimator | KinematicEstimator:
        """The state estimation."""
        mount = self.operation.calibration.mount
        if self.operation.estimator == "kinematics" or self.operation.in_space:
            return KinematicEstimator(
                robot=self.robot, mount=mount, in_space=self.operation.in_space
            )
        lost_after = self.operation.limits.mocap_timeout
        return Estimator(robot=self.robot, mount=mount, plant=self.twin, lost_after=lost_after)

    def init(self) -> OperatorState:
        """Return the state before the first tick."""
        n = len(self.robot.driven_joints)
        return OperatorState(
            supervisor=self.supervisor.init(),
            limits=within_limits(n),
            modules=no_reports(n),
            estimator=self.estimator.init(),
            reference=self.reference_source.init(),
            prepared=Prepared(),
        )

    def tick(
        self, state: OperatorState, now: float, inputs: Inputs
    ) -> tuple[OperatorState, Outputs]:
        """Perform one tick.

        Args:
            state: State returned by the last call, or by `init`.
            now: Time on our clock, later than at the last tick [s].
            inputs: Data received since the last tick.

        Returns:
            The new state, and the outputs.
        """
        before = state
        state = state if state.since is not None else replace(state, since=now)
        state, samples = take_in(self.operation, self.estimator, state, now, inputs)
        state, wrong = self._monitored(state, before, now, inputs)
        state, events = self._prepared(state, now)
        state, requests = self._requested(state, now)
        state, reacted = self._supervised(state, now, wrong, requests)
        state = self._with_references(state, now)
        state, messages = self._with_orders(state, before.supervisor.torque, now)
        found: list[Entry] = list(samples)
        if state.estimate is not None:
            found.append(state.estimate)
            if (
                state.reference.n_decisions > before.reference.n_decisions
                and state.reference.command is not None
            ):
                signals = self.reference_source.signals(state.reference)
                found.append(
                    Decision(
                        time=state.estimate.time, command=state.reference.command, signals=signals
                    )
                )
        found += (
            *events,
            *(_event(entry, wrong) for entry in reacted),
            *_milestones(before, state, now),
            *_torque_events(before, state, messages, now),
        )
        return replace(state, now=now), Outputs(messages=messages, entries=tuple(found))

    def _monitored(
        self, state: OperatorState, before: OperatorState, now: float, inputs: Inputs
    ) -> tuple[OperatorState, dict[str, str]]:
        """Find what is wrong now, by event."""
        tank, found = self.operation.tank, dict(inputs.events)
        room = float("inf")
        if state.estimate is not None and state.phase == "running":
            velocity = state.estimate.center_of_mass_velocity
            velocity = tank.to_tank(velocity) - tank.to_tank(np.zeros_like(velocity))
            room = tank.room(tank.to_tank(state.estimate.center_of_mass), velocity)
        sent = before.supervisor.sends_references
        started = state.since if state.since is not None else now
        pause = 0.0 if before.now is None else now - before.now
        reports = Reports(
            now=now,
            lateness=0.0 if before.now is None else pause - 1.0 / self.operation.rate,
            pause=pause,
            modules=state.modules,
            references=state.reference.references if sent else None,
            mocap_age=now - (started if state.frame_time is None else state.frame_time),
            meter_age=None if state.reading is None else now - state.reading.time,
            room=room,
        )
        limits, wrong = compare(self.operation.limits, state.limits, reports)
        if state.phase in ("connecting", "checking"):
            wrong = {}  # the checks report it better
        if not sent:
            wrong.pop("late_loop", None)
        error = state.error or before.error  # that of the controller is from the last tick
        if error:
            found["program_error"] = error
        if (
            state.phase == "running"
            and "lost_meter" in wrong
            and "lost_meter" not in state.supervisor.present
        ):
            state = replace(state, notes=(*state.notes, f"lost_meter: {wrong['lost_meter']}"))
        return replace(state, limits=limits), {**wrong, **found}

    def _prepared(self, state: OperatorState, now: float) -> preparing.Answer:
        """Perform one tick of the preparations, as far as they are to go."""
        state, events = preparing.step(self.operation, state, now)
        if self.check_only and state.phase == "settling":
            state = replace(state, phase=phase_after("settling", "only_checked"))
        return state, events

    def _requested(self, state: OperatorState, now: float) -> tuple[OperatorState, tuple[str, ...]]:
        """Return the requests of normal operation, and those for giving up before the run."""
        gone = 0.0 if state.since is None else now - state.since
        if state.failure and state.phase not in ("stopping", "done"):
            return replace(state, phase=phase_after(state.phase, "ended"), since=now), ("ended",)
        if state.phase == "settling" and state.supervisor.state == "idle":
            return state, ("checked",)
        if state.phase == "countdown" and gone >= self.operation.countdown:
            return state, ("started",)
        if (
            state.phase == "running"
            and state.begun is not None
            and now - state.begun >= self.operation.duration
        ):
            return state, ("ended",)
        return state, ()

    def _supervised(
        self, state: OperatorState, now: float, wrong: Mapping[str, str], requests: tuple[str, ...]
    ) -> tuple[OperatorState, tuple[Reaction, ...]]:
        """Perform the supervisor's step, and apply its consequences."""
        limits, modules, before = self.operation.limits, state.modules, state.supervisor
        is_limp = modules.is_limp(now, limits.heartbeat_timeout)
        angle = modules.angle[np.isfinite(modules.angle)]
        at_rest = not np.any(state.reference.references)
        is_straight = at_rest and bool(np.all(np.abs(angle) < limits.straight))
        events = {*wrong, *requests}
        after, entries = self.supervisor.step(
            before,
            now,
            events,
            is_straight=is_straight,
            is_limp=is_limp,
            is_on=modules.all_active(),
        )
        state = replace(state, supervisor=after)
        if after.state != before.state:
            phase = phase_with(state.phase, before.state, after.state)
            return self._entered(replace(state, phase=phase), now), entries
        if after.state in ("idle", "fault") and state.phase == "stopping":
            # A module that is not heard goes limp by itself; until then the stop is not over.
            is_sure = is_limp and not modules.silent(now, limits.heartbeat_timeout)
            if is_sure or now - after.since > self.supervisor.within("limp"):
                state = replace(state, phase=phase_after("stopping", "settled"), since=now)
        elif after.state == "idle" and state.phase != "done":
            why = next(
                (event for event in wrong if event in BY_EVENT and event != "lost_meter"), ""
            )
            state = replace(state, failure=f"{cause_of(why)}: {wrong[why]}") if why else state
        return state, entries

    def _entered(self, state: OperatorState, now: float) -> OperatorState:
        """Apply the consequences of a new state of the supervisor."""
        source, reference = self.reference_source, state.reference
        entered = state.supervisor.state
        if entered == "ready":
            return replace(
                state, reference=source.start_straightening(reference, now, state.modules.angle)
            )
        if entered == "running":
            return replace(state, since=now, begun=now, reference=source.begin(reference, now))
        if entered in ("stopping", "fault"):
            if state.begun is not None and state.ended is None:
                state = replace(state, ended=now, stopped_by=state.supervisor.cause)
            reference = source.start_straightening(reference, now, reference.references)
            return replace(state, since=now, reference=reference)
        return state

    def _with_references(self, state: OperatorState, now: float) -> OperatorState:
        """Update the references for this tick."""
        if not state.supervisor.sends_references:
            return state
        source, reference = self.reference_source, state.reference
        if state.supervisor.state != "running":
            way = STRAIGHT_SHARE * self.operation.limits.straighten_time
            return replace(state, reference=source.straighten(reference, now, way))
        try:
            if state.estimate is not None:
                reference = source.decide(reference, now, state.estimate)
            return replace(state, reference=source.follow(reference, now))
        except Exception as error:  # the next tick stops the robot; until then it holds
            return replace(state, error=f"controller: {error}")

    def _with_orders(
        self, state: OperatorState, torque_before: str, now: float
    ) -> tuple[OperatorState, tuple[CanMessage, ...]]:
        """Return the messages of this tick: orders first, then references, and the Sync last."""
        supervisor, prepared = state.supervisor, state.prepared
        orders: list[CanMessage] = []
        is_new = supervisor.torque != torque_before
        if is_new or now - state.ordered >= REPEAT:
            orders += self._torque_orders(state, now, is_new=is_new)
            if not orders and self.clears and state.phase == "connecting":
                orders.append(NodeCommand(order=Order.CLEAR))
            elif not orders and prepared.sets_zero:
                orders.append(NodeCommand(order=Order.SET_ZERO))
                prepared = replace(prepared, sets_zero=False)
        angles: tuple[CanMessage, ...] = ()
        if supervisor.sends_references:
            angles = encode_references(state.reference.references.tolist())
        sync = Sync(counter=state.sync)
        state = replace(
            state,
            prepared=prepared,
            ordered=now if orders else state.ordered,
            sync=(state.sync + 1) % SYNC_COUNTS,
        )
        return state, (*orders, *angles, sync)

    def _torque_orders(
        self, state: OperatorState, now: float, *, is_new: bool
    ) -> tuple[CanMessage, ...]:
        """Return the order that the supervisor's torque requires, if the modules do not obey it yet."""
        supervisor = state.supervisor
        is_limp = state.modules.is_limp(now, self.operation.limits.heartbeat_timeout)
        if supervisor.torque == "enable":
            return (NodeCommand(order=Order.ENABLE),)
        if supervisor.torque == "cut" and (is_new or not is_limp):
            reason = 1 if supervisor.cause == "emergency_key" else 2
            return (EmergencyStop(reason=reason),)
        if supervisor.torque == "off" and (is_new or not is_limp):
            return (NodeCommand(order=Order.DISABLE),)
        return ()


def _torque_events(
    before: OperatorState, state: OperatorState, messages: tuple[CanMessage, ...], now: float
) -> list[Event]:
    """Return an event for every change of what the motors are told, and for every order to switch them on."""
    was, torque = before.supervisor.torque, state.supervisor.torque
    if torque != was:
        return [Event(time=now, kind="torque", message=f"{was} -> {torque}")]
    if NodeCommand(order=Order.ENABLE) in messages:
        off = ", ".join(str(node) for node in np.flatnonzero(~state.modules.are_on()) + 1)
        return [Event(time=now, kind="torque", message=f"{torque} again: module {off} is off")]
    return []


def _milestones(before: OperatorState, state: OperatorState, now: float) -> list[Event]:
    """Return events for phases, and for the beginning and end of the run, which a replay looks for."""
    found: list[Event] = []
    clock = {} if state.clock is None else {"clock": state.clock.offset}
    if state.begun is not None and before.begun is None:
        found.append(Event(time=now, kind="start", message="the run begins", data=clock))
    if state.ended is not None and before.ended is None:
        cause = state.supervisor.cause
        message = (
            f"The run was ended: {cause_of(cause)}."
            if cause in BY_EVENT
            else "The run reached its end."
        )
        data = {"succeeded": not state.supervisor.is_fault, **clock}
        found.append(Event(time=now, kind="stop", message=message, data=data))
    if state.phase != before.phase:
        found.append(Event(time=now, kind="phase", message=f"{before.phase} -> {state.phase}"))
    return found


def _event(entry: Reaction, wrong: Mapping[str, str]) -> Event:
    """Convert a line of the supervisor's log to an event of the recording."""
    rule, detail = BY_EVENT.get(entry.event), wrong.get(entry.event, "")
    return Event(
        time=entry.time,
        kind="fault" if rule is not None and rule.is_fault else "state",
        message=f"{cause_of(entry.event)}{': ' + detail if detail else ''}; {entry.action.replace('_', ' ')}",
        data={
            "event": entry.event,
            "action": entry.action,
            "before": entry.before,
            "after": entry.after,
        },
    )
