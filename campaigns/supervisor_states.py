"""Is there any way through the safety supervisor on which torque returns without a person?

Question: in every state that the supervisor can reach, whatever is wrong, whatever is requested and
whatever the modules report, do its laws hold (`LAWS`)? Above all: motors have torque only in
`ready`, in `running`, and in `stopping` as long as nothing has gone limp since `ready`.

    python campaigns/supervisor_states.py             # all pairs of events; writes supervisor_states.csv
    python campaigns/supervisor_states.py --events 1  # one event at a time; nothing is written

The search is exhaustive. A step depends on the time only by the age of the current action, and on
that only by the thresholds of the supervisor, which lie between the multiples of `GRID`. The tests
search with one event at a time.

Last answer (2026-11-29): 578 states; 443 904 steps with one event at a time (6 s of a free core),
5 123 392 with pairs; no violation. With the old rule, by which motors are switched on while the
robot straightens, too, a law is broken 12 234 times with one event at a time.
"""

import argparse
import csv
import itertools
import math
import sys
import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from laticauda.tank.operate.safety.supervisor import (
    ACTIONS,
    BY_EVENT,
    REQUESTS,
    RULES,
    Supervisor,
    SupervisorState,
)

STORED = Path(__file__).with_suffix(".csv")
COLUMNS = ("events", "states", "steps", "violations")
GRID = 0.2
"""Step of the ages that are told apart [s]; every threshold lies on it, or alone between two."""
OLDEST = 2.0
"""Age from which nothing changes any more [s]: the time for straightening."""
LAPSES = (0.2, 0.6, 1.0, 2.0)
"""Times between two ticks [s]."""


class Place(NamedTuple):
    """What is told apart of a state, and whether the robot has been limp since it was last made ready."""

    state: str
    action: str
    cause: str
    is_fault: bool
    is_enabled: bool
    age: float
    was_limp: bool

    def supervisor_state(self) -> SupervisorState:
        """The state, in which the current action began at time zero."""
        return SupervisorState(
            state=self.state,
            action=self.action,
            cause=self.cause,
            is_fault=self.is_fault,
            is_enabled=self.is_enabled,
        )


@dataclass(frozen=True, kw_only=True)
class Step:
    """One step of the supervisor."""

    before: SupervisorState
    after: SupervisorState
    events: frozenset[str]
    is_on: bool
    was_limp: bool
    """Whether the robot has been limp since it was last made ready, or is limp now."""

    @property
    def is_made_ready(self) -> bool:
        """Whether the robot is made ready by this step."""
        return self.after.state == "ready" and self.before.state != "ready"

    @property
    def has_stop(self) -> bool:
        """Whether something is wrong that stops a robot."""
        return any(BY_EVENT[one].action != "finish" for one in self.events & BY_EVENT.keys())

    @property
    def has_fault(self) -> bool:
        """Whether something is wrong that ends in a fault."""
        return any(BY_EVENT[one].is_fault for one in self.events & BY_EVENT.keys())


def _torque_returns(step: Step) -> bool:
    return step.was_limp and step.after.sends_references


def _switched_on_elsewhere(step: Step) -> bool:
    return step.after.torque == "enable" and step.after.state != "ready"


def _switched_on_again(step: Step) -> bool:
    is_new = step.after.torque == "enable" and step.before.torque != "enable"
    return is_new and not step.is_made_ready


def _ready_unasked(step: Step) -> bool:
    is_asked = step.before.state == "idle" and "checked" in step.events
    return step.is_made_ready and not is_asked


def _ready_while_stopped(step: Step) -> bool:
    return step.is_made_ready and step.has_stop


def _moves_with_fault(step: Step) -> bool:
    return step.has_fault and step.after.state in ("ready", "running")


def _torque_in_emergency(step: Step) -> bool:
    return step.after.action == "emergency_stop" and step.after.torque != "cut"


def _torque_in_fault(step: Step) -> bool:
    return step.after.state == "fault" and step.after.sends_references


def _stop_undone(step: Step) -> bool:
    return step.before.state == "stopping" and step.after.state in ("ready", "running")


def _milder(step: Step) -> bool:
    stopped = ("stopping", "fault")
    if step.before.state not in stopped or step.after.state not in stopped:
        return False
    return ACTIONS.index(step.after.action) < ACTIONS.index(step.before.action)


def _fault_forgotten(step: Step) -> bool:
    return step.before.is_fault and not step.after.is_fault


def _fault_left(step: Step) -> bool:
    return step.before.state == "fault" and step.after.state != "fault"


