"""Flows: values whose formulas are compiled, sums of parts, what a small body meets in them."""

from dataclasses import replace

import numpy as np
import pytest
from flow_laws import Moving
from numba import njit

import laticauda as lc
from laticauda.compiling.formulas import summed
from laticauda.compiling.lane_types import rows_of as rows_of_lanes
from laticauda.robot import Current, load_robot, load_water
from laticauda.values.codec import decode, encode
from laticauda.values.quantities import quantity, value_class
from laticauda.water.fluid.flow import Flow, FunctionFlow, Sum, rows_of
from laticauda.water.fluid.uniform import Uniform

GAIT = lc.Gait(amplitude=0.5, frequency=2.2, phase_shift=0.7)
WATER = load_water("paper-lateral")


@value_class
class Swirl(Flow):
    """Water that moves as one, and turns as one about a point."""

    v_x: float = quantity("m/s", "velocity", default=0.0)
    v_y: float = quantity("m/s", "velocity", default=0.0)
    rate: float = quantity("rad/s", "angular velocity", default=0.0)

    def __call__(self, x, y, z, t):
        return self.v_x - self.rate * y, self.v_y + self.rate * x, 0.0


def test_a_small_body_in_water_that_turns_as_one_meets_its_rotation_and_its_centripetal_acceleration():
    felt = Swirl(rate=0.7).felt(0.3, -0.2, 0.0, 5.0)
    assert felt.s_z == pytest.approx(0.7, abs=1e-9)
    assert (felt.a_x, felt.a_y) == pytest.approx((-0.49 * 0.3, 0.49 * 0.2), abs=1e-9)
    assert (felt.s_x, felt.s_y, felt.a_z, felt.elevation) == (0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("form", ["relative", "kirchhoff", "classic"])
@pytest.mark.parametrize("robot", ["mamba", "mamba-fin"])
def test_a_flow_that_is_everywhere_the_same_is_that_current_to_rounding(robot, form):
    water = replace(WATER, added_mass_form=form)
    known = lc.swim(robot, GAIT, duration=3.0, environment=replace(water, current=(0.05, -0.03)))
    found = lc.swim(
        robot, GAIT, duration=3.0, environment=replace(water, current=Moving(v_x=0.05, v_y=-0.03))
    )
    assert np.abs(found.center_of_mass - known.center_of_mass).max() < 1e-14
    assert found.speed_through_water == pytest.approx(known.speed_through_water, rel=1e-12)


def test_runs_side_by_side_in_flows_with_other_numbers_are_those_of_each_alone():
    swirls = [Moving(v_x=0.02 * k, shear=-0.05 * k, swing=0.05 * k) for k in range(3)]
    scenarios = [
        lc.build_scenario(load_robot("mamba"), GAIT, 2.0, environment=replace(WATER, current=one))
        for one in swirls
    ]
    together = lc.swim_many(scenarios).center_of_mass
    for scenario, end in zip(scenarios, together, strict=True):
        assert np.array_equal(lc.swim(scenario).center_of_mass[-1], end)


def test_a_sum_of_flows_is_the_flow_of_their_sum_accelerations_too():
    both = Swirl(v_x=0.1) + Swirl(rate=0.4) + Swirl(v_y=-0.2)
    one = Swirl(v_x=0.1, v_y=-0.2, rate=0.4)
    assert both.felt(0.5, 0.6, 0.0, 1.0) == pytest.approx(one.felt(0.5, 0.6, 0.0, 1.0), abs=1e-8)
    rows = rows_of(both)
    assert len(rows.kinds) == 1
    assert rows.counts == (3,)
    assert rows.numbers.tolist() == [3.0, 0.1, 0.0, 0.0, 0.0, 0.0, 0.4, 0.0, -0.2, 0.0]


def test_a_flow_gives_the_velocity_at_many_points_at_once():
    points = np.array([[[0.1, 0.2, 0.0], [0.3, 0.4, -1.0]]])
    assert Swirl(rate=2.0, v_x=0.1).velocity(points, 0.0) == pytest.approx(
        np.array([[[-0.3, 0.2, 0.0], [-0.7, 0.6, 0.0]]])
    )


def test_a_water_with_a_flow_goes_through_files():
    class_water = replace(WATER, current=Swirl(rate=0.1) + Swirl(v_x=0.2))
    table = encode(class_water)
    assert table["current"]["kind"] == "sum"
    assert decode(type(class_water), table) == class_water
    assert decode(Current, [0.1, 0.2]) == (0.1, 0.2)
    assert decode(Current, {"kind": "swirl", "rate": 0.1}) == Swirl(rate=0.1)


FLOWS = {
    "sum of two kinds": Swirl(v_x=0.1) + Uniform(u=0.2) + Swirl(rate=0.4),
    "lamb-oseen": Flow.named("lamb-oseen")(circulation=0.3, core=0.2, viscosity=1e-3),
    "karman-street": Flow.named("karman-street")(pairs=3),
    "wake": Flow.named("wake")(
        speed=0.2, period=1.3, width=0.2, circulation=0.05, core=0.05, viscosity=1e-4, pairs=3
    ),
    "turbulence": Flow.named("turbulence")(modes=5, mean=(0.1, 0.0, 0.0), evolution=1.0),
}


@pytest.mark.parametrize("flow", FLOWS.values(), ids=FLOWS)
def test_what_kernels_compute_of_a_flow_is_what_python_does_in_numbers_and_in_lanes(flow):
    rows = rows_of(flow)
    motion, lanes = summed(rows.kinds, 16), rows_of_lanes(8)

    @njit(error_model="numpy")
    def alone(S, x, y, z, t):
        return motion(S, 0, x, y, z, t)

    @njit(error_model="numpy")
    def together(flat, places, out):
        S, P, found = lanes(flat), lanes(places), lanes(out)
        for k, one in enumerate(motion(S, 0, P[0], P[1], P[2], P[3])):
            found[k] = one

    places = np.random.default_rng(1).uniform(-2.0, 2.0, (4, 8))
    out = np.zeros((16, 8))
    together(np.repeat(rows.numbers[:, np.newaxis], 8, axis=1), places, out)
    turned = rows.numbers + 0j
    for lane, place in enumerate(places.T):
        known = flow.motion(*place)
        assert alone(rows.numbers, *place) == pytest.approx(tuple(known), rel=1e-9, abs=1e-12)
        assert tuple(out[:, lane]) == pytest.approx(tuple(known), rel=1e-9, abs=1e-12)
        slope = np.imag(alone(turned, place[0] + 1e-30j, *place[1:])[0]) / 1e-30
        assert slope == pytest.approx(known.u_x, abs=1e-6)


@pytest.mark.parametrize(
    ("flow", "message"),
    [
        (
            FunctionFlow(function=lambda x, y, z, t: (x, y)),
            "must return 3 numbers .* or the 16 of a `Motion`, got",
        ),
        (
            FunctionFlow(function=lambda x, y, z, t: 0.3),
            "must return 3 numbers .* or the 16 of a `Motion`, got 0.3",
        ),
        (Sum(flows=(FunctionFlow(function=lambda x, y, z, t: open(x)),)), "."),
    ],
)
def test_a_flow_that_no_kernel_can_compile_is_refused(flow, message):
    with pytest.raises((ValueError, TypeError), match=message):
        flow.check()
