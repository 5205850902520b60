"""The tables that an operation keeps to, and that the documentation prints: what leads where, and what is done when.

The supervisor's state says whether the joints may move, the phase says what for:

    idle      the robot is limp; no reference is sent
    ready     the joints are held straight
    running   the joints follow the controller
    stopping  the robot is being straightened, and then made limp
    fault     limp, and it stays so until somebody acknowledges and nothing is wrong any more
"""

from dataclasses import dataclass
from typing import NamedTuple

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


TRANSITIONS: tuple[Transition, ...] = (
    Transition("connecting", "idle", "connected", "checking", "idle"),
    Transition("checking", "idle", "well", "calibrating", "idle"),
    Transition("calibrating", "idle", "calibrated", "idle_current", "idle"),
    Transition("idle_current", "idle", "measured", "settling", "idle"),
    Transition("settling", "idle", "only_checked", "done", "idle"),
    Transition("settling", "idle", "checked", "settling", "ready"),
    Transition("settling", "ready", "still", "countdown", "ready"),
    Transition("countdown", "ready", "started", "running", "running"),
    *(Transition(phase, "idle", "ended", "stopping", "idle") for phase in PREPARATIONS[:-1]),
    *(Transition(phase, "ready", "ended", "stopping", "stopping") for phase in ("settling", "countdown")),
    Transition("running", "running", "ended", "stopping", "stopping"),
    *(Transition(phase, "idle", "fault", "stopping", "fault") for phase in (*PREPARATIONS[:-1], "stopping")),
    *(Transition(phase, "ready", "stop", "stopping", "stopping") for phase in ("settling", "countdown")),
    Transition("running", "running", "stop", "stopping", "stopping"),
    *(Transition(phase, "ready", "limp_fault", "stopping", "fault") for phase in ("settling", "countdown")),
    Transition("running", "running", "limp_fault", "stopping", "fault"),
    Transition("stopping", "stopping", "limp", "stopping", "idle"),
    Transition("stopping", "stopping", "limp_fault", "stopping", "fault"),
    Transition("stopping", "idle", "settled", "done", "idle"),
    Transition("stopping", "fault", "settled", "done", "fault"),
    Transition("done", "fault", "acknowledged", "connecting", "idle"),
)
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


RULES: tuple[Rule, ...] = (
    Rule("emergency_key", "the operator hit the emergency stop", "emergency_stop"),
    Rule("leak", "a module reports water inside", "emergency_stop"),
    Rule("bus_off", "the computer is off the CAN bus", "emergency_stop"),
    Rule("over_temperature", "a module is too hot", "limp"),
    Rule("over_current", "a motor draws too much", "limp"),
    Rule("joint_error", "a joint does not follow its reference", "limp"),
    Rule("module_fault", "a module reports a fault of its own", "straighten"),
    Rule("low_voltage", "the supply's voltage is too low", "straighten"),
    Rule("lost_heartbeat", "a module is not heard any more", "straighten"),
    Rule("lost_joints", "a module does not report its angle any more", "straighten"),
    Rule("lost_mocap", "the motion capture does not see the robot", "straighten"),
    Rule("late_loop", "the computer was late", "straighten"),
    Rule("recorder_failed", "nothing is recorded any more", "straighten"),
    Rule("program_error", "the operator's program has an error", "straighten"),
    Rule("operator_key", "the operator stopped the run", "straighten", is_fault=False),
    Rule("edge", "the robot comes to the end of the tank or of the measuring volume", "straighten", is_fault=False),
    Rule("lost_meter", "the power meter is silent; the run goes on, and has no power", "finish", is_fault=False),
)
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
