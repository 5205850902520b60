"""What stable-baselines3 sees of the lanes. CI does not have it: it brings torch along."""

import importlib
import sys

import numpy as np
import pytest
from rendering import skip_without_rendering

from laticauda_gym import SwimmingVectorEnv
from laticauda_gym.packages import NotInstalled


def test_who_lacks_it_is_told_what_to_install(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.delitem(sys.modules, "laticauda_gym.baselines", raising=False)
    monkeypatch.setitem(sys.modules, "stable_baselines3", None)
    with pytest.raises(
        NotInstalled, match="needs stable-baselines3; run `pip install stable-baselines3`"
    ):
        importlib.import_module("laticauda_gym.baselines")


def lanes(n: int = 3, **settings):
    baselines = importlib.import_module("laticauda_gym.baselines")
    return baselines.StableBaselines(
        SwimmingVectorEnv(n, autoreset_mode="SameStep", duration=1.0, **settings)
    )


@pytest.fixture(autouse=True)
def library(request: pytest.FixtureRequest):
    if "told" not in request.node.name:
        pytest.importorskip("stable_baselines3")


def test_the_end_of_an_episode_is_in_its_infos():
    envs, plain = lanes(), SwimmingVectorEnv(3, autoreset_mode="SameStep", duration=1.0)
    envs.seed(4)
    np.testing.assert_array_equal(envs.reset(), plain.reset(seed=4)[0])
    for step in range(7):
        action = np.full((3, 1), 0.1 * step)
        observation, reward, done, infos = envs.step(action)
        expected = plain.step(action)
        np.testing.assert_array_equal(observation, expected[0])
        np.testing.assert_array_equal(reward, expected[1])
        assert done.tolist() == [step == 4] * 3
        if step == 4:
            np.testing.assert_array_equal(
                infos[1]["terminal_observation"], expected[-1]["final_obs"][1]
            )
            assert infos[1]["TimeLimit.truncated"] is True
        else:
            assert infos == [{}, {}, {}]
    envs.close()


def test_ppo_learns_in_it_and_the_same_seed_learns_the_same():
    from stable_baselines3 import PPO

    learned = []
    for _ in range(2):
        model = PPO(
            "MlpPolicy", lanes(8), n_steps=16, batch_size=32, n_epochs=1, seed=3, device="cpu"
        ).learn(256)
        learned.append(model.predict(np.ones((1, 9)), deterministic=True)[0])
    np.testing.assert_array_equal(*learned)


def test_its_own_door_makes_environments_and_records_them():
    from stable_baselines3.common.env_util import make_vec_env

    skip_without_rendering()
    envs = make_vec_env("laticauda/Efficiency-v0", 2)
    envs.reset()
    assert envs.render_mode == "rgb_array"
    assert envs.render().shape == (720, 640, 3)


def test_another_way_from_episode_to_episode_is_refused():
    from laticauda_gym import StableBaselines

    where = r"as in `SwimmingVectorEnv\(64, autoreset_mode=\"SameStep\"\)`"
    with pytest.raises(
        ValueError, match=rf"`envs\.autoreset_mode` must be `SameStep`, {where}, got 'NextStep'"
    ):
        StableBaselines(SwimmingVectorEnv(2))
    with pytest.raises(ValueError, match="`envs` must be of class SwimmingVectorEnv, got int"):
        StableBaselines(3)


def test_lanes_share_their_attributes():
    envs = lanes()
    assert envs.get_attr("render_mode", [0, 2]) == [None, None]
    assert envs.env_is_wrapped(object) == [False] * 3
    with pytest.raises(ValueError, match="`task` must be set when the environment is made"):
        envs.set_attr("task", 1)
    with pytest.raises(ValueError, match="`reset` must be called on `envs`"):
        envs.env_method("reset")
