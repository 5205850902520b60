"""The safety supervisor: the tables that an operation obeys, and the step that applies them.

The tables, which the documentation shows, define all transitions, and the action for each event.
The supervisor's state says whether the joints may move; the phase says for what purpose:

    idle      the robot is limp; no reference is sent
    ready     the joints are held straight
    running   the joints follow the controller
    stopping  the robot is being straightened, and then made limp
    fault     the robot is limp and stays limp: nothing leads out of it but a new operation

The supervisor determines which event leads to which action, within what time, and what is
remembered of it. It is a value with a pure step: no clock, no bus, no threads. At every tick it
gets the time, everything that is wrong at that moment, and what the robot reports; it returns the
next state.

It also decides what the modules' motors are told. Torque never returns without a person: motors are
switched on in `ready` only, which nothing but the start of a run leads to, and only until every
module has said that its motor is on. Whatever has gone limp since then stays limp: it is an event
that makes the whole robot limp at once, and a fault.

No request ends a fault, and so no program can: the operation ends in it. Somebody looks at the robot
and starts another one, or confirms it between two runs of a series; that one begins with all the
checks.

The last line of defense is in the modules: without references they hold after `HOLD_AFTER` and go
limp after `LIMP_AFTER`. Not sending references is thus a way to stop that needs no bus; every time
stated here relies on it.
"""

from collections.abc import Mapping, Set
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, NamedTuple, TypeAlias, get_args

from laticauda.values import quantity, read_rows, suggest_nearest, value_class


def _table(name: str, allowed: Mapping[str, tuple[str, ...]]) -> list[dict[str, Any]]:
    """Return the rows of one of the tables next to this file; they are read when it is imported.

    Args:
        name: Name of the table.
        allowed: The words that may be in some of its columns.

    Raises:
        ValueError: If there is another one.
    """
    rows: list[dict[str, Any]] = []
    for line, row in read_rows(Path(__file__).with_name(f"{name}.csv"))[1]:
        for column, allowed_words in allowed.items():
            if row[column] not in allowed_words:
                suggestion = suggest_nearest(row[column], allowed_words)
                raise ValueError(
                    f"{name}.csv, line {line}: no {column} {row[column]!r}{suggestion}"
                )
        rows.append(dict(row))
    return rows


# ---- transitions ---------------------------------------------------------------------------------

State: TypeAlias = Literal["idle", "ready", "running", "stopping", "fault"]
"""State of the supervisor."""
Phase: TypeAlias = Literal[
    "connecting",
    "checking",
    "calibrating",
    "idle_current",
    "settling",
    "countdown",
    "running",
    "stopping",
    "done",
]
"""Phase of an operation; those before `running` are its preparations."""
Request: TypeAlias = Literal["checked", "started", "ended"]
"""Event by which the operation requests another state of the supervisor."""
STATES: tuple[State, ...] = get_args(State)
PHASES: tuple[Phase, ...] = get_args(Phase)
REQUESTS: tuple[Request, ...] = get_args(Request)
"""Events by which the operation requests another state of the supervisor; all others are detected, not requested."""


class Transition(NamedTuple):
    """One row of the table of transitions."""

    phase: Phase
    """Phase before."""
    state: State
    """State of the supervisor before."""
    event: str
    """What happens."""
    next_phase: Phase
    """Phase after the event."""
    next_state: State
    """State of the supervisor after the event."""


TRANSITIONS: tuple[Transition, ...] = tuple(
    Transition(**row)
    for row in _table(
        "transitions",
        {"phase": PHASES, "state": STATES, "next_phase": PHASES, "next_state": STATES},
    )
)
"""`ended` before the run: it was given up. `stop`: a rule of the supervisor; `fault`, `limp_fault`: a rule that ends in
a fault. `settled`: the modules report that they are limp, or have had enough time to become
limp."""


# ---- what goes wrong -----------------------------------------------------------------------------

