"""Between values and tables: what is written is read back equal, and what is wrong is said of its key."""

import math
from typing import ClassVar, Literal

import pytest
from hypothesis import given, strategies as st

from laticauda.motion.gaits import Gait, lateral_undulation
from laticauda.scenarios.interfaces import Controller
from laticauda.values.codec import BadKey, decode, encode, keys_of, merge_tables
from laticauda.values.errors import RobotFileError
from laticauda.values.extensions import Extensible
from laticauda.values.quantities import option, quantity, value_class


class Spring(Extensible, group="test_springs"):
    """A group."""


@value_class
class Steel(Spring):
    """A member with a number."""

    stiffness: float = quantity("N/m", "k", ge=0.0, default=1.0)


@value_class
class Slack(Spring):
    """A member with none."""


@value_class
class Round:
    """One of a union."""

    radius: float = quantity("m", "r", gt=0.0, default=1.0)


@value_class
class Square:
    """The other."""

    side: float = quantity("m", "a", gt=0.0, default=1.0)


@value_class
class Joint:
    """A counted class with an angle."""

    counted: ClassVar = ("axis",)
    axis: Literal["yaw", "pitch"] = option("Which way", default="yaw")
    limit: float = quantity("rad", "Largest angle", gt=0.0, le=math.pi, default=1.0)
    rate: float = quantity("rad/s", "Fastest", default=0.0)


@value_class
class Machine:
    """A class with everything."""

    former: ClassVar = {"stiffness": "spring.stiffness", "weight": "mass"}
    name: str = option("What it is called")
    mass: float = quantity("kg", "m", gt=0.0, default=1.0)
    spring: Spring = option("What bends", default=Steel())
    shape: Round | Square | None = option("What it looks like", default=None)
    joints: tuple[Joint, ...] = option("What turns", default=())
    first: Joint | None = option("One alone", default=None)
    corners: tuple[tuple[float, float], ...] = quantity("m", "Where", default=())


positive = st.floats(1e-9, 1e6)
joints = st.builds(
    Joint,
    axis=st.sampled_from(["yaw", "pitch"]),
    limit=st.floats(1e-3, math.pi),
    rate=st.sampled_from([0.0, 0.1, 2.0]),
)
machines = st.builds(
    Machine,
    name=st.text("ab", min_size=1),
    mass=positive,
    spring=st.one_of(st.builds(Steel, stiffness=positive), st.just(Slack())),
    shape=st.one_of(st.none(), st.builds(Round, radius=positive), st.builds(Square, side=positive)),
    joints=st.lists(joints, max_size=8).flatmap(lambda some: st.just(tuple(some + some[:1] * 3))),
    first=st.one_of(st.none(), joints),
    corners=st.lists(st.tuples(positive, positive), max_size=3).map(tuple),
)


@given(machines)
def test_what_is_written_is_read_back_equal_to_the_last_bit(machine: Machine):
    assert decode(Machine, encode(machine)) == machine


def test_a_member_that_may_be_absent_says_its_kind():
    hint = Spring | None
    assert encode(Steel(stiffness=2.0), hint) == {"kind": "steel", "stiffness": 2.0}
    assert decode(hint, encode(Slack(), hint)) == Slack()
    assert decode(hint, encode(None, hint)) is None


def test_what_is_no_member_says_no_kind_where_a_member_might_be():
    scenario_motion = Gait | Controller[object]
    assert "kind" not in encode(
        lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7), scenario_motion
    )


def test_a_table_says_no_more_than_it_has_to():
    machine = Machine(
        name="m", joints=(Joint(), Joint(axis="pitch")) * 2, spring=Slack(), shape=Square(side=2.0)
    )
    assert encode(machine) == {
        "name": "m",
        "mass": 1.0,
        "spring": {"kind": "slack"},
        "shape": {"kind": "square", "side": 2.0},
        "joints": [{"count": 4, "axis": ["yaw", "pitch"], "limit": 1.0}],
    }
    assert encode(Joint(limit=math.pi / 2)) == {"axis": "yaw", "limit_deg": 90.0}


