import dataclasses
import math
import subprocess
import sys

import cantools
import pytest
from hypothesis import given, strategies as st
from mamba_dbc import FILE, dbc_text

from laticauda.tank.protocol import (
    Acceleration,
    CommandReply,
    EmergencyStop,
    Heartbeat,
    JointState,
    Loads,
    NodeCommand,
    NodeState,
    Order,
    References,
    Result,
    Sync,
    decode,
    encode,
    encode_references,
    from_frame,
    from_node,
    to_frame,
)

DATABASE = cantools.database.load_file(str(FILE))
NODES = st.integers(1, 19)


def steps(unit: float):
    """Numbers that the wire can carry exactly."""
    return st.integers(-32767, 32767).map(lambda raw: raw * unit)


ANGLES, MILLIS, CENTIS = steps(1e-4), steps(1e-3), steps(1e-2)
FLAGS = [field.name for field in dataclasses.fields(Heartbeat) if field.type in (bool, "bool")]
MESSAGES = st.one_of(
    st.builds(EmergencyStop, reason=st.integers(0, 255)),
    st.builds(NodeCommand, node=st.integers(0, 19), order=st.sampled_from(Order), angle=ANGLES),
    st.builds(Sync, counter=st.integers(0, 65535)),
    st.builds(
        References, group=st.integers(0, 4), angles=st.tuples(ANGLES, ANGLES, ANGLES, ANGLES)
    ),
    st.builds(JointState, node=NODES, angle=ANGLES, rate=MILLIS, current=MILLIS, torque=MILLIS),
    st.builds(
        Loads, node=NODES, force=st.none() | st.tuples(CENTIS, CENTIS, CENTIS), torque=MILLIS
    ),
    st.builds(Acceleration, node=NODES, along=MILLIS, left=MILLIS, up=MILLIS),
    st.builds(
        Heartbeat,
        node=NODES,
        state=st.sampled_from(NodeState),
        temperature=steps(0.1),
        voltage=st.integers(0, 65535).map(lambda raw: raw * 0.01),
        error_count=st.integers(0, 255),
        counter=st.integers(0, 255),
        **{name: st.booleans() for name in FLAGS},
    ),
    st.builds(
        CommandReply,
        node=NODES,
        order=st.integers(0, 255),
        result=st.sampled_from(Result),
        state=st.sampled_from(NodeState),
    ),
)


@given(message=MESSAGES)
def test_every_message_comes_back_as_it_was(message):
    assert decode(*encode(message)) == message


@given(message=MESSAGES)
def test_every_message_comes_back_from_a_frame_of_python_can(message):
    frame = to_frame(message)
    assert frame.arbitration_id < 2**11
    assert from_frame(frame) == message


@given(identifier=st.integers(0, 2**11 - 1), data=st.binary(max_size=8))
def test_random_bytes_are_a_message_or_none_and_never_an_error(identifier, data):
    message = decode(identifier, data)
    if message is not None and not (isinstance(message, Loads) and message.force is None):
        # The lowest number of a signed signal is the only one that we read and do not write.
        assert decode(*encode(message)) == message or b"\x00\x80" in data


def title(name: str) -> str:
    """The signal of a field."""
    return "".join(word.capitalize() for word in name.split("_"))


@given(message=MESSAGES)
def test_cantools_reads_and_writes_the_same_frames_by_the_file_alone(message):
    identifier, data = encode(message)
    theirs = DATABASE.get_message_by_frame_id(identifier)
    values = theirs.decode(data, scaling=True, decode_choices=False)
    for name, value in dataclasses.asdict(message).items():
        if title(name) in values:
            assert values[title(name)] == pytest.approx(float(value), abs=1e-9)
        elif name == "angles":
            assert [values[f"Angle{k}"] for k in range(1, 5)] == pytest.approx(
                list(value), abs=1e-9
            )
    assert (
        theirs.encode(
            theirs.decode(data, scaling=False, decode_choices=False), scaling=False, strict=False
        )
        == data
    )


@given(message=MESSAGES, n=st.integers(0, 7))
def test_truncated_frames_are_none(message, n):
    identifier, data = encode(message)
    assert decode(identifier, data[: min(n, len(data) - 1)]) is None


def test_numbers_beyond_the_range_saturate():
    message = decode(*encode(JointState(node=1, angle=100.0, rate=-100.0, current=0.0, torque=0.0)))
    assert isinstance(message, JointState)
    assert (message.angle, message.rate) == (pytest.approx(3.2767), pytest.approx(-32.767))
    message = decode(*encode(JointState(node=1, angle=1e308, rate=-1e308, current=0.0, torque=0.0)))
    assert (message.angle, message.rate) == (pytest.approx(3.2767), pytest.approx(-32.767))


