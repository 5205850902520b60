import math

import numpy as np
import pytest

import laticauda as lc
from laticauda.robot.kinematics import Posture
from laticauda.show.cockpit import Live
from laticauda.show.cockpit.changes import change_fin
from laticauda.show.cockpit.shapes import build_shapes, compute_poses

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)


@pytest.mark.parametrize("rigidity", [None, 0.2])
def test_modules_and_fin_are_where_kinematics_has_them(rigidity):
    robot = change_fin(lc.load_robot("mamba"), True, rigidity)
    live = Live(lc.build_scenario(robot, GAIT))
    for _ in range(60):
        live.advance(0.05)
    sample = live.latest()
    found = compute_poses(robot, sample, height=0.3)
    angles = (
        None
        if rigidity is None
        else np.array([sample.signals[f"fin_angle_{k}"] for k in (1, 2, 3)])
    )
    place = sample.center_of_mass, sample.link_angle
    ends = Posture(robot, *place, fin_angle=angles).link_ends
    np.testing.assert_allclose(found.position[:9, :2], ends[:-1], atol=1e-12)
    line = Posture(robot, *place, fin_angle=angles).fin_line
    np.testing.assert_allclose(found.position[9:, :2], line[:0:-1], atol=1e-12)
    np.testing.assert_allclose(found.position[:, 2], 0.3)
    assert max(shape.part for shape in build_shapes(robot)) == len(found.position) - 1


def test_both_models_show_the_same_robot():
    pytest.importorskip("mujoco")
    seen = []
    for model in ("planar", "spatial"):
        live = Live(lc.build_scenario("mamba-fin", GAIT, model=model))
        for _ in range(40):
            live.advance(0.05)
        seen.append(compute_poses(live.simulation.plant.robot, live.latest()))
    np.testing.assert_allclose(seen[0].position[:, :2], seen[1].position[:, :2], atol=0.02)
    turned = np.abs(np.sum(seen[0].orientation * seen[1].orientation, axis=1))
    assert np.arccos(np.minimum(turned, 1.0)).max() < math.radians(1.0)
