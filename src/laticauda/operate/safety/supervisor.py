"""The safety supervisor: the tables that an operation keeps to, and the step that keeps to them.

The tables, which the documentation prints, say what leads where, and what is done when. The supervisor's state says
whether the joints may move, the phase says what for:

    idle      the robot is limp; no reference is sent
    ready     the joints are held straight
    running   the joints follow the controller
    stopping  the robot is being straightened, and then made limp
    fault     limp, and it stays so until somebody acknowledges and nothing is wrong any more

The supervisor says which event leads to which action, within which time, and what is remembered of it. It is a value
and a pure step: no clock, no bus, no threads. Every tick it gets the time, everything that is wrong at that moment, and
what the robot reports; it answers with the state that follows.

The last line of defense is in the modules: without references they hold after `HOLD_AFTER` and go limp after
`LIMP_AFTER`. So to stop sending references is a way to stop that needs no bus, and every time stated here rests on it.
"""

from collections.abc import Set
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from laticauda.errors import nearest
from laticauda.files import read_rows
from laticauda.quantities import quantity, value


def _table(name: str) -> list[dict[str, str]]:
    """The rows of one of the two tables beside this file; they are read with it."""
    return [row for _, row in read_rows(Path(__file__).with_name(f"{name}.csv"))[1]]


# ---- what leads where -----------------------------------------------------------------------------------------------

STATES = ("idle", "ready", "running", "stopping", "fault")
PREPARATIONS = ("connecting", "checking", "calibrating", "idle_current", "settling", "countdown")
PHASES = (*PREPARATIONS, "running", "stopping", "done")
REQUESTS = ("checked", "started", "ended", "acknowledged")
"""Events by which the operation asks the supervisor for another state; all others it finds out by itself."""


class Transition(NamedTuple):
    """One row."""

    phase: str
    """Before; one of `PHASES`."""
    state: str
    """Of the supervisor, before; one of `STATES`."""
    event: str
    """What happens."""
    next_phase: str
    """After it."""
    next_state: str
    """After it."""


TRANSITIONS: tuple[Transition, ...] = tuple(Transition(**row) for row in _table("transitions"))
"""`ended` before the run: it was given up. `stop`: a rule of the supervisor; `fault`, `limp_fault`: one that has to be
acknowledged. `settled`: the modules say that they are limp, or have had the time for it."""


# ---- what goes wrong ------------------------------------------------------------------------------------------------

ACTIONS = ("none", "finish", "straighten", "limp", "emergency_stop")
"""Each is graver than the one before it."""


@dataclass(frozen=True)
class Rule:
    """What one event leads to."""

    event: str
    """Its name."""
    says: str
    """What happened, in words."""
    action: str
    """One of `ACTIONS`."""
    is_fault: bool = True
    """Whether somebody has to acknowledge it before the robot moves again."""


RULES: tuple[Rule, ...] = tuple(Rule(is_fault=row.pop("then") == "fault", **row) for row in _table("rules"))
"""The gravest come first."""
BY_EVENT = {rule.event: rule for rule in RULES}


def cause_of(event: str) -> str:
    """What happened, in words; the event itself if there is no rule for it.

    Args:
        event: Of `RULES`, or another one.
    """
    return BY_EVENT[event].says if event in BY_EVENT else event


# ---- reading the tables ---------------------------------------------------------------------------------------------

_NEXT_PHASE = {(row.phase, row.event): row.next_phase for row in TRANSITIONS}
_BY_STATES = {(row.phase, row.state, row.next_state): row.next_phase for row in TRANSITIONS}
_GRANTED = {(row.state, row.event): row.next_state for row in TRANSITIONS if row.event in REQUESTS}


def phase_after(phase: str, event: str) -> str:
    """The phase that follows an event which the operation finds by itself.

    Args:
        phase: Before.
        event: One that the table has for this phase.
    """
    return _NEXT_PHASE[phase, event]


def phase_with(phase: str, state: str, next_state: str) -> str:
    """The phase that follows when the supervisor changes its state; whatever else, its stop stops the operation.

    Args:
        phase: Before.
        state: Of the supervisor, before.
        next_state: After.
    """
    otherwise = "stopping" if next_state in ("stopping", "fault") else phase
    return _BY_STATES.get((phase, state, next_state), otherwise)


def granted(state: str, request: str) -> str:
    """The supervisor's state after a request; the same if the table does not have it there.

    Args:
        state: Before.
        request: One of `REQUESTS`.
    """
    return _GRANTED.get((state, request), state)


# ---- the step -------------------------------------------------------------------------------------------------------

HOLD_AFTER, LIMP_AFTER = 0.2, 1.2  # what a module does by itself without references [s]
CONFIRM_TIME = 0.5  # modules that do not report that they are limp by then get an emergency stop [s]
MARGIN = 0.3  # for ticks and frames on their way [s]


@dataclass(frozen=True, kw_only=True)
class SupervisorState:
    """Where the supervisor stands."""

    state: str = "idle"
    """One of `STATES`."""
    action: str = "none"
    """What is being done about the gravest event, one of `ACTIONS`."""
    cause: str = ""
    """The event that led here; "" in the normal course."""
    is_fault: bool = False
    """Whether what is being done ends in the state fault."""
    since: float = 0.0
    """When the action began [s]."""
    present: frozenset[str] = frozenset()
    """Events that were there at the last step, to log each once."""

    @property
    def sends_references(self) -> bool:
        """Whether references are sent; without, the modules go limp by themselves."""
        return self.state in ("ready", "running") or (self.state == "stopping" and self.action == "straighten")


