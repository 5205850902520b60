"""The tables of an operation and the step that keeps to them; that operations do, the rig asserts at every tick."""

import math
from dataclasses import replace

import pytest
import safety_page
from hypothesis import example, given, strategies as st

from laticauda.tank.lab import NodeSettings
from laticauda.tank.operate.safety.supervisor import (
    ACTIONS,
    BY_EVENT,
    CONFIRM_TIME,
    HOLD_AFTER,
    LIMP_AFTER,
    LIMP_FROM,
    PHASES,
    REQUESTS,
    RULES,
    STATES,
    TRANSITIONS,
    Rule,
    Supervisor,
    SupervisorState,
    _table,
    cause_of,
    phase_after,
    phase_with,
)
from laticauda.tank.operate.settings import Limits

STOPPING = [rule.event for rule in RULES if rule.action != "finish"]
FAULTS = [rule.event for rule in RULES if rule.is_fault]
TICK = 0.01
supervisor = Supervisor(straighten_time=2.0)

events_at_a_tick = st.frozensets(st.sampled_from([*BY_EVENT, *REQUESTS]), max_size=3)
noise = st.lists(
    st.tuples(events_at_a_tick, st.booleans(), st.booleans(), st.sampled_from([TICK, 0.1, 0.5])),
    max_size=40,
)


def brought_to(state: str) -> SupervisorState:
    return {
        "idle": SupervisorState(),
        "ready": SupervisorState(state="ready"),
        "running": SupervisorState(state="running"),
        "stopping": SupervisorState(state="stopping", action="straighten"),
        "fault": SupervisorState(state="fault", action="limp", cause="leak", is_fault=True),
    }[state]


def step(
    state: SupervisorState,
    now: float,
    *events: str,
    straight: bool = False,
    limp: bool = False,
    on: bool | None = None,
):
    """One tick; unless it is said, modules are on if they are not limp."""
    is_on = not limp if on is None else on
    return supervisor.step(state, now, set(events), is_straight=straight, is_limp=limp, is_on=is_on)


def test_the_rows_name_phases_and_states_and_no_two_contradict_each_other():
    for row in TRANSITIONS:
        assert {row.phase, row.next_phase} <= set(PHASES) and {row.state, row.next_state} <= set(
            STATES
        )
        assert row.event not in BY_EVENT
    assert len({row[:3] for row in TRANSITIONS}) == len(TRANSITIONS)
    assert {row.event for row in TRANSITIONS} > set(REQUESTS)


def test_from_everywhere_the_robot_comes_to_rest_and_every_phase_is_reached():
    reached = {("connecting", "idle")}
    for _ in TRANSITIONS:
        reached |= {row[3:] for row in TRANSITIONS if row[:2] in reached}
    assert {phase for phase, _ in reached} == set(PHASES)
    ends = {("done", "idle"), ("done", "fault")}
    for _ in TRANSITIONS:
        ends |= {row[:2] for row in TRANSITIONS if row[3:] in ends}
    assert ends == reached
    assert not [row for row in TRANSITIONS if row.state == "fault" and row.next_state != "fault"]


def test_a_stop_of_the_supervisor_stops_the_operation_in_every_phase():
    for phase in PHASES[:-1]:
        for state in STATES:
            for stop in {"stopping", "fault"} - {state}:
                assert phase_with(phase, state, stop) == "stopping"


def test_no_two_rows_lead_to_different_phases_where_only_a_part_of_them_is_asked_for():
    by_event = {(row.phase, row.event, row.next_phase) for row in TRANSITIONS}
    assert len(by_event) == len({key[:2] for key in by_event})
    by_states = {
        (row.phase, row.state, row.next_state, row.next_phase)
        for row in TRANSITIONS
        if row.state != row.next_state
    }
    assert len(by_states) == len({key[:3] for key in by_states})


def test_an_operation_that_has_moved_on_at_the_same_tick_keeps_its_phase_unless_it_is_stopped():
    assert phase_with("stopping", "ready", "stopping") == "stopping"  # it has asked to end
    assert phase_with("done", "stopping", "idle") == "done"


