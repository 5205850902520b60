import json
import os
import subprocess
import sys
import warnings
from dataclasses import replace

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ResetNeeded
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode
from rendering import skip_without_rendering

import laticauda as lc
from laticauda.models.simulate.numbers import change_parameters
from laticauda.values.quantities import value_class
from laticauda.water.fluid.gridded import Gridded, to_dataset
from laticauda_gym import (
    IDS,
    Efficiency,
    PathFollowing,
    Sight,
    SwimmingEnv,
    SwimmingVectorEnv,
    swimmer,
)
from laticauda_gym.swimming import Range

SHORT = {"duration": 1.0}  # five steps
INFOS = ("x", "y", "heading", "power")


def actions_of(envs, count: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-1.2, 1.2, (count, *envs.action_space.shape))


def roll_out(envs, count: int = 12, seed: int | None = 5) -> list[tuple]:
    """Everything that an environment returns: from a reset, and from some steps."""
    returned = [envs.reset(seed=seed)]
    for action in actions_of(envs, count):
        returned.append(envs.step(action))
    return returned


def check_same_numbers(many: tuple, others: tuple) -> None:
    """Refuse two returns of `step` or `reset` that differ in a bit, without their infos."""
    for values, other_values in zip(many[:-1], others[:-1], strict=True):
        np.testing.assert_array_equal(values, other_values)


def check_same_infos(infos: dict, other_infos: dict) -> None:
    for key in INFOS:
        np.testing.assert_array_equal(infos[key], other_infos[key])


@pytest.mark.parametrize("name", IDS)
def test_gymnasium_has_no_complaint_about_the_single_environment(name: str):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(name, **SHORT).unwrapped)


def test_the_environments_take_the_spatial_model_and_lanes_do_what_single_ones_do():
    pytest.importorskip("mujoco")
    settings = {"duration": 0.6, "model": "spatial", "interval": 0.1}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(IDS[0], **settings).unwrapped)
    many = roll_out(gymnasium.make_vec(IDS[0], num_envs=3, threads=2, **settings), count=8)
    singles = roll_out(
        gymnasium.make_vec(IDS[0], num_envs=3, vectorization_mode="sync", **settings), count=8
    )
    planar = roll_out(gymnasium.make_vec(IDS[0], num_envs=3, duration=0.6, interval=0.1), count=8)
    for of_many, of_singles, of_planar in zip(many, singles, planar, strict=True):
        check_same_numbers(of_many, of_singles)
        # The same episode by another model.
        np.testing.assert_allclose(of_many[-1]["x"], of_planar[-1]["x"], atol=1e-4)


def test_in_space_an_episode_in_a_flow_is_that_in_the_plane():
    pytest.importorskip("mujoco")
    settings = {"duration": 0.6, "interval": 0.1, "current": lc.load_current("street")}

    def last_info(env) -> dict:
        return roll_out(env, count=6)[-1][-1]

    space = last_info(SwimmingEnv(robot="mamba", model="spatial", **settings))
    plane = last_info(SwimmingEnv(robot="mamba", model="planar", **settings))
    still = last_info(SwimmingEnv(robot="mamba", duration=0.6, interval=0.1))
    drift = abs(plane["x"] - still["x"]) + abs(plane["y"] - still["y"])
    for name in ("x", "y"):
        assert space[name] == pytest.approx(plane[name], abs=0.05 * drift)


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_pictures_show_the_robot_as_it_is_and_a_lane_what_a_single_one_shows(model: str):
    skip_without_rendering()
    settings = {"duration": 0.4, "model": model, "render_mode": "rgb_array"}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(IDS[1], **settings).unwrapped)
    assert gymnasium.make(IDS[1], **settings).metadata["render_fps"] == 5.0
    envs = gymnasium.make_vec(IDS[1], num_envs=2, **settings)
    env = gymnasium.make(IDS[1], **settings)
    envs.reset(seed=3)
    env.reset(seed=3)
    before = env.render()
    actions = np.array([[1.0, 1.0, 0.0], [1.0, -1.0, 0.0]])
    for _ in range(2):
        envs.step(actions)
        env.step(actions[0])
    first, second = envs.render()
    assert (first.shape, first.dtype) == ((360, 640, 3), np.uint8)
    np.testing.assert_array_equal(first, env.render())
    assert np.mean(first != before) > 0.005  # one bends, the other stays
    assert np.mean(first != second) > 0.005
    envs.close()
    env.close()
    assert gymnasium.make(IDS[1], duration=1.0).unwrapped.render() is None


