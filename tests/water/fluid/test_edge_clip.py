"""A fin whose flow separates at a large incidence: the limit of its suction, an option."""

from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.robot import textbook_water
from laticauda.water.fluid.edges import NO_CAP, build_plate, finite_span, plate_functions

FISH = lc.load_robot("tendon-fish")
WATER = replace(textbook_water(FISH).water, trailing_edge="finite-span")
GAIT = lc.lateral_undulation(amplitude=0.35, frequency=5.0, phase_shift=0.5)


def plate(aspect: float, cap: float):
    return build_plate(
        plate_functions(aspect), mass_per_length=2.0, chord=0.5, height=0.5 * aspect, cap=cap
    )


def test_the_suction_is_held_at_the_limit_times_the_speed():
    attached, capped = plate(4.0, NO_CAP), plate(4.0, 0.2)
    u, w = 0.3, 0.4
    _, freely, _, _ = finite_span(u, w, 0.0, 0.0, *attached)
    _, held, _, _ = finite_span(u, w, 0.0, 0.0, *capped)
    _, other_side, _, _ = finite_span(u, -w, 0.0, 0.0, *capped)
    assert freely == pytest.approx(-u * attached.lift_mass * attached.instant * w)
    assert held == pytest.approx(-u * attached.lift_mass * 0.2 * 0.5)
    assert other_side == -held


def test_below_the_limit_nothing_changes_by_a_bit():
    attached, capped = plate(4.0, NO_CAP), plate(4.0, 0.2)
    for w, z in ((0.02, 0.05), (-0.1, 0.04)):
        assert finite_span(0.6, w, 0.3, z, *capped) == finite_span(0.6, w, 0.3, z, *attached)


def test_the_wake_takes_up_what_gives_the_held_suction():
    capped = plate(4.0, 0.2)
    u, w, z = 0.3, 0.4, 0.05
    _, _, _, rate = finite_span(u, w, 0.0, z, *capped)
    y = 0.2 * 0.5
    taken_up = (y - (1.0 - capped.instant) * z) / capped.instant
    assert rate == pytest.approx(u / capped.lag * (taken_up - z))


def test_the_edge_gives_no_energy_whatever_moves_and_however_little_suction_there_is():
    draw = np.random.default_rng(5)
    for _ in range(10_000):
        aspect, cap = np.exp(draw.uniform(-3.0, 3.0)), draw.uniform(0.01, 1.0)
        p = plate(aspect, cap)
        u, w, turning, z = draw.normal(size=4)
        f_t, f_n, moment, rate = finite_span(u, w, turning, z, *p)
        power = f_t * u + f_n * w + moment * turning
        # Of the added mass, the Munk moment and the force along, which this edge takes off again.
        if u > 0.0:
            power -= u * p.added_mass * w * turning - p.added_mass * w * turning * u
        stored = p.lift_mass * p.lag * p.instant * z * rate
        assert power + stored <= 1e-9 * (1.0 + abs(power))


def test_the_fish_swims_more_slowly_the_less_suction_its_fin_has():
    speeds = [
        lc.swim(FISH, GAIT, 6.0, environment=replace(WATER, edge_clip=clip)).forward_velocity
        for clip in (None, 0.2, 0.1)
    ]
    assert speeds[0] > speeds[1] > speeds[2] > 0.0
    batch = lc.swim_many(
        [FISH] * 2, [GAIT] * 2, 6.0, environments=replace(WATER, edge_clip=0.2), dt=0.01
    )
    single = lc.swim(FISH, GAIT, 6.0, environment=replace(WATER, edge_clip=0.2), dt=0.01)
    np.testing.assert_allclose(batch.forward_velocity, single.forward_velocity, rtol=1e-9)


@pytest.mark.parametrize("name", ["mamba-fin", "amphibot"])
def test_a_slender_body_has_no_leading_edge_at_which_a_flow_could_separate(name):
    robot = lc.load_robot(name)
    water = replace(textbook_water(robot).water, trailing_edge="finite-span", edge_clip=0.2)
    with pytest.raises(ValueError, match="`edge_clip` must be None for robot") as error:
        lc.swim(robot, GAIT, 1.0, environment=water)
    assert "whose trailing edge ends a slender body" in str(error.value)


def test_only_the_law_of_a_finite_span_has_a_suction_to_limit():
    with pytest.raises(ValueError, match="must be None unless `trailing_edge` is `finite-span`"):
        replace(WATER, trailing_edge="elongated", edge_clip=0.2)