Action: TypeAlias = Literal["none", "finish", "straighten", "limp", "emergency_stop"]
"""What is done about an event."""
ACTIONS: tuple[Action, ...] = get_args(Action)
"""Actions, each more severe than the one before it."""


@dataclass(frozen=True)
class Rule:
    """Rule that says what one event leads to."""

    event: str
    """Name of the event."""
    says: str
    """What happened, in words."""
    action: Action
    """What is done about it."""
    is_fault: bool = True
    """Whether it ends in the state fault: somebody has to look at the robot before it moves again."""


RULES: tuple[Rule, ...] = tuple(
    Rule(is_fault=row.pop("then") == "fault", **row)
    for row in _table("rules", {"action": ACTIONS, "then": ("idle", "fault")})
)
"""Rules, the most severe first."""
BY_EVENT = {rule.event: rule for rule in RULES}


# ---- torque --------------------------------------------------------------------------------------

Torque: TypeAlias = Literal["enable", "hold", "off", "cut"]
"""What the modules' motors are told; see `TORQUE`."""
TORQUE: dict[tuple[State, Action], Torque] = {
    (row["state"], row["action"]): row["torque"]
    for row in _table("torque", {"state": STATES, "action": ACTIONS, "torque": get_args(Torque)})
}
"""What the modules' motors are told, by the supervisor's state and action; what is not listed is "off".

    enable  switch on, and follow references; from the first time that all motors are on: hold
    hold    what is on follows references; what is off stays off
    off     switch off
    cut     switch off by an emergency stop, which has to be cleared
"""


def cause_of(event: str) -> str:
    """Return what happened, in words; the event itself if there is no rule for it.

    Args:
        event: Name of an event of `RULES`, or another one.
    """
    return BY_EVENT[event].says if event in BY_EVENT else event


# ---- reading the tables --------------------------------------------------------------------------

_NEXT_PHASE: dict[tuple[Phase, str], Phase] = {
    (row.phase, row.event): row.next_phase for row in TRANSITIONS
}
_BY_STATES: dict[tuple[Phase, State, State], Phase] = {
    (row.phase, row.state, row.next_state): row.next_phase
    for row in TRANSITIONS
    if row.state != row.next_state
}
_GRANTED: dict[tuple[State, str], State] = {
    (row.state, row.event): row.next_state for row in TRANSITIONS if row.event in REQUESTS
}


def phase_after(phase: Phase, event: str) -> Phase:
    """Return the phase that follows an event that the operation itself detects.

    Args:
        phase: Phase before.
        event: Event that the table has for this phase.
    """
    return _NEXT_PHASE[phase, event]


def phase_with(phase: Phase, state: State, next_state: State) -> Phase:
    """Return the phase after a change of the supervisor's state.

    The operation may have moved on at the same tick, by an event of its own, so that the table has
    no row for this phase. Then a stop stops the operation in whatever phase it is, and everything
    else leaves it there.

    Args:
        phase: Phase before.
        state: State of the supervisor before.
        next_state: State of the supervisor after.
    """
    next_phase = _BY_STATES.get((phase, state, next_state))
    if next_phase is not None:
        return next_phase
    if next_state in ("stopping", "fault"):
        return "stopping"
    return phase


def state_after_request(state: State, request: str) -> State:
    """Return the supervisor's state after a request; unchanged if the table does not have the request in this state.

    Args:
        state: State before.
        request: One of `REQUESTS`.
    """
    return _GRANTED.get((state, request), state)


# ---- the step ------------------------------------------------------------------------------------

HOLD_AFTER = 0.2
"""When a module holds by itself without references [s]."""
LIMP_AFTER = 1.2
"""When a module is limp by itself without references, at the latest [s]."""
LIMP_FROM = 0.8
"""When a module may be limp by itself without references, at the earliest [s].

Motors are switched on for no longer than this: a module that was told to switch on in that time, and
heard nothing more, is not limp yet when it is told again.
"""
CONFIRM_TIME = 0.5
"""Modules that have not reported that they are limp by then get an emergency stop [s]."""
MARGIN = 0.3
"""For ticks, and for frames in transit [s]."""