def test_an_episode_in_a_scene_feels_and_sees_it_and_does_not_begin_inside_of_it():
    pytest.importorskip("mujoco")
    settings = {"robot": "mamba", "model": lc.Spatial(scene="pegs", rays=(0.0,)), "duration": 0.4}
    with pytest.raises(ValueError, match="`start` must not put the robot into `peg_"):
        gymnasium.make(IDS[0], **settings).reset(options={"y": 0.2, "heading": 0.0})
    envs = SwimmingVectorEnv(2, max_cross_track_error=0.0, max_heading=0.0, **settings)
    envs.reset(seed=0)
    envs.step(np.array([[1.0], [-1.0]]))
    for observation in envs.episodes.motion.observations:
        assert observation.contact_force.shape == (9, 3)
        assert observation.ranges.shape == (1,)
    envs.close()


def test_a_task_of_ones_own_sees_what_the_planar_model_knows_nothing_of():
    def height(step):
        observations = step.after.observations
        return np.array([observation.center_of_mass[2] for observation in observations])

    @value_class
    class Dive(Efficiency):
        @property
        def sights(self):
            return (Sight(name="height", of=height),)

    task = Dive(scenario=swimmer(robot="mamba", model="spatial", root="free", duration=0.4))
    observation, _ = SwimmingVectorEnv(2, task=task).reset(seed=0)
    assert observation[:, 0] == pytest.approx([-0.505, -0.505])


@pytest.mark.parametrize("name", IDS)
def test_gymnasium_makes_the_one_with_lanes_by_itself(name: str):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        envs = gymnasium.make_vec(name, num_envs=3)
    assert isinstance(envs, SwimmingVectorEnv)
    assert envs.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    observation, info = envs.reset(seed=1)
    assert envs.observation_space.contains(observation)
    observation, reward, terminated, truncated, info = envs.step(envs.action_space.sample())
    assert envs.observation_space.contains(observation)
    assert reward.shape == terminated.shape == truncated.shape == (3,)
    assert (reward.dtype, terminated.dtype, truncated.dtype) == (float, bool, bool)
    assert {f"_{key}" for key in INFOS} | set(INFOS) == set(info)
    envs.close()


def test_a_module_and_a_name_are_enough_and_registering_compiles_nothing():
    code = """
import sys, gymnasium, laticauda_gym
print([name for name in ("numba", "stable_baselines3") if name in sys.modules])
gymnasium.make("laticauda_gym:laticauda/StationKeeping-v0")
"""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    command = [sys.executable, "-c", code]
    process = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert process.stdout == "[]\n"


def test_what_gymnasium_knows_of_an_environment_can_be_stored():
    spec = gymnasium.make(IDS[0], max_offset=0.2).spec
    again = gymnasium.make(type(spec).from_json(spec.to_json()))
    assert again.unwrapped.task.max_offset == 0.2
    assert json.loads(spec.to_json())["kwargs"] == {"task": "PathFollowing", "max_offset": 0.2}


@pytest.mark.parametrize("name", IDS)
def test_the_same_seed_gives_the_same_bits(name: str):
    first = roll_out(gymnasium.make_vec(name, num_envs=9, **SHORT))
    again = roll_out(gymnasium.make_vec(name, num_envs=9, **SHORT))
    for of_first, of_again in zip(first, again, strict=True):
        check_same_numbers(of_first, of_again)
        check_same_infos(of_first[-1], of_again[-1])
    other_seed = roll_out(gymnasium.make_vec(name, num_envs=9, **SHORT), seed=6)
    assert not np.array_equal(first[0][0], other_seed[0][0])


@pytest.mark.parametrize("name", IDS)
def test_a_lane_does_what_a_single_environment_with_its_seed_does_to_the_last_bit(name: str):
    """Also through the end of an episode, of which there are two in twelve steps."""
    many = roll_out(gymnasium.make_vec(name, num_envs=10, **SHORT))
    singles = roll_out(gymnasium.make_vec(name, num_envs=10, vectorization_mode="sync", **SHORT))
    for of_many, of_singles in zip(many, singles, strict=True):
        check_same_numbers(of_many, of_singles)
        check_same_infos(of_many[-1], of_singles[-1])


