import math
import random
from functools import cache

import pytest
from hypothesis import given, strategies as st
from lab_parts import Operator, make_tank

from laticauda.tank.lab import Fault, NodeSettings
from laticauda.tank.lab.nodes import Node, Senses
from laticauda.tank.protocol import (
    CommandReply,
    EmergencyStop,
    Heartbeat,
    JointState,
    NodeCommand,
    NodeState,
    Order,
    References,
    Result,
    Sync,
    encode,
)


def test_a_node_starts_up_calibrates_and_is_ready_and_limp(operator):
    tank = operator.tank
    assert set(operator.states) == {"STARTUP"}
    assert operator.tell(Sync(counter=0)) == []
    tank.advance(0.15)
    assert set(operator.states) == {"CALIBRATING"}
    tank.advance(1.9)
    assert set(operator.states) == {"READY"}
    assert not any(node.is_on for node in tank.nodes)
    beats = [m for m in operator.heard() if isinstance(m, Heartbeat)]
    assert all(m.not_calibrated for m in beats)
    assert len(beats) == pytest.approx(
        18 * 20, rel=0.2
    )  # ten a second, and one at every change of state


def test_every_node_answers_a_sync_with_its_joint(operator, straight):
    operator.ready()
    answers = [m for m in operator.cycle(straight) if isinstance(m, JointState)]
    assert [m.node for m in answers] == list(range(1, 19))


def test_references_count_from_the_next_sync_on(operator, straight):
    operator.ready()
    straight[4] = 0.2
    operator.cycle(straight)
    node = operator.tank.nodes[4]
    assert node.target == pytest.approx(0.2)
    from laticauda.tank.protocol import encode_references

    for message in encode_references([0.1] * 18):
        operator.tell(message)
    assert node.target == pytest.approx(0.2)
    operator.tell(Sync(counter=9))
    assert node.target == pytest.approx(0.1)


def test_joints_go_where_they_are_told(operator, straight):
    operator.ready()
    straight[[0, 6]] = 0.2, -0.1
    answers = [m for m in operator.cycle(straight, 80) if isinstance(m, JointState)][-18:]
    assert [m.angle for m in answers] == pytest.approx(straight.tolist(), abs=0.01)


def test_without_references_a_node_holds_and_then_goes_limp_and_must_be_enabled_anew(
    operator, straight
):
    operator.ready()
    operator.cycle(straight, 5)
    operator.tank.advance(0.25)
    assert set(operator.states) == {"HOLD"}
    operator.cycle(straight)
    assert set(operator.states) == {"ACTIVE"}
    operator.tank.advance(1.05)
    assert set(operator.states) == {"LIMP"}
    assert any(m.references_lost for m in operator.heard() if isinstance(m, Heartbeat))
    operator.cycle(straight)
    assert set(operator.states) == {"LIMP"}
    operator.tell(NodeCommand(order=Order.ENABLE))
    assert set(operator.states) == {"ACTIVE"}


def test_syncs_without_references_do_not_keep_a_node_active(operator, straight):
    operator.ready()
    for _ in range(30):
        operator.tell(Sync(counter=1))
        operator.tank.advance(0.01)
    assert set(operator.states) == {"HOLD"}


def test_the_reference_moves_no_faster_than_the_limit(operator, straight):
    operator.ready()
    straight[8] = 1.5
    operator.cycle(straight, 10)
    assert operator.tank.nodes[8].reference == pytest.approx(0.1 * 4.0, rel=0.01)


def test_an_emergency_stop_takes_all_motors_off_until_it_is_cleared(operator, straight):
    operator.ready()
    beats = operator.tell(EmergencyStop(reason=1))
    assert {m.node for m in beats if m.emergency_stopped} == set(range(1, 19))
    assert set(operator.states) == {"FAULT"}
    replies = operator.tell(NodeCommand(order=Order.ENABLE))
    assert {m.result for m in replies if isinstance(m, CommandReply)} == {Result.REFUSED}
    operator.tell(NodeCommand(order=Order.CLEAR))
    assert set(operator.states) == {"READY"}


def test_the_zero_is_what_the_operator_says_it_is():
    from laticauda.tank.lab import LabSettings

    operator = Operator(make_tank(LabSettings(seed=3)))
    operator.tank.advance(2.2)
    errors = operator.tank.electronics.zero_error
    assert max(abs(errors)) > 0.02

    def mean_angle():
        found = [
            m.angle
            for _ in range(100)
            for m in operator.tell(Sync(counter=0))
            if isinstance(m, JointState)
        ]
        return sum(found[0::18]) / 100

    assert mean_angle() == pytest.approx(errors[0], abs=0.002)
    operator.tell(NodeCommand(order=Order.SET_ZERO, angle=0.1))
    assert mean_angle() == pytest.approx(0.1, abs=0.012)  # one noisy reading set it
    assert not any("not_calibrated" in node.flags for node in operator.tank.nodes)


