"""Water that moves everywhere alike, or in layers."""

import math
from dataclasses import replace

import pytest
from flow_laws import check_derivatives, check_incompressible
from hypothesis import given, strategies as st

from laticauda.robot import load_water
from laticauda.water.fluid.uniform import BED_LAYER, LinearShear, PowerLawShear, Uniform

PLACE = st.floats(-2.0, 2.0)
FLOWS = {
    "uniform": Uniform(u=0.1, v=-0.2, w=0.05, turning=0.4, ramp=3.0),
    "linear": LinearShear(speed=0.1, direction=0.4, across=0.2, upward=-0.3),
    "power-law": PowerLawShear(speed=0.3, direction=-2.0, depth=1.5),
}


@pytest.mark.parametrize("flow", FLOWS.values(), ids=FLOWS)
@given(x=PLACE, y=PLACE, height=st.floats(0.02, 0.98), t=st.floats(0.0, 20.0))
def test_layers_are_incompressible_and_their_derivatives_are_those_of_their_velocity(
    flow, x, y, height, t
):
    z = -1.5 * (1.0 - height)
    check_incompressible(flow, x, y, z, t)
    if abs(t - 3.0) > 1e-3:  # the second derivative of the ramp jumps at its end
        check_derivatives(flow, x, y, z, t)


@given(u=PLACE, v=PLACE, w=PLACE)
def test_uniform_water_that_neither_turns_nor_begins_is_a_current_as_given_by_numbers(u, v, w):
    water = replace(load_water("paper-lateral"), current=Uniform(u=u, v=v, w=w))
    assert (*water.current, 0.0)[:3] == (u, v, w)
    assert Uniform(u=u, ramp=1.0).constant is None


def test_turning_water_turns_and_beginning_water_begins_at_rest_and_ends_with_its_velocity():
    assert Uniform(u=0.2, turning=0.5).motion(1.0, 2.0, 3.0, math.pi).v == pytest.approx(0.2)
    begins = Uniform(u=0.2, w=0.1, ramp=4.0)
    assert begins.motion(0.0, 0.0, 0.0, 0.0)[:6] == (0.0,) * 6
    assert begins.motion(0.0, 0.0, 0.0, 2.0)[:3] == pytest.approx((0.1, 0.0, 0.05))
    assert begins.motion(0.0, 0.0, 0.0, 4.0)[:6] == (0.2, 0.0, 0.1, 0.0, 0.0, 0.0)


def test_the_layers_of_a_river_follow_their_power_and_end_at_the_bed_and_at_the_surface():
    river = PowerLawShear(speed=0.4, depth=2.0, exponent=0.25)

    def speed(z):
        return river.motion(0.0, 0.0, z, 0.0).u

    assert speed(-1.0) == pytest.approx(0.4 * 0.5**0.25)
    assert speed(0.0) == speed(0.3) == 0.4
    assert speed(-2.0) == speed(-2.5) == 0.0
    edge = -2.0 * (1.0 - BED_LAYER)
    assert speed(edge - 1e-9) == pytest.approx(speed(edge + 1e-9), rel=1e-5)
    assert speed(-2.0 * (1.0 - 0.5 * BED_LAYER)) == pytest.approx(0.5 * speed(edge), rel=1e-9)
