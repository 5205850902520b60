import json
import math
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import laticauda_swimbench as swimbench
from laticauda_swimbench import networks, scoring
from laticauda_swimbench.app import RESULTS, main
from laticauda_swimbench.methods import Method, method
from laticauda_swimbench.statistics import estimate, interquartile_mean, matrix, mean, over_runs
from laticauda_swimbench.table import table

QUICK = "economy"


@pytest.fixture(scope="module")
def short():
    """A scenario with few, short episodes, as it is scored."""
    challenge = swimbench.challenge(QUICK)
    tasks = []
    for task in challenge.tasks:
        tasks.append(replace(task, scenario=replace(task.scenario, duration=4.0)))
    return replace(challenge, seeds=challenge.seeds[:3], tasks=tuple(tasks))


@pytest.fixture(autouse=True)
def quick(short, monkeypatch):
    monkeypatch.setattr(scoring, "challenge", lambda name: short)


def score(policy) -> dict:
    return scoring.score(policy, [QUICK])


def scores_of(results) -> list[float]:
    return [result["score"] for result in results]


# ---- scenarios -----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", swimbench.CHALLENGES)
def test_a_scenario_fixes_its_episodes_and_its_scale(name):
    challenge = swimbench.challenge(name)
    assert len(challenge.seeds) == len(set(challenge.seeds)) == 20
    assert challenge.score(challenge.baseline) == 0.0
    assert challenge.score(challenge.reference) == 1.0
    assert challenge.reference > challenge.baseline
    task = challenge.tasks[0]
    middles = [0.5 * (action.low + action.high) for action in task.actions[:3]]
    gait = task.gait
    np.testing.assert_allclose(middles, [gait.amplitude, gait.frequency, gait.phase_shift])


def test_steering_a_gait_that_is_already_bent_may_not_take_a_joint_beyond_its_limit(short):
    (task, *_) = short.tasks
    bent = replace(task.scenario, motion=replace(task.gait, offset=math.radians(60.0)))
    with pytest.raises(
        ValueError, match=r"`max_offset` must be <= -0\.26\d* rad, or joint 0 goes beyond its limit"
    ):
        replace(task, scenario=bent)


def test_no_two_scenarios_share_an_episode():
    seeds = [seed for name in swimbench.CHALLENGES for seed in swimbench.challenge(name).seeds]
    assert len(seeds) == len(set(seeds))


def test_a_motor_that_is_off_takes_no_power_and_its_joint_does_not_follow():
    angles = {}
    for name, variant in (("economy", 0), ("broken", 1)):
        envs = swimbench.make(name, 2, variant=variant)
        envs.reset(seed=1, options={"y": 0.0, "heading": 0.0})
        for _ in range(10):
            envs.step(np.tile([-1.0, -1.0, 0.0, 1.0], (2, 1)))  # an offset of 20 deg
        angles[name] = envs.episodes.school.observe(0).joint_angle
        envs.close()
    difference = np.abs(angles["broken"] - angles["economy"])
    assert difference.argmax() == 3
    assert difference[3] > 0.2
    robot = swimbench.challenge("broken").tasks[1].scenario.robot
    assert robot.joints[3].actuator.stall_power < 1e-6


def test_a_return_is_the_objective_times_the_duration(short):
    task = short.tasks[0]
    envs = swimbench.make(QUICK, 3)
    envs.reset(seed=list(short.seeds))
    total = 0.0
    for _ in range(task.n_steps):
        _, rewards, _, _, _ = envs.step(np.zeros((3, 4)))
        total += rewards[0]
    envs.close()
    result = score("open-loop")["scenarios"][0]["results"][0]
    assert total / task.scenario.duration == pytest.approx(result["objective"], rel=1e-12)


def test_energy_costs_and_distance_from_the_line_makes_progress_worthless(short):
    task = short.tasks[0]
    near = _reward(task, y=0.0, power=0.0)
    far = _reward(task, y=task.tolerance, power=0.0)
    assert far == pytest.approx(0.5 * near)
    costly = _reward(task, y=0.0, power=10.0)
    assert near - costly == pytest.approx(10.0 * task.interval / task.price)


def _reward(task, y, power):
    step = SimpleNamespace(
        before=SimpleNamespace(x=0.0, y=y),
        after=SimpleNamespace(x=0.02, y=y),
        interval=task.interval,
        power=power,
    )
    return task.reward(step)


# ---- scores --------------------------------------------------------------------------------------


