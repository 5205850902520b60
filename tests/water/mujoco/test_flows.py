"""Flows in MuJoCo: given, changed and taken back, kept by copies and pickles, and what their surface does to bodies."""

import copy
import pickle

import mujoco
import numpy as np
import pytest

from laticauda.values.quantities import quantity, value_class
from laticauda.water import mujoco as water
from laticauda.water.fluid.flow import Flow
from laticauda.water.mujoco import Element, table

BALL = """<mujoco><option timestep="0.002" gravity="{gravity}"/><worldbody><body name="b" pos="{place}"><freejoint/>
<geom name="g" size=".1" density="500"/></body></worldbody></mujoco>"""
DRAG = Element(body="b", drag=(20.0,) * 3, added_mass=(2.0,) * 3, volume=4e-3, half_size=(0.1,) * 3)


@value_class
class Swell(Flow):
    """Waves of deep water along x, and a current."""

    amplitude: float = quantity("m", "of the surface", default=0.05)
    k: float = quantity("1/m", "wave number", default=2.0)
    omega: float = quantity("rad/s", "frequency", default=4.4)
    along: float = quantity("m/s", "velocity of the current", default=0.0)

    def __call__(self, x, y, z, t):
        a, k, omega = self.amplitude, self.k, self.omega
        decay = a * omega * np.exp(k * z)
        c, s = decay * np.cos(k * x - omega * t), decay * np.sin(k * x - omega * t)
        o = 0.0 * c
        rates, slopes = (omega * s, o, -omega * c), (-k * s, o, k * c, o, o, o, k * c, o, k * s)
        return (self.along + c, o, s, *rates, *slopes, a * np.cos(k * x - omega * t))


def ball(gravity: str = "0 0 0", place: str = "0 0 -1"):
    return water.compile_spec(mujoco.MjSpec.from_string(BALL.format(gravity=gravity, place=place)))


def acceleration(model, time: float = 0.3) -> np.ndarray:
    data = mujoco.MjData(model)
    data.time = time
    mujoco.mj_forward(model, data)
    return data.qacc.copy()


def in_water(current, place: str = "0 0 -1") -> np.ndarray:
    model = ball(place=place)
    water.attach(model, [DRAG], current=current)
    return acceleration(model)


def test_a_flow_is_set_and_taken_back_and_a_copy_has_its_own():
    model, swell, other = ball(), Swell(), Swell(along=0.3) + Swell(k=1.0, omega=3.0)
    handle = water.attach(model, [DRAG], current=swell)
    twin = copy.deepcopy(model)
    assert np.array_equal(acceleration(twin), in_water(swell))
    handle.set_current(other)
    assert handle.current is other
    assert water.attached(twin).current is swell
    assert np.array_equal(acceleration(model), in_water(other))
    assert np.array_equal(acceleration(twin), in_water(swell))
    water.attached(twin).set_current((0.1, 0.0, 0.2))
    assert np.array_equal(acceleration(twin), in_water((0.1, 0.0, 0.2)))
    handle.set_current(None)
    assert np.array_equal(acceleration(model), in_water(swell))
    assert len({tuple(in_water(one)) for one in (swell, other, (0.1, 0.0, 0.2))}) == 3


def test_a_pickled_model_keeps_the_flow_that_it_was_given_last():
    model = ball()
    water.attach(model, [DRAG]).set_current(Swell(along=0.2))
    found = pickle.loads(pickle.dumps(model))
    assert np.array_equal(acceleration(found), in_water(Swell(along=0.2)))
    water.attached(found).set_current(None)
    assert not acceleration(found).any()


def test_a_water_keeps_the_last_flows_and_refuses_a_copy_whose_flow_is_gone():
    model = ball()
    handle = water.attach(model, [DRAG], current=Swell())
    twin = copy.deepcopy(model)
    swells = [Swell(along=0.01 * k) for k in range(table.MOST_FLOWS)]
    for one in (*swells, *swells):  # those that it has are not new
        handle.set_current(one)
    assert len(handle.flows) == table.MOST_FLOWS
    assert np.array_equal(acceleration(model), in_water(swells[-1]))
    with pytest.raises(mujoco.FatalError, match="this model has lost the flow of its water"):
        acceleration(twin)
    water.attached(twin).set_current(swells[0])
    assert np.array_equal(acceleration(twin), in_water(swells[0]))


@pytest.mark.parametrize(
    ("current", "message"),
    [
        (
            (0.1, 0.2),
            r"`current` must be a flow, a function of x, y, z and t, or 3 numbers, got \(0.1, 0.2\)",
        ),
        ((0.1, 0.2, float("nan")), r"`current\[2\]` must be a finite number in m/s, got nan"),
        (
            lambda x, y, z, t: (x, y),
            r"must return 3 numbers \(u, v, w\) or the 16 of a `Motion`, got \(0.1, 0.2\)",
        ),
        (
            lambda x, y, z, t: (x, y, open),
            "must have a formula that Numba can compile|unsupported operand",
        ),
    ],
)
def test_what_is_no_current_is_refused(current, message: str):
    with pytest.raises((ValueError, TypeError), match=message):
        water.attach(ball(), [DRAG], current=current)


def test_heights_of_a_flow_count_from_the_mean_surface():
    model = ball(place="0 0 .5")
    water.attach(model, [DRAG], surface=1.5, current=Swell())
    assert np.allclose(acceleration(model), in_water(Swell()), rtol=1e-12)


def test_a_body_is_wet_as_far_as_the_surface_where_it_is():
    """At time 0 a crest is at x = 0, and a trough half a length away."""
    length, covered = np.pi, []
    for x in (0.0, 0.25 * length, 0.5 * length):
        model = ball("0 0 -9.81", f"{x} 0 0")
        handle = water.attach(
            model, [DRAG], surface=0.0, current=Swell(amplitude=0.05), usual_speed=0.01
        )
        lift = handle.forces(mujoco.MjData(model))["buoyancy"][0, 2]
        covered.append(lift / (1000.0 * 9.81 * DRAG.volume))
    s = 0.5
    assert covered == pytest.approx(
        [0.25 * (1 + s) ** 2 * (2 - s), 0.5, 0.25 * (1 - s) ** 2 * (2 + s)], abs=1e-12
    )


@pytest.mark.parametrize("rising", [0.22, -0.22, 0.0])
def test_rising_water_wets_a_body_at_rest_as_water_at_rest_does_one_that_sinks(rising: float):
    """What the wet part takes along grows, against the velocity along y; where it falls there is no such load."""

    def lifted(x, y, z, t):
        o = 0.0 * t
        return o, o, o, o, o, o, o, o, o, o, o, o, o, o, o, rising * t

    def load(current, sinking: float) -> float:
        model = ball(place="0 0 0")
        element = Element(body="b", added_mass=(2.0,) * 3, half_size=(0.1,) * 3)
        handle = water.attach(model, [element], surface=0.0, current=current)
        data = mujoco.MjData(model)
        data.qvel[1:3] = 1.0, -sinking
        return handle.forces(data)["added_mass"][0, 1]

    found = load(lifted, 0.0)
    assert found == pytest.approx(load((0.0, 0.0, 0.0), rising), rel=1e-6)
    assert (found < -1.0) == (rising > 0.0)
