"""What the modules say, beside the limits: every limit at its edge, every sentence, and whose module it names."""

import math
from dataclasses import replace

import numpy as np
import pytest

from laticauda.tank.operate.safety.limits import SPIN_UP, LimitState, Reports, compare_with_limits
from laticauda.tank.operate.safety.modules import Modules, list_complaints, update_modules
from laticauda.tank.operate.safety.supervisor import BY_EVENT, LIMP_FROM
from laticauda.tank.operate.settings import Limits
from laticauda.tank.protocol import Acceleration, Heartbeat, JointState, NodeState, Sync

LIMITS = Limits()


def modules_that(
    *beats: Heartbeat | None, heard: float = 0.0, measured: float = 0.0, **numbers: float
) -> Modules:
    """Modules of which the second has these numbers, and the others zeros."""
    n = len(beats)
    values = {name: np.zeros(n) for name in ("angle", "rate", "current", "torque")}
    for name, value in numbers.items():
        values[name][1] = value
    times = {"heartbeat_time": np.full(n, heard), "angle_time": np.full(n, measured)}
    return replace(Modules.before_messages(n), **values, **times, heartbeat=beats)


WELL = Heartbeat(node=1, state=NodeState.ACTIVE)


def seen_at(now: float, *beats: Heartbeat, **measured: float) -> Reports:
    """Two modules that are asked to be straight, all numbers of which are zero unless `measured` says otherwise."""
    beats = beats or (WELL, replace(WELL, node=2))
    numbers = {
        name: np.array([0.0, measured.get(name, 0.0)])
        for name in ("angle", "rate", "current", "torque")
    }
    times = np.full(2, now)
    modules = replace(
        Modules.before_messages(2),
        **numbers,
        heartbeat=beats,
        heartbeat_time=times,
        angle_time=times,
    )
    references = np.zeros(2)
    return Reports(
        now=now,
        lateness=0.0,
        pause=0.02,
        modules=modules,
        references=references,
        mocap_age=0.0,
        meter_age=None,
        room=1.0,
    )


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("event", "name", "limit", "lasts", "says"),
    [
        (
            "joint_error",
            "angle",
            "max_joint_error",
            "joint_error_time",
            ("module 2: -57 deg", "module 2: +57 deg"),
        ),
        (
            "over_current",
            "current",
            "max_current",
            "current_time",
            ("module 2: 5.0 A", "module 2: -5.0 A"),
        ),
    ],
)
def test_what_is_beyond_its_limit_to_either_side_for_too_long_is_wrong(
    event, name, limit, lasts, says, sign
):
    limits = Limits()
    patience, value = getattr(limits, lasts), {"angle": 1.0, "current": 5.0}[name]
    assert abs(value) > getattr(limits, limit)
    state, found = compare_with_limits(
        limits, LimitState.initial(2), seen_at(10.0, **{name: sign * value})
    )
    assert found == {}
    held, found = compare_with_limits(
        limits, state, seen_at(10.0 + patience, **{name: sign * value})
    )
    assert found == {}
    _, found = compare_with_limits(limits, held, seen_at(10.1 + patience, **{name: sign * value}))
    assert found == {event: says[0] if sign > 0 else says[1]}
    # One moment within the limit, and the time begins anew.
    back, _ = compare_with_limits(limits, held, seen_at(10.05 + patience))
    _, found = compare_with_limits(limits, back, seen_at(10.1 + patience, **{name: sign * value}))
    assert found == {}


def test_what_a_module_says_of_itself_is_told_before_what_it_does():
    limits = Limits()
    beats = (WELL, Heartbeat(node=2, state=NodeState.FAULT, stuck=True))
    seen = seen_at(10.0, *beats)
    state, found = compare_with_limits(limits, replace(LimitState.initial(2), sending=0.0), seen)
    assert found == {"module_fault": "module 2: stuck"}
    limp = (beats[0], Heartbeat(node=2, state=NodeState.LIMP))
    _, found = compare_with_limits(
        limits, state, replace(seen, modules=replace(seen.modules, heartbeat=limp))
    )
    assert found == {"module_fault": "module 2 does not move: limp"}