@pytest.mark.parametrize(
    ("table", "spring"),
    [
        ({}, Steel()),
        ({"spring": {"stiffness": 2.0}}, Steel(stiffness=2.0)),  # the kind of the default
        ({"spring": {"kind": "slack"}}, Slack()),
        ({"spring": "slack"}, Slack()),
        ({"stiffness": 3.0}, Steel(stiffness=3.0)),  # as older files say it
    ],
)
def test_a_kind_can_be_said_in_several_ways(table, spring):
    assert decode(Machine, {"name": "m", **table}).spring == spring


@pytest.mark.parametrize(
    ("table", "key", "rule"),
    [
        ({"nam": 1}, "nam", "is not known; did you mean `name`?"),
        (
            {"xyz": 1},
            "xyz",
            "is not known; the keys here are name, mass, spring, shape, joints, first, corners",
        ),
        ({"name": None, "joints": 3}, "joints", "must be a list of tables, got 3"),
        ({"joints": [3]}, "joints[0]", "must be a table, got 3"),
        ({"mass": -1}, "mass", "must be > 0 kg, got -1"),
        ({"weight": -1}, "mass", "must be > 0 kg, got -1"),
        ({"mass": {}}, "mass", "must be a number in kg, got {}"),
        (
            {"first": {"limit": 1, "limit_deg": 1}},
            "first.limit_deg",
            "must not be given together with `limit`, the same in rad",
        ),
        (
            {"first": {"limit_deg": 400}},
            "first.limit_deg",
            "must be between 0 and 180 deg, got 400",
        ),
        ({"first": {"rate_deg_s": "x"}}, "first.rate_deg_s", "must be a number in deg/s, got 'x'"),
        (
            {"joints": [{"count": 0}]},
            "joints[0].count",
            "must be a whole number from 1 to 1000, got 0",
        ),
        (
            {"joints": [{"axis": []}]},
            "joints[0].count",
            "must be a whole number from 1 to 1000, got 0",
        ),
        (
            {"joints": [{"axis": [], "count": 1}]},
            "joints[0].axis",
            "must be a text or a list of 1 to `count` = 1 texts, got 0",
        ),
        (
            {"joints": [{"axis": "roll"}]},
            "joints[0].axis",
            "must be one of `yaw`, `pitch`, got 'roll'",
        ),
        (
            {"spring": "steal"},
            "spring.kind",
            "must be one of `steel`, `slack`, got 'steal'; did you mean `steel`?",
        ),
        ({"spring": {"kind": 3}}, "spring.kind", "must be one of `steel`, `slack`, got '3'"),
        (
            {"spring": {"kind": "slack", "stiffness": 1}},
            "spring.stiffness",
            "is not known; the keys here are ",
        ),
        ({"shape": {"side": 1}}, "shape.kind", "must be one of `round`, `square`, got None"),
        ({"shape": {"kind": "round", "radius": 0}}, "shape.radius", "must be > 0 m, got 0"),
        ({"corners": [[0, 0], [1]]}, "corners[1]", "must be two numbers in m, got 1 of them"),
    ],
)
def test_what_is_wrong_is_said_of_its_key(table, key, rule):
    with pytest.raises(BadKey) as caught:
        decode(Machine, {"name": "m", **table})
    assert (caught.value.name, caught.value.rule) == (key, rule)


def test_a_missing_key_and_the_file_are_named():
    with (
        pytest.raises(
            RobotFileError, match=r"^m\.toml: key `name`: is missing; every Machine needs it$"
        ),
        keys_of("m.toml", RobotFileError),
    ):
        decode(Machine, {})


def test_what_differs_is_put_over_a_table():
    common = {"a": 1, "law": {"kind": "x", "k": 1}, "list": [1]}
    assert merge_tables(common, {"law": {"k": 2}, "list": [2]}) == {
        "a": 1,
        "law": {"kind": "x", "k": 2},
        "list": [2],
    }
    assert merge_tables(common, {"law": {"kind": "y"}})["law"] == {"kind": "y", "k": 1}
    assert common["law"] == {"kind": "x", "k": 1}