def test_both_go_from_one_episode_to_the_next_in_the_same_step_if_they_are_to():
    settings = {"num_envs": 4, **SHORT}
    many = SwimmingVectorEnv(autoreset_mode="SameStep", **settings)
    singles = gymnasium.make_vec(
        IDS[0],
        vectorization_mode="sync",
        vector_kwargs={"autoreset_mode": AutoresetMode.SAME_STEP},
        **settings,
    )
    for of_many, of_singles in zip(roll_out(many), roll_out(singles), strict=True):
        check_same_numbers(of_many, of_singles)
        infos, other_infos = of_many[-1], of_singles[-1]
        assert ("final_obs" in infos) == ("final_obs" in other_infos)
        if "final_obs" in infos:
            np.testing.assert_array_equal(
                np.stack(infos["final_obs"]), np.stack(other_infos["final_obs"])
            )
            check_same_infos(infos["final_info"], other_infos["final_info"])


def test_threads_change_no_bit():
    by_one_thread = roll_out(SwimmingVectorEnv(33, threads=1, **SHORT))
    by_two_threads = roll_out(SwimmingVectorEnv(33, threads=2, **SHORT))
    for of_one, of_two in zip(by_one_thread, by_two_threads, strict=True):
        np.testing.assert_array_equal(of_one[0], of_two[0])


def test_the_step_after_an_episode_is_its_reset():
    envs = SwimmingVectorEnv(2, **SHORT)
    steps = roll_out(envs, count=7)[1:]
    is_over = [truncated.tolist() for _, _, _, truncated, _ in steps]
    assert is_over == [[False, False]] * 4 + [[True, True]] + [[False, False]] * 2
    _, reward, _, _, info = steps[5]
    assert reward.tolist() == [0.0, 0.0]
    assert info["power"].tolist() == [0.0, 0.0]
    assert envs.episodes.motion.time[0] == pytest.approx(0.2)


def test_without_autoreset_a_mask_says_who_begins_anew():
    envs = SwimmingVectorEnv(3, autoreset_mode="Disabled", **SHORT)
    last_observation, _, _, truncated, _ = roll_out(envs, count=5)[-1]
    assert truncated.all()
    action = actions_of(envs, 1)[0]
    with pytest.raises(
        ValueError, match=r"`reset` must be called with a `reset_mask` for the lanes .* \[0, 1, 2\]"
    ):
        envs.step(action)
    options = {"reset_mask": np.array([True, False, True])}
    observation, _ = envs.reset(options=options)
    assert "reset_mask" in options
    np.testing.assert_array_equal(observation[1], last_observation[1])
    assert not np.array_equal(observation[0], last_observation[0])
    with pytest.raises(ValueError, match=r"\[1\]"):
        envs.step(action)
    envs.reset(options={"reset_mask": np.array([False, True, False])})
    envs.step(action)


def test_a_lane_that_diverges_is_terminated_and_harms_no_other():
    envs = SwimmingVectorEnv(9)
    calm = SwimmingVectorEnv(9)
    envs.reset(seed=1)
    calm.reset(seed=1)
    envs.episodes.school._lanes[0, :, 3] *= 1e200  # nothing that can be asked for does it
    action = np.zeros((9, 1))
    for step in range(3):
        observation, reward, terminated, truncated, _ = envs.step(action)
        expected_observation, expected_reward, _, _, _ = calm.step(action)
        assert envs.observation_space.contains(observation)
        assert not truncated.any()
        if step == 0:
            assert np.flatnonzero(terminated).tolist() == [3]
            assert reward[3] == -1000.0
        else:
            assert not terminated.any()
            assert abs(reward[3]) < 100.0
        are_calm = np.arange(9) != 3
        np.testing.assert_array_equal(observation[are_calm], expected_observation[are_calm])
        np.testing.assert_array_equal(reward[are_calm], expected_reward[are_calm])


def test_actions_beyond_their_bounds_ask_for_the_bounds():
    envs = SwimmingVectorEnv(2)
    envs.reset(seed=[3, 3])
    for _ in range(3):
        observation, *_ = envs.step(np.array([[1.0], [7.0]]))
    np.testing.assert_array_equal(observation[0], observation[1])


def test_options_say_what_is_not_drawn():
    envs = SwimmingVectorEnv(3)
    options = {
        "y": 0.25,
        "heading": np.array([0.1, 0.2, 0.3]),
        "current_speed": 0.05,
        "current_direction": 0.0,
    }
    _, info = envs.reset(seed=1, options=options)
    assert info["y"].tolist() == [0.25] * 3
    assert info["heading"].tolist() == [0.1, 0.2, 0.3]
    drawn = envs.episodes.drawn
    assert drawn["current_speed"].tolist() == [0.05] * 3
    _, info = SwimmingEnv().reset(options={"y": -0.5})
    assert info["y"] == -0.5


