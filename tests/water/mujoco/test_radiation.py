"""Damping by the waves that a floating body makes: table, energy, decay, and where it does not act."""

import math

import mujoco
import numpy as np
import pytest
from campaign_scripts import campaign
from hypothesis import given, settings, strategies as st

from laticauda.water import mujoco as water
from laticauda.water.mujoco.radiation import with_radiation

radiation = campaign("radiation")
STILL = water.GeomCoefficients(drag=(0.0, 0.0, 0.0))
BODY = """<mujoco><option integrator="RK4" timestep="0.002"/><worldbody>
<body name="b" {pose}><freejoint/>{geom}</body></worldbody></mujoco>"""
BOX = '<geom type="box" size=".5 .2 .1" density="500"/>'
SHAPES = (
    BOX,
    '<geom type="ellipsoid" size=".3 .2 .1" density="500"/>',
    '<geom type="cylinder" size=".1 .3" zaxis="1 0 0" density="500"/>',
    '<geom type="capsule" size=".1 .3" zaxis="0 1 0" density="500"/>',
    '<geom type="cylinder" size=".2 .1" density="500"/>',
)


def floating(geom: str = BOX, pose: str = "", *, damped: bool = True):
    spec = mujoco.MjSpec.from_string(BODY.format(geom=geom, pose=pose))
    model = water.compile_spec(spec)
    elements = water.geom_elements(model, STILL)
    if damped:
        elements = with_radiation(model, elements)
    return model, water.attach(model, elements, surface=0.0)


def test_a_box_has_the_dampings_of_the_table():
    _, handle = floating()
    (element,) = handle.elements
    submerged = 0.04
    rows = np.loadtxt(radiation.STORED, delimiter=",", skiprows=1)
    # Its draft is a quarter of its width.
    near = rows[(rows[:, 0] == 0.4) & np.isin(rows[:, 1], (0.2, 0.4))]
    heave, roll, pitch = 0.75 * near[0, 2:] + 0.25 * near[1, 2:]
    scale = 1000.0 * math.sqrt(9.81)
    assert element.heave_damping == pytest.approx(heave * scale * submerged ** (5 / 6))
    right = (roll * scale * submerged**1.5, pitch * scale * submerged**1.5, 0.0)
    assert element.tilt_damping == pytest.approx(right)


def test_the_fit_of_attach_has_it_at_a_surface_only():
    spec = mujoco.MjSpec.from_string(BODY.format(geom=BOX, pose=""))
    assert water.attach(spec, surface=0.0).elements[0].heave_damping > 0.0
    assert water.attach(spec).elements[0].heave_damping == 0.0


@pytest.mark.parametrize("turn", ["0 0 0", "0 90 0", "90 0 0", "0 0 90"])
def test_a_box_is_damped_alike_whichever_of_its_axes_is_called_x(turn):
    sizes = {"0 0 0": ".5 .2 .1", "0 90 0": ".1 .2 .5", "90 0 0": ".5 .1 .2", "0 0 90": ".2 .5 .1"}
    geom = f'<geom type="box" size="{sizes[turn]}" euler="{turn}" density="500"/>'
    _, handle = floating(geom)
    (element,) = handle.elements
    _, level = floating()
    assert element.heave_damping == pytest.approx(level.elements[0].heave_damping)
    assert sorted(element.tilt_damping) == pytest.approx(sorted(level.elements[0].tilt_damping))


def test_heave_dies_out_at_the_rate_of_its_damping():
    model, handle = floating(pose='pos="0 0 .002"')
    (element,) = handle.elements
    data = mujoco.MjData(model)
    heights: list[float] = []
    while data.time < 3.0:
        mujoco.mj_step(model, data)
        heights.append(data.qpos[2])
    curve = np.array(heights)
    peaks = np.flatnonzero((curve[1:-1] > curve[:-2]) & (curve[1:-1] > curve[2:])) + 1
    moving = model.body_mass[1] + 0.5 * element.added_mass[2]
    rate = element.heave_damping / (2.0 * moving)
    found = -np.diff(np.log(curve[peaks])) / (np.diff(peaks) * 0.002)
    assert found[0] == pytest.approx(rate, rel=0.05)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10_000), st.sampled_from(SHAPES))
def test_it_only_takes_energy_and_turns_nothing_about_the_vertical(seed, geom):
    rng = np.random.default_rng(seed)
    loads: list[np.ndarray] = []
    pose = rng.normal(size=4)
    place = (0.0, 0.0, rng.uniform(-0.1, 0.1))
    rates = rng.normal(size=6)
    for damped in (True, False):
        model, _ = floating(geom, damped=damped)
        data = mujoco.MjData(model)
        data.qpos[:3] = place
        data.qpos[3:] = pose / np.linalg.norm(pose)
        data.qvel[:] = rates
        mujoco.mj_forward(model, data)
        loads.append(data.qfrc_passive.copy())
    damping = loads[0] - loads[1]
    assert damping @ rates <= 1e-9
    turned = data.xmat[1].reshape(3, 3) @ damping[3:]  # in world axes
    assert turned[2] == pytest.approx(0.0, abs=1e-9 * (1.0 + np.max(np.abs(damping))))
    np.testing.assert_allclose(damping[:2], 0.0, atol=1e-9 * (1.0 + abs(damping[2])))


@pytest.mark.parametrize("height", [-1.0, 1.0])
def test_it_is_nothing_deep_in_the_water_and_above_it(height):
    forces: list[np.ndarray] = []
    for damped in (True, False):
        model, _ = floating(pose=f'pos="0 0 {height}"', damped=damped)
        data = mujoco.MjData(model)
        data.qvel[:] = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
        mujoco.mj_forward(model, data)
        forces.append(data.qfrc_passive.copy())
    np.testing.assert_array_equal(*forces)