def test_a_table_with_a_word_that_does_not_exist_is_refused_by_its_line():
    with pytest.raises(ValueError, match=r"torque.csv, line 3: no state 'ready'; did you mean"):
        _table("torque", {"state": ("idle", "read")})


def test_the_page_of_the_docs_is_the_one_that_the_tables_make():
    assert safety_page.PAGE.read_text(encoding="utf-8") == safety_page.page()


def test_the_page_names_the_limits_of_every_event_that_has_some():
    assert safety_page.limits_of() == {
        "over_temperature": ["max_temperature"],
        "over_current": ["max_current", "current_time"],
        "low_voltage": ["min_voltage"],
        "high_voltage": ["max_voltage"],
        "joint_error": ["max_joint_error", "joint_error_time"],
        "lost_heartbeat": ["heartbeat_timeout"],
        "lost_joints": ["joint_timeout"],
        "lost_mocap": ["mocap_timeout"],
        "lost_meter": ["meter_timeout"],
        "late_loop": ["max_lateness"],
        "edge": ["edge_margin"],
    }


@given(st.sampled_from(STATES), st.sampled_from(STOPPING), noise, noise)
@example(
    "ready", "over_temperature", [], [(frozenset({"emergency_key"}), False, False, 0.5)]
)  # what comes is graver
def test_from_any_state_any_events_lead_to_no_references_within_the_stated_time(
    state, event, before, after
):
    now, at = 0.0, brought_to(state)
    for events, straight, limp, dt in before:
        now += dt
        at, _ = supervisor.step(at, now, events, is_straight=straight, is_limp=limp, is_on=not limp)
    now += TICK
    at, _ = step(at, now, event)
    end = over = now + supervisor.within(BY_EVENT[event].action)
    # Whatever else happens, as long as nobody starts anew.
    for events, straight, limp, dt in after:
        now += dt
        at, _ = supervisor.step(
            at, now, events - set(REQUESTS), is_straight=straight, is_limp=limp, is_on=not limp
        )
        assert now < end or not at.sends_references
        over = max(
            [
                over,
                *(now + supervisor.within(BY_EVENT[one].action) for one in events & set(STOPPING)),
            ]
        )
    while now < over:  # what came later has its own time to be over
        now += TICK
        at, _ = step(at, now)
        assert now < end or not at.sends_references
    assert not at.sends_references
    assert at.state in ("idle", "fault")


@given(st.sampled_from(FAULTS), noise)
def test_a_fault_is_left_by_nothing_whatever_is_requested(event, after):
    now, at = 0.0, brought_to("running")
    at, _ = step(at, now, event)
    while at.state != "fault":
        now += TICK
        at, _ = step(at, now, event)
        assert now < 10.0
    for events, straight, limp, dt in after:
        now += dt
        at, _ = supervisor.step(at, now, events, is_straight=straight, is_limp=limp, is_on=not limp)
        assert (at.state, at.sends_references) == ("fault", False)


@given(noise)
def test_what_is_done_only_becomes_graver_until_the_robot_is_limp(steps):
    now, at = 0.0, brought_to("stopping")
    for events, straight, limp, dt in steps:
        now += dt
        after, _ = supervisor.step(
            at, now, events, is_straight=straight, is_limp=limp, is_on=not limp
        )
        if after.state in ("stopping", "fault") and at.state in ("stopping", "fault"):
            assert ACTIONS.index(after.action) >= ACTIONS.index(at.action)
        at = after


@given(noise)
def test_every_event_is_logged_once_when_it_begins_and_every_change_of_state_with_it(steps):
    now, at, present = 0.0, brought_to("running"), frozenset()
    for events, straight, limp, dt in steps:
        now += dt
        after, entries = supervisor.step(
            at, now, events, is_straight=straight, is_limp=limp, is_on=not limp
        )
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


def test_an_event_that_is_not_in_the_table_is_refused():
    with pytest.raises(
        ValueError,
        match=r"`events` must hold only events of the table, got 'leek'; did you mean `leak`",
    ):
        step(supervisor.init(), 0.0, "leek")
    with pytest.raises(ValueError, match=r"`straighten_time` must be > 0 s, got 0"):
        Supervisor(straighten_time=0.0)


