"""One operation as a pure tick: what came in, and the time, give what goes out. No clock, no bus, no threads.

    connecting -> checking -> calibrating -> idle_current -> settling -> countdown -> running -> stopping -> done

The supervisor's state stands beside the phase: it says whether the joints may move, the phase says what for.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from laticauda.interfaces import Plant
from laticauda.operate import preparing
from laticauda.operate.asking import Asker
from laticauda.operate.calibration import ClockOffset
from laticauda.operate.estimation import Estimator
from laticauda.operate.kinematic import KinematicEstimator
from laticauda.operate.modules import heard, no_modules
from laticauda.operate.packing import Recorded
from laticauda.operate.replay import AnyEstimator
from laticauda.operate.samples import Event, JointSample, PoseSample, ReferenceSample
from laticauda.operate.settings import Operation
from laticauda.operate.state import Inputs, OperatorState, Outputs, Prepared
from laticauda.operate.supervisor import BY_EVENT, Entry, Supervisor
from laticauda.operate.watch import Seen, Watch
from laticauda.protocol import CanMessage, EmergencyStop, NodeCommand, Order, Sync, references
from laticauda.robot import Robot

REPEAT = 0.1  # orders that are not obeyed yet are given again after [s]
STRAIGHT_SHARE = 0.7  # of the time for straightening, on the way; the rest is for the joints to come after


@dataclass(frozen=True, kw_only=True, eq=False)
class Operator:
    """Everything an operation needs but its devices.

    Raises:
        ValueError: If the robot's joints cannot do what the controller may ask for.
    """

    operation: Operation
    """What to do."""
    clears: bool = False
    """Clear faults of the modules first: somebody has looked at them."""
    check_only: bool = False
    """Stop after the preparations, with the robot limp all the time."""
    twin: Plant[Any] | None = None
    """What runs along as the filter's model of motion; None: the filter knows no water."""

    @cached_property
    def robot(self) -> Robot:
        """What swims."""
        return self.operation.body()

    @cached_property
    def supervisor(self) -> Supervisor:
        """The safety supervisor."""
        return Supervisor(straighten_time=self.operation.limits.straighten_time)

    @cached_property
    def watch(self) -> Watch:
        """The limits."""
        return Watch(limits=self.operation.limits)

    @cached_property
    def asker(self) -> Asker:
        """From observations to references."""
        how = self.operation
        return Asker(
            robot=self.robot, controller=how.controller(), ramp=how.ramp, offset_bandwidth=how.offset_bandwidth
        )

    @cached_property
    def estimator(self) -> AnyEstimator:
        """The state estimation."""
        mount = self.operation.calibration.mount
        if self.operation.estimator == "kinematics":
            return KinematicEstimator(robot=self.robot, mount=mount)
        lost_after = self.operation.limits.mocap_timeout
        return Estimator(robot=self.robot, mount=mount, plant=self.twin, lost_after=lost_after)

    def init(self) -> OperatorState:
        """Nothing done yet."""
        n = self.robot.n_joints
        return OperatorState(
            supervisor=self.supervisor.init(),
            watch=self.watch.init(n),
            modules=no_modules(n),
            estimator=self.estimator.init(),
            asking=self.asker.init(),
            prepared=Prepared(),
        )

    def tick(self, state: OperatorState, now: float, inputs: Inputs) -> tuple[OperatorState, Outputs]:
        """One tick.

        Args:
            state: As the last call returned it, or `init`.
            now: Our clock, later than at the last tick [s].
            inputs: What came in since.

        Returns:
            The state now, and what goes out.
        """
        before = state
        if state.since is None:
            state = replace(state, since=now)
        state, samples = self._taken(state, now, inputs)
        state, wrong = self._looked(state, before, now, inputs)
        state, requests, told = self._prepared(state, now)
        state, asked = self._course(state, now, requests)
        state, entries = self._supervised(state, now, wrong, asked)
        state = self._moved(state, now)
        state, messages = self._said(state, now, wrong)
        events = (*told, *(_event(entry, wrong, inputs.events) for entry in entries))
        events = (*events, *_milestones(before, state, now))
        outputs = Outputs(messages=messages, samples=samples, estimate=state.estimate, events=events)
        if state.asking.thoughts > before.asking.thoughts:
            outputs = replace(outputs, command=state.asking.command, signals=self.asker.signals(state.asking))
        return replace(state, now=now), outputs

    def _prepared(self, state: OperatorState, now: float) -> preparing.Answer:
        """One tick of the preparations, as far as they are to go."""
        if state.is_done:
            return state, (), ()
        state, requests, told = preparing.step(self.operation, state, now)
        if self.check_only and state.phase == "settling":
            return replace(state, phase="done"), (), told
        return state, requests, told

    # ---- what came in ----------------------------------------------------------------------------------------------

    def _taken(self, state: OperatorState, now: float, inputs: Inputs) -> tuple[OperatorState, tuple[Recorded, ...]]:
        """The latest of everything, and the estimate."""
        samples: list[Any] = []
        modules = heard(state.modules, inputs.messages)
        if state.now is not None and inputs.messages:
            fresh = modules.angle_time >= state.now
            if fresh.any():
                samples.append(
                    JointSample(
                        time=state.now,  # the last tick ended with the Sync that they answer
                        angle=np.where(fresh, modules.angle, np.nan),
                        rate=np.where(fresh, modules.rate, np.nan),
                        torque=np.where(fresh, modules.torque, np.nan),
                    )
                )
        clock, seen = state.clock, state.seen
        for arrival, frame in inputs.frames:
            clock = ClockOffset().step(clock, arrival, frame.time)
            placed = self._placed(frame, clock.offset, state.prepared.marker_turned)
            samples.append(placed)
            seen = arrival if not placed.is_lost else seen
        rotations = tuple(s.rotation for s in samples if isinstance(s, PoseSample) and s.rotation is not None)
        prepared = (
            replace(state.prepared, rotation=rotations)
            if state.phase != "calibrating"
            else replace(state.prepared, rotation=(*state.prepared.rotation, *rotations))
        )
        reading, idle, drawn = state.reading, state.idle, state.drawn
        for reading in inputs.readings:
            idle = idle.step(reading.current) if state.phase == "idle_current" else idle
            drawn = drawn.step(reading.current) if state.phase == "running" else drawn
        asked = state.supervisor.sends_references and state.now is not None
        taken = [self._reference(state)] if asked else []
        state = replace(
            state,
            modules=modules,
            clock=clock,
            seen=seen,
            reading=reading,
            idle=idle,
            drawn=drawn,
            error="",
            prepared=prepared,
        )
        samples = [*taken, *samples]
        return self._estimated(state, now, samples), (*samples, *inputs.readings)

    def _reference(self, state: OperatorState) -> ReferenceSample:
        assert state.now is not None  # the caller looked
        gait = state.asking.command.gait if state.phase == "running" and state.asking.command else None
        frequency = 0.0 if gait is None else gait.frequency
        return ReferenceSample(time=state.now, angle=state.asking.references, frequency=frequency)

    def _placed(self, frame: PoseSample, offset: float, turned: float) -> PoseSample:
        """A frame on our clock, in the path frame, and of a marker body that sits as it is said to."""
        tank = self.operation.tank
        return PoseSample(
            time=frame.time + offset,
            position=tank.to_path(frame.position),
            rotation=None
            if frame.rotation is None
            else _about_z(-tank.path_heading) @ frame.rotation @ _about_z(-turned),
            residual=frame.residual,
        )

    def _estimated(self, state: OperatorState, now: float, samples: list[Any]) -> OperatorState:
        """The estimate with the samples; an error in it stops the robot, and not the program."""
        estimator, belief = self.estimator, state.estimator
        try:
            for sample in samples:
                belief = estimator.step(belief, sample)
            return replace(state, estimator=belief, estimate=estimator.estimate(belief, now))
        except Exception as error:
            return replace(state, estimate=None, error=f"state estimation: {error}")

    # ---- what is wrong ---------------------------------------------------------------------------------------------

    def _looked(
        self, state: OperatorState, before: OperatorState, now: float, inputs: Inputs
    ) -> tuple[OperatorState, dict[str, str]]:
        """What is wrong now, by event."""
        tank, found = self.operation.tank, dict(inputs.events)
        room = float("inf")
        if state.estimate is not None and state.phase == "running":
            velocity = tank.to_tank(state.estimate.center_of_mass_velocity) - tank.to_tank(np.zeros(2))
            room = tank.room(tank.to_tank(state.estimate.center_of_mass), velocity)
        sent = before.supervisor.sends_references
        lateness = 0.0 if before.now is None else now - before.now - 1.0 / self.operation.rate
        started = state.since if state.since is not None else now
        seen = Seen(
            now=now,
            lateness=lateness,
            modules=state.modules,
            references=state.asking.references if sent else None,
            mocap_age=now - (started if state.seen is None else state.seen),
            meter_age=None if state.reading is None else now - state.reading.time,
            room=room,
        )
        watch, wrong = self.watch.step(state.watch, seen)
        if state.phase in ("connecting", "checking"):
            wrong = {}  # the checks say it better
        if not sent:
            wrong.pop("late_loop", None)
        error = state.error or before.error  # the controller's is of the last tick
        if error:
            found["program_error"] = error
        if state.phase == "running" and "lost_meter" in wrong and "lost_meter" not in state.supervisor.present:
            state = replace(state, notes=(*state.notes, f"lost_meter: {wrong['lost_meter']}"))
        return replace(state, watch=watch), {**wrong, **found}

    def _course(
        self, state: OperatorState, now: float, requests: tuple[str, ...]
    ) -> tuple[OperatorState, tuple[str, ...]]:
        """The normal course after the preparations, and giving up before the run."""
        if state.phase == "running" and state.begun is not None and now - state.begun >= self.operation.duration:
            return state, ("ended",)
        if state.failure and state.phase not in ("stopping", "done"):
            return replace(state, phase="stopping", since=now), ("ended",)
        return state, requests

    def _supervised(
        self, state: OperatorState, now: float, wrong: Mapping[str, str], requests: tuple[str, ...]
    ) -> tuple[OperatorState, tuple[Entry, ...]]:
        """The supervisor's step, and what follows from it for the phase."""
        limits, modules = self.operation.limits, state.modules
        is_limp = modules.is_limp(now, limits.heartbeat_timeout)
        angle = modules.angle[np.isfinite(modules.angle)]
        at_rest = not np.any(state.asking.references)
        is_straight = at_rest and bool(np.all(np.abs(angle) < limits.straight))
        events = {*wrong, *requests}
        was = state.supervisor
        supervisor, entries = self.supervisor.step(was, now, events, is_straight=is_straight, is_limp=is_limp)
        state = replace(state, supervisor=supervisor)
        if supervisor.state == was.state:
            if supervisor.state in ("idle", "fault") and state.phase == "stopping":
                # A module that is not heard goes limp by itself; until then nothing is over.
                is_sure = is_limp and not modules.silent(now, limits.heartbeat_timeout)
                settled = is_sure or now - supervisor.since > self.supervisor.within("limp")
                state = replace(state, phase="done", since=now) if settled else state
            elif supervisor.state == "idle" and state.phase != "done" and _stops(wrong):
                why = next(event for event in wrong if _stops({event: ""}))
                state = replace(state, failure=f"{BY_EVENT[why].says}: {wrong[why]}")
            return state, entries
        if supervisor.state == "ready":
            state = replace(state, asking=self.asker.from_here(state.asking, now, modules.angle))
        elif supervisor.state == "running":
            state = replace(state, phase="running", since=now, begun=now, asking=self.asker.begin(state.asking, now))
        elif supervisor.state in ("stopping", "fault"):
            ended = now if state.begun is not None and state.ended is None else state.ended
            asking = self.asker.from_here(state.asking, now, state.asking.references)
            phase = state.phase if state.phase in ("stopping", "done") else "stopping"
            first = state.begun is not None and state.ended is None
            stopped = supervisor.cause if first else state.stopped_by
            state = replace(state, phase=phase, since=now, ended=ended, asking=asking, stopped_by=stopped)
        return state, entries

    # ---- what goes out ---------------------------------------------------------------------------------------------

    def _moved(self, state: OperatorState, now: float) -> OperatorState:
        """The references of this tick."""
        if not state.supervisor.sends_references:
            return state
        if state.supervisor.state != "running":
            way = STRAIGHT_SHARE * self.operation.limits.straighten_time
            return replace(state, asking=self.asker.straighten(state.asking, now, way))
        try:
            asking = state.asking
            if state.estimate is not None:
                asking = self.asker.think(asking, now, state.estimate.observation())
            return replace(state, asking=self.asker.follow(asking, now))
        except Exception as error:  # the next tick stops the robot; until then it holds
            return replace(state, error=f"controller: {error}")

    def _said(
        self, state: OperatorState, now: float, wrong: Mapping[str, str]
    ) -> tuple[OperatorState, tuple[CanMessage, ...]]:
        """The messages of this tick: orders first, then references, and the Sync at last."""
        orders: list[CanMessage] = []
        supervisor, modules = state.supervisor, state.modules
        is_limp = modules.is_limp(now, self.operation.limits.heartbeat_timeout)
        if now - state.ordered >= REPEAT:
            if supervisor.action == "emergency_stop" and not is_limp:
                orders.append(EmergencyStop(reason=1 if supervisor.cause == "emergency_key" else 2))
            elif supervisor.sends_references and not modules.all_active():
                orders.append(NodeCommand(order=Order.ENABLE))
            elif not supervisor.sends_references and not is_limp:
                orders.append(NodeCommand(order=Order.DISABLE))
            elif self.clears and state.phase == "connecting":
                orders.append(NodeCommand(order=Order.CLEAR))
            elif state.prepared.sets_zero:
                orders.append(NodeCommand(order=Order.SET_ZERO))
                state = replace(state, prepared=replace(state.prepared, sets_zero=False))
        if supervisor.action == "emergency_stop" and supervisor.since == now and not orders:
            orders.append(EmergencyStop(reason=1 if supervisor.cause == "emergency_key" else 2))
        asked = references(state.asking.references.tolist()) if supervisor.sends_references else ()
        state = replace(state, ordered=now if orders else state.ordered, sync=(state.sync + 1) % 65536)
        return state, (*orders, *asked, Sync(counter=state.sync))


