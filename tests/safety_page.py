"""The page of the docs that has all that the supervisor does, written from the tables that it reads.

python tests/safety_page.py    # writes docs/safety-tables.md
"""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from laticauda.tank.operate.safety.limits import LimitState, Reports, compare_with_limits
from laticauda.tank.operate.safety.modules import Modules
from laticauda.tank.operate.safety.supervisor import (
    CONFIRM_TIME,
    HOLD_AFTER,
    LIMP_AFTER,
    LIMP_FROM,
    MARGIN,
    RULES,
    TORQUE,
    TRANSITIONS,
    Supervisor,
    SupervisorState,
)
from laticauda.tank.operate.settings import Limits
from laticauda.tank.protocol import Heartbeat, NodeState
from laticauda.values.quantities import quantities_of, texts_of

PAGE = Path(__file__).parent.parent / "docs" / "safety-tables.md"
WORDS = {"finish": "finish the run", "straighten": "straighten, then limp"}


def seen(now: float, *, beyond: bool) -> Reports:
    """One module beside a limit of everything: just within, or beyond of what has to last."""
    one = {name: np.ones(1) for name in ("angle", "rate", "current", "torque")}
    if beyond:
        one |= {"current": np.full(1, 9.0), "angle": np.full(1, 3.0)}
    beat = Heartbeat(node=1, state=NodeState.ACTIVE, temperature=30.0, voltage=35.0)
    times = {name: np.full(1, now - 0.1) for name in ("heartbeat_time", "angle_time")}
    modules = replace(Modules.before_messages(1), **one, **times, heartbeat=(beat,))
    at = {
        "now": now,
        "lateness": 0.01,
        "pause": 0.02,
        "mocap_age": 0.1,
        "meter_age": 0.1,
        "room": 1.0,
    }
    return Reports(**at, modules=modules, references=np.full(1, 0.5))


def limits_of() -> dict[str, list[str]]:
    """The limits of every event that has some: those that bring it about when they are moved to nothing, or far out."""
    found: dict[str, list[str]] = {}
    for name in quantities_of(Limits):
        for beyond, later in ((False, 5.0), (True, 1.0)):
            for moved in (1e-9, 100.0):
                limits = replace(Limits(), **{name: moved})
                state, _ = compare_with_limits(
                    limits, LimitState.initial(1), seen(0.0, beyond=beyond)
                )
                for event in compare_with_limits(limits, state, seen(later, beyond=beyond))[1]:
                    if name not in found.setdefault(event, []):
                        found[event].append(name)
    return found


TEXT = """\
<!-- Written by tests/safety_page.py from the tables that the supervisor reads: change those. -->
# What stops the robot

These are all events, actions, deadlines, phases and transitions of an operation, from the tables that the supervisor
reads (`rules.csv`, `torque.csv` and `transitions.csv` of `tank/operate/safety`), and no others.
[Operate the robot](how-to/operate.md) says what they mean for who stands at the tank.

## Events

The time is from the event until every joint is limp, even if every frame on the bus is lost, with the usual
`straighten_time`. It rests on the modules: without references they hold after {hold:g} s and are limp after {limp:g} s
at the latest; {margin:g} s more are for ticks and frames on their way. Modules that do not report that they are limp
{confirm:g} s after they were to be get an emergency stop. The gravest events come first, and theirs is what is done.

{rules}

Nothing leads out of `fault`: the operation ends limp, and the robot moves again only when somebody who has looked at it
starts another one, with all its checks. In a series, that person presses Enter between two runs.

## Torque

Torque never returns without a person: what the motors are told depends on the supervisor alone, and it has them
switched on only when a run is made ready.

{torque}

- `enable`: motors are switched on until all are on, for at most {limp_from:g} s after the robot is made ready; from
  then on as `hold`. Every such order is an entry of the recording. A tick that takes too long sends none.
- `hold`: what is on follows its references; what is off stays off.
- `off`: motors are switched off. `cut`: the same by an emergency stop, which has to be cleared.

A module that was on and is off has gone limp (`went_limp`): the robot goes limp at once, and the operation ends in
`fault`. So has every module if the program was away for more than {limp_from:g} s, whatever they said last.
`python campaigns/supervisor_states.py` tries every step from every state that can be reached.

## Limits

The table `[limits]` of a trial file, with its usual numbers. Which limit leads to which event is found by moving each.

{limits}

## Phases

Beside the phase of the operation stands the state of its supervisor. `ended` before the run means that it was given up,
`stop` is an event of the first table, `fault` and `limp_fault` are those that end in `fault`. `settled`: the
modules say that they are limp, or have had the time for it.

| phase | supervisor | event | next phase | supervisor then |
|---|---|---|---|---|
{transitions}

```mermaid
{diagram}```
"""