def test_what_is_known_of_modules_and_times_is_what_the_documentation_promises():
    nodes = NodeSettings()
    assert (HOLD_AFTER, LIMP_AFTER) == (0.2, 1.2)
    assert nodes.hold_after == HOLD_AFTER
    assert (
        LIMP_FROM < nodes.limp_after < LIMP_AFTER
    )  # it counts on less, and on more, than they take
    assert Supervisor().straighten_time == Limits().straighten_time == 2.0
    assert [supervisor.within(action) for action in ACTIONS] == [
        math.inf,
        math.inf,
        *map(pytest.approx, (3.5, 1.5, 1.5)),
    ]


def test_an_event_is_said_in_words_and_one_without_a_rule_by_its_name():
    assert cause_of("leak") == "a module reports water inside"
    assert cause_of("ended") == "ended"
    assert Rule(event="a", says="b", action="limp").is_fault


def test_the_operation_goes_from_phase_to_phase_by_the_table():
    for row in TRANSITIONS:
        assert phase_after(row.phase, row.event) in {
            other.next_phase for other in TRANSITIONS if other[:3] == row[:3]
        }
    assert phase_after("connecting", "connected") == "checking"
    assert phase_with("settling", "idle", "ready") == "settling"
    assert phase_with("countdown", "ready", "running") == "running"


def test_motors_have_torque_in_ready_running_and_while_the_robot_straightens_and_never_else():
    told = {
        ("ready", "none"): "enable",
        ("running", "none"): "hold",
        ("stopping", "straighten"): "hold",
        ("stopping", "emergency_stop"): "cut",
        ("fault", "emergency_stop"): "cut",
    }
    for state in STATES:
        for action in ACTIONS:
            at = SupervisorState(state=state, action=action)
            assert at.torque == told.get((state, action), "off")
            assert at.sends_references == (at.torque in ("enable", "hold"))


def test_motors_are_switched_on_until_all_are_on_and_never_again_in_the_same_run():
    at, _ = step(supervisor.init(), 0.0, "checked", limp=True)
    assert at.torque == "enable"
    at, _ = step(at, 0.1, limp=False, on=False)
    assert at.torque == "enable"  # some are on
    at, _ = step(at, 0.2, on=True)
    assert at.torque == "hold"
    at, _ = step(at, 0.3, on=False)
    assert (at.state, at.torque) == ("ready", "hold")


def test_motors_are_not_switched_on_for_longer_than_a_module_surely_stays_on_without_references():
    at, _ = step(supervisor.init(), 0.0, "checked", limp=True)
    at, _ = step(at, LIMP_FROM - TICK, on=False)
    assert at.torque == "enable"
    at, _ = step(at, LIMP_FROM, on=False)
    assert at.torque == "hold"


def test_a_run_begins_only_when_every_motor_is_on():
    at, _ = step(supervisor.init(), 0.0, "checked", limp=True)
    assert step(at, 1.0, "started", on=False)[0].state == "ready"
    assert step(at, 1.0, "started", on=True)[0].state == "running"


def test_at_one_tick_one_request_counts_and_that_to_end_before_all_others():
    assert step(supervisor.init(), 0.0, "checked", "started", on=True)[0].state == "ready"
    assert step(supervisor.init(), 0.0, "checked", "ended", on=True)[0].state == "idle"
    assert step(brought_to("ready"), 0.0, "started", "ended", on=True)[0].state == "stopping"


def test_a_robot_that_is_limp_in_part_is_not_straightened():
    at, _ = step(brought_to("running"), 0.0, "operator_key", on=True)
    assert (at.action, at.torque) == ("straighten", "hold")
    at, _ = step(at, 0.1, "operator_key", on=False)
    assert (at.state, at.action, at.torque, at.is_fault) == ("stopping", "limp", "off", False)