@dataclass(frozen=True, kw_only=True)
class SupervisorState:
    """State of the supervisor."""

    state: State = "idle"
    """What the joints may do."""
    action: Action = "none"
    """Current action on the most severe event."""
    cause: str = ""
    """Event that led to this state; "" in normal operation."""
    is_fault: bool = False
    """Whether the current action ends in the state fault."""
    since: float = 0.0
    """When the action began [s]."""
    present: frozenset[str] = frozenset()
    """Events that were present at the last step, so that each is logged once."""
    is_enabled: bool = False
    """Whether switching on is over; no motor is switched on again before the next `ready`."""

    @property
    def torque(self) -> Torque:
        """What the modules' motors are told."""
        torque = TORQUE.get((self.state, self.action), "off")
        if torque == "enable" and self.is_enabled:
            return "hold"
        return torque

    @property
    def sends_references(self) -> bool:
        """Whether references are sent; without them, the modules go limp by themselves."""
        return self.torque in ("enable", "hold")


@dataclass(frozen=True, kw_only=True)
class Reaction:
    """Reaction of the supervisor to an event, or on its way to a stop."""

    time: float
    """Time of the reaction [s]."""
    event: str
    """What happened."""
    action: Action
    """Action from now on."""
    before: State
    """State before the event."""
    after: State
    """State after the event."""


@value_class
class Supervisor:
    """Safety supervisor of a robot; its state is a `SupervisorState`.

    Example:
        >>> supervisor = Supervisor()
        >>> seen = {"is_straight": False, "is_limp": True, "is_on": False}
        >>> state, entries = supervisor.step(supervisor.init(), 0.0, {"leak"}, **seen)
        >>> state.state, state.action, entries[0].event
        ('fault', 'emergency_stop', 'leak')
    """

    straighten_time: float = quantity(
        "s", "how long it may straighten before it is made limp", gt=0.0, default=2.0
    )

    def within(self, action: str) -> float:
        """Return the stated time from an event until the robot is limp, even if every frame is lost [s].

        Args:
            action: One of `ACTIONS`; the time is infinite for those that stop nothing.
        """
        by_itself = LIMP_AFTER + MARGIN
        times = {
            "straighten": self.straighten_time + by_itself,
            "limp": by_itself,
            "emergency_stop": by_itself,
        }
        return times.get(action, float("inf"))

    def init(self) -> SupervisorState:
        """Return the initial state: idle."""
        return SupervisorState()

    def step(
        self,
        state: SupervisorState,
        now: float,
        events: Set[str],
        *,
        is_straight: bool,
        is_limp: bool,
        is_on: bool,
    ) -> tuple[SupervisorState, tuple[Reaction, ...]]:
        """Perform one tick.

        Args:
            state: State returned by the last call, or by `init`.
            now: Current time [s].
            events: Everything that is wrong now, as event names of `RULES`, and the `REQUESTS`.
            is_straight: Whether every joint that reports is at zero.
            is_limp: Whether every module that is heard reports that its motor is off.
            is_on: Whether every module has reported that its motor is on, and none that it is off.

        Returns:
            The new state, and what is to be logged: every event once, when it begins, and every
                change of state.

        Raises:
            ValueError: If an event is unknown.
        """
        _check(events)
        entries: list[Reaction] = []
        wrong = [rule for rule in RULES if rule.event in events]  # the most severe first
        for rule in wrong:
            after = _reacted(state, rule, now)
            if rule.event not in state.present:
                entries.append(_entry(now, rule.event, rule.action, state, after))
            state = after
        request = _request_in(events)
        if request and _is_allowed(request, wrong, is_on=is_on):
            after = _requested(state, request, now)
            if after is not state:
                entries.append(_entry(now, request, after.action, state, after))
                state = after
        after = self._progress(state, now, is_straight=is_straight, is_limp=is_limp, is_on=is_on)
        if after is not state:
            event = after.action if after.state == state.state else after.state
            entries.append(_entry(now, event, after.action, state, after))
        present = frozenset(rule.event for rule in wrong)
        is_enabled = _is_enabled(after, now, is_on)
        return replace(after, present=present, is_enabled=is_enabled), tuple(entries)

    def _progress(
        self,
        state: SupervisorState,
        now: float,
        *,
        is_straight: bool,
        is_limp: bool,
        is_on: bool,
    ) -> SupervisorState:
        """Go on from straightening to limp, and from limp to idle or fault."""
        if state.state != "stopping":
            return state
        elapsed = now - state.since
        if state.action == "straighten":
            # Only what still holds is straightened: a robot that is limp in part may be in hands.
            if is_straight or not is_on or elapsed >= self.straighten_time:
                return replace(state, action="limp", since=now)
            return state
        if is_limp or (state.action == "emergency_stop" and elapsed >= LIMP_AFTER):
            if state.is_fault:
                return replace(state, state="fault")
            return SupervisorState(since=now)
        if state.action == "limp" and elapsed >= CONFIRM_TIME:
            cause = state.cause or "not_limp"
            return replace(
                state, state="fault", action="emergency_stop", is_fault=True, cause=cause
            )
        return state


