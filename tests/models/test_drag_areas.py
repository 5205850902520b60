"""Bars, arms and cables on a robot's modules: they drag, in the plane and in space, and nothing else."""

from dataclasses import replace

import numpy as np
import pytest

import laticauda as lc
from laticauda.models.simulate.numbers import change_parameters
from laticauda.robot import CaudalFin, DragArea, Robot, from_toml, load_robot, to_toml
from laticauda.robot.hydrodynamics import link_coefficients
from laticauda.trials.metrics import towing_drag
from laticauda.water.fluid.laws import PolynomialDrag, TotalSpeedDrag

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.3, phase_shift=0.7)
QUADRATIC = PolynomialDrag(linear=False)
WATER = replace(lc.load_water("paper-lateral"), drag=QUADRATIC)
BARS = (
    DragArea(link=0, x=-0.05, along=0.002, across=0.001),
    DragArea(link=4, along=0.004),
    DragArea(link=0, x=0.03, along=0.001, across=0.003),
)


def barred(name: str, *bars: DragArea) -> Robot:
    return replace(load_robot(name), drag_areas=bars or BARS)


@pytest.mark.parametrize("name", ["mamba", "mamba-fin"])
def test_towed_straight_a_robot_has_the_drag_of_its_bars_as_well(name):
    bare = towing_drag(load_robot(name), WATER, 0.3)
    with_bars = towing_drag(barred(name), WATER, 0.3)
    assert with_bars - bare == pytest.approx(500.0 * 0.007 * 0.3**2)


def test_a_robot_that_coasts_is_braked_by_its_bars():
    robot = barred("mamba", DragArea(link=3, along=0.01))
    still = replace(GAIT, amplitude=0.0)
    water = replace(WATER, tangential_friction=0.0, current=(0.0, 0.0))
    trial = lc.swim(robot, still, 4.0, environment=water, start=lc.Start(velocity=0.5))
    inertia = robot.mass
    # m v' = -1/2 rho C_D A v^2
    expected = 0.5 / (1.0 + 0.5 * 500.0 * 0.01 / inertia * trial.time)
    np.testing.assert_allclose(trial.center_of_mass_velocity[:, 0], expected, rtol=1e-6)


def test_a_bar_has_half_the_density_times_its_area_at_its_place():
    robot = replace(load_robot("mamba"), drag_areas=(DragArea(link=0, x=-0.09, across=0.01),))
    links = link_coefficients(robot, WATER)
    assert links.areas is not None
    assert links.areas.position[0] == pytest.approx(0.0)
    assert links.areas.c_n[0] == pytest.approx(5.0)


@pytest.mark.parametrize("law", [QUADRATIC, TotalSpeedDrag(beta=0.5)], ids=repr)
@pytest.mark.parametrize("fin", [None, CaudalFin(), CaudalFin(n_hinges=1, flexural_rigidity=2.0)])
def test_bars_drag_alike_in_the_plane_and_in_space(fin, law):
    pytest.importorskip("mujoco")
    robot = replace(barred("mamba"), caudal_fin=fin)
    water = replace(WATER, drag=law, current=(0.1, 0.05))
    ends = [
        lc.swim(robot, GAIT, 1.5, environment=water, model=model, dt=0.001).center_of_mass[-1, :2]
        for model in ("planar", "spatial")
    ]
    bare = replace(robot, drag_areas=())
    without = lc.swim(bare, GAIT, 1.5, environment=water, dt=0.001).center_of_mass[-1]
    np.testing.assert_allclose(ends[0], ends[1], atol=2e-5)
    assert np.linalg.norm(ends[0] - without) > 1e-3


def test_bars_are_kept_in_files_and_swept_by_name(tmp_path):
    robot = barred("mamba")
    assert from_toml(_written(to_toml(robot), tmp_path)) == robot
    alongs = (0.004, 0.04)
    robots = [barred("mamba", BARS[0], replace(BARS[1], along=along), BARS[2]) for along in alongs]
    scenario = lc.build_scenario(robot, GAIT, 3.0, environment=WATER)
    for along, other in zip(alongs, robots, strict=True):
        changed = change_parameters(scenario, {"robot.drag_area[1].along": along})
        assert changed.robot == other
    speeds = [lc.swim(other, GAIT, 3.0, environment=WATER).forward_velocity for other in robots]
    batch = lc.swim_many(robots, [GAIT] * 2, 3.0, environments=WATER)
    np.testing.assert_allclose(batch.forward_velocity, speeds, rtol=1e-9)
    assert speeds[1] < speeds[0]


def _written(text, folder):
    path = folder / "robot.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_bars_keep_their_places_when_modules_merge():
    robot = replace(load_robot("mamba-modules"), drag_areas=(DragArea(link=18, along=0.01),))
    merged = robot.planar().drag_areas[0]
    assert merged.link == robot.planar().n_links - 1
    assert merged.along == 0.01


def test_a_bar_on_no_link_is_refused():
    with pytest.raises(ValueError, match=r"`drag_areas\[0\].link` must be 0 \(tail\) to 8"):
        barred("mamba", DragArea(link=9, along=0.1))
    with pytest.raises(ValueError, match=r"`along` must be between 0 and 10000 m\^2, got -0.1"):
        DragArea(link=0, along=-0.1)


def test_on_ground_bars_do_nothing():
    ground = lc.load_ground("viscous")
    assert link_coefficients(barred("mamba"), ground).areas is None
