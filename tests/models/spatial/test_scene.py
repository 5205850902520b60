"""Scenes: what is around the robot, the contacts with it, and what in it is refused."""

from dataclasses import replace
from math import radians

import numpy as np
import pytest

import laticauda as lc
from laticauda.control import OffsetSteps
from laticauda.models.simulate import build_plant, run
from laticauda.models.spatial.scene import HeightField, Mjcf, Pegs, Slope, Tank
from laticauda.robot import Scene
from laticauda.scenarios.interfaces import Command, OpenLoop, Resumed, Start

ROBOT = lc.load_robot("mamba")
WATER = lc.load_water("paper-lateral")
GAIT = lc.lateral_undulation(
    amplitude=radians(30.0), frequency=radians(90.0), phase_shift=radians(40.0)
)
STILL = replace(GAIT, amplitude=0.0)


def swim(scene, duration=4.0, gait=GAIT, **settings):
    return lc.swim(
        ROBOT,
        gait,
        duration,
        **{"environment": WATER, "model": "spatial", "scene": scene, **settings},
    )


def wall(spec):
    """Right ahead of the robot's head."""
    spec.worldbody.add_geom(name="wall", type=6, size=(0.1, 2.0, 1.0), pos=(0.96, 0.0, -0.5))


@pytest.mark.parametrize("joints", ["prescribed", "servo"])
def test_a_wall_takes_the_momentum_of_a_robot_that_swims_against_it(joints):
    body = build_plant(ROBOT, WATER, model="spatial", scene=wall, joints=joints)
    trial = run(
        body,
        OpenLoop(command=Command(gait=STILL)),
        2.0,
        start=Start(velocity=0.5),
        sample_interval=0.002,
    )
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
    pytest.importorskip("mcap")
    for name in ("run.nc", "run.mcap"):
        trial.save(tmp_path / name)
        again = lc.load_trial(tmp_path / name)
        np.testing.assert_array_equal(again.link_force["contact"], trial.link_force["contact"])
        assert again.scenario == trial.scenario


@pytest.mark.parametrize(
    "scene",
    [Pegs(spacing=0.5), Slope(angle=0.1), Tank(), HeightField(heights=((0.0, 1.0), (0.5, 0.0)))],
)
def test_a_scene_is_a_value_that_files_keep(scene, tmp_path):
    scenario = lc.build_scenario(ROBOT, GAIT, 1.0, model="spatial", scene=scene)
    lc.save_scenario(scenario, tmp_path / "one.toml")
    assert lc.load_scenario(tmp_path / "one.toml") == scenario
    assert scenario.settings["scene"] in Scene.names()


def test_what_cannot_be_is_refused_by_name(tmp_path):
    def inside(spec):
        spec.worldbody.add_geom(name="rock", type=2, size=(0.2, 0.0, 0.0), pos=(0.3, 0.0, -0.5))

    def clash(spec):
        spec.worldbody.add_body(name="module_3")

    def flat(spec):
        spec.add_mesh(
            name="sheet", uservert=[0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0], userface=[0, 1, 2, 1, 3, 2]
        )
        spec.worldbody.add_geom(name="sheet", type=7, meshname="sheet")

    with pytest.raises(
        ValueError,
        match=r"`start` must not put the robot into `rock` of the scene, but module_\d is \d+ mm deep",
    ):
        swim(inside)
    with pytest.raises(
        ValueError, match="with the robot; MuJoCo says: repeated name 'module_3' in body"
    ):
        swim(clash)
    with pytest.raises(
        ValueError,
        match="with the robot; MuJoCo says: mesh 'sheet' has coplanar",
    ):
        swim(flat)
    with pytest.raises(
        ValueError, match="`scene` must not be `tank` without water, got the ground `coulomb`"
    ):
        swim("tank", environment=lc.load_ground("coulomb"), root="free")
    with pytest.raises(ValueError, match="`scene` must be one of `pegs`"):
        swim("peggs")
    with pytest.raises(
        ValueError, match="`scene` must compile in MuJoCo together with the robot; MuJoCo says: "
    ):
        swim(str(tmp_path / "none.xml"))


