"""The tables of an operation and the step that keeps to them; that operations do, the rig asserts at every tick."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, strategies as st

from laticauda.operate.safety.limits import Reports, compare, no_reports, within_limits
from laticauda.operate.safety.supervisor import (
    ACTIONS,
    BY_EVENT,
    PHASES,
    REQUESTS,
    RULES,
    STATES,
    TRANSITIONS,
    Supervisor,
    SupervisorState,
    phase_with,
)
from laticauda.operate.settings import Limits
from laticauda.protocol import Heartbeat, NodeState

PAGE = Path(__file__).parents[3] / "docs" / "how-to" / "operate.md"
STOPPING = [rule.event for rule in RULES if rule.action != "finish"]
FAULTS = [rule.event for rule in RULES if rule.is_fault]
TICK = 0.01
supervisor = Supervisor(straighten_time=2.0)

events_at_a_tick = st.frozensets(st.sampled_from([*BY_EVENT, *REQUESTS]), max_size=3)
noise = st.lists(
    st.tuples(events_at_a_tick, st.booleans(), st.booleans(), st.sampled_from([TICK, 0.1, 0.5])), max_size=40
)


def brought_to(state: str) -> SupervisorState:
    return {
        "idle": SupervisorState(),
        "ready": SupervisorState(state="ready"),
        "running": SupervisorState(state="running"),
        "stopping": SupervisorState(state="stopping", action="straighten"),
        "fault": SupervisorState(state="fault", action="limp", cause="leak", is_fault=True),
    }[state]


def step(state: SupervisorState, now: float, *events: str, straight: bool = False, limp: bool = False):
    return supervisor.step(state, now, set(events), is_straight=straight, is_limp=limp)


def test_the_rows_name_phases_and_states_and_no_two_contradict_each_other():
    for row in TRANSITIONS:
        assert {row.phase, row.next_phase} <= set(PHASES) and {row.state, row.next_state} <= set(STATES)
        assert row.event not in BY_EVENT
    assert len({row[:3] for row in TRANSITIONS}) == len(TRANSITIONS)
    assert {row.event for row in TRANSITIONS} > set(REQUESTS)


def test_from_everywhere_the_robot_comes_to_rest_and_every_phase_is_reached():
    rows = [row for row in TRANSITIONS if row.event != "acknowledged"]
    reached = {("connecting", "idle")}
    for _ in rows:
        reached |= {row[3:] for row in rows if row[:2] in reached}
    assert {phase for phase, _ in reached} == set(PHASES)
    ends = {("done", "idle"), ("done", "fault")}
    for _ in rows:
        ends |= {row[:2] for row in rows if row[3:] in ends}
    assert ends == reached


def test_a_stop_of_the_supervisor_stops_the_operation_in_every_phase():
    for phase in PHASES[:-1]:
        for state in STATES:
            for stop in {"stopping", "fault"} - {state}:
                assert phase_with(phase, state, stop) == "stopping"


def state_diagram():
    """The table in the language of mermaid."""
    lines = ["stateDiagram-v2", "    [*] --> connecting_idle"]
    for phase, state in dict.fromkeys((row.phase, row.state) for row in TRANSITIONS):
        lines.append(f"    {phase}_{state} : {phase.replace('_', ' ')} / {state}")
    for row in TRANSITIONS:
        source, target = f"{row.phase}_{row.state}", f"{row.next_phase}_{row.next_state}"
        lines.append(f"    {source} --> {target} : {row.event.replace('_', ' ')}")
    return "\n".join([*lines, "    done_idle --> [*]", ""])


def test_the_diagram_of_the_docs_is_that_of_the_table():
    page = PAGE.read_text(encoding="utf-8")
    assert f"```mermaid\n{state_diagram()}```" in page


@given(st.sampled_from(STATES), st.sampled_from(STOPPING), noise, noise)
@example("ready", "over_temperature", [], [(frozenset({"emergency_key"}), False, False, 0.5)])  # what comes is graver
def test_from_any_state_any_events_lead_to_no_references_within_the_stated_time(state, event, before, after):
    now, at = 0.0, brought_to(state)
    for events, straight, limp, dt in before:
        now += dt
        at, _ = supervisor.step(at, now, events, is_straight=straight, is_limp=limp)
    now += TICK
    at, _ = step(at, now, event)
    end = over = now + supervisor.within(BY_EVENT[event].action)
    # Whatever else happens, as long as nobody starts anew.
    for events, straight, limp, dt in after:
        now += dt
        at, _ = supervisor.step(at, now, events - set(REQUESTS), is_straight=straight, is_limp=limp)
        assert now < end or not at.sends_references
        over = max([over, *(now + supervisor.within(BY_EVENT[one].action) for one in events & set(STOPPING))])
    while now < over:  # what came later has its own time to be over
        now += TICK
        at, _ = step(at, now)
        assert now < end or not at.sends_references
    assert not at.sends_references
    assert at.state in ("idle", "fault")


@given(st.sampled_from(FAULTS), noise)
def test_a_fault_is_left_by_an_acknowledgment_only_and_only_when_nothing_is_wrong(event, after):
    now, at = 0.0, brought_to("running")
    at, _ = step(at, now, event)
    while at.state != "fault":
        now += TICK
        at, _ = step(at, now, event)
        assert now < 10.0
    for events, straight, limp, dt in after:
        now += dt
        at, _ = supervisor.step(at, now, events - {"acknowledged"}, is_straight=straight, is_limp=limp)
        assert at.state == "fault"
    at, _ = step(at, now, event, "acknowledged", limp=True)
    assert at.state == "fault"
    at, _ = step(at, now, "acknowledged", limp=False)
    assert at.state == "fault"
    at, _ = step(at, now, "acknowledged", limp=True)
    assert at.state == "idle"


@given(noise)
def test_what_is_done_only_becomes_graver_until_the_robot_is_limp(steps):
    now, at = 0.0, brought_to("stopping")
    for events, straight, limp, dt in steps:
        now += dt
        after, _ = supervisor.step(at, now, events, is_straight=straight, is_limp=limp)
        if after.state in ("stopping", "fault") and at.state in ("stopping", "fault"):
            assert ACTIONS.index(after.action) >= ACTIONS.index(at.action)
        at = after


@given(noise)
def test_every_event_is_logged_once_when_it_begins_and_every_change_of_state_with_it(steps):
    now, at, present = 0.0, brought_to("running"), frozenset()
    for events, straight, limp, dt in steps:
        now += dt
        after, entries = supervisor.step(at, now, events, is_straight=straight, is_limp=limp)
        wrong = frozenset(events) & BY_EVENT.keys()
        logged = [entry.event for entry in entries]
        assert all(logged.count(event) == 1 for event in wrong - present)
        assert not any(event in logged for event in wrong & present)
        states = [at.state, *(entry.after for entry in entries)]
        assert states[-1] == after.state
        at, present = after, wrong


def test_the_normal_course_is_idle_ready_running_stopping_idle():
    at, seen = supervisor.init(), []
    for now, event, straight, limp in (
        (0.0, "checked", False, True),
        (1.0, "started", True, False),
        (2.0, "ended", False, False),
        (3.0, None, True, False),
        (3.1, None, True, True),
    ):
        at, _ = step(at, now, *([event] if event else []), straight=straight, limp=limp)
        seen.append(at.state)
    assert seen == ["ready", "running", "stopping", "stopping", "idle"]


def test_nothing_starts_while_something_is_wrong():
    assert step(supervisor.init(), 0.0, "checked", "lost_mocap", limp=True)[0].state == "fault"
    assert step(brought_to("ready"), 0.0, "started", "edge")[0].state == "stopping"


def test_a_leak_while_the_robot_straightens_stops_it_at_once():
    at, _ = step(brought_to("running"), 0.0, "operator_key")
    assert (at.state, at.action, at.is_fault) == ("stopping", "straighten", False)
    at, entries = step(at, 0.5, "operator_key", "leak")
    assert (at.action, at.is_fault, at.cause) == ("emergency_stop", True, "leak")
    assert [entry.event for entry in entries] == ["leak"]


@pytest.mark.parametrize("first", ["ended", "operator_key"])
def test_a_fault_that_comes_while_the_robot_already_stops_is_not_forgotten(first):
    at, _ = step(brought_to("running"), 0.0, first)
    assert (at.action, at.is_fault) == ("straighten", False)
    at, _ = step(at, 0.5, "lost_mocap")  # for a moment, and no graver than what is done already
    assert (at.state, at.action, at.is_fault) == ("stopping", "straighten", True)
    at, _ = step(at, 1.0, straight=True)
    at, _ = step(at, 1.1, limp=True)
    assert at.state == "fault"
    assert at.cause == ("lost_mocap" if first == "ended" else first)


def test_modules_that_do_not_go_limp_get_an_emergency_stop():
    at, now = replace(brought_to("stopping"), action="limp"), 0.0
    while at.action == "limp":
        now += TICK
        at, entries = step(at, now)
    assert now == pytest.approx(0.5, abs=0.02)
    assert (at.state, at.action) == ("fault", "emergency_stop")
    assert entries


def test_a_silent_power_meter_stops_nothing():
    at, entries = step(brought_to("running"), 0.0, "lost_meter")
    assert at.state == "running"
    assert [(entry.event, entry.action) for entry in entries] == [("lost_meter", "finish")]


def test_the_rules_are_sorted_by_gravity_and_say_what_they_mean():
    gravity = [ACTIONS.index(rule.action) for rule in RULES]
    assert gravity == sorted(gravity, reverse=True)
    assert len(BY_EVENT) == len(RULES)
    assert all(rule.says for rule in RULES)
    assert supervisor.within("emergency_stop") == pytest.approx(1.5)


def test_the_table_of_the_docs_is_that_of_the_code():
    page = PAGE.read_text(encoding="utf-8")
    words = {"finish": "finish the run", "straighten": "straighten, then limp"}
    for rule in RULES:
        action, within = words.get(rule.action, rule.action.replace("_", " ")), f"{supervisor.within(rule.action):g} s"
        then = f"{within} | {'fault' if rule.is_fault else 'idle'}" if rule.action != "finish" else "- | -"
        assert f"| `{rule.event}` | {rule.says} | {action} | {then} |" in page


def test_an_event_that_is_not_in_the_table_is_refused():
    with pytest.raises(
        ValueError, match=r"`events` must hold events of the table only, got 'leek'; did you mean `leak`"
    ):
        step(supervisor.init(), 0.0, "leek")
    with pytest.raises(ValueError, match=r"`straighten_time` must be > 0 s, got 0"):
        Supervisor(straighten_time=0.0)


WELL = Heartbeat(node=1, state=NodeState.ACTIVE)


def seen_at(now: float, *beats: Heartbeat, **measured: float) -> Reports:
    """Two modules that are asked to be straight, all numbers of which are zero unless `measured` says otherwise."""
    beats = beats or (WELL, replace(WELL, node=2))
    numbers = {name: np.array([0.0, measured.get(name, 0.0)]) for name in ("angle", "rate", "current", "torque")}
    times = np.full(2, now)
    modules = replace(no_reports(2), **numbers, heartbeat=beats, heartbeat_time=times, angle_time=times)
    references = np.zeros(2)
    return Reports(
        now=now, lateness=0.0, modules=modules, references=references, mocap_age=0.0, meter_age=None, room=1.0
    )


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("event", "name", "limit", "lasts", "says"),
    [
        ("joint_error", "angle", "max_joint_error", "joint_error_time", ("module 2: -57 deg", "module 2: +57 deg")),
        ("over_current", "current", "max_current", "current_time", ("module 2: 5.0 A", "module 2: -5.0 A")),
    ],
)
def test_what_is_beyond_its_limit_to_either_side_for_too_long_is_wrong(event, name, limit, lasts, says, sign):
    limits = Limits()
    patience, value = getattr(limits, lasts), {"angle": 1.0, "current": 5.0}[name]
    assert abs(value) > getattr(limits, limit)
    state, found = compare(limits, within_limits(2), seen_at(10.0, **{name: sign * value}))
    assert found == {}
    held, found = compare(limits, state, seen_at(10.0 + patience, **{name: sign * value}))
    assert found == {}
    _, found = compare(limits, held, seen_at(10.1 + patience, **{name: sign * value}))
    assert found == {event: says[0] if sign > 0 else says[1]}
    # One moment within the limit, and the time begins anew.
    back, _ = compare(limits, held, seen_at(10.05 + patience))
    _, found = compare(limits, back, seen_at(10.1 + patience, **{name: sign * value}))
    assert found == {}


def test_what_a_module_says_of_itself_is_told_before_what_it_does():
    limits = Limits()
    beats = (WELL, Heartbeat(node=2, state=NodeState.FAULT, stuck=True))
    seen = seen_at(10.0, *beats)
    state, found = compare(limits, replace(within_limits(2), sending=0.0), seen)
    assert found == {"module_fault": "module 2: stuck"}
    limp = (beats[0], Heartbeat(node=2, state=NodeState.LIMP))
    _, found = compare(limits, state, replace(seen, modules=replace(seen.modules, heartbeat=limp)))
    assert found == {"module_fault": "module 2 does not move: limp"}
