"""Places: rays and distances agree with MuJoCo's own, and with geometry."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st

import laticauda as lc
from laticauda.missions.navigation import Navigation
from laticauda.sensing import Buoy, Compass, Dock, Net, Pipeline, Seabed, Wall, surroundings_of

PLACES = (
    Net(name="pen", center=(4.0, 1.0), radius=1.6),
    Wall(name="quay", begin=(-3.0, -2.0), end=(5.0, -4.0)),
    Pipeline(name="pipe", begin=(-2.0, 3.0, -0.4), end=(3.0, 4.0, -0.8)),
    Buoy(name="buoy", center=(-2.0, 0.5, -0.3)),
    Dock(name="dock", position=(1.0, -1.0), heading=0.4),
)
DIRECTIONS = st.tuples(st.floats(-math.pi, math.pi), st.floats(-0.5 * math.pi, 0.5 * math.pi))


@pytest.fixture(scope="module")
def water_with_places():
    mujoco = pytest.importorskip("mujoco")
    from laticauda.models.spatial.surroundings import add_places

    spec = mujoco.MjSpec()
    add_places(spec, PLACES)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return model, data


@settings(max_examples=80, deadline=None)
@given(
    st.tuples(st.floats(-1.0, 1.0), st.floats(-0.8, 0.8), st.floats(-1.5, -0.05)),
    DIRECTIONS,
)
def test_rays_hit_what_they_hit_in_mujoco(water_with_places, origin, angles):
    import mujoco

    # From inside of a shape, MuJoCo tells the way out, which no sonar hears.
    assume(surroundings_of(PLACES).distances(np.array([origin]))[0] > 0.0)
    model, data = water_with_places
    azimuth, elevation = angles
    direction = np.array(
        (
            math.cos(azimuth) * math.cos(elevation),
            math.sin(azimuth) * math.cos(elevation),
            math.sin(elevation),
        )
    )
    hit_geom = np.zeros(1, dtype=np.int32)
    expected = mujoco.mj_ray(model, data, np.array(origin), direction, None, 1, -1, hit_geom)
    hits = surroundings_of(PLACES).solids.cast(np.array(origin), direction[np.newaxis])
    if expected < 0.0:
        assert hits.distance[0] == np.inf
    else:
        assert hits.distance[0] == pytest.approx(expected, abs=1e-6)
        assert hits.normal[0] @ direction < 1e-9
        assert np.linalg.norm(hits.normal[0]) == pytest.approx(1.0)


@settings(max_examples=60, deadline=None)
@given(st.tuples(st.floats(-4.0, 6.0), st.floats(-5.0, 5.0), st.floats(-3.0, 0.5)), DIRECTIONS)
def test_no_ray_is_shorter_than_the_distance_to_the_nearest_surface(point, angles):
    surroundings = surroundings_of(PLACES)
    distance = surroundings.distances(np.array([point]))[0]
    azimuth, elevation = angles
    direction = np.array(
        (
            math.cos(azimuth) * math.cos(elevation),
            math.sin(azimuth) * math.cos(elevation),
            math.sin(elevation),
        )
    )
    hits = surroundings.solids.cast(np.array(point), direction[np.newaxis])
    if distance > 0.0:
        assert hits.distance[0] >= distance - 1e-9


def test_the_distance_to_one_place_leaves_out_the_others():
    surroundings = surroundings_of(PLACES)
    point = np.array([(4.0, 1.0, -1.0)])
    assert surroundings.distances(point, "buoy")[0] > 5.0
    assert surroundings.distances(point)[0] == surroundings.distances(point, "pen")[0]
    with pytest.raises(
        ValueError, match=r"`place` must be the name of a place, `pen`, `quay`.*got 'Pen'"
    ):
        surroundings.distances(point, "Pen")


def test_a_net_has_the_circumference_of_its_panels():
    net = Net(name="pen", radius=1.6)
    assert net.circumference == pytest.approx(sum(2.0 * solid.size[0] for solid in net.solids()))
    assert net.circumference > 10.0


@pytest.mark.parametrize(
    ("head", "heading_deg", "speed", "is_caught"),
    [
        ((0.0, 0.0), 0.0, 0.1, True),
        ((0.2, 0.0), 0.0, 0.1, False),
        ((0.0, 0.0), 40.0, 0.1, False),
        ((0.0, 0.0), -370.0, 0.1, True),
        ((0.0, 0.0), 0.0, 0.6, False),
    ],
)
def test_a_dock_catches_a_head_that_is_near_aligned_and_slow(head, heading_deg, speed, is_caught):
    dock = Dock(name="dock")
    assert dock.catches(np.array((*head, 0.0)), math.radians(heading_deg), speed) == is_caught


def test_two_places_of_one_name_are_refused():
    with pytest.raises(ValueError, match="`places` must have different names, got `a` twice"):
        lc.Planar(places=(Buoy(name="a"), Buoy(name="a")))


def test_a_robot_in_space_touches_places():
    pytest.importorskip("mujoco")
    gait = lc.lateral_undulation(amplitude_deg=30, frequency_deg_s=130, phase_shift_deg=40)
    wall = Wall(name="quay", begin=(1.1, -2.0), end=(1.1, 2.0))
    trial = lc.swim("mamba", gait, 6.0, model="spatial", joints="servo", places=(wall,))
    assert np.abs(trial.link_force["contact"][-1]).max() > 0.1
    free = lc.swim("mamba", gait, 6.0, model="spatial", joints="servo")
    assert trial.center_of_mass[-1, 0] < free.center_of_mass[-1, 0] - 0.1


def area_of(outline):
    x, y = outline.T
    return 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))


@pytest.mark.parametrize(
    ("place", "area"),
    [
        (Wall(name="quay", begin=(-3.0, -2.0), end=(1.0, 1.0)), 5.0 * 0.1),
        (Pipeline(name="level", begin=(0.0, 0.0, -1.0), end=(3.0, 4.0, -1.0)), 5.0 * 0.6),
        (Pipeline(name="upright", begin=(0.0, 0.0, 0.0), end=(0.0, 0.0, -1.0)), math.pi * 0.3**2),
        (Buoy(name="buoy", center=(-2.0, 0.5, -0.3)), math.pi * 0.2**2),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_the_outline_of_a_shape_is_what_is_seen_from_above(place, area):
    (outline,) = place.outlines()
    assert area_of(outline) == pytest.approx(area, rel=0.01)


def test_the_bed_has_no_outline_since_it_is_everywhere():
    assert Seabed(depth=3.0).outlines() == ()


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (
            lambda: Dock(name="dock", capture_heading=50.0),
            "`capture_heading` .*capture_heading_deg=50",
        ),
        (lambda: Compass(noise=5.0), "`noise` .*noise_deg=5"),
        (lambda: Compass(bias=-10.0), "`bias` .*bias_deg=-10"),
        (lambda: Navigation(beams=(90.0,)), r"`beams\[0\]` .*beams_deg=90"),
    ],
)
def test_an_angle_that_was_meant_in_degrees_is_refused(build, message):
    with pytest.raises(ValueError, match=message):
        build()
