import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from laticauda.logs.ros2 import DEFINITIONS, codec, schema_name, schema_text

INTEGERS = {
    "bool": st.booleans(),
    "byte": st.integers(0, 255),
    "uint8": st.integers(0, 255),
    "int32": st.integers(-(2**31), 2**31 - 1),
    "uint32": st.integers(0, 2**32 - 1),
    "float64": st.floats(allow_nan=False),
    "string": st.text(st.characters(blacklist_categories=["Cs"], blacklist_characters="\0"), max_size=9),
}


def messages(name: str) -> st.SearchStrategy[dict[str, object]]:
    """Any message of a type, drawn along its definition."""
    fields: dict[str, st.SearchStrategy[object]] = {}
    for line in DEFINITIONS[name].splitlines():
        if "=" in line:
            continue
        kind, field = line.split()[:2]
        base, _, count = kind.partition("[")
        package = base if "/" in base else f"{name.split('/')[0]}/{base}"
        one = INTEGERS[base] if base in INTEGERS else messages(package)
        size = int(count.rstrip("]") or 0) if count else 0
        if count and base == "uint8":
            one = st.binary(min_size=size, max_size=size or 9)
        elif count:
            one = st.lists(one, min_size=size, max_size=size or 4)
        fields[field] = one
    return st.fixed_dictionaries(fields)


def plain(value: object) -> object:
    """A message as lists and dicts, whichever reader it comes from."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, bytes):
        return list(value)
    if isinstance(value, dict):
        return {name: plain(one) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [plain(one) for one in value]
    if hasattr(value, "__slots__"):
        return {name.lstrip("_"): plain(getattr(value, name)) for name in value.__slots__}
    return value


@pytest.mark.parametrize("name", DEFINITIONS)
@settings(max_examples=20)
@given(data=st.data())
def test_a_message_is_read_as_it_was_written(name, data):
    message = data.draw(messages(name))
    assert plain(codec(name).decode(codec(name).encode(message))) == plain(message)


@pytest.mark.parametrize("name", [name for name in DEFINITIONS if not name.startswith("builtin")])
@settings(max_examples=20)
@given(data=st.data())
def test_another_reader_reads_the_same_from_the_definition_in_the_file(name, data):
    dynamic = pytest.importorskip("mcap_ros2._dynamic", reason="the other reader of ROS 2 messages is not installed")
    message = data.draw(messages(name))
    decoders = dynamic.generate_dynamic(schema_name(name), schema_text(name))
    assert plain(decoders[schema_name(name)](codec(name).encode(message))) == plain(message)


@pytest.mark.parametrize("name", DEFINITIONS)
@settings(max_examples=20)
@given(data=st.data())
def test_the_definition_in_the_file_is_all_that_a_reader_needs(name, data):
    message = data.draw(messages(name))
    assert codec(name, schema_text(name)).encode(message) == codec(name).encode(message)


@given(cut=st.integers(0, 70), rubbish=st.binary(max_size=80))
def test_bytes_that_make_no_sense_are_refused_or_read_but_nothing_else(cut, rubbish):
    joints = codec("sensor_msgs/JointState")
    whole = joints.encode(
        {
            "header": {"stamp": {"sec": 1, "nanosec": 2}, "frame_id": "x"},
            "name": ["a"],
            "position": [1.0],
            "velocity": [],
            "effort": [2.0],
        }
    )
    if cut < len(whole):
        with pytest.raises(ValueError, match=r"JointState (is damaged|must begin)"):
            joints.decode(whole[:cut])
    try:
        joints.decode(whole[:4] + rubbish)
    except ValueError as error:
        assert "damaged" in str(error)


def test_a_field_that_is_missing_or_does_not_fit_is_named():
    with pytest.raises(ValueError, match="`std_msgs/Float64` must have a fitting `data`"):
        codec("std_msgs/Float64").encode({})
    with pytest.raises(ValueError, match=r"`builtin_interfaces/Time.sec` must fit its type"):
        codec("builtin_interfaces/Time").encode({"sec": 2**31, "nanosec": 0})
    frame = {"header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}, "id": 1, "is_rtr": False}
    frame |= {"is_extended": False, "is_error": False, "dlc": 3, "data": b"abc"}
    with pytest.raises(ValueError, match="fitting `data`: 8 values are needed, got 3"):
        codec("can_msgs/Frame").encode(frame)


def test_a_definition_that_makes_no_sense_is_refused():
    with pytest.raises(ValueError, match="must have lines like `float64 x`, got 'float64'"):
        codec("a/B", "float64\n")
    with pytest.raises(ValueError, match="must define a/C"):
        codec("a/B", "C c\n")
    with pytest.raises(ValueError, match="not by itself"):
        codec("a/B", "B b\n")