BAD = [
    (
        {"task": "PathFolowing"},
        r"`task` must be one of `PathFollowing`.*did you mean `PathFollowing`\?",
    ),
    ({"max_ofset": 0.1}, r"`max_ofset` is not known; did you mean `max_offset`\?"),
    ({"max_offset": 1.5}, "`max_offset` must be <= 1.047 rad"),
    ({"interval": 0.0}, "`interval` must be > 0 s, got 0.0"),
    ({"interval": 2.0, "duration": 1.0}, "`interval` must be between 0 and 1 s, got 2.0"),
    ({"max_current": -0.1}, "`max_current` must be >= 0 m/s, got -0.1"),
    ({"failure_reward": 1.0}, "`failure_reward` must be between -1e\\+09 and 0, got 1.0"),
    ({"joints": "stiff"}, "`joints` must be one of"),
    ({"robot": "mamba-fn"}, "did you mean `mamba-fin`"),
    ({"render_mode": "human"}, "`render_mode` must be one of `rgb_array`, got 'human'"),
    ({"task": Efficiency(), "speeds": (0.1, 0.2)}, "`task` must be a name if its fields are given"),
    (
        {"task": "Efficiency", "speeds": (0.2, 0.1)},
        "`speeds` must be two numbers in m/s, the lower one first",
    ),
    ({"task": "Efficiency", "speeds": "ab"}, "`speeds` must be two numbers in m/s, got 'ab'"),
    (
        {"task": "Efficiency", "frequencies": (-1.0, 1.0)},
        r"`frequencies\[0\]` must be >= 0 rad/s, got -1.0",
    ),
    (
        {"task": "Efficiency", "amplitudes": (0.0, 2.0)},
        r"`amplitudes\[1\]` must be <= 1.571 rad, or joint 0 goes",
    ),
    (
        {"task": "StationKeeping", "distance_tolerance": 0.0},
        "`distance_tolerance` must be > 0 m, got 0.0",
    ),
]


@pytest.mark.parametrize(("settings", "message"), BAD)
def test_settings_out_of_range_are_refused_by_both(settings: dict, message: str):
    for kind in (SwimmingEnv, SwimmingVectorEnv):
        with pytest.raises(ValueError, match=message):
            kind(**settings)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"num_envs": 0}, "`num_envs` must be a whole number >= 1, got 0"),
        ({"threads": 0}, "`threads` must be a whole number >= 1, got 0"),
        (
            {"autoreset_mode": "never"},
            "`autoreset_mode` must be one of `NextStep`, `SameStep`, `Disabled`, got",
        ),
    ],
)
def test_settings_of_the_lanes_out_of_range_are_refused(settings: dict, message: str):
    with pytest.raises(ValueError, match=message):
        SwimmingVectorEnv(**settings)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            {"options": {"z": 1.0}},
            "`options` must be one of `y`, `heading`, `current_speed`",
        ),
        ({"options": {"y": np.nan}}, "`y` must be a finite number, got nan"),
        ({"options": {"y": np.array([0.0, np.inf])}}, r"`y\[1\]` must be a finite number, got inf"),
        ({"options": {"reset_mask": [True, False]}}, "`reset_mask` must be an array of 2 booleans"),
        ({"seed": [1, 2, 3]}, r"`seed` must be one number, or one per lane \(2\), got 3"),
    ],
)
def test_resets_that_do_not_fit_are_refused(arguments: dict, message: str):
    envs = SwimmingVectorEnv(2)
    with pytest.raises(ValueError, match=message):
        envs.reset(**arguments)


def test_actions_that_do_not_fit_are_refused():
    envs = SwimmingVectorEnv(2)
    envs.reset()
    with pytest.raises(
        ValueError, match=r"`action` must be finite numbers of shape \(2, 1\), got shape \(2,\)"
    ):
        envs.step(np.zeros(2))
    with pytest.raises(
        ValueError, match=r"`action` must be finite numbers of shape \(2, 1\), got one that is not"
    ):
        envs.step(np.array([[0.0], [np.nan]]))
    single = SwimmingEnv()
    single.reset()
    with pytest.raises(
        ValueError, match=r"`action` must be finite numbers of shape \(1,\), got shape \(\)"
    ):
        single.step("left")


GUSTS = {"robot": "mamba", "current": replace(lc.load_current("turbulence"), modes=6), **SHORT}