@pytest.mark.parametrize(
    "contents",
    [
        "<body name='leaf'><joint name='root' type='slide' {x}/><geom name='floor' {box}/></body>",
        "<body name='module_1'><joint name='joint_1' type='slide' {x}/><geom {box}/></body>",
        "<body name='leaf'><joint name='hinge' type='slide' {x}/><geom name='wall' {box}/></body>",
    ],
)
def test_a_scene_whose_names_are_the_robot_s_is_the_same_as_with_other_names(
    tmp_path, contents, capfd
):
    ways = []
    for text in (contents, contents.replace("root", "other").replace("_1", "_a")):
        file = tmp_path / f"{len(ways)}.xml"
        text = text.replace("<body ", "<body pos='.865 0 -.5' ")
        text = text.format(
            x="axis='1 0 0' damping='50'", box="size='.05 .3 .4' type='box' mass='1'"
        )
        file.write_text(f"<mujoco><worldbody>{text}</worldbody></mujoco>")
        trial = run(
            build_plant(ROBOT, WATER, model="spatial", scene=Mjcf(file=str(file)), root="free"),
            OpenLoop(command=Command(gait=STILL)),
            0.5,
            start=Start(velocity=0.5),
        )
        assert np.max(np.abs(trial.link_force["contact"])) > 0.0
        ways.append(trial.center_of_mass)
    np.testing.assert_array_equal(*ways)
    assert "WARNING" not in "".join(capfd.readouterr())


# ---- nets ----------------------------------------------------------------------------------------

NET = """<mujoco><worldbody><flexcomp name="net" type="grid" count="5 5 1" spacing=".1 .1 .1" radius=".005"
 pos="{x} 0 -.5" euler="0 90 0" dim="2" mass=".2">{pin}<edge equality="true"/></flexcomp>
</worldbody></mujoco>"""


def test_a_robot_that_swims_into_a_net_is_slowed_by_forces_that_the_trial_has(tmp_path):
    file = tmp_path / "net.xml"
    file.write_text(NET.format(x=".86", pin='<pin id="0 1 2 3 4 20 21 22 23 24"/>'))
    body = build_plant(ROBOT, WATER, model="spatial", scene=str(file), joints="servo")
    trial = run(
        body,
        OpenLoop(command=Command(gait=STILL)),
        0.4,
        start=Start(velocity=0.5),
        sample_interval=0.002,
    )
    force = trial.link_force["contact"]
    assert np.all(force[:, :-1] == 0.0)
    assert np.min(force[:, -1, 0]) < -0.2
    # The solver's force along the root's slides is the sum of all contacts, here still those of the last sample.
    last = body._twin._data.qfrc_constraint
    assert last[0] != 0.0
    np.testing.assert_allclose(force[-1].sum(axis=0)[:2], last[:2], rtol=1e-9, atol=1e-15)


def test_a_start_in_a_net_is_refused_by_the_net_s_name(tmp_path):
    file = tmp_path / "net.xml"
    file.write_text(NET.format(x=".3", pin=""))
    with pytest.raises(ValueError, match=r"must not put the robot into `net` of the scene, but"):
        swim(str(file))


def test_a_net_that_is_elsewhere_blames_nobody(tmp_path):
    file = tmp_path / "net.xml"
    text = NET.format(x="3", pin="").replace(
        "</worldbody>",
        '<body pos="3 .05 -.5"><freejoint/><geom size=".03" mass=".1"/></body></worldbody>',
    )
    file.write_text(text)
    trial = swim(str(file), 0.1)
    assert np.all(trial.link_force["contact"] == 0.0)


# ---- locomotion by obstacles, terrain ------------------------------------------------------------

SNAKE = lc.load_robot("mamba-modules")
SLOW = replace(GAIT, frequency=radians(60.0))
BARE = lc.Ground(friction=lc.CoulombFriction(regularization_speed=1e-2), tangential=0.1, normal=0.1)


def test_the_ground_of_a_file_is_ground_whatever_prefix_its_names_get(tmp_path):
    file = tmp_path / "scene.xml"
    file.write_text(
        """<mujoco><worldbody><geom name="floor" type="plane" size="9 9 1"/>
        <body name="module_1" pos="3 0 1"><geom size=".1"/></body></worldbody></mujoco>"""
    )
    body = build_plant(ROBOT, BARE, model="spatial", scene=Mjcf(file=str(file)), root="free")
    assert body.model.geom("scene_floor").contype[0] == 0
    assert body.model.geom("scene_floor").conaffinity[0] == 0


