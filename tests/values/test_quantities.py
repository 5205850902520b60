"""Declared numbers: what is let through, what is refused and in which words, and what help tells about them."""

import contextlib
import importlib
import math
from collections.abc import Iterator
from dataclasses import FrozenInstanceError, fields, is_dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st

import laticauda
from laticauda.robot import Actuator, CaudalFin, Section, Water, load_water
from laticauda.sensing import Compass, Sonar
from laticauda.tank.lab.settings import LabSettings, NodeSettings
from laticauda.values.checks import check_label
from laticauda.values.declared_quantities import SMALLEST
from laticauda.values.errors import MissingExtra
from laticauda.values.quantities import (
    LARGEST,
    LIMITS,
    Quantity,
    describe_fields,
    hints_of,
    option,
    quantities_of,
    quantity,
    texts_of,
    value_class,
)


@value_class
class Hinge:
    """A hinge."""

    stiffness: float = quantity("N m/rad", "Of the spring", ge=0.0, default=1.0)


@value_class
class Leg:
    """A leg."""

    name: str = option("What it is called", default="leg", check=check_label)
    length: float = quantity("m", "From hip to foot", gt=0.0)
    turn: float = quantity("rad", "Of the foot", ge=-1.0, le=1.0, default=0.0)
    load: float | None = quantity("N", "On it, None for its weight", ge=0.0, default=None)
    lasting: float = quantity("s", "How long it lasts", gt=0.0, default=math.inf)
    n_toes: int = quantity("", "Number of toes", ge=1, le=6, default=5)
    place: tuple[float, float] = quantity("m", "Where", default=(0.0, 0.0))
    corners: tuple[tuple[float, float], ...] = quantity("m", "Of its outline", default=())
    kind: Literal["fore_leg", "hind_leg"] = option("Which", default="fore_leg")
    is_wet: bool = option("Whether it is wet", default=False)
    hip: Hinge = option("At the top", default_factory=Hinge)
    knees: tuple[Hinge, ...] = option("Below it", default=())

    def __post_init__(self) -> None:
        if self.n_toes > 5 and self.is_wet:
            raise ValueError("`n_toes` must be 5 at most on a wet leg.")


finite = st.floats(allow_nan=False, allow_infinity=False)
SOURCES = Path(laticauda.__file__).parent
limited = st.floats(-LARGEST, LARGEST)

MODULES = [
    path.relative_to(SOURCES.parent)
    .with_suffix("")
    .as_posix()
    .replace("/", ".")
    .removesuffix(".__init__")
    for path in sorted(SOURCES.rglob("*.py"))
    if "value_class" in path.read_text()
]
ENDLESS = {
    ("ModelPredictive", "power_limit"): "the gait may take any power",
    ("PlanLimits", "power_limit"): "the same",
    ("OpenLoop", "interval"): "asked once",
    ("Fault", "duration"): "to the end",
    ("SensorFault", "end"): "a fault may last",
    ("KeepStation", "duration"): "a station may be kept until something else happens",
    ("Hover", "duration"): "the same",
    ("FollowWall", "length"): "a wall may be followed for ever",
    ("Phase", "time_limit"): "a phase may last",
    ("Waves", "depth"): "deep water",
    ("Sea", "depth"): "deep water",
    ("Limits", "max_voltage"): "whatever the supply gives",
}
"""What may be infinite, where that is the default, and what it means."""


@given(finite, finite, finite)
def test_a_number_in_its_range_stays_what_it_is_and_any_other_is_refused(
    low: float, high: float, number: float
):
    declared = Quantity(unit="m", text="x", ge=low, le=high)
    if low <= number <= high:
        assert declared.checked("x", number) == number
    else:
        with pytest.raises(
            ValueError, match=r"^`x` must be (between .* and .*|>= .*|<= .*) m, got "
        ):
            declared.checked("x", number)


@given(limited, limited)
def test_above_is_above(low: float, number: float):
    assume(low != 0.0 or not 0.0 < number < SMALLEST)  # taken for a slip, see below
    declared = Quantity(unit="", text="x", gt=low)
    if number > low:
        assert declared.checked("x", number) == number >= declared.least
    else:
        with pytest.raises(ValueError, match=r"^`x` must be > .*, got "):
            declared.checked("x", number)


