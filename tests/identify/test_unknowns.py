import math

import pytest
from identify.trials import DRAG, FRICTION, speeds

from laticauda.identify import Unknown
from laticauda.identify.problem import make_problem
from laticauda.identify.resolving import RANGE

MEASURED = speeds(2)


def resolved(unknown):
    return make_problem(MEASURED, [unknown]).unknowns[0]


def test_what_is_left_open_comes_from_the_measurements_and_the_field():
    found = resolved(FRICTION)
    assert found.is_log and found.start == 0.3 and found.size == 1.0
    assert (found.lower, found.upper) == (0.3 / RANGE, 0.3 * RANGE)
    assert found.value(found.x(0.17)) == pytest.approx(0.17, rel=1e-15)


def test_what_may_be_negative_or_begins_at_zero_is_on_a_linear_scale():
    current, tether = resolved("water.current_x"), resolved("robot.tether.drag")
    assert not current.is_log and (current.lower, current.upper, current.size) == (-1e4, 1e4, 0.1)
    assert not tether.is_log and (tether.lower, tether.upper) == (0.0, math.inf)
    assert resolved("measured.heading_offset").lower == -math.inf


def test_a_range_ends_where_the_field_ends():
    limit = resolved("robot.joint.limit")
    assert limit.upper == pytest.approx(math.pi, rel=1e-6)
    assert limit.upper <= math.pi


@pytest.mark.parametrize(
    "fields, words",
    [
        ({"name": ""}, "`name` must be a text on one line that is not blank"),
        (
            {"lower": 2.0, "upper": 1.0},
            "`lower` of `water.normal_drag` must be < its `upper` of 1, got 2",
        ),
        (
            {"start": 3.0, "upper": 2.0},
            "`start` of `water.normal_drag` must be between -inf and 2, got 3",
        ),
        ({"scale": "cubic"}, "`scale` must be one of"),
        (
            {"scale": "log", "lower": 0.0},
            "`lower` of `water.normal_drag` must be > 0 on a log scale",
        ),
        ({"prior": (1.0, 0.0)}, "`sd of the prior` of `water.normal_drag` must be > 0"),
        ({"start": math.nan}, "`start` must be a finite number"),
        ({"size": -1.0}, "`size` must be > 0"),
    ],
)
def test_bad_unknowns_are_refused_by_name(fields, words):
    with pytest.raises(ValueError, match=words):
        Unknown(**({"name": DRAG} | fields))


def test_ends_that_the_field_does_not_allow_are_refused():
    rule = r"`lower` of `water.normal_drag` must be in its range, got -1: .*>= 0"
    with pytest.raises(ValueError, match=rule):
        resolved(Unknown(name=DRAG, lower=-1.0, scale="linear"))
    with pytest.raises(
        ValueError, match=r"`start` of `robot.tether.drag` must be > 0 on a log scale, got 0"
    ):
        resolved(Unknown(name="robot.tether.drag", scale="log"))
