"""What is drawn around the robot on the page."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import laticauda as lc
from laticauda.sensing import Buoy, Net, Pipeline
from laticauda.show.cockpit.scene import Scene, _solids_around

GAIT = lc.lateral_undulation(amplitude=0.5, frequency=2.0, phase_shift=0.7)
PLACES = (
    Net(name="pen", center=(4.0, 2.0), radius=1.0, panels=3),
    Buoy(name="mark", center=(3.0, 0.0, -0.1)),
    Pipeline(name="pipe", begin=(0.0, 3.0, -0.4), end=(3.0, 4.0, -0.8)),
)


def plant_and_state(model):
    scenario = lc.build_scenario("mamba", GAIT, 1.0, model=model)
    scenario = replace(scenario, model=replace(scenario.model, places=PLACES))
    plant = lc.build_plant(scenario)
    return plant, plant.init(lc.Start(), lc.Command(gait=GAIT))


def test_places_are_drawn_alike_in_the_plane_and_in_space():
    pytest.importorskip("mujoco")
    planar = _solids_around(*plant_and_state("planar"))
    spatial = _solids_around(*plant_and_state("spatial"))
    assert [solid.kind for solid in planar] == ["box"] * 3 + ["sphere", "cylinder"]
    for solid, expected in zip(spatial, planar, strict=True):
        assert solid.kind == expected.kind
        for name in ("center", "size", "axes"):
            np.testing.assert_allclose(getattr(solid, name), getattr(expected, name), atol=1e-9)


def test_places_are_drawn_once_and_removed_with_the_scenario():
    plant, state = plant_and_state("planar")
    drawn = {}

    def add(name, **look):
        drawn[name] = look
        return SimpleNamespace(remove=lambda: drawn.pop(name))

    scene = SimpleNamespace(
        _scene=SimpleNamespace(add_box=add, add_cylinder=add, add_icosphere=add),
        _surroundings=[],
        _shown_surroundings=None,
    )
    scene._add_solid = lambda *arguments: Scene._add_solid(scene, *arguments)
    Scene.draw_surroundings(scene, plant, state)
    assert len(drawn) == 5
    handles = scene._surroundings
    Scene.draw_surroundings(scene, plant, state)
    assert scene._surroundings is handles
    Scene.draw_surroundings(scene, SimpleNamespace(settings=lc.Planar()), None)
    assert not drawn