@pytest.mark.parametrize("number", [2, 2.0, np.float64(2), np.int64(2)])
def test_numbers_of_all_kinds_become_floats_and_counts_ints(number):
    leg = Leg(length=number, load=number, place=[number, number])
    assert [type(one) for one in (leg.length, leg.load, *leg.place)] == 4 * [float]
    assert type(Leg(length=1, n_toes=np.int64(3)).n_toes) is int


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"length": 0.0}, "`length` must be > 0 m, got 0.0."),
        ({"length": math.nan}, "`length` must be a finite number in m, got nan."),
        ({"length": None}, "`length` must be a number in m, got None."),
        ({"turn": 1.5}, "`turn` must be between -1 and 1 rad, got 1.5."),
        ({"load": -1}, "`load` must be >= 0 N, got -1."),
        ({"lasting": -math.inf}, "`lasting` must be a finite number in s, got -inf."),
        ({"n_toes": 2.0}, "`n_toes` must be a whole number >= 1, got 2.0."),
        ({"n_toes": 7}, "`n_toes` must be between 1 and 6, got 7."),
        ({"n_toes": 6, "is_wet": True}, "`n_toes` must be 5 at most on a wet leg."),
        ({"place": (1.0,)}, "`place` must be two numbers in m, got 1 of them."),
        ({"place": 1.0}, "`place` must be two numbers in m, got 1.0."),
        ({"place": "ab"}, "`place` must be two numbers in m, got 'ab'."),
        ({"place": (1.0, "b")}, "`place[1]` must be a number in m, got 'b'."),
        ({"corners": [(0, 0), (1, "b")]}, "`corners[1][1]` must be a number in m, got 'b'."),
        ({"corners": [(0, 0), 1]}, "`corners[1]` must be two numbers in m, got 1."),
        (
            {"kind": "midleg"},
            "`kind` must be one of `fore_leg`, `hind_leg`, got 'midleg'; did you mean `hind_leg`?",
        ),
        ({"is_wet": 1}, "`is_wet` must be true or false, got 1."),
        ({"name": 3}, "`name` must be a text, got 3."),
        ({"name": " "}, "`name` must be a text on one line that is not blank, got ' '."),
        ({"hip": 3.0}, "`hip` must be of class Hinge, got float."),
        ({"knees": Hinge()}, "`knees` must be a tuple of Hinge, got Hinge()."),
        ({"knees": [Hinge(), 1]}, "`knees[1]` must be of class Hinge, got int."),
    ],
)
def test_what_is_refused_is_refused_with_name_rule_unit_and_value(changes, message):
    with pytest.raises(ValueError) as caught:
        Leg(**{"length": 1.0} | changes)
    assert str(caught.value).replace("Hinge(stiffness=1.0)", "Hinge()") == message


@given(st.sampled_from(["m", "rad", "", "Pa"]), finite)
def test_without_a_declared_range_the_limit_of_the_unit_holds(unit: str, number: float):
    declared, limit = Quantity(unit=unit, text="x"), LIMITS.get(unit, LARGEST)
    assert declared.ends == (-limit, limit)
    assert declared.range == ""  # help names what is declared only
    if abs(number) <= limit:
        assert declared.checked("x", number) == number
    else:
        with pytest.raises(ValueError, match=f"^`x` must be {'<= ' if number > 0.0 else '>= -'}"):
            declared.checked("x", number)


def test_a_side_without_a_bound_is_that_of_the_unit_in_a_value_too():
    with pytest.raises(ValueError, match=r"^`length` must be <= 1e\+07 m, got 20000000\.0\.$"):
        Leg(length=2e7)
    with pytest.raises(
        ValueError, match=r"^`place\[1\]` must be >= -1e\+07 m, got -20000000\.0\.$"
    ):
        Leg(length=1.0, place=(0.0, -2e7))
    assert Leg(length=1e7).lasting == math.inf


@pytest.mark.parametrize("number", [1e-308, 5e-324, 9e-10])
def test_what_is_above_0_is_not_so_small_that_it_must_be_a_slip(number: float):
    with pytest.raises(ValueError, match=rf"^`length` must be >= 1e-09 m, got {number}\.$"):
        Leg(length=number)
    assert Leg(length=1e-9).length == 1e-9


def values() -> Iterator[type]:
    """Every public class of the library that declares numbers."""
    found: dict[type, None] = {}
    for name in MODULES:
        with contextlib.suppress(MissingExtra):
            module = importlib.import_module(name)
            found |= {
                one: None
                for one in vars(module).values()
                if isinstance(one, type) and is_dataclass(one)
            }
    return (one for one in found if one.__module__.startswith("laticauda.") and quantities_of(one))


def test_every_number_of_every_value_has_a_finite_range_on_both_sides_or_is_endless_for_a_reason():
    endless: set[tuple[str, str]] = set()
    for kind in values():
        for name, declared in quantities_of(kind).items():
            low, high = declared.ends
            assert math.isfinite(low) and math.isfinite(high) and low < high, (kind, name)
            default = next(field.default for field in fields(kind) if field.name == name)
            if default == math.inf:
                endless.add((kind.__name__, name))
            elif isinstance(default, float | int):
                assert low <= default <= high, (kind, name)
    assert endless == ENDLESS.keys()


