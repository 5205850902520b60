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


def rolled(envs, count: int = 12, seed: int | None = 5) -> list[tuple]:
    """Everything that an environment says in some steps."""
    said = [envs.reset(seed=seed)]
    said += [envs.step(action) for action in actions_of(envs, count)]
    return said


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
    many = rolled(gymnasium.make_vec(IDS[0], num_envs=3, threads=2, **settings), count=8)
    singles = rolled(
        gymnasium.make_vec(IDS[0], num_envs=3, vectorization_mode="sync", **settings), count=8
    )
    planar = rolled(gymnasium.make_vec(IDS[0], num_envs=3, duration=0.6, interval=0.1), count=8)
    for one, other, flat in zip(many, singles, planar, strict=True):
        for x, y in zip(one[:-1], other[:-1], strict=True):
            np.testing.assert_array_equal(x, y)
        np.testing.assert_allclose(
            one[-1]["x"], flat[-1]["x"], atol=1e-4
        )  # the same episode by another model


def test_in_space_an_episode_in_a_flow_is_that_in_the_plane():
    pytest.importorskip("mujoco")
    settings = {"duration": 0.6, "interval": 0.1, "current": lc.load_current("street")}
    space, plane = (
        SwimmingEnv(robot="mamba", model=model, **settings) for model in ("spatial", "planar")
    )
    still = SwimmingEnv(robot="mamba", duration=0.6, interval=0.1)
    ends = [rolled(one, count=6)[-1][-1] for one in (space, plane, still)]
    moved = abs(ends[1]["x"] - ends[2]["x"]) + abs(ends[1]["y"] - ends[2]["y"])
    for name in ("x", "y"):
        assert ends[0][name] == pytest.approx(ends[1][name], abs=0.05 * moved)


@pytest.mark.parametrize("model", ["planar", "spatial"])
def test_pictures_show_the_robot_as_it_is_and_a_lane_what_a_single_one_shows(model: str):
    skip_without_rendering()
    settings = {"duration": 0.4, "model": model, "render_mode": "rgb_array"}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(IDS[1], **settings).unwrapped)
    assert gymnasium.make(IDS[1], **settings).metadata["render_fps"] == 5.0
    envs, env = (
        gymnasium.make_vec(IDS[1], num_envs=2, **settings),
        gymnasium.make(IDS[1], **settings),
    )
    envs.reset(seed=3), env.reset(seed=3)
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
    envs.close(), env.close()
    assert gymnasium.make(IDS[1], duration=1.0).unwrapped.render() is None


def test_an_episode_in_a_scene_feels_and_sees_it_and_does_not_begin_inside_of_it():
    pytest.importorskip("mujoco")
    settings = {"robot": "mamba", "model": lc.Spatial(scene="pegs", rays=(0.0,)), "duration": 0.4}
    with pytest.raises(ValueError, match="`start` must not put the robot into `peg_"):
        gymnasium.make(IDS[0], **settings).reset(options={"y": 0.2, "heading": 0.0})
    envs = SwimmingVectorEnv(2, max_cross_track_error=0.0, max_heading=0.0, **settings)
    envs.reset(seed=0)
    envs.step(np.array([[1.0], [-1.0]]))
    for one in envs.episodes.motion.observations:
        assert (one.contact_force.shape, one.ranges.shape) == ((9, 3), (1,))
    envs.close()