def test_a_force_beyond_its_range_is_the_greatest_and_not_unknown():
    message = decode(*encode(Loads(node=1, force=(-400.0, 400.0, -327.68), torque=0.0)))
    assert message.force == pytest.approx((-327.67, 327.67, -327.67))


@pytest.mark.parametrize("data", ["63" + 7 * "00", "06" + 7 * "00"])
def test_a_state_that_there_is_not_makes_a_frame_none_of_ours(data):
    found = decode(0x701, bytes.fromhex(data))
    assert (found is None) == data.startswith("63")


def test_answers_and_heartbeats_come_from_a_node_and_all_else_does_not():
    sent = encode(Sync(counter=1)), encode(EmergencyStop()), encode(NodeCommand(order=Order.ENABLE))
    assert not any(from_node(identifier) for identifier, _ in sent)
    assert from_node(encode(JointState(node=1, angle=0.0, rate=0.0, current=0.0, torque=0.0))[0])
    assert from_node(encode(Heartbeat(node=19, state=NodeState.READY))[0])


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_no_frame_says_nan_nor_infinity(value):
    with pytest.raises(ValueError, match=rf"`Angle2` must be a finite number, got {value}\."):
        encode(References(group=0, angles=(0.0, value, 0.0, 0.0)))


def test_there_are_19_nodes():
    with pytest.raises(ValueError, match=r"`node` must be a number from 1 to 19, got 20\."):
        encode(JointState(node=20, angle=0.0, rate=0.0, current=0.0, torque=0.0))


def test_references_of_18_joints_are_five_frames_and_so_are_those_with_a_fin():
    frames = encode_references([0.1 * k for k in range(18)])
    assert [frame.group for frame in frames] == [0, 1, 2, 3, 4]
    assert frames[4].angles == (pytest.approx(1.6), pytest.approx(1.7), 0.0, 0.0)
    with_fin = encode_references([*[0.1 * k for k in range(18)], -0.5])
    assert with_fin == (*frames[:4], References(group=4, angles=(*frames[4].angles[:2], -0.5, 0.0)))
    with pytest.raises(
        ValueError, match=r"`angles` must be 1 to 19 numbers, one per joint, got 20\."
    ):
        encode_references([0.0] * 20)


def test_a_stop_goes_before_all_else_and_references_before_their_sync():
    def first(name):
        return min(m.frame_id for m in DATABASE.messages if m.name.rstrip("0123456789") == name)

    order = [
        "EmergencyStop",
        "NodeCommand",
        "References",
        "Sync",
        "JointState",
        "Loads",
        "Acceleration",
        "Heartbeat",
    ]
    assert [first(name) for name in order] == sorted(m for m in map(first, order))


def test_the_file_is_the_one_that_its_program_writes():
    assert FILE.read_text(encoding="utf-8") == dbc_text()


def test_error_frames_and_frames_of_other_kinds_are_none():
    import can

    data = encode(Sync(counter=1))[1]
    assert from_frame(can.Message(arbitration_id=0x180, data=data, is_extended_id=True)) is None
    assert (
        from_frame(
            can.Message(arbitration_id=0x180, is_extended_id=False, is_remote_frame=True, dlc=2)
        )
        is None
    )
    assert from_frame(can.Message(is_error_frame=True)) is None


def test_another_process_reads_frames_with_the_file_and_cantools_only():
    identifier, data = encode(Heartbeat(node=7, state=NodeState.FAULT, leak=True, temperature=41.5))
    code = (
        "import sys, cantools; db = cantools.database.load_file(sys.argv[1]);"
        "m = db.decode_message(int(sys.argv[2]), bytes.fromhex(sys.argv[3]));"
        "print(m['State'], m['Leak'], m['Temperature'], 'laticauda' in sys.modules)"
    )
    words = [sys.executable, "-c", code, str(FILE), str(identifier), data.hex()]
    assert subprocess.run(words, capture_output=True, text=True, check=True).stdout.split() == [
        "FAULT",
        "1",
        "41.5",
        "False",
    ]


def test_by_the_file_a_sensor_without_a_number_says_so_and_periodic_messages_have_their_period():
    identifier, data = encode(Loads(node=3, force=None, torque=1.0))
    theirs = DATABASE.get_message_by_frame_id(identifier)
    assert str(theirs.decode(data)["ForceUp"]) == "not available"
    assert theirs.cycle_time == 50
    assert DATABASE.get_message_by_name("Sync").cycle_time == 10
    assert not DATABASE.get_message_by_name("EmergencyStop").cycle_time