def test_the_same_policy_has_the_same_scores_to_the_last_bit():
    assert score("ilos")["sha256"] == score("ilos")["sha256"] != score("los")["sha256"]


def test_a_score_file_is_what_its_schema_says_and_is_read_back(tmp_path):
    jsonschema = pytest.importorskip("jsonschema")
    content = score("los")
    text = scoring.text_of(content)
    jsonschema.validate(json.loads(text), json.loads(scoring.SCHEMA.read_text()))
    file = tmp_path / "los.json"
    file.write_text(text)
    assert scoring.read_scores(file) == json.loads(text)
    file.write_text(text.replace('"progress": 0.', '"progress": 1.', 1))
    with pytest.raises(
        scoring.BadScores, match=r"los\.json: its checksum is wrong; it was changed"
    ):
        scoring.read_scores(file)
    old = content | {"scenarios": [content["scenarios"][0] | {"sha256": "0" * 64}]}
    file.write_text(json.dumps(old | {"sha256": scoring.checksum(old)}))
    with pytest.raises(
        scoring.BadScores, match="was scored in another version of economy; score it again"
    ):
        scoring.read_scores(file)
    file.write_text("[]")
    with pytest.raises(scoring.BadScores, match="is not a score file"):
        scoring.read_scores(file)


def test_actions_that_are_none_are_refused():
    bad = Method(
        name="bad",
        kind="callable",
        sha256="",
        pilot=lambda *_: lambda observations: np.full((len(observations), 4), np.nan),
    )
    with pytest.raises(scoring.BadScores, match="bad: returned actions of shape"):
        score(bad)


# ---- policies from outside -----------------------------------------------------------------------

OUTSIDE = """
import numpy as np
import laticauda as lc


def still(observation):
    return np.zeros(4)


still_in_economy = still


class Still:
    def __call__(self, observation):
        assert observation.shape == (13,)
        return np.zeros(4)


gait = lc.Gait(amplitude_deg=30, frequency_deg_s=90, phase_shift_deg=40)
controller = lc.OpenLoop(command=lc.Command(gait=gait), interval=0.2)
nothing = 3
"""


@pytest.mark.parametrize("name", ["still", "Still", "controller", "still_in_{scenario}"])
def test_a_callable_from_outside_is_scored_as_a_baseline_is(tmp_path, monkeypatch, name):
    (tmp_path / "outside.py").write_text(OUTSIDE)
    monkeypatch.syspath_prepend(str(tmp_path))
    ours = score("open-loop")["scenarios"][0]["results"]
    theirs = score(f"outside:{name}")["scenarios"][0]["results"]
    np.testing.assert_allclose(scores_of(theirs), scores_of(ours), rtol=1e-9)
    sys.modules.pop("outside")


def test_what_is_no_policy_is_refused(tmp_path, monkeypatch):
    (tmp_path / "outside.py").write_text(OUTSIDE)
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(
        ValueError,
        match="`policy` must name a function, a class or a controller, got outside:nothing",
    ):
        method("outside:nothing")
    sys.modules.pop("outside")
    with pytest.raises(
        ValueError,
        match="`policy` must name a module that can be imported, got no_such:act: No module",
    ):
        method("no_such:act")
    with pytest.raises(ValueError, match=r"`policy` must be an existing file, got gone\.onnx"):
        method("gone.onnx")
    with pytest.raises(ValueError, match="`policy` must be one of `open-loop`, `los`"):
        method("nobody")


def test_weights_in_a_file_are_the_network_that_was_written(tmp_path):
    draws = np.random.default_rng(1)
    runs = []
    for _ in range(2):
        hidden = networks.Layer(draws.normal(size=(8, 13)), np.ones(8))
        last = networks.Layer(draws.normal(size=(4, 8)), np.zeros(4))
        runs.append([hidden, last])
    networks.save(tmp_path / "mine.npz", runs, "tanh", squash=True)
    observations = draws.normal(size=(5, 13))
    loaded = networks.load(tmp_path / "mine.npz")
    for network, (hidden, last) in zip(loaded, runs, strict=True):
        signals = np.tanh(observations @ hidden.weights.T + hidden.biases)
        expected = np.tanh(signals @ last.weights.T + last.biases)
        actions = network(observations)
        np.testing.assert_allclose(actions, expected, atol=0.02)  # stored in half precision
        np.testing.assert_array_equal(actions[2], network(observations[2:3])[0])
    content = score(str(tmp_path / "mine.npz"))
    assert content["method"]["runs"] == 2
    assert matrix(content["scenarios"][0]).shape == (2, 3)