def _milestones(before: OperatorState, state: OperatorState, now: float) -> list[Event]:
    """The phases, and the begin and end of the run, which a replay looks for."""
    found: list[Event] = []
    if state.begun is not None and before.begun is None:
        found.append(Event(time=now, kind="start", message="the run begins"))
    if state.ended is not None and before.ended is None:
        is_well = not state.supervisor.is_fault
        cause = BY_EVENT[state.supervisor.cause].says if state.supervisor.cause in BY_EVENT else "reached its end"
        message = f"The run {cause}." if cause == "reached its end" else f"The run was ended: {cause}."
        found.append(Event(time=now, kind="stop", message=message, data={"succeeded": is_well}))
    if state.phase != before.phase:
        found.append(Event(time=now, kind="phase", message=f"{before.phase} -> {state.phase}"))
    return found


def _about_z(angle: float) -> np.ndarray:
    """A rotation about the vertical [-]."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


def _stops(wrong: Mapping[str, str]) -> bool:
    """Whether something keeps an idle robot from moving."""
    return any(event in BY_EVENT and event != "lost_meter" for event in wrong)


def _event(entry: Entry, wrong: Mapping[str, str], given: Mapping[str, str]) -> Event:
    """A line of the supervisor's log as an event of the recording."""
    rule = BY_EVENT.get(entry.event)
    detail = wrong.get(entry.event) or given.get(entry.event) or ""
    says = rule.says if rule else entry.event
    return Event(
        time=entry.time,
        kind="fault" if rule is not None and rule.is_fault else "state",
        message=f"{says}{': ' + detail if detail else ''}; {entry.action.replace('_', ' ')}",
        data={"event": entry.event, "action": entry.action, "before": entry.before, "after": entry.after},
    )