@pytest.mark.parametrize(
    ("make", "wrong", "right"),
    [
        (Water, {"density": 26e3}, {"density": 13.6e3}),
        (CaudalFin, {"length": 101.0}, {"length": 30.0}),
        (CaudalFin, {"thickness": 11.0}, {"thickness": 0.5}),
        (CaudalFin, {"density": 26e3}, {"density": 7850.0}),
        (CaudalFin, {"n_strips": 1001}, {"n_strips": 200}),
        (Section, {"half_height": 101.0}, {"half_height": 15.0}),
        (NodeSettings, {"temperature_limit": -300.0}, {"temperature_limit": 150.0}),
        (LabSettings, {"water_temperature": 200.0}, {"water_temperature": 30.0}),
        (Actuator, {"voltage": 1e6}, {"voltage": 400.0}),
        (Actuator, {"stall_torque": 1e13}, {"stall_torque": 5000.0}),
    ],
)
def test_what_no_robot_has_is_refused_and_what_a_large_one_has_is_not(make, wrong, right):
    base: dict[str, float] = {
        Water: {"tangential_friction": 0.1, "normal_drag": 1.0, "added_mass": 1.0},
        Section: {"half_height": 0.1, "half_width": 0.1},
    }.get(make, {})
    for name, number in right.items():
        assert getattr(make(**base | right), name) == number
    with pytest.raises(ValueError, match=f"^`{next(iter(wrong))}` must be "):
        make(**base | wrong)


def test_a_hyphen_is_as_good_as_an_underscore():
    assert Leg(length=1.0, kind="hind-leg").kind == "hind_leg"  # pyright: ignore[reportArgumentType]


def test_a_copy_is_checked_anew_and_a_value_does_not_change():
    leg = Leg(length=1.0)
    assert replace(leg, length=2.0) == Leg(length=2.0) != leg
    with pytest.raises(ValueError, match="`length` must be > 0 m"):
        replace(leg, length=-2.0)
    with pytest.raises(FrozenInstanceError):
        leg.length = 2.0  # pyright: ignore[reportAttributeAccessIssue]


def test_a_class_below_another_checks_the_fields_of_both_and_keeps_its_rules():
    @value_class
    class Arm(Leg):
        """An arm."""

        reach: float = quantity("m", "How far", gt=0.0)

    assert Arm(length=1.0, reach=2.0).reach == 2.0
    for wrong in ({"reach": 0.0}, {"length": 0.0}, {"n_toes": 6, "is_wet": True}):
        with pytest.raises(ValueError):
            Arm(**{"length": 1.0, "reach": 1.0} | wrong)


def test_declarations_can_be_read():
    assert quantities_of(Leg)["length"] == Quantity(unit="m", text="From hip to foot", gt=0.0)
    assert "name" not in quantities_of(Leg)
    assert texts_of(Leg)["name"] == "What it is called"
    assert hints_of(Leg)["load"] == float | None


def test_a_value_tells_what_it_holds_in_units_and_degrees_and_leaves_out_what_says_nothing():
    @value_class
    class Foot:
        """A foot."""

        size: tuple[float, ...] = quantity("m", "Along both axes", default=())
        angle: float = quantity("rad", "To the leg", default=0.0)
        rate: float = quantity("rad/s", "Of that", default=math.inf)
        is_bare: bool = option("Whether it has no shoe", default=False)
        side: str = option("Which", default="left")
        hinge: Hinge | None = option("In it", default=None)

    assert describe_fields(Foot()) == {"side": "left"}
    foot = Foot(
        size=(0.3, 0.0), angle=math.radians(30), rate=math.radians(5), is_bare=True, hinge=Hinge()
    )
    words = {
        "size": "(0.3, 0) m",
        "angle": "30 deg",
        "rate": "5 deg/s",
        "is_bare": "yes",
        "side": "left",
    }
    assert describe_fields(foot) == words | {"hinge": "(stiffness 1 N m/rad)"}
    assert describe_fields(foot, "size", "hinge") == {
        name: one for name, one in words.items() if name != "size"
    }
    assert describe_fields(load_water("paper-vortex"))["drag"] == "quadratic only"


def test_help_lists_every_field_with_its_unit_range_and_default():
    assert Leg.__doc__ is not None
    assert Leg.__doc__.startswith("A leg.\n\nFields:\n")
    assert "    turn: Of the foot [rad], between -1 and 1; default 0.0.\n" in Leg.__doc__
    assert all(f"    {name}: " in Leg.__doc__ for name in hints_of(Leg))


def test_each_of_several_angles_may_be_given_in_degrees():
    assert Sonar(beams_deg=(-30, 0, 30)).beams == pytest.approx((-math.pi / 6, 0.0, math.pi / 6))
    with pytest.raises(ValueError, match=r"`beams_deg\[1\]` must be a number in deg, got 'ahead'"):
        Sonar(beams_deg=(-30, "ahead", 30))
    with pytest.raises(ValueError, match=r"`bias_deg` must be a number in deg, got \(1, 2\)"):
        Compass(bias_deg=(1, 2))
