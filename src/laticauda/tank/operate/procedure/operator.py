"""One operation as a pure tick: from inputs and time to outputs, without clock, bus or threads.

`safety.supervisor` has the table of its phases and of the supervisor's states; `preparing` has the
phases before the run.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from laticauda.control.estimation import Estimator, KinematicEstimator
from laticauda.models.dynamics import Plant
from laticauda.robot import Robot
from laticauda.tank.operate.procedure import preparing
from laticauda.tank.operate.procedure.intake import take_in
from laticauda.tank.operate.procedure.reference_source import ReferenceSource
from laticauda.tank.operate.procedure.state import Inputs, OperatorState, Outputs, Prepared
from laticauda.tank.operate.recording.entries import Decision, Entry, Event
from laticauda.tank.operate.safety.limits import LimitState, Reports, compare_with_limits
from laticauda.tank.operate.safety.modules import Modules
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

REPEAT_TIME = 0.1
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
    """Twin that runs along as the filter's motion model; None: it has no model of the water."""

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
        return ReferenceSource(
            robot=self.robot,
            controller=self.operation.controller(),
            ramp=self.operation.ramp,
            offset_bandwidth=self.operation.offset_bandwidth,
        )

    @cached_property
    def estimator(self) -> Estimator | KinematicEstimator:
        """The state estimation."""
        mount = self.operation.calibration.mount
        in_space = self.operation.in_space
        if self.operation.estimator == "kinematics" or in_space:
            return KinematicEstimator(robot=self.robot, mount=mount, in_space=in_space)
        return Estimator(
            robot=self.robot,
            mount=mount,
            plant=self.twin,
            lost_after=self.operation.limits.mocap_timeout,
        )

    def init(self) -> OperatorState:
        """Return the state before the first tick."""
        n_joints = len(self.robot.driven_joints)
        return OperatorState(
            supervisor=self.supervisor.init(),
            limits=LimitState.initial(n_joints),
            modules=Modules.before_messages(n_joints),
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
        if state.since is None:
            state = replace(state, since=now)
        state, samples = take_in(self.operation, self.estimator, state, now, inputs)
        state, problems = self._monitor(state, before, now, inputs)
        state, preparation_events = self._prepare(state, now)
        state, requests = self._request(state, now)
        state, reactions = self._supervise(state, now, problems, requests)
        state = self._update_references(state, now)
        state, messages = self._give_orders(state, before.supervisor.torque, now)
        entries: list[Entry] = [
            *samples,
            *self._estimate_and_decision(before, state),
            *preparation_events,
            *(_describe_reaction(reaction, problems) for reaction in reactions),
            *_milestones(before, state, now),
            *_torque_events(before, state, messages, now),
        ]
        return replace(state, now=now), Outputs(messages=messages, entries=tuple(entries))

    def _monitor(
        self, state: OperatorState, before: OperatorState, now: float, inputs: Inputs
    ) -> tuple[OperatorState, dict[str, str]]:
        """Find what is wrong now, by event."""
        reports = self._reports(state, before, now)
        limits, problems = compare_with_limits(self.operation.limits, state.limits, reports)
        state = replace(state, limits=limits)
        if state.phase in ("connecting", "checking"):
            problems = {}  # the checks report it better
        if reports.references is None:
            problems.pop("late_loop", None)
        is_without_power = state.phase == "running" and "lost_meter" in problems
        if is_without_power and not state.lost_meter:
            note = f"lost_meter: {problems['lost_meter']}"
            state = replace(state, lost_meter=True, notes=(*state.notes, note))
        problems |= inputs.events
        error = state.error or before.error  # that of the controller is from the last tick
        if error:
            problems["program_error"] = error
        return state, problems

    def _reports(self, state: OperatorState, before: OperatorState, now: float) -> Reports:
        """Return what is to be compared with the limits."""
        started = now if state.since is None else state.since
        last_seen = started if state.frame_time is None else state.frame_time
        pause = 0.0
        lateness = 0.0
        if before.now is not None:
            pause = now - before.now
            lateness = pause - 1.0 / self.operation.rate
        references = None
        if before.supervisor.sends_references:
            references = state.reference.references
        meter_age = None
        if state.reading is not None:
            meter_age = now - state.reading.time
        return Reports(
            now=now,
            lateness=lateness,
            pause=pause,
            modules=state.modules,
            references=references,
            mocap_age=now - last_seen,
            meter_age=meter_age,
            room=self._room(state),
        )

    def _room(self, state: OperatorState) -> float:
        """Return the distance to the edge of the tank that the robot swims toward [m]."""
        estimate = state.estimate
        if estimate is None or state.phase != "running":
            return math.inf
        tank = self.operation.tank
        velocity = estimate.center_of_mass_velocity
        velocity_in_tank = tank.to_tank(velocity) - tank.to_tank(np.zeros_like(velocity))
        return tank.room(tank.to_tank(estimate.center_of_mass), velocity_in_tank)

    def _prepare(self, state: OperatorState, now: float) -> preparing.PreparationStep:
        """Perform one tick of the preparations, as far as they are to go."""
        state, events = preparing.step(self.operation, state, now)
        if self.check_only and state.phase == "settling":
            state = replace(state, phase=phase_after("settling", "only_checked"))
        return preparing.PreparationStep(state=state, events=events)

    def _request(self, state: OperatorState, now: float) -> tuple[OperatorState, tuple[str, ...]]:
        """Return the requests of normal operation, and those for giving up before the run."""
        if state.failure and state.phase not in ("stopping", "done"):
            return replace(state, phase=phase_after(state.phase, "ended"), since=now), ("ended",)
        if state.phase == "settling" and state.supervisor.state == "idle":
            return state, ("checked",)
        time_in_phase = 0.0 if state.since is None else now - state.since
        if state.phase == "countdown" and time_in_phase >= self.operation.countdown:
            return state, ("started",)
        if state.phase == "running" and state.begun is not None:
            if now - state.begun >= self.operation.duration:
                return state, ("ended",)
        return state, ()

    def _supervise(
        self,
        state: OperatorState,
        now: float,
        problems: Mapping[str, str],
        requests: tuple[str, ...],
    ) -> tuple[OperatorState, tuple[Reaction, ...]]:
        """Perform the supervisor's step, and apply its consequences."""
        modules = state.modules
        before = state.supervisor
        is_limp = modules.is_limp(now, self.operation.limits.heartbeat_timeout)
        after, reactions = self.supervisor.step(
            before,
            now,
            {*problems, *requests},
            is_straight=self._is_straight(state),
            is_limp=is_limp,
            is_on=modules.all_active(),
        )
        state = replace(state, supervisor=after)
        if after.state != before.state:
            phase = phase_with(state.phase, before.state, after.state)
            return self._enter(replace(state, phase=phase), now), reactions
        if after.state in ("idle", "fault") and state.phase == "stopping":
            if self._has_stopped(state, now, is_limp=is_limp):
                state = replace(state, phase=phase_after("stopping", "settled"), since=now)
        elif after.state == "idle" and state.phase != "done":
            state = _give_up_for_problem(state, problems)
        return state, reactions

    def _is_straight(self, state: OperatorState) -> bool:
        """Return whether references and all joints that report are at zero."""
        if np.any(state.reference.references):
            return False
        reported = state.modules.angle[np.isfinite(state.modules.angle)]
        return bool(np.all(np.abs(reported) < self.operation.limits.straight))

    def _has_stopped(self, state: OperatorState, now: float, *, is_limp: bool) -> bool:
        """Return whether all modules are limp: those that are not heard go limp by themselves."""
        silent = state.modules.silent(now, self.operation.limits.heartbeat_timeout)
        if is_limp and not silent:
            return True
        return now - state.supervisor.since > self.supervisor.within("limp")

    def _enter(self, state: OperatorState, now: float) -> OperatorState:
        """Apply the consequences of a new state of the supervisor."""
        source = self.reference_source
        reference = state.reference
        entered = state.supervisor.state
        if entered == "ready":
            reference = source.start_straightening(reference, now, state.modules.angle)
            return replace(state, reference=reference)
        if entered == "running":
            return replace(state, since=now, begun=now, reference=source.begin(reference, now))
        if entered in ("stopping", "fault"):
            if state.begun is not None and state.ended is None:
                state = replace(state, ended=now, stopped_by=state.supervisor.cause)
            reference = source.start_straightening(reference, now, reference.references)
            return replace(state, since=now, reference=reference)
        return state

    def _update_references(self, state: OperatorState, now: float) -> OperatorState:
        """Update the references for this tick."""
        if not state.supervisor.sends_references:
            return state
        source = self.reference_source
        reference = state.reference
        if state.supervisor.state != "running":
            duration = STRAIGHT_SHARE * self.operation.limits.straighten_time
            return replace(state, reference=source.straighten(reference, now, duration))
        try:
            if state.estimate is not None:
                observation = state.estimate.with_readings(state.sensed.readings)
                reference = source.decide(reference, now, observation)
            if reference.n_decisions > state.reference.n_decisions:
                state = replace(state, sensed=state.sensed.after_decision())
            return replace(state, reference=source.follow(reference, now))
        except Exception as error:  # the next tick stops the robot; until then it holds
            return replace(state, error=f"controller: {error}")

    def _estimate_and_decision(
        self, before: OperatorState, state: OperatorState
    ) -> tuple[Entry, ...]:
        """Return the estimate, and what the controller decided on it."""
        if state.estimate is None:
            return ()
        command = state.reference.command
        has_decided = state.reference.n_decisions > before.reference.n_decisions
        if command is None or not has_decided:
            return (state.estimate,)
        decision = Decision(
            time=state.estimate.time,
            command=command,
            signals=self.reference_source.signals(state.reference),
        )
        return (state.estimate, decision)

    def _give_orders(
        self, state: OperatorState, torque_before: str, now: float
    ) -> tuple[OperatorState, tuple[CanMessage, ...]]:
        """Return the messages of this tick: orders first, then references, and the Sync last."""
        supervisor = state.supervisor
        prepared = state.prepared
        orders: list[CanMessage] = []
        is_new = supervisor.torque != torque_before
        if is_new or now - state.ordered >= REPEAT_TIME:
            orders += self._torque_orders(state, now, is_new=is_new)
            if not orders and self.clears and state.phase == "connecting":
                orders.append(NodeCommand(order=Order.CLEAR))
            elif not orders and prepared.sets_zero:
                orders.append(NodeCommand(order=Order.SET_ZERO))
                prepared = replace(prepared, sets_zero=False)
        references: tuple[CanMessage, ...] = ()
        if supervisor.sends_references:
            references = encode_references(state.reference.references.tolist())
        sync = Sync(counter=state.sync)
        state = replace(
            state,
            prepared=prepared,
            ordered=now if orders else state.ordered,
            sync=(state.sync + 1) % SYNC_COUNTS,
        )
        return state, (*orders, *references, sync)

    def _torque_orders(
        self, state: OperatorState, now: float, *, is_new: bool
    ) -> tuple[CanMessage, ...]:
        """Return the order that the supervisor's torque requires, unless the modules obey already."""
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


def _give_up_for_problem(state: OperatorState, problems: Mapping[str, str]) -> OperatorState:
    """Give the operation up before the robot has moved, if anything but the meter is wrong."""
    for event, description in problems.items():
        if event in BY_EVENT and event != "lost_meter":
            return replace(state, failure=f"{cause_of(event)}: {description}")
    return state


def _torque_events(
    before: OperatorState, state: OperatorState, messages: tuple[CanMessage, ...], now: float
) -> list[Event]:
    """Return events for changes of what motors are told, and for orders to switch them on."""
    torque_before = before.supervisor.torque
    torque = state.supervisor.torque
    if torque != torque_before:
        return [Event(time=now, kind="torque", message=f"{torque_before} -> {torque}")]
    if NodeCommand(order=Order.ENABLE) in messages:
        nodes = np.flatnonzero(~state.modules.are_on()) + 1
        off = ", ".join(str(node) for node in nodes)
        return [Event(time=now, kind="torque", message=f"{torque} again: module {off} is off")]
    return []


def _milestones(before: OperatorState, state: OperatorState, now: float) -> list[Event]:
    """Return events for phases, and for beginning and end of the run, which a replay looks for."""
    events: list[Event] = []
    clock: dict[str, float] = {}
    if state.clock is not None:
        clock["clock"] = state.clock.offset
    if state.begun is not None and before.begun is None:
        events.append(Event(time=now, kind="start", message="the run begins", data=clock))
    if state.ended is not None and before.ended is None:
        cause = state.supervisor.cause
        message = "The run reached its end."
        if cause in BY_EVENT:
            message = f"The run was ended: {cause_of(cause)}."
        data = {"succeeded": not state.supervisor.is_fault, **clock}
        events.append(Event(time=now, kind="stop", message=message, data=data))
    if state.phase != before.phase:
        events.append(
            Event(
                time=now,
                kind="phase",
                message=f"{before.phase} -> {state.phase}",
                data={"before": before.phase, "after": state.phase},
            )
        )
    return events


def _describe_reaction(reaction: Reaction, problems: Mapping[str, str]) -> Event:
    """Convert a line of the supervisor's log to an event of the recording."""
    rule = BY_EVENT.get(reaction.event)
    is_fault = rule is not None and rule.is_fault
    cause = cause_of(reaction.event)
    detail = problems.get(reaction.event, "")
    if detail:
        cause = f"{cause}: {detail}"
    return Event(
        time=reaction.time,
        kind="fault" if is_fault else "state",
        message=f"{cause}; {reaction.action.replace('_', ' ')}",
        data={
            "event": reaction.event,
            "action": reaction.action,
            "before": reaction.before,
            "after": reaction.after,
        },
    )