def test_before_any_message_nothing_is_known_and_every_module_is_silent():
    modules = Modules.before_messages(3)
    assert modules.n == 3
    assert modules.unheard == (1, 2, 3) and not modules.all_active()
    assert modules.is_limp(0.0, 1e9)  # of what is not heard, nothing says that it moves
    assert modules.silent(0.0, 1e9) == (1, 2, 3)
    for name in ("angle", "rate", "current", "torque"):
        assert np.isnan(getattr(modules, name)).all()
    assert np.isneginf(modules.angle_time).all() and np.isneginf(modules.heartbeat_time).all()


def test_messages_count_for_their_module_and_those_of_others_for_none():
    beat = Heartbeat(node=2, state=NodeState.READY)
    messages = [
        (1.0, JointState(node=2, angle=0.1, rate=0.2, current=0.3, torque=0.4)),
        (2.0, beat),
        (3.0, Acceleration(node=1, along=0.0, left=0.0, up=9.8)),
        (4.0, JointState(node=3, angle=9.0, rate=9.0, current=9.0, torque=9.0)),
        (5.0, Heartbeat(node=3, state=NodeState.FAULT)),
        (6.0, JointState(node=19, angle=9.0, rate=9.0, current=9.0, torque=9.0)),
        (7.0, Heartbeat(node=19, state=NodeState.FAULT)),
    ]
    before = Modules.before_messages(2)
    after = update_modules(before, messages)
    assert [getattr(after, name)[1] for name in ("angle", "rate", "current", "torque")] == [
        0.1,
        0.2,
        0.3,
        0.4,
    ]
    assert after.angle_time.tolist() == [-math.inf, 1.0]
    assert after.heartbeat == (None, beat) and after.heartbeat_time.tolist() == [-math.inf, 2.0]
    assert np.isnan(after.angle[0])
    assert np.isnan(before.angle).all() and before.heartbeat == (
        None,
        None,
    )  # a value is not changed
    last = update_modules(
        after, [(8.0, JointState(node=1, angle=-0.1, rate=0.0, current=0.0, torque=0.0))]
    )
    assert last.angle.tolist() == [-0.1, 0.1] and last.angle_time.tolist() == [8.0, 1.0]
    first = update_modules(after, [(9.0, Heartbeat(node=1, state=NodeState.READY))])
    assert first.heartbeat_time.tolist() == [9.0, 2.0]


def test_a_node_is_unheard_until_it_has_sent_a_heartbeat_and_an_angle():
    beats = WELL, replace(WELL, node=2)
    assert modules_that(*beats).unheard == ()
    assert modules_that(*beats, angle=math.nan).unheard == (2,)
    assert modules_that(WELL, None).unheard == (2,)


def test_limp_is_who_says_so_or_is_not_heard_in_time():
    off, on = replace(WELL, state=NodeState.LIMP), replace(WELL, node=2)
    assert modules_that(off, replace(off, node=2)).is_limp(0.0, 0.5)
    assert not modules_that(off, on).is_limp(0.5, 0.5)
    assert modules_that(off, on).is_limp(0.51, 0.5)
    assert modules_that(off, None).is_limp(0.0, 0.5)
    assert not modules_that(on, None).is_limp(0.0, 0.5)
    assert not modules_that(off, on, heard=10.0).is_limp(10.5, 0.5)


def test_all_are_active_only_if_each_follows_or_holds_its_references():
    hold = Heartbeat(node=2, state=NodeState.HOLD)
    assert modules_that(WELL, hold).all_active()
    assert not modules_that(WELL, None).all_active()
    assert not modules_that(WELL, replace(hold, state=NodeState.READY)).all_active()


def test_silent_is_who_has_not_been_heard_for_longer_than_allowed():
    modules = replace(Modules.before_messages(3), heartbeat_time=np.array([1.0, 0.5, 0.75]))
    assert modules.silent(1.5, 0.75) == (2,)
    assert modules.silent(1.25, 0.75) == ()


SOUND = Heartbeat(node=1, state=NodeState.READY, temperature=30.0, voltage=35.0)