LAWS: dict[str, Callable[[Step], bool]] = {
    "torque returns to a robot that has been limp": _torque_returns,
    "a motor is switched on outside `ready`": _switched_on_elsewhere,
    "a motor is switched on twice": _switched_on_again,
    "the robot is made ready although nobody has asked for it": _ready_unasked,
    "the robot is made ready while something stops it": _ready_while_stopped,
    "the robot moves with a fault": _moves_with_fault,
    "an emergency stop is not sent to the motors": _torque_in_emergency,
    "references are sent in `fault`": _torque_in_fault,
    "a stop is undone": _stop_undone,
    "a stop becomes milder": _milder,
    "a fault is forgotten": _fault_forgotten,
    "a fault is left, without another operation": _fault_left,
}
"""What breaks a law, in words, and the function that sees it in a step."""


@dataclass(kw_only=True)
class Answer:
    """What a search found."""

    places: dict[Place, None] = field(default_factory=dict[Place, None])
    """All reachable states."""
    n_steps: int = 0
    """Steps that were tried [-]."""
    violations: list[str] = field(default_factory=list[str])
    """Every step that breaks a law, in words."""


def search(n_events: int, *, most: float = math.inf) -> Answer:
    """Try every step from every reachable state.

    Args:
        n_events: Largest number of events and requests at one tick.
        most: Number of violations after which the search is given up.
    """
    supervisor = Supervisor(straighten_time=OLDEST)
    names = [rule.event for rule in RULES] + list(REQUESTS)
    groups = [
        frozenset(group)
        for size in range(n_events + 1)
        for group in itertools.combinations(names, size)
    ]
    first = Place("idle", "none", "", False, False, 0.0, True)
    answer = Answer(places={first: None})
    waiting = deque([first])
    while waiting and len(answer.violations) < most:
        place = waiting.popleft()
        for step, then in _steps_from(place, supervisor, groups):
            answer.n_steps += 1
            for law, is_broken in LAWS.items():
                if is_broken(step):
                    answer.violations.append(f"{law}: {place}, {sorted(step.events)} -> {then}")
            if then not in answer.places:
                answer.places[then] = None
                waiting.append(then)
    return answer


def _steps_from(
    place: Place, supervisor: Supervisor, groups: list[frozenset[str]]
) -> Iterator[tuple[Step, Place]]:
    """Every step from a state, and where it leads."""
    before = place.supervisor_state()
    booleans = (False, True)
    for lapse in LAPSES:
        now = round(place.age + lapse, 1)
        for is_straight, is_limp, is_on in itertools.product(booleans, repeat=3):
            for events in groups:
                after, _ = supervisor.step(
                    before, now, events, is_straight=is_straight, is_limp=is_limp, is_on=is_on
                )
                step = Step(
                    before=before,
                    after=after,
                    events=events,
                    is_on=is_on,
                    was_limp=_was_limp(place, after, events, is_on=is_on),
                )
                age = min(round(now - after.since, 1), OLDEST)
                then = Place(
                    after.state,
                    after.action,
                    after.cause,
                    after.is_fault,
                    after.is_enabled,
                    age,
                    step.was_limp,
                )
                yield step, then


def _was_limp(place: Place, after: SupervisorState, events: frozenset[str], *, is_on: bool) -> bool:
    """Whether the robot has been limp since it was last made ready.

    It is limp when its motors are told to be off, when a module says that it has gone limp, and
    when a motor turns out to be off while the robot stops.
    """
    if after.state == "ready" and place.state == "idle":
        return False
    is_told = not after.sends_references
    says_so = "went_limp" in events or (place.state == "stopping" and not is_on)
    return place.was_limp or is_told or says_so


def stored() -> list[dict[str, str]]:
    """The last answer."""
    with STORED.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--events", type=int, help="most events at a tick; default: 1, then 2")
    options = parser.parse_args()
    rows = list[tuple[int, int, int, int]]()
    for n_events in (1, 2) if options.events is None else (options.events,):
        began = time.monotonic()
        answer = search(n_events)
        rows.append((n_events, len(answer.places), answer.n_steps, len(answer.violations)))
        print(
            f"up to {n_events} at a tick: {len(answer.places)} states, {answer.n_steps} steps, "
            f"{len(answer.violations)} violations, {time.monotonic() - began:.0f} s"
        )
        for violation in answer.violations[:10]:
            print(f"    {violation}")
    if options.events is None:
        with STORED.open("w", newline="", encoding="utf-8") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(COLUMNS)
            table.writerows(rows)
    return int(any(row[-1] for row in rows))


if __name__ == "__main__":
    sys.exit(main())
