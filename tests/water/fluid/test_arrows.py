import numpy as np
import pytest
from hypothesis import given, strategies as st

from laticauda.water.fluid.arrows import (
    LONGEST_IN_SPACINGS,
    REACH_IN_LENGTHS,
    arrows_of,
    round_down,
)
from laticauda.water.fluid.flow import FunctionFlow
from laticauda.water.fluid.surface import MOMENTS, Surface, has_waves, surface_elevation

VORTEX = FunctionFlow(function=lambda x, y, z, t: (-0.3 * y + 0.0 * t, 0.3 * x, 0.1 * z))
WAVE = FunctionFlow(
    function=lambda x, y, z, t: (0.0 * x,) * 15 + (0.1 * np.cos(3.0 * x - 2.0 * t),)
)
LOW, HIGH = np.array((-1.0, -2.0, -0.5)), np.array((3.0, 1.0, -0.5))


@given(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(0.3, 4.0))
def test_an_arrow_stands_around_its_place_in_the_world_and_is_the_way_of_the_water_there(
    x: float, y: float, r: float
):
    arrows = arrows_of(VORTEX.velocity, LOW, HIGH, MOMENTS, r)
    assert arrows is not None
    tails, tips = np.moveaxis(arrows.around(np.array((x, y, -0.5)), 0.0), 1, 0)
    places = 0.5 * (tails + tips)
    assert np.allclose(
        places[:, :2] / arrows.spacing, np.round(places[:, :2] / arrows.spacing), atol=1e-9
    )
    assert np.all(np.hypot(*(places[:, :2] - (x, y)).T) <= REACH_IN_LENGTHS * r)
    way, drawn = VORTEX.velocity(places, 0.0) * arrows.time, tips - tails
    length = np.linalg.norm(way, axis=1)
    whole = length <= LONGEST_IN_SPACINGS * arrows.spacing
    assert np.allclose(drawn[whole], way[whole])
    assert np.allclose(np.linalg.norm(drawn[~whole], axis=1), LONGEST_IN_SPACINGS * arrows.spacing)
    assert np.allclose(np.cross(drawn, way), 0.0, atol=1e-9)


@given(st.floats(1e-9, 1e9))
def test_round_numbers_are_1_2_3_or_5_times_a_power_of_ten_and_not_above(number: float):
    found = round_down(number)
    assert found <= number * (1.0 + 1e-6) and found > 0.49 * number
    assert f"{found:e}"[0] in "1235"


def test_most_arrows_are_not_longer_than_the_way_to_the_next_and_still_water_has_none():
    arrows = arrows_of(VORTEX.velocity, LOW, HIGH, MOMENTS)
    assert arrows is not None and 10 <= 4.0 / arrows.spacing <= 20
    places = np.column_stack(
        (arrows.places(LOW[:2], HIGH[:2]), np.full(len(arrows.places(LOW[:2], HIGH[:2])), -0.5))
    )
    lengths = np.linalg.norm(VORTEX.velocity(places, 0.0), axis=1) * arrows.time
    assert np.mean(lengths <= arrows.spacing) > 0.9
    assert np.max(lengths) > 0.9 * arrows.spacing
    assert arrows_of(lambda points, t: np.zeros_like(points), LOW, HIGH, MOMENTS) is None


def test_only_flows_that_move_the_surface_have_waves():
    middle = np.array((100.0, 0.0))
    assert has_waves(WAVE, middle) and not has_waves(VORTEX, middle) and not has_waves(None, middle)
    places = np.array([(0.1, 0.0), (0.2, 5.0)])
    assert surface_elevation(WAVE, places, 0.5) == pytest.approx(
        0.1 * np.cos(3.0 * places[:, 0] - 1.0)
    )


def test_a_surface_covers_its_square_once_with_triangles_seen_from_above_at_its_elevation():
    surface = Surface(WAVE, 4.0, 7)
    corners = surface.at(np.array((2.0, 1.0, -3.0)), 0.5)
    assert corners[:, 2] == pytest.approx(0.1 * np.cos(3.0 * corners[:, 0] - 1.0))
    a, b, c = (
        np.column_stack((corners[k, :2], np.zeros(len(surface.faces)))) for k in surface.faces.T
    )
    areas = 0.5 * np.cross(b - a, c - a)[:, 2]
    assert np.all(areas > 0.0)
    assert np.sum(areas) == pytest.approx(64.0)


def test_arrows_in_space_stand_in_the_water_and_not_above_it():
    level = np.array((0.0, 0.0, 0.05))
    flow = VORTEX + WAVE
    arrows = arrows_of(flow.velocity, level, level, MOMENTS, 2.0, flow)
    assert arrows is not None
    places = np.mean(arrows.around(level, 0.5), axis=1)
    assert np.all(0.1 * np.cos(3.0 * places[:, 0] - 1.0) >= 0.05) and 0 < len(places) < len(
        arrows.around(-level, 0.5)
    )