@pytest.mark.parametrize(
    ("beat", "says"),
    [
        (None, ["module 2 does not respond: check its power and its bus connection"]),
        (
            replace(SOUND, leak=True),
            ["module 2 reports water inside: take the robot out and dry it"],
        ),
        (
            replace(SOUND, state=NodeState.STARTUP),
            ["module 2 is still starting up: wait, or restart it"],
        ),
        (
            replace(SOUND, state=NodeState.CALIBRATING),
            ["module 2 is still calibrating: wait, or restart it"],
        ),
        (replace(SOUND, state=NodeState.LIMP), []),
        (replace(SOUND, state=NodeState.FAULT), ["module 2 is in its fault state (no flag)"]),
        (
            replace(SOUND, state=NodeState.FAULT, over_current=True, emergency_stopped=True),
            ["module 2 is in its fault state (over current, emergency stopped)"],
        ),
        (replace(SOUND, temperature=60.0), []),
        (replace(SOUND, temperature=60.1), ["module 2 is at 60 degC, limit 60: let it cool"]),
        (replace(SOUND, voltage=28.0), []),
        (replace(SOUND, voltage=27.9), ["module 2 has 27.9 V, but needs 28.0: check the supply"]),
        (
            replace(SOUND, leak=True, voltage=1.0),
            [
                "module 2 reports water inside: take the robot out and dry it",
                "module 2 has 1.0 V, but needs 28.0: check the supply",
            ],
        ),
    ],
)
def test_what_speaks_against_starting_is_said_of_its_module_with_what_to_look_at(beat, says):
    # A third one that is well: what follows a silent module is looked at, too.
    modules = modules_that(SOUND, beat, replace(SOUND, node=3, leak=True))
    found = list_complaints(modules, max_temperature=60.0, min_voltage=28.0)
    assert found == (*says, "module 3 reports water inside: take the robot out and dry it")


def test_a_bus_with_more_modules_than_the_robot_has_joints_is_that_of_another_robot():
    angles = {"angle": 0.0, "rate": 0.0, "current": 0.0, "torque": 0.0}
    modules = modules_that(SOUND, replace(SOUND, node=2))
    other = update_modules(modules, [(1.0, JointState(node=18, **angles)), (1.0, Sync(counter=1))])
    assert (
        modules.highest,
        update_modules(modules, [(0.5, Sync(counter=1))]).highest,
        other.highest,
    ) == (
        0,
        0,
        18,
    )
    assert list_complaints(other, max_temperature=60.0, min_voltage=28.0) == (
        "module 18 responds, but the robot has 2: check `robot`",
    )
    same = update_modules(
        modules, [(1.0, JointState(node=2, **angles)), (1.0, replace(SOUND, node=1))]
    )
    assert list_complaints(same, max_temperature=60.0, min_voltage=28.0) == ()


def test_a_robot_that_is_well_and_in_time_breaks_no_limit():
    state, found = compare_with_limits(LIMITS, LimitState.initial(2), seen_at(10.0))
    assert found == {}
    assert np.isposinf(state.current).all() and np.isposinf(state.joint_error).all()
    assert state.sending == 10.0
    again, _ = compare_with_limits(LIMITS, state, seen_at(10.5))
    assert again.sending == 10.0  # since the first one
    stopped, _ = compare_with_limits(LIMITS, state, replace(seen_at(11.0), references=None))
    assert stopped.sending == math.inf


@pytest.mark.parametrize(
    ("event", "field", "edge", "beyond", "says"),
    [
        ("late_loop", "lateness", LIMITS.max_lateness, 0.25, "a tick came 0.250 s late"),
        ("lost_mocap", "mocap_age", LIMITS.mocap_timeout, 2.0, "the robot was last seen 2.0 s ago"),
        ("edge", "room", LIMITS.edge_margin, 0.125, "0.12 m left to the edge"),
        ("edge", "room", LIMITS.edge_margin, -3.0, "0.00 m left to the edge"),
        ("lost_meter", "meter_age", LIMITS.meter_timeout, 4.0, "the meter was last read 4.0 s ago"),
    ],
)
def test_at_its_limit_nothing_is_wrong_and_beyond_it_one_event_is(event, field, edge, beyond, says):
    assert (
        compare_with_limits(LIMITS, LimitState.initial(2), replace(seen_at(10.0), **{field: edge}))[
            1
        ]
        == {}
    )
    assert compare_with_limits(
        LIMITS, LimitState.initial(2), replace(seen_at(10.0), **{field: beyond})
    )[1] == {event: says}
    assert event in BY_EVENT


