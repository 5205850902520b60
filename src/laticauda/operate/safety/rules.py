"""Which event leads to which action: the table that the supervisor keeps to, and that the documentation prints."""

from dataclasses import dataclass

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
