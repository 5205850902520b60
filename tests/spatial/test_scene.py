"""Scenes: what is around the robot, the contacts with it, and what in it is refused."""

from dataclasses import replace
from math import radians

import numpy as np
import pytest

import laticauda as lc
from laticauda.interfaces import Command, OpenLoop, Start
from laticauda.robot import Scene
from laticauda.simulate import plant, run
from laticauda.spatial.scene import HeightField, Mjcf, Pegs, Slope, Tank

ROBOT = lc.load_robot("mamba")
WATER = lc.load_water("paper-lateral")
GAIT = lc.lateral_undulation(amplitude=radians(30.0), frequency=radians(90.0), phase_shift=radians(40.0))
STILL = replace(GAIT, amplitude=0.0)


def swim(scene, duration=4.0, gait=GAIT, **settings):
    return lc.swim(ROBOT, gait, duration, **{"environment": WATER, "model": "spatial", "scene": scene, **settings})


def wall(spec):
    """Right ahead of the robot's head."""
    spec.worldbody.add_geom(name="wall", type=6, size=(0.1, 2.0, 1.0), pos=(0.96, 0.0, -0.5))


@pytest.mark.parametrize("joints", ["prescribed", "servo"])
def test_a_wall_takes_the_momentum_of_a_robot_that_swims_against_it(joints):
    body = plant(ROBOT, WATER, model="spatial", scene=wall, joints=joints)
    trial = run(body, OpenLoop(command=Command(gait=STILL)), 2.0, start=Start(velocity=0.5), sample_interval=0.002)
    force = trial.link_force["contact"]
    assert np.all(force[:, :-1] == 0.0)  # the head alone is there
    assert np.min(force[:, -1, 0]) < -1.0
    assert np.max(np.abs(force[:, -1, 1:])) < 1e-6 + 0.6 * np.max(np.abs(force[:, -1, 0]))
    before, after = trial.center_of_mass_velocity[:, 0], trial.center_of_mass_velocity[-1, 0]
    assert before[0] == pytest.approx(0.5)
    assert after < 0.05
    # What the wall gives is the change of momentum less the drag's: never more than all of it.
    impulse = -np.trapezoid(force[:, -1, 0], trial.time)
    assert 0.0 < impulse < 1.5 * ROBOT.mass * 0.5
    assert trial.center_of_mass[-1, 0] < 0.25


def test_far_from_all_obstacles_it_swims_as_in_open_water():
    def far(spec):
        spec.worldbody.add_geom(name="far", type=6, size=(0.1, 0.1, 0.1), pos=(50.0, 0.0, 0.0))

    alone, beside = swim(None, dt=0.002), swim(far)
    np.testing.assert_allclose(beside.center_of_mass, alone.center_of_mass, atol=1e-12)
    np.testing.assert_array_equal(beside.link_force["contact"], 0.0)
    assert alone.link_force is None


def test_contact_forces_are_saved_and_loaded(tmp_path):
    trial = swim("pegs", 6.0, joints="servo", link_forces=True)
    assert set(trial.link_force) == {"drag", "added_mass", "effector", "contact"}
    assert np.max(np.abs(trial.link_force["contact"])) > 1.0
    for name in ("run.nc", "run.mcap"):
        trial.save(tmp_path / name)
        again = lc.load_trial(tmp_path / name)
        np.testing.assert_array_equal(again.link_force["contact"], trial.link_force["contact"])
        assert again.scenario == trial.scenario


@pytest.mark.parametrize(
    "scene", [Pegs(spacing=0.5), Slope(angle=0.1), Tank(), HeightField(heights=((0.0, 1.0), (0.5, 0.0)))]
)
def test_a_scene_is_a_value_that_files_keep(scene, tmp_path):
    scenario = lc.scenario(ROBOT, GAIT, 1.0, model="spatial", scene=scene)
    lc.save_scenario(scenario, tmp_path / "one.toml")
    assert lc.load_scenario(tmp_path / "one.toml") == scenario
    assert scenario.settings["scene"] in Scene.names()


def test_older_files_with_a_tank_or_a_shore_have_them_still():
    text = lc.scenarios.run_to_toml(lc.scenario(ROBOT, GAIT, 1.0, model="spatial"))
    tank = lc.scenarios.run_from_toml(text.replace("[model]", "[model]\ntank = true"))
    assert tank.model.scene == Tank()
    assert lc.scenarios.run_from_toml(text.replace("[model]", "[model]\ntank = false")).model.scene is None


def test_what_cannot_be_is_refused_by_name(tmp_path):
    def inside(spec):
        spec.worldbody.add_geom(name="rock", type=2, size=(0.2, 0.0, 0.0), pos=(0.3, 0.0, -0.5))

    def clash(spec):
        spec.worldbody.add_body(name="module_3")

    def flat(spec):
        spec.add_mesh(name="sheet", uservert=[0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0], userface=[0, 1, 2, 1, 3, 2])
        spec.worldbody.add_geom(name="sheet", type=7, meshname="sheet")

    with pytest.raises(
        ValueError, match=r"`start` must not put the robot into `rock` of the scene, but module_\d is \d+ mm deep"
    ):
        swim(inside)
    with pytest.raises(ValueError, match="beside the robot; it says: repeated name 'module_3' in body"):
        swim(clash)
    with pytest.raises(
        ValueError,
        match="beside the robot; it says: mesh 'sheet' has coplanar",
    ):
        swim(flat)
    with pytest.raises(ValueError, match="`scene` must not be `tank` without water, got the ground `coulomb`"):
        swim("tank", environment=lc.load_ground("coulomb"), root="free")
    with pytest.raises(ValueError, match="`scene` must be one of `pegs`"):
        swim("peggs")
    with pytest.raises(ValueError, match="`scene` must be one that MuJoCo can compile beside the robot; it says: "):
        swim(str(tmp_path / "none.xml"))
    (tmp_path / "twice.xml").write_text("<mujoco><worldbody><body name='module_1'/></worldbody></mujoco>")
    with pytest.raises(ValueError, match=r"`scene` must .*module_1"):
        swim(Mjcf(file=str(tmp_path / "twice.xml")))