def test_where_no_references_are_sent_neither_the_edge_nor_the_cameras_matter_nor_joints():
    seen = replace(
        seen_at(10.0, angle=2.0), references=None, mocap_age=99.0, room=-1.0, lateness=1.0
    )
    state, found = compare_with_limits(LIMITS, LimitState.initial(2), seen)
    assert found == {"late_loop": "a tick came 1.000 s late"}
    assert np.isposinf(state.joint_error).all()


def test_modules_that_stay_away_are_named():
    seen = seen_at(10.0)
    edge = replace(seen.modules, heartbeat_time=np.full(2, 9.5), angle_time=np.full(2, 9.7))
    exact = replace(LIMITS, heartbeat_timeout=0.5, joint_timeout=10.0 - 9.7)
    assert compare_with_limits(exact, LimitState.initial(2), replace(seen, modules=edge))[1] == {}
    late = replace(
        seen.modules, heartbeat_time=np.array([10.0, 9.0]), angle_time=np.array([9.0, 10.0])
    )
    found = compare_with_limits(LIMITS, LimitState.initial(2), replace(seen, modules=late))[1]
    assert found == {"lost_heartbeat": "module 2", "lost_joints": "module 1"}
    both = replace(seen.modules, heartbeat_time=np.full(2, 9.0), angle_time=np.full(2, 9.0))
    found = compare_with_limits(LIMITS, LimitState.initial(2), replace(seen, modules=both))[1]
    assert found == {"lost_heartbeat": "module 1, 2", "lost_joints": "module 1, 2"}


@pytest.mark.parametrize(
    ("changes", "found"),
    [
        ({"leak": True}, {"leak": "module 2"}),
        (
            {"over_temperature": True, "temperature": 20.0},
            {"over_temperature": "module 2: 20 degC"},
        ),
        ({"temperature": 70.0}, {}),
        ({"temperature": 70.5}, {"over_temperature": "module 2: 70 degC"}),
        ({"over_current": True}, {"over_current": "module 2"}),
        ({"voltage": 28.0}, {}),
        ({"voltage": 27.0}, {"low_voltage": "module 2: 27.0 V"}),
        ({"state": NodeState.FAULT}, {}),
        ({"state": NodeState.FAULT, "emergency_stopped": True}, {}),
        (
            {"state": NodeState.FAULT, "stuck": True, "emergency_stopped": True},
            {"module_fault": "module 2: stuck"},
        ),
        ({"stuck": True}, {}),
        (
            {"state": NodeState.FAULT, "leak": True, "stuck": True},
            {"leak": "module 2", "module_fault": "module 2: leak, stuck"},
        ),
        (
            {"state": NodeState.FAULT, "over_current": True},
            {"over_current": "module 2", "module_fault": "module 2: over current"},
        ),
    ],
)
def test_what_a_heartbeat_says_is_an_event_of_its_module_whoever_else_is_not_heard(changes, found):
    beats = None, replace(WELL, node=2, **changes), replace(WELL, node=3, **changes)
    seen = seen_at(10.0)
    modules = replace(modules_that(*beats, heard=10.0, measured=10.0))
    _, said = compare_with_limits(
        LIMITS, LimitState.initial(3), replace(seen, modules=modules, references=None)
    )
    assert said == found


def test_a_supply_beyond_the_greatest_voltage_is_an_event_where_that_is_set():
    seen = replace(seen_at(10.0, WELL, replace(WELL, node=2, voltage=36.5)), references=None)
    assert compare_with_limits(LIMITS, LimitState.initial(2), seen)[1] == {}
    assert (
        compare_with_limits(replace(LIMITS, max_voltage=36.5), LimitState.initial(2), seen)[1] == {}
    )
    found = compare_with_limits(replace(LIMITS, max_voltage=36.0), LimitState.initial(2), seen)[1]
    assert found == {"high_voltage": "module 2: 36.5 V"}