def same_in_all_directions():
    section = SNAKE.modules[0].section
    a, b = section.half_height, section.half_width
    share = 4.0 * a / (np.pi * (a + b))  # c_t = c_n
    plain = {
        "added_mass": 0.0,
        "added_inertia": 0.0,
        "normal_drag": 1.0,
        "tangential_friction": share,
    }
    return replace(WATER, density=SNAKE.mass / SNAKE.volume, **plain)


@pytest.mark.parametrize("environment", [BARE, same_in_all_directions()], ids=["land", "water"])
def test_without_anisotropic_friction_it_moves_by_its_pegs_alone(environment):
    ways = []
    for scene in (None, "pegs"):
        trial = lc.swim(
            SNAKE, SLOW, 8.0, environment=environment, model="spatial", scene=scene, throw=True
        )
        ways.append(trial.center_of_mass[-1, 0] - trial.center_of_mass[0, 0])
    push = trial.link_force["contact"][:, :, 0].sum(axis=1)
    assert ways[0] < 0.1
    assert ways[1] > 0.6
    assert np.mean(push) > 0.0  # against the drag


def test_terrain_of_the_elements_is_the_ground_that_mujoco_has():
    mujoco = pytest.importorskip("mujoco")
    for scene in (HeightField(), Slope(angle=0.2), Slope(angle=-0.3, bottom=-0.4)):
        spec = mujoco.MjSpec()
        scene(spec)
        model = spec.compile()
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        for x, y in np.random.default_rng(3).uniform((-2.0, -2.0), (5.0, 2.0), (40, 2)):
            hit = mujoco.mj_ray(
                model,
                data,
                np.array([x, y, 3.0]),
                np.array([0.0, 0.0, -1.0]),
                None,
                1,
                -1,
                np.zeros(1, "i4"),
            )
            assert 3.0 - hit == pytest.approx(scene.terrain.at(x, y)[0], abs=2e-3)


def test_the_tangents_of_a_terrain_are_its_derivatives():
    terrain, step = HeightField(amplitude=0.1).terrain, 1e-6
    for x, y in np.random.default_rng(4).uniform(-1.0, 1.0, (20, 2)):
        _, fall_x, fall_y = terrain.at(x, y)
        assert fall_x == pytest.approx(
            (terrain.at(x - step, y)[0] - terrain.at(x + step, y)[0]) / (2 * step), abs=1e-3
        )
        assert fall_y == pytest.approx(
            (terrain.at(x, y - step)[0] - terrain.at(x, y + step)[0]) / (2 * step), abs=1e-3
        )


def test_a_snake_crawls_over_uneven_ground_and_follows_it():
    skin = replace(BARE, normal=0.5)
    trial = lc.swim(
        SNAKE, SLOW, 5.0, environment=skin, model="spatial", scene=HeightField(), throw=True
    )
    assert trial.center_of_mass[-1, 0] - trial.center_of_mass[0, 0] > 0.2
    assert 0.03 < np.mean(trial.center_of_mass[:, 2]) < 0.09
    assert np.ptp(trial.center_of_mass[:, 2]) > 0.01


def test_a_ray_measures_the_way_to_a_wall():
    body = build_plant(
        ROBOT, WATER, model="spatial", scene=wall, rays=(0.0, np.pi / 3.0, np.pi / 2.0)
    )
    ranges = body.observe(body.init(Start(center_of_mass=(-1.0, 0.0)), Command(gait=GAIT))).ranges
    ahead = 0.86 - (-1.0 + 0.5 * ROBOT.length)
    np.testing.assert_allclose(ranges, (ahead, ahead / np.cos(np.pi / 3.0), np.inf), rtol=1e-6)


# ---- several robots ------------------------------------------------------------------------------


def one(y, robot="mamba", **changes):
    given = {
        "model": "spatial",
        "scene": "open",
        "start": Start(center_of_mass=(0.0, y)),
        **changes,
    }
    gait = replace(GAIT, frequency=GAIT.frequency * (0.78 if y else 1.0))
    return lc.build_scenario(robot, gait, given.pop("duration", 2.0), **given)