def test_a_task_of_ones_own_sees_what_the_planar_model_knows_nothing_of():
    @value_class
    class Dive(Efficiency):
        @property
        def sights(self):
            return (
                Sight(
                    name="height",
                    of=lambda step: np.array(
                        [o.center_of_mass[2] for o in step.after.observations]
                    ),
                ),
            )

    task = Dive(scenario=swimmer(robot="mamba", model="spatial", root="free", duration=0.4))
    seen, _ = SwimmingVectorEnv(2, task=task).reset(seed=0)
    assert seen[:, 0] == pytest.approx([-0.505, -0.505])


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
    path = {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    words = [sys.executable, "-c", code]
    done = subprocess.run(
        words, env={**os.environ, **path}, capture_output=True, text=True, check=True
    )
    assert done.stdout == "[]\n"


def test_what_gymnasium_knows_of_an_environment_can_be_stored():
    spec = gymnasium.make(IDS[0], max_offset=0.2).spec
    again = gymnasium.make(type(spec).from_json(spec.to_json()))
    assert again.unwrapped.task.max_offset == 0.2
    assert json.loads(spec.to_json())["kwargs"] == {"task": "PathFollowing", "max_offset": 0.2}


@pytest.mark.parametrize("name", IDS)
def test_the_same_seed_gives_the_same_bits(name: str):
    a, b = (rolled(gymnasium.make_vec(name, num_envs=9, **SHORT)) for _ in range(2))
    for one, other in zip(a, b, strict=True):
        for x, y in zip(one[:-1], other[:-1], strict=True):
            np.testing.assert_array_equal(x, y)
        for key in INFOS:
            np.testing.assert_array_equal(one[-1][key], other[-1][key])
    c = rolled(gymnasium.make_vec(name, num_envs=9, **SHORT), seed=6)
    assert not np.array_equal(a[0][0], c[0][0])


@pytest.mark.parametrize("name", IDS)
def test_a_lane_does_what_a_single_environment_with_its_seed_does_to_the_last_bit(name: str):
    """Also through the end of an episode, of which there are two in twelve steps."""
    many = rolled(gymnasium.make_vec(name, num_envs=10, **SHORT))
    singles = rolled(gymnasium.make_vec(name, num_envs=10, vectorization_mode="sync", **SHORT))
    for one, other in zip(many, singles, strict=True):
        for x, y in zip(one[:-1], other[:-1], strict=True):
            np.testing.assert_array_equal(x, y)
        for key in INFOS:
            np.testing.assert_array_equal(one[-1][key], other[-1][key])


def test_both_go_from_one_episode_to_the_next_in_the_same_step_if_they_are_to():
    settings = {"num_envs": 4, **SHORT}
    many = SwimmingVectorEnv(autoreset_mode="SameStep", **settings)
    wrapped = {
        "vectorization_mode": "sync",
        "vector_kwargs": {"autoreset_mode": AutoresetMode.SAME_STEP},
    }
    singles = gymnasium.make_vec(IDS[0], **wrapped, **settings)
    for one, other in zip(rolled(many), rolled(singles), strict=True):
        for x, y in zip(one[:-1], other[:-1], strict=True):
            np.testing.assert_array_equal(x, y)
        assert ("final_obs" in one[-1]) == ("final_obs" in other[-1])
        if "final_obs" in one[-1]:
            np.testing.assert_array_equal(
                np.stack(one[-1]["final_obs"]), np.stack(other[-1]["final_obs"])
            )
            for key in INFOS:
                np.testing.assert_array_equal(
                    one[-1]["final_info"][key], other[-1]["final_info"][key]
                )


def test_threads_change_no_bit():
    one, two = (rolled(SwimmingVectorEnv(33, threads=threads, **SHORT)) for threads in (1, 2))
    for x, y in zip(one, two, strict=True):
        np.testing.assert_array_equal(x[0], y[0])


def test_the_step_after_an_episode_is_its_reset():
    envs = SwimmingVectorEnv(2, **SHORT)
    said = rolled(envs, count=7)
    over = [step[3].tolist() for step in said[1:]]
    assert over == [[False, False]] * 4 + [[True, True]] + [[False, False]] * 2
    assert said[6][1].tolist() == [0.0, 0.0]
    assert said[6][-1]["power"].tolist() == [0.0, 0.0]
    assert envs.episodes.motion.time[0] == pytest.approx(0.2)


def test_without_autoreset_a_mask_says_who_begins_anew():
    envs = SwimmingVectorEnv(3, autoreset_mode="Disabled", **SHORT)
    said = rolled(envs, count=5)
    assert said[-1][3].all()
    action = actions_of(envs, 1)[0]
    with pytest.raises(
        ValueError, match=r"`reset` must be called with a `reset_mask` for the lanes .* \[0, 1, 2\]"
    ):
        envs.step(action)
    options = {"reset_mask": np.array([True, False, True])}
    observation, _ = envs.reset(options=options)
    assert "reset_mask" in options
    np.testing.assert_array_equal(observation[1], said[-1][0][1])
    assert not np.array_equal(observation[0], said[-1][0][0])
    with pytest.raises(ValueError, match=r"\[1\]"):
        envs.step(action)
    envs.reset(options={"reset_mask": np.array([False, True, False])})
    envs.step(action)


def test_a_lane_that_diverges_is_terminated_and_harms_no_other():
    envs, calm = SwimmingVectorEnv(9), SwimmingVectorEnv(9)
    envs.reset(seed=1)
    calm.reset(seed=1)
    envs.episodes.school._lanes[0, :, 3] *= 1e200  # nothing that can be asked for does it
    action = np.zeros((9, 1))
    for step in range(3):
        observation, reward, terminated, truncated, _ = envs.step(action)
        expected = calm.step(action)
        assert envs.observation_space.contains(observation)
        assert np.flatnonzero(terminated).tolist() == ([3] if step == 0 else [])
        assert not truncated.any()
        assert reward[3] == -1000.0 if step == 0 else abs(reward[3]) < 100.0
        others = np.arange(9) != 3
        np.testing.assert_array_equal(observation[others], expected[0][others])
        np.testing.assert_array_equal(reward[others], expected[1][others])


def test_actions_beyond_their_bounds_ask_for_the_bounds():
    envs = SwimmingVectorEnv(2)
    envs.reset(seed=[3, 3])
    observation = [envs.step(np.array([[1.0], [7.0]]))[0] for _ in range(3)][-1]
    np.testing.assert_array_equal(observation[0], observation[1])


def test_options_say_what_is_not_drawn():
    envs = SwimmingVectorEnv(3)
    given = {
        "y": 0.25,
        "heading": np.array([0.1, 0.2, 0.3]),
        "current_speed": 0.05,
        "current_direction": 0.0,
    }
    _, info = envs.reset(seed=1, options=given)
    assert info["y"].tolist() == [0.25] * 3
    assert info["heading"].tolist() == [0.1, 0.2, 0.3]
    drawn = envs.episodes.drawn
    assert drawn["current_speed"].tolist() == [0.05] * 3
    single = SwimmingEnv()
    assert single.reset(options={"y": -0.5})[1]["y"] == -0.5


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
    envs, one = SwimmingVectorEnv(3, **settings), SwimmingEnv(**settings)
    envs.reset(seed=5)
    one.reset(seed=7)
    for _ in range(5):
        ends, end = envs.step(np.zeros((3, 1)))[0], one.step(np.zeros(1))[0]
    np.testing.assert_array_equal(ends[2], end)
    drawn, task = envs.episodes.drawn, envs.task
    assert len(set(drawn["water.current.seed"])) == 3
    assert all((drawn["water.current.intensity"] > 0.02) & (drawn["water.current.intensity"] < 0.1))
    for lane in range(3):
        numbers = {
            name: values[lane] for name, values in drawn.items() if name.startswith("water.")
        }
        start = lc.Start(center_of_mass=(0.0, drawn["y"][lane]), heading=drawn["heading"][lane])
        trial = lc.swim(replace(change_parameters(task.scenario, numbers), start=start))
        here = envs.episodes.motion.x[lane], envs.episodes.motion.y[lane]
        assert here == pytest.approx(trial.center_of_mass[-1], abs=1e-12)


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
        own = change_parameters(
            envs.task.scenario, {"water.current.start": drawn["water.current.start"][lane]}
        )
        start = lc.Start(center_of_mass=(0.0, drawn["y"][lane]), heading=drawn["heading"][lane])
        here = envs.episodes.motion.x[lane], envs.episodes.motion.y[lane]
        assert here == pytest.approx(
            lc.swim(replace(own, start=start)).center_of_mass[-1], abs=1e-12
        )


def test_a_flow_is_drawn_by_its_seed_and_not_seen_and_can_be_said():
    still, moving = SwimmingEnv(robot="mamba", **SHORT), SwimmingEnv(**GUSTS)
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
    share = np.linspace(0.0, 1.0, 3000, endpoint=False)
    counts = np.unique(
        Range(name="seed", low=2.0, high=4.0, is_whole=True).at(share), return_counts=True
    )
    np.testing.assert_array_equal(counts, ([2.0, 3.0, 4.0], [1000] * 3))


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