def test_modules_have_a_second_to_follow_the_first_references():
    limp = (WELL, Heartbeat(node=2, state=NodeState.LIMP))
    state = replace(LimitState.initial(2), sending=5.0)
    assert compare_with_limits(LIMITS, state, seen_at(5.0 + SPIN_UP, *limp))[1] == {}
    found = compare_with_limits(LIMITS, state, seen_at(5.01 + SPIN_UP, *limp))[1]
    assert found == {"module_fault": "module 2 does not move: limp"}
    assert SPIN_UP == 1.0
    silent = replace(seen_at(9.0).modules, heartbeat=(None, WELL))
    assert compare_with_limits(LIMITS, state, replace(seen_at(9.0), modules=silent))[1] == {}


def test_a_module_that_was_on_and_is_off_has_gone_limp_and_one_that_was_never_on_has_not():
    ready = Heartbeat(node=2, state=NodeState.READY)
    state, found = compare_with_limits(LIMITS, LimitState.initial(2), seen_at(5.0, WELL, ready))
    assert found == {}  # it is being switched on
    state, found = compare_with_limits(
        LIMITS, state, seen_at(5.1, replace(WELL, state=NodeState.LIMP), ready)
    )
    assert found == {"went_limp": "module 1"}
    on = compare_with_limits(LIMITS, LimitState.initial(2), seen_at(5.0))[0]
    for off in set(NodeState) - {NodeState.ACTIVE, NodeState.HOLD}:
        _, found = compare_with_limits(
            LIMITS, on, seen_at(5.1, *(replace(WELL, node=k, state=off) for k in (1, 2)))
        )
        assert found == {"went_limp": "module 1, 2"}
    assert (
        compare_with_limits(LIMITS, on, seen_at(5.1, replace(WELL, state=NodeState.HOLD), WELL))[1]
        == {}
    )


def test_what_was_on_before_references_are_sent_does_not_count():
    on = compare_with_limits(LIMITS, LimitState.initial(2), seen_at(5.0))[0]
    off = seen_at(5.1, *(Heartbeat(node=k, state=NodeState.LIMP) for k in (1, 2)))
    state, found = compare_with_limits(LIMITS, on, replace(off, references=None))
    assert found == {}
    assert compare_with_limits(LIMITS, state, off)[1] == {}


def test_modules_that_heard_nothing_for_longer_than_they_wait_are_limp_whatever_they_said_last():
    assert (
        compare_with_limits(LIMITS, LimitState.initial(2), replace(seen_at(10.0), pause=LIMP_FROM))[
            1
        ]
        == {}
    )
    late = replace(seen_at(10.0), pause=LIMP_FROM + 0.1)
    assert compare_with_limits(LIMITS, LimitState.initial(2), late)[1] == {
        "went_limp": "they had no references for 0.9 s"
    }
    assert (
        compare_with_limits(LIMITS, LimitState.initial(2), replace(late, references=None))[1] == {}
    )


def test_the_error_of_a_joint_is_that_beside_its_reference():
    state = replace(LimitState.initial(2), joint_error=np.zeros(2))
    seen = replace(seen_at(10.0, angle=0.5), references=np.array([0.0, 0.5]))
    assert compare_with_limits(LIMITS, state, seen)[1] == {}
    found = compare_with_limits(LIMITS, state, replace(seen, references=np.array([0.0, -0.5])))[1]
    assert found == {"joint_error": "module 2: -57 deg"}


def test_of_several_that_are_wrong_the_first_is_named():
    seen = seen_at(10.0, WELL, replace(WELL, node=2))
    state = replace(LimitState.initial(2), current=np.zeros(2), joint_error=np.zeros(2))
    modules = replace(seen.modules, current=np.full(2, 5.0), angle=np.full(2, 1.0))
    found = compare_with_limits(LIMITS, state, replace(seen, modules=modules))[1]
    assert found == {"over_current": "module 1: 5.0 A", "joint_error": "module 1: -57 deg"}
    assert (
        compare_with_limits(
            LIMITS,
            state,
            replace(
                seen,
                modules=replace(
                    modules,
                    current=np.full(2, LIMITS.max_current),
                    angle=np.full(2, LIMITS.max_joint_error),
                ),
            ),
        )[1]
        == {}
    )


def test_at_first_nothing_is_beyond_its_limit():
    assert (
        LimitState.initial(3).current.tolist()
        == LimitState.initial(3).joint_error.tolist()
        == [math.inf] * 3
    )
    assert LimitState.initial(3).sending == math.inf
