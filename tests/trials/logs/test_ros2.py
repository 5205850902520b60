import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from laticauda.trials.logs.ros2 import DEFINITIONS, build_decoder, encode, schema_name, schema_text

records = pytest.importorskip("mcap.records", reason="the package mcap is not installed")
pytest.importorskip("mcap_ros2.decoder", reason="the reader of ROS 2 messages is not installed")

INTEGERS = {
    "bool": st.booleans(),
    "byte": st.integers(0, 255),
    "uint8": st.integers(0, 255),
    "int32": st.integers(-(2**31), 2**31 - 1),
    "uint32": st.integers(0, 2**32 - 1),
    "float64": st.floats(allow_nan=False),
    "string": st.text(
        st.characters(blacklist_categories=["Cs"], blacklist_characters="\0"), max_size=9
    ),
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
    return value


def reader(name: str, text: str | None = None):
    """The library's reader of a type."""
    definition = schema_text(name) if text is None else text
    return build_decoder(
        records.Schema(id=1, name=schema_name(name), encoding="ros2msg", data=definition.encode())
    )


@pytest.mark.parametrize("name", [name for name in DEFINITIONS if not name.startswith("builtin")])
@settings(max_examples=20)
@given(data=st.data())
def test_another_hand_reads_what_was_written_from_the_definition_in_the_file(name, data):
    message = data.draw(messages(name))
    assert plain(reader(name)(encode(name, message))) == plain(message)


@given(cut=st.integers(0, 70), rubbish=st.binary(max_size=80))
def test_bytes_that_make_no_sense_are_refused_or_read_but_nothing_else(cut, rubbish):
    read = reader("sensor_msgs/JointState")
    whole = encode(
        "sensor_msgs/JointState",
        {
            "header": {"stamp": {"sec": 1, "nanosec": 2}, "frame_id": "x"},
            "name": ["a"],
            "position": [1.0],
            "velocity": [],
            "effort": [2.0],
        },
    )
    if cut < len(whole):
        with pytest.raises(ValueError, match="JointState is damaged"):
            read(whole[:cut])
    try:
        read(whole[:4] + rubbish)
    except ValueError as error:
        assert "damaged" in str(error)


def test_a_field_that_is_missing_or_does_not_fit_is_named():
    with pytest.raises(ValueError, match="`std_msgs/Float64` must have a valid `data`"):
        encode("std_msgs/Float64", {})
    with pytest.raises(ValueError, match="`builtin_interfaces/Time` must have a valid `sec`"):
        encode("builtin_interfaces/Time", {"sec": 2**31, "nanosec": 0})
    frame = {
        "header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""},
        "id": 1,
        "is_rtr": False,
    }
    frame |= {"is_extended": False, "is_error": False, "dlc": 3, "data": b"abc"}
    with pytest.raises(ValueError, match="valid `data`: 8 values are needed, got 3"):
        encode("can_msgs/Frame", frame)


def test_a_definition_that_makes_no_sense_is_refused():
    with pytest.raises(ValueError, match="The definition of a/B makes no sense"):
        reader("a/B", "float64\n")
    with pytest.raises(ValueError, match="A message of a/B is damaged"):
        reader("a/B", "C c\n")(b"\x00\x01\x00\x00" + bytes(8))