def test_an_onnx_file_is_scored_or_says_what_it_needs(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "onnxruntime", None)
    (tmp_path / "mine.onnx").write_bytes(b"")
    with pytest.raises(ImportError, match="needs onnxruntime; run `pip install onnxruntime`"):
        method(str(tmp_path / "mine.onnx"))


# ---- statistics and table ------------------------------------------------------------------------


def test_the_interquartile_mean_leaves_out_a_quarter_at_each_end():
    values = np.random.default_rng(0).normal(size=41)
    assert interquartile_mean(values) == pytest.approx(np.sort(values)[10:31].mean())


def test_an_interval_shrinks_with_the_root_of_the_number_of_episodes():
    draws = np.random.default_rng(0)
    few = estimate([draws.normal(size=(1, 25))], mean)
    many = estimate([draws.normal(size=(1, 400))], mean)
    assert 3.0 < (few.high - few.low) / (many.high - many.low) < 5.0
    assert few.low < few.value < few.high


def test_of_a_learner_runs_are_resampled_and_not_episodes():
    same_runs = np.tile([0.0, 1.0, 2.0], (5, 1))
    score_of_runs = estimate([same_runs], over_runs)
    assert score_of_runs.low == score_of_runs.value == score_of_runs.high == 1.0


# ---- learners, where they are installed ----------------------------------------------------------


def test_training_goes_on_where_it_stopped_and_what_it_learned_is_scored_without_it(
    tmp_path, monkeypatch
):
    pytest.importorskip("stable_baselines3")
    from laticauda_swimbench import train

    quick_settings = {
        "ppo": {"n_steps": 4, "batch_size": 16, "n_epochs": 1},
        "sac": {"learning_starts": 8},
    }
    for name, settings in quick_settings.items():
        monkeypatch.setitem(train.SETTINGS, name, train.SETTINGS[name] | settings)
        monkeypatch.setitem(train.LANES, name, 8)
        lines: list[str] = []
        for steps in (32, 64, 64):
            progress = train.train(name, "broken", 1, steps, tmp_path, lines.append)
        assert progress["steps"] == 64
        assert len(lines) == 2
        assert train.collect(name, "broken", tmp_path, tmp_path / "kept.npz") == 1
        networks.load.cache_clear()
        (network,) = networks.load(tmp_path / "kept.npz")
        library = __import__("stable_baselines3")
        model = getattr(library, name.upper()).load(tmp_path / f"{name}-broken-1.zip", device="cpu")
        observations = np.random.default_rng(0).normal(size=(6, 13)).astype(np.float32)
        predicted, _ = model.predict(observations, deterministic=True)
        expected = np.clip(predicted, -1.0, 1.0)
        actions = np.clip(network(observations.astype(float)), -1.0, 1.0)
        np.testing.assert_allclose(actions, expected, atol=0.02)


# ---- what is kept in the distribution ------------------------------------------------------------


def test_the_command_scores_and_tables(tmp_path, capsys):
    assert main(["score", "open-loop", "los", "--scenarios", QUICK, "--output", str(tmp_path)]) == 0
    assert "| LOS |" in capsys.readouterr().out
    assert main(["table", str(tmp_path / "los.json")]) == 0
    assert "economy" in capsys.readouterr().out
    assert main(["score", "nobody"]) == 2
    assert "`policy` must be one of" in capsys.readouterr().err


def test_the_page_has_the_table_of_the_stored_scores(monkeypatch):
    monkeypatch.undo()
    stored = [scoring.read_scores(file) for file in sorted(RESULTS.glob("*.json"))]
    page = (RESULTS.parents[4] / "docs" / "swimbench.md").read_text(encoding="utf-8")
    assert table(stored) in page


@pytest.mark.parametrize("policy", ["los", "ppo"])
def test_what_is_stored_is_what_is_scored_today(monkeypatch, policy):
    monkeypatch.undo()
    stored = scoring.read_scores(RESULTS / f"{policy}.json")
    expected = next(part["results"] for part in stored["scenarios"] if part["name"] == QUICK)
    results = scoring.results(QUICK, method(policy))
    for result, expected_result in zip(results, expected, strict=True):
        assert result["run"] == expected_result["run"]
        assert result["seed"] == expected_result["seed"]
    np.testing.assert_allclose(scores_of(results), scores_of(expected), atol=1e-3)