def test_an_order_to_one_node_is_answered_by_it_alone(operator):
    operator.ready(enable=False)
    replies = [
        m
        for m in operator.tell(NodeCommand(node=7, order=Order.ENABLE))
        if isinstance(m, CommandReply)
    ]
    assert [(m.node, m.order, m.result.name, m.state.name) for m in replies] == [
        (7, 1, "DONE", "ACTIVE")
    ]


@pytest.mark.parametrize(
    ("fault", "flag", "within"),
    [
        (Fault(kind="leak", node=5), "leak", 0.03),
        (Fault(kind="over_temperature", node=5), "over_temperature", 0.03),
        (Fault(kind="stuck_servo", node=5), "stuck", 4.0),
    ],
)
def test_a_module_with_a_fault_stops_itself_and_says_why(operator, straight, fault, flag, within):
    operator.ready()
    operator.cycle(straight, 5)
    from dataclasses import replace

    operator.tank.inject(replace(fault, time=operator.tank.time))
    straight[4] = 0.6
    heard = operator.cycle(straight, round(within / 0.01))
    assert [i + 1 for i, state in enumerate(operator.states) if state == "FAULT"] == [5]
    said = [m for m in heard if isinstance(m, Heartbeat) and m.faults]
    assert {(m.node, *m.faults) for m in said} == {(5, flag)}


def pulled(duty, angle, duration, noise=0.0):
    """The flags of a node that was enabled, and then pulled and stood as functions of time say."""
    node = Node(1, NodeSettings(startup_time=0.0, calibration_time=0.0), limit=1.5)
    chance = random.Random(1)
    for k in range(round(duration / 0.01)):
        now = 0.01 * (k + 1)
        senses = Senses(duty=duty(now), angle=angle(now) + chance.gauss(0.0, noise))
        node.tick(now, senses)
        if node.state == NodeState.READY:
            node.receive(NodeCommand(order=Order.ENABLE), now, senses)
        node.receive(References(group=0, angles=(0.0, 0.0, 0.0, 0.0)), now, senses)
        node.receive(Sync(counter=0), now, senses)
    return node.flags


NOISE = NodeSettings().angle_noise


def test_a_servo_that_stalls_under_a_load_and_then_goes_on_is_not_stuck():
    # So it went in the tank: 2 s at full pull without a move, while the robot straightened against
    # the water.
    def angle(now):
        return -0.6 if now % 2.5 < 2.0 else -0.6 + 0.3 * (now % 2.5 - 2.0)

    assert "stuck" not in pulled(lambda now: 1.0, angle, 10.0, NOISE)


def test_a_servo_that_is_jammed_is_stuck_though_the_gait_pulls_it_to_and_fro():
    def duty(now):
        return min(max(3.0 * math.sin(math.pi / 2.0 * now), -1.0), 1.0)

    assert "stuck" in pulled(duty, lambda now: 0.3, 5.0, NOISE)
    assert "stuck" not in pulled(lambda now: 0.3 * duty(now), lambda now: 0.3, 20.0, NOISE)


def test_a_leak_cannot_be_cleared_while_it_is_there(operator):
    operator.ready()
    operator.tank.inject(Fault(kind="leak", node=2, time=operator.tank.time, duration=0.5))
    operator.tank.advance(0.1)
    operator.tell(NodeCommand(order=Order.CLEAR))
    assert operator.states[1] == "FAULT"
    operator.tank.advance(0.5)
    operator.tell(NodeCommand(order=Order.CLEAR))
    assert operator.states[1] == "READY"


FRAMES = st.lists(
    st.tuples(
        st.integers(0, 2**11 - 1) | st.sampled_from([1, 16, 0x100, 0x180]), st.binary(max_size=9)
    )
)


@cache
def listener():
    return Operator(make_tank()).ready()


@given(frames=FRAMES)
def test_no_frame_whatever_brings_a_node_down(frames):
    for identifier, data in frames:
        listener().tank.receive(identifier, data)
    listener().tank.advance(0.02)
    assert all(m is not None for m in listener().heard())
    assert all(abs(node.reference) < 1.6 for node in listener().tank.nodes)


def test_truncated_frames_do_nothing(operator, straight):
    operator.ready()
    identifier, data = encode(EmergencyStop())
    operator.tank.receive(identifier, data[:-1])
    assert set(operator.states) == {"ACTIVE"}