def test_each_seed_is_another_flow_in_lanes_as_in_single_environments_and_all_swim_as_swim_does():
    settings = {**GUSTS, "currents": {"intensity": (0.02, 0.1)}}
    envs = SwimmingVectorEnv(3, **settings)
    single = SwimmingEnv(**settings)
    envs.reset(seed=5)
    single.reset(seed=7)
    for _ in range(5):
        observations, *_ = envs.step(np.zeros((3, 1)))
        observation, *_ = single.step(np.zeros(1))
    np.testing.assert_array_equal(observations[2], observation)
    drawn = envs.episodes.drawn
    assert len(set(drawn["water.current.seed"])) == 3
    intensity = drawn["water.current.intensity"]
    assert all((intensity > 0.02) & (intensity < 0.1))
    names = [name for name in drawn if name.startswith("water.")]
    for lane in range(3):
        check_swims_as_swim_does(envs, lane, names)


def check_swims_as_swim_does(envs, lane, names):
    """Refuse a lane that swims elsewhere than a trial in the flow and from the start that it drew."""
    drawn = envs.episodes.drawn
    flow = {name: drawn[name][lane] for name in names}
    scenario = change_parameters(envs.task.scenario, flow)
    start = lc.Start(center_of_mass=(0.0, drawn["y"][lane]), heading=drawn["heading"][lane])
    trial = lc.swim(replace(scenario, start=start))
    position = envs.episodes.motion.x[lane], envs.episodes.motion.y[lane]
    assert position == pytest.approx(trial.center_of_mass[-1], abs=1e-12)


def test_in_a_flow_on_a_grid_whose_start_is_drawn_lanes_swim_as_swim_does():
    axis = np.linspace(-6.0, 6.0, 13)
    lake = Gridded(source=to_dataset(GUSTS["current"], time=range(20), x=axis, y=axis))
    envs = SwimmingVectorEnv(2, **GUSTS | {"current": lake}, currents={"start": (0.0, 5.0)})
    envs.reset(seed=5)
    for _ in range(5):
        envs.step(np.zeros((2, 1)))
    drawn = envs.episodes.drawn
    assert np.ptp(drawn["water.current.start"]) > 0.1
    for lane in range(2):
        check_swims_as_swim_does(envs, lane, ["water.current.start"])


def test_a_flow_is_drawn_by_its_seed_and_not_seen_and_can_be_said():
    still = SwimmingEnv(robot="mamba", **SHORT)
    moving = SwimmingEnv(**GUSTS)
    assert moving.observation_space == still.observation_space
    assert [draw.name for draw in still.task.draws] == [
        "y",
        "heading",
        "current_speed",
        "current_direction",
    ]
    assert [draw.name for draw in moving.task.draws] == ["y", "heading", "water.current.seed"]
    moving.reset(seed=1, options={"water.current.seed": 3})
    assert moving.unwrapped.episodes.drawn["water.current.seed"] == [3.0]
    seeds = Range(name="seed", low=2.0, high=4.0, is_whole=True)
    draws = seeds.at(np.linspace(0.0, 1.0, 3000, endpoint=False))
    values, counts = np.unique(draws, return_counts=True)
    assert values.tolist() == [2.0, 3.0, 4.0]
    assert counts.tolist() == [1000] * 3


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (
            {"currents": {"intensty": (0.0, 1.0)}},
            "got 'water.current.intensty'; the nearest are `water.current.inten",
        ),
        ({"currents": {"intensity": (-1.0, 1.0)}}, "`intensity` must be >= 0 m/s, got -1"),
        (
            {"currents": {"seed": (0, 1)}, "current": (0.1, 0.0)},
            "`currents` must name numbers of gait, water or robot",
        ),
    ],
)
def test_numbers_that_the_flow_has_not_are_refused(settings, message):
    with pytest.raises(ValueError, match=message):
        SwimmingEnv(**{**GUSTS, **settings})


def test_nobody_swims_before_a_reset():
    for envs in (SwimmingEnv(), SwimmingVectorEnv(2)):
        with pytest.raises(ResetNeeded, match="`reset` must be called before the first `step`"):
            envs.step(np.zeros(envs.action_space.shape))
    with pytest.raises(ResetNeeded, match="`reset` must be called"):
        SwimmingVectorEnv(2).reset(options={"reset_mask": np.array([True, False])})


def test_a_task_of_ones_own_is_taken_as_it_is():
    task = PathFollowing(scenario=swimmer("mamba", duration=2.0), interval=0.1)
    envs = SwimmingVectorEnv(2, task=task)
    assert envs.task is task
    assert task.n_steps == 20