def _is_enabled(state: SupervisorState, now: float, is_on: bool) -> bool:
    """Return whether switching on is over: all motors are on, or have had the time for it."""
    if state.state != "ready":
        return False
    return state.is_enabled or is_on or now - state.since >= LIMP_FROM


def _request_in(events: Set[str]) -> str:
    """Return the one request that counts at this tick, before all others that to end; "" without any."""
    for request in ("ended", *REQUESTS):
        if request in events:
            return request
    return ""


def _is_allowed(request: str, wrong: list[Rule], *, is_on: bool) -> bool:
    """Return whether the operation may have what it requests; a request to stop is always allowed."""
    if request == "ended":
        return True
    if any(rule.action != "finish" for rule in wrong):
        return False
    if request == "started":
        return is_on
    return True


def _requested(state: SupervisorState, request: str, now: float) -> SupervisorState:
    """Return the state that the operation requests; the same if the table has no such request in this state."""
    after = state_after_request(state.state, request)
    if after == state.state:
        return state
    if after == "stopping":
        return SupervisorState(state=after, action="straighten", since=now)
    return SupervisorState(state=after, since=now)


def _reacted(state: SupervisorState, rule: Rule, now: float) -> SupervisorState:
    """Return the state with the action of a rule, if that is more severe than the current action."""
    if rule.action == "finish" or (state.state == "idle" and not rule.is_fault):
        return state  # nothing moves that would have to stop
    is_graver = ACTIONS.index(rule.action) > ACTIONS.index(state.action)
    if state.state == "fault":
        if is_graver:
            return replace(state, action=rule.action, cause=rule.event, since=now)
        return state
    if state.state == "stopping" and not is_graver:
        is_fault = state.is_fault or rule.is_fault
        return replace(state, is_fault=is_fault, cause=state.cause or rule.event)
    if state.state == "idle":  # limp already: a fault at once, with nothing to straighten
        action = "limp" if rule.action == "straighten" else rule.action
        return replace(
            state, state="fault", action=action, cause=rule.event, is_fault=True, since=now
        )
    return SupervisorState(
        state="stopping",
        action=rule.action,
        cause=rule.event,
        is_fault=state.is_fault or rule.is_fault,
        since=now,
        present=state.present,
    )


def _entry(
    now: float, event: str, action: Action, before: SupervisorState, after: SupervisorState
) -> Reaction:
    return Reaction(time=now, event=event, action=action, before=before.state, after=after.state)


def _check(events: Set[str]) -> None:
    known = (*BY_EVENT, *REQUESTS)
    for event in events:
        if event not in known:
            raise ValueError(
                f"`events` must hold only events of the table, got {event!r}{suggest_nearest(event, known)}"
            )