@dataclass(frozen=True, kw_only=True)
class Reaction:
    """What the supervisor did about an event, or on its way to a stop."""

    time: float
    """[s]."""
    event: str
    """What happened."""
    action: str
    """What is done about it from now on."""
    before: str
    """The state before it."""
    after: str
    """The state after it."""


@value
class Supervisor:
    """Watches over a robot; its state is a `SupervisorState`.

    Example:
        >>> supervisor = Supervisor()
        >>> state, entries = supervisor.step(supervisor.init(), 0.0, {"leak"}, is_straight=False, is_limp=True)
        >>> state.state, state.action, entries[0].event
        ('fault', 'emergency_stop', 'leak')
    """

    straighten_time: float = quantity("s", "how long it may straighten before it is made limp", gt=0.0, default=2.0)

    def within(self, action: str) -> float:
        """The stated time from an event to a robot that is limp, whatever is lost on the way [s].

        Args:
            action: One of `ACTIONS`; infinite for those that stop nothing.
        """
        by_itself = LIMP_AFTER + MARGIN
        times = {"straighten": self.straighten_time + by_itself, "limp": by_itself, "emergency_stop": by_itself}
        return times.get(action, float("inf"))

    def init(self) -> SupervisorState:
        """Idle."""
        return SupervisorState()

    def step(
        self, state: SupervisorState, now: float, events: Set[str], *, is_straight: bool, is_limp: bool
    ) -> tuple[SupervisorState, tuple[Reaction, ...]]:
        """One tick.

        Args:
            state: As the last call returned it, or `init`.
            now: [s].
            events: Everything that is wrong now, by the names of `RULES`, and the `REQUESTS`.
            is_straight: Whether every joint that reports is at zero.
            is_limp: Whether every module that is heard reports that it is limp.

        Returns:
            The state now, and what is to be logged: every event once, when it begins, and every change of state.

        Raises:
            ValueError: If there is no such event.
        """
        entries: list[Reaction] = []
        wrong = [rule for rule in RULES if rule.event in events]  # the gravest come first
        _check(events)
        for rule in wrong:
            after = _reacted(state, rule, now)
            if rule.event not in state.present:
                entries.append(_entry(now, rule.event, rule.action, state, after))
            state = after
        for request in REQUESTS:
            if request in events:
                after = _requested(state, request, now, any(rule.is_fault for rule in wrong), is_limp)
                if after is not state:
                    entries.append(_entry(now, request, after.action, state, after))
                    state = after
        after = self._progress(state, now, is_straight, is_limp)
        if after is not state:
            event = "" if after.state == state.state else after.state
            entries.append(_entry(now, event or after.action, after.action, state, after))
        return replace(after, present=frozenset(rule.event for rule in wrong)), tuple(entries)

    def _progress(self, state: SupervisorState, now: float, is_straight: bool, is_limp: bool) -> SupervisorState:
        """From straightening to limp, and from limp to idle or fault."""
        if state.state != "stopping":
            return state
        gone = now - state.since
        if state.action == "straighten":
            return replace(state, action="limp", since=now) if is_straight or gone >= self.straighten_time else state
        if is_limp or (state.action == "emergency_stop" and gone >= LIMP_AFTER):
            return replace(state, state="fault") if state.is_fault else SupervisorState(since=now)
        if state.action == "limp" and gone >= CONFIRM_TIME:
            cause = state.cause or "not_limp"
            return replace(state, state="fault", action="emergency_stop", is_fault=True, cause=cause)
        return state


def _requested(state: SupervisorState, request: str, now: float, is_wrong: bool, is_limp: bool) -> SupervisorState:
    """What the operation asks for, if it may have it; the way to a stop is always free."""
    after = granted(state.state, request)
    allowed = request == "ended" or (not is_wrong and (request != "acknowledged" or is_limp))
    if after == state.state or not allowed:
        return state
    return SupervisorState(state=after, action="straighten" if after == "stopping" else "none", since=now)


def _reacted(state: SupervisorState, rule: Rule, now: float) -> SupervisorState:
    """The state with the action of a rule, if it is graver than what is being done already."""
    is_graver = ACTIONS.index(rule.action) > ACTIONS.index(state.action)
    if rule.action == "finish" or (state.state == "idle" and not rule.is_fault):
        return state  # nothing moves that would have to stop
    if state.state == "fault":
        return replace(state, action=rule.action, cause=rule.event, since=now) if is_graver else state
    if state.state == "stopping" and not is_graver:
        return replace(state, is_fault=state.is_fault or rule.is_fault, cause=state.cause or rule.event)
    return SupervisorState(
        # What is limp already is a fault at once, and has nothing to straighten.
        state="fault" if state.state == "idle" else "stopping",
        action="limp" if state.state == "idle" and rule.action == "straighten" else rule.action,
        cause=rule.event,
        is_fault=state.is_fault or rule.is_fault,
        since=now,
        present=state.present,
    )


def _entry(now: float, event: str, action: str, before: SupervisorState, after: SupervisorState) -> Reaction:
    return Reaction(time=now, event=event, action=action, before=before.state, after=after.state)


def _check(events: Set[str]) -> None:
    known = (*BY_EVENT, *REQUESTS)
    for event in events:
        if event not in known:
            raise ValueError(f"`events` must hold events of the table only, got {event!r}{nearest(event, known)}")