@pytest.mark.parametrize("joints", ["prescribed", "servo"])
def test_robots_that_are_far_apart_swim_as_alone(joints):
    scenarios = [
        one(0.0, joints=joints, root="free"),
        one(10.0, "mamba-modules-fin", joints=joints),
    ]
    for together, scenario in zip(lc.swim_together(scenarios), scenarios, strict=True):
        alone = lc.swim(scenario)
        for name in ("center_of_mass", "link_angle", "joint_torque", "work"):
            np.testing.assert_allclose(getattr(together, name), getattr(alone, name), atol=1e-9)
        assert together.scenario == scenario


def test_robots_side_by_side_push_each_other_with_equal_forces():
    trials = lc.swim_together(
        [one(0.0, joints="servo", duration=4.0), one(0.25, joints="servo", duration=4.0)]
    )
    first, second = (trial.link_force["contact"].sum(axis=1) for trial in trials)
    assert np.max(np.abs(first)) > 1.0
    np.testing.assert_allclose(first, -second, atol=1e-9)


def test_every_robot_of_a_scene_has_its_own_controller():
    following = lc.PathFollowing(
        gait=GAIT,
        path=lc.StraightLine(point=(0.0, 3.0)),
        guidance=lc.LineOfSight(look_ahead_distance=0.5),
        heading=lc.HeadingController(gain=0.4, max_offset=0.2),
    )
    steered = lc.build_scenario(
        "mamba",
        following,
        2.0,
        model="spatial",
        scene="open",
        start=Start(center_of_mass=(0.0, 4.0)),
    )
    free, led = lc.swim_together([one(0.0), steered])
    assert "cross_track_error" in led.signals and "cross_track_error" not in free.signals
    np.testing.assert_allclose(led.center_of_mass, lc.swim(steered).center_of_mass, atol=1e-9)


def test_a_delay_is_of_the_robot_whose_commands_are_late():
    led = OffsetSteps(gait=GAIT, offsets=(0.3, -0.3), interval=0.5)
    far = {"model": "spatial", "scene": "open", "start": Start(center_of_mass=(0.0, 4.0))}
    late, other = (
        lc.build_scenario("mamba", led, 1.0, loop_delay=0.12, **far),
        one(0.0, duration=1.0),
    )
    for together, scenario in zip(lc.swim_together([other, late]), (other, late), strict=True):
        np.testing.assert_allclose(
            together.center_of_mass, lc.swim(scenario).center_of_mass, atol=1e-9
        )
        np.testing.assert_allclose(together.link_angle, lc.swim(scenario).link_angle, atol=1e-9)
    at_once = lc.swim_together([other, replace(late, model=replace(late.model, loop_delay=0.0))])[1]
    assert np.max(np.abs(at_once.link_angle - together.link_angle)) > 0.01


def test_robots_of_a_scene_go_on_from_where_they_touched():
    scenarios = [one(y, joints="servo") for y in (0.0, 0.25)]
    whole = lc.swim_together([replace(scenario, duration=4.0) for scenario in scenarios])
    ends = [Resumed(state=trial.state) for trial in lc.swim_together(scenarios)]
    rest = lc.swim_together(
        [replace(one, start=end) for one, end in zip(scenarios, ends, strict=True)]
    )
    for trial, half in zip(whole, rest, strict=True):
        np.testing.assert_array_equal(half.center_of_mass, trial.center_of_mass[-len(half.time) :])


def test_robots_that_cannot_be_in_one_scene_are_refused_by_name():
    with pytest.raises(
        ValueError, match="`start` must not put the robot into `robot_1_module_0_hull`"
    ):
        lc.swim_together([one(0.0), one(0.02)])
    with pytest.raises(ValueError, match="`root` must be the same for all robots in one scene"):
        lc.swim_together([one(0.0), one(3.0, "mamba-modules")])
    with pytest.raises(ValueError, match="`scene` must be the same for all robots in one scene"):
        lc.swim_together([one(0.0), one(3.0, scene="pegs")])
    with pytest.raises(
        ValueError, match=r"`scenarios\[0\].model` must have a `scene`, such as `open`"
    ):
        lc.swim_together([one(0.0, scene=None), one(3.0)])