@pytest.mark.parametrize("state", ["ready", "running", "stopping"])
def test_what_went_limp_makes_the_whole_robot_limp_at_once_and_stays_limp(state):
    at, _ = step(brought_to(state), 1.0, "went_limp", on=False)
    assert (at.state, at.action, at.torque, at.is_fault) == ("stopping", "limp", "off", True)
    at, _ = step(at, 1.1, limp=True)
    assert (at.state, at.cause) == ("fault", "went_limp")
    for request in REQUESTS:
        assert step(at, 9.0, request, limp=True)[0].state == "fault"


@pytest.mark.parametrize("event", ["operator_key", "edge"])
def test_a_key_at_the_tick_of_a_request_is_stronger_than_the_request(event):
    assert step(supervisor.init(), 0.0, "checked", event, limp=True)[0].state == "idle"


def course(
    at: SupervisorState, *ticks: tuple[float, str, bool, bool]
) -> list[tuple[str, str, str, str]]:
    """What is logged over some ticks: time, event or "", whether straight, whether limp."""
    logged = []
    for now, event, straight, limp in ticks:
        at, entries = step(at, now, *([event] if event else []), straight=straight, limp=limp)
        assert all(entry.time == now for entry in entries)
        logged += [(entry.event, entry.action, entry.before, entry.after) for entry in entries]
    return logged


def test_every_request_and_every_step_to_a_stop_is_logged_with_what_it_leads_to():
    assert course(
        supervisor.init(),
        (0.0, "checked", False, True),
        (1.0, "started", True, False),
        (2.0, "started", True, False),
        (3.0, "ended", False, False),
        (4.0, "", True, False),
        (4.1, "", True, True),
        (4.2, "", True, True),
    ) == [
        ("checked", "none", "idle", "ready"),
        ("started", "none", "ready", "running"),
        ("ended", "straighten", "running", "stopping"),
        ("limp", "limp", "stopping", "stopping"),
        ("idle", "none", "stopping", "idle"),
    ]


def test_straightening_ends_at_its_time_limp_at_its_time_and_an_emergency_stop_at_its():
    at = replace(brought_to("stopping"), since=8.0, is_fault=True, cause="lost_mocap")
    assert step(at, 9.75)[0] == at
    limp, entries = step(at, 10.0)
    assert (limp.state, limp.action, limp.since) == ("stopping", "limp", 10.0)
    assert [entry.event for entry in entries] == ["limp"]
    assert step(limp, 10.25)[0] == limp
    stopped, entries = step(limp, 10.0 + CONFIRM_TIME)
    assert (stopped.state, stopped.action, stopped.is_fault, stopped.cause) == (
        "fault",
        "emergency_stop",
        True,
        "lost_mocap",
    )
    assert [(entry.event, entry.action) for entry in entries] == [("fault", "emergency_stop")]
    assert step(stopped, 99.0)[0] == stopped
    hit = SupervisorState(state="stopping", action="emergency_stop", cause="leak", is_fault=True)
    assert step(hit, 1.0)[0] == hit
    assert step(hit, LIMP_AFTER)[0] == replace(hit, state="fault")


def test_a_stop_that_nobody_confirms_is_a_fault_of_its_own():
    at, _ = step(replace(brought_to("stopping"), action="limp", cause=""), CONFIRM_TIME)
    assert (at.state, at.action, at.cause, at.is_fault) == (
        "fault",
        "emergency_stop",
        "not_limp",
        True,
    )


@pytest.mark.parametrize(
    ("event", "action"),
    [("leak", "emergency_stop"), ("over_current", "limp"), ("lost_mocap", "limp")],
)
def test_a_robot_that_is_limp_already_is_a_fault_at_once_and_has_nothing_to_straighten(
    event, action
):
    at, entries = step(supervisor.init(), 3.0, event)
    assert (at.state, at.action, at.cause, at.is_fault, at.since) == (
        "fault",
        action,
        event,
        True,
        3.0,
    )
    assert [(entry.before, entry.after) for entry in entries] == [("idle", "fault")]
    graver, _ = step(at, 4.0, "emergency_key")
    assert (graver.state, graver.action, graver.cause) == (
        ("fault", "emergency_stop", "emergency_key")
        if action == "limp"
        else ("fault", action, event)
    )