def page() -> str:
    """The whole page."""
    rows = [f"| {a} | {b} | `{event}` | {c} | {d} |" for a, b, event, c, d in TRANSITIONS]
    return TEXT.format(
        hold=HOLD_AFTER,
        limp=LIMP_AFTER,
        margin=MARGIN,
        confirm=CONFIRM_TIME,
        limp_from=LIMP_FROM,
        rules="\n".join(rules()),
        torque="\n".join(torque()),
        limits="\n".join(limits()),
        transitions="\n".join(rows),
        diagram=state_diagram(),
    )


def rules() -> list[str]:
    """The table of the events."""
    supervisor, of_event = Supervisor(), limits_of()
    found = [
        "| event | what happened | limits | action | limp within | then |",
        "|---|---|---|---|---|---|",
    ]
    for rule in RULES:
        action = WORDS.get(rule.action, rule.action.replace("_", " "))
        within = supervisor.within(rule.action)
        then = f"{within:g} s | {'fault' if rule.is_fault else 'idle'}" if within < 1e9 else "- | -"
        named = ", ".join(f"`{name}`" for name in of_event.get(rule.event, ())) or "-"
        found.append(f"| `{rule.event}` | {rule.says} | {named} | {action} | {then} |")
    return found


def torque() -> list[str]:
    """The table of what the motors are told."""
    found = ["| supervisor | action | motors | references |", "|---|---|---|---|"]
    for (state, action), told in TORQUE.items():
        sends = SupervisorState(state=state, action=action).sends_references
        name = action.replace("_", " ").replace("none", "-")
        found.append(f"| {state} | {name} | `{told}` | {'yes' if sends else '-'} |")
    return found


def limits() -> list[str]:
    """The table of the limits, in the units of a file."""
    found, usual = ["| limit | usual | |", "|---|---|---|"], Limits()
    texts, quantities = texts_of(Limits), quantities_of(Limits)
    for name, text in texts.items():
        unit, value = quantities[name].unit, getattr(usual, name)
        if unit == "rad":
            name, unit, value = f"{name}_deg", "deg", math.degrees(value)
        found.append(f"| `{name}` | {value:g} {unit} | {text} |")
    return found


def state_diagram() -> str:
    """The transitions in the language of mermaid."""
    lines = ["stateDiagram-v2", "    [*] --> connecting_idle"]
    sources = [(row.phase, row.state) for row in TRANSITIONS]
    targets = [(row.next_phase, row.next_state) for row in TRANSITIONS]
    for phase, state in dict.fromkeys([*sources, *targets]):
        lines.append(f"    {phase}_{state} : {phase.replace('_', ' ')} / {state}")
    for row in TRANSITIONS:
        source, target = f"{row.phase}_{row.state}", f"{row.next_phase}_{row.next_state}"
        lines.append(f"    {source} --> {target} : {row.event.replace('_', ' ')}")
    return "\n".join([*lines, "    done_idle --> [*]", "    done_fault --> [*]", ""])


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
