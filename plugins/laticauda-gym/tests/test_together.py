"""Several robots in one scene, as PettingZoo sees them."""

import importlib
import math
import sys
import warnings
from dataclasses import replace

import numpy as np
import pytest
from gymnasium.error import ResetNeeded

import laticauda as lc
from laticauda.models.spatial.school import JointAdvance
from laticauda_gym import Abreast, Step, SwimmingVectorEnv, swimmer
from laticauda_gym.packages import NotInstalled

SHORT = {"duration": 0.8, "robot": "mamba"}  # four steps
STRAIGHT = {"max_lead": 0.0, "max_heading": 0.0, "max_cross_track_error": 0.0}


@pytest.fixture(autouse=True)
def libraries(request: pytest.FixtureRequest):
    pytest.importorskip("mujoco")
    if "told" not in request.node.name:
        pytest.importorskip("pettingzoo")


def school(n: int = 2, **settings):
    from laticauda_gym import SwimmingParallelEnv

    return SwimmingParallelEnv(n, **SHORT | settings)


def both(env, first, second):
    return env.step({"robot_0": np.array(first), "robot_1": np.array(second)})


def test_who_lacks_it_is_told_what_to_install(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.delitem(sys.modules, "laticauda_gym.together", raising=False)
    monkeypatch.setitem(sys.modules, "pettingzoo", None)
    with pytest.raises(
        NotInstalled,
        match="Learning with PettingZoo needs pettingzoo; run `pip install pettingzoo`",
    ):
        importlib.import_module("laticauda_gym.together")


def test_pettingzoo_has_no_complaint():
    from pettingzoo.test import parallel_api_test, parallel_seed_test

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings(
            "ignore", "`options` has 'options', which no episode draws"
        )  # its own
        parallel_api_test(school(3), num_cycles=10)
        parallel_seed_test(school, num_cycles=6)


def test_each_sees_the_nearest_other_one_and_who_is_ahead():
    env = school(3, **STRAIGHT, spacing=0.8)
    seen, infos = env.reset(options={"x": np.array([0.3, 0.0, 0.0]), "current_speed": 0.0})
    assert [infos[agent]["y"] for agent in env.agents] == pytest.approx([-0.8, 0.0, 0.8])
    names = [sight.name for sight in env.task.sights]

    def of(agent: str, *which: str) -> list[float]:
        return [seen[agent][names.index(name)] for name in which]

    assert of("robot_0", "lead", "nearest_along", "nearest_across") == pytest.approx(
        [0.2, -0.3, 0.8]
    )
    assert of("robot_1", "lead", "nearest_along", "nearest_across") == pytest.approx(
        [-0.1, 0.0, 0.8]
    )
    assert of("robot_2", "lead", "nearest_along", "nearest_across") == pytest.approx(
        [-0.1, 0.0, -0.8]
    )
    assert of("robot_2", "cross_track_error", "touches") == pytest.approx([0.0, 0.0])


def test_robots_that_keep_apart_swim_as_each_would_alone():
    env = school(2, **STRAIGHT, spacing=2.0)
    env.reset(options={"current_speed": 0.05, "current_direction": 0.5})
    alone = SwimmingVectorEnv(2, task=env.task)
    alone.reset(
        options={
            "x": 0.0,
            "y": 0.0,
            "heading": 0.0,
            "current_speed": 0.05,
            "current_direction": 0.5,
        }
    )
    for _ in range(4):
        both(env, [0.5, 1.0], [-0.5, 0.2])
        alone.step(np.array([[0.5, 1.0], [-0.5, 0.2]]))
    for name in ("x", "y", "heading", "work"):
        together, apart = (getattr(one.episodes.motion, name) for one in (env, alone))
        np.testing.assert_array_equal(together, apart)


def test_robots_that_meet_feel_it_and_pay_for_it():
    env = school(2, **STRAIGHT, spacing=0.4, duration=4.0)
    env.reset(options={"current_speed": 0.0})
    rewards = [both(env, [0.6, 1.0], [-0.6, 1.0])[1] for _ in range(8)]
    touched = [one.contact_force for one in env.episodes.motion.observations]
    np.testing.assert_allclose(
        touched[0].sum(axis=0)[:2], -touched[1].sum(axis=0)[:2], atol=1e-9
    )  # as Newton has it
    assert np.linalg.norm(touched[0]) > 1.0
    assert rewards[-1]["robot_0"] < rewards[0]["robot_0"] - 0.2 * env.task.touch_cost * 0.5


def test_an_episode_ends_for_all_at_once():
    env = school()
    env.reset(seed=2)
    for step in range(4):
        _, _, terminated, truncated, _ = both(env, [0.0, 0.0], [0.0, 0.0])
        assert set(truncated.values()) == {step == 3}
        assert set(terminated.values()) == {False}
    assert env.agents == []
    with pytest.raises(ResetNeeded):
        env.step({})


def test_one_that_diverges_ends_it_for_all(monkeypatch: pytest.MonkeyPatch):
    env = school()
    env.reset(seed=2)
    # Nothing that can be asked for does it; this is what a march says then.
    monkeypatch.setattr(
        env.episodes.school._together,
        "march",
        lambda states, *_: JointAdvance(list(states), [], "It diverged."),
    )
    seen, rewards, terminated, _, _ = both(env, [0.0, 0.0], [0.0, 0.0])
    assert terminated == {"robot_0": True, "robot_1": True}
    assert rewards == {"robot_0": -1000.0, "robot_1": -1000.0}
    assert all(env.observation_space(agent).contains(seen[agent]) for agent in seen)
    assert env.agents == []


def test_the_current_is_that_of_all_and_places_are_each_ones_own():
    env = school(3, max_lead=0.2)
    env.reset(seed=5)
    drawn = env.episodes.drawn
    assert len(set(drawn["current_speed"])) == len(set(drawn["current_direction"])) == 1
    assert drawn["current_speed"][0] > 0.0
    assert len(set(drawn["x"])) == 3


def test_what_does_not_fit_is_refused():
    with pytest.raises(ValueError, match="`n_robots` must be a whole number >= 2, got 1"):
        school(1)
    with pytest.raises(
        ValueError, match=r"`scenario\.model` must be a `Spatial` with a `scene`, e.g. `open`"
    ):
        school(model="spatial")
    with pytest.raises(ValueError, match="`spacng` is not known; did you mean `spacing`"):
        school(spacng=1.0)
    with pytest.raises(ValueError, match="`task` must be None if its fields are given"):
        school(task=Abreast())
    with pytest.raises(ValueError, match="`start` must not put"):
        school(**STRAIGHT, spacing=0.01).reset()
    env = school()
    with pytest.raises(ResetNeeded, match="`reset` must be called before the first `step`"):
        both(env, [0.0, 0.0], [0.0, 0.0])
    env.reset()
    with pytest.raises(
        ValueError,
        match=r"`actions` must have an action for each agent, got none for \['robot_1'\]",
    ):
        env.step({"robot_0": np.zeros(2)})
    with pytest.raises(
        ValueError, match=r"`action` must be finite numbers of shape \(2,\), got shape \(1,\)"
    ):
        both(env, [0.0], [0.0, 0.0])
    with pytest.warns(UserWarning, match="`options` has 'z', which no episode draws"):
        env.reset(options={"z": 1.0})


def test_the_reward_is_progress_less_what_it_costs():
    task = Abreast(
        scenario=swimmer("mamba", model=lc.Spatial(scene="open"), duration=1.0), power_unit=50.0
    )
    motion = SwimmingVectorEnv(2, task=task)
    motion.reset(options={"x": 0.0, "y": 0.0, "heading": 0.0, "current_speed": 0.0})
    before = motion.episodes.motion
    after = replace(
        before, x=np.array([0.1, 0.3]), y=np.array([-0.4, 0.5]), work=np.array([10.0, 0.0])
    )
    got = task.reward(Step(drawn={}, before=before, after=after, interval=0.2))
    lead = math.log1p((0.1 / 0.2) ** 2)
    assert got[0] == pytest.approx(1.0 - 0.2 * (lead + 50.0 / 50.0))
    assert got[1] == pytest.approx(3.0 - 0.2 * (lead + math.log1p((0.1 / 0.1) ** 2)))
